#ifndef KILN_HAIR_PUBLISHED_GLSL
#define KILN_HAIR_PUBLISHED_GLSL
// The longitudinal lobe of hair as it is printed, kept to measure by: hair_longitudinal in hair.glsl is the one to use.
// Arguments are hair_longitudinal's.

// d'Eon et al. 2011, equation 7, with I0 as a power series in 10 terms, which serves to x = 10. Not finite below
// v = 0.0112, where sinh(1/v) leaves fp32.
float hair_longitudinal_printed(float si, float ci, float so, float co, float v) {
    const float x = ci * co / v;
    const float y = 0.25 * x * x;
    float i0 = 1.0;
    float term = 1.0;
    for (int k = 1; k < 10; ++k) {
        term *= y / float(k * k);
        i0 += term;
    }
    return exp(-si * so / v) * i0 / (2.0 * v * sinh(1.0 / v));
}

// The logarithmic form for v <= 0.1 of d'Eon et al. 2013: log I0(x) = x + (1/(8x) - log(2 pi x)) / 2 above x = 12. Its 1/(8x)
// belongs outside the bracket: the integral comes out 0.06 to 0.08 % small at v = 0.01. Its sum of terms of size 1/v
// costs 6e-8 / v of relative error.
float hair_longitudinal_log(float si, float ci, float so, float co, float v) {
    const float x = ci * co / v;
    const float y = 0.25 * x * x;
    float i0 = 1.0;
    float term = 1.0;
    for (int k = 1; k < 10; ++k) {
        term *= y / float(k * k);
        i0 += term;
    }
    const float log_i0 = x > 12.0 ? x + 0.5 * (-log(2.0 * 3.14159265 * x) + 1.0 / (8.0 * x)) : log(i0);
    return exp(log_i0 - si * so / v - 1.0 / v + 0.6931 + log(1.0 / (2.0 * v)));
}

#endif
