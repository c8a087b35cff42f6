// Functions of hair, subsurface and indirect light that read textures, on the device against their references.

#include "tests/functions/library_run.h"
#include "uber/reference/gi_cornell.h"
#include "uber/reference/gi_rsm.h"
#include "uber/reference/gi_screen.h"
#include "uber/reference/gi_truth.h"
#include "uber/reference/subsurface_preintegrated.h"

namespace kiln::test {
namespace {

using namespace reference;

float single(double x) { return static_cast<float>(x); }

// A reflective shadow map of the empty room, 16 x 16, as three images and as the reference's callables, both in floats.
struct Map {
    std::vector<Texel> positions, normals, intensities;
};
constexpr int map_size = 16;

Map map_of_room(const std::vector<GiQuad<double>>& room, const GiLamp<double>& lamp) {
    Map map;
    const double solid_angle = 2 * pi / (map_size * map_size);
    for (int j = 0; j < map_size; ++j)
        for (int i = 0; i < map_size; ++i) {
            const Vec3<double> d = rsm_direction(i, j, map_size, lamp.axis);
            double t = 0;
            const int met = gi_trace(room, lamp.position, d, 1e-4, 1e30, t);
            Texel position{0, 0, 0, 1}, normal{}, intensity{};
            if (met >= 0) {
                const auto& quad = room[static_cast<std::size_t>(met)];
                const Vec3<double> m = normalize(cross(quad.u, quad.v)), at = lamp.position + d * t;
                const Vec3<double> sent = lamp.intensity * quad.albedo * (solid_angle / pi);
                position = {single(at.x), single(at.y), single(at.z), single(t * t * solid_angle / max(-dot(m, d), 0.05))};
                normal = {single(m.x), single(m.y), single(m.z), 0};
                intensity = {single(sent.x), single(sent.y), single(sent.z), 0};
            }
            map.positions.push_back(position), map.normals.push_back(normal), map.intensities.push_back(intensity);
        }
    return map;
}

TEST(TransportTextures, ReflectiveShadowMapsAreSummed) {
    auto room = gi_cornell_quads();
    room.resize(5);
    const Map map = map_of_room(room, gi_cornell_lamp());
    const auto image = [](const std::vector<Texel>& texels) {
        return image_of(TexelFormat::rgba32_float, map_size, map_size, bytes_of(texels));
    };
    const auto seen = compute("#define RSM_SIZE 16\n#define RSM_TAPS 4096\n", {"gi_rsm.glsl"}, R"(
    const vec3 x = vec3(-0.8 + 0.1 * float(i), 1.0, 0.3);
    const vec3 n = vec3(0.0, -1.0, 0.0);
    // All texels; and, from the middle of the map, so many taps that they find all within reach.
    const vec3 all = rsm_gather_all(positions, normals, intensities, x, n);
    const vec3 some = rsm_gather(positions, normals, intensities, x, n, vec2(0.5), 0.5, vec2(0.0));
    result = vec4(all.rg, some.rg);
)",
                              17,
                              {{"positions", image(map.positions), smooth},
                               {"normals", image(map.normals), smooth},
                               {"intensities", image(map.intensities), smooth}},
                              "layout(set = 0, binding = 1) uniform sampler2D positions;\n"
                              "layout(set = 0, binding = 2) uniform sampler2D normals;\n"
                              "layout(set = 0, binding = 3) uniform sampler2D intensities;\n");
    const auto texel = [](const std::vector<Texel>& texels, int i, int j) {
        const Texel& t = texels[static_cast<std::size_t>(j * map_size + i)];
        return Vec4<double>{at(t, 0), at(t, 1), at(t, 2), at(t, 3)};
    };
    const auto positions = [&](int i, int j) { return texel(map.positions, i, j); };
    const auto normals = [&](int i, int j) { return texel(map.normals, i, j).xyz(); };
    const auto intensities = [&](int i, int j) { return texel(map.intensities, i, j).xyz(); };
    for (int k = 0; k < 17; ++k) {
        const Vec3<double> x{-0.8 + 0.1 * k, 1, 0.3}, n{0, -1, 0};
        const Vec3<double> all = rsm_gather_all<double>(positions, normals, intensities, x, n, map_size);
        // 256 terms, none negative, each of some 20 operations.
        EXPECT_NEAR(at(seen[static_cast<std::size_t>(k)], 0), all.x, 300 * 0x1p-23 * all.x) << k;
        EXPECT_NEAR(at(seen[static_cast<std::size_t>(k)], 1), all.y, 300 * 0x1p-23 * all.y) << k;
        // The disc's texels, each by the share of it that lies within reach.
        Vec3<double> within{};
        for (int j = 0; j < map_size; ++j)
            for (int i = 0; i < map_size; ++i) {
                int inside = 0;
                for (int b = 0; b < 16; ++b)
                    for (int a = 0; a < 16; ++a)
                        inside += std::hypot((i + (a + 0.5) / 16) / map_size - 0.5, (j + (b + 0.5) / 16) / map_size - 0.5) < 0.5;
                const Vec4<double> y = positions(i, j);
                within = within + rsm_irradiance(x, n, y.xyz(), normals(i, j), intensities(i, j), y.w) * (inside / 256.0);
            }
        // 4096 stratified taps over 201 texels: 20 a texel, of which a border takes or leaves about 1.
        EXPECT_NEAR(at(seen[static_cast<std::size_t>(k)], 3), within.y, 0.05 * within.y) << k;
    }
}

TEST(TransportTextures, ScreenRaysMeetWhatTheReferenceMeets) {
    // A depth buffer of a slanted floor, 64 x 64, in floats, read at the nearest texel on both sides.
    const double near = 0.1, far = 100;
    const int side = 64;
    const Mat4<double> projection{
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, far / (near - far), -1}, {0, 0, near * far / (near - far), 0}}};
    std::vector<float> depths;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double down = 2 * (y + 0.5) / side - 1, distance = down > 0.05 ? std::fmin(1 / down, 50.0) : 50;
            depths.push_back(single(far / (far - near) * (1 - near / distance)));
        }
    const auto depth = [&](const Vec2<double>& uv) {
        const int x = std::clamp(static_cast<int>(uv.x * side), 0, side - 1);
        const int y = std::clamp(static_cast<int>(uv.y * side), 0, side - 1);
        return static_cast<double>(depths[static_cast<std::size_t>(y * side + x)]);
    };
    constexpr SamplerState nearest{Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off};
    const auto seen = compute("", {"gi_screen.glsl"}, R"(
    const float near = 0.1;
    const float far = 100.0;
    const mat4 projection = mat4(vec4(1.0, 0.0, 0.0, 0.0), vec4(0.0, 1.0, 0.0, 0.0), vec4(0.0, 0.0, far / (near - far), -1.0),
                                 vec4(0.0, 0.0, near * far / (near - far), 0.0));
    const float phi = 0.0123 + 2.0 * pi * float(i) / float(count);
    const vec3 direction = normalize(vec3(cos(phi), 0.6 + 0.3 * sin(3.0 * phi), sin(phi)));
    vec2 hit;
    const bool met = screen_march(depths, projection, vec3(0.1, 0.2, -3.0), direction, 4.0, 0.5, 0.25, hit);
    result = vec4(met ? 1.0 : 0.0, hit, phi);
)",
                              256, {{"depths", image_of(TexelFormat::r32_float, side, side, bytes_of(depths)), nearest}},
                              "layout(set = 0, binding = 1) uniform sampler2D depths;\n");
    int met = 0, other = 0;
    for (const Texel& t : seen) {
        const double phi = at(t, 3);
        const Vec3<double> direction = normalize(Vec3<double>{cos(phi), 0.6 + 0.3 * sin(3 * phi), sin(phi)});
        Vec2<double> hit;
        const bool meets = screen_march<double>(depth, projection, {0.1, 0.2, -3}, direction, 4.0, 0.5, 0.25, hit);
        met += meets ? 1 : 0;
        // sin and cos may be off by 2^-11, which moves a point by less than a texel and seldom over a texel's edge.
        const bool alike = meets == (t[0] > 0.5f) && std::hypot(at(t, 1) - hit.x, at(t, 2) - hit.y) < 0.5 / side;
        other += alike ? 0 : 1;
    }
    std::printf("screen: %d of 256 rays meet the floor, %d elsewhere than in the reference\n", met, other);
    EXPECT_GT(met, 100);
    EXPECT_LT(met, 256);
    EXPECT_LE(other, 8);
}

TEST(TransportTextures, PreintegratedTableIsTheFunctionItWasBakedFrom) {
    const int side = 64;
    std::vector<float> table;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) table.push_back(single(preintegrated_texel<double>(x, y, side, side)));
    const auto seen = compute("", {"subsurface_preintegrated.glsl"}, R"(
    const float c = -0.97 + 1.94 * float(i % 32) / 31.0;
    const float k = exp2(-5.0 + float(i / 32));
    result = vec4(preintegrated_lookup(table, c, k, vec3(1.0, 2.0, 0.5)).x, preintegrated_sphere(c, k), c, k);
    result.x += abs(preintegrated_texel(ivec2(i % 32, i / 32), ivec2(64)) - texelFetch(table, ivec2(i % 32, i / 32), 0).r) > 1e-5 ? 9.0 : 0.0;
)",
                              32 * 8, {{"table", image_of(TexelFormat::r32_float, side, side, bytes_of(table)), smooth}},
                              "layout(set = 0, binding = 1) uniform sampler2D table;\n");
    double worst = 0;
    for (const Texel& t : seen) worst = std::fmax(worst, std::fabs(at(t, 0) - at(t, 1)));
    std::printf("preintegrated table 64 x 64: worst error of a lookup %.5f\n", worst);
    // Bilinear: a quarter of a step times the change of slope in a cell. The slope in n.l is at most 1 and bends most at the
    // shadow's edge, by no more than 1: 2/63/4. Along the curvature the function changes by less than 1/2 over 63 cells.
    EXPECT_LT(worst, 2.0 / 63 / 4 + 0.5 / 63 / 4);
}

TEST(TransportTextures, ConesPastAnEdgeOfADistanceField) {
    // The field of y = 0's upper half space is linear: trilinear filtering returns it as it is.
    const uint32_t side = 16;
    std::vector<float> field;
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) field.push_back(single(2 * (y + 0.5) / side - 1));
    const auto seen = compute("", {"gi_sdf.glsl"}, R"(
    const SdfVolume volume = SdfVolume(vec3(-1.0), vec3(2.0));
    const float height = 0.02 + 0.02 * float(i);
    const vec3 origin = vec3(0.0, height, -0.9);
    const vec3 direction = vec3(0.0, 0.0, 1.0);
    result = vec4(sdf_visibility(field, volume, origin, direction, 0.2, 0.0, 1.8, 1e-4),
                  sdf_soft_visibility(field, volume, origin, direction, 5.0, 0.0, 1.8, 1e-4),
                  sdf_trace(field, volume, origin, normalize(vec3(0.0, -1.0, 1.0)), 0.0, 3.0, 1e-4), height);
)",
                              20, {{"field", volume_of(TexelFormat::r32_float, side, bytes_of(field)), smooth}},
                              "layout(set = 0, binding = 1) uniform sampler3D field;\n");
    const auto ground = [](const Vec3<double>& p) { return p.y; };
    for (const Texel& t : seen) {
        const double height = at(t, 3);
        const Vec3<double> origin{0, height, -0.9}, along{0, 0, 1};
        // Filter weights in steps of 2^-8 of a texel's slope, 1/8: the distance is off by 5e-4, which over the reach times the
        // tangent, 0.36, is 1.4e-3 of u, and in the soft form k/t of it; a last step more or less moves t by `height`.
        const double step = height / 1.8;
        EXPECT_NEAR(at(t, 0), sdf_visibility<double>(ground, origin, along, 0.2, 0.0, 1.8, 1e-4), 2e-3 + step * 0.6) << height;
        EXPECT_NEAR(at(t, 1), sdf_soft_visibility<double>(ground, origin, along, 5.0, 0.0, 1.8, 1e-4), 2e-3 + step) << height;
        EXPECT_NEAR(at(t, 2), height * std::sqrt(2.0), 1e-3) << height;
    }
}

}  // namespace
}  // namespace kiln::test
