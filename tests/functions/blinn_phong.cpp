#include "uber/reference/blinn_phong.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, BlinnPhong) {
    Functions brdf("blinn_phong.glsl");
    brdf.test(
        "blinn_phong_normalization(shininess)", [](auto shininess) { return blinn_phong_normalization(shininess); },
        number("shininess", logarithmic(1, 2048)));
    brdf.test(
        "blinn_phong_roughness(shininess)", [](auto shininess) { return blinn_phong_roughness(shininess); },
        number("shininess", logarithmic(1, 2048)));
    brdf.test(
        "blinn_phong_shininess(roughness)", [](auto roughness) { return blinn_phong_shininess(roughness); },
        number("roughness", linear(0, 1)));
    brdf.test(
        "blinn_phong(n, v, l, diffuse, specular, shininess)",
        [](auto n, auto v, auto l, auto diffuse, auto specular, auto shininess) {
            return blinn_phong(n, v, l, diffuse, specular, shininess);
        },
        unit("n"), hemisphere("v", "n"), hemisphere("l", "n"), colour("diffuse"), colour("specular"),
        number("shininess", logarithmic(0.5, 4096).also({1, 2048})));
    brdf.test(
            "blinn_phong(n, v, l, diffuse, specular, shininess)",
            [](auto n, auto v, auto l, auto diffuse, auto specular, auto shininess) {
                return blinn_phong(n, v, l, diffuse, specular, shininess);
            },
            unit("n"), unit("v"), unit("l"), colour("diffuse"), colour("specular"), number("shininess", either_sign(1, 1e6)))
        .named("blinn_phong_any_direction");
    brdf.run();
}

}  // namespace
}  // namespace kiln::test
