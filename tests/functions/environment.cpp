#include "uber/reference/environment.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Environment) {
    Functions environment("environment.glsl", "lecture_environment.glsl");
    environment
        .test(
            "environment_reflection(n, v)", [](auto n, auto v) { return environment_reflection(n, v); }, unit("n"), unit("v"))
        .truth([](auto n, auto v) { return reflect(-v, n); }, 1e-15);
    environment.test(
        "environment_reflection_lecture(n, v)", [](auto n, auto v) { return environment_reflection_lecture(n, v); }, unit("n"),
        unit("v"));
    environment.test(
        "environment_lod(roughness, levels)", [](auto roughness, auto levels) { return environment_lod(roughness, levels); },
        number("roughness", linear(-1, 2)), number("levels", linear(0, 16)));
    environment
        .test(
            "float(cube_face(d))", [](auto d) { return decltype(d.x)(cube_face(d)); }, vector3("d", either_sign(1e-3, 1e3)))
        .named("cube_face")
        .skip([](auto d) { return dot(d, d) == 0; });
    environment
        .test(
            "cube_face_coordinates(d, cube_face(d))", [](auto d) { return cube_face_coordinates(d, cube_face(d)); },
            vector3("d", either_sign(1e-3, 1e3)))
        .skip([](auto d) { return max(max(abs(d.x), abs(d.y)), abs(d.z)) < 1e-30; });
    environment.test(
        "cube_direction(face, p)", [](auto face, auto p) { return cube_direction(static_cast<int>(face), p); },
        integer("face", 0, 5), vector2("p", linear(-1, 1)));
    environment.test(
        "cube_texel_solid_angle(p, size)", [](auto p, auto size) { return cube_texel_solid_angle(p, size); },
        vector2("p", linear(-1, 1)), number("size", logarithmic(1, 4096)));
    environment
        .test(
            "equirect_uv(d)", [](auto d) { return equirect_uv(d); }, vector3("d", either_sign(1e-3, 1e3)))
        .skip([](auto d) { return dot(d, d) == 0; });
    environment.test(
        "equirect_direction(uv)", [](auto uv) { return equirect_direction(uv); }, vector2("uv", linear(0, 1)));
    environment.test(
        "environment_clamped(radiance, limit)", [](auto radiance, auto limit) { return environment_clamped(radiance, limit); },
        vector3("radiance", logarithmic(1e-3, 1e9)), number("limit", logarithmic(1, 65504)));
    environment.test(
        "environment_excess(radiance, limit)", [](auto radiance, auto limit) { return environment_excess(radiance, limit); },
        vector3("radiance", logarithmic(1e-3, 1e9)), number("limit", logarithmic(1, 65504)));
    environment.run();
}

}  // namespace
}  // namespace kiln::test
