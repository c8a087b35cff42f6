#include "uber/reference/ggx.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Ggx) {
    Functions ggx("ggx.glsl");
    ggx.test(
        "ggx_alpha(roughness)", [](auto roughness) { return ggx_alpha(roughness); },
        number("roughness", linear(-0.5, 2).also({0.045})));
    // The truth is for the angle between the vectors as rounded. Rounding (and moving one component by a float) changes their
    // lengths by up to 1.7e-7, hence |h - n|^2 by twice that, relatively, and D by twice that again.
    ggx.test(
           "ggx_distribution(n, h, alpha)", [](auto n, auto alpha, auto h) { return ggx_distribution(n, h, alpha); }, unit("n"),
           number("alpha", logarithmic(0.002025, 1)), near("h", "n", 8, "alpha"))
        .skip([](auto n, double, auto h) { return dot(n, h) < 0; })
        .truth([](auto n, double alpha, auto h) { return ggx_distribution_textbook(dot(normalize(n), normalize(h)), alpha); },
               7e-7);
    ggx.test(
           "ggx_visibility(n_dot_l, n_dot_v, alpha)",
           [](auto n_dot_l, auto n_dot_v, auto alpha) { return ggx_visibility(n_dot_l, n_dot_v, alpha); },
           number("n_dot_l", logarithmic(1e-4, 1)), number("n_dot_v", logarithmic(1e-4, 1)),
           number("alpha", logarithmic(0.002025, 1)))
        .truth([](double n_dot_l, double n_dot_v, double alpha) { return ggx_visibility_textbook(n_dot_l, n_dot_v, alpha); },
               1e-9);
    ggx.run();
}

}  // namespace
}  // namespace kiln::test
