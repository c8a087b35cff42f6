#include "uber/reference/pcss.h"

#include "tests/functions/shadow_maps.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Pcss) {
    Functions pcss("pcss.glsl");
    pcss.test(
            "light_distance(depth, near, far)",
            [](auto depth, auto near, auto far) { return near * far / (near * depth + far * (decltype(depth)(1) - depth)); },
            number("depth", linear(0, 1)), number("near", logarithmic(0.05, 1)), number("far", logarithmic(2, 1000)))
        .exactly([](double depth, double near, double far) { return light_distance(depth, near, far); });
    pcss.test(
            "map_distance(depth, near, far)",
            [](auto depth, auto near, auto far) {
                using T = decltype(depth);
                return near > T(0) ? near * far / (near * depth + far * (T(1) - depth)) : far * depth;
            },
            number("depth", linear(0, 1)), number("near", values({0, 0.1, 1})), number("far", logarithmic(2, 1000)))
        .exactly([](double depth, double near, double far) { return map_distance(depth, near, far); });
    pcss.test(
        "pcss_search_width(receiver, near, size)",
        [](auto receiver, auto near, auto size) { return pcss_search_width(receiver, near, size); },
        number("receiver", linear(0.01, 100)), number("near", logarithmic(0.05, 10)), number("size", linear(0, 5)));
    pcss.test(
        "pcss_penumbra_width(receiver, blocker, size, 0.01, 4.0)",
        [](auto receiver, auto blocker, auto size) {
            return pcss_penumbra_width(receiver, blocker, size, decltype(size)(0.01), decltype(size)(4));
        },
        number("receiver", linear(0, 100)), number("blocker", linear(0, 100).also({1e-3})), number("size", linear(0, 5)));
    pcss.test(
        "pcss_penumbra_width_directional(receiver, blocker, size, 0.01, 4.0)",
        [](auto receiver, auto blocker, auto size) {
            return pcss_penumbra_width_directional(receiver, blocker, size, decltype(size)(0.01), decltype(size)(4));
        },
        number("receiver", linear(0, 100)), number("blocker", linear(0, 100)), number("size", logarithmic(0.001, 0.5)));
    for (const int count : {16, 32, 64, 25}) {
        const std::string n = std::to_string(count);
        // 4096 jitters are enough to land next to the torus's seam; there either side is right.
        pcss.test(
                "pcss_square_tap(i, " + n + ", jitter)",
                [count](int i, auto jitter) { return pcss_square_tap(i, count, jitter); }, integer("i", 0, count - 1),
                vector2("jitter", linear(0, 0.999999)))
            .named("pcss_square_tap_" + n);
        pcss.test(
                "pcss_disk_tap(i, " + n + ", turn)", [count](int i, auto turn) { return pcss_disk_tap(i, count, turn); },
                integer("i", 0, count - 1), number("turn", linear(0, 0.999999)))
            .named("pcss_disk_tap_" + n);
    }
    // Every count that is allowed, as the table of steps has them.
    pcss.test(
            "pcss_square_tap(i % count, count, vec2(0.0))",
            [](int i, int count, auto one) { return pcss_square_tap(i % count, count, Vec2<decltype(one)>{}); },
            integer("i", 0, 255), integer("count", 4, 256), number("one", values({1})))
        .named("pcss_square_tap");

    const LightView view{1, 20, 2};
    const DepthTexture texture = depth_texture(square_scene(6), view, 64);
    pcss.texture("sampler2D depth_map", texture.image(), nearest(false));
    pcss.texture("sampler2DShadow shadow_map", texture.image(), nearest(true));
    const auto read = [&texture](auto uv) { return texture.read(uv); };
    const auto compare = [&texture](auto uv, auto depth) { return texture.compare(uv, depth); };
    pcss.test(
        "pcss_blockers(depth_map, place, slope, 1e-4, width, 1.0, 20.0, jitter)",
        [read](auto place, auto slope, auto width, auto jitter) {
            using T = decltype(place.x);
            return pcss_blockers(read, place, slope, T(1e-4), width, T(1), T(20), jitter);
        },
        vector3("place", linear(0, 1)), vector2("slope", linear(-0.3, 0.3)), vector2("width", logarithmic(1e-3, 0.5)),
        vector2("jitter", linear(0, 0.999)));
    pcss.test(
        "pcss_filter(shadow_map, place, slope, 1e-4, width, jitter)",
        [compare](auto place, auto slope, auto width, auto jitter) {
            return pcss_filter(compare, place, slope, decltype(place.x)(1e-4), width, jitter);
        },
        vector3("place", linear(0, 1)), vector2("slope", linear(-0.3, 0.3)), vector2("width", logarithmic(1e-3, 0.5)),
        vector2("jitter", linear(0, 0.999)));
    // Receivers anywhere before and behind the light, lights from none to 2 m.
    const auto clip_of = [](auto x, auto y, auto w) {
        using T = decltype(x);
        return Vec4<T>{x, y, T(20.0 / 19) * w - T(20.0 / 19), w};
    };
    pcss.test(
        "pcss_factor(depth_map, shadow_map, vec4(x, y, (20.0 / 19.0) * w - (20.0 / 19.0), w), vec2(0.0), 1e-4, size, 1.0, 20.0, "
        "2.0, 1.0 / 64.0, jitter)",
        [read, compare, clip_of](auto x_, auto y_, auto w_, auto size, auto jitter) {
            using T = decltype(x_);
            return pcss_factor(read, compare, clip_of(x_, y_, w_), Vec2<T>{T(0), T(0)}, T(1e-4), size, T(1), T(20), T(2),
                               T(1.0 / 64), jitter);
        },
        number("x", linear(-6, 6)), number("y", linear(-6, 6)), number("w", linear(-1, 22).also({0, 1, 20})),
        number("size", linear(0, 2)), vector2("jitter", linear(0, 0.999)));
    pcss.test(
        "pcss_factor_directional(depth_map, shadow_map, vec4(x, y, z, 1.0), vec2(0.0), 1e-4, size, 40.0, 10.0, 1.0 / 64.0, "
        "jitter)",
        [read, compare](auto x_, auto y_, auto z, auto size, auto jitter) {
            using T = decltype(x_);
            return pcss_factor_directional(read, compare, Vec4<T>{x_, y_, z, T(1)}, Vec2<T>{T(0), T(0)}, T(1e-4), size, T(40),
                                           T(10), T(1.0 / 64), jitter);
        },
        number("x", linear(-1.1, 1.1)), number("y", linear(-1.1, 1.1)), number("z", linear(-0.1, 1.1)),
        number("size", logarithmic(1e-3, 0.2)), vector2("jitter", linear(0, 0.999)));
    pcss.run();
}

}  // namespace
}  // namespace kiln::test
