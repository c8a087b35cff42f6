#include "uber/reference/sh_lightmap.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, ShLightmap) {
    Functions lightmap("sh_lightmap.glsl");
    lightmap.test(
        "decode_sh_ratio(texel)", [](auto texel) { return decode_sh_ratio(texel); }, colour("texel"));
    lightmap.test(
        "sh_l1_irradiance(m0, ratio_y, ratio_z, ratio_x, n)",
        [](auto m0, auto ratio_y, auto ratio_z, auto ratio_x, auto n) {
            return sh_l1_irradiance(m0, ratio_y, ratio_z, ratio_x, n);
        },
        vector3("m0", logarithmic(1e-4, 1e5)), vector3("ratio_y", linear(-1, 1)), vector3("ratio_z", linear(-1, 1)),
        vector3("ratio_x", linear(-1, 1)), unit("n"));
    lightmap.run();
}

}  // namespace
}  // namespace kiln::test
