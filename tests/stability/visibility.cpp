// Rows 5, 18, 19 and 20: masking at grazing angles and for roughnesses out of range.

#include <cmath>

#include "tests/stability/half_forms.h"
#include "tests/stability/raw.h"
#include "uber/reference/ggx.h"

namespace kiln::test {
namespace {

const std::vector<std::string> visibility_files{
    "ggx.glsl",    "smith.glsl",      "material_models.glsl", "cook_torrance.glsl", "cook_torrance_forms.glsl",
    "disney.glsl", "hair_cheap.glsl", "lecture_brdf.glsl"};

// Whole BRDFs times n.l of x: n, v, l, roughness x[9], with a white specular colour and no diffuse part.
const std::vector<Expression> brdfs{
    {"cook_torrance", "cook_torrance(u3(0), u3(3), u3(6), vec3(0.0), vec3(1.0), x[9])"},
    {"disney_brdf", "disney_brdf(u3(0), u3(3), u3(6), DisneyMaterial(vec3(1.0), 1.0, 0.0, 0.5, x[9], 0.0, 0.0, 0.0, 0.0, 0.0))"},
    {"hammon", "cook_torrance_hammon(u3(0), u3(3), u3(6), vec3(0.0), vec3(1.0), x[9])"}};

// n.l and n.v from grazing on, in random planes; the second half has l and v changed over.
std::vector<Sample> grazing() {
    Directions directions(5);
    std::vector<Sample> out;
    for (const double l : {0.0, 1e-7, 1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0})
        for (const double v : {0.0, 1e-7, 1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0})
            for (const float roughness : {0.0f, 0.045f, 0.1f, 0.3f, 1.0f})
                for (int k = 0; k < 8; ++k) {
                    Sample s{};
                    const auto n = directions.unit();
                    put(s, 0, n);
                    put(s, 3, directions.tilted(n, std::acos(v)));
                    put(s, 6, directions.tilted(n, std::acos(l)));
                    s[9] = roughness;
                    out.push_back(s);
                }
    const size_t half = out.size();
    for (size_t i = 0; i < half; ++i) {
        Sample s = out[i];
        for (size_t c = 3; c < 6; ++c) std::swap(s[c], s[c + 3]);
        out.push_back(s);
    }
    return out;
}

double dot3(const Sample& s, size_t a, size_t b) {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += static_cast<double>(s[a + c]) * static_cast<double>(s[b + c]);
    return sum;
}

TEST(Stability, Row05_GrazingAngles) {
    const std::vector<Sample> samples = grazing();
    const size_t half = samples.size() / 2;
    std::vector<Expression> forms = brdfs;
    // D F at the same arguments: f n.l <= D F / (4 n.v).
    forms.push_back({"D of cook_torrance", "ggx_distribution(u3(0), safe_normalize(u3(3) + u3(6), u3(0)), ggx_alpha(x[9]))"});
    forms.push_back({"D of disney", "ggx_distribution(u3(0), safe_normalize(u3(3) + u3(6), u3(0)), disney_alpha(x[9]))"});
    const std::vector<Raw> all = raw({visibility_files, "", "", {}}, samples, forms);
    for (size_t k = 0; k < all.size(); ++k) {
        const Raw& r = all[k];
        const size_t form = k % forms.size();
        expect_finite(r, samples);
        if (form >= brdfs.size()) continue;
        const Raw& d = all[k - form + brdfs.size() + (form == 1 ? 1 : 0)];
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const double v = std::max(dot3(samples[i], 0, 3), 1e-4), l = dot3(samples[i], 0, 6);
                if (l < -3e-7) return q.at(i) == 0;  // between, the device's n.l may have either sign
                return q.at(i) >= 0 && q.at(i) <= d.at(i) / (4 * v) * (1 + 1e-5);
            },
            "f n.l is above D F / (4 n.v), or light arrives from below");
        // Symmetric: f(l, v) = f(v, l) wherever both are above the clamps.
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                if (i >= half) return true;
                const double v = dot3(samples[i], 0, 3), l = dot3(samples[i], 0, 6);
                if (v < 1.01e-4 || l < 1.01e-4) return true;
                // n.l as the device has it: each product and sum rounds, an absolute error of 2e-7.
                const double slack = 4 * 0x1p-23 + 2.4e-7 / v + 2.4e-7 / l;
                return std::fabs(q.at(i) / l - q.at(half + i) / v) <= slack * q.at(i) / l;
            },
            "not the same with light and viewer changed over");
    }
    // The visibility terms alone, over cosines and alpha: finite, and the same to 4 ulp with the arguments changed over.
    std::vector<float> cosines = neighbourhood({1e-4f, 1e-3f, 0.01f, 0.1f, 0.5f});
    cosines[0] = cosines[1] = 1e-4f;
    cosines.push_back(1);
    const std::vector<Sample> pairs = grid({cosines, cosines, {2.025e-3f, 0.01f, 0.1f, 0.5f, 1}});
    const std::vector<std::string> terms{"ggx_visibility",       "visibility_separable",    "visibility_height_correlated_pushed",
                                         "visibility_karis_ibl", "visibility_karis_direct", "visibility_hammon"};
    std::vector<Expression> visibilities;
    for (const std::string& t : terms)
        visibilities.push_back({t, "vec2(" + t + "(x[0], x[1], x[2]), " + t + "(x[1], x[0], x[2]))"});
    visibilities.push_back({"visibility_kelemen", "vec2(visibility_kelemen(x[0]))"});
    for (const Raw& r : raw({visibility_files, "", "", {}}, pairs, visibilities)) {
        expect_finite(r, pairs);
        expect_each(
            r, pairs, [](const Raw& q, size_t i) { return q.at(i) > 0; }, "not positive");
        expect_each(
            r, pairs, [](const Raw& q, size_t i) { return std::fabs(q.at(i) - q.at(i, 1)) <= 4 * 0x1p-23 * q.at(i, 1); },
            "not symmetric to 4 ulp");
    }
    // As printed: a padded denominator, 71 % too dark where both cosines are 0.01 and nothing at all at 0.
    std::vector<Sample> dark{{0.01f}, {0.1f}, {0}};
    for (const Raw& r :
         raw({visibility_files, "", "", {}}, dark,
             {{"lecture", "specular_lecture(x[0], x[0], 1.0, 1.0, vec3(1.0), 0.5)"},
              {"unpadded", "ggx_distribution_lecture(1.0, 0.5) * smith_lecture(x[0], x[0], 0.5) / (4.0 * x[0] * x[0])"},
              {"height-correlated", "ggx_visibility(x[0], x[0], 0.25)"}})) {
        if (r.name.find("lecture") == 0) {
            const double exact[] = {0.5 * 0.5 / (reference::pi * 0.0625), 0};  // D; G by the printed k below
            const double k = 1.5 * 1.5 / 8;
            for (size_t i = 0; i < 2; ++i) {
                const double c = static_cast<double>(dark[i][0]), g1 = c / (c * (1 - k) + k);
                const double right = exact[0] * g1 * g1 / (4 * c * c);
                EXPECT_NEAR(1 - r.at(i) / right, i == 0 ? 0.714 : 0.0244, 1e-3) << r.name;
            }
            EXPECT_EQ(r.at(2), 0.0) << r.name;
        } else {
            EXPECT_FALSE(std::isfinite(r.at(2))) << r.name << ": 0 / 0 and 0.5 / 0 without the clamp of n.v";
        }
    }
    // V at the clamp itself, and the same in half precision: infinite, so that V has to be limited there.
    Shader coarse{visibility_files, half_forms, half_extension, {}};
    const std::vector<Sample> corner{{1e-4f, 1e-4f, 2.025e-3f}};
    for (const Raw& r :
         raw(coarse, corner,
             {{"V", "ggx_visibility(x[0], x[1], x[2])"},
              {"V, fp16", "float(half_visibility(float16_t(x[0]), float16_t(x[1]), float16_t(x[2])))"},
              {"V, fp16, limited",
               "float(min(half_visibility(float16_t(x[0]), float16_t(x[1]), float16_t(x[2])), float16_t(65504.0)))"}})) {
        if (r.name.find("fp16") == std::string::npos)
            EXPECT_NEAR(r.at(0), reference::ggx_visibility_textbook(1e-4, 1e-4, 2.025e-3), 1) << r.name;
        else if (r.name.find("limited") == std::string::npos)
            EXPECT_TRUE(std::isinf(r.at(0))) << r.name << " " << r.at(0);
        else
            EXPECT_EQ(r.at(0), 65504.0) << r.name;
    }
    EXPECT_NEAR(reference::ggx_visibility_textbook(1e-4, 1e-4, 2.025e-3), 1.23e6, 0.01e6);
}

TEST(Stability, Row18_RoughnessBelowZero) {
    std::vector<Sample> samples;
    for (const Sample& s : grazing())
        for (const float roughness : {-1.0f, -0.5f, -1e-30f}) {
            samples.push_back(s);
            samples.back()[9] = roughness;
        }
    const std::vector<Raw> all = raw({visibility_files, "", "", {}}, samples, brdfs);
    for (const Raw& r : all) {
        expect_finite(r, samples);
        expect_each(
            r, samples, [](const Raw& q, size_t i) { return q.at(i) >= 0; }, "negative");
    }
    // As printed k is 0 for roughness -1 and masking at a cosine of 0 is 0 / 0; D is that of roughness 1.
    const std::vector<Sample> at{{0, 0.5f, -1}, {0.5f, 0, -1}, {0.5f, 0.5f, -1}};
    for (const Raw& r : raw({visibility_files, "", "", {}}, at,
                            {{"G", "smith_lecture(x[0], x[1], x[2])"}, {"D", "ggx_distribution_lecture(1.0, x[2])"}})) {
        if (r.name[0] == 'G') {
            EXPECT_TRUE(std::isnan(r.at(0)) && std::isnan(r.at(1))) << r.name;
            EXPECT_EQ(r.at(2), 1.0) << r.name;
        } else {
            EXPECT_NEAR(r.at(0), 1 / reference::pi, 1e-6) << r.name;
        }
    }
}

TEST(Stability, Row19_RoughnessAboveOne) {
    // D(1) of alpha 1.5, 2 and 3 is what the lecture's form gives for such roughnesses, and a distribution.
    const std::vector<Sample> at{{1.5f}, {2}, {3}};
    const double peak[] = {0.1415, 0.0796, 0.0354}, k[] = {0.78, 1.125, 2};
    for (const Raw& r : raw({visibility_files, "", "", {}}, at,
                            {{"D lecture", "ggx_distribution_lecture(1.0, x[0])"},
                             {"D", "ggx_distribution(vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, 1.0), x[0])"},
                             {"G lecture", "smith_lecture(0.5, 0.5, x[0])"}}))
        for (size_t i = 0; i < 3; ++i) {
            const double g1 = 0.5 / (0.5 * (1 - k[i]) + k[i]);
            if (r.name[0] == 'G')
                EXPECT_NEAR(r.at(i), g1 * g1, 2e-3) << r.name;
            else
                EXPECT_NEAR(r.at(i), peak[i], 1e-4) << r.name;
        }
    // Whole BRDFs pushed to roughness 1.5 to 3 and beyond, by the forms that are for it and by those that limit it.
    std::vector<Sample> samples;
    for (const Sample& s : grazing())
        for (const float roughness : {1.0000001f, 1.5f, 2.0f, 3.0f, 4.0f, 1e30f}) {
            samples.push_back(s);
            samples.back()[9] = roughness;
        }
    std::vector<Expression> forms = brdfs;
    forms.push_back({"pushed",
                     "ggx_distribution(u3(0), safe_normalize(u3(3) + u3(6), u3(0)), ggx_alpha_pushed(x[9])) * "
                     "visibility_height_correlated_pushed(clamp(dot(u3(0), u3(6)), 1e-4, 1.0), clamp(dot(u3(0), u3(3)), 1e-4, "
                     "1.0), ggx_alpha_pushed(x[9]))"});
    for (const Raw& r : raw({visibility_files, "", "", {}}, samples, forms)) {
        expect_finite(r, samples);
        expect_each(
            r, samples, [](const Raw& q, size_t i) { return q.at(i) >= 0; }, "negative");
    }
    // E <= 1: the lobe's directional albedo by a midpoint rule over the hemisphere, on the device.
    const std::vector<Sample> albedo = grid({{0.05f, 0.2f, 0.5f, 0.9f, 1}, {1, 1.5f, 2, 3, 4}});
    const std::string sum = R"(
    const float alpha = ggx_alpha_pushed(x[1]);
    const vec3 n = vec3(0.0, 0.0, 1.0);
    const vec3 v = vec3(sqrt(1.0 - x[0] * x[0]), 0.0, x[0]);
    for (int a = 0; a < 64; ++a)
        for (int b = 0; b < 64; ++b) {
            const float z = (float(a) + 0.5) / 64.0;
            const float phi = 2.0 * pi * ((float(b) + 0.5) / 64.0 - 0.5);
            const vec3 l = vec3(sqrt(1.0 - z * z) * cos(phi), sqrt(1.0 - z * z) * sin(phi), z);
            const float f = ggx_distribution(n, safe_normalize(v + l, n), alpha) *
                            visibility_height_correlated_pushed(max(z, 1e-4), max(x[0], 1e-4), alpha);
            result.x += f * z * (2.0 * pi / 4096.0);
        })";
    for (const Raw& r : raw({visibility_files, "", "", {}}, albedo, {{"albedo", sum}})) {
        expect_finite(r, albedo);
        expect_each(
            r, albedo, [](const Raw& q, size_t i) { return q.at(i) > 0 && q.at(i) <= 1 + 1e-3; }, "E above 1");
    }
}

TEST(Stability, Row20_LambdaForSmallAlpha) {
    std::vector<float> cosines = neighbourhood({1e-18f, 1e-6f, 0.01f, 0.1f, 0.5f, 0.9f, 0.999f});
    cosines[1] = 1e-18f;
    const std::vector<Sample> samples = grid({cosines, {1e-4f, 2e-4f, 1e-3f, 2.025e-3f, 0.01f, 0.1f, 1, 16}});
    const auto lambda = [&](size_t i) {
        const long double c = static_cast<long double>(samples[i][0]), a = static_cast<long double>(samples[i][1]);
        const long double q = a * a * (1 - c * c) / (c * c);
        return static_cast<double>(q / (2 * (1 + std::sqrt(1 + q))));
    };
    for (const Raw& r :
         raw({visibility_files, "", "", {}}, samples, {{"lambda", "smith_lambda(x[0], x[1])"}, {"g1", "smith_g1(x[0], x[1])"}})) {
        expect_finite(r, samples);
        const bool g1 = r.name[0] == 'g';
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const double e = g1 ? 1 / (1 + lambda(i)) : lambda(i);
                return std::fabs(q.at(i) - e) <= 4 * 0x1p-23 * e;
            },
            "more than 4 ulp from the textbook form in long double");
    }
    // As printed in the literature: the root less 1 keeps no digit, and tan^2 leaves the format.
    const std::vector<Sample> at{{0.9f, 1e-3f}, {0.99f, 2e-4f}, {1e-20f, 1e-3f}};
    const std::string tan2 = "(1.0 - x[0] * x[0]) / (x[0] * x[0])";
    for (const Raw& r : raw({visibility_files, "", "", {}}, at,
                            {{"difference", "precise float q = x[1] * x[1] * (" + tan2 +
                                                "); precise float root = sqrt(1.0 + q); result = vec4((root - 1.0) * 0.5);"},
                             {"g1", "1.0 / (1.0 + (sqrt(1.0 + x[1] * x[1] * (" + tan2 + ")) - 1.0) * 0.5)"},
                             {"g1 kiln", "smith_g1(x[0], x[1])"}})) {
        if (r.name.find("difference") == 0) {
            EXPECT_NEAR(r.at(0), 5.96046e-8, 1e-12) << r.name;
            EXPECT_NEAR(r.at(0) / 5.8642e-8, 1.016, 1e-3) << r.name;
            EXPECT_EQ(r.at(1), 0.0) << r.name;
        } else if (r.name.find("kiln") != std::string::npos) {
            EXPECT_NEAR(r.at(2) / 2e-17, 1, 1e-6) << r.name;  // 2 c / alpha
        } else {
            EXPECT_EQ(r.at(2), 0.0) << r.name;
        }
    }
}

}  // namespace
}  // namespace kiln::test
