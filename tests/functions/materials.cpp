#include "uber/reference/materials.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Materials) {
    Functions materials("materials.glsl");
    materials.test(
        "metallic_diffuse(base, metallic)", [](auto base, auto metallic) { return metallic_diffuse(base, metallic); },
        colour("base"), number("metallic", linear(-1, 2)));
    materials.test(
        "metallic_f0(base, metallic, specular)",
        [](auto base, auto metallic, auto specular) { return metallic_f0(base, metallic, specular); }, colour("base"),
        number("metallic", linear(-1, 2)), number("specular", linear(-1, 2)));
    materials.test(
        "reflectance(texel, factor)", [](auto texel, auto factor) { return reflectance(texel, factor); },
        vector3("texel", linear(-1, 4)), vector3("factor", linear(-1, 4)));
    materials.run();
}

}  // namespace
}  // namespace kiln::test
