// Rows 33 and 34: profiles at distance 0, lobes narrower than the exponential's range. Their integrals on the device over more
// cases are in tests/functions/transport_scenes.cpp.

#include <cmath>

#include "tests/stability/raw.h"
#include "uber/reference/half.h"

namespace kiln::test {
namespace {

TEST(Stability, Row33_ProfilesAtDistanceZero) {
    const std::vector<float> distances = neighbourhood({0, 1e-45f, 1e-38f, 1e-20f, 1e-7f, 1e-4f, 0.01f, 1, 10, 100});
    std::vector<Sample> samples;
    for (const float r : distances)
        for (const float s : {0.92f, 1.05f, 3.16f, 18.3f, 1e3f})
            for (const float share : {0.0f, 1e-30f, 1e-7f, 0.0999f, 0.1f, 0.5f, 0.999999f, 1.0f})
                if (r >= 0) samples.push_back({r, s, share});
    for (const Raw& r : raw({{"subsurface.glsl"}, "", "", {}}, samples,
                            {{"r R", "burley_profile_r(x[0], vec3(x[1]))"},
                             {"cumulative", "burley_cumulative(x[0], x[1])"},
                             {"radius", "burley_radius(x[2], x[1])"},
                             {"weight", "burley_tap_weight(min(x[0], 50.0 / x[1]), vec3(x[1]), x[1])"},
                             {"dipole albedo", "dipole_albedo(vec3(x[2]), dipole_boundary(1.3))"},
                             {"dipole", "dipole_profile(x[0], vec3(x[1]), vec3(0.0), dipole_boundary(1.3))"},
                             {"dipole, white", "dipole_profile(x[0], vec3(x[1]), vec3(1e-30), dipole_boundary(1.5))"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                if (r.name.find("cumulative") == 0 || r.name.find("dipole albedo") == 0)
                    return q.at(i) >= 0 && q.at(i) <= 1 + 1e-5;
                return q.at(i) >= 0;
            },
            "negative, or a share above 1");
    }
    // R itself is infinite there; and the integral of r R over the plane is the albedo, by the substitution of its own radius.
    const std::vector<Sample> at{{0, 1.539f}};
    for (const Raw& r : raw({{"subsurface.glsl"}, "", "", {}}, at, {{"R", "burley_profile_r(x[0], vec3(x[1])) / x[0]"}}))
        EXPECT_TRUE(std::isinf(r.at(0))) << r.name;
    const std::vector<Sample> shapes{{0, 0.9236f}, {0, 1.539f}, {0, 18.276f}};
    for (const Raw& r :
         raw({{"subsurface.glsl"}, "", "", {}}, shapes,
             {{"integral",
               "for (int i = 0; i < 4000; ++i) { float u = (float(i) + 0.5) / 4000.0; float r = 40.0 / x[1] * u * u; result += "
               "vec4(burley_profile_r(r, vec3(x[1])) * (2.0 * pi), 0.0) * (80.0 / x[1] * u / 4000.0); }"}})) {
        expect_finite(r, shapes);
        for (size_t i = 0; i < shapes.size(); ++i) EXPECT_NEAR(r.at(i), 1, 1e-3) << r.name << " " << shapes[i][1];
    }
}

TEST(Stability, Row34_NarrowHairLobes) {
    const std::vector<float> variances = neighbourhood({1e-5f, 1e-4f, 1e-3f, 0.0111f, 0.01119f, 0.0849f, 0.1f, 1, 10});
    std::vector<Sample> samples;
    Directions directions(34);
    for (const float v : variances)
        if (v >= 1e-5f)
            for (int k = 0; k < 40; ++k) {
                const double i = k == 0 ? 1.5707963 : directions.uniform(-1.57, 1.57),
                             o = k < 2 ? -i : directions.uniform(-1.57, 1.57);
                samples.push_back({static_cast<float>(std::sin(i)), static_cast<float>(std::cos(i)),
                                   static_cast<float>(std::sin(o)), static_cast<float>(std::cos(o)), v});
            }
    for (const Raw& r : raw({{"hair.glsl"}, "", "", {}}, samples,
                            {{"longitudinal", "hair_longitudinal(x[0], x[1], x[2], x[3], x[4])"},
                             {"azimuthal", "hair_azimuthal(x[0] * 6.0, 1, max(x[4], 1e-3), 0.5 * x[2], 0.3 * x[2])"},
                             {"attenuation", "hair_attenuation(3, abs(x[0]), vec3(x[1]))"},
                             {"attenuation, mirror", "hair_attenuation(3, 1.0, vec3(1.0)) + vec3(0.0 * x[0])"},
                             {"transmittance", "hair_transmittance(vec3(1e6 * x[4]), x[1], max(x[3], 0.5))"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples, [](const Raw& q, size_t i) { return q.at(i) >= 0; }, "negative");
    }
    // As published: sinh(1/v) leaves single precision below 0.011184 and half precision below 0.0849.
    const std::vector<Sample> at{{0.0111f}, {0.0112f}};
    for (const Raw& r : raw({{"hair_published.glsl"}, "", "", {}}, at,
                            {{"sinh", "sinh(1.0 / x[0])"},
                             {"printed", "hair_longitudinal_printed(sin(0.4), cos(0.4), -sin(0.4), cos(0.4), x[0])"}})) {
        if (r.name[0] == 's') {
            EXPECT_TRUE(std::isinf(r.at(0))) << r.name << " " << r.at(0);
        } else {
            // Its peak is 1 / (2 v sqrt(..)): what the device makes of infinity is not that.
            EXPECT_FALSE(r.at(0) > 1) << r.name << " " << r.at(0);
        }
    }
    const double limit = 1 / std::asinh(65504.0);
    EXPECT_NEAR(limit, 0.0849, 1e-4);
    EXPECT_NEAR(1 / std::asinh(static_cast<double>(largest_float)), 0.011184, 1e-5);
    EXPECT_TRUE(std::isinf(reference::round_to_half(static_cast<float>(std::sinh(1 / 0.0848)))));
    EXPECT_FALSE(std::isinf(reference::round_to_half(static_cast<float>(std::sinh(1 / 0.085)))));
    // The integral over the sphere of directions: 1 for every width.
    const std::vector<Sample> widths{{1e-4f}, {1e-3f}, {0.01f}, {0.0112f}, {0.1f}, {1}};
    for (const Raw& r : raw({{"hair.glsl"}, "", "", {}}, widths,
                            {{"integral",
                              "for (int a = 0; a < 2000; ++a) { float t = pi * ((float(a) + 0.5) / 2000.0 - 0.5); result += "
                              "vec4(hair_longitudinal("
                              "sin(t), cos(t), sin(0.7), cos(0.7), x[0]) * cos(t) * pi / 2000.0); }"}}))
        for (size_t i = 0; i < widths.size(); ++i) EXPECT_NEAR(r.at(i), 1, 1e-3) << r.name << " " << widths[i][0];
}

}  // namespace
}  // namespace kiln::test
