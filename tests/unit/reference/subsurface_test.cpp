// Subsurface references against closed forms, printed values and random walks.

#include "uber/reference/subsurface.h"

#include <gtest/gtest.h>

#include "uber/reference/subsurface_preintegrated.h"
#include "uber/reference/subsurface_separable.h"
#include "uber/reference/subsurface_walk.h"

namespace kiln::reference {
namespace {

// Integral over [0, inf) by r = x / (1 - x) and the midpoint rule.
template <class F>
double integral_to_infinity(F f, int n = 200000) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double x = (i + 0.5) / n;
        sum += f(x / (1 - x)) / ((1 - x) * (1 - x));
    }
    return sum / n;
}

TEST(Subsurface, WrappedDiffuseMakesNoEnergy) {
    for (const double wrap : {0.0, 0.3, 1.0}) {
        double sum = 0;
        const int n = 100000;
        for (int i = 0; i < n; ++i) sum += wrap_diffuse(2 * (i + 0.5) / n - 1, wrap);
        EXPECT_NEAR(2 * pi * sum * 2 / n, pi, 1e-8) << wrap;
    }
}

TEST(Subsurface, ShapesHaveThePrintedValues) {
    const double albedo[] = {0.2, 0.5, 0.8, 0.95};
    const double searchlight[] = {3.162, 1.539, 1.05, 0.923625};
    const double diffuse[] = {2.96, 1.715, 1.1, 1.02875};
    const double path[] = {3.528561, 3.583521, 8.379681, 18.276336};
    for (int i = 0; i < 4; ++i) {
        EXPECT_NEAR(burley_shape_searchlight(splat3(albedo[i])).x, searchlight[i], 1e-12);
        EXPECT_NEAR(burley_shape_diffuse(splat3(albedo[i])).x, diffuse[i], 1e-12);
        EXPECT_NEAR(burley_shape_mean_free_path(splat3(albedo[i])).x, path[i], 1e-12);
    }
}

TEST(Subsurface, BurleyProfileIntegratesToOneAndItsShareFollows) {
    for (const double s : {0.1, 1.0, 40.0}) {
        const auto ring = [&](double r) { return 2 * pi * burley_profile_r(r, splat3(s)).x; };
        EXPECT_NEAR(integral_to_infinity(ring), 1, 1e-7) << s;
        const auto guarded = [&](double r) { return 2 * pi * r * burley_profile(r, splat3(s)).x; };
        EXPECT_NEAR(integral_to_infinity(guarded), 1, 1e-3) << s;  // row 33
        double share = 0;
        const double end = 2 / s;
        const int n = 10000;
        for (int i = 0; i < n; ++i) share += ring(end * (i + 0.5) / n) * end / n;
        EXPECT_NEAR(share, burley_cumulative(end, s), 1e-8) << s;
    }
    EXPECT_TRUE(std::isfinite(burley_profile(0.0, splat3(1.0)).x));
}

TEST(Subsurface, BurleyRadiusIsTheInverse) {
    for (const double u : {0.0, 1e-9, 1e-3, 0.2, 0.5, 0.9, 0.999, 1 - 1e-6}) {
        EXPECT_NEAR(burley_cumulative_textbook(burley_radius_textbook(u, 2.5), 2.5), u, 1e-14) << u;
        EXPECT_NEAR(burley_radius(u, 2.5), burley_radius_textbook(u, 2.5), 1e-14 + 2e-8 * u) << u;
        EXPECT_NEAR(burley_cumulative(0.3 + u, 2.5), burley_cumulative_textbook(0.3 + u, 2.5), 1e-14) << u;
    }
    EXPECT_NEAR(burley_radius(1.0, 1.0), burley_radius(1 - 1e-7, 1.0), 1e-9);
}

TEST(Subsurface, BurleyTapsGatherAConstantAndTheMeanSquareDistance) {
    const auto constant = [](const Vec2<double>&) { return Vec3<double>{1, 2, 3}; };
    const Vec3<double> s{1, 2, 4};
    const Vec3<double> got = burley_gather<double>(constant, {0, 0}, {1, 1}, s, 1.0, 0.3, 16);
    EXPECT_NEAR(got.x, 1, 1e-14);
    EXPECT_NEAR(got.z, 3, 1e-14);
    // Mean of r^2 is 14/s^2, as burley_gaussian_variance has it.
    const auto square = [&](double r) { return 2 * pi * r * r * burley_profile_r(r, splat3(2.0)).x; };
    EXPECT_NEAR(integral_to_infinity(square) / 2, burley_gaussian_variance(2.0), 1e-6);
}

TEST(Subsurface, DipoleAlbedosHaveThePrintedValues) {
    const double albedo[] = {0.5, 0.9, 0.99, 0.999, 0.99999};
    const double at_13[] = {0.07450688, 0.29912916, 0.64452549, 0.86391606, 0.98516762};
    const double at_15[] = {0.07357244, 0.27465814, 0.58310283, 0.82701072, 0.98035478};
    EXPECT_NEAR(dipole_boundary(1.3), 2.6020644, 5e-8);
    EXPECT_NEAR(dipole_boundary(1.5), 3.9594974, 5e-8);
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(dipole_albedo(splat3(albedo[i]), dipole_boundary(1.3)).x, at_13[i], 5e-9);
        EXPECT_NEAR(dipole_albedo(splat3(albedo[i]), dipole_boundary(1.5)).x, at_15[i], 5e-9);
    }
    EXPECT_NEAR(dipole_albedo(splat3(1.0), dipole_boundary(1.3)).x, 1, 1e-15);  // row 33
}

TEST(Subsurface, DipoleProfileIntegratesToItsAlbedo) {
    for (const double eta : {1.3, 1.5})
        for (const double a : {0.5, 0.9, 0.99}) {
            const double boundary = dipole_boundary(eta);
            const auto ring = [&](double r) { return 2 * pi * r * dipole_profile(r, a, 1 - a, boundary); };
            EXPECT_NEAR(integral_to_infinity(ring), dipole_albedo(splat3(a), boundary).x, 1e-7) << eta << ' ' << a;
        }
}

TEST(Subsurface, CircleOfClampedCosineIsItsMean) {
    for (const double theta : {0.0, 0.4, 1.5, 2.0, 3.1})
        for (const double omega : {0.01, 0.7, 1.6, 3.0}) {
            double sum = 0;
            const int n = 20000;
            for (int i = 0; i < n; ++i) {
                const double phi = 2 * pi * (i + 0.5) / n;
                sum += max(cos(theta) * cos(omega) + sin(theta) * sin(omega) * cos(phi), 0.0);
            }
            EXPECT_NEAR(circle_of_clamped_cosine_textbook(cos(theta), cos(omega)), sum / n, 1e-7) << theta << ' ' << omega;
            EXPECT_NEAR(circle_of_clamped_cosine(cos(theta), cos(omega)),
                        circle_of_clamped_cosine_textbook(cos(theta), cos(omega)), 1e-14);
        }
}

TEST(Subsurface, PreintegratedFormsKeepTheSphereMeanAndTheFlatLimit) {
    EXPECT_NEAR(preintegrated_ring(0.37, 0.0, 1.0), 0.37, 1e-15);
    EXPECT_NEAR(preintegrated_sphere(0.37, 0.0), 0.37, 1e-9);
    for (const double k : {0.01, 0.2, 1.0, 30.0}) {
        double sum = 0;
        const int n = 400;
        for (int i = 0; i < n; ++i) sum += preintegrated_sphere(2 * (i + 0.5) / n - 1, k, 64);
        EXPECT_NEAR(sum / n, 0.25, 1e-5) << k;  // the midpoint rule in n.l: step^2 / 24 of a kink's slope
    }
    // The last row is the profile 1/r: steps of equal chord.
    double limit = 0;
    for (int i = 0; i < 32; ++i) {
        const double chord = 2 * (i + 0.5) / 32;
        limit += circle_of_clamped_cosine(2.0 * 3 / 15 - 1, 1 - chord * chord / 2) / 32;
    }
    EXPECT_NEAR(preintegrated_texel<double>(3, 15, 16, 16), limit, 1e-5);
    const Vec2<double> uv = preintegrated_uv(1.0, 1.0, Vec2<double>{16, 32});
    EXPECT_NEAR(uv.x, 15.5 / 16, 1e-15);
    EXPECT_NEAR(uv.y, 0.5, 1e-15);
}

TEST(Subsurface, LineSpreadIntegratesToOneAndIsTheProfileAlongALine) {
    const double s = 1.7;
    const auto root = [&](double t) { return 2 * t * 2 * burley_line_spread(t * t, s); };
    EXPECT_NEAR(integral_to_infinity(root), 1, 1e-7);
    for (const double x : {0.05, 0.8, 4.0}) {
        const auto along = [&](double y) { return 2 * burley_profile(std::sqrt(x * x + y * y), splat3(s)).x; };
        EXPECT_NEAR(integral_to_infinity(along), burley_line_spread(x, s), 1e-7 * burley_line_spread(x, s)) << x;
    }
    // Beyond 9/s lies 1.5 % of the light.
    const auto beyond = [&](double y) { return 2 * burley_line_spread(9 / s + y, s); };
    EXPECT_NEAR(integral_to_infinity(beyond), 0.015, 5e-4);
}

TEST(Subsurface, SeparableKernelsSumToOneAndAreEven) {
    for (const int taps : {7, 17, 25}) {
        for (const auto& kernel : {separable_kernel_skin<double>({1, 0.37, 0.3}, {0.48, 0.41, 0.28}, taps),
                                   separable_kernel_burley<double>({1, 2, 4}, 9.0, taps)}) {
            Vec3<double> sum{};
            for (std::size_t i = 0; i < kernel.size(); ++i) {
                sum = sum + kernel[i].xyz();
                EXPECT_NEAR(kernel[i].y, kernel[kernel.size() - 1 - i].y, 1e-15);
                EXPECT_NEAR(kernel[i].w, -kernel[kernel.size() - 1 - i].w, 1e-15);
            }
            EXPECT_NEAR(sum.x, 1, 1e-14);
            EXPECT_NEAR(sum.z, 1, 1e-14);
        }
    }
}

TEST(SubsurfaceWalk, HalfSpaceReflectsWhatChandrasekharSays) {
    for (const double albedo : {0.5, 0.9, 0.99}) {
        const double exact = half_space_albedo(albedo);
        EXPECT_NEAR(half_space_albedo(albedo, 50), exact, 1e-4);
        const Estimate walk = subsurface_half_space({albedo, 1}, 0, 40000, 1, [](const Vec3<double>&) { return 1.0; });
        std::printf("albedo %.2f: exact %.6f walk %.6f +- %.6f\n", albedo, exact, walk.mean, walk.standard_error);
        EXPECT_NEAR(walk.mean, exact, 4.5 * walk.standard_error) << albedo;
        EXPECT_LT(walk.standard_error, 3e-3);
    }
}

TEST(SubsurfaceWalk, NothingIsLostWithoutAbsorption) {
    const auto one = [](const Vec3<double>&) { return 1.0; };
    EXPECT_NEAR(subsurface_slab({1, 1}, 3, 2000, 2, one).mean, 1, 1e-12);
    EXPECT_NEAR(subsurface_sphere({1, 0.2}, 1, {0, 0, 1}, 2000, 3, one).mean, 1, 1e-12);
}

TEST(SubsurfaceWalk, EmptySlabTransmitsTheExponentialIntegral) {
    // With albedo 0 what crosses is 2 E3(thickness), E3(1) = 0.1096919671.
    const auto back = [](const Vec3<double>& exit) { return exit.z < -0.5 ? 1.0 : 0.0; };
    const Estimate walk = subsurface_slab({0, 1}, 1, 40000, 4, back);
    EXPECT_NEAR(walk.mean, 2 * 0.1096919671, 4.5 * walk.standard_error);
}

// What crosses a slab: Burley's share beyond its thickness, and the sum over the mirror images of a dipole.
TEST(Subsurface, SlabsTransmitTheSharesTheyShould) {
    for (const double d : {0.0, 0.3, 2.0, 9.0})
        EXPECT_NEAR(burley_transmittance(d, 1.3), 1 - burley_cumulative_textbook(d, 1.3), 1e-14);
    // Taps behind a slab have the mean square distance of that profile: integral over rho > d of rho^2, less d^2.
    const double s = 1.3, d = 0.7;
    double taps = 0, density = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vec3<double> tap = burley_through_tap(i, 4000, s, d, 0.0);
        EXPECT_NEAR(tap.x * tap.x + tap.y * tap.y + d * d, tap.z * tap.z, 1e-9);
        taps += (tap.x * tap.x + tap.y * tap.y) / 4000;
    }
    constexpr int steps = 200'000;
    for (int i = 0; i < steps; ++i) {
        const double rho = d + (i + 0.5) * 60 / steps;
        density += (rho * rho - d * d) * s * (std::exp(-s * rho) + std::exp(-s * rho / 3)) / 4 * 60 / steps;
    }
    EXPECT_NEAR(taps, density / burley_transmittance(d, s), 0.01 * taps);
    // The images one by one, where the medium absorbs enough for the sum to end.
    const double a = 0.8, boundary = dipole_boundary(1.0), tr = std::sqrt(3 * (1 - a)), zb = 2 * boundary / 3, thick = 3;
    double sum = 0;
    for (int i = -60; i <= 60; ++i) {
        const double real = 2 * i * (thick + 2 * zb) + 2.0 / 3, image = 2 * i * (thick + 2 * zb) - 2.0 / 3 - 2 * zb;
        const auto out = [&](double z) { return (thick > z ? 1.0 : -1.0) * std::exp(-tr * std::fabs(thick - z)); };
        sum += a / 2 * (out(real) - out(image));
    }
    EXPECT_NEAR(multipole_transmittance_textbook(thick, a, 1 - a, boundary), sum, 1e-12);
    // Nothing absorbed: what diffusion has, (z_r + z_b) / (d + 2 z_b).
    EXPECT_NEAR(multipole_transmittance_textbook(thick, 1, 0, boundary), (2.0 / 3 + zb) / (thick + 2 * zb), 1e-5);
}

TEST(SubsurfaceWalk, SlabsBetweenTheirLimits) {
    // Far inside the light an edge on the back is none, far outside nothing comes.
    const auto far = subsurface_slab_edge({0.9, 1}, 1.5, {1e9, 0.0, -1e9}, 20000, 3);
    const Estimate whole = subsurface_slab({0.9, 1}, 1.5, 20000, 4, [](const Vec3<double>& p) { return p.z < -0.7 ? 1.0 : 0.0; });
    EXPECT_NEAR(far[0].mean, whole.mean, 5 * std::hypot(far[0].standard_error, whole.standard_error));
    EXPECT_NEAR(far[1].mean, 0.5 * whole.mean, 5 * std::hypot(far[1].standard_error, whole.standard_error));
    EXPECT_EQ(far[2].mean, 0.0);
    // A thick slab that absorbs nothing, of the surface's own index: with Milne's extrapolated ends, 0.7104 outside, 4/3 / (d
    // + 1.4208).
    const Estimate thick = subsurface_slab({1, 1}, 8, 400'000, 5, [](const Vec3<double>& p) { return p.z < -4 ? 1.0 : 0.0; });
    EXPECT_NEAR(thick.mean, 4.0 / 3 / (8 + 1.4208), 4 * thick.standard_error);
    EXPECT_NEAR(multipole_transmittance_textbook(8, 1, 0, 1.0), thick.mean, 0.01);
}

TEST(SubsurfaceWalk, InversionOfTheAlbedoHoldsForDiffuseLight) {
    for (const double albedo : {0.2, 0.5, 0.8}) {
        const double single = single_scattering_albedo(splat3(albedo)).x;
        std::printf("albedo %.2f: single %.6f gives %.6f\n", albedo, single, half_space_albedo(single));
        EXPECT_NEAR(half_space_albedo(single), albedo, 0.01);
    }
}

}  // namespace
// Receivers that share their walks see what walks of their own see, with the errors of both.
TEST(SubsurfaceWalk, SharedWalksAgreeWithTheReceiversOwn) {
    const Medium medium{0.9, 1};
    const std::vector<double> at{-2, -0.3, 0.4, 3};
    const auto edge = subsurface_edge(medium, at, 20000, 5);
    for (std::size_t k = 0; k < at.size(); ++k) {
        const Estimate own =
            subsurface_half_space(medium, at[k], 20000, 6 + k, [](const Vec3<double>& p) { return p.x > 0 ? 1.0 : 0.0; });
        EXPECT_NEAR(edge[k].mean, own.mean, 4.5 * std::hypot(edge[k].standard_error, own.standard_error)) << at[k];
        EXPECT_LT(edge[k].standard_error, own.standard_error);
    }
    const std::vector<double> cosines{-0.7, 0.0, 0.2, 0.9};
    const auto sphere = subsurface_terminator(medium, 5, cosines, 20000, 7);
    for (std::size_t k = 0; k < cosines.size(); ++k) {
        const double c = cosines[k];
        const Estimate own = subsurface_sphere(medium, 5, {std::sqrt(1 - c * c), 0, c}, 20000, 8 + k,
                                               [](const Vec3<double>& p) { return std::fmax(p.z / 5, 0.0); });
        EXPECT_NEAR(sphere[k].mean, own.mean, 4.5 * std::hypot(sphere[k].standard_error, own.standard_error)) << c;
        EXPECT_LT(sphere[k].standard_error, own.standard_error);
    }
}

TEST(SubsurfaceWalk, MeansOverACircle) {
    for (const double a : {-1.5, -0.6, 0.0, 0.3, 2.0}) {
        double beyond = 0, clamped = 0;
        const int n = 100000;
        for (int i = 0; i < n; ++i) {
            const double c = std::cos(pi * (i + 0.5) / n);
            beyond += a + 1.3 * c > 0 ? 1.0 / n : 0.0;
            clamped += std::fmax(a + 1.3 * c, 0.0) / n;
        }
        EXPECT_NEAR(share_beyond_an_edge(a, 1.3), beyond, 2e-5) << a;
        EXPECT_NEAR(mean_clamped_cosine(a, 1.3), clamped, 1e-8) << a;
    }
}

}  // namespace kiln::reference
