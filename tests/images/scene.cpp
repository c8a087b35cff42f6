#include "tests/images/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace kiln::test {

using namespace reference;

double f32(double x) { return static_cast<double>(static_cast<float>(x)); }
V3 f32(const V3& v) {
    return map(v, [](double x) { return f32(x); });
}
M4 f32(const M4& m) {
    M4 out = m;
    for (V4& c : out.columns) c = map(c, [](double x) { return f32(x); });
    return out;
}

namespace {

constexpr V3 lamp{-2.6, 4.2, 2.8}, middle{0, 1, 0};
constexpr double shadow_near = 0.5, shadow_far = 20, spot_half_angle = 0.42, sun_half_side = 5;
constexpr int shadow_size = 256, face_size = 256;

Mesh make_mesh() {
    Mesh mesh;
    const auto add = [&](int body, const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {  // seen from outside
        for (const Vertex& v : {a, b, c, a, c, d}) {
            Vertex r = v;
            r.position = f32(v.position);
            r.normal = f32(v.normal);
            r.uv = map(v.uv, [](double x) { return f32(x); });
            r.lightmap_uv = map(v.lightmap_uv, [](double x) { return f32(x); });
            mesh.vertices.push_back(r);
        }
        mesh.body.push_back(body);
        mesh.body.push_back(body);
    };
    const auto chart = [](double s, double t, double left) {
        return std::pair{V2{0.03 + 0.94 * s, 0.03 + 0.94 * t}, V2{left + 0.3 * s, 0.03 + 0.94 * t}};
    };
    constexpr int columns = 64, rows = 32;
    const auto on_sphere = [&](int i, int j) {
        // The seam of uv is at the back.
        const double a = 2 * pi * i / columns + pi, b = pi * j / rows;
        const V3 n{std::sin(b) * std::sin(a), std::cos(b), std::sin(b) * std::cos(a)};
        const auto [uv, lightmap] = chart(static_cast<double>(i) / columns, static_cast<double>(j) / rows, 0.02);
        return Vertex{middle + n, n, uv, lightmap};
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            add(sphere, on_sphere(i, j), on_sphere(i, j + 1), on_sphere(i + 1, j + 1), on_sphere(i + 1, j));
    const auto on_plane = [&](int i, int j) {
        const auto [uv, lightmap] = chart(i / 12.0, j / 12.0, 0.35);
        return Vertex{{i - 6.0, 0, j - 6.0}, {0, 1, 0}, uv, lightmap};
    };
    for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) add(plane, on_plane(i, j), on_plane(i, j + 1), on_plane(i + 1, j + 1), on_plane(i + 1, j));
    // Its back to the camera, leaning.
    const V3 right = normalize(V3{0.9, 0.1, 0.35}), top = normalize(V3{-0.2, 1, 0.3}), n = normalize(cross(top, right));
    const auto on_card = [&](double s, double t) {
        const auto [uv, lightmap] = chart(s, t, 0.68);
        return Vertex{V3{1.75, 0.95, 0.9} + right * (1.1 * (s - 0.5)) + top * (1.3 * (t - 0.5)), n, uv, lightmap};
    };
    add(card, on_card(0, 0), on_card(0, 1), on_card(1, 1), on_card(1, 0));
    return mesh;
}

M4 turned(double angle, const V3& scale, const V3& move) {
    const double c = std::cos(angle), s = std::sin(angle);
    return f32(M4{
        {{c * scale.x, 0, -s * scale.x, 0}, {0, scale.y, 0, 0}, {s * scale.z, 0, c * scale.z, 0}, {move.x, move.y, move.z, 1}}});
}

M4 moved(const M4& m, const V4& jitter) {  // by jitter.xy in NDC
    M4 out = m;
    for (V4& c : out.columns) c = {c.x + jitter.x * c.w, c.y + jitter.y * c.w, c.z, c.w};
    return out;
}

SurfaceBlocks make_blocks(bool directional) {
    SurfaceBlocks b;
    const auto camera = [](const V3& eye) { return perspective(0.27, 0.5, 40) * look_at(eye, {0.1, 0.75, 0}, {0, 1, 0}); };
    b.jitter = {f32(0.0021), f32(-0.0013), f32(-0.0017), f32(0.0009)};
    b.camera_position = f32(V3{0.3, 2.4, 6.4});
    b.view_projection = f32(moved(camera(b.camera_position), b.jitter));
    b.previous_view_projection = f32(moved(camera({0.42, 2.36, 6.5}), {b.jitter.z, b.jitter.w, 0, 0}));
    b.ambient_irradiance = f32(V3{0.42, 0.5, 0.62});
    b.light_position = f32(lamp);
    b.light_direction = f32(normalize(middle - lamp));
    const double power = directional ? 2.6 : 68;
    b.light_intensity = f32(V3{power, power * 0.96, power * 0.88});
    b.light_range = 25;
    b.light_cos_inner = f32(std::cos(spot_half_angle * 0.6));
    b.light_cos_outer = f32(std::cos(spot_half_angle));
    const V3 direction = normalize(middle - lamp);
    const M4 sun = orthographic(sun_half_side, shadow_near, shadow_far) * look_at(middle - direction * 8.0, middle, {0, 1, 0});
    const double spread = spot_half_angle * 1.1;
    const M4 spot = perspective(spread, shadow_near, shadow_far) * look_at(lamp, middle, {0, 1, 0});
    b.shadow_view_projection = f32(directional ? sun : spot);
    b.shadow_near = shadow_near;
    b.shadow_far = shadow_far;
    b.shadow_texel = f32(directional ? 2 * sun_half_side / shadow_size : 2.0 / face_size);  // a face of the cube is coarsest
    b.shadow_depth_bias = f32(2e-4);
    b.base_factor = {f32(0.9), f32(1.0), f32(0.95), 1};
    b.specular_factor = {f32(1.0), f32(0.9), f32(0.8), 1};
    b.emissive = f32(V3{0.02, 0.01, 0.03});
    b.dielectric_specular = 0.5;
    b.shininess = 60;
    b.roughness_factor = f32(0.9);
    b.metallic_factor = f32(0.95);
    b.glossiness_factor = f32(0.9);
    b.model = turned(0.3, {1.06, 0.95, 1.0}, {0.05, 0.02, -0.1});
    b.previous_model = turned(0.27, {1.06, 0.95, 1.0}, {0.02, 0.01, -0.1});
    b.lightmap_rect = {f32(0.9), f32(0.8), f32(0.05), f32(0.1)};
    b.lightmap_range = f32(1.7);
    return b;
}

using Colour = std::array<double, 3>;

Texture2D texture(long size, bool linear, TextureWrap wrap, const std::function<Colour(double, double)>& f) {
    std::vector<float> texels;
    for (long y = 0; y < size; ++y)
        for (long x = 0; x < size; ++x) {
            const Colour c = f((static_cast<double>(x) + 0.5) / static_cast<double>(size),
                               (static_cast<double>(y) + 0.5) / static_cast<double>(size));
            for (const double v : c) texels.push_back(static_cast<float>(v));
            texels.push_back(1);
        }
    return {size, size, texels, linear, wrap};
}

// Between low and high in slow waves.
std::function<Colour(double, double)> waves(double low, double high, double phase) {
    return [=](double u, double v) {
        Colour c;
        for (size_t k = 0; k < 3; ++k) {
            const double channel = static_cast<double>(k), p = phase + 1.7 * channel;
            c[k] = low +
                   (high - low) * (0.5 + 0.25 * (std::sin(2 * pi * u * (channel + 1) + p) + std::cos(2 * pi * (v + u) + 2 * p)));
        }
        return c;
    };
}

Maps make_maps(bool filtered) {
    Maps m;
    m.base_map = texture(64, filtered, TextureWrap::repeat, waves(0.1, 0.9, 0.3));
    m.specular_map = texture(64, filtered, TextureWrap::repeat, waves(0.02, 0.35, 1.1));
    m.gloss_map = texture(32, filtered, TextureWrap::repeat, waves(0.3, 0.95, 2.0));
    // Steps: a texel belongs to one place or another.
    m.roughness_map = texture(8, false, TextureWrap::repeat, waves(0.15, 1.0, 2.9));
    m.metallic_map = texture(8, false, TextureWrap::repeat, [](double u, double v) {
        const double x = static_cast<int>(u * 8 + v * 16) % 3 / 2.0;
        return Colour{x, x, x};
    });
    m.lightmap_flat = texture(64, filtered, TextureWrap::clamp, waves(0.1, 0.9, 3.3));
    m.lightmap_l0 = texture(64, filtered, TextureWrap::clamp, waves(0.5, 3.0, 4.1));
    m.lightmap_l1_y = texture(64, filtered, TextureWrap::clamp, waves(0.3, 0.9, 5.0));
    m.lightmap_l1_z = texture(64, filtered, TextureWrap::clamp, waves(0.2, 0.8, 5.7));
    m.lightmap_l1_x = texture(64, filtered, TextureWrap::clamp, waves(0.2, 0.8, 6.1));
    return m;
}

// What the lamp sees, for all scenes of one mesh and lamp.
struct Shadows {
    std::shared_ptr<DepthMap> map;
    DepthCube cube;
};

Shadows make_shadows(const Mesh& mesh, const SurfaceBlocks& b) {
    std::vector<std::array<V3, 3>> world;
    for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
        std::array<V3, 3> t;
        for (size_t k = 0; k < 3; ++k) {
            const V3& p = mesh.vertices[i + k].position;
            t[k] = (b.model * V4{p.x, p.y, p.z, 1}).xyz();
        }
        world.push_back(t);
    }
    const auto depth_map = [&](const M4& matrix, int size) {
        return DepthMap(static_cast<size_t>(size), static_cast<size_t>(size), depths_of(world, matrix, size));
    };
    std::vector<DepthMap> faces;
    for (int f = 0; f < 6; ++f) faces.push_back(depth_map(cube_face(f, b.light_position, shadow_near, shadow_far), face_size));
    return {std::make_shared<DepthMap>(depth_map(b.shadow_view_projection, shadow_size)), DepthCube(std::move(faces))};
}

Scene make_scene(bool directional, bool filtered) {
    Scene s;
    s.mesh = make_mesh();
    s.blocks = make_blocks(directional);
    s.maps = make_maps(filtered);
    static const Shadows sun = make_shadows(s.mesh, make_blocks(true)), spot = make_shadows(s.mesh, make_blocks(false));
    s.maps.shadow_map = directional ? sun.map : spot.map;
    s.maps.shadow_cube = spot.cube;
    return s;
}

}  // namespace

const Scene& scene(bool directional, bool filtered) {
    static const Scene all[2][2] = {{make_scene(false, false), make_scene(false, true)},
                                    {make_scene(true, false), make_scene(true, true)}};
    return all[directional ? 1 : 0][filtered ? 1 : 0];
}

}  // namespace kiln::test
