#pragma once
// uber/post.frag as a function: a pixel's radiance to what the screen is given.

#include "uber/reference/color.h"
#include "uber/reference/tonemap.h"

namespace kiln::reference {

// Values in the order of manifests/renderer.yaml.
enum class PostTone { clip, reinhard, reinhard_white, aces };

struct PostAxes {
    bool metered = false, encode_srgb = false;
    PostTone tone = PostTone::clip;
};

// mean: luminance; counts where metered.
template <class T>
Vec3<T> post_color(const PostAxes& axes, const Vec3<T>& radiance, const T& exposure_value, const T& white, const T& mean) {
    const T exposure = axes.metered ? exposure_from_mean(mean) * exp2(-exposure_value) : exposure_from_ev100(exposure_value);
    const Vec3<T> exposed = limit_half(radiance * exposure);
    const Vec3<T> shown = axes.tone == PostTone::reinhard         ? tone_reinhard(exposed)
                          : axes.tone == PostTone::reinhard_white ? tone_reinhard_white(exposed, white)
                          : axes.tone == PostTone::aces           ? tone_aces(exposed)
                                                                  : min(exposed, splat3(T(1)));
    return axes.encode_srgb ? srgb_encode(shown) : shown;
}

}  // namespace kiln::reference
