#include "uber/reference/ggx_forms.h"

#include "tests/functions/function.h"
#include "uber/reference/ggx.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, GgxForms) {
    Functions ggx("ggx_forms.glsl", "ggx.glsl");
    ggx.test(
           "ggx_from_sine(cosine, sine2, alpha)", [](auto c, auto s2, auto a) { return ggx_from_sine(c, s2, a); },
           number("cosine", linear(0, 1)), number("sine2", linear(0, 1)), number("alpha", logarithmic(0.002, 16)))
        .skip([](double c, double s2, double) { return std::fabs(c * c + s2 - 1) > 0.5; });
    // The vectors are unit to fp32's rounding, which moves D by up to 1e-6.
    ggx.test(
           "ggx_distribution_cross(n, h, alpha)", [](auto n, auto a, auto h) { return ggx_distribution_cross(n, h, a); },
           unit("n"), number("alpha", logarithmic(0.002, 1)), near("h", "n", 8, "alpha"))
        .skip([](auto n, double, auto h) { return dot(n, h) < 0; })
        .truth([](auto n, double a, auto h) { return ggx_distribution_textbook(dot(normalize(n), normalize(h)), a); }, 1e-6);
    ggx.test(
           "ggx_distribution_cosine(n_dot_h, alpha)", [](auto c, auto a) { return ggx_distribution_cosine(c, a); },
           number("n_dot_h", linear(-0.1, 1.1).also({0, 1})), number("alpha", logarithmic(0.002, 1)))
        .truth([](double c, double a) { return ggx_distribution_textbook(std::min(std::max(c, 0.0), 1.0), a); }, 1e-9);
    // Pushed beyond roughness 1 the same text is still a distribution.
    ggx.test(
           "ggx_distribution(n, h, alpha)", [](auto n, auto a, auto h) { return ggx_distribution(n, h, a); }, unit("n"),
           number("alpha", linear(1, 16)), near("h", "n", 1.5))
        .skip([](auto n, double, auto h) { return dot(n, h) < 0; })
        .named("ggx_distribution_pushed");
    // How far the forms are from |h - n|^2 on the device: the cross product by 1.2e-7 / alpha + 1e-6, and |h - n|^2 itself
    // by 2e-6. The cosine of fp32 vectors is off by half an ulp or so, which the distribution multiplies by 1 / alpha^2.
    ggx.declare(
        "vec2 forms_agree(vec3 n, vec3 h, float a) {"
        "    const float d = ggx_distribution(n, h, a);"
        "    return vec2(abs(ggx_distribution_cross(n, h, a) - d) <= (1.2e-7 / a + 3e-6) * d ? 1.0 : 0.0,"
        "                abs(ggx_distribution_cosine(dot(n, h), a) - d) <= (6e-7 / (a * a) + 3e-6) * d ? 1.0 : 0.0); }");
    ggx.test(
           "forms_agree(n, h, alpha)",
           [](auto, auto a, auto) {
               return Vec2<decltype(a)>{decltype(a)(1), decltype(a)(1)};
           },
           unit("n"), number("alpha", logarithmic(0.002025, 1)), near("h", "n", 3, "alpha"))
        .skip([](auto n, double, auto h) { return dot(n, h) < 0; });
    ggx.run();
}

}  // namespace
}  // namespace kiln::test
