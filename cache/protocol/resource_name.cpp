#include "cache/protocol/resource_name.h"

#include <algorithm>
#include <charconv>
#include <vector>

namespace kiln {
namespace {

constexpr size_t longest_name = 1024;

std::vector<std::string_view> split(std::string_view text) {
    std::vector<std::string_view> out;
    while (true) {
        const size_t slash = text.find('/');
        out.push_back(text.substr(0, slash));
        if (slash == std::string_view::npos) return out;
        text.remove_prefix(slash + 1);
    }
}

bool is_kind(std::string_view word) { return word == "blobs" || word == "compressed-blobs" || word == "uploads"; }

std::string with_instance(std::string_view instance, const std::string& rest) {
    return instance.empty() ? rest : std::string(instance) + "/" + rest;
}

std::string tail(const BlobName& blob) { return "blobs/" + blob.digest.hex() + "/" + std::to_string(blob.size); }

}  // namespace

std::optional<BlobName> blob_name(std::string_view hash, int64_t size) {
    const bool lower =
        std::all_of(hash.begin(), hash.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
    const std::optional<Digest> digest = lower ? Digest::from_hex(hash) : std::nullopt;
    if (!digest || size < 0) return std::nullopt;
    return BlobName{*digest, static_cast<uint64_t>(size)};
}

std::optional<ResourceName> parse_resource_name(std::string_view name) {
    if (name.size() > longest_name) return std::nullopt;
    const std::vector<std::string_view> parts = split(name);
    const auto kind = std::find_if(parts.begin(), parts.end(), is_kind);
    if (kind == parts.end()) return std::nullopt;
    ResourceName out;
    if (kind != parts.begin()) out.instance = std::string(name.substr(0, static_cast<size_t>(kind->data() - name.data()) - 1));
    size_t at = static_cast<size_t>(kind - parts.begin());
    const auto next = [&] { return at < parts.size() ? parts[at++] : std::string_view(); };
    std::string_view word = next();
    if (word == "uploads") {
        out.upload = true;
        if (next().empty()) return std::nullopt;
        word = next();
    }
    if (word == "compressed-blobs") {
        out.zstd = true;
        if (next() != "zstd") return std::nullopt;
    } else if (word != "blobs") {
        return std::nullopt;
    }
    const std::string_view hash = next(), digits = next();
    int64_t size = 0;
    const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), size);
    if (digits.empty() || problem != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    const std::optional<BlobName> blob = blob_name(hash, size);
    if (!blob) return std::nullopt;
    out.blob = *blob;
    return out;
}

std::string read_name(std::string_view instance, const BlobName& blob) { return with_instance(instance, tail(blob)); }

std::string upload_name(std::string_view instance, std::string_view uuid, const BlobName& blob) {
    return with_instance(instance, "uploads/" + std::string(uuid) + "/" + tail(blob));
}

}  // namespace kiln
