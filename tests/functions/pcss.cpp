#include "uber/reference/pcss.h"

#include "tests/functions/function.h"

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
    pcss.run();
}

}  // namespace
}  // namespace kiln::test
