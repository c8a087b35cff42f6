#include "uber/reference/color.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Color) {
    Functions color("color.glsl");
    color.test(
        "srgb_encode(x)", [](auto x) { return srgb_encode(x); }, number("x", linear(-0.5, 2).also({0, 0.0031308, 1})));
    color.test(
        "srgb_decode(x)", [](auto x) { return srgb_decode(x); }, number("x", linear(-0.5, 2).also({0, 0.04045, 1})));
    color
        .test(
            "srgb_encode(c)", [](auto c) { return srgb_encode(c); }, vector3("c", either_sign(1e-6, 100)))
        .named("srgb_encode_colour");
    color
        .test(
            "srgb_decode(c)", [](auto c) { return srgb_decode(c); }, vector3("c", either_sign(1e-6, 4)))
        .named("srgb_decode_colour");
    color.run();
}

}  // namespace
}  // namespace kiln::test
