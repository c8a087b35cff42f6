#pragma once
// The protobuf wire format, as far as the messages of this folder need it: varints, length-delimited fields, fixed ones to
// skip. Groups are refused. Every view points into the bytes that were given.

#include <optional>

#include "compiler/base/bytes.h"

// Inline and named, for compiler/base/wire.h has classes of the same names.
namespace kiln {
inline namespace protobuf {

class WireReader {
public:
    enum class Type : uint8_t { varint = 0, fixed64 = 1, bytes = 2, fixed32 = 5 };
    struct Field {
        uint32_t number = 0;
        Type type = Type::varint;
        uint64_t value = 0;  // of a varint or fixed one
        ByteView bytes;      // of a length-delimited one
    };

    explicit WireReader(ByteView message) : rest_(message) {}
    // The next field; nullopt at the end and at the first byte that is no field: then `bad()`.
    std::optional<Field> next();
    bool bad() const { return bad_; }

private:
    std::optional<uint64_t> varint();
    std::optional<uint64_t> fixed(size_t size);
    ByteView rest_;
    bool bad_ = false;
};

// Writes what WireReader reads, in the order of the calls. As proto3 has it, a zero or empty value is not written.
class WireWriter {
public:
    void number(uint32_t field, uint64_t value);
    void bytes(uint32_t field, ByteView value);
    // Also when it is empty: a message that is there.
    void message(uint32_t field, ByteView value);
    Bytes take() { return std::move(out_); }

private:
    void varint(uint64_t value);
    Bytes out_;
};

}  // namespace protobuf
}  // namespace kiln
