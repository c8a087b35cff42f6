#pragma once
// The little linear algebra that the contact sheet's scene needs. Column vectors, column-major.

#include <array>
#include <cmath>

namespace kiln {

struct Vec3 {
    double x = 0, y = 0, z = 0;
};
inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Vec3 unit(Vec3 a) { return a * (1.0 / std::sqrt(dot(a, a))); }

using Mat4 = std::array<double, 16>;  // entry (row, column) at [column * 4 + row]
inline Mat4 identity() { return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }
inline Mat4 operator*(const Mat4& a, const Mat4& b) {
    Mat4 out{};
    for (size_t c = 0; c < 4; ++c)
        for (size_t r = 0; r < 4; ++r)
            for (size_t k = 0; k < 4; ++k) out[c * 4 + r] += a[k * 4 + r] * b[c * 4 + k];
    return out;
}

// World to view: the eye looks along -z.
inline Mat4 look_at(Vec3 eye, Vec3 target, Vec3 up) {
    const Vec3 back = unit(eye - target), right = unit(cross(up, back)), top = cross(back, right);
    return {right.x, top.x, back.x, 0, right.y,          top.y,          back.y,          0,
            right.z, top.z, back.z, 0, -dot(right, eye), -dot(top, eye), -dot(back, eye), 1};
}
// Vulkan's clip space: y down, depth 0 to 1.
inline Mat4 perspective(double half_angle, double near, double far) {
    const double f = 1.0 / std::tan(half_angle);
    return {f, 0, 0, 0, 0, -f, 0, 0, 0, 0, far / (near - far), -1, 0, 0, near * far / (near - far), 0};
}
inline Mat4 orthographic(double half_side, double near, double far) {
    return {1 / half_side, 0, 0, 0, 0, -1 / half_side, 0, 0, 0, 0, 1 / (near - far), 0, 0, 0, near / (near - far), 1};
}
inline Mat4 rotation_y(double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c, 0, -s, 0, 0, 1, 0, 0, s, 0, c, 0, 0, 0, 0, 1};
}

}  // namespace kiln
