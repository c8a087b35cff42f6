#include "tools/execute.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "cache/execute/local_engine.h"
#include "cache/execute/slurm_engine.h"
#include "tools/console.h"
#include "tools/session.h"

namespace kiln {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> out(1);
    for (const char c : text) {
        if (c == at)
            out.emplace_back();
        else
            out.back() += c;
    }
    return out;
}

Result<std::unique_ptr<Engine>> open_engine(const std::string& spec) {
    if (spec.starts_with("local:")) {
        const std::string count = spec.substr(6);
        const int n =
            count.size() < 5 && count.find_first_not_of("0123456789") == std::string::npos ? std::atoi(count.c_str()) : 0;
        if (n < 1) return Error{Fault::usage, "--execute local:N takes a number of processes from 1 on"};
        return std::unique_ptr<Engine>(std::make_unique<LocalEngine>(static_cast<size_t>(n)));
    }
    if (spec.starts_with("slurm:")) {
        std::vector<std::string> words = split(spec.substr(6), ',');
        const std::string folder = words.front();
        words.erase(words.begin());
        if (folder.empty() || folder.front() != '/')
            return Error{Fault::usage, "--execute slurm:FOLDER takes the absolute name of a folder that all nodes see"};
        return std::unique_ptr<Engine>(std::make_unique<SlurmEngine>(folder, std::move(words)));
    }
    if (spec.starts_with("grpc://") || spec.starts_with("grpcs://")) return open_nodes(split(spec, ','));
    return Error{Fault::usage,
                 "--execute takes local:N, slurm:FOLDER[,SBATCH-OPTION]… or grpc://NODE[,grpc://NODE]…, not '" + spec + "'"};
}

std::string worker_program() {
    if (const char* named = std::getenv("KILN_WORKER"); named != nullptr && *named != '\0') return named;
    std::error_code problem;
    return (std::filesystem::read_symlink("/proc/self/exe", problem).parent_path() / "kiln-worker").string();
}

// That this process has used, on all of its threads.
double processor_ms() {
    struct rusage usage {};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& t) { return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_usec) / 1e3; };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

std::string seconds(double ms) {
    char out[32];
    std::snprintf(out, sizeof out, "%.2f s", ms / 1000);
    return out;
}

}  // namespace

const Option option_execute{"--execute", nullptr, "ENGINE",
                            "compile and translate on an engine: local:N (processes), slurm:FOLDER[,OPTION]…, "
                            "grpc://NODE[/INSTANCE][,grpc://NODE]… (Remote Execution API)"};
const Option option_execute_timeout{"--execute-timeout", nullptr, "S",
                                    "how long a step may take there before the rest is done here; default 600"};
const Option option_plan{"--distributed-plan", nullptr, nullptr,
                         "say what --execute would send and how long it would take; writes nothing"};
const Option option_workers{"--workers", nullptr, "N", "with --distributed-plan: model this many workers instead of 1 to 64"};

Result<std::unique_ptr<Execution>> Execution::open(const Args& args, Store& store, Toolchain& tools) {
    if (!args.has("--execute")) return std::unique_ptr<Execution>();
    auto engine = open_engine(args.value("--execute"));
    KILN_TRY(engine);
    const auto timeout = args.number("--execute-timeout", 600, 1, 86400);
    KILN_TRY(timeout);
    auto out = std::make_unique<Execution>();
    out->engine = std::move(*engine);
    auto distributor = Distributor::make(*out->engine, store, tools, worker_program(), std::chrono::seconds(*timeout));
    KILN_TRY(distributor);
    out->distributor = std::move(*distributor);
    out->distributor->progress = console_progress();
    return out;
}

void execution_json(Json& json, const Execution& execution) {
    const DistributionCounts& c = execution.distributor->counts();
    json.key("execution").object().text("engine", execution.engine->name());
    json.number("questions", c.questions).number("answered", c.answered).number("batches", c.batches);
    json.number("failed_batches", c.failed_batches).number("cached_batches", c.cached_batches);
    json.number("bytes_sent", c.bytes_out).number("bytes_received", c.bytes_in).end();
}

std::string execution_text(const Execution& execution) {
    const DistributionCounts& c = execution.distributor->counts();
    const auto n = [](uint64_t v) { return Count(v).grouped(); };
    if (c.questions == 0) return "  " + execution.engine->name() + " was not asked: everything was in the cache\n";
    return "  " + execution.engine->name() + " answered " + n(c.answered) + " of " + n(c.questions) + " in " + n(c.batches) +
           " batches (" + n(c.failed_batches) + " failed, " + n(c.cached_batches) + " from its cache), " + n(c.bytes_out) +
           " bytes out, " + n(c.bytes_in) + " back\n";
}

std::string execution_warning(const Execution& execution) {
    const DistributionCounts& c = execution.distributor->counts();
    if (c.failed_batches == 0) return {};
    const std::string name = execution.engine->name();  // of a single node, its problems begin with it
    const std::string problem =
        c.first_problem.starts_with(name + ": ") ? c.first_problem.substr(name.size() + 2) : c.first_problem;
    return name + " failed " + std::to_string(c.failed_batches) + " of " + std::to_string(c.batches) +
           " batches, which were done here: " + problem;
}

int print_plan(const Args& args, const BuildOptions& options, PassContext& context) {
    const auto workers = args.number("--workers", 0, 1, 100'000);
    if (!workers.ok()) return print_error(workers.error());
    DistributionPlan plan(context.tools.identity());
    PassContext cold{context.files, plan, context.tools, context.jobs, context.progress, &plan};
    const double began = processor_ms();
    const Build build = run_pass(options, cold);
    if (const int code = report_build(build); code != 0) return code;
    const double used = processor_ms() - began;

    double here = 0;
    std::map<std::string, double> step_ms;
    for (const auto& [step, ms] : build.ms) step_ms[step] += ms, here += ms;
    // What this machine gave others in the meantime is not the work's: times are those of processors to themselves.
    const double jobs = std::min<double>(context.jobs.threads(), std::max(1u, std::thread::hardware_concurrency()));
    const double sent = step_ms["modules"] + step_ms["artifacts"];
    const double share = std::clamp(used / (sent * jobs + here - sent), 0.01, 1.0);
    for (auto& [step, ms] : step_ms) ms *= share;
    const double alone = here * share, rest = (here - sent) * share;
    const DistributionModel model;
    const auto work = [&](const DistributionPlan::Step& step) { return step_ms[step.name] * jobs; };
    const auto modelled = [&](uint64_t n) {
        return rest + plan.module_step.ms(work(plan.module_step), n, model) +
               plan.artifact_step.ms(work(plan.artifact_step), n, model);
    };
    const auto batches = [&](uint64_t n) { return plan.module_step.batches(n) + plan.artifact_step.batches(n); };
    std::vector<uint64_t> counts = {1, 2, 4, 8, 16, 32, 64};
    if (*workers != 0) counts = {static_cast<uint64_t>(*workers)};

    if (args.has("--json")) {
        Json json;
        json.object().key("steps").array();
        for (const auto& step : {plan.module_step, plan.artifact_step})
            json.object()
                .text("step", step.name)
                .number("questions", step.questions)
                .number("bytes", step.bytes_out)
                .number("bytes_back", step.bytes_in)
                .number("work_ms", work(step))
                .end();
        json.end().number("here_ms", alone).number("measured_ms", here).number("not_distributed_ms", rest).key("model").array();
        for (const uint64_t n : counts)
            json.object().number("workers", n).number("batches", batches(n)).number("ms", modelled(n)).end();
        json.end().end();
        return finish(json.take());
    }
    const auto n = [](uint64_t v) { return Count(v).grouped(); };
    const auto line = [&](const char* what, const DistributionPlan::Step& step, const char* of) {
        return what + n(step.questions) + of + seconds(work(step)) + " of work, " + n(step.bytes_out) + " bytes out, " +
               n(step.bytes_in) + " back\n";
    };
    std::string out = line("compile    ", plan.module_step, " classes, ") +
                      line("translate  ", plan.artifact_step, " modules, ") + "here       " + seconds(alone) + " with " +
                      std::to_string(context.jobs.threads()) + " jobs, of which " + seconds(rest) + " stay here";
    if (share < 0.75) out += " (" + seconds(here) + " now: this machine is busy with other things)";
    out += "\n";
    uint64_t pays = 0;
    for (const uint64_t count : counts) {
        if (pays == 0 && modelled(count) < alone) pays = count;
        out += std::to_string(count) + (count == 1 ? " worker   " : " workers  ") + n(batches(count)) + " batches, about " +
               seconds(modelled(count)) + (modelled(count) < alone ? "\n" : ", no gain\n");
    }
    if (counts.size() > 1 && pays != 0)
        out += "from an empty cache it pays from " + std::to_string(pays) + " workers on; what the cache knows is not sent\n";
    else if (counts.size() > 1)
        out += "it does not pay: there is too little work\n";
    out +=
        "modelled with workers as fast as this machine, 90 ms an action, 80 ms a worker's start and 100 MB/s; batches of at "
        "least half a second of work\n";
    return finish(out);
}

}  // namespace kiln
