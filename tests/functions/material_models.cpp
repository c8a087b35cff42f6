#include "uber/reference/material_models.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, MaterialModels) {
    Functions models("material_models.glsl");
    const auto wide = linear(-2, 3).also({0, 1});
    const auto flat = [](const auto& s) {
        using T = std::decay_t<decltype(s.glossiness)>;
        return Mat3<T>{{s.specular, s.diffuse, {s.glossiness, s.normal.x, s.normal.z}}};
    };
    const std::string after = "result = mat3(s.specular, s.diffuse, vec3(s.glossiness, s.normal.x, s.normal.z));";
    models
        .test(
            "SpecularGlossiness s = metallic_to_specular(MetallicRoughness(base, n, r, m), d); " + after,
            [=](auto base, auto n, auto r, auto m, auto d) {
                return flat(metallic_to_specular(MetallicRoughness<decltype(r)>{base, n, r, m}, d));
            },
            vector3("base", wide), unit("n"), number("r", wide), number("m", wide), number("d", wide))
        .named("metallic_to_specular");
    models
        .test(
            "SpecularGlossiness s = metallic_to_specular_pushed(MetallicRoughness(base, n, r, m), d); " + after,
            [=](auto base, auto n, auto r, auto m, auto d) {
                return flat(metallic_to_specular_pushed(MetallicRoughness<decltype(r)>{base, n, r, m}, d));
            },
            vector3("base", either_sign(1e-3, 1e6)), unit("n"), number("r", either_sign(1e-3, 1e6)),
            number("m", either_sign(1e-3, 1e6)), number("d", either_sign(1e-3, 1e6)))
        .named("metallic_to_specular_pushed");
    models.test(
        "ggx_alpha_pushed(r)", [](auto r) { return ggx_alpha_pushed(r); }, number("r", linear(-2, 6).also({0.045, 4})));
    models.run();
}

}  // namespace
}  // namespace kiln::test
