#include "tests/functions/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kiln::test {

namespace {

using reference::Bounded;

constexpr size_t most_described = 3;

std::string text(double x) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.9g", x);
    return buffer;
}

double ulps(double error, double scale) {
    if (error == 0) return 0;
    const double size = std::max(std::fabs(scale), 0x1p-126);
    return error / std::exp2(std::floor(std::log2(size)) - 23);
}

// References in double are themselves off by a few units of 2^-53.
double slack(double scale) { return 1e-13 * scale; }

}  // namespace

bool Verdict::conditioned(const Expected& e, double scale) {
    return scale >= 0x1p-126 && static_cast<double>(e.bound) < 0.01 * scale;
}

Verdict::Verdict(const FunctionTest& function, const std::vector<uint32_t>& samples)
    : function_(function), samples_(samples), components_(static_cast<uint32_t>(function.result.picks.size())) {
    const size_t n = samples.size() / function.words;
    figures_.name = function.name;
    figures_.samples = n;
    expected_.resize(n * components_);
    scale_.resize(n);
    close_.resize(n);
    undecided_.resize(n);
    std::vector<double> exact(components_), reference(components_), truth(components_), typical;
    std::vector<float> single(components_);
    std::vector<Bounded> bounded(components_);
    uint64_t far_from_truth = 0;
    for (size_t i = 0; i < n; ++i) {
        const uint32_t* words = samples.data() + i * function.words;
        function.reference(words, reference.data());
        if (function.exact)
            function.exact(words, exact.data());
        else
            exact = reference;
        function.single(words, single.data());
        reference::decision_was_close = false;
        function.bounded(words, bounded.data());
        close_[i] = reference::decision_was_close;
        bool unbounded = false;
        for (uint32_t c = 0; c < components_; ++c) {
            Expected& e = expected_[i * components_ + c];
            // To float, upwards.
            const double bound = reference::reassociation_margin * bounded[c].error;
            e = {exact[c], single[c],
                 bound == 0 ? 0.0f : std::nextafter(static_cast<float>(bound), std::numeric_limits<float>::infinity())};
            unbounded |= std::isinf(e.bound);
            scale_[i] = std::max(scale_[i], std::fabs(exact[c]));
            if (!std::isfinite(exact[c]) && reference_breaches_.size() < most_described)
                reference_breaches_.push_back("the reference is not finite for " + describe(i));
        }
        figures_.unbounded += unbounded ? 1 : 0;
        for (uint32_t c = 0; c < components_; ++c) {
            const Expected& e = expected_[i * components_ + c];
            if (!close_[i] && conditioned(e, scale_[i]))
                figures_.rounding_ulps =
                    std::max(figures_.rounding_ulps, ulps(std::fabs(static_cast<double>(e.single) - e.exact), scale_[i]));
            if (!unbounded) typical.push_back(ulps(static_cast<double>(e.bound), scale_[i]));
        }
        if (function.truth) {
            function.truth(words, truth.data());
            for (uint32_t c = 0; c < components_; ++c) {
                const double off = std::fabs(exact[c] - truth[c]);
                figures_.model_relative = std::max(figures_.model_relative, off / std::max(std::fabs(truth[c]), scale_[i]));
                if (!(off <= function.truth_relative * std::fabs(truth[c]) + function.truth_absolute) &&
                    ++far_from_truth <= most_described)
                    reference_breaches_.push_back("the model gives " + text(exact[c]) + ", the truth is " + text(truth[c]) +
                                                  " for " + describe(i));
            }
        }
    }
    if (!typical.empty()) {
        std::nth_element(typical.begin(), typical.begin() + static_cast<std::ptrdiff_t>(typical.size() / 2), typical.end());
        figures_.typical_bound_ulps = typical[typical.size() / 2];
    }
}

std::string Verdict::describe(size_t sample) const {
    std::string out;
    const uint32_t* words = samples_.data() + sample * function_.words;
    for (const FunctionTest::Slot& a : function_.arguments) {
        out += (out.empty() ? "" : ", ") + a.name + " = ";
        const bool whole = a.glsl == "int" || a.glsl == "uint";
        for (uint32_t w = 0; w < a.words; ++w)
            out += (w == 0 ? "" : " ") + (a.glsl == "int" ? std::to_string(static_cast<int>(words[a.first + w]))
                                          : whole         ? std::to_string(words[a.first + w])
                                                          : text(from_word<double>(words[a.first + w])));
    }
    return out;
}

void Verdict::judge(const std::vector<uint32_t>& results, const std::string& how, std::vector<std::string>& breaches) {
    if (results.size() < expected_.size()) {
        breaches.push_back(function_.name + ", " + how + ": the device returned too little");
        return;
    }
    size_t described = 0;
    for (size_t i = 0; i < scale_.size(); ++i) {
        std::string wrong;
        for (uint32_t c = 0; c < components_; ++c) {
            const Expected& e = expected_[i * components_ + c];
            const double got = from_word<double>(results[i * components_ + c]), off = std::fabs(got - e.exact);
            const double bound = static_cast<double>(e.bound) + slack(scale_[i]);
            if (std::isfinite(got) && off > bound && close_[i]) {
                undecided_[i] = true;
                continue;
            }
            if (!std::isfinite(got) || !(off <= bound)) {
                if (wrong.empty())
                    wrong = "device" + function_.result.picks[c] + " " + text(got) + ", reference " + text(e.exact) + ", bound " +
                            text(bound) + " for " + describe(i);
                continue;
            }
            figures_.absolute = std::max(figures_.absolute, off);
            if (!close_[i] && bound > 0 && off / bound > figures_.share) {
                figures_.share = off / bound;
                figures_.worst = "device" + function_.result.picks[c] + " " + text(got) + ", reference " + text(e.exact) +
                                 ", bound " + text(bound) + " for " + describe(i);
            }
            if (close_[i] || !conditioned(e, scale_[i])) continue;
            figures_.relative = std::max(figures_.relative, off / scale_[i]);
            figures_.ulps = std::max(figures_.ulps, ulps(off, scale_[i]));
            figures_.implementation_ulps =
                std::max(figures_.implementation_ulps, ulps(std::fabs(got - static_cast<double>(e.single)), scale_[i]));
        }
        if (wrong.empty()) continue;
        ++figures_.mismatches;
        if (++described <= most_described) breaches.push_back(function_.name + ", " + how + ": " + wrong);
    }
    if (described > most_described)
        breaches.push_back(function_.name + ", " + how + ": " + std::to_string(described) + " of " +
                           std::to_string(figures_.samples) + " samples are wrong");
}

Figures Verdict::finish(std::vector<std::string>& breaches) {
    figures_.undecided = static_cast<uint64_t>(std::count(undecided_.begin(), undecided_.end(), true));
    for (const std::string& b : reference_breaches_) breaches.push_back(function_.name + ": " + b);
    const auto limit = [&](uint64_t count, double share, const char* what) {
        if (static_cast<double>(count) > share * static_cast<double>(figures_.samples))
            breaches.push_back(function_.name + ": " + std::to_string(count) + " of " + std::to_string(figures_.samples) +
                               " samples are " + what + ", more than " + text(100 * share) + " %");
    };
    limit(figures_.undecided, function_.undecided_share, "undecided");
    limit(figures_.unbounded, function_.unbounded_share, "unbounded");
    return figures_;
}

}  // namespace kiln::test
