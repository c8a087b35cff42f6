#include "uber/reference/subsurface.h"

#include "tests/functions/function.h"
#include "uber/reference/subsurface_preintegrated.h"
#include "uber/reference/subsurface_separable.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Subsurface) {
    Functions subsurface("subsurface.glsl");
    const auto s = number("s", logarithmic(0.01, 100));
    const auto shapes = vector3("s", logarithmic(0.01, 100));
    const auto r = number("r", logarithmic(1e-4, 10).with({0}));
    subsurface.test(
        "wrap_diffuse(n_dot_l, wrap)", [](auto c, auto wrap) { return wrap_diffuse(c, wrap); }, number("n_dot_l", linear(-1, 1)),
        number("wrap", linear(0, 1)));
    // |x|^3 and x^4 as products: the reference's powers have the wider bounds.
    subsurface.test(
        "burley_shape_searchlight(a)", [](auto a) { return burley_shape_searchlight(a); }, colour("a"));
    subsurface.test(
        "burley_shape_diffuse(a)", [](auto a) { return burley_shape_diffuse(a); }, colour("a"));
    subsurface.test(
        "burley_shape_mean_free_path(a)", [](auto a) { return burley_shape_mean_free_path(a); }, colour("a"));
    subsurface.test(
        "single_scattering_albedo(a)", [](auto a) { return single_scattering_albedo(a); }, colour("a"));
    subsurface.test(
        "burley_profile_r(r, s)", [](auto at, auto shape) { return burley_profile_r(at, shape); }, r, shapes);
    subsurface.test(
        "burley_profile(r, s)", [](auto at, auto shape) { return burley_profile(at, shape); }, r, shapes);
    subsurface
        .test(
            "burley_cumulative(r, s)", [](auto at, auto shape) { return burley_cumulative(at, shape); }, r, s)
        .truth([](double at, double shape) { return burley_cumulative_textbook(at, shape); }, 5e-8, 1e-15);
    subsurface
        .test(
            "burley_radius(u, s)", [](auto u, auto shape) { return burley_radius(u, shape); },
            number("u", linear(0, 1).also({0.1})), s)
        .truth(burley_radius_textbook, 1e-6, 1e-12);
    subsurface.test(
        "burley_tap(i, 32, s, rotation)", [](auto i, auto shape, auto rotation) { return burley_tap(i, 32, shape, rotation); },
        integer("i", 0, 31), s, number("rotation", linear(-3, 3)));
    subsurface.test(
        "burley_tap_weight(x / drawn, s, drawn)",
        [](auto x, auto shape, auto drawn) { return burley_tap_weight(x / drawn, shape, drawn); },
        number("x", logarithmic(1e-3, 50).with({0})), shapes, number("drawn", logarithmic(0.01, 100)));
    subsurface.test(
        "dipole_boundary(eta)", [](auto eta) { return dipole_boundary(eta); }, number("eta", linear(1, 2)));
    const auto boundary = number("boundary", linear(1, 10));
    subsurface.test(
        "dipole_albedo(a, boundary)", [](auto a, auto b) { return dipole_albedo(a, b); }, colour("a"), boundary);
    subsurface.test(
        "dipole_profile(r, scattering, absorption, boundary)",
        [](auto at, auto scattering, auto absorption, auto b) { return dipole_profile(at, scattering, absorption, b); },
        number("r", logarithmic(1e-3, 100).with({0})), vector3("scattering", logarithmic(0.01, 100)),
        vector3("absorption", logarithmic(1e-4, 10)), boundary);
    subsurface.test(
        "burley_transmittance(x / s, vec3(s)).x", [](auto x, auto shape) { return burley_transmittance(x / shape, shape); },
        number("x", logarithmic(1e-3, 60).with({0})), s);
    subsurface.test(
        "burley_through_tap(i, 32, s, x / s, rotation)",
        [](auto i, auto x, auto shape, auto rotation) { return burley_through_tap(i, 32, shape, x / shape, rotation); },
        integer("i", 0, 31), number("x", logarithmic(0.05, 10)), s, number("rotation", linear(-3, 3)));
    // In mean free paths. tr below 1e-3 is where 1 - exp has lost its digits.
    subsurface
        .test(
            "multipole_transmittance(thickness, vec3(a), vec3(1.0 - a), boundary).x",
            [](auto thickness, auto a, auto b) {
                using T = decltype(a);
                return multipole_transmittance(thickness, a, T(1) - a, b);
            },
            number("thickness", logarithmic(0.01, 40).with({0})), number("a", linear(0, 1)), boundary)
        .truth([](double thickness, double a, double b) { return multipole_transmittance_textbook(thickness, a, 1 - a, b); },
               1e-9, 1e-15);
    subsurface.run();
}

TEST(Functions, SubsurfacePreintegrated) {
    Functions preintegrated("subsurface_preintegrated.glsl");
    const auto cosine = number("n_dot_l", linear(-1, 1));
    preintegrated
        .test(
            "preintegrated_sine(x)", [](auto x) { return preintegrated_sine(x); }, number("x", linear(-1.5707963, 1.5707963)))
        .truth([](double x) { return std::sin(x); }, 6e-8);
    preintegrated
        .test(
            "preintegrated_ring(n_dot_l, curvature, variance)",
            [](auto c, auto curvature, auto variance) { return preintegrated_ring(c, curvature, variance); }, cosine,
            number("curvature", logarithmic(1e-3, 100).with({0})), number("variance", logarithmic(1e-3, 10).with({0})))
        .truth([](double c, double curvature, double variance) { return preintegrated_ring_textbook(c, curvature, variance); }, 0,
               1e-6);
    preintegrated.test(
        "burley_gaussian_variance(s)", [](auto s) { return burley_gaussian_variance(s); }, number("s", logarithmic(0.01, 100)));
    preintegrated
        .test(
            "circle_of_clamped_cosine(a, b)", [](auto a, auto b) { return circle_of_clamped_cosine(a, b); },
            number("a", linear(-1, 1)), number("b", linear(-1, 1)))
        .truth(circle_of_clamped_cosine_textbook, 0, 1e-7);
    preintegrated.test(
        "preintegrated_sphere(n_dot_l, k)", [](auto c, auto k) { return preintegrated_sphere(c, k); }, cosine,
        number("k", logarithmic(1e-6, 1e6).with({0})));
    preintegrated.test(
        "preintegrated_uv(n_dot_l, k, vec2(64.0, 32.0))",
        [](auto c, auto k) {
            return preintegrated_uv(c, k, Vec2<decltype(k)>{decltype(k)(64), decltype(k)(32)});
        },
        cosine, number("k", logarithmic(1e-6, 1e6).with({0})));
    preintegrated.run();
}

TEST(Functions, SubsurfaceSeparable) {
    Functions separable("subsurface_separable.glsl");
    separable.test(
        "separable_offset(i, 17, range)", [](auto i, auto range) { return separable_offset(i, 17, range); }, integer("i", 0, 16),
        number("range", logarithmic(0.1, 100)));
    separable.test(
        "separable_skin_profile(r, falloff)", [](auto r, auto falloff) { return separable_skin_profile(r, falloff); },
        number("r", linear(-5, 5)), vector3("falloff", logarithmic(0.01, 1)));
    separable.test(
        "burley_line_spread(x, s)", [](auto x, auto s) { return burley_line_spread(x, s); }, number("x", logarithmic(1e-5, 10)),
        number("s", logarithmic(0.01, 10)));
    separable
        .test(
            "vec4 kernel[SEPARABLE_TAPS]; separable_kernel_skin(falloff, strength, kernel); result = kernel[i];",
            [](auto i, auto falloff, auto strength) {
                return separable_kernel_skin(falloff, strength)[static_cast<std::size_t>(i)];
            },
            integer("i", 0, 16), vector3("falloff", logarithmic(0.05, 1)), colour("strength"))
        .named("separable_kernel_skin");
    separable
        .test(
            "vec4 kernel[SEPARABLE_TAPS]; separable_kernel_burley(s, range, kernel); result = kernel[i];",
            [](auto i, auto s, auto range) { return separable_kernel_burley(s, range)[static_cast<std::size_t>(i)]; },
            integer("i", 0, 16), vector3("s", logarithmic(0.3, 3)), number("range", logarithmic(1, 30)))
        .named("separable_kernel_burley");
    separable.run();
}

}  // namespace
}  // namespace kiln::test
