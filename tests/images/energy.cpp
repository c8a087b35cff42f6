// Full variants in a white furnace, under lamps from all sides, with camera and lamp exchanged, with no light and with light
// from behind.

#include <cstdio>

#include "tests/device/glsl.h"
#include "tests/images/variants.h"
#include "uber/reference/random.h"

namespace kiln::test {
namespace {

// One large square, seen from above by a camera that looks at the origin.
Scene square(const V3& eye) {
    Scene s = scene(true, false);
    s.mesh = {};
    for (const auto& [x, z] : {std::pair{-50.0, -50.0}, {-50.0, 50.0}, {50.0, 50.0}, {-50.0, -50.0}, {50.0, 50.0}, {50.0, -50.0}})
        s.mesh.vertices.push_back({{x, 0, z}, {0, 1, 0}, {0.5, 0.5}, {0.5, 0.5}, {1, 0, 0, 1}});
    s.mesh.body = {plane, plane};
    s.blocks.model = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    s.blocks.camera_position = f32(eye);
    const V3 up = std::fabs(eye.y) > 0.9 * length(eye) ? V3{1, 0, 0} : V3{0, 1, 0};
    s.blocks.view_projection = f32(reference::perspective(0.2, 0.5, 200) * reference::look_at(s.blocks.camera_position, {}, up));
    return s;
}

const Values forward = {{"pass", "forward"}};
Values with(Values v, const std::string& axis, const std::string& value) {
    v[axis] = value;
    return v;
}

// Radiance 1 from everywhere, by each way that surface knows of: a white diffuse surface shows radiance 1 itself.
TEST(Energy, WhiteFurnace) {
    const Points points = visible_points(scene(false, true));
    for (const char* material : {"blinn_phong", "pbr_mr", "pbr_sg"})
        for (const char* lightmap : {"none", "flat", "sh_lq", "sh_hq"}) {
            Scene s = scene(false, true);
            make_white(s, 1, 0, 0.5, 0);
            const double e = f32(reference::pi);
            s.blocks.ambient_irradiance = {e, e, e};
            s.maps.lightmap_flat = s.maps.lightmap_l0 = plain(1);
            s.maps.lightmap_l1_y = s.maps.lightmap_l1_z = s.maps.lightmap_l1_x = plain(0.5);
            // E = range for flat, range / 4 for the first band without a direction.
            s.blocks.lightmap_range = std::string(lightmap) == "flat" ? e : 4 * e;
            const Values values = with(with(forward, "material", material), "lightmap", lightmap);
            const RunOutput run = draw(surface_variant(values).stages, {inputs_of(s)}).front();
            const ReadBack* got = output(run, "output 0");
            ASSERT_NE(got, nullptr);
            size_t seen = 0;
            for (size_t i = 0; i < points.at.size(); ++i) {
                if (points.at[i].body < 0 || points.at[i].silhouette) continue;
                ++seen;
                // A quotient of 2.5 ulp, products and the constants' own rounding.
                for (size_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(static_cast<double>(as_float(got->words[4 * i + c])), 1.0, 8 * 0x1p-23)
                        << material << ' ' << lightmap;
            }
            EXPECT_GT(seen, 5000u);
        }
}

// Nodes on (-1, 1) and weights of Gauss and Legendre, by Newton's method.
std::vector<std::pair<double, double>> gauss_legendre(int n) {
    std::vector<std::pair<double, double>> out;
    for (int i = 0; i < n; ++i) {
        double x = std::cos(reference::pi * (i + 0.75) / (n + 0.5)), slope = 1;
        for (int step = 0; step < 50; ++step) {
            double p = 1, before = 0;
            for (int k = 0; k < n; ++k) {
                const double next = ((2 * k + 1) * x * p - k * before) / (k + 1);
                before = p, p = next;
            }
            slope = n * (x * p - before) / (x * x - 1);
            x -= p / slope;
        }
        out.push_back({x, 2 / ((1 - x * x) * slope * slope)});
    }
    return out;
}

// Lamps that together are a sky of radiance 1, one drawn after another: no material reflects more than arrives.
TEST(Energy, LampsFromAllSides) {
    struct Case {
        const char* material;
        double base, specular, roughness, metallic, shininess;
        int rings = 14, around = 32;
        std::vector<V3> eyes = {{0.2, 10, 0.1}, {9, 3, 2}};
    };
    const Case cases[] = {{"pbr_mr", 1, 0, 0.7, 1, 1},
                          {"pbr_mr", 1, 0, 1.0, 1, 1},
                          {"pbr_mr", 1, 0, 0.7, 0, 1},
                          {"pbr_sg", 1, 0.04, 0.7, 0, 1},
                          {"pbr_sg", 0.5, 0.5, 1.0, 0, 1},
                          {"blinn_phong", 1, 0.0, 0, 0, 20},
                          {"blinn_phong", 1, 1, 0, 0, 4},
                          {"blinn_phong", 1, 0.5, 0, 0, 8},
                          // Where a coat reflects most beyond F(n.v), from n.v = 0.6.
                          {"pbr_sg", 1, 0.02, 0.325, 0, 1, 28, 64, {{8, 6, 0}}}};
    for (const Case& c : cases) {
        const uint32_t size = c.rings == 14 ? 8 : 3;
        std::vector<std::pair<V3, double>> lamps;
        for (const auto& [x, w] : gauss_legendre(c.rings))
            for (int k = 0; k < c.around; ++k) {
                const double cosine = (x + 1) / 2, phi = 2 * reference::pi * (k + 0.5) / c.around,
                             sine = std::sqrt(1 - cosine * cosine);
                lamps.push_back({{sine * std::cos(phi), cosine, sine * std::sin(phi)}, w / 2 * 2 * reference::pi / c.around});
            }
        for (const V3& eye : c.eyes) {
            Scene s = square(eye);
            make_white(s, c.base, c.specular, c.roughness, c.metallic);
            s.blocks.shininess = c.shininess;
            const Values values = with(with(forward, "material", c.material), "light", "directional");
            std::vector<reference::SurfaceBlocks> blocks;
            std::vector<NamedInputs> inputs;
            const NamedInputs base = inputs_of(s);
            for (const auto& [to_lamp, solid_angle] : lamps) {
                s.blocks.light_direction = f32(-to_lamp);
                s.blocks.light_intensity = f32(V3{solid_angle, solid_angle, solid_angle});
                blocks.push_back(s.blocks);
                inputs.push_back(base);
                put(inputs.back(), s.blocks);
            }
            const std::vector<RunOutput> runs = draw(surface_variant(values).stages, inputs, size);
            const Points points = visible_points(s, size);
            for (size_t i = 0; i < points.at.size(); ++i) {
                if (points.at[i].body < 0 || points.at[i].silhouette) continue;
                double device_sum = 0, sum = 0, allowed = 0;
                for (size_t l = 0; l < lamps.size(); ++l) {
                    const ReadBack* got = output(runs[l], "output 0");
                    ASSERT_NE(got, nullptr);
                    const Bounded one = reference::surface_radiance(axes_of(values), blocks[l], s.maps, points.at[i].in, true).x;
                    device_sum += static_cast<double>(as_float(got->words[4 * i]));
                    sum += one.value;
                    allowed += reference::reassociation_margin * one.error;
                }
                ASSERT_NEAR(device_sum, sum, allowed) << c.material << ' ' << eye.x;
                ASSERT_LE(device_sum, 1 + 1e-3) << c.material << ' ' << c.specular << ' ' << eye.x;
                ASSERT_GT(device_sum, 0.25) << c.material << ' ' << c.specular << ' ' << eye.x;
            }
        }
    }
}

// Camera and lamp change places: what a point passes on, over its cosine to the lamp, is the same (Helmholtz).
TEST(Energy, Reciprocity) {
    constexpr uint32_t size = 33, centre = 16 * size + 16;
    reference::Random random(5);
    const auto direction = [&] {
        const double y = 0.15 + 0.8 * random(), phi = 2 * reference::pi * random(), r = std::sqrt(1 - y * y);
        return V3{r * std::cos(phi), y, r * std::sin(phi)};
    };
    for (const char* material : {"blinn_phong", "pbr_mr", "pbr_sg"})
        for (int pair = 0; pair < 6; ++pair) {
            const V3 ends[2] = {direction(), direction()};
            double over_cosine[2]{}, allowed = 0;
            for (const size_t k : {size_t{0}, size_t{1}}) {
                Scene s = square(ends[k] * 6.0);
                make_white(s, 0.7, 0.3, 0.3 + 0.1 * pair, 0.5);
                s.blocks.light_direction = f32(-ends[1 - k]);
                s.blocks.light_intensity = {1, 1, 1};
                const Values values = with(with(forward, "material", material), "light", "directional");
                const Variant v = surface_variant(values);
                const RunOutput run = draw(v.stages, {inputs_of(s)}, size).front();
                const ReadBack* got = output(run, "output 0");
                ASSERT_NE(got, nullptr);
                const Points points = drawn_points(v.stages.front(), inputs_of(s), visible_points(s, size));
                const Bounded expected =
                    reference::surface_radiance(axes_of(values), s.blocks, s.maps, points.at[centre].in, true).x;
                const double cosine = ends[1 - k].y;
                over_cosine[k] = static_cast<double>(as_float(got->words[4 * centre])) / cosine;
                // Directions of the two pictures are each rounded to fp32: as much again as one's own error.
                allowed += 2 * reference::reassociation_margin * expected.error / cosine;
                ASSERT_NEAR(over_cosine[k] * cosine, expected.value, reference::reassociation_margin * expected.error);
            }
            EXPECT_NEAR(over_cosine[0], over_cosine[1], allowed) << material;
            EXPECT_LT(allowed, 5e-3 * over_cosine[0]) << material;  // a comparison worth making
        }
}

TEST(Energy, WithoutLightOnlyEmissionIsLeft) {
    for (const char* light : {"none", "directional", "point", "spot"})
        for (const char* material : {"blinn_phong", "pbr_mr"}) {
            Scene s = scene(std::string(light) == "directional", true);
            s.blocks.light_intensity = s.blocks.ambient_irradiance = {0, 0, 0};
            const Values values = with(with(forward, "material", material), "light", light);
            const RunOutput run = draw(surface_variant(values).stages, {inputs_of(s)}).front();
            const ReadBack* got = output(run, "output 0");
            ASSERT_NE(got, nullptr);
            size_t seen = 0;
            for (size_t i = 0; i < got->words.size(); i += 4) {
                if (as_float(got->words[i + 3]) == 0) continue;
                ++seen;
                ASSERT_EQ(as_float(got->words[i]), static_cast<float>(s.blocks.emissive.x)) << light << ' ' << material;
                ASSERT_EQ(as_float(got->words[i + 2]), static_cast<float>(s.blocks.emissive.z)) << light << ' ' << material;
            }
            EXPECT_GT(seen, 5000u);
        }
}

// Where the lamp is behind the surface nothing arrives, highlight or not: exactly 0.
TEST(Energy, LightFromBehindIsNothing) {
    const Points points = visible_points(scene(true, true));
    for (const char* material : {"blinn_phong", "pbr_mr", "pbr_sg"}) {
        Scene s = scene(true, true);
        s.blocks.ambient_irradiance = s.blocks.emissive = {0, 0, 0};
        s.blocks.light_direction = f32(normalize(V3{0.4, 0.7, 0.3}));
        const Values values = with(with(forward, "material", material), "light", "directional");
        const RunOutput run = draw(surface_variant(values).stages, {inputs_of(s)}).front();
        const ReadBack* got = output(run, "output 0");
        ASSERT_NE(got, nullptr);
        size_t behind = 0;
        for (size_t i = 0; i < points.at.size(); ++i) {
            const Points::Point& p = points.at[i];
            if (p.body < 0 || p.silhouette) continue;
            const auto n = reference::safe_normalize(p.in.world_normal, {Bounded(0), Bounded(0), Bounded(1)});
            if (dot(n, reference::read<Bounded>(-s.blocks.light_direction)).high() >= 0) continue;
            ++behind;
            for (size_t c = 0; c < 3; ++c) ASSERT_EQ(as_float(got->words[4 * i + c]), 0.0f) << material;
        }
        EXPECT_GT(behind, 3000u);
    }
}

}  // namespace
}  // namespace kiln::test
