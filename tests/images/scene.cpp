#include "tests/images/scene.h"

#include <cmath>

#include "uber/reference/cascades.h"

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

constexpr V3 lamp{-2.6, 4.2, 2.8}, middle{0, 1, 0}, camera_target{0.1, 0.75, 0};
constexpr double camera_half_angle = 0.27;
constexpr double spot_half_angle = 0.42, spot_spread = spot_half_angle * 1.1, sun_half_side = 5;

}  // namespace

Mesh make_mesh() {
    Mesh mesh;
    const auto add = [&](int body, const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {  // seen from outside
        for (const Vertex& v : {a, b, c, a, c, d}) {
            Vertex r = v;
            r.position = f32(v.position);
            r.normal = f32(v.normal);
            r.uv = map(v.uv, [](double x) { return f32(x); });
            r.lightmap_uv = map(v.lightmap_uv, [](double x) { return f32(x); });
            r.tangent = map(v.tangent, [](double x) { return f32(x); });
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
        return Vertex{middle + n, n, uv, lightmap, {std::cos(a), 0, -std::sin(a), 1}};
    };
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            add(sphere, on_sphere(i, j), on_sphere(i, j + 1), on_sphere(i + 1, j + 1), on_sphere(i + 1, j));
    const auto on_plane = [&](int i, int j) {
        const auto [uv, lightmap] = chart(i / 12.0, j / 12.0, 0.35);
        return Vertex{{i - 6.0, 0, j - 6.0}, {0, 1, 0}, uv, lightmap, {1, 0, 0, -1}};
    };
    for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) add(plane, on_plane(i, j), on_plane(i, j + 1), on_plane(i + 1, j + 1), on_plane(i + 1, j));
    // Its back to the camera, leaning.
    const V3 right = normalize(V3{0.9, 0.1, 0.35}), top = normalize(V3{-0.2, 1, 0.3}), n = normalize(cross(top, right));
    const auto on_card = [&](double s, double t) {
        const auto [uv, lightmap] = chart(s, t, 0.68);
        return Vertex{V3{1.75, 0.95, 0.9} + right * (1.1 * (s - 0.5)) + top * (1.3 * (t - 0.5)),
                      n,
                      uv,
                      lightmap,
                      {right.x, right.y, right.z, 1}};
    };
    add(card, on_card(0, 0), on_card(0, 1), on_card(1, 1), on_card(1, 0));
    return mesh;
}

namespace {

// Leaning by 0.15 about x, so that no face of a cube map sees the floor at one depth, and turned about y.
M4 turned(double angle, const V3& scale, const V3& move) {
    const double c = std::cos(angle), s = std::sin(angle), a = std::cos(0.15), b = std::sin(0.15);
    const M4 lean{{{1, 0, 0, 0}, {0, a, b, 0}, {0, -b, a, 0}, {move.x, move.y, move.z, 1}}};
    return f32(lean *
               M4{{{c * scale.x, 0, -s * scale.x, 0}, {0, scale.y, 0, 0}, {s * scale.z, 0, c * scale.z, 0}, {0, 0, 0, 1}}});
}

M4 moved(const M4& m, const V4& jitter) {  // by jitter.xy in NDC
    M4 out = m;
    for (V4& c : out.columns) c = {c.x + jitter.x * c.w, c.y + jitter.y * c.w, c.z, c.w};
    return out;
}

// Slices of the view with a map each.
void set_cascades(SurfaceBlocks& b, const V3& direction) {
    constexpr double start = 3.5;
    const V4 ends{5.4, 6.6, 8.5, 14};
    const double bounds[] = {start, ends.x, ends.y, ends.z, ends.w}, reach = std::tan(camera_half_angle);
    const V3 forward = normalize(camera_target - b.camera_position);
    double texels[4];
    for (size_t i = 0; i < 4; ++i) {
        const BoundingSphere s = slice_sphere(bounds[i], bounds[i + 1], reach, reach);
        const CascadeFit fit =
            fit_cascade(b.camera_position + forward * s.depth, s.radius, light_axes(direction), cascade_size, 8);
        b.cascade_view_projection[i] = f32(fit.clip_of_world);
        b.cascade_plane_of_world[i] = f32(transpose(inverse(b.cascade_view_projection[i])));
        texels[i] = f32(fit.texel);
    }
    b.cascade_ends = map(ends, [](double x) { return f32(x); });
    b.cascade_texel = {texels[0], texels[1], texels[2], texels[3]};
    b.cascade_bias = {0x1p-19, 0x1p-19, 0x1p-19, 0x1p-19};
    b.cascade_filter = map(V4{4, 3.5, 3, 2.5}, [](double x) { return f32(x / cascade_size); });
    b.cascade_start = start;
    b.cascade_band = f32(0.2);
    b.cascade_texel_uv = 1.0 / cascade_size;
    b.cascade_quantum = 0x1p-23;
}

// Coefficients that light something from everywhere: the first is large, the others are a wave of a fifth of it.
V3 coefficient(int k, double phase) {
    const auto wave = [&](double p) { return (k == 0 ? 3 : 0) + 0.4 * std::sin(phase + 1.3 * k + p); };
    return f32(V3{wave(0), wave(0.8), wave(1.7)});
}

void set_indirect(SurfaceBlocks& b) {
    b.ambient_irradiance = f32(V3{0.42, 0.5, 0.62});
    b.lightmap_rect = {f32(0.9), f32(0.8), f32(0.05), f32(0.1)};
    b.lightmap_range = f32(1.7);
    b.probe_first = f32(V3{-3.1, -0.2, -2.9});
    b.probe_inverse_spacing = f32(V3{1 / 2.9, 1 / 2.3, 1 / 3.1});
    const int count[3] = {3, 2, 3};
    for (int k = 0; k < 3; ++k) b.probe_count[k] = count[k];
    for (int i = 0; i < 576; ++i) b.probe_sh[i] = coefficient(i % 9, 0.7 * (i / 9));
    for (int k = 0; k < 9; ++k) b.sky_sh[k] = coefficient(k, 2.2);
    b.environment_levels = sky_levels;
    b.split_sum_size = split_sum_side;
    // One box holds most of the scene, another its right side.
    b.reflection_box_min[0] = {f32(-4.2), f32(-0.3), f32(-4.1), f32(0.9)};
    b.reflection_box_max[0] = {f32(4.3), f32(5.1), f32(4.4), 0};
    b.reflection_centre[0] = {f32(0.3), f32(1.4), f32(0.2), 0};
    b.reflection_box_min[1] = {f32(0.2), f32(-0.4), f32(-3.0), f32(0.7)};
    b.reflection_box_max[1] = {f32(5.2), f32(4.2), f32(3.3), 0};
    b.reflection_centre[1] = {f32(2.1), f32(1.2), f32(0.6), 0};
    b.reflection_layer[0] = 1;
    b.reflection_layer[1] = 2;
}

void set_material(SurfaceBlocks& b) {
    b.base_factor = {f32(0.9), f32(1.0), f32(0.95), f32(0.35)};
    b.specular_factor = {f32(1.0), f32(0.9), f32(0.8), 1};
    b.emissive = f32(V3{0.02, 0.01, 0.03});
    b.dielectric_specular = 0.5;
    b.shininess = 60;
    b.roughness_factor = f32(0.9);
    b.metallic_factor = f32(0.95);
    b.glossiness_factor = f32(0.9);
    b.disney_subsurface_share = f32(0.3);
    b.disney_specular_level = f32(0.6);
    b.disney_specular_tint = f32(0.4);
    b.disney_sheen = f32(0.5);
    b.disney_sheen_tint = f32(0.3);
    b.disney_coat = f32(0.7);
    b.disney_coat_gloss = f32(0.6);
}

void set_shadow(SurfaceBlocks& b, bool directional) {
    const V3 direction = normalize(middle - lamp);
    const M4 sun = orthographic(sun_half_side, shadow_near, shadow_far) * look_at(middle - direction * 8.0, middle, {0, 1, 0});
    const M4 spot = perspective(spot_spread, shadow_near, shadow_far) * look_at(lamp, middle, {0, 1, 0});
    b.shadow_view_projection = f32(directional ? sun : spot);
    b.shadow_near = shadow_near;
    // Where directional, what depth runs over.
    b.shadow_far = directional ? shadow_far - shadow_near : shadow_far;
    b.shadow_texel = f32(directional ? 2 * sun_half_side / shadow_size : 2.0 / face_size);  // a face of the cube is coarsest
    b.shadow_depth_bias = 0x1p-19;  // what rounding may add to a place on its way to depth
    b.shadow_plane_of_world = f32(transpose(inverse(b.shadow_view_projection)));
    b.shadow_texel_uv = 1.0 / shadow_size;
    b.shadow_filter = 4.0 / moments_size;
    b.shadow_quantum = 0x1p-23;
    b.light_size = f32(directional ? 0.12 : 0.5);
    b.shadow_extent = f32(directional ? 2 * sun_half_side : 2 * std::tan(spot_spread));
    b.moments_far = shadow_far;
    b.moments_reference = f32(directional ? 0.35 : 0.25);
    b.moments_least = f32(1e-5);
    b.moments_bleeding = f32(0.2);
    b.moments_levels = 4;
}

}  // namespace

SurfaceBlocks make_blocks(bool directional) {
    SurfaceBlocks b;
    const auto camera = [](const V3& eye) {
        return perspective(camera_half_angle, 0.5, 40) * look_at(eye, camera_target, {0, 1, 0});
    };
    b.jitter = {f32(0.0021), f32(-0.0013), f32(-0.0017), f32(0.0009)};
    b.camera_position = f32(V3{0.3, 2.4, 6.4});
    b.view_projection = f32(moved(camera(b.camera_position), b.jitter));
    b.previous_view_projection = f32(moved(camera({0.42, 2.36, 6.5}), {b.jitter.z, b.jitter.w, 0, 0}));
    b.light_position = f32(lamp);
    b.light_direction = f32(normalize(middle - lamp));
    const double power = directional ? 2.6 : 68;
    b.light_intensity = f32(V3{power, power * 0.96, power * 0.88});
    b.light_range = 25;
    b.light_cos_inner = f32(std::cos(spot_half_angle * 0.6));
    b.light_cos_outer = f32(std::cos(spot_half_angle));
    b.model = turned(0.3, {1.06, 0.95, 1.0}, {0.05, 0.02, -0.1});
    b.previous_model = turned(0.27, {1.06, 0.95, 1.0}, {0.02, 0.01, -0.1});
    set_material(b);
    set_shadow(b, directional);
    set_cascades(b, b.light_direction);
    set_indirect(b);
    return b;
}

namespace {

Scene make_scene(bool directional, bool filtered) {
    Scene s;
    s.mesh = make_mesh();
    s.blocks = make_blocks(directional);
    s.maps = make_maps(s.mesh, directional, filtered);
    return s;
}

}  // namespace

Texture2D plain(double v) {
    const float x = static_cast<float>(v);
    return {1, 1, {x, x, x, 1}, false, TextureWrap::repeat};
}

void make_white(Scene& s, double base, double specular, double roughness, double metallic) {
    s.maps.base_map = plain(base);
    s.maps.specular_map = plain(specular);
    s.maps.roughness_map = plain(roughness);
    s.maps.gloss_map = plain(1 - roughness);
    s.maps.metallic_map = plain(metallic);
    s.blocks.base_factor = s.blocks.specular_factor = {1, 1, 1, 1};
    s.blocks.roughness_factor = s.blocks.metallic_factor = s.blocks.glossiness_factor = 1;
    s.blocks.emissive = {0, 0, 0};
    s.blocks.ambient_irradiance = {0, 0, 0};
}

const Scene& scene(bool directional, bool filtered) {
    static std::map<std::pair<bool, bool>, Scene> made;
    auto found = made.find({directional, filtered});
    if (found == made.end()) found = made.emplace(std::pair{directional, filtered}, make_scene(directional, filtered)).first;
    return found->second;
}

}  // namespace kiln::test
