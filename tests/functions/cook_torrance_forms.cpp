#include "uber/reference/cook_torrance_forms.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, CookTorranceForms) {
    Functions brdf("cook_torrance_forms.glsl");
    brdf.test(
        "cook_torrance_hammon(n, v, l, diffuse, f0, roughness)",
        [](auto n, auto v, auto l, auto diffuse, auto f0, auto roughness) {
            return cook_torrance_hammon(n, v, l, diffuse, f0, roughness);
        },
        unit("n"), hemisphere("v", "n"), hemisphere("l", "n"), colour("diffuse"), colour("f0"),
        number("roughness", linear(0, 1).also({0.045})));
    brdf.run();
}

}  // namespace
}  // namespace kiln::test
