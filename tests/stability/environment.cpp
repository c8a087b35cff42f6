// Rows 28 to 30: light below zero, directions without a face, suns that no format holds.
// Continuity over cube edges, seams and poles of real maps, and the split of a whole sky: tests/bakes.

#include <cmath>

#include "tests/stability/raw.h"

namespace kiln::test {
namespace {

const std::vector<std::string> sh_files{"sh.glsl", "sh_lightmap.glsl", "probes.glsl", "lecture_sh.glsl"};

TEST(Stability, Row28_HarmonicsOppositeASmallLight) {
    // x: n, direction of the light, its power (of any size, also 0).
    Directions directions(28);
    std::vector<Sample> samples;
    for (const float power : {0.0f, 1e-40f, 1e-30f, 1e-20f, 1e-3f, 1.0f, 1e4f, 1e18f})
        for (int k = 0; k < 300; ++k) {
            Sample s{};
            const auto d = directions.unit();
            put(s, 3, d);
            if (k == 0)
                put(s, 0, {-d[0], -d[1], -d[2]});
            else if (k == 1)
                put(s, 0, d);
            else
                put(s, 0, directions.unit());
            s[6] = power;
            samples.push_back(s);
        }
    const std::string moments = "sh_moments_accumulate(sh_moments_zero(), u3(3), vec3(x[6]), 1.0)";
    const std::string l2 = "sh_l2_accumulate(sh_l2_zero(), u3(3), vec3(x[6]), 1.0)";
    const std::string texel = "ShMomentsL1 m = " + moments +
                              "; result = vec4(sh_l1_irradiance(m.m0, decode_sh_ratio(encode_sh_ratio(m.m0, m.m1_y)), "
                              "decode_sh_ratio(encode_sh_ratio(m.m0, "
                              "m.m1_z)), decode_sh_ratio(encode_sh_ratio(m.m0, m.m1_x)), u3(0)), 0.0);";
    for (const Raw& r : raw({sh_files, "", "", {}}, samples,
                            {{"clamped l1", "sh_irradiance_clamped(" + moments + ", u3(0))"},
                             {"clamped l2", "sh_irradiance_clamped(" + l2 + ", u3(0))"},
                             {"non-linear l1", "sh_irradiance_nonlinear(" + moments + ", u3(0))"},
                             {"lightmap", texel}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                // Never negative, never more than a surface that faces the light gets: 1.11 power in band 2, 1 in the others.
                const double power = static_cast<double>(samples[i][6]);
                return q.at(i) >= 0 && q.at(i) <= (r.name == "lightmap" ? 1 : 1.2) * power * (1 + 1e-5) + 1e-30;
            },
            "negative, or more than arrives");
    }
    // The plain sums opposite a light of power 1: -1/4 and -0.0396; and what no light could make (m0 below 0, |m1| above m0)
    // in the forms that shade from stored numbers.
    const double low = -8.0 / 15;  // where 1/4 + c/2 + 5/32 (3 c^2 - 1) is lowest
    const std::vector<Sample> opposite{{0, 0, -1, 0, 0, 1, 1},
                                       {static_cast<float>(std::sqrt(1 - low * low)), 0, static_cast<float>(low), 0, 0, 1, 1}};
    for (const Raw& r :
         raw({sh_files, "", "", {}}, opposite,
             {{"l1", "sh_irradiance_from_moments(" + moments + ", u3(0))"},
              {"l2", "sh_irradiance_from_radiance(" + l2 + ", u3(0))"},
              {"lecture",
               "ShL1 c = sh_l1_accumulate(sh_l1_zero(), u3(3), vec3(x[6]), 1.0); result = vec4(sh_irradiance_lecture(vec4("
               "c.c[0].x, c.c[1].x, c.c[2].x, c.c[3].x), u3(0)));"}})) {
        if (r.name.find("l1") == 0) {
            EXPECT_NEAR(r.at(0), -0.25, 1e-6) << r.name;
        } else if (r.name.find("l2") == 0) {
            EXPECT_NEAR(r.at(1), -0.0396, 1e-4) << r.name;
        } else {
            // 0.886227 Y0^2 - 1.023326 Y1^2: the direction weighs sqrt(3) too much.
            EXPECT_NEAR(r.at(0), 0.0705 - 0.2443, 1e-3) << r.name;
        }
    }
    const std::vector<Sample> impossible =
        grid({{0}, {0}, {1}, {-1e6f, -1, -1e-20f, 0, 1e-20f, 1, 1e6f}, {-1e6f, -1, 0, 1, 1e6f}});
    const std::string stored = "ShMomentsL1(vec3(x[3]), vec3(0.0), vec3(x[4]), vec3(0.5 * x[4]))";
    for (const Raw& r : raw({sh_files, "", "", {}}, impossible,
                            {{"clamped", "sh_irradiance_clamped(" + stored + ", u3(0))"},
                             {"non-linear", "sh_irradiance_nonlinear(" + stored + ", u3(0))"},
                             {"encoded", "encode_sh_ratio(vec3(x[3]), vec3(x[4]))"}})) {
        EXPECT_EQ(r.non_finite(), 0u) << r.name;
        expect_each(
            r, impossible, [](const Raw& q, size_t i) { return q.at(i) >= 0; }, "negative");
    }
}

TEST(Stability, Row29_DirectionsWithoutAFace) {
    Directions directions(29);
    std::vector<Sample> samples;
    for (const double size : {0.0, 1e-45, 1e-38, 1e-30, 1e-20, 1.0, 1e19, 1e30, 3e38})
        for (int k = 0; k < 40; ++k) {
            Sample s{};
            auto d = directions.unit();
            if (k < 6)
                d = {k / 2 == 0 ? 1.0 - 2 * (k % 2) : 0.0, k / 2 == 1 ? 1.0 - 2 * (k % 2) : 0.0,
                     k / 2 == 2 ? 1.0 - 2 * (k % 2) : 0.0};
            if (k == 6) d = {-1, 0, -1e-30};  // the seam, from both sides
            if (k == 7) d = {-1, 0, 1e-30};
            if (k == 8) d = {1e-8, 1, 0};  // next to a pole
            for (size_t c = 0; c < 3; ++c) s[c] = static_cast<float>(d[c] * size);
            s[3] = static_cast<float>(k) / 39;
            samples.push_back(s);
        }
    std::vector<float> faces;
    for (int face = 0; face < 6; ++face)
        for (int t = 0; t < 16; ++t) faces.insert(faces.end(), {0.5f, 0.25f, static_cast<float>(face) / 8, 1});
    auto cube = image_of(TexelFormat::rgba32_float, 4, 4, bytes_of(faces));
    cube->dim = ImageDim::cube;
    cube->layers = 6;
    Shader shader{{"environment.glsl"}, "", "", {}};
    shader.textures = {
        {"samplerCube sky", {"sky", cube, SamplerState{}}},
        {"sampler2D picture", {"picture", image_of(TexelFormat::rgba32_float, 8, 12, bytes_of(faces)), SamplerState{}}}};
    for (const Raw& r : raw(shader, samples,
                            {{"cube", "sample_environment(sky, u3(0), x[3], 1.0)"},
                             {"equirect", "sample_equirect(picture, u3(0), 0.0)"},
                             {"uv", "equirect_uv(u3(0))"},
                             {"face", "vec3(cube_face_coordinates(u3(0), cube_face(u3(0))), float(cube_face(u3(0))))"},
                             {"lod", "environment_lod(1e30 * (x[3] - 0.5), x[3])"}})) {
        expect_finite(r, samples);
        const bool read = r.name[0] == 'c' || r.name.find("equirect") == 0;
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                if (read) return std::fabs(q.at(i) - 0.5) < 1e-6 && q.at(i, 2) >= 0 && q.at(i, 2) <= 0.625 + 1e-6;
                return r.name[0] != 'u' || (q.at(i) >= 0 && q.at(i) <= 1 + 1e-6 && q.at(i, 1) >= 0 && q.at(i, 1) <= 1 + 1e-6);
            },
            "no place in the map");
    }
    // As printed: r = reflect(v, n) for a v without a direction; and atan of two zeroes, which GLSL leaves open.
    const std::vector<Sample> at{{0, 0, 0}};
    for (const Raw& r : raw(shader, at, {{"lecture", "reflect(normalize(u3(0)), vec3(0.0, 0.0, 1.0))"}}))
        EXPECT_EQ(r.non_finite(), 1u) << r.name;
}

TEST(Stability, Row30_SunsInEnvironments) {
    std::vector<float> radiances = neighbourhood({0, 1e-30f, 1, 65504, 65520, 1e5f, 1e9f, 1e30f});
    radiances.push_back(largest_float);
    std::vector<Sample> samples;
    for (const float l : radiances)
        if (l >= 0) samples.push_back({l});
    for (const Raw& r : raw({{"environment.glsl"}, "", "", {}}, samples,
                            {{"kept",
                              "vec3(environment_clamped(vec3(x[0]), 65504.0).x, environment_excess(vec3(x[0]), 65504.0).x, "
                              "unpackHalf2x16(packHalf2x16(environment_clamped(vec3(x[0]), 65504.0).xy)).x)"},
                             {"stored", "unpackHalf2x16(packHalf2x16(vec2(x[0]))).x"}})) {
        if (r.name[0] == 'k') {
            expect_finite(r, samples);
            expect_each(
                r, samples,
                [&](const Raw& q, size_t i) {
                    const double l = static_cast<double>(samples[i][0]);  // what is cut is what the sun gets
                    return q.at(i) <= 65504 && q.at(i, 1) >= 0 && std::fabs(q.at(i) + q.at(i, 1) - l) <= 0x1p-23 * l &&
                           q.at(i, 2) <= 65504;
                },
                "light is lost, or too much for the map");
        } else {
            expect_each(
                r, samples, [&](const Raw& q, size_t i) { return samples[i][0] < 65520 || std::isinf(q.at(i)); },
                "a half float holds it");
        }
    }
    // One such texel makes the means of all that contain it infinite: every level down to the last.
    for (const Raw& r :
         raw({{"environment.glsl"}, "", "", {}}, {{1e5f}},
             {{"mips",
               "float level = unpackHalf2x16(packHalf2x16(vec2(x[0]))).x; for (int i = 0; i < 10; ++i) level = 0.25 * (level "
               "+ 3.0); result = vec4(level);"}}))
        EXPECT_TRUE(std::isinf(r.at(0))) << r.name;
}

}  // namespace
}  // namespace kiln::test
