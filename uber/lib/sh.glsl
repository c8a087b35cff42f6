#ifndef KILN_SH_GLSL
#define KILN_SH_GLSL
// Real spherical harmonics of bands 0 to 1 (L1, four numbers a colour) and 0 to 2 (L2, nine), for light around a point.
//
// A set of coefficients means nothing without its convention: multiplying by the basis constants both in the bake and when
// shading makes a furnace of 0.886 instead of pi. So each convention is a type of its own, and a function takes one type:
//   ShMomentsL1     m0 = integral of L, m1 = integral of L times direction; no basis constant in them ("raw moments")
//   ShL1, ShL2      orthonormal coefficients of radiance, c_lm = integral of L Y_lm
//   ShIrradianceL1, ShIrradianceL2    orthonormal coefficients of irradiance, pi c_0m, 2 pi/3 c_1m, pi/4 c_2m
//   ShWeightedL1    raw moments times the cosine lobe's weights, m0 / 4 and m1 / 2: shading is one dot product
// All integrals are over the sphere of directions. Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance
// Environment Maps", 2001; Sloan, "Stupid Spherical Harmonics (SH) Tricks", 2008.
// Order of coefficients: 1, y, z, x, xy, yz, 3 z^2 - 1, xz, x^2 - y^2. Radiance in W/(m2 sr), irradiance in W/m2.
#include "math.glsl"

const float sh_y0 = 0.282094792;      // sqrt(1 / (4 pi))
const float sh_y1 = 0.488602512;      // sqrt(3 / (4 pi)), times y, z or x
const float sh_y2 = 1.092548431;      // sqrt(15 / (4 pi)), times xy, yz or xz
const float sh_y2_z = 0.315391565;    // sqrt(5 / (16 pi)), times 3 z^2 - 1
const float sh_y2_x = 0.546274215;    // sqrt(15 / (16 pi)), times x^2 - y^2

struct ShMomentsL1 {
    vec3 m0, m1_y, m1_z, m1_x;
};
struct ShWeightedL1 {
    vec3 w0, w1_y, w1_z, w1_x;
};
struct ShL1 {
    vec3 c[4];
};
struct ShL2 {
    vec3 c[9];
};
struct ShIrradianceL1 {
    vec3 e[4];
};
struct ShIrradianceL2 {
    vec3 e[9];
};
// Irradiance of one colour channel each as n^T M n with n = (x, y, z, 1); symmetric.
struct ShQuadratic {
    mat4 red, green, blue;
};

// The four basis functions of bands 0 and 1 in direction p. p: unit vector.
vec4 sh_l1_basis(vec3 p) {
    return vec4(sh_y0, sh_y1 * p.y, sh_y1 * p.z, sh_y1 * p.x);
}

// The first four basis functions of band 2 in direction p: xy, yz, 3 z^2 - 1, xz. p: unit vector.
vec4 sh_band2_basis(vec3 p) {
    return vec4(sh_y2 * p.x * p.y, sh_y2 * p.y * p.z, sh_y2_z * (3.0 * p.z * p.z - 1.0), sh_y2 * p.x * p.z);
}

// The fifth: x^2 - y^2, as a product so that nothing cancels beyond the difference itself. p: unit vector.
float sh_band2_basis_last(vec3 p) {
    return sh_y2_x * ((p.x - p.y) * (p.x + p.y));
}

ShMomentsL1 sh_moments_zero() {
    return ShMomentsL1(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
}

ShL1 sh_l1_zero() {
    return ShL1(vec3[4](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)));
}

ShL2 sh_l2_zero() {
    return ShL2(vec3[9](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0)));
}

// sum plus one sample of radiance that stands for a solid angle. direction: unit vector; radiance: >= 0; solid_angle: sr,
// 4 pi / N for N samples spread evenly over the sphere.
ShMomentsL1 sh_moments_accumulate(ShMomentsL1 sum, vec3 direction, vec3 radiance, float solid_angle) {
    const vec3 l = radiance * solid_angle;
    return ShMomentsL1(sum.m0 + l, sum.m1_y + l * direction.y, sum.m1_z + l * direction.z, sum.m1_x + l * direction.x);
}

ShL1 sh_l1_accumulate(ShL1 sum, vec3 direction, vec3 radiance, float solid_angle) {
    const vec3 l = radiance * solid_angle;
    const vec4 y = sh_l1_basis(direction);
    sum.c[0] += l * y.x;
    sum.c[1] += l * y.y;
    sum.c[2] += l * y.z;
    sum.c[3] += l * y.w;
    return sum;
}

ShL2 sh_l2_accumulate(ShL2 sum, vec3 direction, vec3 radiance, float solid_angle) {
    const vec3 l = radiance * solid_angle;
    const vec4 y1 = sh_l1_basis(direction);
    const vec4 y2 = sh_band2_basis(direction);
    sum.c[0] += l * y1.x;
    sum.c[1] += l * y1.y;
    sum.c[2] += l * y1.z;
    sum.c[3] += l * y1.w;
    sum.c[4] += l * y2.x;
    sum.c[5] += l * y2.y;
    sum.c[6] += l * y2.z;
    sum.c[7] += l * y2.w;
    sum.c[8] += l * sh_band2_basis_last(direction);
    return sum;
}

// From orthonormal coefficients to raw moments and back: m0 = c0 / Y0, m1 = c1 / Y1.
ShMomentsL1 sh_moments_of(ShL1 sh) {
    return ShMomentsL1(sh.c[0] / sh_y0, sh.c[1] / sh_y1, sh.c[2] / sh_y1, sh.c[3] / sh_y1);
}

ShL1 sh_l1_of(ShMomentsL1 m) {
    return ShL1(vec3[4](m.m0 * sh_y0, m.m1_y * sh_y1, m.m1_z * sh_y1, m.m1_x * sh_y1));
}

// Convolution with the clamped cosine: band l times pi, 2 pi/3, pi/4. Bands 0, 1 and 2 hold 37.5 %, 50 % and 11.7 % of the
// lobe's energy. These eigenvalues are not sqrt(pi)/2 and sqrt(pi/3): those contain a basis constant already.
ShIrradianceL1 sh_l1_convolve(ShL1 sh) {
    const float band1 = 2.0 * pi / 3.0;
    return ShIrradianceL1(vec3[4](sh.c[0] * pi, sh.c[1] * band1, sh.c[2] * band1, sh.c[3] * band1));
}

ShIrradianceL2 sh_l2_convolve(ShL2 sh) {
    const float band1 = 2.0 * pi / 3.0;
    const float band2 = pi / 4.0;
    return ShIrradianceL2(vec3[9](sh.c[0] * pi, sh.c[1] * band1, sh.c[2] * band1, sh.c[3] * band1, sh.c[4] * band2,
                                  sh.c[5] * band2, sh.c[6] * band2, sh.c[7] * band2, sh.c[8] * band2));
}

ShWeightedL1 sh_l1_weight(ShMomentsL1 m) {
    return ShWeightedL1(0.25 * m.m0, 0.5 * m.m1_y, 0.5 * m.m1_z, 0.5 * m.m1_x);
}

// Radiance from direction p as the bands have it. p: unit vector. May be negative.
vec3 sh_l1_radiance(ShL1 sh, vec3 p) {
    const vec4 y = sh_l1_basis(p);
    return sh.c[0] * y.x + sh.c[1] * y.y + sh.c[2] * y.z + sh.c[3] * y.w;
}

vec3 sh_l2_radiance(ShL2 sh, vec3 p) {
    const vec4 y = sh_band2_basis(p);
    const vec3 l1 = sh_l1_radiance(ShL1(vec3[4](sh.c[0], sh.c[1], sh.c[2], sh.c[3])), p);
    return l1 + sh.c[4] * y.x + sh.c[5] * y.y + sh.c[6] * y.z + sh.c[7] * y.w + sh.c[8] * sh_band2_basis_last(p);
}

// Irradiance on a receiver with normal n. Each line below is the same number from another convention; all may be negative
// opposite a small light (L1 by up to 0.25, L2 by 0.0396 of the irradiance that faces it). n: unit vector.
vec3 sh_irradiance_convolved(ShIrradianceL1 sh, vec3 n) {
    return sh_l1_radiance(ShL1(sh.e), n);
}

vec3 sh_irradiance_convolved(ShIrradianceL2 sh, vec3 n) {
    return sh_l2_radiance(ShL2(sh.e), n);
}

// E = m0 / 4 + m1 . n / 2:  1/4 = pi Y0^2, 1/2 = 2 pi/3 Y1^2.
vec3 sh_irradiance_from_moments(ShMomentsL1 m, vec3 n) {
    return 0.25 * m.m0 + 0.5 * (m.m1_y * n.y + m.m1_z * n.z + m.m1_x * n.x);
}

vec3 sh_irradiance_from_weighted(ShWeightedL1 w, vec3 n) {
    return w.w0 + w.w1_y * n.y + w.w1_z * n.z + w.w1_x * n.x;
}

// E = pi Y0 c0 + 2 pi/3 Y1 c1 . n, convolution and evaluation merged: sqrt(pi) / 2 and sqrt(pi / 3).
vec3 sh_irradiance_from_radiance(ShL1 sh, vec3 n) {
    return 0.886226925 * sh.c[0] + 1.023326708 * (sh.c[1] * n.y + sh.c[2] * n.z + sh.c[3] * n.x);
}

// The same to band 2: pi/4 sqrt(15 / (4 pi)) = 0.858085531 for the mixed terms, a quarter and a half of its parts for the
// others. Ramamoorthi and Hanrahan 2001 write c1 = 0.429043, c3 = 0.743125, c5 = 0.247708 for halves of the same numbers.
vec3 sh_irradiance_from_radiance(ShL2 sh, vec3 n) {
    const vec3 l1 = 0.886226925 * sh.c[0] + 1.023326708 * (sh.c[1] * n.y + sh.c[2] * n.z + sh.c[3] * n.x);
    const vec3 mixed = sh.c[4] * (n.x * n.y) + sh.c[5] * (n.y * n.z) + sh.c[7] * (n.x * n.z);
    return l1 + 0.858085531 * mixed + 0.247707956 * sh.c[6] * (3.0 * n.z * n.z - 1.0) +
           0.429042765 * sh.c[8] * ((n.x - n.y) * (n.x + n.y));
}

// The matrix of one channel's quadratic form, E(n) = n^T M n, n = (x, y, z, 1) (Ramamoorthi and Hanrahan 2001, equation
// 12). It is irradiance, not the projection integral. c: that channel's nine orthonormal coefficients of radiance.
mat4 sh_quadratic_matrix(float c[9]) {
    const float c1 = 0.429042765, c2 = 0.511663354, c3 = 0.743123868, c4 = 0.886226925, c5 = 0.247707956;
    return mat4(vec4(c1 * c[8], c1 * c[4], c1 * c[7], c2 * c[3]), vec4(c1 * c[4], -c1 * c[8], c1 * c[5], c2 * c[1]),
                vec4(c1 * c[7], c1 * c[5], c3 * c[6], c2 * c[2]), vec4(c2 * c[3], c2 * c[1], c2 * c[2], c4 * c[0] - c5 * c[6]));
}

ShQuadratic sh_quadratic(ShL2 sh) {
    float c[3][9];
    for (int i = 0; i < 9; ++i) {
        c[0][i] = sh.c[i].r;
        c[1][i] = sh.c[i].g;
        c[2][i] = sh.c[i].b;
    }
    return ShQuadratic(sh_quadratic_matrix(c[0]), sh_quadratic_matrix(c[1]), sh_quadratic_matrix(c[2]));
}

vec3 sh_quadratic_irradiance(ShQuadratic q, vec3 n) {
    const vec4 v = vec4(n, 1.0);
    return vec3(dot(v, q.red * v), dot(v, q.green * v), dot(v, q.blue * v));
}

// Forms that are never negative.

// The two-band or three-band sum, 0 where it is below. What the clamp adds is light that is not there: RMSE of a small
// light falls from 0.144 to 0.125 (L1) and 0.036 to 0.033 (L2) of the irradiance that faces it.
vec3 sh_irradiance_clamped(ShMomentsL1 m, vec3 n) {
    return max(sh_irradiance_from_moments(m, n), vec3(0.0));
}

vec3 sh_irradiance_clamped(ShL2 sh, vec3 n) {
    return max(sh_irradiance_from_radiance(sh, n), vec3(0.0));
}

// One channel of the non-linear L1 form:
//   E = m0/4 (a + (1 - a)(p + 1) q^p),   q = (1 + m1 . n / |m1|) / 2,   p = 1 + 2 k,   a = (1 - k) / (1 + k),   k = |m1| / m0
// where (1 - a)(p + 1) = 4 k. It keeps m0, equals m0/4 + m1 . n / 2 for small k, and a small light (k = 1) gives
// ((1 + cos) / 2)^3: right where it faces the light, RMSE 0.057. Hazel, "Reconstructing Diffuse Lighting from Spherical
// Harmonic Data", Geomerics, 2017.
// m0: W/m2, below 0 counts as 0; m1: (x, y, z) of this channel, at most 1e18, below 1e-15 counts as 0; k is limited to [0, 1],
// which no light leaves; n: unit.
float sh_irradiance_nonlinear_channel(float m0, vec3 m1, vec3 n) {
    const float power = max(m0, 0.0);
    const float square = dot(m1, m1);
    const float inverse = inversesqrt(max(square, 1e-30));
    const float k = saturate(square * inverse / max(power, 1e-30));
    const float q = saturate(0.5 + 0.5 * inverse * dot(m1, n));
    const float lobe = q * exp2(2.0 * k * log2(max(q, 1e-30)));
    return 0.25 * power * ((1.0 - k) / (1.0 + k) + 4.0 * k * lobe);
}

vec3 sh_irradiance_nonlinear(ShMomentsL1 m, vec3 n) {
    return vec3(sh_irradiance_nonlinear_channel(m.m0.r, vec3(m.m1_x.r, m.m1_y.r, m.m1_z.r), n),
                sh_irradiance_nonlinear_channel(m.m0.g, vec3(m.m1_x.g, m.m1_y.g, m.m1_z.g), n),
                sh_irradiance_nonlinear_channel(m.m0.b, vec3(m.m1_x.b, m.m1_y.b, m.m1_z.b), n));
}

// Hallucinated ZH3: the third band of a light that has one axis, guessed from how much of two bands points one way. Roughton,
// Sloan, Silvennoinen, Iwanicki and Shirley, "ZH3: Quadratic Zonal Harmonics", I3D 2024, section 3.4: with orthonormal
// coefficients and r = |c1 . axis| / c0, in [0, sqrt 3],
//   c2 = c0 (0.08 r + 0.6 r^2) along the axis,   E = E of two bands + pi/4 c2 sqrt(5 / (16 pi)) (3 (n . axis)^2 - 1)
// where r = sqrt(3) k, k = |m1 . axis| / m0, so that the constants below are sqrt(5)/32 times 0.08 sqrt(3) and 1.8.
// A small light gives 1.02 of what faces it and RMSE 0.041 (two bands 0.144, three 0.036). Below 0 for k > 0.84 only, by at most
// 0.039 of m0 (two bands: 0.25).
float sh_zh3_zonal(float k, float z) {
    return k * (0.00968246 + 0.125778818 * k) * (3.0 * z * z - 1.0);
}

// One channel, about its own axis. m0: W/m2, below 0 counts as 0; m1: (x, y, z) of this channel, at most 1e18, below 1e-15
// counts as 0; k is limited to [0, 1], which no light leaves; n: unit. May be negative.
float sh_irradiance_zh3_channel(float m0, vec3 m1, vec3 n) {
    const float power = max(m0, 0.0);
    const float square = dot(m1, m1);
    const float inverse = inversesqrt(max(square, 1e-30));
    const float k = saturate(square * inverse / max(power, 1e-30));
    const float z = clamp(inverse * dot(m1, n), -1.0, 1.0);
    return power * (0.25 + 0.5 * k * z + sh_zh3_zonal(k, z));
}

vec3 sh_irradiance_zh3(ShMomentsL1 m, vec3 n) {
    return vec3(sh_irradiance_zh3_channel(m.m0.r, vec3(m.m1_x.r, m.m1_y.r, m.m1_z.r), n),
                sh_irradiance_zh3_channel(m.m0.g, vec3(m.m1_x.g, m.m1_y.g, m.m1_z.g), n),
                sh_irradiance_zh3_channel(m.m0.b, vec3(m.m1_x.b, m.m1_y.b, m.m1_z.b), n));
}

// All channels about the axis of their luminance (Rec. 709), as the paper has it, so that a white light's band is white and one
// root is all. Lights of several colours from several sides share an axis that none of them has. Two bands are kept as they
// are: k is limited, the moments are not.
vec3 sh_irradiance_zh3_luminance(ShMomentsL1 m, vec3 n) {
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    const vec3 sum = vec3(dot(m.m1_x, luminance), dot(m.m1_y, luminance), dot(m.m1_z, luminance));
    const vec3 axis = sum * inversesqrt(max(dot(sum, sum), 1e-30));
    const vec3 along = abs(m.m1_x * axis.x + m.m1_y * axis.y + m.m1_z * axis.z);
    const vec3 power = max(m.m0, vec3(0.0));
    const vec3 k = min(along / max(power, vec3(1e-30)), vec3(1.0));
    const float z = dot(axis, n);
    return sh_irradiance_from_moments(m, n) + power * vec3(sh_zh3_zonal(k.r, z), sh_zh3_zonal(k.g, z), sh_zh3_zonal(k.b, z));
}

#endif
