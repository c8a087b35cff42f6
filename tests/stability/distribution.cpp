// Rows 1 to 4: the peak of the GGX distribution.

#include <cmath>

#include "tests/stability/half_forms.h"
#include "tests/stability/raw.h"
#include "uber/reference/half.h"

namespace kiln::test {
namespace {

const double pi = reference::pi;
const double least_alpha = 0.045 * 0.045, least_half_alpha = 0.089 * 0.089;

Shader distribution() {
    return {{"ggx.glsl", "ggx_forms.glsl", "gtr.glsl", "material_models.glsl", "lecture_brdf.glsl"}, "", "", {}};
}

TEST(Stability, Row01_DistributionAtAlphaZero) {
    // x[0]: roughness as a material may have it.
    const std::vector<float> roughness =
        neighbourhood({-largest_float, -3, -1, -1e-30f, 0, 1e-40f, 1e-30f, 1e-5f, 0.02f, 0.045f});
    const std::vector<Sample> samples = grid({roughness});
    const std::string n = "vec3(0.0, 0.0, 1.0)";
    for (const Raw& r : raw(distribution(), samples,
                            {{"h - n", "ggx_distribution(" + n + ", " + n + ", ggx_alpha(x[0]))"},
                             {"cross", "ggx_distribution_cross(" + n + ", " + n + ", ggx_alpha(x[0]))"},
                             {"cosine", "ggx_distribution_cosine(1.0, ggx_alpha(x[0]))"},
                             {"pushed", "ggx_distribution(" + n + ", " + n + ", ggx_alpha_pushed(x[0]))"},
                             {"gtr1", "gtr1_distribution(" + n + ", " + n + ", ggx_alpha(x[0]))"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples,
            [](const Raw& q, size_t i) { return q.at(i) > 0 && q.at(i) <= (1 + 2e-6) / (pi * least_alpha * least_alpha); },
            "above 1 / (pi alpha_min^2)");
    }
    // As printed alpha 0 is 0 / 0, in single and in half precision.
    Shader lecture = distribution();
    lecture.extensions = half_extension;
    lecture.declared = half_forms;
    const std::vector<Sample> zero = grid({{0, -0.0f}});
    for (const Raw& r : raw(lecture, zero,
                            {{"lecture", "ggx_distribution_lecture(1.0, x[0])"},
                             {"lecture, fp16", "float(half_square_form(float16_t(1.0), float16_t(x[0])))"}}))
        expect_each(
            r, zero, [](const Raw& q, size_t i) { return std::isnan(q.at(i)); }, "0 / 0 has a value");
    // From which alpha on D(1) has a value at all: 1 / (pi alpha^2) < 65504 at 2.2044e-3 in half precision, and
    // < FLT_MAX at 3.06e-20 in single, where alpha^2 is far below the normal numbers and only 1 / alpha is used.
    const std::vector<Sample> ends = grid({{2.19e-3f, 2.215e-3f, static_cast<float>(least_half_alpha)}});
    for (const Raw& r :
         raw(lecture, ends,
             {{"h - n, fp16", "float(half_difference(f16vec3(0.0, 0.0, 1.0), f16vec3(0.0, 0.0, 1.0), float16_t(x[0])))"}})) {
        EXPECT_TRUE(std::isinf(r.at(0))) << r.name << " " << r.at(0);
        EXPECT_GT(r.at(1), 0.97 * 65504) << r.name;
        EXPECT_TRUE(std::isfinite(r.at(1))) << r.name;
        EXPECT_NEAR(r.at(2) * pi * least_half_alpha * least_half_alpha, 1, 6e-3) << r.name;
    }
    for (const Raw& r :
         raw(distribution(), grid({{3.06e-20f, 3.2e-20f, 1e-12f}}), {{"1 / (pi alpha^2)", "1.0 / x[0] / pi / x[0]"}}))
        EXPECT_TRUE(std::isfinite(r.at(1)) && r.at(1) > 3e38) << r.name << " " << r.at(1);
}

TEST(Stability, Row02_DistributionAtThePeakForSmallAlpha) {
    std::vector<float> alphas =
        neighbourhood({1e-5f, 3e-5f, 1e-4f, 1.7e-4f, 1.8e-4f, 2e-4f, 5e-4f, 1e-3f, 2.025e-3f, 0.01f, 0.1f, 1});
    alphas.back() = 1;
    const std::vector<Sample> samples = grid({alphas});
    const std::string n = "vec3(0.0, 0.0, 1.0)";
    const auto exact = [](double alpha) { return 1 / (pi * alpha * alpha); };
    for (const Raw& r : raw(distribution(), samples,
                            {{"h - n", "ggx_distribution(" + n + ", " + n + ", x[0])"},
                             {"cross", "ggx_distribution_cross(" + n + ", " + n + ", x[0])"},
                             {"cosine", "ggx_distribution_cosine(1.0, x[0])"},
                             {"sine", "ggx_from_sine(1.0, 0.0, x[0])"}})) {
        expect_finite(r, samples);
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const double e = exact(static_cast<double>(samples[i][0]));
                return std::fabs(q.at(i) - e) <= 1e-6 * e;
            },
            "more than 1e-6 from 1 / (pi alpha^2)");
    }
    // As printed: a2 - 1 rounds to -1 and f is 0; then wrong values of the predicted size.
    const std::vector<Sample> infinite = grid({neighbourhood({1e-5f, 2e-5f, 5e-5f, 1e-4f, 1.69e-4f})});
    for (const Raw& r : raw(distribution(), infinite, {{"lecture", "ggx_distribution_lecture(1.0, x[0])"}}))
        expect_each(
            r, infinite, [](const Raw& q, size_t i) { return std::isinf(q.at(i)); }, "has a value");
    struct Wrong {
        float alpha;
        double predicted;
    };
    const std::vector<Wrong> wrong{{1.8e-4f, 2.90e6}, {2e-4f, 3.58e6}, {5e-4f, 1.400e6}, {1e-3f, 310022}};
    std::vector<Sample> at;
    for (const Wrong& w : wrong) at.push_back({w.alpha});
    for (const Raw& r : raw(distribution(), at, {{"lecture", "ggx_distribution_lecture(1.0, x[0])"}}))
        for (size_t i = 0; i < at.size(); ++i) {
            EXPECT_NEAR(r.at(i), wrong[i].predicted, 2e-3 * wrong[i].predicted) << r.name << " " << wrong[i].alpha;
            EXPECT_GT(std::fabs(r.at(i) / exact(static_cast<double>(wrong[i].alpha)) - 1), 0.02) << r.name;
        }
    // Half precision: inf up to 0.01 on this device, and on the CPU's halves the same to the bit.
    Shader half = distribution();
    half.extensions = half_extension;
    half.declared = half_forms;
    const std::vector<Sample> coarse = grid({{1e-3f, 5e-3f, 0.01f, 0.02f, 0.05f}});
    for (const Raw& r : raw(half, coarse, {{"lecture, fp16", "float(half_square_form(float16_t(1.0), float16_t(x[0])))"}})) {
        for (size_t i = 0; i < 3; ++i) EXPECT_TRUE(std::isinf(r.at(i))) << r.name << " " << r.at(i);
        EXPECT_NEAR(r.at(3), 516.5, 0.5) << r.name;  // 795.8
        EXPECT_NEAR(r.at(4), 133.5, 0.2) << r.name;  // 127.3
        for (size_t i = 3; i < 5; ++i) {
            using reference::Half;
            const Half a(samples.empty() ? 0.0f : coarse[i][0]), a2 = a * a;
            const Half f = Half(1) * Half(1) * (a2 - Half(1)) + Half(1);
            EXPECT_EQ(reference::value(a2 / (Half(pi) * f * f)), r.at(i)) << r.name;
        }
    }
}

// Largest relative error of each form over random frames and angles up to 3 alpha, against D in double of the same rounded
// vectors; the share that is not finite.
struct Worst {
    double error = 0, non_finite = 0;
};

double exact_distribution(const std::array<double, 3>& n, const std::array<double, 3>& h, double alpha) {
    double nn = 0, hh = 0, nh = 0;
    for (size_t c = 0; c < 3; ++c) nn += n[c] * n[c], hh += h[c] * h[c], nh += n[c] * h[c];
    double dd = 0;  // |h / |h| - n / |n||^2
    for (size_t c = 0; c < 3; ++c) {
        const double d = h[c] / std::sqrt(hh) - n[c] / std::sqrt(nn);
        dd += d * d;
    }
    const double cosine = 1 - dd / 2, sine2 = dd * (1 - dd / 4), k = alpha / (sine2 + alpha * alpha * cosine * cosine);
    return k * k / pi;
}

Worst worst_of(const Raw& r, const std::vector<Sample>& samples, bool halves) {
    Worst w;
    for (size_t i = 0; i < samples.size(); ++i) {
        std::array<double, 3> n = get(samples[i], 0), h = get(samples[i], 3);
        double alpha = static_cast<double>(samples[i][6]);
        if (halves) {
            for (double& c : n) c = static_cast<double>(reference::round_to_half(static_cast<float>(c)));
            for (double& c : h) c = static_cast<double>(reference::round_to_half(static_cast<float>(c)));
            alpha = static_cast<double>(reference::round_to_half(samples[i][6]));
        }
        const double exact = exact_distribution(n, h, alpha);
        if (std::isfinite(r.at(i)))
            w.error = std::max(w.error, std::fabs(r.at(i) - exact) / exact);
        else
            w.non_finite += 1.0 / static_cast<double>(samples.size());
    }
    return w;
}

std::vector<Sample> frames(double alpha, size_t count) {
    Directions directions(3);
    std::vector<Sample> out(count);
    for (Sample& s : out) {
        const auto n = directions.unit();
        put(s, 0, n);
        put(s, 3, directions.tilted(n, directions.uniform(0, 3 * alpha)));
        s[6] = static_cast<float>(alpha);
    }
    return out;
}

TEST(Stability, Row03_DistributionOverRandomFrames) {
    const double alphas[] = {1e-4, 5e-4, 1e-3, 2.025e-3, 0.01, 0.1};
    const double square[] = {99, 3.55, 0.505, 0.112, 5.6e-3, 5.4e-5};  // predicted, 99 for 73 % not finite
    const double cosine[] = {99, 3.1, 0.55, 0.12, 5.3e-3, 5.3e-5};
    for (size_t a = 0; a < 6; ++a) {
        const double alpha = alphas[a];
        const std::vector<Sample> samples = frames(alpha, 20'000);
        for (const Raw& r : raw(distribution(), samples,
                                {{"h - n", "ggx_distribution(u3(0), u3(3), x[6])"},
                                 {"cross", "ggx_distribution_cross(u3(0), u3(3), x[6])"},
                                 {"cosine", "ggx_distribution_cosine(dot(u3(0), u3(3)), x[6])"},
                                 {"lecture", "ggx_distribution_lecture(dot(u3(0), u3(3)), x[6])"}})) {
            const Worst w = worst_of(r, samples, false);
            std::printf("KILN_ROW 3 alpha %g %s %.3g, not finite %.3f\n", alpha, r.name.c_str(), w.error, w.non_finite);
            if (r.name.find("h - n") == 0 || r.name.find("cross") == 0) {
                expect_finite(r, samples);
                EXPECT_LE(w.error, r.name.find("cross") == 0 ? 1.2e-7 / alpha + 1e-6 : 2e-6) << r.name << " " << alpha;
            } else if (r.name.find("cosine") == 0) {  // finite, but n.h has forgotten the angle
                expect_finite(r, samples);
                if (a > 0) {
                    EXPECT_GT(w.error, cosine[a] / 3) << r.name << " " << alpha;
                    EXPECT_LT(w.error, cosine[a] * 3) << r.name << " " << alpha;
                }
            } else if (a == 0) {
                EXPECT_GT(w.non_finite, 0.5) << r.name;
            } else {
                EXPECT_GT(w.error, square[a] / 3) << r.name << " " << alpha;
                EXPECT_LT(w.error, square[a] * 3) << r.name << " " << alpha;
            }
        }
    }
    Shader half = distribution();
    half.extensions = half_extension;
    half.declared = half_forms;
    const std::string vectors = "(f16vec3(u3(0)), f16vec3(u3(3)), float16_t(x[6])))";
    for (const double alpha : {least_half_alpha, 0.01, 0.03, 0.1}) {
        const std::vector<Sample> samples = frames(alpha, 20'000);
        for (const Raw& r :
             raw(half, samples,
                 {{"h - n, fp16", "float(half_difference" + vectors},
                  {"cross, fp16", "float(half_cross" + vectors},
                  {"lecture, fp16", "float(half_square_form(dot(f16vec3(u3(0)), f16vec3(u3(3))), float16_t(x[6])))"}})) {
            const Worst w = worst_of(r, samples, true);
            std::printf("KILN_ROW 3 alpha %g %s %.3g, not finite %.3f\n", alpha, r.name.c_str(), w.error, w.non_finite);
            if (r.name.find("h - n") == 0) {
                EXPECT_EQ(r.non_finite(), 0u) << r.name;
                EXPECT_LE(w.error, 2e-2) << r.name << " " << alpha;
            } else if (r.name.find("cross") == 0) {
                EXPECT_EQ(r.non_finite(), 0u) << r.name;
                EXPECT_LE(w.error, 0.2) << r.name << " " << alpha;
            } else if (alpha <= 0.01) {
                EXPECT_GE(w.non_finite, 0.5) << r.name << " " << alpha;
            } else {
                EXPECT_GT(w.error, alpha < 0.05 ? 3 : 0.2) << r.name << " " << alpha;
            }
        }
    }
}

TEST(Stability, Row04_CosinesForgetSmallAngles) {
    // Half a quantum of n.h below 1 is an angle of 0.0198 degrees in single, 1.79 in half precision. Below that n.h is 1 or
    // the next number, whatever the angle; h - n still tells.
    Shader half = distribution();
    half.extensions = half_extension;
    half.declared = half_forms;
    std::vector<Sample> samples;
    for (const double degrees : {0.0, 0.002, 0.004, 0.008, 0.012}) {
        const double angle = degrees * pi / 180;
        Sample s{};
        put(s, 0, {0, 0, 1});
        put(s, 3, {std::sin(angle), 0, std::cos(angle)});
        samples.push_back(s);
    }
    for (const Raw& r : raw(half, samples,
                            {{"cosine", "dot(u3(0), u3(3))"},
                             {"h - n", "ggx_distribution(u3(0), u3(3), 0.002025)"},
                             {"D of the cosine", "ggx_distribution_cosine(dot(u3(0), u3(3)), 0.002025)"}}))
        for (size_t i = 1; i < samples.size(); ++i) {
            const double exact = exact_distribution(get(samples[i], 0), get(samples[i], 3), 2.025e-3);
            if (r.name.find("cosine") == 0) {
                EXPECT_EQ(r.at(i), 1.0) << r.name << " " << i;
            } else if (r.name.find("h - n") == 0) {
                EXPECT_NEAR(r.at(i) / exact, 1, 2e-6) << r.name;
                EXPECT_LT(r.at(i), r.at(i - 1)) << r.name;
            } else {
                EXPECT_EQ(r.at(i), r.at(0)) << r.name;
            }
        }
    std::vector<Sample> coarse;
    for (const double degrees : {0.5, 1.0, 1.2}) {
        Sample s{};
        put(s, 0, {0, 0, 1});
        put(s, 3, {std::sin(degrees * pi / 180), 0, std::cos(degrees * pi / 180)});
        coarse.push_back(s);
    }
    for (const Raw& r : raw(half, coarse,
                            {{"cosine, fp16", "float(dot(f16vec3(u3(0)), f16vec3(u3(3))))"},
                             {"difference, fp16", "float(length(f16vec3(u3(3)) - f16vec3(u3(0))))"}}))
        for (size_t i = 0; i < coarse.size(); ++i) {
            if (r.name.find("cosine") == 0)
                EXPECT_EQ(r.at(i), 1.0) << r.name;
            else
                EXPECT_NEAR(r.at(i) / static_cast<double>(coarse[i][3]), 1, 1e-2) << r.name;
        }
    EXPECT_NEAR(std::acos(static_cast<double>(std::nextafter(1.0f, 0.0f))) * 180 / pi, 0.0198, 1e-4);
    EXPECT_NEAR(std::acos(1 - 0x1p-11) * 180 / pi, 1.79, 1e-2);
}

}  // namespace
}  // namespace kiln::test
