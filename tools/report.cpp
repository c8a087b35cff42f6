// kiln report: error against run time of the shader library's functions, as JSON, CSV and one HTML page.
#include "compiler/report/report.h"

#include <unistd.h>

#include <filesystem>

#include "compiler/report/device_bench.h"
#include "tools/console.h"
#include "tools/report_json.h"
#include "tools/session.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

using namespace report;

// uber/lib beside an installed binary (bin/kiln, share/kiln/uber), or in the source tree that holds the build folder.
Result<std::string> find_library(const Args& args) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (args.has("--library")) {
        const std::string given = args.value("--library");
        for (const std::string& folder : {given, join_path(given, "lib")})
            if (fs::is_regular_file(join_path(folder, "math.glsl"), ignored)) return folder;
        return input_error("no math.glsl in '" + given + "': --library names the folder uber or uber/lib");
    }
    char self[4096];
    const ssize_t length = ::readlink("/proc/self/exe", self, sizeof self);
    if (length <= 0) return environment_error("cannot find this program's own file");
    const fs::path binary(std::string(self, static_cast<size_t>(length)));
    for (fs::path folder = binary.parent_path(); folder != folder.root_path(); folder = folder.parent_path())
        for (const char* below : {"share/kiln/uber/lib", "uber/lib"})
            if (fs::is_regular_file(folder / below / "math.glsl", ignored)) return (folder / below).string();
    return environment_error("the GLSL library (uber/lib) is neither beside this program nor above it; name it with --library");
}

// Beside the library, as an installation or the source tree has it; empty when it could not run.
std::string find_bc_encoder(const std::string& library) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    for (const char* beside : {"../../bake", "../../compiler/bake"}) {
        const std::string folder = join_path(library, beside);
        if (fs::is_directory(join_path(folder, "node_modules/ktx2-encoder"), ignored)) return folder;
    }
    return {};
}

std::string summary(const Report& report) {
    std::string out;
    for (const FamilyReport& f : report.families) {
        out += std::to_string(f.family.number) + " " + f.family.name + ": " + f.family.title + "\n";
        size_t longest = 0;
        for (const report::Member& m : f.family.members) longest = std::max(longest, m.name.size());
        for (size_t i = 0; i < f.together.size(); ++i) {
            const Measured& m = f.together[i];
            const std::string& name = f.family.members[i].name;
            out += "  " + name + std::string(longest - name.size(), ' ') + "  " + digits(m.timing.min) + " ns/pixel, relMSE " +
                   digits(m.all.relmse) + ", maxRel " + digits(m.all.max_rel) +
                   (m.front_relmse || m.front_max_rel ? "  front" : "") +
                   (m.all.nonfinite != 0 ? "  " + std::to_string(m.all.nonfinite) + " values not finite" : "") + "\n";
        }
        for (size_t s = 0; s < f.standard_errors.size(); ++s)
            if (f.standard_errors[s] > 0.0)
                out += "  reference of " + f.family.scenes[s].name + ": standard error " + digits(f.standard_errors[s]) +
                       " of the mean\n";
        for (const Judged& j : f.judged) out += "  " + j.words + "\n";
        for (const std::string& remark : f.remarks) out += "  " + remark + "\n";
    }
    return out;
}

Result<Report> measure_all(const Args& args, DiskFiles& files, Toolchain& tools, ReportOptions options) {
    KILN_TRY(chosen_families(options));  // a misspelt family before the device is opened
    const auto folder = find_library(args);
    KILN_TRY(folder);
    options.bc_encoder = find_bc_encoder(*folder);
    Library library(files, *folder);
    DriverChoice choice;
    choice.icd = args.value("--icd");
    auto bench = open_device_bench(choice, tools, library);
    KILN_TRY(bench);
    return run_report(options, library, tools, **bench, console_progress());
}

int run_report_verb(const Args& args) {
    ReportOptions options;
    options.families = args.values("--family");
    options.quick = args.has("--quick");
    std::vector<Budget> budgets;
    for (const std::string& text : args.values("--budget")) {
        const auto budget = parse_budget(text);
        if (!budget.ok()) return print_error(budget.error());
        budgets.push_back(*budget);
    }
    DiskFiles files;
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    const auto report = measure_all(args, files, *tools, options);
    if (!report.ok()) return print_error(report.error());
    clear_progress();
    const std::string json = report_json(*report, budgets);
    if (args.has("--output")) {
        const std::string folder = args.value("--output");
        const std::pair<const char*, std::string> outputs[] = {
            {"report.json", json}, {"report.csv", as_csv(*report)}, {"report.html", as_html(*report, budgets)}};
        for (const auto& [name, text] : outputs) {
            const Status status = files.write(join_path(folder, name), as_bytes(text));
            if (!status.ok()) return print_error(status.error());
        }
    }
    if (args.has("--json")) return finish(json);
    return finish(summary(*report) + (budgets.empty() ? "" : budget_text(*report, budgets)));
}

}  // namespace

const Verb verb_report{
    "report",
    "[-o DIR] [--family N]… [--quick] [--budget METRIC=VALUE]… [--json]",
    "measure error against run time of the shader library's functions",
    0,
    0,
    {{"--output", "-o", "DIR", "write report.json, report.csv and report.html there"},
     {"--family", nullptr, "N", "number or name of a family; default all", true},
     {"--quick", nullptr, nullptr, "smaller pictures, times of one scene: two minutes in place of many"},
     {"--budget", nullptr, "METRIC=VALUE", "say which member of each family is cheapest within it: relmse=1e-3", true},
     {"--library", nullptr, "DIR", "the GLSL library; default: what was installed with this program"},
     {"--icd", nullptr, "FILE", "Vulkan driver manifest; default $KILN_ICD, else lavapipe"},
     option_json},
    "kiln report --quick --family fresnel -o out --budget maxabs=0.05",
    run_report_verb};

}  // namespace kiln
