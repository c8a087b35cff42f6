#pragma once
// GLSL that counts what clamp, min and max would hide: put before any text, it looks at each of their arguments on the way in.

namespace kiln::test {

inline constexpr const char* watching = R"(
int watched_non_finite = 0;
float watched(float a) { if (isnan(a) || isinf(a)) ++watched_non_finite; return a; }
vec2 watched(vec2 a) { watched(a.x); watched(a.y); return a; }
vec3 watched(vec3 a) { watched(a.x); watched(a.y); watched(a.z); return a; }
vec4 watched(vec4 a) { watched(a.xy); watched(a.zw); return a; }
int watched(int a) { return a; }
ivec2 watched(ivec2 a) { return a; }
ivec3 watched(ivec3 a) { return a; }
uint watched(uint a) { return a; }
#define clamp(a, b, c) clamp(watched(a), watched(b), watched(c))
#define min(a, b) min(watched(a), watched(b))
#define max(a, b) max(watched(a), watched(b))
)";

}  // namespace kiln::test
