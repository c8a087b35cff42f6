// The split-sum quadrature against a table that was computed apart from it, closed forms, and itself at other node counts.

#include "uber/reference/split_sum_quadrature.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

struct Entry {
    SmithForm form;
    double roughness, n_dot_v, a, b;
};
// To 8 digits; alpha = roughness^2, Schlick's Fresnel.
const Entry table[] = {
    // clang-format off
    {SmithForm::height_correlated, 0.10, 0.05, 0.24254784, 0.73365975},
    {SmithForm::height_correlated, 0.10, 0.10, 0.41576975, 0.57835420},
    {SmithForm::height_correlated, 0.10, 0.25, 0.76292953, 0.23616242},
    {SmithForm::height_correlated, 0.10, 0.50, 0.96833885, 0.03140327},
    {SmithForm::height_correlated, 0.10, 0.75, 0.99885439, 0.00100395},
    {SmithForm::height_correlated, 0.10, 1.00, 0.99989847, 0.00000009},
    {SmithForm::height_correlated, 0.25, 0.05, 0.44925789, 0.44484705},
    {SmithForm::height_correlated, 0.25, 0.10, 0.50514728, 0.39162235},
    {SmithForm::height_correlated, 0.25, 0.25, 0.75803121, 0.20353574},
    {SmithForm::height_correlated, 0.25, 0.50, 0.95568667, 0.03263733},
    {SmithForm::height_correlated, 0.25, 0.75, 0.99230894, 0.00150219},
    {SmithForm::height_correlated, 0.25, 1.00, 0.99568511, 0.00000295},
    {SmithForm::height_correlated, 0.50, 0.05, 0.76881920, 0.16431254},
    {SmithForm::height_correlated, 0.50, 0.10, 0.75192990, 0.13969245},
    {SmithForm::height_correlated, 0.50, 0.25, 0.75925435, 0.08082755},
    {SmithForm::height_correlated, 0.50, 0.50, 0.83491614, 0.02234730},
    {SmithForm::height_correlated, 0.50, 0.75, 0.88881416, 0.00271873},
    {SmithForm::height_correlated, 0.50, 1.00, 0.91578506, 0.00002737},
    {SmithForm::height_correlated, 0.75, 0.05, 0.83980677, 0.06511869},
    {SmithForm::height_correlated, 0.75, 0.10, 0.79577294, 0.05258290},
    {SmithForm::height_correlated, 0.75, 0.25, 0.71650801, 0.02794833},
    {SmithForm::height_correlated, 0.75, 0.50, 0.65469284, 0.00848301},
    {SmithForm::height_correlated, 0.75, 0.75, 0.63124400, 0.00164136},
    {SmithForm::height_correlated, 0.75, 1.00, 0.62683802, 0.00004764},
    {SmithForm::height_correlated, 1.00, 0.05, 0.81568427, 0.03208961},
    {SmithForm::height_correlated, 1.00, 0.10, 0.73634358, 0.02386689},
    {SmithForm::height_correlated, 1.00, 0.25, 0.58676427, 0.01087626},
    {SmithForm::height_correlated, 1.00, 0.50, 0.44770512, 0.00298874},
    {SmithForm::height_correlated, 1.00, 0.75, 0.36389353, 0.00063307},
    {SmithForm::height_correlated, 1.00, 1.00, 0.30681921, 0.00003361},
    {SmithForm::karis_ibl, 0.10, 0.05, 0.20830218, 0.62414531},
    {SmithForm::karis_ibl, 0.10, 0.10, 0.38295170, 0.53141677},
    {SmithForm::karis_ibl, 0.10, 0.25, 0.74105661, 0.22930148},
    {SmithForm::karis_ibl, 0.10, 0.50, 0.95883893, 0.03109024},
    {SmithForm::karis_ibl, 0.10, 0.75, 0.99555394, 0.00100035},
    {SmithForm::karis_ibl, 0.10, 1.00, 0.99988711, 0.00000008},
    {SmithForm::karis_ibl, 0.25, 0.05, 0.33486172, 0.31005230},
    {SmithForm::karis_ibl, 0.25, 0.10, 0.39126772, 0.29109075},
    {SmithForm::karis_ibl, 0.25, 0.25, 0.65733729, 0.17334749},
    {SmithForm::karis_ibl, 0.25, 0.50, 0.90234945, 0.03047090},
    {SmithForm::karis_ibl, 0.25, 0.75, 0.97173368, 0.00144499},
    {SmithForm::karis_ibl, 0.25, 1.00, 0.99433176, 0.00000263},
    {SmithForm::karis_ibl, 0.50, 0.05, 0.62074208, 0.11505240},
    {SmithForm::karis_ibl, 0.50, 0.10, 0.59017700, 0.09836691},
    {SmithForm::karis_ibl, 0.50, 0.25, 0.60941139, 0.06088431},
    {SmithForm::karis_ibl, 0.50, 0.50, 0.72853449, 0.01854643},
    {SmithForm::karis_ibl, 0.50, 0.75, 0.82753767, 0.00238258},
    {SmithForm::karis_ibl, 0.50, 1.00, 0.89504188, 0.00002417},
    {SmithForm::karis_ibl, 0.75, 0.05, 0.66892716, 0.04170323},
    {SmithForm::karis_ibl, 0.75, 0.10, 0.64088405, 0.03525692},
    {SmithForm::karis_ibl, 0.75, 0.25, 0.59346790, 0.02062534},
    {SmithForm::karis_ibl, 0.75, 0.50, 0.57301219, 0.00696962},
    {SmithForm::karis_ibl, 0.75, 0.75, 0.58205361, 0.00145152},
    {SmithForm::karis_ibl, 0.75, 1.00, 0.60356843, 0.00004454},
    {SmithForm::karis_ibl, 1.00, 0.05, 0.56809989, 0.01638167},
    {SmithForm::karis_ibl, 1.00, 0.10, 0.54436200, 0.01355222},
    {SmithForm::karis_ibl, 1.00, 0.25, 0.48347974, 0.00748477},
    {SmithForm::karis_ibl, 1.00, 0.50, 0.40668146, 0.00245563},
    {SmithForm::karis_ibl, 1.00, 0.75, 0.35010736, 0.00058158},
    {SmithForm::karis_ibl, 1.00, 1.00, 0.30681921, 0.00003361},
    {SmithForm::karis_direct, 0.10, 0.05, 0.02037417, 0.05361523},
    {SmithForm::karis_direct, 0.10, 0.10, 0.07806246, 0.10458959},
    {SmithForm::karis_direct, 0.10, 0.25, 0.36189861, 0.11121749},
    {SmithForm::karis_direct, 0.10, 0.50, 0.73039223, 0.02361353},
    {SmithForm::karis_direct, 0.10, 0.75, 0.90496014, 0.00090548},
    {SmithForm::karis_direct, 0.10, 1.00, 0.99961547, 0.00000004},
    {SmithForm::karis_direct, 0.25, 0.05, 0.07948965, 0.05583848},
    {SmithForm::karis_direct, 0.25, 0.10, 0.12197247, 0.07442611},
    {SmithForm::karis_direct, 0.25, 0.25, 0.33020629, 0.08014238},
    {SmithForm::karis_direct, 0.25, 0.50, 0.66952041, 0.02152741},
    {SmithForm::karis_direct, 0.25, 0.75, 0.86819350, 0.00119863},
    {SmithForm::karis_direct, 0.25, 1.00, 0.98776915, 0.00000154},
    {SmithForm::karis_direct, 0.50, 0.05, 0.29371155, 0.04747704},
    {SmithForm::karis_direct, 0.50, 0.10, 0.31408882, 0.04557888},
    {SmithForm::karis_direct, 0.50, 0.25, 0.39892979, 0.03494738},
    {SmithForm::karis_direct, 0.50, 0.50, 0.57240365, 0.01286056},
    {SmithForm::karis_direct, 0.50, 0.75, 0.73096337, 0.00180527},
    {SmithForm::karis_direct, 0.50, 1.00, 0.85982824, 0.00001703},
    {SmithForm::karis_direct, 0.75, 0.05, 0.48572436, 0.02864414},
    {SmithForm::karis_direct, 0.75, 0.10, 0.48193638, 0.02500126},
    {SmithForm::karis_direct, 0.75, 0.25, 0.48170067, 0.01568057},
    {SmithForm::karis_direct, 0.75, 0.50, 0.50233595, 0.00567124},
    {SmithForm::karis_direct, 0.75, 0.75, 0.53572739, 0.00122421},
    {SmithForm::karis_direct, 0.75, 1.00, 0.57553534, 0.00003749},
    {SmithForm::karis_direct, 1.00, 0.05, 0.56809989, 0.01638167},
    {SmithForm::karis_direct, 1.00, 0.10, 0.54436200, 0.01355222},
    {SmithForm::karis_direct, 1.00, 0.25, 0.48347974, 0.00748477},
    {SmithForm::karis_direct, 1.00, 0.50, 0.40668146, 0.00245563},
    {SmithForm::karis_direct, 1.00, 0.75, 0.35010736, 0.00058158},
    {SmithForm::karis_direct, 1.00, 1.00, 0.30681921, 0.00003361},
    {SmithForm::separable, 0.10, 0.05, 0.24252255, 0.73355679},
    {SmithForm::separable, 0.10, 0.10, 0.41576687, 0.57834940},
    {SmithForm::separable, 0.10, 0.25, 0.76292942, 0.23616238},
    {SmithForm::separable, 0.10, 0.50, 0.96833884, 0.03140327},
    {SmithForm::separable, 0.10, 0.75, 0.99885439, 0.00100395},
    {SmithForm::separable, 0.10, 1.00, 0.99989847, 0.00000009},
    {SmithForm::separable, 0.25, 0.05, 0.44510921, 0.43427335},
    {SmithForm::separable, 0.25, 0.10, 0.50345744, 0.38901516},
    {SmithForm::separable, 0.25, 0.25, 0.75784227, 0.20344978},
    {SmithForm::separable, 0.25, 0.50, 0.95567477, 0.03263640},
    {SmithForm::separable, 0.25, 0.75, 0.99230795, 0.00150217},
    {SmithForm::separable, 0.25, 1.00, 0.99568511, 0.00000295},
    {SmithForm::separable, 0.50, 0.05, 0.73204118, 0.14254047},
    {SmithForm::separable, 0.50, 0.10, 0.72713067, 0.12716571},
    {SmithForm::separable, 0.50, 0.25, 0.75014367, 0.07836869},
    {SmithForm::separable, 0.50, 0.50, 0.83290279, 0.02219574},
    {SmithForm::separable, 0.50, 0.75, 0.88845108, 0.00271366},
    {SmithForm::separable, 0.50, 1.00, 0.91578506, 0.00002737},
    {SmithForm::separable, 0.75, 0.05, 0.72103738, 0.04600207},
    {SmithForm::separable, 0.75, 0.10, 0.70649615, 0.03978009},
    {SmithForm::separable, 0.75, 0.25, 0.67249254, 0.02393091},
    {SmithForm::separable, 0.75, 0.50, 0.63946944, 0.00797395},
    {SmithForm::separable, 0.75, 0.75, 0.62673939, 0.00160624},
    {SmithForm::separable, 0.75, 1.00, 0.62683802, 0.00004764},
    {SmithForm::separable, 1.00, 0.05, 0.56809989, 0.01638167},
    {SmithForm::separable, 1.00, 0.10, 0.54436200, 0.01355222},
    {SmithForm::separable, 1.00, 0.25, 0.48347974, 0.00748477},
    {SmithForm::separable, 1.00, 0.50, 0.40668146, 0.00245563},
    {SmithForm::separable, 1.00, 0.75, 0.35010736, 0.00058158},
    {SmithForm::separable, 1.00, 1.00, 0.30681921, 0.00003361},
    // clang-format on
};

TEST(SplitSum, ReachesTheTableToItsLastDigit) {
    const TanhSinh quadrature(60);
    for (const Entry& e : table) {
        const SplitSum s = split_sum(e.form, e.n_dot_v, e.roughness, quadrature);
        EXPECT_NEAR(s.a, e.a, 0.5001e-8) << int(e.form) << ' ' << e.roughness << ' ' << e.n_dot_v;
        EXPECT_NEAR(s.b, e.b, 0.5001e-8) << int(e.form) << ' ' << e.roughness << ' ' << e.n_dot_v;
    }
}

TEST(SplitSum, NumbersOfNodesAgree) {
    const TanhSinh fine(110), coarse(73);
    for (const double roughness : {0.1, 0.25, 0.5, 1.0})
        for (const double n_dot_v : {0.05, 0.5, 0.9}) {
            const SplitSum f = split_sum(SmithForm::height_correlated, n_dot_v, roughness, fine);
            const SplitSum c = split_sum(SmithForm::height_correlated, n_dot_v, roughness, coarse);
            EXPECT_NEAR(f.a, c.a, 1e-12) << roughness << ' ' << n_dot_v;
            EXPECT_NEAR(f.b, c.b, 1e-12) << roughness << ' ' << n_dot_v;
        }
}

TEST(SplitSum, FrontalViewOfTheRoughestSurfaceHasAClosedForm) {
    const TanhSinh quadrature(110);
    for (const SmithForm form : {SmithForm::height_correlated, SmithForm::separable, SmithForm::karis_ibl}) {
        const SplitSum s = split_sum(form, 1.0, 1.0, quadrature);
        EXPECT_NEAR(s.a + s.b, 1.0 - std::log(2.0), 1e-12) << int(form);
    }
}

TEST(SplitSum, AverageIsTheEnergyThatSingleScatteringKeeps) {
    const TanhSinh quadrature(30);
    const struct {
        double roughness, white, glass;  // F = 1; F0 = 0.04
    } known[] = {{0.1, 0.9994905, 0.0851658},
                 {0.25, 0.9872503, 0.0774957},
                 {0.5, 0.8823234, 0.0532240},
                 {0.75, 0.6562014, 0.0330118},
                 {1.0, 0.4091371, 0.0190110}};
    for (const auto& k : known) {
        const SplitSum s = split_sum_average(SmithForm::height_correlated, k.roughness, quadrature);
        EXPECT_NEAR(s.a + s.b, k.white, 1e-7) << k.roughness;
        EXPECT_NEAR(0.04 * s.a + s.b, k.glass, 1e-7) << k.roughness;
    }
}

// The lecture prints (1 - n.l)^5 for the Fresnel weight, which is right only for a mirror.
TEST(SplitSum, LectureFresnelIsFarTooBright) {
    const TanhSinh quadrature(60);
    const auto albedo = [&](double roughness, double n_dot_v) {
        const SplitSum s = split_sum(
            n_dot_v, roughness * roughness, quadrature,
            [&](double l, double v) { return smith_g2(SmithForm::height_correlated, l, v, roughness); },
            [](const LobeCosines& c) { return std::pow(1.0 - c.n_dot_l, 5.0); });
        return 0.04 * s.a + s.b;
    };
    EXPECT_NEAR(albedo(0.5, 0.5), 0.087685, 1e-6);  // 0.055744 is right
    EXPECT_NEAR(albedo(0.5, 1.0), 0.051854, 1e-6);  // 0.036659
    EXPECT_NEAR(albedo(1.0, 0.1), 0.108434, 1e-6);  // 0.053321
}

}  // namespace
}  // namespace kiln::reference
