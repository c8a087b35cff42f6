#include "uber/reference/vsm.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Vsm) {
    Functions vsm("vsm.glsl");
    const auto mean = [] { return number("m", linear(-0.5, 0.5)); };
    // Any two numbers, variance or none, so that no compiler sees through a difference of moments.
    const auto moments = [] { return vector2("moments", linear(-0.5, 0.5)); };
    vsm.test(
        "shadow_moments(distance, far, reference)",
        [](auto distance, auto far, auto reference) { return shadow_moments(distance, far, reference); },
        number("distance", linear(0, 100)), number("far", logarithmic(1, 100)), number("reference", linear(0, 1)));
    vsm.test(
           "shadow_moments(distance, 20.0, 0.5, gradient)",
           [](auto distance, auto gradient) {
               using T = decltype(distance);
               return shadow_moments(distance, T(20), T(0.5), gradient);
           },
           number("distance", linear(0, 20)), vector2("gradient", linear(-0.1, 0.1)))
        .named("shadow_moments_of_a_slope");
    vsm.test(
        "moments_variance(moments, 1e-9)", [](auto m) { return moments_variance(m, decltype(m.x)(1e-9)); }, moments());
    vsm.test(
        "chebyshev_upper_bound(moments, t, 1e-9)", [](auto m, auto t) { return chebyshev_upper_bound(m, t, decltype(t)(1e-9)); },
        moments(), number("t", linear(-0.5, 0.5)));
    vsm.test(
        "reduce_light_bleeding(lit, amount)", [](auto lit, auto amount) { return reduce_light_bleeding(lit, amount); },
        number("lit", linear(0, 1)), number("amount", linear(0, 0.9)));
    vsm.test(
           "vssm_blocker(vec2(m, 0.0), t, lit)",
           [](auto m, auto t, auto lit) {
               using T = decltype(m);
               return lit > T(0.999) ? t : m - (t - m) * lit / max(T(1) - lit, T(0.001));
           },
           mean(), number("t", linear(-0.5, 0.5)), number("lit", linear(0, 1)))
        .exactly([](double m, double t, double lit) {
            // Between the float above which all is lit and the number that it stands for, either answer is right.
            return vssm_blocker(Vec2<double>{m, 0}, t, lit);
        });
    vsm.test(
        "vsm_factor(moments, distance, 20.0, 0.5, 1e-9, 0.2)",
        [](auto m, auto distance) {
            using T = decltype(distance);
            return vsm_factor(m, distance, T(20), T(0.5), T(1e-9), T(0.2));
        },
        moments(), number("distance", linear(0, 20)));
    vsm.run();
}

}  // namespace
}  // namespace kiln::test
