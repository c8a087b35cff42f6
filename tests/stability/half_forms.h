#pragma once
// The forms of D and V in native half precision, operation for operation as the files of uber/lib and the lecture have them in
// single. Vectors come as singles and are rounded to halves first; results go back as singles.

namespace kiln::test {

inline constexpr const char* half_extension = "#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require\n";

inline constexpr const char* half_forms = R"(
float16_t half_square_form(float16_t c, float16_t alpha) {   // as printed in the lecture
    precise float16_t a2 = alpha * alpha;
    precise float16_t f = c * c * (a2 - float16_t(1.0)) + float16_t(1.0);
    precise float16_t d = a2 / (float16_t(pi) * f * f);
    return d;
}
float16_t half_difference(f16vec3 n, f16vec3 h, float16_t alpha) {   // ggx_distribution
    const f16vec3 d = h - n;
    const float16_t c = dot(d, d);
    const float16_t a_cosine = alpha * (float16_t(1.0) - float16_t(0.5) * c);
    const float16_t k = alpha / (c * (float16_t(1.0) - float16_t(0.25) * c) + a_cosine * a_cosine);
    return k * (k / float16_t(pi));    // k^2 alone passes 65504 below alpha 0.0039
}
float16_t half_cross(f16vec3 n, f16vec3 h, float16_t alpha) {    // ggx_distribution_cross
    const f16vec3 across = cross(n, h);
    const float16_t a_cosine = alpha * dot(n, h);
    const float16_t k = alpha / (dot(across, across) + a_cosine * a_cosine);
    return k * (k / float16_t(pi));
}
float16_t half_visibility(float16_t l, float16_t v, float16_t alpha) {    // ggx_visibility
    const float16_t a2 = alpha * alpha;
    return float16_t(0.5) / (l * sqrt(v * v * (float16_t(1.0) - a2) + a2) + v * sqrt(l * l * (float16_t(1.0) - a2) + a2));
}
)";

}  // namespace kiln::test
