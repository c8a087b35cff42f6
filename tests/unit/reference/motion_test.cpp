// Screen motion of points whose motion is known.

#include "uber/reference/motion.h"

#include <gtest/gtest.h>

namespace kiln::reference {
namespace {

using V4 = Vec4<double>;

TEST(Motion, LeavesJitterOut) {
    const Vec2<double> m = screen_motion(V4{1, 0, 0, 2}, V4{0, 0.5, 0, 1}, V4{0.1, 0, 0, 0.3});
    EXPECT_NEAR(m.x, 0.2, 1e-15);   // ((0.5 - 0.1) - (0 - 0)) / 2
    EXPECT_NEAR(m.y, -0.1, 1e-15);  // ((0 - 0) - (0.5 - 0.3)) / 2
}

TEST(Motion, HasNoHistoryBehindTheCamera) {
    for (const double w : {-1.0, 0.0, 1e-40})
        for (const bool before : {false, true}) {
            const V4 there{1, 1, 0, 1}, nowhere{1, 0, 0, w};
            const Vec2<double> m = screen_motion(before ? there : nowhere, before ? nowhere : there, V4{});
            EXPECT_EQ(m.x, 0);
            EXPECT_EQ(m.y, 0);
        }
}

}  // namespace
}  // namespace kiln::reference
