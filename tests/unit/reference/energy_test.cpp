// Energy compensation against the split-sum quadrature: a white metal reflects all that arrives.

#include "uber/reference/energy.h"

#include <gtest/gtest.h>

#include "uber/reference/split_sum_quadrature.h"

namespace kiln::reference {
namespace {

TEST(Energy, WhiteMetalReflectsAll) {
    const TanhSinh quadrature(40);
    const Vec3<double> white = splat3(1.0);
    for (const double roughness : {0.1, 0.5, 1.0})
        for (const double n_dot_v : {0.05, 0.5, 1.0}) {
            const SplitSum s = split_sum(SmithForm::height_correlated, n_dot_v, roughness, quadrature);
            const Vec2<double> dfg{s.a, s.b};
            const double e = s.a + s.b;
            EXPECT_NEAR(multiscatter_scale(white, e).x * e, 1.0, 1e-12);
            EXPECT_NEAR((single_scatter_albedo(white, dfg) + multiple_scatter_albedo(white, dfg)).x, 1.0, 1e-12);
            EXPECT_NEAR(diffuse_below(white, dfg).x, 0.0, 1e-12);
            // A dielectric keeps what single scattering gave and gains little; nothing reflects more than arrives.
            const Vec3<double> glass = splat3(0.04);
            EXPECT_GE(multiple_scatter_albedo(glass, dfg).x, 0.0);
            EXPECT_LT(multiple_scatter_albedo(glass, dfg).x, 0.01);
            EXPECT_LE(multiscatter_scale(glass, e).x * single_scatter_albedo(glass, dfg).x, 1.0);
        }
}

// The added lobe integrates to what the first one lost: integral of lobe n.l dl = 1 - E(v) for F = 1.
TEST(Energy, AddedLobeIsWhatWasLost) {
    const TanhSinh quadrature(20);
    for (const double roughness : {0.25, 0.5, 1.0}) {
        const auto e = [&](double c) {
            const SplitSum s = split_sum(SmithForm::height_correlated, c, roughness, quadrature);
            return s.a + s.b;
        };
        const SplitSum average = split_sum_average(SmithForm::height_correlated, roughness, quadrature);
        for (const double n_dot_v : {0.1, 0.7}) {
            const double e_v = e(n_dot_v);
            const double added = quadrature(1e-9, 1.0, [&](double c) {
                return 2.0 * pi * c * multiscatter_lobe(e(c), e_v, average.a + average.b, splat3(1.0)).x;
            });
            EXPECT_NEAR(e_v + added, 1.0, 1e-9) << roughness << ' ' << n_dot_v;
        }
    }
}

TEST(Energy, NothingLostNothingAdded) {
    EXPECT_EQ(multiscatter_scale(splat3(0.7), 1.0).x, 1.0);
    EXPECT_EQ(multiscatter_lobe(1.0, 1.0, 1.0, splat3(0.7)).x, 0.0);
    EXPECT_EQ(multiple_scatter_albedo(splat3(0.7), Vec2<double>{1.0, 0.0}).x, 0.0);
}

}  // namespace
}  // namespace kiln::reference
