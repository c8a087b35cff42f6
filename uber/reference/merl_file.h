#pragma once
// A file of the MERL database:
//
//   file := int32 theta_h, int32 theta_d, int32 phi_d bins, which must be 90, 90, 180
//           float64 values[3][90][90][180]: red, green, blue; phi_d fastest     all little-endian, nothing behind
//
// Values are stored unscaled (merl_reflectance in merl.h); -1 marks what was not measured. A file of another size or other
// bins is refused. Negative and non-finite values become 0, and the warning says how many.

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "uber/reference/merl.h"

namespace kiln::reference {

struct MerlFile {
    std::vector<double> values;  // 3 planes of merl_plane; empty if refused
    std::string error;           // empty if `values` is there
    std::string warning;         // empty if every value was usable
};

inline constexpr size_t merl_file_size = 12 + sizeof(double) * 3 * size_t{merl_plane};

// `name` is what messages call the input.
inline MerlFile parse_merl(const std::string& name, const std::vector<unsigned char>& bytes) {
    MerlFile file;
    if (bytes.size() != merl_file_size) {
        file.error = name + ": " + std::to_string(bytes.size()) + " bytes; a MERL file has " + std::to_string(merl_file_size);
        return file;
    }
    const auto integer = [&](size_t at, size_t size) {
        uint64_t x = 0;
        for (size_t i = size; i-- > 0;) x = x << 8 | bytes[at + i];
        return x;
    };
    const uint64_t bins[] = {integer(0, 4), integer(4, 4), integer(8, 4)};
    if (bins[0] != merl_theta_h_bins || bins[1] != merl_theta_d_bins || bins[2] != merl_phi_d_bins) {
        file.error = name + ": " + std::to_string(bins[0]) + " x " + std::to_string(bins[1]) + " x " + std::to_string(bins[2]) +
                     " bins; a MERL file has 90 x 90 x 180";
        return file;
    }
    file.values.resize(3 * size_t{merl_plane});
    size_t unusable = 0;
    for (size_t i = 0; i < file.values.size(); ++i) {
        const uint64_t word = integer(12 + 8 * i, 8);
        double x = 0;
        std::memcpy(&x, &word, sizeof x);
        if (!(x >= 0 && std::isfinite(x))) x = 0, ++unusable;
        file.values[i] = x;
    }
    if (unusable)
        file.warning = name + ": " + std::to_string(unusable) + " of " + std::to_string(file.values.size()) +
                       " values are negative or not finite and count as 0";
    return file;
}

inline MerlFile load_merl(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) return {{}, path + ": cannot be read", {}};
    return parse_merl(path, std::vector<unsigned char>(std::istreambuf_iterator<char>(in), {}));
}

}  // namespace kiln::reference
