#pragma once
// Two hashes with two jobs. XXH3-128 (Fast) finds candidates inside one process, where bytes are compared before
// anything merges. SHA-256 (Digest) names what is shared through a store, where a forged name would hit everybody.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "compiler/base/bytes.h"

namespace kiln {

struct Digest {
    std::array<uint8_t, 32> bytes{};
    friend auto operator<=>(const Digest&, const Digest&) = default;
    std::string hex() const;  // 64 lower-case digits
    static std::optional<Digest> from_hex(std::string_view hex);
};

struct Fast {
    uint64_t low = 0, high = 0;
    friend auto operator<=>(const Fast&, const Fast&) = default;
};

Digest sha256(ByteView bytes);
Fast xxh3(ByteView bytes);

// SHA-256 of bytes that are never in memory all at once.
class StreamHash {
public:
    StreamHash();
    StreamHash(const StreamHash&) = delete;
    StreamHash& operator=(const StreamHash&) = delete;
    ~StreamHash();
    void update(ByteView bytes);
    Digest finish();  // once

private:
    void* state_;
};

// Hashes named, length-prefixed fields, so that no two field lists collide by concatenation. `domain` carries a version:
// "kiln.module.v1".
class KeyHasher {
public:
    explicit KeyHasher(std::string_view domain);
    KeyHasher& field(std::string_view name, ByteView value);
    KeyHasher& field(std::string_view name, std::string_view value) { return field(name, as_bytes(value)); }
    KeyHasher& field(std::string_view name, const char* value) { return field(name, std::string_view(value)); }
    KeyHasher& field(std::string_view name, uint64_t value);
    KeyHasher& field(std::string_view name, const Digest& value) { return field(name, ByteView(value.bytes)); }
    Digest finish() { return hash_.finish(); }

private:
    void number(uint64_t value);
    StreamHash hash_;
};

}  // namespace kiln

template <>
struct std::hash<kiln::Fast> {
    size_t operator()(const kiln::Fast& f) const noexcept { return static_cast<size_t>(f.low); }
};
template <>
struct std::hash<kiln::Digest> {
    size_t operator()(const kiln::Digest& d) const noexcept {
        size_t h = 0;
        for (size_t i = 0; i < sizeof h; ++i) h = h << 8 | d.bytes[i];
        return h;
    }
};
