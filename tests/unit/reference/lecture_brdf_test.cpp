// The lecture's forms fail as predicted: in double what they mean, in float and half what they lose.

#include "uber/reference/lecture_brdf.h"

#include <gtest/gtest.h>

#include "uber/reference/blinn_phong_raw.h"
#include "uber/reference/furnace.h"
#include "uber/reference/ggx.h"
#include "uber/reference/ggx_forms.h"
#include "uber/reference/half.h"
#include "uber/reference/random.h"

namespace kiln::reference {
namespace {

using V3 = Vec3<double>;

TEST(LectureBrdf, SampleIsTooDark) {
    EXPECT_NEAR(ggx_distribution_lecture(0.95, 0.5), 0.762165024, 5e-10);  // 0.839880758 for alpha = r^2
    EXPECT_NEAR(ggx_distribution_lecture(1.0, 0.5), 1.273240, 5e-7);       // 5.092958
    EXPECT_NEAR(specular_lecture(0.6, 0.8, 0.95, 0.75, splat3(0.04), 0.5).x, 0.012779055, 5e-10);
    EXPECT_NEAR(smith_lecture(0.1, 0.1, 0.5) / (4 * 0.1 * 0.1 + 0.001), 1.95595659, 5e-9);
}

TEST(LectureBrdf, PaddedDenominator) {
    for (const auto& [cosine, loss] :
         {std::pair{1.0, .00025}, {.5, .001}, {.1, .0244}, {.05, .0909}, {.01, .7143}, {.003, .9653}}) {
        const double plain = 4 * cosine * cosine;
        EXPECT_NEAR(1 - plain / (plain + 0.001), loss, 5.1e-5) << cosine;
        const double g = smith_lecture(cosine, cosine, 0.5), d = ggx_distribution_lecture(0.9, 0.5);
        EXPECT_NEAR(specular_lecture(cosine, cosine, 0.9, 0.9, splat3(1.0), 0.5).x / (d * g / plain), 1 - loss, 5.1e-5) << cosine;
    }
}

TEST(LectureBrdf, DistributionInFloatAndHalf) {
    EXPECT_TRUE(std::isnan(ggx_distribution_lecture(1.0f, 0.0f)));
    for (const float alpha : {1e-5f, 1e-4f, 1.7e-4f}) EXPECT_TRUE(std::isinf(ggx_distribution_lecture(1.0f, alpha))) << alpha;
    const struct {
        double alpha, wrong, exact;
    } rows[] = {{1.8e-4, 2.90e6, 9.82e6}, {2e-4, 3.58e6, 7.96e6}, {5e-4, 1.400e6, 1.273e6}, {1e-3, 310022, 318310}};
    for (const auto& row : rows) {
        EXPECT_NEAR(static_cast<double>(ggx_distribution_lecture(1.0f, static_cast<float>(row.alpha))) / row.wrong, 1, 2e-3)
            << row.alpha;
        EXPECT_NEAR(ggx_distribution_lecture(1.0, row.alpha) / row.exact, 1, 1e-3) << row.alpha;
    }
    for (const double alpha : {1e-3, 0.005, 0.01})
        EXPECT_FALSE(std::isfinite(value(ggx_distribution_lecture(Half(1.0), Half(alpha))))) << alpha;
    EXPECT_NEAR(value(ggx_distribution_lecture(Half(1.0), Half(0.02))), 516.5, 0.5);
    EXPECT_NEAR(value(ggx_distribution_lecture(Half(1.0), Half(0.05))), 133.5, 0.5);
}

// Forms of D over random frames and angles up to 3 alpha, in T, against the angle between the same rounded vectors.
struct Worst {
    double lecture = 0, cosine = 0, cross = 0, difference = 0;  // largest relative error of finite results
    double lecture_lost = 0;                                    // share that is not finite
};
template <class T>
Worst worst_of_forms(double alpha) {
    Random random(11);
    Worst worst;
    const auto rounded = [](const V3& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    const auto exact = [](const Vec3<T>& v) { return normalize(V3{value(v.x), value(v.y), value(v.z)}); };
    const int samples = 20000;
    for (int i = 0; i < samples; ++i) {
        const V3 axis = from_polar(2 * random() - 1, 2 * pi * random());
        const V3 aside = normalize(cross(axis, V3{random() - 0.5, random() - 0.5, random() - 0.5}));
        const double theta = 3 * alpha * random();
        const Vec3<T> n = rounded(axis), h = rounded(axis * std::cos(theta) + aside * std::sin(theta));
        const V3 across = cross(exact(n), exact(h));
        const T a = T(alpha);
        const double d = ggx_from_sine(dot(exact(n), exact(h)), dot(across, across), value(a));
        const auto take = [&](double& most, const T& result) {
            const double error = std::fabs(value(result) / d - 1);
            if (std::isfinite(error)) most = std::fmax(most, error);
            return !std::isfinite(error);
        };
        worst.lecture_lost += take(worst.lecture, ggx_distribution_lecture(saturate(dot(n, h)), a)) / double(samples);
        take(worst.cosine, ggx_distribution_cosine(dot(n, h), a));
        take(worst.cross, ggx_distribution_cross(n, h, a));
        EXPECT_FALSE(take(worst.difference, ggx_distribution(n, h, a))) << alpha;
    }
    return worst;
}

TEST(LectureBrdf, FormsOfTheDistributionInFloat) {
    const struct { double alpha, lecture; } rows[] = {{5e-4, 3.55}, {1e-3, .505}, {2.025e-3, .112}, {.01, 5.6e-3}, {.1, 5.4e-5}};
    for (const auto& row : rows) {
        const Worst w = worst_of_forms<float>(row.alpha);
        EXPECT_GT(w.lecture, 0.6 * row.lecture) << row.alpha;
        EXPECT_LT(w.lecture, 1.6 * row.lecture) << row.alpha;
        EXPECT_LE(w.cross, 1.2e-7 / row.alpha + 1e-6) << row.alpha;
        EXPECT_LE(w.difference, 2e-6) << row.alpha;
    }
    const Worst w = worst_of_forms<float>(1e-4);
    EXPECT_LE(w.difference, 2e-6);
}

TEST(LectureBrdf, FormsOfTheDistributionInHalf) {
    for (const double alpha : {.0079, .03, .1}) {
        const Worst w = worst_of_forms<Half>(alpha);
        EXPECT_LE(w.difference, 2e-2) << alpha;
    }
    EXPECT_GE(worst_of_forms<Half>(.0079).lecture_lost, 0.69);
    EXPECT_GT(worst_of_forms<Half>(.03).lecture, 5.0);
}

TEST(LectureBrdf, FresnelAboveOne) {
    EXPECT_EQ(std::nextafter(1.0f, 2.0f), 1.0f + 0x1p-23f);
    EXPECT_LT(fresnel_schlick_lecture(std::nextafter(1.0f, 2.0f), 0.0f), 0.0f);  // -2.4e-35 in C; NaN in GLSL
    EXPECT_NEAR(fresnel_schlick_lecture(0.5, 0.04), 0.07, 1e-15);
    EXPECT_NEAR(fresnel_schlick_lecture(0.5, -0.1), -0.065625, 1e-15);
    EXPECT_NEAR(fresnel_schlick_lecture(0.5, 2.0), 1.96875, 1e-15);
}

TEST(LectureBrdf, OppositeViewHasNoHalfVector) {
    const SpecularGlossiness<double> m{splat3(0.04), splat3(0.5), {0, 0, 1}, 0.5};
    EXPECT_TRUE(std::isnan(normalize(V3{0, 0, 1} + V3{0, 0, -1}).x));  // and only the clamp of n.h hides it:
    EXPECT_NEAR(cook_torrance_lecture(m, V3{0, 0, 1}, V3{0, 0, -1}, 1.0).x, 0.5 / pi, 1e-12);
    EXPECT_NEAR(cook_torrance_lecture(m, V3{0, 0, 1}, V3{0, 0, 1}, 1.0).x,
                0.5 / pi + ggx_distribution_lecture(1.0, 0.5) * 0.04 / 4.001, 1e-12);
}

TEST(LectureBrdf, BlinnPhongShinesThroughFromBehind) {
    const V3 n{0, 0, 1}, v = from_polar(0.9, 0), behind = from_polar(-0.2, pi);
    const V3 none = splat3(0.0), white = splat3(1.0);
    EXPECT_GT(blinn_phong_lecture(n, v, behind, none, white, 2.0).x, 0.1);
    EXPECT_EQ(blinn_phong_raw(n, v, behind, none, white, 2.0).x, 0.0);
    EXPECT_EQ(blinn_phong_raw(n, v, -v, white, white, 2.0).x, 0.0);
    EXPECT_EQ(phong_power(0.0, 0.0), 1.0);
    EXPECT_EQ(phong_power(-1.0, 3.0), 0.0);
}

// integral of (n.h)^p n.l dl = 8 pi (2^(-p/2) + p) / ((p + 2) (p + 4)) at v = n.
TEST(BlinnPhongRaw, ReflectsWhatTheClosedFormSays) {
    const TanhSinh quadrature(60);
    for (const auto& [p, reflected] :
         {std::pair{1.0, 2.860284865}, {10.0, 1.500671491}, {50.0, .447520321}, {100.0, .236922523}, {1000.0, .024982645}}) {
        const double albedo =
            specular_albedo(1.0, std::sqrt(2 / (p + 2)), quadrature, [&, e = p](const V3& n, const V3& v, const V3& l) {
                return blinn_phong_raw(n, v, l, splat3(0.0), splat3(1.0), e).x;
            });
        EXPECT_NEAR(albedo, reflected, 5.1e-10) << p;
        EXPECT_NEAR(albedo, 8 * pi * (std::exp2(-p / 2) + p) / ((p + 2) * (p + 4)), 1e-10) << p;
    }
}

TEST(Half, RoundsAsFp16) {
    EXPECT_EQ(round_to_half(65519.0f), 65504.0f);
    EXPECT_TRUE(std::isinf(round_to_half(65520.0f)));
    EXPECT_EQ(round_to_half(2e-8f), 0.0f);
    EXPECT_EQ(round_to_half(0x1p-24f), 0x1p-24f);
    EXPECT_EQ(round_to_half(1.0f + 0x1p-11f), 1.0f);  // tie to even
    EXPECT_EQ(round_to_half(1.0f + 0x3p-11f), 1.0f + 0x1p-9f);
    EXPECT_TRUE(std::isinf(value(Half(300) * Half(300))));
    EXPECT_EQ(value(Half(1024.0) + Half(0.25)), 1024.0);
}

}  // namespace
}  // namespace kiln::reference
