#pragma once
// A renderer in double: triangles in clip space to fragments, with barycentric weights in perspective, by homogeneous edge
// functions (Olano and Greer, "Triangle Scan Conversion Using 2D Homogeneous Coordinates", 1997), which needs no clipping:
// with M the matrix whose columns are (x, y, w) of a triangle's corners, e = M^-1 (X, Y, 1) holds weight over w of each
// corner at NDC (X, Y), and 1 / w there is the sum of e.

#include <array>
#include <vector>

#include "uber/reference/bounded.h"

namespace kiln::reference {

// ---- matrices, column vectors, Vulkan's clip space (y down, depth 0 to 1) ----

inline Mat4<double> operator*(const Mat4<double>& a, const Mat4<double>& b) {
    return {{a * b.columns[0], a * b.columns[1], a * b.columns[2], a * b.columns[3]}};
}

// By cofactors.
inline Mat4<double> inverse(const Mat4<double>& m) {
    const auto at = [&](int r, int c) {
        const Vec4<double>& v = m.columns[c];
        return r == 0 ? v.x : r == 1 ? v.y : r == 2 ? v.z : v.w;
    };
    double cofactor[4][4];
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) {
            const int a[3] = {r == 0 ? 1 : 0, r <= 1 ? 2 : 1, r <= 2 ? 3 : 2},
                      b[3] = {c == 0 ? 1 : 0, c <= 1 ? 2 : 1, c <= 2 ? 3 : 2};
            const auto row = [&](int i) { return Vec3<double>{at(a[i], b[0]), at(a[i], b[1]), at(a[i], b[2])}; };
            cofactor[r][c] = dot(row(0), cross(row(1), row(2))) * ((r + c) % 2 == 0 ? 1 : -1);
        }
    double det = 0;
    for (int c = 0; c < 4; ++c) det += at(0, c) * cofactor[0][c];
    Mat4<double> out;
    for (int c = 0; c < 4; ++c)
        out.columns[c] = Vec4<double>{cofactor[c][0], cofactor[c][1], cofactor[c][2], cofactor[c][3]} / det;
    return out;
}

inline Mat4<double> transpose(const Mat4<double>& m) {
    const auto& c = m.columns;
    return {{{c[0].x, c[1].x, c[2].x, c[3].x},
             {c[0].y, c[1].y, c[2].y, c[3].y},
             {c[0].z, c[1].z, c[2].z, c[3].z},
             {c[0].w, c[1].w, c[2].w, c[3].w}}};
}

// World to view: the eye looks along -z.
inline Mat4<double> look_at(const Vec3<double>& eye, const Vec3<double>& target, const Vec3<double>& up) {
    const Vec3<double> back = normalize(eye - target), right = normalize(cross(up, back)), top = cross(back, right);
    return {{{right.x, top.x, back.x, 0},
             {right.y, top.y, back.y, 0},
             {right.z, top.z, back.z, 0},
             {-dot(right, eye), -dot(top, eye), -dot(back, eye), 1}}};
}

inline Mat4<double> perspective(double half_angle, double near, double far) {
    const double f = 1 / std::tan(half_angle);
    return {{{f, 0, 0, 0}, {0, -f, 0, 0}, {0, 0, far / (near - far), -1}, {0, 0, near * far / (near - far), 0}}};
}

inline Mat4<double> orthographic(double half_side, double near, double far) {
    return {{{1 / half_side, 0, 0, 0}, {0, -1 / half_side, 0, 0}, {0, 0, 1 / (near - far), 0}, {0, 0, near / (near - far), 1}}};
}

// World to clip of one face of a cube map about `centre`: +x, -x, +y, -y, +z, -z (Vulkan specification, "Cube Map Face
// Selection"); depth far / (far - near) - far near / ((far - near) z).
inline Mat4<double> cube_face(int face, const Vec3<double>& centre, double near, double far) {
    static constexpr double s[6][3] = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
    static constexpr double t[6][3] = {{0, -1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, -1, 0}, {0, -1, 0}};
    static constexpr double m[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const double scale = far / (far - near), at[3] = {centre.x, centre.y, centre.z};
    Mat4<double> out{};
    Vec4<double>& last = out.columns[3];
    for (int k = 0; k < 3; ++k) {
        out.columns[k] = {s[face][k], t[face][k], scale * m[face][k], m[face][k]};
        last = last - out.columns[k] * at[k];
    }
    last.z -= scale * near;
    return out;
}

// ---- triangles to fragments ----

struct RasterTriangle {
    Vec4<double> clip[3];
};

struct Fragment {
    int triangle = -1;  // -1: nothing here
    bool front = false;
    double depth = 1;
    double margin = 1;  // how near a triangle was to being cut away here, or to not being
    // Weights of the corners at the pixel's centre, and a step to the right and down of it.
    std::array<double, 3> weight{}, right{}, down{};
};

// A device may move each vertex to a grid of 2^-8 of a pixel (subPixelPrecisionBits), and with them whatever is between.
inline constexpr double pixel_step = 1.0 / 256;

// opacity: callable (triangle, weights) -> how far above the least opacity that is drawn; below 0 there is a hole.
template <class Opacity>
std::vector<Fragment> rasterise(const std::vector<RasterTriangle>& triangles, int width, int height, const Opacity& opacity) {
    std::vector<Fragment> out(static_cast<size_t>(width) * static_cast<size_t>(height));
    for (size_t index = 0; index < triangles.size(); ++index) {
        const Vec4<double>* p = triangles[index].clip;
        const Vec3<double> corner[3] = {{p[0].x, p[0].y, p[0].w}, {p[1].x, p[1].y, p[1].w}, {p[2].x, p[2].y, p[2].w}};
        const double det = dot(corner[0], cross(corner[1], corner[2]));
        if (det == 0) continue;
        const Vec3<double> rows[3] = {cross(corner[1], corner[2]) / det, cross(corner[2], corner[0]) / det,
                                      cross(corner[0], corner[1]) / det};
        int x0 = 0, y0 = 0, x1 = width - 1, y1 = height - 1;
        if (p[0].w > 0 && p[1].w > 0 && p[2].w > 0) {
            double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
            for (int k = 0; k < 3; ++k) {
                const double at[2] = {(p[k].x / p[k].w + 1) / 2 * width, (p[k].y / p[k].w + 1) / 2 * height};
                for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
            }
            const auto limit = [](double v, int n) { return static_cast<int>(std::clamp<double>(std::floor(v), 0, n - 1)); };
            if (high[0] < 0 || high[1] < 0 || low[0] > width || low[1] > height) continue;
            x0 = limit(low[0] - 1, width), x1 = limit(high[0] + 1, width);
            y0 = limit(low[1] - 1, height), y1 = limit(high[1] + 1, height);
        }
        const auto edges = [&](double px, double py) {
            const Vec3<double> at{2 * px / width - 1, 2 * py / height - 1, 1};
            return std::array<double, 3>{dot(rows[0], at), dot(rows[1], at), dot(rows[2], at)};
        };
        const auto weights = [](const std::array<double, 3>& e) {
            const double w = 1 / (e[0] + e[1] + e[2]);
            return std::array<double, 3>{e[0] * w, e[1] * w, e[2] * w};
        };
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const std::array<double, 3> e = edges(x + 0.5, y + 0.5);
                if (e[0] < 0 || e[1] < 0 || e[2] < 0) continue;
                const double depth = e[0] * p[0].z + e[1] * p[1].z + e[2] * p[2].z;
                Fragment& f = out[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
                if (depth < 0 || depth > 1) continue;
                const double opaque = opacity(index, weights(e));
                f.margin = std::min(f.margin, std::fabs(opaque));
                if (opaque < 0 || (f.triangle >= 0 && depth >= f.depth)) continue;
                f.triangle = static_cast<int>(index);
                f.depth = depth;
                // Counter-clockwise is front; with y down its determinant is negative.
                f.front = det < 0;
                f.weight = weights(e);
                f.right = weights(edges(x + 0.5 + pixel_step, y + 0.5));
                f.down = weights(edges(x + 0.5, y + 0.5 + pixel_step));
            }
    }
    return out;
}

inline std::vector<Fragment> rasterise(const std::vector<RasterTriangle>& triangles, int width, int height) {
    return rasterise(triangles, width, height, [](size_t, const std::array<double, 3>&) { return 1.0; });
}

// What a device may make of one varying there: its vertices moved and wrong by their own errors, eight roundings between.
// (Vulkan bounds no interpolation; a plane's equation and the division by the sum of weights have about as many.)
inline Bounded interpolated(const Fragment& f, const Bounded& a, const Bounded& b, const Bounded& c) {
    const auto at = [&](const std::array<double, 3>& w) { return w[0] * a.value + w[1] * b.value + w[2] * c.value; };
    const double here = at(f.weight), largest = std::max({std::fabs(a.value), std::fabs(b.value), std::fabs(c.value)});
    const double moved = std::fabs(at(f.right) - here) + std::fabs(at(f.down) - here);
    return {here, 1.01 * moved + std::max({a.error, b.error, c.error}) + 8 * bounds::ulp * largest};
}

// Depth of all triangles seen with a matrix: 1 where there is nothing.
inline std::vector<float> depths_of(const std::vector<std::array<Vec3<double>, 3>>& world, const Mat4<double>& clip_of_world,
                                    int size) {
    std::vector<RasterTriangle> triangles;
    for (const auto& t : world) {
        RasterTriangle r;
        for (size_t k = 0; k < 3; ++k) r.clip[k] = clip_of_world * Vec4<double>{t[k].x, t[k].y, t[k].z, 1};
        triangles.push_back(r);
    }
    std::vector<float> out;
    for (const Fragment& f : rasterise(triangles, size, size)) out.push_back(static_cast<float>(f.depth));
    return out;
}

}  // namespace kiln::reference
