// A record repeats the action that it answers, so that an entry under a wrong name is a miss and no wrong text.

#include "compiler/translate/translate_record.h"

namespace kiln {
namespace {

// Part of every key: raise it when the same input gives another text (edits.cpp, cross.cpp, limits.cpp).
constexpr uint64_t text_rules = 1;

Digest read_digest(WireReader& in) {
    Digest d;
    const ByteView bytes = in.raw(d.bytes.size());
    for (size_t i = 0; i < bytes.size(); ++i) d.bytes[i] = bytes[i];
    return d;
}

}  // namespace

Bytes write_slots(const SlotLayout& layout) {
    WireWriter out;
    out.u8(static_cast<uint8_t>(layout.rasterised));
    out.u8(layout.flat_blocks);
    out.u64(layout.interpolation.size());
    for (const Interpolation& i : layout.interpolation) {
        out.u32(i.location);
        for (const bool flag : {i.flat, i.no_perspective, i.centroid, i.sample}) out.u8(flag);
    }
    for (const Slot& s : layout.slots) {
        out.u8(static_cast<uint8_t>(s.kind));
        out.u8(s.by_stage);
        out.text(s.name);
        for (const uint32_t n :
             {s.set, s.binding, s.buffer, s.texture, s.sampler, s.image, s.uav, s.metal_buffer, s.metal_texture, s.unit_offset})
            out.u32(n);
    }
    return out.take();
}

Digest artifact_action(const std::string& identity, Target target, const SlotLayout& layout, const Digest& module) {
    KeyHasher key("kiln.artifact.v1");
    key.field("tools", identity).field("rules", text_rules).field("target", name_of(target));
    key.field("slots", ByteView(write_slots(layout))).field("module", module);
    return key.finish();
}

Bytes write_artifact_record(const Digest& action, const ArtifactRecord& record) {
    WireWriter out;
    out.raw(action.bytes);
    out.u8(record.refusal.empty() ? 0 : 1);
    if (record.refusal.empty())
        out.raw(record.text.bytes);
    else
        out.text(record.refusal);
    return out.take();
}

std::optional<ArtifactRecord> read_artifact_record(const Digest& action, ByteView bytes) {
    WireReader in(bytes);
    if (read_digest(in) != action) return std::nullopt;
    ArtifactRecord record;
    const uint8_t kind = in.u8();
    if (kind == 0)
        record.text = read_digest(in);
    else if (kind == 1)
        record.refusal = in.text();
    if (!in.ok() || !in.at_end() || kind > 1 || (kind == 1 && record.refusal.empty())) return std::nullopt;
    return record;
}

Digest parse_back_action(const std::string& identity, Target target, Stage stage, const Digest& text) {
    KeyHasher key("kiln.parse_back.v1");
    key.field("tools", identity).field("target", name_of(target)).field("stage", name_of(stage)).field("text", text);
    return key.finish();
}

Digest link_back_action(const std::string& identity, Target target, const Digest& vertex, const Digest& fragment) {
    KeyHasher key("kiln.link_back.v1");
    key.field("tools", identity).field("target", name_of(target)).field("vertex", vertex).field("fragment", fragment);
    return key.finish();
}

Bytes write_messages(const Digest& action, const std::vector<ToolMessage>& messages) {
    WireWriter out;
    out.raw(action.bytes);
    out.u64(messages.size());
    for (const ToolMessage& m : messages) {
        out.u8(static_cast<uint8_t>(m.severity));
        out.u32(m.line);
        out.text(m.text);
    }
    return out.take();
}

std::optional<std::vector<ToolMessage>> read_messages(const Digest& action, ByteView bytes) {
    WireReader in(bytes);
    if (read_digest(in) != action) return std::nullopt;
    std::vector<ToolMessage> messages(in.count(13));
    for (ToolMessage& m : messages) {
        const uint8_t severity = in.u8();
        if (severity > static_cast<uint8_t>(Severity::error)) in.fail();
        m.severity = static_cast<Severity>(severity);
        m.line = in.u32();
        m.text = in.text();
    }
    if (!in.ok() || !in.at_end()) return std::nullopt;
    return messages;
}

}  // namespace kiln
