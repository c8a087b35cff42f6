#include "uber/reference/fresnel.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Fresnel) {
    Functions fresnel("fresnel.glsl");
    fresnel.test(
        "fresnel_f90(f0)", [](auto f0) { return fresnel_f90(f0); }, colour("f0"));
    fresnel.test(
        "fresnel_schlick(cosine, f0)", [](auto cosine, auto f0) { return fresnel_schlick(cosine, f0); },
        number("cosine", linear(-1.1, 1.1)), colour("f0"));
    fresnel.test(
        "fresnel_average(f0)", [](auto f0) { return fresnel_average(f0); }, colour("f0"));
    fresnel.run();
}

}  // namespace
}  // namespace kiln::test
