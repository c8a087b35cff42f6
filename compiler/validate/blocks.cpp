#include "compiler/validate/blocks.h"

#include <algorithm>
#include <cstring>

#include "compiler/validate/inputs.h"
#include "compiler/validate/values.h"

namespace kiln {

namespace {

// A block of hostile or broken reflection must not ask for all memory.
constexpr size_t block_limit = 16u << 20;
constexpr size_t element_limit = 1u << 20;

bool is_float(BaseType t) { return t == BaseType::float32 || t == BaseType::float16 || t == BaseType::float64; }

uint16_t half_bits(float v) {
    uint32_t bits;
    std::memcpy(&bits, &v, 4);
    const uint32_t sign = bits >> 16 & 0x8000u;
    const int32_t exponent = static_cast<int32_t>(bits >> 23 & 0xffu) - 112;
    if (exponent <= 0) return static_cast<uint16_t>(sign);  // ordinary inputs are never that small
    if (exponent >= 31) return static_cast<uint16_t>(sign | 0x7c00u);
    return static_cast<uint16_t>(sign | static_cast<uint32_t>(exponent) << 10 | (bits >> 13 & 0x3ffu));
}

size_t bytes_of(BaseType t) {
    switch (t) {
        case BaseType::float64:
        case BaseType::int64:
        case BaseType::uint64:
            return 8;
        case BaseType::float16:
        case BaseType::int16:
        case BaseType::uint16:
            return 2;
        case BaseType::int8:
        case BaseType::uint8:
            return 1;
        default:
            return 4;
    }
}

template <class T>
void put(Bytes& out, size_t at, T v) {
    if (at <= out.size() && out.size() - at >= sizeof v) std::memcpy(out.data() + at, &v, sizeof v);
}

void store_scalar(Bytes& out, size_t at, BaseType type, double v) {
    switch (type) {
        case BaseType::float32:
            return put(out, at, static_cast<float>(v));
        case BaseType::float16:
            return put(out, at, half_bits(static_cast<float>(v)));
        case BaseType::float64:
            return put(out, at, v);
        case BaseType::int64:
        case BaseType::uint64:
            return put(out, at, static_cast<int64_t>(v));
        case BaseType::int16:
        case BaseType::uint16:
            return put(out, at, static_cast<int16_t>(v));
        case BaseType::int8:
        case BaseType::uint8:
            return put(out, at, static_cast<int8_t>(v));
        default:
            return put(out, at, static_cast<int32_t>(v));
    }
}

// Bytes from one column (or row, where row-major) of a matrix to the next.
size_t matrix_stride_of(const Member& m) {
    if (m.matrix_stride != 0) return m.matrix_stride;
    const size_t vector = m.row_major ? m.type.columns : m.type.rows;
    return vector * bytes_of(m.type.base);
}

// A matrix near the identity; entry (row, column) at [column * rows + row].
void near_identity(double* out, unsigned rows, unsigned columns, uint64_t seed, bool wide) {
    const double reach = wide ? 1.2 : 0.7;
    const double a = (static_cast<double>(unit(seed, 1)) - 0.5) * reach;  // about z
    const double b = (static_cast<double>(unit(seed, 2)) - 0.5) * reach;  // about x
    const double scale = 0.85 + 0.1 * static_cast<double>(unit(seed, 3));
    const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
    const double rotation[3][3] = {{ca, -sa, 0}, {cb * sa, cb * ca, -sb}, {sb * sa, sb * ca, cb}};  // [row][column]
    for (unsigned c = 0; c < columns; ++c)
        for (unsigned r = 0; r < rows; ++r) {
            double v = r == c ? 1.0 : 0.0;
            if (r < 3 && c < 3) v = rotation[r][c] * scale;
            out[c * rows + r] = v;
        }
    if (rows == 2 || columns == 2) return;
    if (columns == 4) {  // a translation: small in the picture's plane, and z to the middle of (0, 1)
        out[3 * rows + 0] = 0.1 * static_cast<double>(unit(seed, 4)) - 0.05;
        out[3 * rows + 1] = 0.1 * static_cast<double>(unit(seed, 5)) - 0.05;
        out[3 * rows + 2] = 0.5;
    }
    if (rows == 4 && columns == 4) {
        for (unsigned c = 0; c < 3; ++c) out[c * rows + 2] *= 0.4;
        out[2 * rows + 3] = 0.1 * static_cast<double>(unit(seed, 6));  // w grows a little with z
        out[3 * rows + 3] = 1.0;
    }
}

void make_value(double* out, const Member& m, uint64_t seed, bool either_sign) {
    const unsigned n = unsigned{m.type.rows} * m.type.columns;
    if (!is_float(m.type.base)) {
        for (unsigned i = 0; i < n; ++i)
            out[i] = m.type.base == BaseType::boolean ? static_cast<double>(mix64(seed ^ i) & 1)
                                                      : static_cast<double>(1 + (mix64(seed ^ i) & 1));
        return;
    }
    if (m.type.columns > 1) return near_identity(out, m.type.rows, m.type.columns, seed, either_sign);
    for (unsigned i = 0; i < n; ++i) out[i] = static_cast<double>(ordinary(seed, i, either_sign));
    if (n == 3) {
        const double length = std::sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
        const double wanted = 0.8 + 0.4 * static_cast<double>(unit(seed, 3));
        for (unsigned i = 0; i < 3; ++i) out[i] *= wanted / length;
    }
}

}  // namespace

std::vector<size_t> element_offsets(const Member& member) {
    std::vector<size_t> out{member.offset};
    const size_t dims = member.type.array.size();
    // Where only the innermost stride is known, the outer dimensions are taken to follow without gaps.
    std::vector<size_t> strides(dims, member.array_stride);
    for (size_t d = dims; d-- > 1;) strides[d - 1] = strides[d] * std::max<size_t>(1, member.type.array[d]);
    if (member.strides.size() == dims) std::copy(member.strides.begin(), member.strides.end(), strides.begin());
    for (size_t d = 0; d < dims; ++d) {
        const size_t n = member.type.array[d] == 0 ? run_time_elements : member.type.array[d];
        std::vector<size_t> next;
        for (const size_t base : out)
            for (size_t i = 0; i < n && next.size() < element_limit; ++i) next.push_back(base + i * strides[d]);
        out = std::move(next);
    }
    return out;
}

size_t block_bytes(const Resource& block) {
    size_t bytes = block.bytes;
    for (const Member& m : block.members) {
        if (std::find(m.type.array.begin(), m.type.array.end(), 0u) == m.type.array.end()) continue;
        const size_t stride = !m.strides.empty() ? m.strides.front() : m.array_stride;
        bytes = std::max(bytes, m.offset + stride * run_time_elements);
    }
    bytes = (std::max<size_t>(bytes, 16) + 15) / 16 * 16;
    return std::min(bytes, block_limit);
}

void store_value(Bytes& block, size_t at, const Member& member, const double* values) {
    const size_t step = bytes_of(member.type.base);
    const size_t stride = member.type.columns > 1 ? matrix_stride_of(member) : 0;
    for (unsigned c = 0; c < member.type.columns; ++c)
        for (unsigned r = 0; r < member.type.rows; ++r) {
            const size_t offset = member.row_major && member.type.columns > 1 ? r * stride + c * step : c * stride + r * step;
            store_scalar(block, at + offset, member.type.base, values[c * member.type.rows + r]);
        }
}

Bytes fill_block(const Resource& block, uint64_t seed, bool either_sign) {
    Bytes out(block_bytes(block));
    const uint64_t of_block = seed_of(seed, block.name);
    for (const Member& m : block.members) {
        if (m.type.base == BaseType::structure || m.type.rows > 4 || m.type.columns > 4) continue;
        const uint64_t of_member = seed_of(of_block, m.name);
        uint64_t index = 0;
        for (const size_t at : element_offsets(m)) {
            double values[16];
            make_value(values, m, mix64(of_member ^ index++), either_sign);
            store_value(out, at, m, values);
        }
    }
    return out;
}

std::vector<BaseType> word_types(const Resource& block) {
    std::vector<BaseType> out(block_bytes(block) / 4, BaseType::uint32);
    for (const Member& m : block.members) {
        if (m.type.base != BaseType::float32 || m.type.rows > 4 || m.type.columns > 4) continue;
        const size_t stride = m.type.columns > 1 ? matrix_stride_of(m) : 0;
        for (const size_t at : element_offsets(m))
            for (unsigned c = 0; c < m.type.columns; ++c)
                for (unsigned r = 0; r < m.type.rows; ++r) {
                    const size_t word =
                        (at + (m.row_major && m.type.columns > 1 ? r * stride + c * 4u : c * stride + r * 4u)) / 4;
                    if (word < out.size()) out[word] = BaseType::float32;
                }
    }
    return out;
}

}  // namespace kiln
