#include "tools/report_json.h"

#include "tools/json.h"

namespace kiln {

namespace {

using namespace report;

void measured(Json& json, const FamilyReport& f, const std::vector<Measured>& members) {
    json.key("members").array();
    for (size_t i = 0; i < members.size(); ++i) {
        const Measured& m = members[i];
        json.object().text("member", f.family.members[i].name);
        for (const Metric metric : all_metrics()) {
            if (f.family.region.empty() && (metric == Metric::region_rmse || metric == Metric::rest_rmse)) continue;
            json.number(name_of(metric), metric == Metric::bias ? m.all.bias : m.value(metric));
        }
        json.number("ns_median", m.timing.median).number("ns_p90", m.timing.p90).number("baseline_ns", m.timing.baseline);
        json.number("dispatch_ms", m.timing.dispatch_ms).number("repeats", uint64_t{m.timing.repeats});
        json.key("front").array();
        if (m.front_relmse) json.text("relmse");
        if (m.front_max_rel) json.text("maxrel");
        json.end().end();
    }
    json.end();
}

}  // namespace

std::string report_json(const Report& report, const std::vector<Budget>& budgets) {
    Json json;
    json.object()
        .text("device", report.device.name)
        .text("driver", report.device.driver)
        .text("settings", report.device.settings);
    json.key("quick").boolean(report.quick);
    json.key("families").array();
    for (const FamilyReport& f : report.families) {
        json.object().number("number", uint64_t{f.family.number}).text("name", f.family.name).text("title", f.family.title);
        json.text("primary", name_of(f.family.primary));
        json.key("scenes").array();
        for (size_t s = 0; s < f.scenes.size(); ++s) {
            const Scene& scene = f.family.scenes[s];
            json.object().text("scene", scene.name).text("what", scene.what).text("reference", scene.truth);
            json.number("width", uint64_t{scene.width}).number("height", uint64_t{scene.height});
            json.number("standard_error", f.standard_errors[s]);
            json.text("timed_scene", f.scenes[s].empty() ? "" : f.scenes[s].front().timing.scene);
            measured(json, f, f.scenes[s]);
            json.end();
        }
        json.end();
        json.key("together").object();
        measured(json, f, f.together);
        json.end();
        json.key("expectations").array();
        for (const Judged& j : f.judged) json.object().text("verdict", name_of(j.verdict)).text("words", j.words).end();
        json.end();
        json.key("remarks").array();
        for (const std::string& remark : f.remarks) json.text(remark);
        json.end().end();
    }
    json.end();
    json.key("budget").array();
    if (!budgets.empty())
        for (const FamilyReport& f : report.families) {
            const auto best = cheapest(f, budgets);
            json.object().text("family", f.family.name).text("cheapest", best ? f.family.members[*best].name : "").end();
        }
    json.end().end();
    return json.take();
}

}  // namespace kiln
