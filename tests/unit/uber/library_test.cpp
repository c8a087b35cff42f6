// The formulas of uber/lib against closed forms, tables of double-precision integrals, and themselves in double precision.
#include "tests/unit/uber/library.h"

#include <gtest/gtest.h>

#include <random>

namespace {

using twice::Real;
using twice::vec2;
using twice::vec3;
using twice::vec4;

constexpr double pi = 3.14159265358979323846;

double value(twice::Real x) { return x.v; }
double value(single::Real x) { return static_cast<double>(x.v); }

bool finite(single::vec3 c) { return std::isfinite(c.x.v) && std::isfinite(c.y.v) && std::isfinite(c.z.v); }

// Unit vector at an angle from (0, 0, 1).
vec3 at(double cosine, double azimuth = 0.0) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}
single::vec3 narrow(vec3 a) { return {value(a.x), value(a.y), value(a.z)}; }

const vec3 up(0.0, 0.0, 1.0);

// Integral over the hemisphere of what `reflect` gives for light directions, by half vectors spread as GGX spreads them.
template <class Reflect>
double albedo(double n_dot_v, double alpha, Reflect reflect) {
    constexpr int steps = 240;
    const vec3 v = at(n_dot_v);
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double w = (i + 0.5) * (pi / 2) / steps;
        const double theta = std::atan(alpha * std::tan(w));
        for (int j = 0; j < steps; ++j) {
            const vec3 h = at(std::cos(theta), (j + 0.5) * 2.0 * pi / steps);
            const double v_dot_h = value(dot(v, h));
            const vec3 l = h * Real(2.0 * v_dot_h) - v;
            if (v_dot_h <= 0.0 || value(l.z) <= 0.0) continue;
            const double density = value(twice::ggx_distribution(up, h, alpha)) * std::cos(theta) / (4.0 * v_dot_h);
            sum += value(reflect(v, l)) / density * std::sin(w) * std::cos(w) / pi;
        }
    }
    return sum * (pi / 2 / steps) * (2.0 * pi / steps);
}

TEST(Ggx, DistributionIntegratesToOne) {
    for (const double alpha : {0.01, 0.1, 0.5, 1.0}) {
        double sum = 0.0;
        constexpr int steps = 20'000;
        for (int i = 0; i < steps; ++i) {
            const double w = (i + 0.5) * (pi / 2) / steps;
            const double theta = std::atan(alpha * std::tan(w));
            const double stretch = alpha / (std::cos(w) * std::cos(w) + alpha * alpha * std::sin(w) * std::sin(w));
            sum += value(twice::ggx_distribution(up, at(std::cos(theta)), alpha)) * std::cos(theta) * std::sin(theta) * stretch;
        }
        EXPECT_NEAR(sum * (pi / 2 / steps) * 2.0 * pi, 1.0, 1e-6) << alpha;
    }
}

TEST(Ggx, HasTheKnownValues) {
    EXPECT_NEAR(value(twice::ggx_distribution(up, up, 0.25)), 5.09295817894, 1e-9);
    EXPECT_NEAR(value(twice::ggx_distribution(up, at(0.95), 0.25)), 0.839880758209, 1e-9);
    EXPECT_NEAR(value(twice::ggx_distribution(up, at(std::sqrt(0.5)), 1e-2)), 1.27298494e-4, 1e-12);
    EXPECT_NEAR(value(twice::ggx_visibility(0.1, 0.1, 0.25)), 9.32504808, 1e-7);
    EXPECT_NEAR(value(twice::ggx_alpha(0.5)), 0.25, 1e-12);
    EXPECT_NEAR(value(twice::ggx_alpha(0.0)), 0.045 * 0.045, 1e-12);
    EXPECT_NEAR(value(twice::ggx_alpha(3.0)), 1.0, 1e-12);
}

TEST(Ggx, DistributionKeepsItsDigitsInSinglePrecision) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double worst = 0.0;
    for (const double alpha : {0.002025, 0.01, 0.1, 0.5}) {
        for (int i = 0; i < 20'000; ++i) {
            // A random frame, and a half vector up to three lobe widths away. The reference takes the same rounded vectors.
            const vec3 n = at(unit(random) * 2.0 - 1.0, unit(random) * 2.0 * pi);
            const double angle = 3.0 * alpha * unit(random);
            const vec3 side =
                twice::safe_normalize(cross(n, vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) + 0.1)), up);
            const single::vec3 n32 = narrow(n), h32 = narrow(n * Real(std::cos(angle)) + side * Real(std::sin(angle)));
            const vec3 n64(value(n32.x), value(n32.y), value(n32.z)), h64(value(h32.x), value(h32.y), value(h32.z));
            const double exact = value(twice::ggx_distribution(n64, h64, value(single::Real(alpha))));
            worst = std::max(worst, std::fabs(value(single::ggx_distribution(n32, h32, alpha)) / exact - 1.0));
        }
    }
    EXPECT_LT(worst, 2e-6);
}

struct AlbedoRow {
    double roughness, n_dot_v, a, b;  // reflects F0 a + b
};
// Double-precision split-sum integrals for height-correlated Smith.
constexpr AlbedoRow albedos[] = {{0.25, 0.50, 0.95568667, 0.03263733}, {0.50, 0.10, 0.75192990, 0.13969245},
                                 {0.50, 0.50, 0.83491614, 0.02234730}, {0.75, 0.25, 0.71650801, 0.02794833},
                                 {1.00, 0.50, 0.44770512, 0.00298874}, {1.00, 1.00, 0.30681921, 0.00003361}};

TEST(CookTorrance, ReflectsWhatTheIntegralsSay) {
    for (const AlbedoRow& row : albedos) {
        for (const double f0 : {0.04, 1.0}) {
            const double got = albedo(row.n_dot_v, row.roughness * row.roughness, [&](vec3 v, vec3 l) {
                return twice::cook_torrance(up, v, l, vec3(0.0), vec3(f0), row.roughness).x;
            });
            EXPECT_NEAR(got, f0 * row.a + row.b, 1e-3) << row.roughness << " " << row.n_dot_v << " " << f0;
        }
    }
}

TEST(CookTorrance, HasTheKnownValue) {
    // n.v 0.8, n.l 0.6: the azimuth is chosen so that n.h is 0.95, and v.h follows.
    const double l_dot_v = 2.0 * std::pow(1.4 / (2.0 * 0.95), 2.0) - 1.0;
    const double azimuth = std::acos((l_dot_v - 0.48) / (0.6 * 0.8));
    const double v_dot_h = std::sqrt((1.0 + l_dot_v) / 2.0);
    const double f = 0.04 + 0.96 * std::pow(1.0 - v_dot_h, 5.0);
    const double expected = 0.839880758209 * value(twice::ggx_visibility(0.6, 0.8, 0.25)) * f * 0.6;
    EXPECT_NEAR(value(twice::cook_torrance(up, at(0.8), at(0.6, azimuth), vec3(0.0), vec3(0.04), 0.5).x), expected, 1e-9);
}

// The same integral for a smooth integrand, over cosine-weighted directions.
template <class Reflect>
double diffuse_albedo(double n_dot_v, Reflect reflect) {
    constexpr int steps = 300;
    const vec3 v = at(n_dot_v);
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double c = std::sqrt((i + 0.5) / steps);
            sum += value(reflect(v, at(c, (j + 0.5) * 2.0 * pi / steps))) / c;
        }
    return sum * pi / steps / steps;
}

TEST(CookTorrance, NeverReflectsMoreThanArrives) {
    for (const double f0 : {0.0, 0.04, 0.5})
        for (const double roughness : {0.1, 0.2, 0.3, 0.4, 0.6, 1.0})
            for (const double n_dot_v : {0.05, 0.2, 0.4, 0.6, 0.8, 1.0}) {
                const double base = diffuse_albedo(n_dot_v, [&](vec3 v, vec3 l) {
                    return twice::cook_torrance(up, v, l, vec3(1.0), vec3(f0), roughness).x -
                           twice::cook_torrance(up, v, l, vec3(0.0), vec3(f0), roughness).x;
                });
                const double coat = albedo(n_dot_v, roughness * roughness, [&](vec3 v, vec3 l) {
                    return twice::cook_torrance(up, v, l, vec3(0.0), vec3(f0), roughness).x;
                });
                EXPECT_NEAR(base, 1.0 - value(twice::fresnel_schlick(n_dot_v, vec3(f0)).x), 1e-4);
                EXPECT_LE(base + coat, 1.002) << f0 << " " << roughness << " " << n_dot_v;
            }
}

TEST(CookTorrance, IsReciprocal) {
    for (const double roughness : {0.1, 0.6})
        for (const double azimuth : {0.3, 2.0, 3.1}) {
            const vec3 a = at(0.3), b = at(0.8, azimuth);
            const double there = value(twice::cook_torrance(up, a, b, vec3(0.5), vec3(0.1), roughness).x) / 0.8;
            const double back = value(twice::cook_torrance(up, b, a, vec3(0.5), vec3(0.1), roughness).x) / 0.3;
            EXPECT_NEAR(there, back, 1e-12 + 1e-9 * there);
        }
}

TEST(Brdfs, AreFiniteAndDarkBehindTheSurface) {
    const single::vec3 n(0.0, 0.0, 1.0);
    std::vector<single::vec3> directions = {{0.0, 0.0, 1.0}, {0.0, 0.0, -1.0}, {1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}};
    for (const double c : {0.9, 1e-3, 1e-7, -1e-7, -0.5}) directions.push_back(narrow(at(c, 1.0)));
    for (const single::vec3 v : directions)
        for (const single::vec3 l : directions)
            for (const double roughness : {0.0, 0.045, 1.0, -1.0, 3.0}) {
                const single::vec3 pbr = single::cook_torrance(n, v, l, single::vec3(0.8), single::vec3(0.04), roughness);
                const single::vec3 phong = single::blinn_phong(n, v, l, single::vec3(0.8), single::vec3(0.2), roughness * 5000.0);
                EXPECT_TRUE(finite(pbr) && finite(phong));
                EXPECT_GE(value(pbr.x), 0.0);
                EXPECT_GE(value(phong.x), 0.0);
                if (value(l.z) > 0.0) continue;
                EXPECT_EQ(value(pbr.x), 0.0);
                EXPECT_EQ(value(phong.x), 0.0);
            }
}

double phong_albedo(double p, double n_dot_v) {
    constexpr int steps = 600;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            sum += value(
                twice::blinn_phong(up, at(n_dot_v), at((i + 0.5) / steps, (j + 0.5) * 2.0 * pi / steps), vec3(0.0), vec3(1.0), p)
                    .x);
    return sum * 2.0 * pi / steps / steps;
}

TEST(BlinnPhong, ReflectsExactlyItsSpecularColourFromTheFront) {
    for (const double p : {1.0, 10.0, 100.0}) EXPECT_NEAR(phong_albedo(p, 1.0), 1.0, 1e-3) << p;
    EXPECT_LT(phong_albedo(10.0, 0.5), 0.5);
    EXPECT_LT(phong_albedo(10.0, 0.866), 0.9);
}

TEST(BlinnPhong, HasTheLobeWidthOfItsRoughness) {
    EXPECT_NEAR(value(twice::blinn_phong_roughness(6.0)), std::sqrt(0.5), 1e-12);  // alpha 1/2
    EXPECT_NEAR(value(twice::blinn_phong_roughness(198.0)), std::sqrt(0.1), 1e-12);
}

TEST(Fresnel, StaysBetweenItsEnds) {
    EXPECT_NEAR(value(twice::fresnel_schlick(0.5, vec3(0.04)).x), 0.07, 1e-12);
    EXPECT_NEAR(value(twice::fresnel_schlick(0.0, vec3(0.04)).x), 1.0, 1e-12);
    EXPECT_NEAR(value(twice::fresnel_schlick(0.0, vec3(0.01)).x), 0.495, 1e-12);  // f90 fades below 2 %
    EXPECT_EQ(value(single::fresnel_schlick(1.0000001, single::vec3(0.04)).x), value(single::Real(0.04)));
    EXPECT_EQ(value(twice::fresnel_schlick(0.3, vec3(0.0)).x), 0.0);
}

TEST(Lights, FallOffAndEnd) {
    EXPECT_NEAR(value(twice::distance_attenuation(1.0, 10.0)), 0.999800010, 1e-9);
    EXPECT_NEAR(value(twice::distance_attenuation(81.0, 10.0)), 0.001460089, 1e-9);
    EXPECT_EQ(value(twice::distance_attenuation(100.0, 10.0)), 0.0);
    EXPECT_NEAR(value(single::distance_attenuation(0.0, 10.0)), 1e4, 1.0);
    EXPECT_EQ(value(single::distance_attenuation(1e38, 10.0)), 0.0);
    EXPECT_EQ(value(twice::cone_attenuation(0.9, 0.8, 0.6)), 1.0);
    EXPECT_NEAR(value(twice::cone_attenuation(0.7, 0.8, 0.6)), 0.25, 1e-12);
    EXPECT_EQ(value(twice::cone_attenuation(0.5, 0.8, 0.6)), 0.0);
    EXPECT_EQ(value(twice::cone_attenuation(0.8, 0.8, 0.8)), 0.0);  // a hard edge, not 0/0
    EXPECT_EQ(value(twice::cone_attenuation(0.9, 0.8, 0.8)), 1.0);
}

TEST(Materials, MetalsHaveNoDiffuse) {
    EXPECT_NEAR(value(twice::metallic_f0(vec3(0.9), 0.0, 0.5).x), 0.04, 1e-12);
    EXPECT_NEAR(value(twice::metallic_f0(vec3(0.9), 1.0, 0.5).x), 0.9, 1e-12);
    EXPECT_NEAR(value(twice::metallic_diffuse(vec3(0.9), 0.0).x), 0.9, 1e-12);
    EXPECT_EQ(value(twice::metallic_diffuse(vec3(0.9), 2.0).x), 0.0);
    EXPECT_EQ(value(twice::reflectance(vec3(0.5), vec3(4.0)).x), 1.0);
}

TEST(ShLightmap, GivesIrradianceFromRawMoments) {
    const vec3 none(0.0);
    EXPECT_NEAR(value(twice::sh_l1_irradiance(vec3(4.0 * pi), none, none, none, at(0.3, 1.0)).x), pi, 1e-12);  // L = 1
    for (const double c : {1.0, 0.5, 0.0, -0.4, -1.0}) {  // unit irradiance from (0, 0, 1): 0.25 + 0.5 c, not below 0
        const double e = value(twice::sh_l1_irradiance(vec3(1.0), none, vec3(1.0), none, at(c, 2.0)).x);
        EXPECT_NEAR(e, std::max(0.0, 0.25 + 0.5 * c), 1e-12);
    }
    // Light from above with radiance 1: m0 = 2 pi, m1 = pi; E = pi (1 + c) / 2.
    EXPECT_NEAR(value(twice::sh_l1_irradiance(vec3(2.0 * pi), none, vec3(0.5), none, at(0.6)).x), pi * 0.8, 1e-12);
    // Each coefficient goes with its own axis, y z x.
    EXPECT_NEAR(value(twice::sh_l1_irradiance(vec3(1.0), vec3(1.0), none, none, vec3(0.0, 1.0, 0.0)).x), 0.75, 1e-12);
    EXPECT_NEAR(value(twice::sh_l1_irradiance(vec3(1.0), none, none, vec3(1.0), vec3(1.0, 0.0, 0.0)).x), 0.75, 1e-12);
    EXPECT_EQ(value(twice::decode_sh_ratio(vec3(0.5)).x), 0.0);
    EXPECT_EQ(value(twice::decode_sh_ratio(vec3(1.0)).x), 1.0);
}

TEST(ShadowMap, KeepsVulkansDepthAndAsksOnlyInsideTheMap) {
    // The left half of the map is blocked at depth 0.5, the right is empty.
    const twice::sampler2DShadow map{[](vec2 uv) { return Real(value(uv.x) < 0.5 ? 0.5 : 1.0); }};
    const auto lit = [&](double x, double y, double z, double w) {
        return value(twice::shadow_factor_2d(map, vec4(x * w, y * w, z * w, w), 0.001));
    };
    EXPECT_EQ(lit(-0.5, 0.0, 0.4, 2.0), 1.0);
    EXPECT_EQ(lit(-0.5, 0.0, 0.6, 2.0), 0.0);
    EXPECT_EQ(lit(0.5, 0.0, 0.6, 2.0), 1.0);
    EXPECT_EQ(lit(-0.5, 0.0, 0.5, 2.0), 1.0);   // the blocker itself
    EXPECT_EQ(lit(-1.5, 0.0, 0.6, 2.0), 1.0);   // outside the map
    EXPECT_EQ(lit(-0.5, 0.0, 1.1, 2.0), 1.0);   // beyond it
    EXPECT_EQ(lit(-0.5, 0.0, -0.1, 2.0), 1.0);  // before it
    EXPECT_EQ(lit(-0.5, 0.0, 0.6, -1.0), 1.0);  // behind the light
    EXPECT_EQ(value(twice::shadow_factor_2d(map, vec4(0.0, 0.0, 0.0, 0.0), 0.0)), 1.0);
}

TEST(ShadowMap, CubeDepthIsThePerspectivesOfItsFaces) {
    // A blocker at 2 m along every face's axis, seen by a perspective from 0.1 to 50 m.
    static const auto depth_at = [](double z) { return 50.0 / 49.9 - 50.0 * 0.1 / (49.9 * z); };
    const twice::samplerCubeShadow map{[](vec3) { return Real(depth_at(2.0)); }};
    const auto lit = [&](vec3 d) { return value(twice::shadow_factor_cube(map, d, 0.1, 50.0, 1e-6)); };
    EXPECT_EQ(lit(vec3(0.0, -1.9, 1.0)), 1.0);
    EXPECT_EQ(lit(vec3(0.0, -2.1, 1.0)), 0.0);
    EXPECT_EQ(lit(vec3(1.9, 1.9, 1.9)), 1.0);  // 3.3 m away, but 1.9 along the axis
    EXPECT_EQ(lit(vec3(60.0, 0.0, 0.0)), 1.0);
    EXPECT_EQ(lit(vec3(0.0)), 1.0);
}

TEST(ShadowMap, OffsetClearsAPlaneOfItsOwnTexels) {
    // Depth grows by tan(a) metres a metre on a plane at angle a to the light; a bilinear comparison reads texels up to one
    // side away in both directions of the map.
    for (const double angle : {0.0, 0.5, 1.0, 1.5}) {
        const double texel = 0.01;
        const vec3 n(std::sin(angle), 0.0, std::cos(angle));  // the light comes from (0, 0, 1)
        const vec3 moved = twice::offset_shadow_receiver(vec3(0.0), n, std::cos(angle), texel);
        const double plane_depth_there = value(moved.x) * std::tan(angle);  // below the light, at the new place
        const double clearance = value(moved.z) + plane_depth_there;        // how far above the plane, along the light
        EXPECT_GE(clearance * 1.0000001, std::sqrt(2.0) * texel * std::tan(angle)) << angle;
    }
}

TEST(Motion, LeavesJitterOut) {
    const vec2 m = twice::screen_motion(vec4(1.0, 0.0, 0.0, 2.0), vec4(0.0, 0.5, 0.0, 1.0), vec4(0.1, 0.0, 0.0, 0.3));
    EXPECT_NEAR(value(m.x), 0.2, 1e-12);   // ((0.5 - 0.1) - (0 - 0)) / 2
    EXPECT_NEAR(value(m.y), -0.1, 1e-12);  // ((0 - 0) - (0.5 - 0.3)) / 2
    EXPECT_EQ(value(twice::screen_motion(vec4(1.0, 1.0, 0.0, 1.0), vec4(1.0, 0.0, 0.0, -1.0), vec4(0.0, 0.0, 0.0, 0.0)).x), 0.0);
}

TEST(Vectors, NormalizeTakesAnyLength) {
    for (const double scale : {1.0, 1e-20, 1e-30, 1e20, 1e37}) {
        const single::vec3 v = single::safe_normalize(single::vec3(3.0 * scale, 4.0 * scale, 0.0), single::vec3(0.0, 0.0, 1.0));
        EXPECT_NEAR(value(v.x), 0.6, 1e-6) << scale;
        EXPECT_NEAR(value(v.y), 0.8, 1e-6) << scale;
    }
    EXPECT_EQ(value(single::safe_normalize(single::vec3(0.0), single::vec3(0.0, 1.0, 0.0)).y), 1.0);
}

TEST(Vectors, NormalsStayPerpendicularAndOutside) {
    // A plane through two edges; after any map the normal must stay perpendicular to both and on the side it was on.
    const vec3 a(1.0, 0.2, 0.1), b(-0.3, 0.9, 0.4), n = cross(a, b);
    const twice::mat3 maps[] = {{vec3(2.0, 0.0, 0.0), vec3(0.5, 1.0, 0.0), vec3(0.0, 0.3, 3.0)},
                                {vec3(-1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0)},
                                {vec3(0.0, -2.0, 0.0), vec3(1.0, 0.0, 0.5), vec3(0.0, 0.0, -1.0)}};
    for (const twice::mat3& m : maps) {
        const vec3 moved = twice::transform_normal(m, n);
        EXPECT_NEAR(value(dot(moved, m * a)), 0.0, 1e-12);
        EXPECT_NEAR(value(dot(moved, m * b)), 0.0, 1e-12);
        EXPECT_GT(value(dot(moved, m * n)), 0.0);
    }
    const twice::mat3 flat{vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 0.0)};
    EXPECT_NEAR(value(twice::transform_normal(flat, up).z), 1.0, 1e-12);
}

TEST(Octahedral, UnfoldsAgain) {
    for (double c = -1.0; c <= 1.0; c += 0.125)
        for (double azimuth = 0.05; azimuth < 6.28; azimuth += 0.37) {
            const vec3 n = at(c, azimuth);
            const vec2 e = twice::encode_octahedral(n);
            const double x = value(e.x), y = value(e.y), z = 1.0 - std::fabs(x) - std::fabs(y);
            const double t = std::max(-z, 0.0);
            const vec3 back = twice::safe_normalize(vec3(x + (x >= 0.0 ? -t : t), y + (y >= 0.0 ? -t : t), z), up);
            EXPECT_NEAR(value(dot(back, n)), 1.0, 1e-12);
        }
}

}  // namespace
