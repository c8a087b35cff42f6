// Action records are not named by their content, so a flipped bit would go unnoticed; hence the checksum and the key inside.

#include "compiler/modules/module_record.h"

#include <algorithm>

#include "compiler/base/wire.h"
#include "compiler/reflect/reflect_wire.h"

namespace kiln {
namespace {

constexpr std::string_view magic = "kiln.module.v1";

Digest read_digest(WireReader& in) {
    Digest digest;
    const ByteView bytes = in.raw(digest.bytes.size());
    if (bytes.size() == digest.bytes.size()) std::copy(bytes.begin(), bytes.end(), digest.bytes.begin());
    return digest;
}

}  // namespace

Digest module_action(const std::string& identity, const Options& options, Stage stage, std::string_view text) {
    KeyHasher hasher(magic);
    hasher.field("tools", identity);
    hasher.field("optimise", static_cast<uint64_t>(options.optimise));
    hasher.field("vulkan", uint64_t{options.vulkan}).field("spirv", uint64_t{options.spirv});
    hasher.field("debug", uint64_t{options.debug});
    hasher.field("stage", static_cast<uint64_t>(stage)).field("tokens", text);
    return hasher.finish();
}

Bytes write_module_record(const Digest& key, const ModuleRecord& record) {
    WireWriter out;
    out.text(magic);
    for (const Digest* digest : {&key, &record.raw, &record.pruned, &record.module}) out.raw(digest->bytes);
    out.u64(record.messages.size());
    for (const ToolMessage& m : record.messages) {
        out.u8(static_cast<uint8_t>(m.severity));
        out.u32(m.line);
        out.text(m.text);
    }
    write_reflection(out, record.reflection);
    const Fast checksum = xxh3(out.view());
    out.u64(checksum.low);
    out.u64(checksum.high);
    return out.take();
}

std::optional<ModuleRecord> read_module_record(const Digest& key, ByteView bytes) {
    constexpr size_t checksum_size = 16;
    if (bytes.size() < checksum_size) return std::nullopt;
    const ByteView body = bytes.first(bytes.size() - checksum_size);
    WireReader tail(bytes.subspan(body.size()));
    const uint64_t low = tail.u64(), high = tail.u64();
    if (xxh3(body) != Fast{low, high}) return std::nullopt;

    WireReader in(body);
    if (in.text() != magic || read_digest(in) != key) return std::nullopt;
    ModuleRecord record;
    for (Digest* digest : {&record.raw, &record.pruned, &record.module}) *digest = read_digest(in);
    const size_t messages = in.count(1 + 4 + 8);
    for (size_t i = 0; i < messages && in.ok(); ++i) {
        ToolMessage m;
        const uint8_t severity = in.u8();
        if (severity >= static_cast<uint8_t>(Severity::error)) in.fail();
        m.severity = static_cast<Severity>(severity);
        m.line = in.u32();
        m.text = in.text();
        record.messages.push_back(std::move(m));
    }
    if (!read_reflection(in, record.reflection) || !in.at_end()) return std::nullopt;
    return record;
}

}  // namespace kiln
