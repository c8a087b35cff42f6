#include "compiler/validate/check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "compiler/validate/inputs.h"

namespace kiln {

namespace {

constexpr double tolerance = 1e-4;
constexpr double allowed_share = 1e-3;

float as_float(uint32_t word) {
    float v;
    std::memcpy(&v, &word, 4);
    return v;
}

BaseType type_of(const ReadBack& r, size_t word) {
    if (r.types.empty()) return BaseType::uint32;
    return r.types.size() == 1 ? r.types[0] : word < r.types.size() ? r.types[word] : BaseType::uint32;
}

std::vector<StageCode> copy_stages(const std::vector<StagePtr>& stages) {
    std::vector<StageCode> out;
    for (const StagePtr& s : stages) out.push_back(*s);
    return out;
}

std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", v);
    return text;
}

// Runs with the vertex input as position that covers most: the first that can be one where that covers a quarter of the
// picture, else every other in turn. `options` is left at the choice.
Result<PipelineOutput> run_visible(Device& device, PipelineRequest& request, const CheckJob& job, InputOptions& options) {
    const auto attempt = [&](const InputOptions& with) {
        InputOptions o = with;
        request.inputs.clear();
        for (const Mood mood : {Mood::ordinary, Mood::mixed}) {
            o.mood = mood;
            request.inputs.push_back(make_inputs(request.stages, o));
        }
        return device.run(request);
    };
    const auto final = [](const Result<PipelineOutput>& r) { return !r.ok() || r->runs.empty() || !r->errors.empty(); };
    options.seed = job.seed;
    Result<PipelineOutput> best = attempt(options);
    if (request.stages.empty() || request.stages.front().stage != Stage::vertex || request.stages.front().partner) return best;
    std::vector<InputOptions> others;
    const std::vector<std::string> candidates = position_candidates(request.stages);
    for (size_t i = 1; i < candidates.size(); ++i) {
        others.push_back(options);
        others.back().position = candidates[i];
    }
    if (candidates.empty())  // positions out of gl_VertexIndex: strips and lists of other lengths
        for (const uint32_t vertices : {6u, 36u}) {
            others.push_back(options);
            others.back().vertices = vertices;
        }
    const uint64_t enough = uint64_t{job.size} * job.size / 4;
    for (const InputOptions& other : others) {
        if (final(best) || best->runs.front().covered >= enough) break;
        Result<PipelineOutput> again = attempt(other);
        if (final(again) || again->runs.front().covered > best->runs.front().covered) {
            best = std::move(again);
            options = other;
        }
    }
    return best;
}

void judge_difference(const ReadBack& a, const ReadBack& b, Mood mood, Verdict& v) {
    const Difference d = compare(a, b);
    v.values += d.values;
    v.differing += d.differing;
    const bool too_many = static_cast<double>(d.differing) > allowed_share * static_cast<double>(d.values);
    const bool finiteness = mood == Mood::ordinary && d.finiteness != 0;
    if (!too_many && !finiteness) return;
    v.outcome = Outcome::failed;
    if (!v.why.empty()) return;
    v.why = "optimised and unoptimised differ in " + a.what + ": " + std::to_string(d.differing) + " of " +
            std::to_string(d.values) + " values";
    if (d.finiteness != 0)
        v.why += ", " + std::to_string(d.finiteness) + " finite in one only";
    else
        v.why += ", at most by " + number(d.worst);
    if (mood == Mood::mixed) v.why += " (inputs of either sign)";
}

void judge_runs(const PipelineOutput& optimised, const PipelineOutput& unoptimised, Verdict& v) {
    for (size_t run = 0; run < optimised.runs.size() && run < unoptimised.runs.size(); ++run) {
        const Mood mood = static_cast<Mood>(run);
        for (const ReadBack& a : optimised.runs[run].values) {
            const auto& others = unoptimised.runs[run].values;
            const auto b = std::find_if(others.begin(), others.end(), [&](const ReadBack& r) { return r.what == a.what; });
            if (b != others.end()) judge_difference(a, *b, mood, v);
        }
        // What only the unoptimised form has: a resource that it declares and never needed to. An output must be in both.
        for (const ReadBack& b : unoptimised.runs[run].values) {
            const auto& mine = optimised.runs[run].values;
            if (b.what.rfind("output ", 0) == 0 &&
                std::none_of(mine.begin(), mine.end(), [&](const ReadBack& r) { return r.what == b.what; })) {
                v.outcome = Outcome::failed;
                v.why = b.what + " is missing from the optimised form";
            }
        }
    }
}

// True when the form ran; otherwise the verdict is final.
bool judge_messages(const PipelineOutput& out, const char* prefix, Verdict& v) {
    if (!out.unsupported.empty()) {
        v.outcome = Outcome::unsupported;
        v.why = out.unsupported;
        return false;
    }
    if (out.errors.empty()) return true;
    v.outcome = Outcome::failed;
    v.why = prefix + out.errors.front();
    if (out.errors.size() > 1) v.why += " (and " + std::to_string(out.errors.size() - 1) + " more)";
    return false;
}

}  // namespace

Difference compare(const ReadBack& a, const ReadBack& b) {
    Difference d;
    d.values = std::max(a.words.size(), b.words.size());
    const size_t both = std::min(a.words.size(), b.words.size());
    d.differing = d.values - both;
    for (size_t i = 0; i < both; ++i) {
        if (a.words[i] == b.words[i]) continue;
        if (type_of(a, i) != BaseType::float32) {
            ++d.differing;
            d.worst = std::max(d.worst, 1.0);
            continue;
        }
        const double x = static_cast<double>(as_float(a.words[i])), y = static_cast<double>(as_float(b.words[i]));
        if (std::isfinite(x) != std::isfinite(y)) {
            ++d.finiteness;
            ++d.differing;
            continue;
        }
        if (!std::isfinite(x)) continue;  // NaN of another payload, infinity of another sign: equally broken
        const double off = std::fabs(x - y);
        if (off > tolerance * std::max({1.0, std::fabs(x), std::fabs(y)})) ++d.differing;
        if (off > d.worst) d.worst = off, d.worst_index = i;
    }
    return d;
}

uint64_t count_nonfinite(const RunOutput& run) {
    uint64_t n = 0;
    for (const ReadBack& r : run.values)
        for (size_t i = 0; i < r.words.size(); ++i)
            if (type_of(r, i) == BaseType::float32 && !std::isfinite(as_float(r.words[i]))) ++n;
    return n;
}

Result<Verdict> check_pipeline(Device& device, const CheckJob& job) {
    Verdict v;
    PipelineRequest request;
    request.size = job.size;
    request.stages = copy_stages(job.optimised);
    InputOptions options;
    Result<PipelineOutput> optimised = run_visible(device, request, job, options);
    KILN_TRY(optimised);
    v.ms = optimised->create_ms + optimised->run_ms;
    if (!judge_messages(*optimised, "", v)) return v;
    if (optimised->runs.empty()) return environment_error("the device ran nothing and said nothing");
    v.covered = optimised->runs.front().covered;
    v.nonfinite = count_nonfinite(optimised->runs.front());
    if (v.nonfinite != 0) {
        v.outcome = Outcome::failed;
        v.why = std::to_string(v.nonfinite) + " values are not finite though every input is ordinary";
        for (const ReadBack& r : optimised->runs.front().values) {
            RunOutput one;
            one.values = {r};
            if (const uint64_t n = count_nonfinite(one); n != 0) v.why += "; " + std::to_string(n) + " in " + r.what;
        }
    }
    if (job.unoptimised.empty()) return v;

    request.stages = copy_stages(job.unoptimised);
    request.inputs.clear();
    for (const Mood mood : {Mood::ordinary, Mood::mixed}) {
        options.mood = mood;
        request.inputs.push_back(make_inputs(request.stages, options));
    }
    Result<PipelineOutput> unoptimised = device.run(request);
    KILN_TRY(unoptimised);
    v.ms += unoptimised->create_ms + unoptimised->run_ms;
    if (!judge_messages(*unoptimised, "the unoptimised form: ", v)) return v;
    v.compared = true;
    judge_runs(*optimised, *unoptimised, v);
    return v;
}

}  // namespace kiln
