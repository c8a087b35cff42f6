#pragma once
// Cascaded shadow maps for the tests of functions: four layers of blocks, four matrices.

#include <iomanip>
#include <sstream>

#include "tests/functions/shadow_maps.h"
#include "uber/reference/cascades.h"
#include "uber/reference/pcf.h"

namespace kiln::test {

// Four layers of random blocks of 4 x 4 texels.
inline DepthTexture blocks(int size) {
    DepthTexture out{size, {}};
    for (int layer = 0; layer < 4; ++layer)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                out.depths.push_back(static_cast<float>(
                    reference::pixel_hash(static_cast<uint32_t>(x / 4 + 64 * layer), static_cast<uint32_t>(y / 4))));
    return out;
}

// Four slices' matrices in fp32, as numbers and as GLSL ("const mat4 NAME[4] = ...;").
class Matrices {
public:
    template <class Make>
    Matrices(const std::string& name, Make make) {
        std::ostringstream text;
        text << std::setprecision(20) << std::fixed << "const mat4 " << name << "[4] = mat4[4](";
        for (size_t i = 0; i < 4; ++i) {
            of_[i] = make(static_cast<int>(i));
            text << (i == 0 ? "" : ", ") << "mat4(";
            bool first = true;
            for (auto& column : of_[i].columns)
                for (double* x : {&column.x, &column.y, &column.z, &column.w}) {
                    // Multiples of 2^-20: short decimals that fp32 holds exactly.
                    *x = std::round(*x * 0x1p20) / 0x1p20;
                    text << (first ? "" : ", ") << *x;
                    first = false;
                }
            text << ")";
        }
        glsl = text.str() + ");";
    }
    template <class T>
    std::array<reference::Mat4<T>, 4> read() const {
        std::array<reference::Mat4<T>, 4> out;
        for (size_t i = 0; i < 4; ++i)
            for (int c = 0; c < 4; ++c) {
                const reference::Vec4<double>& v = of_[i].columns[c];
                out[i].columns[c] = {T(v.x), T(v.y), T(v.z), T(v.w)};
            }
        return out;
    }
    std::string glsl;

private:
    std::array<reference::Mat4<double>, 4> of_;
};

// Slices of 10 m each along the view, fitted in maps of 32 x 32 texels.
inline reference::Mat4<double> cascade_matrix(int i) {
    const reference::LightAxes light = reference::light_axes({0.3, -0.8, 0.4});
    const double end = 10.0 * (i + 1);
    return reference::fit_cascade({0, 0, end / 2}, end, light, 32, 20).clip_of_world;
}

}  // namespace kiln::test
