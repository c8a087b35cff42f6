#pragma once
// The rooms of uber/lib/gi_cornell.glsl.

#include <vector>

#include "uber/reference/gi_quad.h"

namespace kiln::reference {

inline std::vector<GiQuad<double>> gi_cornell_quads() {
    const Vec3<double> white{0.725, 0.71, 0.68}, red{0.63, 0.065, 0.05}, green{0.14, 0.45, 0.091};
    return {{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, white, {}},          {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white, {}},
            {{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white, {}},          {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, red, {}},
            {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}, green, {}},           {{0.05, -0.4, 0.05}, {0, 0, 0.6}, {0.6, 0, 0}, white, {}},
            {{0.05, -1, 0.65}, {0.6, 0, 0}, {0, 0.6, 0}, white, {}},  {{0.05, -1, 0.05}, {0, 0.6, 0}, {0.6, 0, 0}, white, {}},
            {{0.05, -1, 0.05}, {0, 0, 0.6}, {0, 0.6, 0}, white, {}},  {{0.65, -1, 0.05}, {0, 0.6, 0}, {0, 0, 0.6}, white, {}},
            {{-0.7, 0.2, -0.6}, {0, 0, 0.6}, {0.6, 0, 0}, white, {}}, {{-0.7, -1, 0}, {0.6, 0, 0}, {0, 1.2, 0}, white, {}},
            {{-0.7, -1, -0.6}, {0, 1.2, 0}, {0.6, 0, 0}, white, {}},  {{-0.7, -1, -0.6}, {0, 0, 0.6}, {0, 1.2, 0}, white, {}},
            {{-0.1, -1, -0.6}, {0, 1.2, 0}, {0, 0, 0.6}, white, {}}};
}

inline std::vector<GiQuad<double>> gi_furnace_quads(double albedo = 0.5) {
    return {{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, splat3(albedo), splat3(1.0)},
            {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, splat3(albedo), splat3(1.0)},
            {{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, splat3(albedo), splat3(1.0)},
            {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, splat3(albedo), splat3(1.0)},
            {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}, splat3(albedo), splat3(1.0)},
            {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, splat3(albedo), splat3(1.0)}};
}

inline std::vector<GiQuad<double>> gi_plate_quads() {
    return {{{-0.5, -0.5, -0.5}, {0, 0, 1}, {1, 0, 0}, {}, {}}, {{-0.5, 0.5, -0.5}, {1, 0, 0}, {0, 0, 1}, {}, splat3(1.0)}};
}

inline GiLamp<double> gi_cornell_lamp() { return {{0, 0.9, 0}, {0, -1, 0}, splat3(1.0)}; }

}  // namespace kiln::reference
