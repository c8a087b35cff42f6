#ifndef KILN_MOTION_GLSL
#define KILN_MOTION_GLSL
// Screen motion.

// How far a point moved on the screen since the last frame, in uv units (1 is the picture's width or height), the jitter
// of both frames taken out: current - previous. 0 for a point that is or was not in front of the camera (w <= 1e-18), where
// no history can be read. clip, previous_clip: clip space, up to 1e18; jitter: NDC offsets, xy of this frame and zw of the last.
vec2 screen_motion(vec4 clip, vec4 previous_clip, vec4 jitter) {
    const bool in_front = min(clip.w, previous_clip.w) > 1e-18;
    const vec2 now = clip.xy / (in_front ? clip.w : 1.0) - jitter.xy;
    const vec2 before = previous_clip.xy / (in_front ? previous_clip.w : 1.0) - jitter.zw;
    return in_front ? (now - before) * 0.5 : vec2(0.0);
}

#endif
