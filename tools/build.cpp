// kiln build: the whole pass, and its files published together at the end.
#include <sys/resource.h>

#include <cstdio>
#include <filesystem>

#include "tools/console.h"
#include "tools/json.h"
#include "tools/session.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

double peak_mebibytes() {
    struct rusage usage {};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

std::string as_json(const Build& build, const RemoteCache* remote, const Execution* execution) {
    Json json;
    json.object().key("counts").object();
    json.text("declared", build.counts.declared.decimal()).text("legal", build.counts.legal.decimal());
    json.text("needed", build.counts.needed.decimal()).text("classes", std::to_string(build.counts.classes));
    json.text("raw", std::to_string(build.counts.raw)).text("pruned", std::to_string(build.counts.pruned));
    json.text("modules", std::to_string(build.counts.modules)).text("pipelines", std::to_string(build.counts.pipelines));
    json.key("artifacts").object();
    for (const auto& [target, n] : build.counts.artifacts) json.text(name_of(target), std::to_string(n));
    json.end().end().key("work").object();
    json.number("preprocessed", build.work.preprocessed).number("compiled", build.work.compiled);
    json.number("optimised", build.work.optimised).number("translated", build.work.translated);
    json.number("cache_hits", build.work.cache_hits).end().key("bytes").object();
    json.number("table", uint64_t{build.files.table.size()}).number("proof", uint64_t{build.files.proof.size()});
    json.number("peak_memory", static_cast<uint64_t>(peak_mebibytes() * 1048576.0)).end().key("ms").object();
    for (const auto& [step, ms] : build.ms) json.number(step, ms);
    json.end();
    if (remote != nullptr) remote_json(json, *remote);
    if (execution != nullptr) execution_json(json, *execution);
    json.end();
    return json.take();
}

std::string as_text(const Build& build, const std::string& output) {
    const auto n = [](uint64_t v) { return Count(v).grouped(); };
    std::string out = output + ": " + build.counts.needed.grouped() + " variants (" + build.counts.declared.grouped() +
                      " declared, " + build.counts.legal.grouped() + " legal)\n";
    out += "  " + n(build.counts.classes) + " classes -> " + n(build.counts.raw) + " raw -> " + n(build.counts.pruned) +
           " pruned -> " + n(build.counts.modules) + " modules, " + n(build.counts.pipelines) + " pipelines\n ";
    for (const auto& [target, count] : build.counts.artifacts) out += std::string(" ") + name_of(target) + " " + n(count);
    out += "\n  compiled " + n(build.work.compiled) + ", optimised " + n(build.work.optimised) + ", translated " +
           n(build.work.translated) + ", cache hits " + n(build.work.cache_hits) + "\n";
    out += "  " + n(build.files.table.size()) + " bytes, proof " + n(build.files.proof.size()) + " bytes\n";
    return out;
}

// Spaces and the few other characters that mean something to make and Ninja are escaped.
std::string escaped(const std::string& path) {
    std::string out;
    for (const char c : path) {
        if (c == ' ' || c == '#' || c == '\\') out += '\\';
        if (c == '$') out += '$';
        out += c;
    }
    return out;
}

std::string depfile(const std::string& output, const std::vector<std::string>& depends) {
    std::string out = escaped(output) + ":";
    for (const std::string& path : depends) out += " \\\n  " + escaped(path);
    return out + "\n";
}

struct Output {
    std::string option, path;
};

std::vector<Output> outputs_of(const Args& args) {
    const std::string table = args.value("--output");
    std::vector<Output> out{{"--output", table}, {"the proof", table + ".proof"}};
    for (const char* option : {"--header", "--report-json", "--depfile"})
        if (args.has(option)) out.push_back({option, args.value(option)});
    return out;
}

// Links followed, so that two spellings of one file are equal; a name that does not exist yet is only made absolute.
std::string one_name(const std::string& path) {
    std::error_code failed;
    const std::filesystem::path whole = std::filesystem::weakly_canonical(std::filesystem::absolute(path, failed), failed);
    return failed ? path : whole.string();
}

// No output may replace a file that the build reads, or another output: a slip of the hand must not cost a shader its source.
// Devices (/dev/null, /dev/stdout) can be named often.
Status check_outputs(const std::vector<Output>& outputs, const std::vector<std::string>& inputs) {
    std::vector<std::pair<std::string, const Output*>> taken;
    std::vector<std::string> read;
    for (const std::string& input : inputs) read.push_back(one_name(input));
    for (const Output& output : outputs) {
        if (output.path.empty()) return Error{Fault::usage, "kiln build: " + output.option + ": the name of a file is missing"};
        std::error_code failed;
        const auto there = std::filesystem::status(output.path, failed);
        if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) continue;
        const std::string name = one_name(output.path);
        for (size_t i = 0; i < read.size(); ++i)
            if (read[i] == name)
                return Error{Fault::usage, "kiln build: " + output.option + " would overwrite " + inputs[i] +
                                               ", which this build reads; give it another name"};
        for (const auto& [other, first] : taken)
            if (other == name)
                return Error{Fault::usage, "kiln build: " + first->option + " and " + output.option + " name one file, " +
                                               output.path + "; give one of them another name"};
        taken.emplace_back(name, &output);
    }
    return {};
}

Status publish(Files& files, const Args& args, const Build& build, const std::string& output) {
    KILN_TRY(files.write(output + ".proof", build.files.proof));
    if (args.has("--header")) {
        // An unchanged header keeps its time stamp, so that nothing that includes it is rebuilt.
        const auto old = files.read(args.value("--header"));
        if (!old.ok() || !old->has_value() || **old != build.key_header)
            KILN_TRY(files.write(args.value("--header"), as_bytes(build.key_header)));
    }
    KILN_TRY(files.write(output, build.files.table));
    if (args.has("--depfile")) KILN_TRY(files.write(args.value("--depfile"), as_bytes(depfile(output, build.depends))));
    return {};
}

int run_build(const Args& args) {
    const bool plans = args.has("--distributed-plan");
    for (const auto& [option, of] : {std::pair("--workers", "--distributed-plan"), std::pair("--execute-timeout", "--execute")})
        if (args.has(option) && !args.has(of))
            return print_error({Fault::usage, std::string("kiln build: ") + option + " is of use with " + of + " alone"});
    if (!args.has("--output") && !plans) return print_error({Fault::usage, "kiln build: where to? give -o TABLE.kiln"});
    const auto options = build_options(args);
    if (!options.ok()) return print_error(options.error());
    if (plans) {
        auto session = Session::open(args);
        return session.ok() ? print_plan(args, *options, *(*session)->context) : print_error(session.error());
    }
    const std::vector<Output> outputs = outputs_of(args);
    std::vector<std::string> named = options->scenes;
    named.push_back(options->manifest);
    if (const Status status = check_outputs(outputs, named); !status.ok()) return print_error(status.error());
    auto session = Session::open(args);
    if (!session.ok()) return print_error(session.error());
    const Build build = run_pass(*options, *(*session)->context);
    if (const int code = report_build(build); code != 0) return code;
    if (const Status status = check_outputs(outputs, build.depends); !status.ok()) return print_error(status.error());
    const std::string output = args.value("--output");
    if (const Status status = publish((*session)->files, args, build, output); !status.ok()) return print_error(status.error());
    (*session)->finish();
    const RemoteCache* remote = (*session)->remote ? &(*session)->remote->remote() : nullptr;
    const Execution* execution = (*session)->execution.get();
    if (execution != nullptr)
        if (const std::string warning = execution_warning(*execution); !warning.empty()) print_note("warning: " + warning);
    const std::string report =
        args.has("--json") || args.has("--report-json") ? as_json(build, remote, execution) : std::string();
    if (args.has("--report-json"))
        if (const Status status = (*session)->files.write(args.value("--report-json"), as_bytes(report)); !status.ok())
            return print_error(status.error());
    if (args.has("--json")) return finish(report);
    return finish(as_text(build, output) + (execution != nullptr ? execution_text(*execution) : std::string()) +
                  (remote != nullptr ? remote_text(*remote) : std::string()));
}

}  // namespace

const Verb verb_build{"build",
                      "MANIFEST -o T.kiln [--scene S]… [--target T]… [--cache DIR|URL]… [--cache-size SIZE] [-j N] [-g] "
                      "[--parse-back] [--execute ENGINE] [--distributed-plan] [--header F] [--depfile D] "
                      "[--json | --report-json F]",
                      "compile a manifest into a variant table and its proof",
                      1,
                      1,
                      {{"--output", "-o", "FILE", "the table; its proof goes beside it as FILE.proof"},
                       option_scene,
                       {"--target", nullptr, "NAME", "instead of the manifest's targets", true},
                       option_cache,
                       option_cache_size,
                       option_cache_timeout,
                       option_cache_read_only,
                       option_chaos,
                       option_execute,
                       option_execute_timeout,
                       option_plan,
                       option_workers,
                       option_jobs,
                       {"-g", nullptr, nullptr, "keep names and lines for debuggers; layout then tells classes apart"},
                       {"--parse-back", nullptr, nullptr, "parse and link every emitted GLSL and ESSL text again"},
                       {"--header", nullptr, "FILE", "write a C++ header with the key's bit fields"},
                       {"--depfile", nullptr, "FILE", "write the files read, for Ninja and make"},
                       option_json,
                       {"--report-json", nullptr, "FILE", "write the JSON document to a file"}},
                      "kiln build manifests/surface.yaml -o surface.kiln --target spirv --target msl21",
                      run_build};

}  // namespace kiln
