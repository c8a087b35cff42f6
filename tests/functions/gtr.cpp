#include "uber/reference/gtr.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Gtr) {
    Functions gtr("gtr.glsl");
    // The series leaves out z^8 / 9, z <= 1/7: 2e-8.
    gtr.test(
           "log_ratio(u)", [](auto u) { return log_ratio(u); }, number("u", linear(0, 0.999).also({0.25})))
        .truth([](double u) { return u == 0 ? 1.0 : -std::log1p(-u) / u; }, 2.1e-8);
    // Lengths that fp32 has rounded move |h - n|^2 by up to 4e-7, relatively.
    gtr.test(
           "gtr1_distribution(n, h, alpha)", [](auto n, auto a, auto h) { return gtr1_distribution(n, h, a); }, unit("n"),
           number("alpha", logarithmic(1e-3, 1)), near("h", "n", 8, "alpha"))
        .skip([](auto n, double, auto h) { return dot(n, h) < 0; })
        .truth(
            [](auto n, double a, auto h) {
                const double c = dot(normalize(n), normalize(h)), a2 = a * a;
                return a2 == 1 ? 1 / pi : (a2 - 1) / (pi * std::log(a2) * (1 + (a2 - 1) * c * c));
            },
            5e-7);
    gtr.run();
}

}  // namespace
}  // namespace kiln::test
