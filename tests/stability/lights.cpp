// Rows 12 and 13: lights without a distance, cones and bands without a width.

#include <cmath>

#include "tests/stability/raw.h"

namespace kiln::test {
namespace {

TEST(Stability, Row12_LightAtNoDistance) {
    // x: the way to the light, its range.
    Directions directions(12);
    std::vector<Sample> samples;
    for (const double r : {0.0, 1e-45, 1e-40, 1e-20, 1e-10, 9.9e-3, 0.01, 0.0101, 1.0, 1e4, 1e9, 1.8e19, 1e20, 3e38})
        for (const float range : {1e-7f, 1e-6f, 0.01f, 1.0f, 1e3f, 1e6f, 1e18f})
            for (int k = 0; k < 4; ++k) {
                Sample s{};
                const auto d = directions.unit();
                for (size_t c = 0; c < 3; ++c) s[c] = static_cast<float>(d[c] * r);
                s[3] = range;
                samples.push_back(s);
            }
    for (const Raw& r : raw({{"lights.glsl", "vectors.glsl"}, "", "", {}}, samples,
                            {{"attenuation", "distance_attenuation(dot(u3(0), u3(0)), x[3])"},
                             {"direction", "safe_normalize(u3(0), vec3(0.0, 1.0, 0.0))"}})) {
        EXPECT_EQ(r.non_finite(), 0u) << r.name;
        const bool attenuation = r.name[0] == 'a';
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                double squared = 0;
                for (size_t c = 0; c < 3; ++c) squared += static_cast<double>(samples[i][c]) * static_cast<double>(samples[i][c]);
                if (attenuation) {
                    const double range = static_cast<double>(samples[i][3]);
                    // 0 beyond the range (which the shader has as 1e-6 at least), never more than 1e4, never more than 1 / r^2.
                    if (squared > 1.001 * std::max(range * range, 1e-12) && q.at(i) != 0) return false;
                    // Where the square of the distance has left the format the count has an infinite argument, and only there.
                    return q.at(i) >= 0 && q.at(i) <= 1e4 * (1 + 1e-6) && q.at(i) * squared <= 1 + 1e-6 &&
                           (q.hidden[i] == 0 || squared > 3.4e38 || squared / range / range > 1e19);
                }
                const double length = std::sqrt(q.at(i) * q.at(i) + q.at(i, 1) * q.at(i, 1) + q.at(i, 2) * q.at(i, 2));
                return std::fabs(length - 1) <= 4 * 0x1p-23 && q.hidden[i] == 0;
            },
            "out of bounds");
    }
    // As printed: I / r^2, the direction by normalize.
    const std::vector<Sample> at{{0, 0, 0}, {1e-20f, 0, 0}, {1e20f, 0, 0}};
    for (const Raw& r : raw({{"math.glsl"}, "", "", {}}, at,
                            {{"1 / r^2", "1.0 / dot(u3(0), u3(0))"}, {"cos / r^2", "normalize(u3(0)).x / dot(u3(0), u3(0))"}})) {
        if (r.name[0] == '1') {
            EXPECT_TRUE(std::isinf(r.at(0)) && std::isinf(r.at(1))) << r.name;
            EXPECT_EQ(r.at(2), 0.0) << r.name;
        } else {
            EXPECT_TRUE(std::isnan(r.at(0))) << r.name << " " << r.at(0);
        }
    }
}

TEST(Stability, Row13_ConesAndBandsOfNoWidth) {
    // inner = outer = x[0]; the cosine x[1] on both sides of it.
    std::vector<Sample> samples;
    for (const float edge : {-1.0f, -0.5f, 0.0f, 0.5f, 0.9f, 0.9999f, 1.0f})
        for (const float c : neighbourhood({-1, edge - 0.01f, edge, edge + 0.01f, 1})) samples.push_back({edge, c});
    for (const Raw& r :
         raw({{"lights.glsl"}, "", "", {}}, samples,
             {{"cone", "cone_attenuation(x[1], x[0], x[0])"}, {"inverted", "cone_attenuation(x[1], x[0] - 0.1, x[0])"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const double beyond = static_cast<double>(samples[i][1]) - static_cast<double>(samples[i][0]);
                if (beyond <= 0) return q.at(i) == 0;
                return beyond >= 1.001e-3 ? q.at(i) == 1 : q.at(i) >= 0 && q.at(i) <= 1;
            },
            "no step");
    }
    // Cascades blended over no band, a probe's box without a fade.
    std::vector<Sample> depths;
    for (const float z : neighbourhood({0, 9.9f, 10, 20, 20.1f, 30})) depths.push_back({z});
    for (const Raw& r : raw({{"cascades.glsl", "probes.glsl"}, "", "", {}}, depths,
                            {{"blend", "cascade_blend(x[0], 10.0, 20.0, 0.0)"},
                             {"empty slice", "cascade_blend(x[0], 20.0, 20.0, 0.1)"},
                             {"box", "1.0 - probe_box_weight(vec3(x[0] - 10.0, 0.0, 0.0), vec3(-10.0), vec3(10.0), 0.0)"}})) {
        expect_finite(r, depths);
        expect_each(
            r, depths,
            [&](const Raw& q, size_t i) {
                const double z = static_cast<double>(depths[i][0]);
                if (r.name[0] == 'b' && r.name[1] == 'o') return z > 0 && z < 20 ? q.at(i) <= 1 : q.at(i) == 1;
                return z <= 20 ? q.at(i) == 0 : q.at(i) > 0 && q.at(i) <= 1;
            },
            "no step");
    }
    // As printed: 1 / (inner - outer) times a difference of 0.
    for (const Raw& r : raw({{"math.glsl"}, "", "", {}}, {{0.5f, 0.5f, 0.5f}},
                            {{"cone", "(x[1] - x[0]) / (x[2] - x[0])"},
                             {"scale and offset", "x[1] * (1.0 / (x[2] - x[0])) - x[0] * (1.0 / (x[2] - x[0]))"}}))
        EXPECT_TRUE(std::isnan(r.at(0))) << r.name << " " << r.at(0);
}

}  // namespace
}  // namespace kiln::test
