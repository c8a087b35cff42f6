#ifndef KILN_BESSEL_GLSL
#define KILN_BESSEL_GLSL
// Modified Bessel functions of order 0, in the scaled forms that neither overflow nor underflow.
// Polynomials: Abramowitz and Stegun, "Handbook of Mathematical Functions", 9.8.1, 9.8.2, 9.8.5, 9.8.6.

// exp(-x) I0(x), x: [0, inf). Relative error of the fit below 2e-7; 1/sqrt(2 pi x) for large x.
float bessel_i0_scaled(float x) {
    const float t = x / 3.75;
    const float t2 = t * t;
    const float near = 1.0 + t2 * (3.5156229 + t2 * (3.0899424 + t2 * (1.2067492 + t2 * (0.2659732 +
                       t2 * (0.0360768 + t2 * 0.0045813)))));
    if (x < 3.75) return near * exp(-x);
    const float u = 3.75 / x;
    const float far = 0.39894228 + u * (0.01328592 + u * (0.00225319 + u * (-0.00157565 + u * (0.00916281 +
                      u * (-0.02057706 + u * (0.02635537 + u * (-0.01647633 + u * 0.00392377)))))));
    return far * inversesqrt(x);
}

// exp(x) K0(x), x: (0, inf). Relative error of the fit below 3e-7; -ln(x/2) - 0.5772 for small x.
float bessel_k0_scaled(float x) {
    if (x <= 2.0) {
        const float h = 0.5 * x;
        const float y = h * h;
        const float t2 = x * x / 14.0625;
        const float i0 = 1.0 + t2 * (3.5156229 + t2 * (3.0899424 + t2 * (1.2067492 + t2 * (0.2659732 +
                         t2 * (0.0360768 + t2 * 0.0045813)))));
        const float series = -0.57721566 + y * (0.42278420 + y * (0.23069756 + y * (0.03488590 + y * (0.00262698 +
                             y * (0.00010750 + y * 0.00000740)))));
        return (series - log(max(h, 1e-37)) * i0) * exp(x);
    }
    const float u = 2.0 / x;
    return (1.25331414 + u * (-0.07832358 + u * (0.02189568 + u * (-0.01062446 + u * (0.00587872 +
            u * (-0.00251540 + u * 0.00053208)))))) * inversesqrt(x);
}

#endif
