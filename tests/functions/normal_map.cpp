#include "uber/reference/normal_map.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

// 1 if the columns are orthonormal to 4 ulp, as GLSL.
const char* const orthonormal =
    "float orthonormal(mat3 m) { mat3 p = transpose(m) * m - mat3(1.0); vec3 w = max(max(abs(p[0]), abs(p[1])), abs(p[2]));"
    " return max(max(w.x, w.y), w.z) <= 4.8e-7 ? 1.0 : 0.0; }";

TEST(Functions, NormalMap) {
    Functions normals("normal_map.glsl");
    normals.declare(orthonormal);
    // At n.z = 0 the sign turns, and two quite different frames are right.
    normals.test(
        "frame_of_normal(n)", [](auto n) { return frame_of_normal(n); }, unit("n"));
    normals.test(
        "tangent_frame(n, t, side)", [](auto n, auto t, auto side) { return tangent_frame(n, t, side); }, unit("n"),
        vector3("t", either_sign(1e-20, 1e20)), number("side", values({-1, 1})));
    // Any tangent, also none or one along the normal, gives a frame; n itself is unit to 1.2e-7 only.
    normals
        .test(
            "orthonormal(tangent_frame(n, pick > 0.5 ? n * along + t * 1e-20 : t, side))",
            [](auto, auto, auto along, auto, auto) { return decltype(along)(1); }, unit("n"),
            vector3("t", either_sign(1e-20, 1e20)), number("along", either_sign(1e-3, 1e3)), number("side", values({-1, 1})),
            number("pick", values({0, 1})))
        .named("tangent_frame_orthonormal");
    normals
        .test(
            "orthonormal(cotangent_frame(n, dp_x, dp_y, duv_x, duv_y))",
            [](auto n, auto, auto, auto, auto) { return decltype(n.x)(1); }, unit("n"), vector3("dp_x", either_sign(1e-6, 1e3)),
            vector3("dp_y", either_sign(1e-6, 1e3)), vector2("duv_x", either_sign(1e-6, 1)),
            vector2("duv_y", either_sign(1e-6, 1)))
        .named("cotangent_frame_orthonormal");
    normals.test(
        "cotangent_frame(n, dp_x, dp_y, duv_x, duv_y)",
        [](auto n, auto a, auto b, auto c, auto d) { return cotangent_frame(n, a, b, c, d); }, unit("n"),
        vector3("dp_x", linear(-1, 1)), vector3("dp_y", linear(-1, 1)), vector2("duv_x", linear(-1, 1)),
        vector2("duv_y", linear(-1, 1)));
    normals.test(
        "decode_normal_unorm8(t)", [](auto t) { return decode_normal_unorm8(t); }, colour("t"));
    normals.test(
        "decode_normal(t)", [](auto t) { return decode_normal(t); }, colour("t"));
    normals.test(
        "decode_normal_xy(xy)", [](auto xy) { return decode_normal_xy(xy); }, vector2("xy", linear(-1, 1)));
    normals.test(
        "apply_normal(frame_of_normal(n), t)", [](auto n, auto t) { return apply_normal(frame_of_normal(n), t); }, unit("n"),
        vector3("t", either_sign(1e-3, 1)));
    normals.run();
}

}  // namespace
}  // namespace kiln::test
