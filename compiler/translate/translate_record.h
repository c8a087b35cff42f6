#pragma once
// Keys and records of artifacts in the store (ARCHITECTURE.md, Cache).
//
//   record := the action's 32 bytes | u8 kind | kind 0: 32 bytes, name of the text's blob | kind 1: text, why it is refused

#include <optional>

#include "compiler/base/digest.h"
#include "compiler/base/wire.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln {

struct ArtifactRecord {
    Digest text;
    std::string refusal;  // not empty: there is no text
};

Bytes write_slots(const SlotLayout& layout);
Digest artifact_action(const std::string& identity, Target target, const SlotLayout& layout, const Digest& module);
Bytes write_artifact_record(const Digest& action, const ArtifactRecord& record);
// nullopt for anything but a whole record of this action.
std::optional<ArtifactRecord> read_artifact_record(const Digest& action, ByteView bytes);

// What glslang said of a text, or of a pair: error messages, none when it was accepted.
Digest parse_back_action(const std::string& identity, Target target, Stage stage, const Digest& text);
Digest link_back_action(const std::string& identity, Target target, const Digest& vertex, const Digest& fragment);
Bytes write_messages(const Digest& action, const std::vector<ToolMessage>& messages);
std::optional<std::vector<ToolMessage>> read_messages(const Digest& action, ByteView bytes);

}  // namespace kiln
