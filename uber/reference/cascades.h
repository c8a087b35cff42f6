#pragma once
// Cascades: the choice of slices as uber/lib/cascades.glsl names it, and the processor's side of them, which has no GLSL:
// where to split, and matrices that keep a standing edge on the same texels while the camera moves.

#include <array>
#include <vector>

#include "uber/reference/shadow_receiver.h"

namespace kiln::reference {

template <class T>
int cascade_index(const T& depth, const Vec4<T>& ends, int count) {
    const T end[] = {ends.x, ends.y, ends.z, ends.w};
    for (int i = 0; i + 1 < count; ++i)
        if (depth < end[i]) return i;
    return depth <= end[count - 1] ? count - 1 : -1;
}

template <class T>
T cascade_blend(const T& depth, const T& start, const T& end, const T& band) {
    const T width = band * (end - start);
    return saturate((depth - (end - width)) / max(width, T(1e-6)));
}

template <class T>
struct CascadeChoice {
    int index = -1, next = -1;
    T blend{};
};

template <class T>
CascadeChoice<T> choose_cascade(const T& depth, const T& start, const Vec4<T>& ends, int count, const T& band) {
    const T bounds[] = {start, ends.x, ends.y, ends.z, ends.w};
    CascadeChoice<T> choice;
    choice.index = cascade_index(depth, ends, count);
    if (choice.index < 0) return choice;
    choice.blend = cascade_blend(depth, bounds[choice.index], bounds[choice.index + 1], band);
    choice.next = choice.index + 1 < count ? choice.index + 1 : -1;
    return choice;
}

// maps: callable (layer, uv, depth) -> 1 lit or 0.
template <class T, class Compare>
T cascade_factor(const Compare& maps, const Vec4<T>& clip, int layer, const T& bias) {
    const Vec4<T> place = shadow_coordinates(clip);
    return place.w > T(0) ? maps(layer, place.xy(), place.z - bias) : T(1);
}

// texel: callable (layer, column, row, depth) -> 1 lit or 0, clamped to the layer's edge; size: of a side.
template <class T, class Compare>
T cascade_factor_gathered_linear(const Compare& texel, int size, const Vec4<T>& clip, int layer, const T& bias) {
    const Vec4<T> place = shadow_coordinates(clip);
    const auto row = [&](int x, int y, const T& w) {
        return mix(texel(layer, x, y, place.z - bias), texel(layer, x + 1, y, place.z - bias), w);
    };
    const T x = place.x * T(size) - T(0.5), y = place.y * T(size) - T(0.5), left = floor(x), top = floor(y);
    const int i = to_int(left), j = to_int(top);
    return place.w > T(0) ? mix(row(i, j, x - left), row(i, j + 1, x - left), y - top) : T(1);
}

template <class T, class Compare>
T cascaded_shadow(const Compare& maps, const Vec4<T>& clip, const Vec4<T>& next_clip, const Vec2<T>& bias,
                  const CascadeChoice<T>& choice) {
    if (choice.index < 0) return T(1);
    const T own = cascade_factor(maps, clip, choice.index, bias.x);
    if (!(choice.blend > T(0))) return own;
    return mix(own, choice.next < 0 ? T(1) : cascade_factor(maps, next_clip, choice.next, bias.y), choice.blend);
}

// As a renderer calls it.
template <class T, class Compare>
T cascaded_shadow(const Compare& maps, const std::array<Mat4<T>, 4>& clip_of_world, const Vec4<T>& bias, const Vec3<T>& receiver,
                  const CascadeChoice<T>& choice) {
    const T biases[] = {bias.x, bias.y, bias.z, bias.w};
    const Vec4<T> world{receiver.x, receiver.y, receiver.z, T(1)};
    const auto own = static_cast<size_t>(std::max(choice.index, 0)), next = static_cast<size_t>(std::max(choice.next, 0));
    return cascaded_shadow(maps, clip_of_world[own] * world, clip_of_world[next] * world, Vec2<T>{biases[own], biases[next]},
                           choice);
}

// Zhang et al. 2006, the practical scheme: where `count` slices of [near, far] end. lambda: 0 equal, 1 logarithmic; 0.5 to 0.75
// is common. The last is far, exactly.
inline std::vector<double> practical_splits(double near, double far, int count, double lambda) {
    std::vector<double> ends;
    for (int i = 1; i < count; ++i) {
        const double part = static_cast<double>(i) / count;
        ends.push_back(lambda * near * std::pow(far / near, part) + (1 - lambda) * (near + (far - near) * part));
    }
    ends.push_back(far);
    return ends;
}

// The smallest sphere about a frustum's slice, whose centre is on the axis: its size depends on the frustum alone, so that it
// does not change as the camera turns. depth: of the centre, in view space.
struct BoundingSphere {
    double depth = 0, radius = 0;
};

// tan_x, tan_y: tangents of half the field of view.
inline BoundingSphere slice_sphere(double start, double end, double tan_x, double tan_y) {
    const double k = tan_x * tan_x + tan_y * tan_y;
    const double even = (start + end) / 2 * (1 + k);  // equally far from the near and the far corners
    if (even >= end) return {end, end * std::sqrt(k)};
    return {even, std::sqrt((end - even) * (end - even) + end * end * k)};
}

// A light's axes: unit, at right angles; forward the way light travels, right along u, down along v.
struct LightAxes {
    Vec3<double> right, down, forward;
};

// Axes that depend on the light's direction alone.
inline LightAxes light_axes(const Vec3<double>& direction) {
    const Vec3<double> forward = normalize(direction);
    const Vec3<double> other = std::fabs(forward.y) < 0.9 ? Vec3<double>{0, 1, 0} : Vec3<double>{1, 0, 0};
    const Vec3<double> right = normalize(cross(other, forward));
    return {right, cross(forward, right), forward};
}

struct CascadeFit {
    Mat4<double> clip_of_world;
    double texel = 0;    // metres
    double range = 0;    // metres of depth 0 to 1
    double origin[2]{};  // of uv 0 along right and down, a whole number of texels
};

// An orthographic map of size x size texels about a sphere, `casters` metres deeper towards the light. A texel is
// 2 r / (size - 1), so that one texel is left over, and the origin is rounded down to whole texels: it uses up what is left
// over and moves by whole texels only.
inline CascadeFit fit_cascade(const Vec3<double>& centre, double radius, const LightAxes& light, int size, double casters) {
    CascadeFit fit;
    fit.texel = 2 * radius / (size - 1);
    const Vec3<double> axes[] = {light.right, light.down};
    const double side = size * fit.texel;
    Vec4<double> rows[3];
    for (int k = 0; k < 2; ++k) {
        fit.origin[k] = std::floor((dot(axes[k], centre) - radius) / fit.texel) * fit.texel;
        const Vec3<double> row = axes[k] * (2 / side);
        rows[k] = {row.x, row.y, row.z, -2 * fit.origin[k] / side - 1};
    }
    fit.range = 2 * radius + casters;
    const Vec3<double> row = light.forward / fit.range;
    rows[2] = {row.x, row.y, row.z, -(dot(light.forward, centre) - radius - casters) / fit.range};
    fit.clip_of_world = {{{rows[0].x, rows[1].x, rows[2].x, 0},
                          {rows[0].y, rows[1].y, rows[2].y, 0},
                          {rows[0].z, rows[1].z, rows[2].z, 0},
                          {rows[0].w, rows[1].w, rows[2].w, 1}}};
    return fit;
}

}  // namespace kiln::reference
