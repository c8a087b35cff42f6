#include "tests/functions/function.h"
#include "uber/reference/numbers.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Math) {
    Functions math("math.glsl");
    math.test(
        "saturate(x)", [](auto x) { return saturate(x); }, number("x", finite()));
    math.test(
        "max_component(c)", [](auto c) { return max_component(c); }, vector3("c", finite()));
    math.test(
            "pi * x", [](auto x) { return decltype(x)(pi) * x; }, number("x", linear(-4, 4)))
        .named("pi");
    math.test(
        "cos_sin_of_turn(turn)", [](auto turn) { return cos_sin_of_turn(turn); }, number("turn", linear(0, 1)));
    math.run();
}

}  // namespace
}  // namespace kiln::test
