#version 450
// From the scene's radiance to the screen: exposure, curve, encoding.

#define EXPOSURE_FIXED 0
#define EXPOSURE_METERED 1

#define TONE_CLIP 0
#define TONE_REINHARD 1
#define TONE_REINHARD_WHITE 2
#define TONE_ACES 3

#include "lib/tonemap.glsl"
#if ENCODE_SRGB
#include "lib/color.glsl"
#endif

layout(std140, set = 0, binding = 0) uniform Post {
    float exposure_value;       // EV at ISO 100; metered: added to what is metered, so that -1 is twice as bright
    float white;                // radiance after exposure that becomes 1, >= 1; reinhard_white
};
layout(set = 0, binding = 1) uniform sampler2D scene_radiance;
#if EXPOSURE == EXPOSURE_METERED
layout(set = 0, binding = 2) uniform sampler2D mean_luminance;    // one texel r: cd/m2
#endif

layout(location = 0) in vec2 screen_uv;
layout(location = 0) out vec4 color;    // [0, 1]; linear or sRGB

void main() {
#if EXPOSURE == EXPOSURE_METERED
    const float exposure = exposure_from_mean(texelFetch(mean_luminance, ivec2(0), 0).r) * exp2(-exposure_value);
#else
    const float exposure = exposure_from_ev100(exposure_value);
#endif
    const vec3 exposed = limit_half(textureLod(scene_radiance, screen_uv, 0.0).rgb * exposure);
#if TONE == TONE_REINHARD
    const vec3 shown = tone_reinhard(exposed);
#elif TONE == TONE_REINHARD_WHITE
    const vec3 shown = tone_reinhard_white(exposed, white);
#elif TONE == TONE_ACES
    const vec3 shown = tone_aces(exposed);
#else
    const vec3 shown = min(exposed, vec3(1.0));
#endif
#if ENCODE_SRGB
    color = vec4(srgb_encode(shown), 1.0);
#else
    color = vec4(shown, 1.0);
#endif
}
