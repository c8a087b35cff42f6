#include "uber/reference/probes.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Probes) {
    Functions probes("probes.glsl");
    probes
        .test(
            "TrilinearWeights w = trilinear_weights(t); result = float[8](w.low.x, w.low.y, w.low.z, w.low.w, w.high.x, "
            "w.high.y, "
            "w.high.z, w.high.w);",
            [](auto t) { return trilinear_weights(t); }, vector3("t", linear(-0.5, 1.5)))
        .named("trilinear_weights");
    // Cell and place together are continuous, whichever cell a border goes to.
    probes
        .test(
            "GridCell g = probe_grid_cell(p, s, ivec3(4, 1, 2)); result = vec3(g.cell) + g.t;",
            [](auto p, auto s) {
                using T = decltype(p.x);
                return Vec3<T>{clamp(p.x * s.x, T(0), T(3)), T(0) * p.y, clamp(p.z * s.z, T(0), T(1))};
            },
            vector3("p", linear(-10, 10)), vector3("s", logarithmic(0.1, 10)))
        .named("probe_grid_cell");
    probes.test(
        "probe_facing_weight(l, n)", [](auto l, auto n) { return probe_facing_weight(l, n); }, unit("l"), unit("n"));
    probes.test(
        "normalize_weights(w)", [](auto w) { return normalize_weights(w); }, vector4("w", either_sign(1e-6, 1e6)));
    // p far outside a thin tetrahedron: the weights grow as the volume falls, and so do the bounds.
    probes.test(
        "tetrahedron_weights(p, a, b, c, d)",
        [](auto p, auto a, auto b, auto c, auto d) { return tetrahedron_weights(p, a, b, c, d); }, vector3("p", linear(-5, 5)),
        vector3("a", linear(-5, 5)), vector3("b", linear(-5, 5)), vector3("c", linear(-5, 5)), vector3("d", linear(-5, 5)));
    probes
        .test(
            "ShL2 a; ShL2 b; for (int i = 0; i < 9; ++i) { a.c[i] = vec3(c[i]); b.c[i] = vec3(1.0, -c[i], 0.5); } result = "
            "sh_add(a, b, w).c;",
            [](auto c, auto w) {
                using T = decltype(w);
                ShL2<T> a, b;
                for (size_t i = 0; i < 9; ++i) a.c[i] = splat3(c[i]), b.c[i] = {T(1), -c[i], T(0.5)};
                return sh_add(a, b, w).c;
            },
            array<9>(number("c", either_sign(1e-3, 1e3))), number("w", linear(0, 1)))
        .named("sh_add");
    probes.test(
        "box_projected_direction(p, d, vec3(-2.0, -1.0, -3.0), vec3(4.0, 3.0, 5.0), probe)",
        [](auto p, auto d, auto probe) {
            using T = decltype(p.x);
            return box_projected_direction(p, d, Vec3<T>{T(-2), T(-1), T(-3)}, Vec3<T>{T(4), T(3), T(5)}, probe);
        },
        vector3("p", linear(-3, 5)), unit("d"), vector3("probe", linear(-1, 3)));
    probes.test(
        "probe_box_weight(p, vec3(-2.0, -1.0, -3.0), vec3(4.0, 3.0, 5.0), fade)",
        [](auto p, auto fade) {
            using T = decltype(fade);
            return probe_box_weight(p, Vec3<T>{T(-2), T(-1), T(-3)}, Vec3<T>{T(4), T(3), T(5)}, fade);
        },
        vector3("p", linear(-3, 5)), number("fade", linear(0, 2)));
    probes.test(
        "probe_normalized_reflection(l, here, there, limit)",
        [](auto l, auto here, auto there, auto limit) { return probe_normalized_reflection(l, here, there, limit); },
        vector3("l", linear(0, 100)), vector3("here", linear(0, 10)), vector3("there", linear(0, 10)),
        number("limit", linear(1, 16)));
    probes.run();
}

}  // namespace
}  // namespace kiln::test
