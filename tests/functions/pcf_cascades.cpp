#include "uber/reference/pcf_cascades.h"

#include "tests/functions/cascade_maps.h"

namespace kiln::test {
namespace {

using namespace reference;

// Inverse transpose of an affine matrix: cofactors of its 3 x 3 part over the determinant, and what the translation makes of
// them.
Mat4<double> plane_matrix(int i) {
    const Mat4<double> m = cascade_matrix(i);
    const auto column = [&](int c) { return Vec3<double>{m.columns[c].x, m.columns[c].y, m.columns[c].z}; };
    const double determinant = dot(column(0), cross(column(1), column(2)));
    Mat4<double> out{};
    for (int c = 0; c < 3; ++c) {
        const Vec3<double> rows = cross(column((c + 1) % 3), column((c + 2) % 3)) / determinant;
        out.columns[c] = {rows.x, rows.y, rows.z, -dot(rows, column(3))};
    }
    out.columns[3] = {0, 0, 0, 1};
    return out;
}

TEST(Functions, PcfCascades) {
    Functions pcf("pcf_cascades.glsl");
    const DepthTexture texture = blocks(32);
    pcf.texture("sampler2DArrayShadow maps", texture.image(true), nearest(true));
    const auto compare = [&texture](int layer, auto uv, auto depth) { return texture.compare(uv, depth, layer); };
    for (const int n : {3, 5, 7})
        pcf.test(
               "cascade_pcf(maps, vec4(x, y, z, w), layer, slope, 1e-4, width, " + std::to_string(n) + ")",
               [compare, n](auto x, auto y, auto z, auto w, int layer, auto slope, auto width) {
                   using T = decltype(x);
                   return cascade_pcf(compare, Vec4<T>{x, y, z, w}, layer, slope, T(1e-4), width, n);
               },
               // Not w to 1.5: 1.2 / 1.5 and a fifth of the widest box put taps of n = 5 exactly on the map's border, and whole
               // families of extremes were undecided. What is left: extremes where x or y is w, and, where one of n coordinates
               // an axis is within 1e-6 of one of 8 blocks' edges: 2 x 7 x 8 x 2e-6 = 2e-4.
               number("x", linear(-1.2, 1.2)), number("y", linear(-1.2, 1.2)), number("z", linear(-0.2, 1.2)),
               number("w", linear(-0.2, 1.45).also({0})), integer("layer", 0, 3), vector2("slope", linear(-0.3, 0.3)),
               number("width", logarithmic(1e-3, 0.5)))
            .named("cascade_pcf_" + std::to_string(n))
            .undecided(0.002);
    static const Matrices matrices("matrices", cascade_matrix), planes("planes", plane_matrix);
    pcf.declare(matrices.glsl + "\n" + planes.glsl);
    // Near the slices' border, where the choice of one or two layers is the matter.
    pcf.test(
           "CascadeChoice c = choose_cascade(depth, 0.1, vec4(10.0, 20.0, 30.0, 40.0), 4, 0.2); int own = max(c.index, 0), next "
           "= "
           "max(c.next, 0); vec4 width = vec4(0.2, 0.1, 0.05, 0.05), at = vec4(receiver, 1.0), plane = vec4(n, -dot(n, "
           "receiver)); "
           "result = cascaded_pcf(maps, matrices[own] * at, planes[own] * plane, matrices[next] * at, planes[next] * plane, "
           "vec2(width[own], width[next]), 0.03125, 1e-4, c, 3);",
           [compare](auto receiver, auto n, auto depth) {
               using T = decltype(depth);
               const CascadeChoice<T> choice = choose_cascade(depth, T(0.1), Vec4<T>{T(10), T(20), T(30), T(40)}, 4, T(0.2));
               return cascaded_pcf(compare, matrices.read<T>(), planes.read<T>(), Vec4<T>{T(0.2), T(0.1), T(0.05), T(0.05)},
                                   T(0.03125), T(1e-4), receiver, n, choice, 3);
           },
           vector3("receiver", linear(-30, 30)), unit("n"), number("depth", linear(0, 42).also({10, 20, 30, 40})))
        .named("cascaded_pcf");
    pcf.run();
}

}  // namespace
}  // namespace kiln::test
