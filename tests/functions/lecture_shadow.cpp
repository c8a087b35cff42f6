#include "uber/reference/lecture_shadow.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

// The printed forms compute what they print; what that does to an image is in shadow_images.cpp.
TEST(Functions, LectureShadow) {
    Functions lecture("lecture_shadow.glsl");
    lecture.test(
        "pcss_penumbra_width_lecture(receiver, blocker, size)",
        [](auto receiver, auto blocker, auto size) { return pcss_penumbra_width_lecture(receiver, blocker, size); },
        number("receiver", linear(0, 100)), number("blocker", logarithmic(1e-3, 100)), number("size", linear(0, 5)));
    lecture.test(
        "pcss_mean_blocker_lecture(sum, count)", [](auto sum, auto count) { return pcss_mean_blocker_lecture(sum, count); },
        number("sum", linear(0, 1000)), number("count", linear(1, 64)));
    lecture.test(
        "shadow_moments_lecture(depth)", [](auto depth) { return shadow_moments_lecture(depth); }, number("depth", linear(0, 1)));
    lecture.test(
        "moments_variance_lecture(moments)", [](auto moments) { return moments_variance_lecture(moments); },
        vector2("moments", linear(0, 1)));
    // Where it has a value: its variance and distance from the mean not both near 0.
    lecture.test(
        "chebyshev_lecture(vec2(m, m * m + v), t)",
        [](auto m, auto v, auto t) {
            return chebyshev_lecture(Vec2<decltype(m)>{m, m * m + v}, t);
        },
        number("m", linear(0.1, 0.9)), number("v", logarithmic(1e-3, 0.2)), number("t", linear(0, 1)));
    lecture.run();
}

}  // namespace
}  // namespace kiln::test
