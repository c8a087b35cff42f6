#pragma once
// What the store remembers of one compiled class: the action record of ARCHITECTURE.md, Cache.

#include <optional>
#include <string>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln {

struct ModuleRecord {
    Digest raw, pruned, module;         // of glslang's words, of the pruned ones, of the final ones; the latter two name blobs
    std::vector<ToolMessage> messages;  // warnings and notes; a class with errors is never recorded
    Reflection reflection;
};

// Everything that decides the record: tools, options that reach them, stage, tokens.
Digest module_action(const std::string& identity, const Options& options, Stage stage, std::string_view text);

// record := "kiln.module.v1" | key[32] | raw[32] | pruned[32] | module[32] | n * (u8 severity | u32 line | text) | reflection
//           | u64 XXH3-128 low | u64 high of all before
// The reader refuses a record of another key, version or checksum.
Bytes write_module_record(const Digest& key, const ModuleRecord& record);
std::optional<ModuleRecord> read_module_record(const Digest& key, ByteView bytes);

}  // namespace kiln
