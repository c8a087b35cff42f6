#include "uber/reference/cook_torrance.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, CookTorrance) {
    Functions brdf("cook_torrance.glsl");
    const auto form = [](auto n, auto v, auto l, auto diffuse, auto f0, auto roughness) {
        return cook_torrance(n, v, l, diffuse, f0, roughness);
    };
    brdf.test("cook_torrance(n, v, l, diffuse, f0, roughness)", form, unit("n"), hemisphere("v", "n"), hemisphere("l", "n"),
              colour("diffuse"), colour("f0"), number("roughness", linear(0, 1).also({0.045})));
    brdf.test(
        "rough_coat_surplus(alpha)", [](auto alpha) { return rough_coat_surplus(alpha); }, number("alpha", linear(0, 1)));
    // From behind and against one another: finite, and 0 below the horizon.
    brdf.test("cook_torrance(n, v, l, diffuse, f0, roughness)", form, unit("n"), unit("v"), unit("l"), colour("diffuse"),
              colour("f0"), number("roughness", linear(-1, 2)))
        .named("cook_torrance_any_direction")
        .unbounded(0.05);  // where l is -v but for rounding, h is anything
    brdf.run();
}

}  // namespace
}  // namespace kiln::test
