#include "tests/functions/function.h"
#include "uber/reference/gi_ambient.h"
#include "uber/reference/gi_cones.h"
#include "uber/reference/gi_cornell.h"
#include "uber/reference/gi_path.h"
#include "uber/reference/gi_rsm.h"
#include "uber/reference/gi_screen.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, GiSampling) {
    Functions sampling("gi_sampling.glsl");
    // Integers are exact; the scale is there for the result's type.
    sampling
        .test(
            "uint s = state; result = gi_random(s) * scale;",
            [](auto state, auto scale) {
                uint32_t s = state;
                return decltype(scale)(gi_random(s)) * scale;
            },
            bits("state"), number("scale", linear(0.5, 1)))
        .named("gi_random");
    sampling
        .test(
            "vec3 t, b; gi_basis(n, t, b); result = t;",
            [](auto n) {
                auto t = n, b = n;
                gi_basis(n, t, b);
                return t;
            },
            unit("n"))
        .named("gi_basis");
    sampling.test(
        "gi_cosine_direction(u, n)", [](auto u, auto n) { return gi_cosine_direction(u, n); }, vector2("u", linear(0, 0.9999999)),
        unit("n"));
    sampling.run();
}

TEST(Functions, GiAmbient) {
    Functions ambient("gi_ambient.glsl");
    ambient.test(
        "ambient_radiance(albedo, e, open)", [](auto albedo, auto e, auto open) { return ambient_radiance(albedo, e, open); },
        colour("albedo"), vector3("e", logarithmic(1e-3, 1e4).with({0})), number("open", linear(0, 1)));
    ambient
        .test(
            "interreflection(e, albedo, n)", [](auto e, auto albedo, auto n) { return interreflection(e, albedo, n); },
            vector3("e", logarithmic(1e-3, 1e4)), colour("albedo"), integer("n", 0, 1000))
        .truth([](auto e, auto albedo, int n) { return interreflection_textbook(e, albedo, n); }, 1e-9);
    ambient.test(
        "interreflection_limit(e, albedo)", [](auto e, auto albedo) { return interreflection_limit(e, albedo); },
        vector3("e", logarithmic(1e-3, 1e4)), colour("albedo"));
    ambient.test(
        "multibounce_visibility(v, albedo)", [](auto v, auto albedo) { return multibounce_visibility(v, albedo); },
        number("v", linear(0, 1)), colour("albedo"));
    ambient.run();
}

TEST(Functions, GiRsm) {
    Functions rsm("gi_rsm.glsl");
    const auto place = linear(-10, 10);
    rsm.test(
        "rsm_irradiance(x, n, y, m, intensity, nearest)",
        [](auto x, auto n, auto y, auto m, auto intensity, auto nearest) {
            return rsm_irradiance(x, n, y, m, intensity, nearest);
        },
        vector3("x", place), unit("n"), vector3("y", place), unit("m"), vector3("intensity", logarithmic(1e-3, 1e3)),
        number("nearest", logarithmic(1e-4, 1)));
    rsm.test(
        "rsm_disc_irradiance(x, n, y, m, intensity, area)",
        [](auto x, auto n, auto y, auto m, auto intensity, auto area) {
            return rsm_disc_irradiance(x, n, y, m, intensity, area);
        },
        vector3("x", place), unit("n"), vector3("y", place), unit("m"), vector3("intensity", logarithmic(1e-3, 1e3)),
        number("area", logarithmic(1e-4, 1)));
    rsm.test(
        "rsm_direction(ivec2(i, j), axis)", [](auto i, auto j, auto axis) { return rsm_direction(i, j, 16, axis); },
        integer("i", 0, 15), integer("j", 0, 15), unit("axis"));
    rsm.test(
        "rsm_tap(u, reach, size)", [](auto u, auto reach, auto size) { return rsm_tap(u, reach, size); },
        vector2("u", linear(0, 0.9999999)), number("reach", linear(0.01, 1)), number("size", values({16, 256, 1024})));
    rsm.run();
}

TEST(Functions, GiScreen) {
    Functions screen("gi_screen.glsl");
    // A projection with near and far planes: z' = f / (n - f), w' = n f / (n - f).
    screen
        .test(
            "screen_distance(depth, mat4(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, p, -1), vec4(0, 0, q, 0)))",
            [](auto depth, auto p, auto q) {
                using T = decltype(depth);
                const T o = T(0), one = T(1);
                return screen_distance(depth, Mat4<T>{{{one, o, o, o}, {o, one, o, o}, {o, o, p, T(-1)}, {o, o, q, o}}});
            },
            number("depth", linear(0, 0.999)), number("p", linear(-1.1, -1.001)), number("q", linear(-1, -0.01)))
        .named("screen_distance");
    screen.test(
        "screen_clip(o, d, reach, 1e-3)",
        [](auto o, auto d, auto reach) { return screen_clip(o, d, reach, decltype(reach)(1e-3)); },
        vector3("o", linear(-100, -0.01)), unit("d"), number("reach", logarithmic(0.01, 100)));
    screen.test(
        "screen_point(a, b, t)", [](auto a, auto b, auto t) { return screen_point(a, b, t); },
        vector4("a", logarithmic(0.01, 100)), vector4("b", logarithmic(0.01, 100)), number("t", linear(0, 1)));
    screen
        .test(
            "screen_meets(a, b, s, thickness) ? 1.0 : 0.0",
            [](auto a, auto b, auto s, auto thickness) {
                using T = decltype(a);
                return screen_meets(a, b, s, thickness) ? T(1) : T(0);
            },
            number("a", linear(0, 2)), number("b", linear(0, 2)), number("s", linear(0, 2)), number("thickness", linear(0, 1)))
        .named("screen_meets");
    screen.run();
}

TEST(Functions, GiCones) {
    Functions cones("gi_cones.glsl");
    cones.test(
        "cone_level(t, tangent, voxel)", [](auto t, auto tangent, auto voxel) { return cone_level(t, tangent, voxel); },
        number("t", logarithmic(1e-4, 2).with({0})), number("tangent", logarithmic(0.01, 2)),
        number("voxel", logarithmic(1e-3, 0.1)));
    cones
        .test(
            "cone_opacity(alpha, ratio)", [](auto alpha, auto ratio) { return cone_opacity(alpha, ratio); },
            number("alpha", linear(0, 1).also({1e-3})), number("ratio", linear(0, 16)))
        .truth(cone_opacity_textbook, 1e-6, 1e-12);
    cones.test(
        "cone_over(a, b)", [](auto a, auto b) { return cone_over(a, b); }, vector4("a", linear(0, 1)),
        vector4("b", linear(0, 1)));
    cones.test(
        "cone_of_six(i, n)", [](auto i, auto n) { return cone_of_six(i, n); }, integer("i", 0, 5), unit("n"));
    cones.run();
}

TEST(Functions, GiSdf) {
    Functions sdf("gi_sdf.glsl");
    const auto p = vector3("p", linear(-3, 3));
    sdf.test(
        "sdf_sphere(p, radius)", [](auto at, auto radius) { return sdf_sphere(at, radius); }, p,
        number("radius", linear(0.1, 2)));
    sdf.test(
        "sdf_box(p, h)", [](auto at, auto h) { return sdf_box(at, h); }, p, vector3("h", linear(0.1, 2)));
    sdf.test(
        "sdf_rectangle(p, o, vec3(a, 0, 0), vec3(0, 0, b))",
        [](auto at, auto o, auto a, auto b) {
            using T = decltype(a);
            return sdf_rectangle(at, o, Vec3<T>{a, T(0), T(0)}, Vec3<T>{T(0), T(0), b});
        },
        p, vector3("o", linear(-1, 1)), number("a", linear(0.1, 2)), number("b", linear(0.1, 2)));
    sdf.test(
           "sdf_open_share(d, t, tangent)", [](auto d, auto t, auto tangent) { return sdf_open_share(d, t, tangent); },
           number("d", either_sign(1e-4, 1)), number("t", linear(0, 10)), number("tangent", logarithmic(0.01, 2)))
        .truth(sdf_open_share_textbook, 0, 1e-7);
    sdf.test(
        "sdf_soft_share(d, t, k)", [](auto d, auto t, auto k) { return sdf_soft_share(d, t, k); },
        number("d", either_sign(1e-4, 1)), number("t", linear(0, 10)), number("k", logarithmic(0.5, 100)));
    sdf.run();
}

template <class T>
Vec3<T> converted(const Vec3<double>& v) {
    return {T(v.x), T(v.y), T(v.z)};
}
template <class T>
std::vector<GiQuad<T>> converted(const std::vector<GiQuad<double>>& quads) {
    std::vector<GiQuad<T>> result;
    for (const GiQuad<double>& q : quads)
        result.push_back(
            {converted<T>(q.origin), converted<T>(q.u), converted<T>(q.v), converted<T>(q.albedo), converted<T>(q.emission)});
    return result;
}
template <class T>
GiLamp<T> converted(const GiLamp<double>& lamp) {
    return {converted<T>(lamp.position), converted<T>(lamp.axis), converted<T>(lamp.intensity)};
}

// The Cornell box of the shader and of the reference are the same room, seen by every ray.
TEST(Functions, GiPath) {
    Functions path("gi_cornell.glsl", "gi_path.glsl");
    const auto inside = vector3("p", linear(-0.99, 0.99));
    path.test(
            "float t; int i = gi_trace(p, d, 1e-4, 1e30, t); result = vec2(float(i), i < 0 ? 0.0 : t);",
            [](auto p, auto d) {
                using T = std::decay_t<decltype(p.x)>;
                T t;
                const int i = gi_trace(converted<T>(gi_cornell_quads()), p, d, T(1e-4), T(1e30), t);
                return Vec2<T>{T(i), i < 0 ? T(0) : t};
            },
            inside, unit("d"))
        .named("gi_trace");
    path.test(
            "float t; vec3 n, albedo, emission; gi_meet(p, d, 1e-4, 1e30, t, n, albedo, emission); result = vec4(n, albedo.r);",
            [](auto p, auto d) {
                using T = std::decay_t<decltype(p.x)>;
                T t;
                Vec3<T> n, albedo, emission;
                gi_meet(converted<T>(gi_cornell_quads()), p, d, T(1e-4), T(1e30), t, n, albedo, emission);
                return Vec4<T>{n.x, n.y, n.z, albedo.x};
            },
            inside, unit("d"))
        .named("gi_meet");
    path.test(
        "gi_distance(p)",
        [](auto p) {
            using T = std::decay_t<decltype(p.x)>;
            return gi_distance(converted<T>(gi_cornell_quads()), p);
        },
        inside);
    path.test(
            "gi_direct(gi_cornell_lamp(), p, n)",
            [](auto p, auto n) {
                using T = std::decay_t<decltype(p.x)>;
                return gi_direct(converted<T>(gi_cornell_quads()), converted<T>(gi_cornell_lamp()), p, n);
            },
            inside, unit("n"))
        .named("gi_direct");
    path.run();
}

}  // namespace
}  // namespace kiln::test
