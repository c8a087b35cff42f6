// The cheapest member that is good enough.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "compiler/report/report.h"

namespace kiln::report {

Result<Budget> parse_budget(const std::string& text) {
    const size_t equals = text.find('=');
    const auto metric = metric_named(text.substr(0, equals));
    if (equals == std::string::npos || !metric) {
        std::string known;
        for (const Metric m : all_metrics()) known += (known.empty() ? "" : ", ") + std::string(name_of(m));
        return Error{Fault::usage, "--budget '" + text + "': give METRIC=VALUE; metrics are " + known};
    }
    const std::string number = text.substr(equals + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || end != number.c_str() + number.size() || !std::isfinite(value) || value < 0.0)
        return Error{Fault::usage, "--budget '" + text + "': '" + number + "' is no number from 0 on"};
    return Budget{*metric, value};
}

std::optional<size_t> cheapest(const FamilyReport& family, const std::vector<Budget>& budgets) {
    std::optional<size_t> best;
    for (size_t i = 0; i < family.together.size(); ++i) {
        const Measured& m = family.together[i];
        if (m.all.nonfinite != 0) continue;
        if (!std::all_of(budgets.begin(), budgets.end(), [&](const Budget& b) { return m.value(b.metric) <= b.limit; })) continue;
        if (!best || m.timing.min < family.together[*best].timing.min) best = i;
    }
    return best;
}

std::string budget_text(const Report& report, const std::vector<Budget>& budgets) {
    std::string out = "cheapest within";
    for (const Budget& b : budgets) out += " " + std::string(name_of(b.metric)) + " <= " + digits(b.limit);
    out += ":\n";
    for (const FamilyReport& f : report.families) {
        const auto best = cheapest(f, budgets);
        out += "  " + std::to_string(f.family.number) + " " + f.family.name + ": ";
        if (!best) {
            out += "none\n";
            continue;
        }
        const Measured& m = f.together[*best];
        out += f.family.members[*best].name + ", " + digits(m.timing.min) + " ns/pixel, relMSE " + digits(m.all.relmse) +
               ", maxRel " + digits(m.all.max_rel) + "\n";
    }
    return out;
}

}  // namespace kiln::report
