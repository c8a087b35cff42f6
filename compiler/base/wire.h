#pragma once
// Little-endian, bounds-checked records for everything that reaches disk. A Reader never reads past its bytes: the first
// short or oversized field makes it fail, every later read gives zero or empty, and ok() tells at the end.

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "compiler/base/bytes.h"

namespace kiln {

class WireWriter {
public:
    void u8(uint8_t v) { out_.push_back(v); }
    void u32(uint32_t v) { number(v, 4); }
    void u64(uint64_t v) { number(v, 8); }
    void bytes(ByteView v) {
        u64(v.size());
        out_.insert(out_.end(), v.begin(), v.end());
    }
    void text(std::string_view v) { bytes(as_bytes(v)); }
    void raw(ByteView v) { out_.insert(out_.end(), v.begin(), v.end()); }
    size_t size() const { return out_.size(); }
    Bytes take() { return std::move(out_); }
    const Bytes& view() const { return out_; }

private:
    void number(uint64_t v, unsigned n) {
        for (unsigned i = 0; i < n; ++i) out_.push_back(static_cast<uint8_t>(v >> (8 * i)));
    }
    Bytes out_;
};

class WireReader {
public:
    explicit WireReader(ByteView bytes) : rest_(bytes) {}
    uint8_t u8() { return static_cast<uint8_t>(number(1)); }
    uint32_t u32() { return static_cast<uint32_t>(number(4)); }
    uint64_t u64() { return number(8); }
    ByteView bytes() { return raw(u64()); }
    std::string text() { return std::string(as_text(bytes())); }
    ByteView raw(uint64_t size) {
        if (size > rest_.size()) {
            fail();
            return {};
        }
        const ByteView got = rest_.first(static_cast<size_t>(size));
        rest_ = rest_.subspan(static_cast<size_t>(size));
        return got;
    }
    // A count of records that each take at least `least` bytes; fails when they cannot fit in what is left.
    size_t count(size_t least) {
        const uint64_t n = u64();
        if (least != 0 && n > rest_.size() / least) {
            fail();
            return 0;
        }
        return static_cast<size_t>(n);
    }
    void fail() {
        ok_ = false;
        rest_ = {};
    }
    bool ok() const { return ok_; }
    bool at_end() const { return rest_.empty(); }
    size_t left() const { return rest_.size(); }

private:
    uint64_t number(unsigned n) {
        if (n > rest_.size()) {
            fail();
            return 0;
        }
        uint64_t v = 0;
        for (unsigned i = 0; i < n; ++i) v |= static_cast<uint64_t>(rest_[i]) << (8 * i);
        rest_ = rest_.subspan(n);
        return v;
    }
    ByteView rest_;
    bool ok_ = true;
};

}  // namespace kiln
