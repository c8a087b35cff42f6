#ifndef KILN_COLOR_GLSL
#define KILN_COLOR_GLSL
// The sRGB transfer functions, IEC 61966-2-1.

// Linear to encoded: 12.92 x up to 0.0031308, then 1.055 x^(1/2.4) - 0.055. x: any finite; negative ones give 0, since pow
// of one is undefined. Values above 1 go on along the curve.
float srgb_encode(float x) {
    const float y = max(x, 0.0);
    return y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1.0 / 2.4) - 0.055;
}
vec3 srgb_encode(vec3 x) { return vec3(srgb_encode(x.x), srgb_encode(x.y), srgb_encode(x.z)); }

// Encoded to linear: x / 12.92 up to 0.04045, then ((x + 0.055) / 1.055)^2.4. x: any finite; negative ones give 0.
float srgb_decode(float x) {
    const float y = max(x, 0.0);
    return y <= 0.04045 ? y / 12.92 : pow((y + 0.055) / 1.055, 2.4);
}
vec3 srgb_decode(vec3 x) { return vec3(srgb_decode(x.x), srgb_decode(x.y), srgb_decode(x.z)); }

#endif
