#include "uber/reference/tonemap.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Tonemap) {
    Functions tonemap("tonemap.glsl");
    tonemap.test(
        "luminance(c)", [](auto c) { return luminance(c); }, vector3("c", logarithmic(1e-6, 1e6)));
    tonemap.test(
        "exposure_from_ev100(ev)", [](auto ev) { return exposure_from_ev100(ev); }, number("ev", linear(-20, 30)));
    tonemap.test(
        "exposure_from_mean(mean)", [](auto mean) { return exposure_from_mean(mean); },
        number("mean", logarithmic(1e-8, 1e9).with({0})));
    tonemap.test(
        "limit_half(c)", [](auto c) { return limit_half(c); }, vector3("c", either_sign(1e-8, 1e30).also({65504, 65520})));
    // The shader's form is a difference from 1: its error is that of 1, which the textbook's quotient does not have.
    tonemap
        .test(
            "tone_reinhard(x)",
            [](auto x) {
                using T = decltype(x);
                return T(1) - T(1) / (T(1) + max(x, T(0)));
            },
            number("x", either_sign(1e-6, 1e30).with({3e38})))
        .exactly([](auto x) { return tone_reinhard(x); });
    tonemap
        .test(
            "tone_reinhard(c)",
            [](auto c) {
                return map(c, [](auto x) { return decltype(x)(1) - decltype(x)(1) / (decltype(x)(1) + max(x, decltype(x)(0))); });
            },
            vector3("c", either_sign(1e-3, 1e6)))
        .named("tone_reinhard_colour")
        .exactly([](auto c) { return tone_reinhard(c); });
    tonemap.test(
        "tone_reinhard_white(c, white)", [](auto c, auto white) { return tone_reinhard_white(c, white); },
        vector3("c", either_sign(1e-4, 1e9).also({65504})), number("white", logarithmic(0.5, 1e4).also({1})));
    tonemap.test(
        "tone_aces(x)", [](auto x) { return tone_aces(x); }, number("x", either_sign(1e-6, 1e30).also({8}).with({3e38})));
    tonemap
        .test(
            "tone_aces(c)", [](auto c) { return tone_aces(c); }, vector3("c", either_sign(1e-3, 1e6)))
        .named("tone_aces_colour");
    tonemap.run();
}

}  // namespace
}  // namespace kiln::test
