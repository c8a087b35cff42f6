#include "compiler/table/table_sections.h"

namespace kiln {

namespace {

// Strides of sections that may stay empty, so that their entries still say what their records are.
constexpr size_t strides[kf_section_last + 1] = KF_STRIDES;

constexpr uint64_t index_limit = 0x7fffffff;

}  // namespace

kf_text TableSections::text(std::string_view text) {
    if (const auto it = texts_.find(text); it != texts_.end()) return it->second;
    Bytes& bytes = sections_[kf_strings].bytes;
    if (bytes.size() + text.size() + 1 > index_limit) overflow_ = true;
    const kf_text out{static_cast<uint32_t>(bytes.size()), static_cast<uint32_t>(text.size())};
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.push_back(0);
    texts_.emplace(text, out);
    return out;
}

kf_range TableSections::add(uint32_t kind, size_t stride, ByteView bytes, bool share) {
    if (bytes.empty()) return {0, 0};
    Section& s = sections_[kind];
    std::string key;
    if (share) {
        key = std::string(as_text(bytes));
        if (const auto it = s.known.find(key); it != s.known.end()) return it->second;
    }
    if ((s.bytes.size() + bytes.size()) / stride > index_limit) overflow_ = true;
    const kf_range out{static_cast<uint32_t>(s.bytes.size() / stride), static_cast<uint32_t>(bytes.size() / stride)};
    s.bytes.insert(s.bytes.end(), bytes.begin(), bytes.end());
    if (share) s.known.emplace(std::move(key), out);
    return out;
}

Result<Bytes> TableSections::file() const {
    if (overflow_) return environment_error("the table grows past 2^31 records or bytes of names in one section");
    std::vector<kf_entry> entries;
    uint64_t at = sizeof(kf_header) + sizeof(kf_entry) * kf_section_last;
    for (uint32_t kind = 1; kind <= kf_section_last; ++kind) {
        kf_entry e{};
        e.kind = kind;
        e.stride = static_cast<uint32_t>(strides[kind]);
        e.offset = at;
        e.used = sections_[kind].bytes.size();
        e.bytes = (e.used + 7) / 8 * 8;
        at += e.bytes;
        entries.push_back(e);
    }
    Bytes out(static_cast<size_t>(at));
    for (kf_entry& e : entries) {
        const Bytes& from = sections_[e.kind].bytes;
        if (!from.empty()) std::memcpy(out.data() + e.offset, from.data(), from.size());
        e.checksum = kf_checksum(out.data() + e.offset, e.bytes / 8, KF_NO_SKIP);
    }
    kf_header header{};
    std::memcpy(header.magic, KF_MAGIC, 8);
    header.version = KF_VERSION;
    header.sections = kf_section_last;
    header.file_bytes = at;
    std::memcpy(out.data(), &header, sizeof header);
    std::memcpy(out.data() + sizeof header, entries.data(), entries.size() * sizeof(kf_entry));
    header.checksum = kf_checksum(out.data(), (sizeof header + entries.size() * sizeof(kf_entry)) / 8, KF_HEADER_SKIP);
    std::memcpy(out.data(), &header, sizeof header);
    return out;
}

}  // namespace kiln
