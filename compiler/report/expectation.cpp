#include "compiler/report/expectation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kiln::report {

namespace {

struct Row {
    Metric metric;
    std::string_view name, title;
};
constexpr Row rows[] = {{Metric::relmse, "relmse", "relMSE"},
                        {Metric::rmse, "rmse", "RMSE"},
                        {Metric::max_rel, "maxrel", "maxRel"},
                        {Metric::max_abs, "maxabs", "maxAbs"},
                        {Metric::bias, "bias", "bias"},
                        {Metric::flip, "flip", "HDR-FLIP"},
                        {Metric::nonfinite, "nonfinite", "non-finite"},
                        {Metric::region_rmse, "region_rmse", "RMSE inside"},
                        {Metric::rest_rmse, "rest_rmse", "RMSE outside"},
                        {Metric::time, "ns", "ns/pixel"},
                        {Metric::jit, "jit_ms", "JIT ms"},
                        {Metric::bytes, "bytes", "bytes"},
                        {Metric::spirv, "spirv_bytes", "SPIR-V bytes"},
                        {Metric::operations, "operations", "operations"}};

std::string quantity(const Expectation& e, const std::string& member) {
    return std::string(title_of(e.metric)) + " of " + member;
}

}  // namespace

std::string_view name_of(Metric metric) {
    for (const Row& r : rows)
        if (r.metric == metric) return r.name;
    return {};
}

std::string_view title_of(Metric metric) {
    for (const Row& r : rows)
        if (r.metric == metric) return r.title;
    return {};
}

std::optional<Metric> metric_named(std::string_view name) {
    for (const Row& r : rows)
        if (r.name == name) return r.metric;
    return std::nullopt;
}

const std::vector<Metric>& all_metrics() {
    static const std::vector<Metric> all = [] {
        std::vector<Metric> out;
        for (const Row& r : rows) out.push_back(r.metric);
        return out;
    }();
    return all;
}

std::string_view name_of(Verdict verdict) {
    return verdict == Verdict::confirmed ? "confirmed" : verdict == Verdict::falsified ? "falsified" : "undecided";
}

std::vector<Expectation> ascending(Metric metric, const std::vector<std::string>& members, const std::string& scene) {
    std::vector<Expectation> out;
    for (size_t i = 0; i + 1 < members.size(); ++i) {
        Expectation e;
        e.metric = metric;
        e.a = members[i];
        e.b = members[i + 1];
        e.scene = scene;
        out.push_back(e);
    }
    return out;
}

std::string digits(double value) {
    if (std::isnan(value)) return "nan";
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    char text[32];
    const double size = std::fabs(value);
    if (size != 0.0 && (size < 1e-3 || size >= 1e6))
        std::snprintf(text, sizeof text, "%.2e", value);
    else
        std::snprintf(text, sizeof text, size >= 1000.0 ? "%.0f" : "%.3g", value);
    return text;
}

namespace {

bool holds(const Expectation& e, double a, double b) {
    switch (e.relation) {
        case Relation::below:
            return a * e.factor < b;
        case Relation::near:
            return a == b || std::max(a, b) <= e.factor * std::min(a, b);
        case Relation::at_most:
            return a <= b;
        case Relation::at_least:
            return a >= b;
    }
    return false;
}

// Whether any two values within the noises give another answer: the ends do, if any.
bool steady(const Expectation& e, const Known& a, const Known& b) {
    const bool here = holds(e, a.value, b.value);
    for (const double i : {-1.0, 0.0, 1.0})
        for (const double k : {-1.0, 0.0, 1.0})
            if (holds(e, std::max(0.0, a.value + i * a.noise), std::max(0.0, b.value + k * b.noise)) != here) return false;
    return true;
}

}  // namespace

Judged judge(const Expectation& e,
             const std::function<std::optional<Known>(const std::string&, const std::string&, Metric)>& measured) {
    Judged out;
    out.expectation = e;
    const bool one = e.relation == Relation::at_most || e.relation == Relation::at_least;
    const std::optional<Known> a = measured(e.a, e.scene, e.metric);
    const std::optional<Known> b = one ? std::optional<Known>(Known{e.factor, 0.0}) : measured(e.b, e.scene, e.metric);
    std::string what = quantity(e, e.a);
    const std::string times = e.factor == 1.0 ? "" : digits(e.factor) + " times ";
    if (e.relation == Relation::below)
        what += e.factor == 1.0 ? " below " + e.b : " at least " + times + "below " + e.b;
    else if (e.relation == Relation::near)
        what += e.factor == 1.0 ? " equal to " + e.b : " within a factor " + digits(e.factor) + " of " + e.b;
    else
        what += (e.relation == Relation::at_most ? " at most " : " at least ") + digits(e.factor);
    if (!e.scene.empty()) what += " in " + e.scene;
    if (!e.because.empty()) what += " (" + e.because + ")";
    if (!a || !b) {
        out.words = what + ": undecided, not measured";
        return out;
    }
    const bool timed = e.metric == Metric::time;
    const std::string unit = timed ? " ns" : e.metric == Metric::jit ? " ms" : "";
    std::string numbers = digits(a->value) + unit + (one ? "" : " against " + digits(b->value) + unit);
    const double time_apart = timed ? std::max(time_floor, time_noise * std::max(std::fabs(a->value), std::fabs(b->value))) : 0.0;
    out.verdict =
        holds(e, a->value, b->value) || (timed && e.relation == Relation::near && std::fabs(a->value - b->value) <= time_apart)
            ? Verdict::confirmed
            : Verdict::falsified;
    if (timed && e.relation == Relation::below && std::fabs(a->value * e.factor - b->value) <= time_apart) {
        out.verdict = Verdict::undecided;
        numbers += ", closer than the noise of the measurement";
    } else if (!steady(e, *a, *b)) {
        out.verdict = Verdict::undecided;
        numbers += ", closer than the noise of " + digits(std::max(a->noise, b->noise));
    }
    out.words = what + ": " + std::string(name_of(out.verdict)) + ", " + numbers;
    return out;
}

}  // namespace kiln::report
