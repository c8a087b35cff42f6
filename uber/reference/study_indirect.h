#pragma once
// Light that has met a surface before, as uber/study_indirect.frag has it: the form by its name in manifests/library.yaml.

#include <string>
#include <vector>

#include "uber/reference/bounded.h"
#include "uber/reference/gi_ambient.h"
#include "uber/reference/gi_cones.h"
#include "uber/reference/gi_rsm.h"
#include "uber/reference/gi_sampling.h"
#include "uber/reference/gi_screen.h"
#include "uber/reference/gi_sdf.h"
#include "uber/reference/texture.h"
#include "uber/reference/vectors.h"

namespace kiln::reference {

struct IndirectBlock {
    Mat4<double> screen_projection;
    Vec3<double> ambient, wall_albedo, lamp_bearing;
    double reach = 0, tangent = 0, thickness = 0;
};

// A cube of voxels with mips, four floats each, trilinear and clamped. What a read may be off by is counted by the level's
// steepest step, whichever cell it may fall into.
class VoxelCube {
public:
    VoxelCube() = default;
    VoxelCube(int side, int levels, const std::vector<float>& texels) : side_(side), texels_(texels) {
        size_t at = 0;
        for (int l = 0; l < levels; ++l) {
            const long n = side >> l;
            first_.push_back(at);
            double steepest = 0, largest = 0;
            for (long z = 0; z < n; ++z)
                for (long y = 0; y < n; ++y)
                    for (long x = 0; x < n; ++x)
                        for (size_t c = 0; c < 4; ++c) {
                            const double here = texel(l, x, y, z, c);
                            largest = std::max(largest, std::fabs(here));
                            for (const double next :
                                 {texel(l, x + 1, y, z, c), texel(l, x, y + 1, z, c), texel(l, x, y, z + 1, c)})
                                steepest = std::max(steepest, std::fabs(next - here));
                        }
            steepest_.push_back(steepest);
            largest_.push_back(largest);
            at += static_cast<size_t>(n * n * n) * 4;
        }
    }
    int side() const { return side_; }
    int levels() const { return static_cast<int>(first_.size()); }
    const std::vector<float>& texels() const { return texels_; }

    template <class T>
    Vec4<T> operator()(const Vec3<T>& uvw, const T& level) const {
        return between_levels(level, levels(), true, [&](int l) { return read(uvw, l); });
    }

private:
    double texel(int level, long x, long y, long z, size_t c) const {
        const long n = side_ >> level;
        const auto inside = [&](long i) { return std::clamp<long>(i, 0, n - 1); };
        const size_t at = static_cast<size_t>((inside(z) * n + inside(y)) * n + inside(x));
        return static_cast<double>(texels_[first_[static_cast<size_t>(level)] + 4 * at + c]);
    }
    template <class T>
    Vec4<T> read(const Vec3<T>& uvw, int level) const {
        const double n = side_ >> level;
        const double x = value(uvw.x) * n - 0.5, y = value(uvw.y) * n - 0.5, z = value(uvw.z) * n - 0.5;
        const long i = static_cast<long>(std::floor(x)), j = static_cast<long>(std::floor(y)),
                   k = static_cast<long>(std::floor(z));
        const size_t l = static_cast<size_t>(level);
        const double moved = (error_of(uvw.x) + error_of(uvw.y) + error_of(uvw.z)) * n + 3 * texel_step;
        const double slack = moved * steepest_[l] + 16 * bounds::ulp * largest_[l];
        const auto channel = [&](size_t c) {
            double sum = 0;
            for (unsigned corner = 0; corner < 8; ++corner) {
                const bool a = (corner & 1) != 0, b = (corner & 2) != 0, d = (corner & 4) != 0;
                const auto weight = [](double at, long low, bool high) {
                    const double part = at - static_cast<double>(low);
                    return high ? part : 1 - part;
                };
                sum += weight(x, i, a) * weight(y, j, b) * weight(z, k, d) *
                       texel(level, i + (a ? 1 : 0), j + (b ? 1 : 0), k + (d ? 1 : 0), c);
            }
            return loosened(T(sum), slack);
        };
        return {channel(0), channel(1), channel(2), channel(3)};
    }
    int side_ = 0;
    std::vector<float> texels_;
    std::vector<size_t> first_;
    std::vector<double> steepest_, largest_;
};

struct IndirectMaps {
    Texture2D rsm_position, rsm_facing, rsm_intensity, scene_depth, scene_radiance;  // the first three of 8 x 8
    VoxelCube radiance_volume, distance_field;
};

template <class T>
Vec3<T> study_indirect(const std::string& form, const IndirectBlock& b, const IndirectMaps& maps, const Vec2<T>& uv) {
    constexpr int rsm_size = 8, rsm_taps = 8, cone_steps = 12, sdf_cones = 4, sdf_steps = 12, screen_rays = 2, screen_steps = 8;
    const auto vector = [](const Vec3<double>& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const Vec3<T> n{T(0), T(1), T(0)}, x{uv.x - T(0.5), T(-0.5), uv.y - T(0.5)}, half = splat3(T(0.5));
    const Vec3<T> ambient = vector(b.ambient), albedo = vector(b.wall_albedo);
    const T reach(b.reach);
    uint32_t state = 7;
    const auto fetch = [](const Texture2D& map, long i, long j) {
        return Vec4<T>{T(map.texel(i, j, 0)), T(map.texel(i, j, 1)), T(map.texel(i, j, 2)), T(map.texel(i, j, 3))};
    };
    const auto gathered = [&]() -> Vec3<T> {
        if (form == "ambient") return ambient_radiance(splat3(T(1)), ambient, uv.y) * T(pi);
        if (form == "multibounce") return ambient * multibounce_visibility(uv.y, albedo * uv.x);
        if (form == "interreflection") return interreflection(ambient, albedo * uv.x, to_int(T(8) * uv.y));
        if (form == "rsm_all")
            return rsm_gather_all([&](int i, int j) { return fetch(maps.rsm_position, i, j); },
                                  [&](int i, int j) { return fetch(maps.rsm_facing, i, j).xyz(); },
                                  [&](int i, int j) { return fetch(maps.rsm_intensity, i, j).xyz(); }, x, n, rsm_size);
        if (form == "rsm_taps") {
            Vec3<T> sum = splat3(T(0));
            for (int i = 0; i < rsm_taps; ++i) {
                const Vec3<T> tap =
                    rsm_tap(gi_hammersley(i, rsm_taps, Vec2<T>{T(0.28125), T(0.0625)}), min(reach, T(0.5)), T(rsm_size));
                const Vec2<T> at = uv + tap.xy();
                if (at.x < T(0) || at.y < T(0) || at.x >= T(1) || at.y >= T(1)) continue;
                const int px = to_int(at.x * T(rsm_size)), py = to_int(at.y * T(rsm_size));
                const Vec4<T> y = fetch(maps.rsm_position, px, py);
                sum = sum + rsm_irradiance(x, n, y.xyz(), fetch(maps.rsm_facing, px, py).xyz(),
                                           fetch(maps.rsm_intensity, px, py).xyz(), y.w) *
                                tap.z;
            }
            return sum / T(rsm_taps);
        }
        const auto radiance = [&](const Vec3<T>& at, const T& level) { return maps.radiance_volume(at, level); };
        const T voxel(1.0 / maps.radiance_volume.side());
        if (form == "cones") {
            Vec3<T> sum = splat3(T(0));
            for (int i = 0; i < 6; ++i) {
                const Vec4<T> cone = cone_of_six(i, n);
                sum = sum + cone_march(radiance, x + half + n * voxel, cone.xyz(), T(1 / std::sqrt(3.0)), voxel, voxel, reach,
                                       cone_steps)
                                    .xyz() *
                                cone.w;
            }
            return sum * T(pi);
        }
        if (form == "screen") {
            Mat4<T> projection;
            for (size_t c = 0; c < 4; ++c) {
                const Vec4<double>& v = b.screen_projection.columns[c];
                projection.columns[c] = {T(v.x), T(v.y), T(v.z), T(v.w)};
            }
            const Vec3<T> at{uv.x - T(0.5), -(uv.y - T(0.5)), T(-1.5)}, towards{T(0), T(0), T(1)};
            const auto depth = [&](const Vec2<T>& p) { return maps.scene_depth.channel(p, 0); };
            const T first(gi_random(state)), second(gi_random(state));
            const Vec2<T> shift{first, second};
            Vec3<T> sum = splat3(T(0));
            for (int i = 0; i < screen_rays; ++i) {
                const Vec3<T> direction = gi_cosine_direction(gi_hammersley(i, screen_rays, shift), towards);
                const T jitter(gi_random(state));
                Vec2<T> hit;
                if (screen_march(depth, projection, at + towards * (T(2e-3) * -at.z), direction, reach, T(b.thickness), jitter,
                                 hit, screen_steps))
                    sum = sum + maps.scene_radiance.rgb(hit);
            }
            return sum * T(pi) / T(screen_rays);
        }
        const auto field = [&](const Vec3<T>& p) {
            const Vec3<T> inside = min(max(p, -half), half);
            const Vec3<T> out = p - inside;
            const bool within = value(out.x) == 0 && value(out.y) == 0 && value(out.z) == 0;
            const T away = within ? loosened(T(0), error_of(p.x) + error_of(p.y) + error_of(p.z)) : length(out);
            return maps.distance_field(inside + half, T(0)).x + away;
        };
        const T texel(1.0 / maps.distance_field.side()), near = T(0.5) * texel;
        if (form == "sdf_cones") {
            const T first(gi_random(state)), second(gi_random(state));
            const Vec2<T> shift{first, second};
            const double cosine = 1 - 1.0 / sdf_cones;
            const T tangent(std::sqrt(1 - cosine * cosine) / cosine);
            const Vec3<T> origin = x + n * (T(2) * near);
            Vec3<T> sum = splat3(T(0));
            for (int i = 0; i < sdf_cones; ++i) {
                const Vec3<T> direction = gi_cosine_direction(gi_hammersley(i, sdf_cones, shift), n);
                const T t = sdf_trace(field, origin, direction, T(0), reach, near, sdf_steps);
                if (t < T(0)) continue;
                const Vec4<T> there = radiance(origin + direction * t + half, log2(max(T(2) * t * tangent / voxel, T(1))));
                sum = sum + there.xyz() / there.w;
            }
            return sum * T(pi) / T(sdf_cones);
        }
        const Vec3<T> l = safe_normalize(vector(b.lamp_bearing), n), origin = x + n * texel;
        const T tangent(b.tangent);
        return ambient * (form == "sdf_visibility"
                              ? sdf_visibility(field, origin, l, tangent, T(0), reach, near, sdf_steps)
                              : sdf_soft_visibility(field, origin, l, T(1) / tangent, T(0), reach, near, sdf_steps));
    };
    return gathered() / T(pi);
}

}  // namespace kiln::reference
