#include "cache/protocol/wire_message.h"

namespace kiln {

std::optional<uint64_t> WireReader::varint() {
    uint64_t value = 0;
    for (size_t i = 0; i < 10 && i < rest_.size(); ++i) {
        const uint8_t byte = rest_[i];
        if (i == 9 && byte > 1) return std::nullopt;  // past 64 bits
        value |= uint64_t{byte & 0x7fu} << (7 * i);
        if (byte < 0x80) {
            rest_ = rest_.subspan(i + 1);
            return value;
        }
    }
    return std::nullopt;
}

std::optional<uint64_t> WireReader::fixed(size_t size) {
    if (rest_.size() < size) return std::nullopt;
    uint64_t value = 0;
    for (size_t i = 0; i < size; ++i) value |= uint64_t{rest_[i]} << (8 * i);
    rest_ = rest_.subspan(size);
    return value;
}

std::optional<WireReader::Field> WireReader::next() {
    if (rest_.empty() || bad_) return std::nullopt;
    bad_ = true;  // until the field is whole
    const auto tag = varint();
    if (!tag || (*tag >> 3) == 0 || (*tag >> 3) > 0x1fffffff) return std::nullopt;
    Field field{static_cast<uint32_t>(*tag >> 3), static_cast<Type>(*tag & 7), 0, {}};
    std::optional<uint64_t> value;
    switch (field.type) {
        case Type::varint:
            value = varint();
            break;
        case Type::fixed64:
            value = fixed(8);
            break;
        case Type::fixed32:
            value = fixed(4);
            break;
        case Type::bytes:
            value = varint();
            if (!value || *value > rest_.size()) return std::nullopt;
            field.bytes = rest_.first(static_cast<size_t>(*value));
            rest_ = rest_.subspan(field.bytes.size());
            break;
        default:
            return std::nullopt;
    }
    if (!value) return std::nullopt;
    field.value = *value;
    bad_ = false;
    return field;
}

void WireWriter::varint(uint64_t value) {
    for (; value >= 0x80; value >>= 7) out_.push_back(static_cast<uint8_t>(value | 0x80));
    out_.push_back(static_cast<uint8_t>(value));
}

void WireWriter::number(uint32_t field, uint64_t value) {
    if (value == 0) return;
    varint(uint64_t{field} << 3);
    varint(value);
}

void WireWriter::bytes(uint32_t field, ByteView value) {
    if (!value.empty()) message(field, value);
}

void WireWriter::message(uint32_t field, ByteView value) {
    varint(uint64_t{field} << 3 | 2);
    varint(value.size());
    out_.insert(out_.end(), value.begin(), value.end());
}

}  // namespace kiln
