// The scene's textures: waves where any smooth picture will do, and what the lamp sees.

#include <cmath>
#include <functional>

#include "tests/images/scene.h"

namespace kiln::test {

using namespace reference;

namespace {

using Colour = std::array<double, 4>;
using Picture = std::function<Colour(double, double)>;

void append(std::vector<float>& out, const Colour& c) {
    for (const double v : c) out.push_back(static_cast<float>(v));
}

Texture2D texture(long size, bool linear, TextureWrap wrap, const Picture& f) {
    std::vector<float> texels;
    const auto centre = [&](long i) { return (static_cast<double>(i) + 0.5) / static_cast<double>(size); };
    for (long y = 0; y < size; ++y)
        for (long x = 0; x < size; ++x) append(texels, f(centre(x), centre(y)));
    return {size, size, texels, linear, wrap};
}

// Between low and high in slow waves; alpha between 0 and 1.
Picture waves(double low, double high, double phase) {
    return [=](double u, double v) {
        Colour c;
        for (size_t k = 0; k < 4; ++k) {
            const double channel = static_cast<double>(k), p = phase + 1.7 * channel;
            const double wave = 0.5 + 0.25 * (std::sin(2 * pi * u * (channel + 1) + p) + std::cos(2 * pi * (v + u) + 2 * p));
            c[k] = k == 3 ? wave : low + (high - low) * wave;
        }
        return c;
    };
}

// Layers with other waves each, which flatten from mip to mip.
CubeArray make_environment(bool filtered) {
    std::vector<float> texels;
    for (int level = 0; level < sky_levels; ++level)
        for (int layer = 0; layer < 3; ++layer)
            for (int face = 0; face < 6; ++face) {
                const int n = sky_side >> level;
                for (int y = 0; y < n; ++y)
                    for (int x = 0; x < n; ++x) {
                        const V3 d = normalize(cube_direction(face, cube_texel_centre<double>(x, y, n)));
                        const double contrast = 0.8 / (1 + level), phase = 2.1 * layer;
                        const auto wave = [&](double p) {
                            return 1 + contrast * std::sin(3 * d.x + phase + p) * std::cos(2.5 * d.y - d.z + p);
                        };
                        append(texels, {wave(0), wave(1), wave(2), 1});
                    }
            }
    return {sky_side, sky_levels, 3, texels, filtered};
}

Texture2D make_split_sum(bool filtered) {
    std::vector<float> texels;
    for (int y = 0; y < split_sum_side; ++y)
        for (int x = 0; x < split_sum_side; ++x) {
            const V2 at = split_sum_texel(x, y, split_sum_side), ab = split_sum_fit(at.x, at.y);
            append(texels, {ab.x, ab.y, 0, 1});
        }
    return {split_sum_side, split_sum_side, texels, filtered, TextureWrap::clamp};
}

// ---- shadows ----

std::vector<std::array<V3, 3>> in_world(const Mesh& mesh, const M4& model) {
    std::vector<std::array<V3, 3>> out;
    for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
        std::array<V3, 3> t;
        for (size_t k = 0; k < 3; ++k) {
            const V3& p = mesh.vertices[i + k].position;
            t[k] = (model * V4{p.x, p.y, p.z, 1}).xyz();
        }
        out.push_back(t);
    }
    return out;
}

// (q, q^2) of a depth (uber/lib/vsm.glsl): of depth itself under a sun, else of distance.
V2 moments_of(float depth, bool directional, double reference) {
    const double d = static_cast<double>(depth);
    const double q = (directional ? d : light_distance(d, shadow_near, shadow_far) / shadow_far) - reference;
    return {q, q * q};
}

struct Shadows {
    std::shared_ptr<const DepthMap> map;
    std::vector<std::vector<float>> mips;  // of moments, four floats a texel
    std::vector<float> sums;
    DepthCube cube;
    std::vector<float> cube_moments;
    std::vector<DepthMap> cascades;
};

Shadows make_shadows(const Mesh& mesh, const SurfaceBlocks& b, bool directional) {
    const std::vector<std::array<V3, 3>> world = in_world(mesh, b.model);
    const auto depth_map = [&](const M4& matrix, int size) {
        return DepthMap(static_cast<size_t>(size), static_cast<size_t>(size), depths_of(world, matrix, size));
    };
    Shadows out;
    out.map = std::make_shared<DepthMap>(depth_map(b.shadow_view_projection, shadow_size));
    constexpr size_t n = moments_size;
    std::vector<float> level;
    std::vector<V2> sums(n * n);
    const DepthMap coarse = depth_map(b.shadow_view_projection, moments_size);
    for (size_t y = 0; y < n; ++y)
        for (size_t x = 0; x < n; ++x) {
            const V2 m = moments_of(coarse.texels()[y * n + x], directional, b.moments_reference);
            append(level, {m.x, m.y, 0, 1});
            V2& sum = sums[y * n + x];
            sum = m;
            if (x > 0) sum = sum + sums[y * n + x - 1];
            if (y > 0) sum = sum + sums[(y - 1) * n + x];
            if (x > 0 && y > 0) sum = sum - sums[(y - 1) * n + x - 1];
            append(out.sums, {sum.x, sum.y, 0, 1});
        }
    for (size_t side = n; out.mips.size() < static_cast<size_t>(b.moments_levels); side /= 2) {
        out.mips.push_back(level);
        std::vector<float> next;
        for (size_t y = 0; y < side / 2; ++y)
            for (size_t x = 0; x < side / 2; ++x)
                for (size_t c = 0; c < 4; ++c) {
                    const auto at = [&](size_t dx, size_t dy) { return level[((2 * y + dy) * side + 2 * x + dx) * 4 + c]; };
                    next.push_back(0.25f * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)));
                }
        level = std::move(next);
    }
    std::vector<DepthMap> faces;
    for (int f = 0; f < 6; ++f) {
        faces.push_back(depth_map(cube_face(f, b.light_position, shadow_near, shadow_far), face_size));
        for (const float depth : faces.back().texels()) {
            const V2 m = moments_of(depth, false, b.moments_reference);
            append(out.cube_moments, {m.x, m.y, 0, 1});
        }
    }
    out.cube = DepthCube(std::move(faces));
    for (const M4& matrix : b.cascade_view_projection) out.cascades.push_back(depth_map(matrix, cascade_size));
    return out;
}

}  // namespace

Maps make_maps(const Mesh& mesh, bool directional, bool filtered) {
    Maps m;
    m.base_map = texture(64, filtered, TextureWrap::repeat, waves(0.1, 0.9, 0.3));
    m.specular_map = texture(64, filtered, TextureWrap::repeat, waves(0.02, 0.35, 1.1));
    m.gloss_map = texture(32, filtered, TextureWrap::repeat, waves(0.3, 0.95, 2.0));
    // Steps: a texel belongs to one place or another.
    m.roughness_map = texture(8, false, TextureWrap::repeat, waves(0.15, 1.0, 2.9));
    m.metallic_map = texture(8, false, TextureWrap::repeat, [](double u, double v) {
        const double x = static_cast<int>(u * 8 + v * 16) % 3 / 2.0;
        return Colour{x, x, x, 1};
    });
    const Picture tilts = waves(0.3, 0.7, 0.9);
    m.normal_map = texture(64, filtered, TextureWrap::repeat, [&](double u, double v) {
        const Colour c = tilts(u, v);
        return Colour{c[0], c[1], 0.95, 1};
    });
    m.lightmap_flat = texture(64, filtered, TextureWrap::clamp, waves(0.1, 0.9, 3.3));
    m.lightmap_l0 = texture(64, filtered, TextureWrap::clamp, waves(0.5, 3.0, 4.1));
    m.lightmap_l1_y = texture(64, filtered, TextureWrap::clamp, waves(0.3, 0.9, 5.0));
    m.lightmap_l1_z = texture(64, filtered, TextureWrap::clamp, waves(0.2, 0.8, 5.7));
    m.lightmap_l1_x = texture(64, filtered, TextureWrap::clamp, waves(0.2, 0.8, 6.1));
    m.environment_maps = make_environment(filtered);
    m.split_sum_table = make_split_sum(filtered);
    static const Shadows sun = make_shadows(mesh, make_blocks(true), true), spot = make_shadows(mesh, make_blocks(false), false);
    const Shadows& shadows = directional ? sun : spot;
    m.shadow_map = shadows.map;
    m.shadow_cube = shadows.cube;
    m.cascade_maps = shadows.cascades;
    std::vector<Texture2D> levels;
    for (const std::vector<float>& level : shadows.mips) {
        const long side = moments_size >> levels.size();
        levels.emplace_back(side, side, level, filtered, TextureWrap::clamp);
    }
    m.moment_mips = MomentMips(std::move(levels));
    m.moment_sums = {moments_size, moments_size, shadows.sums, false, TextureWrap::clamp};
    m.moments_cube_map = {face_size, 1, 1, shadows.cube_moments, filtered};
    return m;
}

}  // namespace kiln::test
