#pragma once
// What was expected before measuring, and in words whether it came true.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kiln::report {

enum class Metric {
    relmse,
    rmse,
    max_rel,
    max_abs,
    bias,
    flip,
    nonfinite,
    region_rmse,
    rest_rmse,
    time,
    jit,
    bytes,
    spirv,
    operations
};

std::string_view name_of(Metric metric);  // as in report.json: "relmse", "maxrel", "ns" …
std::string_view title_of(Metric metric);
std::optional<Metric> metric_named(std::string_view name);
const std::vector<Metric>& all_metrics();

enum class Relation {
    below,    // a * factor < b
    near,     // a and b within a factor of each other
    at_most,  // a <= factor
    at_least  // a >= factor
};

struct Expectation {
    Metric metric = Metric::relmse;
    Relation relation = Relation::below;
    std::string a = {}, b = {};  // members; b is empty for at_most and at_least
    double factor = 1.0;
    std::string scene = {};  // empty: all scenes together
    std::string because = {};
};

// a < b < c …: one expectation a pair.
std::vector<Expectation> ascending(Metric metric, const std::vector<std::string>& members, const std::string& scene = {});

enum class Verdict { confirmed, falsified, undecided };
std::string_view name_of(Verdict verdict);

struct Judged {
    Expectation expectation;
    Verdict verdict = Verdict::undecided;
    std::string words;  // "relMSE of l1 below ambient: confirmed, 1.2e-3 against 4.4e-2"
};

// Two times closer than this cannot be told apart on a shared machine.
inline constexpr double time_noise = 0.05;
// Nor can two times that differ by less than this many ns a pixel.
inline constexpr double time_floor = 0.02;

// A measured value, and how far it may be off: the reference may be, and what a member draws at random is.
struct Known {
    double value = 0, noise = 0;
};

// `measured` gives a member's value, nothing when it was not measured. What its noise could turn round is undecided.
Judged judge(
    const Expectation& expectation,
    const std::function<std::optional<Known>(const std::string& member, const std::string& scene, Metric metric)>& measured);

// Three digits: "0.0123", "1.2e-07", "inf".
std::string digits(double value);

}  // namespace kiln::report
