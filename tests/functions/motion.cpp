#include "uber/reference/motion.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Motion) {
    Functions motion("motion.glsl");
    motion.test(
        "screen_motion(clip, previous_clip, jitter)",
        [](auto clip, auto previous_clip, auto jitter) { return screen_motion(clip, previous_clip, jitter); },
        vector4("clip", either_sign(1e-19, 1e18)), vector4("previous_clip", either_sign(1e-19, 1e18)),
        vector4("jitter", linear(-1e-2, 1e-2)));
    motion.run();
}

}  // namespace
}  // namespace kiln::test
