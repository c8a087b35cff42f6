// One line a member and scene, and one a member for all scenes together ("all").
#include <cstdio>

#include "compiler/report/report.h"

namespace kiln::report {

namespace {

std::string exact(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", v);
    return text;
}

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

}  // namespace

std::string as_csv(const Report& report) {
    std::string out = "family,name,scene,member";
    for (const Metric m : all_metrics()) out += "," + std::string(name_of(m));
    out += ",ns_median,ns_p90,baseline_ns,front_relmse,front_maxrel\n";
    for (const FamilyReport& f : report.families) {
        const auto line = [&](const std::string& scene, size_t i, const Measured& m) {
            out += std::to_string(f.family.number) + "," + quoted(f.family.name) + "," + quoted(scene) + "," +
                   quoted(f.family.members[i].name);
            for (const Metric metric : all_metrics()) out += "," + exact(metric == Metric::bias ? m.all.bias : m.value(metric));
            out += "," + exact(m.timing.median) + "," + exact(m.timing.p90) + "," + exact(m.timing.baseline) + "," +
                   (m.front_relmse ? "1" : "0") + "," + (m.front_max_rel ? "1" : "0") + "\n";
        };
        for (size_t s = 0; s < f.scenes.size(); ++s)
            for (size_t i = 0; i < f.scenes[s].size(); ++i) line(f.family.scenes[s].name, i, f.scenes[s][i]);
        for (size_t i = 0; i < f.together.size(); ++i) line("all", i, f.together[i]);
    }
    return out;
}

}  // namespace kiln::report
