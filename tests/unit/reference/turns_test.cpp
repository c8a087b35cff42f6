// Samples around an axis ask for sines within [-pi, pi], where Vulkan bounds them: so their bounds say something. Beyond, each
// would be allowed 2.

#include <gtest/gtest.h>

#include "uber/reference/bounded.h"
#include "uber/reference/gi_cones.h"
#include "uber/reference/gi_rsm.h"
#include "uber/reference/ibl_bake.h"
#include "uber/reference/subsurface.h"

namespace kiln::reference {
namespace {

TEST(Turns, EverySampleIsBounded) {
    const Vec3<Bounded> n{Bounded(0.48), Bounded(0.6), Bounded(0.64)};
    const auto worst = [](const Vec3<Bounded>& v) { return std::max({v.x.error, v.y.error, v.z.error}); };
    for (int i = 1; i < 64; ++i) {
        const Vec2<Bounded> u{Bounded(0.3), Bounded(i / 64.0)};
        EXPECT_LT(worst(sample_cosine(u)), 2e-3) << i;
        EXPECT_LT(worst(sample_ggx_half(u, Bounded(0.5))), 2e-3) << i;
        EXPECT_LT(worst(gi_cosine_direction(u, n)), 4e-3) << i;
        EXPECT_LT(worst(rsm_tap(u, Bounded(1), Bounded(1))), 2e-3) << i;
        EXPECT_LT(worst(rsm_direction(i % 16, i / 16, 16, n)), 4e-3) << i;
        // Out to a radius that is itself known to some 1e-3. Not at the fold itself, where rounding may pass pi.
        const Vec3<Bounded> tap = burley_tap(i % 32, 32, Bounded(1), Bounded(i / 8.0 - 4.03));
        EXPECT_LT(worst(tap), 0.02 * std::max(1.0, tap.z.value)) << i;
    }
    for (int i = 0; i < 6; ++i) EXPECT_LT(worst(cone_of_six(i, n).xyz()), 4e-3) << i;
}

}  // namespace
}  // namespace kiln::reference
