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
    brdf.run();
}

}  // namespace
}  // namespace kiln::test
