#include "uber/reference/energy.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Energy) {
    Functions energy("energy.glsl");
    // A + B <= 1: the split-sum pair as A and the part of what is left.
    energy.declare("vec2 dfg_of(float a, float part) { return vec2(a, part * (1.0 - a)); }");
    const auto dfg = [](const auto& a, const auto& part) {
        using T = std::decay_t<decltype(a)>;
        return Vec2<T>{a, part * (T(1) - a)};
    };
    const auto a = number("a", linear(0, 1)), part = number("part", linear(0, 1));
    energy.test(
        "multiscatter_scale(f0, e)", [](auto f0, auto e) { return multiscatter_scale(f0, e); }, colour("f0"),
        number("e", linear(-0.1, 1.1).also({1e-3, 1})));
    energy.test(
        "single_scatter_albedo(f0, dfg_of(a, part))",
        [=](auto f0, auto x, auto y) { return single_scatter_albedo(f0, dfg(x, y)); }, colour("f0"), a, part);
    energy.test(
        "multiple_scatter_albedo(f0, dfg_of(a, part))",
        [=](auto f0, auto x, auto y) { return multiple_scatter_albedo(f0, dfg(x, y)); }, colour("f0"), a, part);
    energy.test(
        "diffuse_below(f0, dfg_of(a, part))", [=](auto f0, auto x, auto y) { return diffuse_below(f0, dfg(x, y)); }, colour("f0"),
        a, part);
    energy.test(
        "multiscatter_lobe(e_l, e_v, e_avg, f)", [](auto l, auto v, auto m, auto f) { return multiscatter_lobe(l, v, m, f); },
        number("e_l", linear(0.05, 1)), number("e_v", linear(0.05, 1)), number("e_avg", linear(0.3, 1)), colour("f"));
    energy.run();
}

}  // namespace
}  // namespace kiln::test
