// One page that needs nothing else: style, script and pictures are inside. Every family has a part for all scenes together and
// one a scene, of which one is shown; a point, a table row and a picture of one member in one part share a data-row.
#include "compiler/report/html_parts.h"
#include "compiler/report/plot.h"
#include "compiler/report/report.h"

namespace kiln::report {

namespace {

std::string base64(ByteView bytes) {
    constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t left = std::min<size_t>(3, bytes.size() - i);
        uint32_t v = uint32_t{bytes[i]} << 16;
        if (left > 1) v |= uint32_t{bytes[i + 1]} << 8;
        if (left > 2) v |= bytes[i + 2];
        out += letters[v >> 18];
        out += letters[v >> 12 & 63];
        out += left > 1 ? letters[v >> 6 & 63] : '=';
        out += left > 2 ? letters[v & 63] : '=';
    }
    return out;
}

std::string image(const Bytes& png, const std::string& what) {
    return "<img alt=\"" + escaped(what) + "\" src=\"data:image/png;base64," + base64(png) + "\">";
}

// Only the parts' own ids go into attributes: numbers.
std::string row_id(const FamilyReport& f, size_t part, size_t member) {
    return "f" + std::to_string(f.family.number) + "-" + std::to_string(part) + "-" + std::to_string(member);
}

std::string count(double v) {
    const std::string plain = std::to_string(static_cast<uint64_t>(v));
    std::string out;
    for (size_t i = 0; i < plain.size(); ++i) {
        if (i != 0 && (plain.size() - i) % 3 == 0) out += "\u202f";
        out += plain[i];
    }
    return out;
}

std::string plots(const FamilyReport& f, size_t part, const std::string& where, const std::vector<Measured>& members) {
    std::string out = "<div class=\"plots\">";
    for (const Metric metric : {Metric::relmse, Metric::max_rel}) {
        std::vector<Mark> marks;
        for (size_t i = 0; i < members.size(); ++i) {
            const Measured& m = members[i];
            Mark mark;
            mark.label = f.family.members[i].name;
            mark.id = row_id(f, part, i);
            mark.time = m.timing.min;
            mark.error = m.value(metric);
            mark.front = metric == Metric::relmse ? m.front_relmse : m.front_max_rel;
            mark.tooltip = mark.label + ": " + std::string(title_of(metric)) + " " + digits(mark.error) + ", " +
                           digits(mark.time) + " ns a pixel" + (mark.front ? ", on the front" : "");
            if (m.all.nonfinite != 0) mark.tooltip += ", " + count(static_cast<double>(m.all.nonfinite)) + " values not finite";
            marks.push_back(std::move(mark));
        }
        out += plot_svg(std::string(title_of(metric)) + ", " + where, std::string(title_of(metric)), marks);
    }
    return out + "</div>";
}

std::string table(const FamilyReport& f, size_t part, const std::vector<Measured>& members) {
    const bool region = !f.family.region.empty();
    std::string out =
        "<div class=\"wide\"><table><thead><tr><th>member</th><th title=\"on the front of relMSE, of maxRel\">front</th>"
        "<th>relMSE</th><th>RMSE</th>";
    if (region) out += "<th>RMSE inside</th><th>RMSE outside</th>";
    out +=
        "<th>maxRel</th><th>maxAbs</th><th>bias</th><th>HDR-FLIP</th><th>non-finite</th><th>ns min</th><th>median</th>"
        "<th>p90</th><th>JIT ms</th><th>SPIR-V bytes</th><th>operations</th><th>data bytes</th></tr></thead><tbody>";
    for (size_t i = 0; i < members.size(); ++i) {
        const Measured& m = members[i];
        out += "<tr data-row=\"" + row_id(f, part, i) + "\" tabindex=\"0\"><th title=\"" + escaped(f.family.members[i].what) +
               "\">" + escaped(f.family.members[i].name) + "</th><td>" + (m.front_relmse ? "R" : "") +
               (m.front_max_rel ? "M" : "") + "</td>";
        const auto cell = [&](const std::string& text) { out += "<td>" + text + "</td>"; };
        cell(digits(m.all.relmse));
        cell(digits(m.all.rmse));
        if (region) {
            cell(digits(m.region.rmse));
            cell(digits(m.rest.rmse));
        }
        cell(digits(m.all.max_rel));
        cell(digits(m.all.max_abs));
        cell(digits(m.all.bias));
        cell(digits(m.all.flip));
        cell(count(static_cast<double>(m.all.nonfinite)));
        cell(digits(m.timing.min));
        cell(digits(m.timing.median));
        cell(digits(m.timing.p90));
        cell(digits(m.timing.jit_ms));
        cell(count(static_cast<double>(m.spirv)));
        cell(count(static_cast<double>(m.operations)));
        cell(count(static_cast<double>(m.bytes)));
        out += "</tr>";
    }
    return out + "</tbody></table></div>";
}

std::string pictures(const FamilyReport& f, size_t scene) {
    std::string out = "<div class=\"pictures\"><figure class=\"truth\">" + image(f.references[scene], "reference") +
                      "<figcaption>reference</figcaption></figure>";
    for (size_t i = 0; i < f.scenes[scene].size(); ++i) {
        const std::string& name = f.family.members[i].name;
        out += "<figure data-row=\"" + row_id(f, scene + 1, i) + "\" tabindex=\"0\"><div>" +
               image(f.scenes[scene][i].picture, name) + image(f.scenes[scene][i].error_map, "error of " + name) +
               "</div><figcaption>" + escaped(name) + "</figcaption></figure>";
    }
    return out + "</div>";
}

std::string section(const FamilyReport& f) {
    const Family& family = f.family;
    const std::string id = "f" + std::to_string(family.number);
    std::string out = "<section id=\"" + id + "\"><h2><span class=\"number\">" + std::to_string(family.number) + "</span> " +
                      escaped(family.title) + "</h2><p>" + escaped(family.what) + "</p>";
    out += "<div class=\"choose\" role=\"tablist\"><button role=\"tab\" aria-selected=\"true\" data-part=\"" + id +
           "-0\">all scenes</button>";
    for (size_t s = 0; s < family.scenes.size(); ++s)
        out += "<button role=\"tab\" aria-selected=\"false\" data-part=\"" + id + "-" + std::to_string(s + 1) + "\">" +
               escaped(family.scenes[s].name) + "</button>";
    out += "</div>";
    out +=
        "<div class=\"part\" id=\"" + id + "-0\">" + plots(f, 0, "all scenes", f.together) + table(f, 0, f.together) + "</div>";
    for (size_t s = 0; s < family.scenes.size(); ++s) {
        const Scene& scene = family.scenes[s];
        out += "<div class=\"part\" id=\"" + id + "-" + std::to_string(s + 1) + "\" hidden><p>" + escaped(scene.what) +
               " Reference: " + escaped(scene.truth) +
               (f.standard_errors[s] > 0.0 ? ", standard error " + digits(f.standard_errors[s]) + " of the mean" : "") + ". " +
               std::to_string(scene.width) + " x " + std::to_string(scene.height) + " points." +
               (family.region.empty() ? "" : " Inside: " + escaped(family.region) + ".") + "</p>";
        out += plots(f, s + 1, scene.name, f.scenes[s]) + table(f, s + 1, f.scenes[s]);
        if (f.scenes[s].front().timing.scene != scene.name)
            out += "<p class=\"note\">Times are those of " + escaped(f.scenes[s].front().timing.scene) + ".</p>";
        out += pictures(f, s) + "</div>";
    }
    out += "<details open><summary>Expected and found</summary><ul class=\"verdicts\">";
    for (const Judged& j : f.judged) out += "<li class=\"" + std::string(name_of(j.verdict)) + "\">" + escaped(j.words) + "</li>";
    out += "</ul>";
    if (!f.remarks.empty()) {
        out += "<ul>";
        for (const std::string& r : f.remarks) out += "<li>" + escaped(r) + "</li>";
        out += "</ul>";
    }
    return out + "</details></section>";
}

// What did not come as expected, of all families.
std::string contradicted(const Report& report) {
    std::string out;
    for (const FamilyReport& f : report.families)
        for (const Judged& j : f.judged)
            if (j.verdict != Verdict::confirmed)
                out += "<li class=\"" + std::string(name_of(j.verdict)) + "\"><a href=\"#f" + std::to_string(f.family.number) +
                       "\">" + std::to_string(f.family.number) + "</a> " + escaped(j.words) + "</li>";
    return out.empty() ? out
                       : "<details class=\"contradicted\"><summary>Not as expected</summary><ul class=\"verdicts\">" + out +
                             "</ul></details>";
}

}  // namespace

std::string as_html(const Report& report, const std::vector<Budget>& budgets) {
    std::string out =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\"><meta name=\"color-scheme\" content=\"light dark\">"
        "<title>Error against run time</title><style>";
    out += page_style;
    out += "</style></head><body><header><h1>Error against run time</h1><p>" + escaped(report.device.name) + ", " +
           escaped(report.device.driver) + (report.quick ? ", quick" : "") + "</p>";
    size_t confirmed = 0, falsified = 0, undecided = 0;
    for (const FamilyReport& f : report.families)
        for (const Judged& j : f.judged)
            ++(j.verdict == Verdict::confirmed ? confirmed : j.verdict == Verdict::falsified ? falsified : undecided);
    out += "<p>" + std::to_string(confirmed) + " expectations confirmed, " + std::to_string(falsified) + " falsified, " +
           std::to_string(undecided) + " undecided.</p><nav>";
    for (const FamilyReport& f : report.families)
        out += "<a href=\"#f" + std::to_string(f.family.number) + "\">" + std::to_string(f.family.number) + " " +
               escaped(f.family.name) + "</a>";
    out += "</nav></header><main>";
    out += contradicted(report);
    if (!budgets.empty()) out += "<pre class=\"budget\">" + escaped(budget_text(report, budgets)) + "</pre>";
    for (const FamilyReport& f : report.families) out += section(f);
    out += page_foot;
    out += "</main><script>";
    out += page_script;
    return out + "</script></body></html>\n";
}

}  // namespace kiln::report
