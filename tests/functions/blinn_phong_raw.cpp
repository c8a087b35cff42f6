#include "uber/reference/blinn_phong_raw.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, BlinnPhongRaw) {
    Functions raw("blinn_phong_raw.glsl");
    const auto shininess = linear(0, 4096).also({1, 2048});
    raw.test(
        "phong_power(x, p)", [](auto x, auto p) { return phong_power(x, p); }, number("x", linear(-1, 1).also({0})),
        number("p", shininess));
    raw.test(
        "blinn_phong_raw(n, v, l, kd, ks, p)",
        [](auto n, auto v, auto l, auto kd, auto ks, auto p) { return blinn_phong_raw(n, v, l, kd, ks, p); }, unit("n"),
        hemisphere("v", "n"), unit("l"), colour("kd"), colour("ks"), number("p", shininess));
    raw.run();
}

}  // namespace
}  // namespace kiln::test
