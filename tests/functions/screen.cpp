#include "uber/reference/screen.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Screen) {
    Functions screen("screen.glsl");
    // Any matrix at all: w passes through 0 for some pixels, where only finiteness is left to hold.
    screen
        .test(
            "screen_to_world(m, uv, depth)", [](auto m, auto uv, auto depth) { return screen_to_world(m, uv, depth); },
            matrix4("m", linear(-2, 2)), vector2("uv", linear(0, 1)), number("depth", linear(0, 1)))
        .unbounded(0.02);
    screen.test(
        "screen_ray(m, uv)", [](auto m, auto uv) { return screen_ray(m, uv); }, matrix4("m", linear(-2, 2)),
        vector2("uv", linear(0, 1)));
    // A view along -z with tangent 1/2, near plane 1/4, far plane at infinity: what it drew comes back.
    screen
        .test(
            "screen_to_world(mat4(0.5, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0, 0.0, 0.0, 0.0, -4.0, 0.0, 0.0, -1.0, 4.0), "
            "vec2(2.0 * p.x / -p.z + 1.0, -2.0 * p.y / -p.z + 1.0) * 0.5, 1.0 + 0.25 / p.z)",
            [](auto p) {
                using T = decltype(p.x);
                const T o(0);
                const Mat4<T> m{{{T(0.5), o, o, o}, {o, T(-0.5), o, o}, {o, o, o, T(-4)}, {o, o, T(-1), T(4)}}};
                const Vec2<T> uv{(T(2) * p.x / -p.z + T(1)) * T(0.5), (T(-2) * p.y / -p.z + T(1)) * T(0.5)};
                return screen_to_world(m, uv, T(1) + T(0.25) / p.z);
            },
            vector3("p", linear(-8, -0.25)))
        .named("screen_to_world_of_what_was_drawn")
        .truth([](auto p) { return p; }, 1e-12);
    screen.run();
}

}  // namespace
}  // namespace kiln::test
