#pragma once
// A file of the MERL database:
//
//   file := int32 theta_h, int32 theta_d, int32 phi_d bins, which must be 90, 90, 180
//           float64 values[3][90][90][180]: red, green, blue; phi_d fastest     all little-endian, nothing behind
//
// Values are stored unscaled (merl_reflectance in merl.h); -1 marks what was not measured. A file of another size or other
// bins is refused. Negative and non-finite values become 0, and the warning says how many; their bins are not measured.

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "uber/reference/merl.h"

namespace kiln::reference {

struct MerlFile {
    std::vector<double> values;  // 3 planes of merl_plane; empty if refused
    std::vector<bool> measured;  // of merl_plane: whether a bin had all three colours
    std::string error;           // empty if `values` is there
    std::string warning;         // empty if every value was usable
};

inline constexpr size_t merl_file_size = 12 + sizeof(double) * 3 * size_t{merl_plane};

inline std::string merl_size_error(const std::string& name, long long size) {
    return name + ": " + std::to_string(size) + " bytes; a MERL file has " + std::to_string(merl_file_size);
}

// `name` is what messages call the input.
inline MerlFile parse_merl(const std::string& name, const std::vector<unsigned char>& bytes) {
    MerlFile file;
    if (bytes.size() != merl_file_size) {
        file.error = merl_size_error(name, static_cast<long long>(bytes.size()));
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
    file.measured.assign(size_t{merl_plane}, true);
    size_t unusable = 0;
    for (size_t i = 0; i < file.values.size(); ++i) {
        const uint64_t word = integer(12 + 8 * i, 8);
        double x = 0;
        std::memcpy(&x, &word, sizeof x);
        if (!(x >= 0 && x <= 1e38)) {
            x = 0;
            ++unusable;
            file.measured[i % size_t{merl_plane}] = false;
        }
        file.values[i] = x;
    }
    if (unusable)
        file.warning = name + ": " + std::to_string(unusable) + " of " + std::to_string(file.values.size()) +
                       " values are negative, above 1e38 or not numbers and count as 0";
    return file;
}

// Columns, rows and slices of the texture that uber/lib/merl.glsl reads.
inline constexpr int merl_columns = merl_phi_d_bins + 2, merl_rows = merl_theta_d_bins, merl_slices = merl_theta_h_bins;

// Its texels, rgba: the BRDF per steradian and 1, or four zeros. `file`: not refused.
inline std::vector<float> merl_texels(const MerlFile& file) {
    std::vector<float> texels(size_t{4} * merl_columns * merl_rows * merl_slices);
    size_t at = 0;
    for (int h = 0; h < merl_slices; ++h)
        for (int d = 0; d < merl_rows; ++d)
            for (int column = 0; column < merl_columns; ++column, at += 4) {
                const int phi = (column + merl_phi_d_bins - 1) % merl_phi_d_bins;
                const size_t bin = static_cast<size_t>(merl_index({h, d, phi}));
                if (!file.measured[bin]) continue;
                const Vec3<double> f = merl_reflectance(Vec3<double>{file.values[bin], file.values[bin + size_t{merl_plane}],
                                                                     file.values[bin + 2 * size_t{merl_plane}]});
                texels[at] = static_cast<float>(f.x), texels[at + 1] = static_cast<float>(f.y);
                texels[at + 2] = static_cast<float>(f.z), texels[at + 3] = 1.0f;
            }
    return texels;
}

// A file of an analytic BRDF, for tests and for who has none of the database: brdf(l, v) -> per steradian, at the bins'
// centres, n being z. -1 where light or view are below the horizon.
template <class Brdf>
std::vector<unsigned char> merl_bytes(Brdf brdf) {
    std::vector<unsigned char> bytes(merl_file_size);
    const auto put = [&](size_t at, uint64_t word, size_t size) {
        for (size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<unsigned char>(word >> 8 * i & 0xff);
    };
    put(0, merl_theta_h_bins, 4), put(4, merl_theta_d_bins, 4), put(8, merl_phi_d_bins, 4);
    const Vec3<double> scale = merl_reflectance(Vec3<double>{1, 1, 1});
    for (int h = 0; h < merl_theta_h_bins; ++h)
        for (int d = 0; d < merl_theta_d_bins; ++d)
            for (int phi = 0; phi < merl_phi_d_bins; ++phi) {
                const MerlDirections at = merl_directions({h + 0.5, d + 0.5, phi + 0.5});
                const bool above = at.l.z > 0 && at.v.z > 0;
                const Vec3<double> f = above ? brdf(at.l, at.v) : Vec3<double>{};
                const double stored[] = {f.x / scale.x, f.y / scale.y, f.z / scale.z};
                for (size_t plane = 0; plane < 3; ++plane) {
                    const double x = above ? stored[plane] : -1.0;
                    uint64_t word = 0;
                    std::memcpy(&word, &x, sizeof x);
                    put(12 + 8 * (plane * size_t{merl_plane} + static_cast<size_t>(merl_index({h, d, phi}))), word, 8);
                }
            }
    return bytes;
}

inline MerlFile load_merl(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) return {{}, {}, path + ": cannot be read", {}};
    in.seekg(0, std::ios::end);
    const std::streamoff size = in.tellg();
    if (size != static_cast<std::streamoff>(merl_file_size)) return {{}, {}, merl_size_error(path, size), {}};
    in.seekg(0);
    std::vector<unsigned char> bytes(merl_file_size);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<size_t>(in.gcount()));
    return parse_merl(path, bytes);
}

}  // namespace kiln::reference
