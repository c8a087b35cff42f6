#pragma once
// The split-sum integrals of a GGX lobe (Karis, "Real Shading in Unreal Engine 4", 2013) by quadrature, in double:
//   A = integral of G2 v.h / (n.h n.v) (1 - (1 - v.h)^5) p dh,   B = the same with (1 - v.h)^5,   p dh = D n.h dh
// so that the directional albedo at Schlick's Fresnel is F0 A + F90 B. A + B is the albedo at F = 1.
//
// With tan(theta_h) = alpha tan(w) the lobe becomes (1/pi) sin w cos w dw dphi, smooth at every alpha. n.l > 0 bounds phi,
// and the bound has kinks at theta_h = (pi/2 -+ theta_v)/2, so the domain is cut there and each piece is smooth.
// `quadrature` is TanhSinh; from 60 on the results hold to 1e-12 (tests).

#include <cmath>

#include "uber/reference/quadrature.h"

namespace kiln::reference {

// The forms of Smith's G2 that are compared. karis_*: separable with G1(c) = c / (c (1 - k) + k).
enum class SmithForm {
    height_correlated,  // 1 / (1 + Lambda(l) + Lambda(v)), Heitz 2014
    separable,          // the exact G1(l) G1(v)
    karis_ibl,          // k = alpha / 2
    karis_direct,       // k = (roughness + 1)^2 / 8
};

// G2 in [0, 1], in the plain form. n_dot_l, n_dot_v: (0, 1]; roughness: perceptual, alpha = roughness^2.
inline double smith_g2(SmithForm form, double n_dot_l, double n_dot_v, double roughness) {
    const double alpha = roughness * roughness;
    const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 - c * c) / (c * c)) - 1.0); };
    const auto karis = [&](double k) { return n_dot_l / (n_dot_l * (1.0 - k) + k) * (n_dot_v / (n_dot_v * (1.0 - k) + k)); };
    switch (form) {
        case SmithForm::height_correlated:
            return 1.0 / (1.0 + lambda(n_dot_l) + lambda(n_dot_v));
        case SmithForm::separable:
            return 1.0 / ((1.0 + lambda(n_dot_l)) * (1.0 + lambda(n_dot_v)));
        case SmithForm::karis_ibl:
            return karis(0.5 * alpha);
        case SmithForm::karis_direct:
            break;
    }
    return karis((roughness + 1.0) * (roughness + 1.0) / 8.0);
}

// What a lobe's integrand may depend on.
struct LobeCosines {
    double n_dot_l, n_dot_h, v_dot_h;
};

// The integral of g(cosines) over the visible part of the GGX lobe, D n.h dh = 1 over all half vectors.
// n_dot_v: (0, 1]; alpha: (0, 1].
template <class G>
double ggx_lobe_integral(double n_dot_v, double alpha, const TanhSinh& quadrature, G g) {
    const double theta_v = std::acos(n_dot_v);
    const double sin_v = std::sqrt((1.0 - n_dot_v) * (1.0 + n_dot_v));
    const auto ring = [&](double w, bool cut) {  // over phi in [0, its bound], doubled
        const double t = alpha * std::tan(w);
        const double cos_h = 1.0 / std::sqrt(1.0 + t * t);
        const double sin_h = t * cos_h;
        double bound = pi;
        if (cut) {
            const double c = (0.5 * n_dot_v / cos_h - n_dot_v * cos_h) / (sin_v * sin_h);
            bound = std::acos(std::fmin(std::fmax(c, -1.0), 1.0));
        }
        const double sum = quadrature(0.0, bound, [&](double phi) {
            const double v_dot_h = n_dot_v * cos_h + sin_v * sin_h * std::cos(phi);
            const double n_dot_l = 2.0 * v_dot_h * cos_h - n_dot_v;
            return n_dot_l <= 0.0 ? 0.0 : g(LobeCosines{n_dot_l, cos_h, v_dot_h});
        });
        return 2.0 / pi * std::sin(w) * std::cos(w) * sum;
    };
    const auto w_of = [&](double theta_h) { return std::atan(std::tan(theta_h) / alpha); };
    const double inner = w_of(0.5 * (0.5 * pi - theta_v));
    const double outer = w_of(0.5 * (0.5 * pi + theta_v));
    double sum = quadrature(0.0, inner, [&](double w) { return ring(w, false); });
    if (sin_v > 0.0) sum += quadrature(inner, outer, [&](double w) { return ring(w, true); });
    return sum;
}

struct SplitSum {
    double a, b;
};

// A and B for any G2(n.l, n.v) and any Fresnel weight Fc(cosines): (1 - v.h)^5 as above; the lecture prints (1 - n.l)^5.
template <class G, class F>
SplitSum split_sum(double n_dot_v, double alpha, const TanhSinh& quadrature, G g2, F fc) {
    const auto visible = [&](const LobeCosines& c) { return g2(c.n_dot_l, n_dot_v) * c.v_dot_h / (c.n_dot_h * n_dot_v); };
    SplitSum s{};
    s.a = ggx_lobe_integral(n_dot_v, alpha, quadrature, [&](const LobeCosines& c) { return visible(c) * (1.0 - fc(c)); });
    s.b = ggx_lobe_integral(n_dot_v, alpha, quadrature, [&](const LobeCosines& c) { return visible(c) * fc(c); });
    return s;
}

// A and B of one Smith form. n_dot_v: (0, 1]; roughness: perceptual, (0, 1].
inline SplitSum split_sum(SmithForm form, double n_dot_v, double roughness, const TanhSinh& quadrature) {
    return split_sum(
        n_dot_v, roughness * roughness, quadrature, [&](double l, double v) { return smith_g2(form, l, v, roughness); },
        [](const LobeCosines& c) {
            const double x = 1.0 - c.v_dot_h, x2 = x * x;
            return x2 * x2 * x;
        });
}

// The cosine-weighted means over the view, 2 integral of A(m) m dm and the same of B.
inline SplitSum split_sum_average(SmithForm form, double roughness, const TanhSinh& quadrature) {
    SplitSum s{};
    // v below 1e-9 has a weight of 1e-18.
    s.a = quadrature(1e-9, 1.0, [&](double m) { return 2.0 * m * split_sum(form, m, roughness, quadrature).a; });
    s.b = quadrature(1e-9, 1.0, [&](double m) { return 2.0 * m * split_sum(form, m, roughness, quadrature).b; });
    return s;
}

}  // namespace kiln::reference
