#pragma once
// Screen motion, as uber/lib/motion.glsl names it.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// ((ndc - jitter) - (previous ndc - previous jitter)) / 2, or 0 where either point was not in front of the camera (w <= 1e-18).
template <class T>
Vec2<T> screen_motion(const Vec4<T>& clip, const Vec4<T>& previous_clip, const Vec4<T>& jitter) {
    if (!(min(clip.w, previous_clip.w) > T(1e-18))) return {T(0), T(0)};
    const Vec2<T> now = clip.xy() / clip.w - jitter.xy();
    const Vec2<T> before = previous_clip.xy() / previous_clip.w - Vec2<T>{jitter.z, jitter.w};
    return (now - before) * T(0.5);
}

}  // namespace kiln::reference
