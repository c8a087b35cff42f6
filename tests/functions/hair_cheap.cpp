#include "uber/reference/hair_cheap.h"

#include "tests/functions/function.h"
#include "uber/reference/hair_cheap_textbook.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, HairCheap) {
    Functions hair("hair_cheap.glsl");
    const auto exponent = number("exponent", logarithmic(1, 2048));
    hair.test(
        "hair_kajiya_kay(tangent, l, e, diffuse, specular, exponent)",
        [](auto t, auto l, auto e, auto diffuse, auto specular, auto p) {
            return hair_kajiya_kay(t, l, e, diffuse, specular, p);
        },
        unit("tangent"), unit("l"), unit("e"), colour("diffuse"), colour("specular"), exponent);
    hair.test(
        "hair_scheuermann(tangent, l, e, exponent)", [](auto t, auto l, auto e, auto p) { return hair_scheuermann(t, l, e, p); },
        unit("tangent"), unit("l"), unit("e"), exponent);
    hair.test(
        "hair_gaussian(x, b)", [](auto x, auto b) { return hair_gaussian(x, b); }, number("x", linear(-2, 2)),
        number("b", logarithmic(7e-6, 2)));
    hair.test(
            "hair_schlick(cosine)", [](auto cosine) { return hair_schlick(cosine); }, number("cosine", linear(-0.1, 1.1)))
        .truth([](double cosine) { return hair_schlick_textbook(cosine); }, 1e-8);
    hair.test(
        "hair_karis(tangent, l, e, c, roughness, specular, backlit)",
        [](auto t, auto l, auto e, auto c, auto roughness, auto specular, auto backlit) {
            return hair_karis(t, l, e, c, roughness, specular, backlit);
        },
        unit("tangent"), unit("l"), unit("e"), colour("c"), number("roughness", linear(0, 1)), number("specular", linear(0, 1)),
        number("backlit", linear(0, 1)));
    hair.run();
}

}  // namespace
}  // namespace kiln::test
