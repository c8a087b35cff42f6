#pragma once
// Tanh-sinh quadrature (Takahasi and Mori 1974): converges exponentially for a smooth integrand on a finite interval, also
// when it has an integrable singularity (a root, a logarithm) at an end. Break the interval where the integrand has a kink.

#include <cmath>
#include <vector>

#include "uber/reference/numbers.h"

namespace kiln::reference {

class TanhSinh {
public:
    // 2 half + 1 nodes; the step is 3.2 / half, the weights beyond it are below 1e-16. 110 reaches the last digits of a
    // double for what the tests here integrate; compare with another number of nodes to know.
    explicit TanhSinh(int half) {
        const double step = 3.2 / half;
        for (int i = -half; i <= half; ++i) {
            const double t = i * step;
            const double u = 0.5 * pi * std::sinh(t);
            const double c = std::cosh(u);
            // Distance from the nearer end as a part of the interval: 1 - |tanh u| would cancel.
            const double from_end = 1.0 / (1.0 + std::exp(2.0 * std::fabs(u)));
            nodes_.push_back({from_end, 0.25 * pi * std::cosh(t) / (c * c) * step, i < 0});
        }
    }

    // The integral of f over [a, b].
    template <class F>
    double operator()(double a, double b, F f) const {
        double sum = 0;
        for (const Node& n : nodes_) {
            const double d = n.from_end * (b - a);
            sum += n.weight * f(n.low ? a + d : b - d);
        }
        return sum * (b - a);
    }

private:
    struct Node {
        double from_end, weight;
        bool low;
    };
    std::vector<Node> nodes_;
};

}  // namespace kiln::reference
