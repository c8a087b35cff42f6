// kiln validate: every pipeline of a table on a device, one worker process a core (the hidden verb validate-worker).
#include "compiler/validate/validate.h"

#include <unistd.h>

#include "compiler/device/vulkan_device.h"
#include "compiler/table/proof.h"
#include "tools/console.h"
#include "tools/json.h"
#include "tools/session.h"
#include "tools/table_file.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

std::string finding_text(const Finding& finding) {
    std::string out = finding.shader + " " + finding.variant + ": " + finding.why + "\n";
    if (!finding.where.empty()) out += "  " + finding.where + "\n";
    return out;
}

std::string as_text(const ValidateReport& report) {
    const auto n = [](uint64_t v) { return Count(v).grouped(); };
    std::string out = report.device.name + " (" + report.device.driver + ")\n";
    out += "  " + report.variants.grouped() + " variants in " + n(report.pipelines) + " of " + n(report.pipelines_there) +
           " pipelines, " + n(report.modules) + " of " + n(report.modules_there) + " modules\n";
    out += "  run " + n(report.run) + ", cached " + n(report.cached) + ", equal to another " + n(report.shared) + ": passed " +
           n(report.passed) + ", failed " + n(report.failed.size()) + ", unsupported " + n(report.unsupported.size()) +
           ", not compared " + n(report.not_compared) + "\n";
    out += "  " + n(report.values) + " values compared, " + n(report.nonfinite) + " pipelines with values that are not finite, " +
           n(report.undrawn.size()) + " that drew no pixel\n";
    for (const Finding& f : report.failed) out += "failed: " + finding_text(f);
    for (const Finding& f : report.unsupported) out += "unsupported by this device: " + finding_text(f);
    for (const Finding& f : report.undrawn) out += "drew no pixel: " + finding_text(f);
    return out;
}

void list(Json& json, const char* name, const std::vector<Finding>& findings) {
    json.key(name).array();
    for (const Finding& f : findings)
        json.object().text("variant", f.shader + " " + f.variant).text("why", f.why).text("where", f.where).end();
    json.end();
}

std::string as_json(const ValidateReport& report) {
    Json json;
    json.object().text("device", report.device.name).text("driver", report.device.driver).text("layers", report.device.layers);
    if (report.variants.fits_u64())
        json.number("variants", report.variants.u64());
    else
        json.number("variants", report.variants.approximate());
    json.number("pipelines", report.pipelines).number("pipelines_there", report.pipelines_there);
    json.number("modules", report.modules).number("modules_there", report.modules_there);
    json.number("run", report.run)
        .number("cached", report.cached)
        .number("shared", report.shared)
        .number("passed", report.passed);
    list(json, "failed", report.failed);
    json.number("not_compared", report.not_compared).number("nonfinite", report.nonfinite).number("values", report.values);
    list(json, "unsupported", report.unsupported);
    list(json, "undrawn", report.undrawn);
    json.number("device_ms", report.device_ms).end();
    return json.take();
}

Result<ValidateReport> run(const Args& args, Session& session) {
    const std::string path = args.words().front();
    // Opened before any worker starts: a damaged table is the user's business, a missing driver the machine's.
    const auto table = open_table(session.files, path);
    KILN_TRY(table);
    const std::string proof_path = args.value("--proof", path + ".proof");
    const auto proof = session.files.read(proof_path);
    if (!proof.ok()) return input_error(proof.error().message);
    if (!proof->has_value() && args.has("--proof")) return input_error(proof_path + ": no such file");
    if (!proof->has_value())
        print_note("warning: no proof at " + proof_path + ": nothing can be compared with what the build recorded");
    if (proof->has_value()) {
        const auto checked = read_proof(as_bytes(**proof), (*table)->bytes());
        if (!checked.ok())
            return input_error(proof_path + ": " + checked.error().message +
                               "; build the table again, both are written together");
    }

    ValidateOptions options;
    options.shader = args.value("--shader");
    const auto sample = args.number("--sample", 0, 1, 1'000'000'000);
    KILN_TRY(sample);
    const auto seed = args.number("--seed", 1, 0, 1'000'000'000);
    KILN_TRY(seed);
    const auto timeout = args.number("--timeout", 60, 1, 86'400);
    KILN_TRY(timeout);
    const auto jobs = args.number("--jobs", 0, 1, 1024);
    KILN_TRY(jobs);
    options.sample = *sample;
    options.seed = *seed;

    char self[4096];
    const ssize_t length = ::readlink("/proc/self/exe", self, sizeof self);
    if (length <= 0) return environment_error("cannot find this program's own file");
    WorkerOptions workers;
    workers.command = {std::string(self, static_cast<size_t>(length)), "validate-worker"};
    if (args.has("--icd")) workers.command.insert(workers.command.end(), {"--icd", args.value("--icd")});
    workers.count = static_cast<unsigned>(*jobs);
    workers.timeout_seconds = static_cast<double>(*timeout);
    const ByteView proof_bytes = proof->has_value() ? as_bytes(**proof) : ByteView();
    auto pool = WorkerPool::start(workers);
    KILN_TRY(pool);
    return validate((*table)->bytes(), proof_bytes, options, **pool, session.context->store, *session.tools, console_progress());
}

int run_validate(const Args& args) {
    auto session = Session::open(args);
    if (!session.ok()) return print_error(session.error());
    const auto report = run(args, **session);
    if (!report.ok()) return print_error(report.error());
    clear_progress();
    if (args.has("--report")) {
        const std::string folder = args.value("--report");
        Status status = (*session)->files.write(join_path(folder, "validate.json"), as_bytes(as_json(*report)));
        if (status.ok()) status = (*session)->files.write(join_path(folder, "validate.txt"), as_bytes(as_text(*report)));
        if (!status.ok()) return print_error(status.error());
    }
    const int code = report->ok() ? 0 : static_cast<int>(Fault::mismatch);
    return finish(args.has("--json") ? as_json(*report) : as_text(*report), code);
}

int run_worker_verb(const Args& args) {
    return run_worker([&] {
        DriverChoice choice;
        choice.icd = args.value("--icd");
        return open_vulkan_device(choice);
    });
}

const Option option_icd{"--icd", nullptr, "FILE", "Vulkan driver manifest; default $KILN_ICD, else lavapipe"};

}  // namespace

const Verb verb_validate{"validate",
                         "T.kiln [--shader S] [--sample N] [--json] [--report DIR]",
                         "run every pipeline of a table on a Vulkan device, and compare with its unoptimised form",
                         1,
                         1,
                         {option_shader,
                          {"--sample", nullptr, "N", "every module at least once, then others up to N pipelines in all"},
                          {"--seed", nullptr, "N", "of inputs and of the sample; default 1"},
                          {"--report", nullptr, "DIR", "write validate.txt and validate.json there"},
                          {"--proof", nullptr, "FILE", "default: the table's name with .proof added"},
                          {"--timeout", nullptr, "SECONDS", "for one pipeline; default 60"},
                          option_icd,
                          option_cache,
                          option_jobs,
                          option_json},
                         "kiln validate surface.kiln --report out",
                         run_validate};

const Verb verb_validate_worker{"validate-worker", "",  "one worker of kiln validate", 0, 0, {option_icd}, nullptr,
                                run_worker_verb,   true};

}  // namespace kiln
