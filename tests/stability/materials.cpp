// Rows 10, 16 and 17: Fresnel beyond its range, and parameters that no material has.

#include <cmath>

#include "tests/stability/raw.h"

namespace kiln::test {
namespace {

const std::vector<std::string> files{"fresnel.glsl",    "fresnel_fits.glsl",    "fresnel_exact.glsl", "disney.glsl",
                                     "hair_cheap.glsl", "material_models.glsl", "cook_torrance.glsl", "energy.glsl",
                                     "ibl.glsl",        "lecture_brdf.glsl"};

bool within(const Raw& r, size_t i, double low, double high) {
    for (size_t c = 0; c < 3; ++c)
        if (!(r.at(i, c) >= low && r.at(i, c) <= high)) return false;
    return true;
}

TEST(Stability, Row10_CosinesAboveOne) {
    // x[0]: cosine, rounded over 1 or below 0; x[1]: F0.
    std::vector<float> cosines = neighbourhood({-1, -1e-7f, 0, 1e-7f, 0.5f, 1, 1.0000005f, 1.001f});
    const std::vector<Sample> samples = grid({cosines, {0.02f, 0.04f, 0.5f, 0.95f, 1}});
    const std::string f0 = "(x[0], vec3(x[1]))";
    for (const Raw& r : raw({files, "", "", {}}, samples,
                            {{"schlick", "fresnel_schlick" + f0},
                             {"f90", "fresnel_schlick_f90(x[0], vec3(x[1]), vec3(1.0))"},
                             {"pow", "fresnel_schlick_pow" + f0},
                             {"spherical gaussian", "fresnel_spherical_gaussian" + f0},
                             {"pushed", "fresnel_schlick_pushed" + f0},
                             {"disney", "mix(vec3(x[1]), vec3(1.0), schlick_weight(x[0]))"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) { return within(q, i, static_cast<double>(samples[i][1]) * (1 - 2e-7), 1 + 2e-7); },
            "outside [F0, 1]");
    }
    for (const Raw& r : raw({files, "", "", {}}, samples,
                            {{"f82", "fresnel_f82(x[0], vec3(x[1]), vec3(0.9 * x[1] + 0.1))"},
                             {"dielectric", "vec3(fresnel_dielectric(x[0], dielectric_ior(x[1])))"},
                             {"conductor", "vec3(fresnel_conductor(x[0], x[1], 3.9))"},
                             {"hair", "vec3(hair_schlick(x[0]))"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples, [&](const Raw& q, size_t i) { return within(q, i, 0, 1 + 1e-6); }, "outside [0, 1]");
    }
    std::vector<Sample> over;
    for (const Sample& s : samples)
        if (s[0] > 1) over.push_back(s);
    for (const Raw& r : raw({files, "", "", {}}, over, {{"lecture", "vec3(fresnel_schlick_lecture(x[0], x[1]))"}}))
        EXPECT_EQ(r.non_finite(), over.size()) << r.name;
}

TEST(Stability, Row16_ReflectanceOutOfRange) {
    const std::vector<float> f0s = neighbourhood({-1e6f, -2, -0.1f, 0, 0.02f, 0.5f, 1, 1.5f, 2, 1e6f});
    const std::vector<Sample> samples = grid({{0, 1e-3f, 0.1f, 0.5f, 0.9f, 1}, f0s, {0, 0.045f, 0.5f, 1}});
    const std::string v = "vec3(0.6, 0.0, 0.8), vec3(-0.6 * sqrt(1.0 - x[0] * x[0]) - 0.8 * x[0] * 0.0, 0.0, x[0])";
    const std::string f0 = "(x[0], vec3(x[1]))";
    for (const Raw& r : raw({files, "", "", {}}, samples,
                            {{"pushed", "fresnel_schlick_pushed" + f0},
                             {"limited", "fresnel_schlick(x[0], reflectance(vec3(x[1]), vec3(1.0)))"},
                             {"limited twice", "fresnel_schlick(x[0], reflectance(vec3(x[1]), vec3(x[1])))"},
                             {"f82", "fresnel_f82(x[0], reflectance(vec3(x[1]), vec3(1.0)), vec3(0.5))"},
                             {"cook_torrance, diffuse", "cook_torrance(vec3(0.0, 0.0, 1.0), " + v +
                                                            ", vec3(0.5), reflectance(vec3(x[1]), vec3(1.0)), 1.0)"}})) {
        expect_finite(r, samples);
        const bool pushed = r.name.find("pushed") == 0;
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                // Pushed beyond 1 it makes energy; otherwise never more than all.
                const double most = pushed && samples[i][1] > 1 ? 1.01 * static_cast<double>(samples[i][1]) : 1 + 2e-7;
                return within(q, i, 0, most);
            },
            "negative, or above 1 for a reflectance that is not");
    }
    for (const Raw& r :
         raw({files, "", "", {}}, {{0.5f, -0.1f}, {0.5f, 2}}, {{"lecture", "vec3(fresnel_schlick_lecture(x[0], x[1]))"}})) {
        EXPECT_NEAR(r.at(0), -0.0656, 1e-4) << r.name;
        EXPECT_NEAR(r.at(1), 1.969, 1e-3) << r.name;
    }
}

TEST(Stability, Row17_MetallicOutOfRange) {
    const std::vector<Sample> samples =
        grid({neighbourhood({-1e6f, -1, -1e-3f, 0, 0.3f, 1, 1.001f, 2, 1e6f}), {-2, 0, 0.5f, 1, 3}, {-1, 0, 0.5f, 1, 2}});
    const std::string m = "(MetallicRoughness(vec3(x[1]), vec3(0.0, 0.0, 1.0), 0.5, x[0]), x[2])";
    for (const Raw& r : raw({files, "", "", {}}, samples,
                            {{"specular", "metallic_to_specular" + m + ".specular"},
                             {"diffuse", "metallic_to_specular" + m + ".diffuse"},
                             {"pushed specular", "metallic_to_specular_pushed" + m + ".specular"},
                             {"pushed diffuse", "metallic_to_specular_pushed" + m + ".diffuse"},
                             {"metallic_f0", "metallic_f0(reflectance(vec3(x[1]), vec3(1.0)), x[0], x[2])"},
                             {"metallic_diffuse", "metallic_diffuse(reflectance(vec3(x[1]), vec3(1.0)), x[0])"}})) {
        expect_finite(r, samples);
        const double most = r.name.find("pushed") == 0 ? 1e8 : 1;
        expect_each(
            r, samples, [&](const Raw& q, size_t i) { return within(q, i, 0, most); }, "negative, or above 1 where limited");
    }
    const std::string lecture = "metallic_to_specular_lecture(MetallicRoughness(vec3(0.5), vec3(0.0), 0.5, x[0]), 0.5)";
    for (const Raw& r :
         raw({files, "", "", {}}, {{2}, {-1}}, {{"diffuse", lecture + ".diffuse"}, {"specular", lecture + ".specular"}})) {
        const bool diffuse = r.name[0] == 'd';
        EXPECT_NEAR(r.at(0), diffuse ? -0.5 : 0.96, 1e-6) << r.name;
        EXPECT_NEAR(r.at(1), diffuse ? 1 : -0.42, 1e-6) << r.name;
    }
    // What that does to a picture: light that is negative.
    for (const Raw& r :
         raw({files, "", "", {}}, {{2}},
             {{"lecture", "SpecularGlossiness s = " + lecture +
                              "; s.normal = vec3(0.0, 0.0, 1.0); result = vec4(cook_torrance_lecture(s, vec3(0.6, 0.0, "
                              "0.8), vec3(0.8, 0.0, 0.6), 1.0), 1.0);"}}))
        EXPECT_LT(r.at(0), 0.0) << r.name;
}

}  // namespace
}  // namespace kiln::test
