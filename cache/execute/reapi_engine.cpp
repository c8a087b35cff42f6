#include "cache/execute/reapi_engine.h"

#include <algorithm>

#include "cache/execute/reapi_node.h"
#include "cache/protocol/action_result.h"

namespace kiln {

namespace {

using Clock = ReapiNode::Clock;

class ReapiEngine final : public Engine {
public:
    explicit ReapiEngine(ReapiOptions options) : options_(std::move(options)) {}
    Status add(const RemoteUrl& url) {
        auto node = ReapiNode::open(url, options_);
        KILN_TRY(node);
        nodes_.push_back(std::move(*node));
        return {};
    }

    std::string name() const override {
        return nodes_.front()->url.text() + (nodes_.size() == 1 ? "" : " and " + std::to_string(nodes_.size() - 1) + " more");
    }
    size_t width() const override { return options_.width * nodes_.size(); }
    Result<JobResult> run(const Job& job, std::chrono::milliseconds deadline) override;

private:
    Result<JobResult> run_on(ReapiNode& node, const Job& job, const ReapiAction& action, Clock::time_point end, bool& reached);
    Outcome fetch(ReapiNode& node, const Job& job, const ActionResult& result, JobResult& out);
    // What a command that failed wrote to its standard error, as far as it is to be had.
    static std::string complaint(ReapiNode& node, const ActionResult& result);

    const ReapiOptions options_;
    std::vector<std::unique_ptr<ReapiNode>> nodes_;
    std::atomic<size_t> turn_{0};
};

// A node that rests is asked when there is no other.
Result<JobResult> ReapiEngine::run(const Job& job, std::chrono::milliseconds deadline) {
    const auto end = Clock::now() + deadline;
    const auto action = reapi_action(job, options_.platform);
    KILN_TRY(action);
    std::vector<ReapiNode*> order;
    const size_t first = turn_++;
    for (size_t i = 0; i < nodes_.size(); ++i) order.push_back(nodes_[(first + i) % nodes_.size()].get());
    std::stable_partition(order.begin(), order.end(), [](const ReapiNode* node) { return !node->rests(); });
    std::optional<Error> problem;
    for (ReapiNode* node : order) {
        if (node->interrupted()) return environment_error("interrupted");
        if (problem && Clock::now() >= end) break;
        bool reached = true;
        auto result = run_on(*node, job, *action, end, reached);
        if (reached) return result;
        node->rest();
        problem = result.error();
    }
    return *problem;
}

Result<JobResult> ReapiEngine::run_on(ReapiNode& node, const Job& job, const ReapiAction& action, Clock::time_point end,
                                      bool& reached) {
    const auto error = [&](const Outcome& outcome) {
        reached = outcome.kind != Outcome::Kind::no_node;
        return environment_error(node.url.text() + ": " + outcome.problem);
    };
    bool sent_again = false, anew = false;
    Outcome outcome = node.send(action, false);
    while (outcome.kind == Outcome::Kind::done) {
        outcome = node.execute(action.name, anew, end);
        if (outcome.kind == Outcome::Kind::missing && !sent_again) {
            sent_again = true;
            outcome = node.send(action, true);
            continue;
        }
        if (outcome.kind != Outcome::Kind::done) break;
        const std::string bytes = outcome.response.result().SerializeAsString();
        const auto result = parse_action_result(as_bytes(bytes));
        if (!result.ok())
            return error({Outcome::Kind::failed, "its result is malformed: " + one_line(result.error().message), {}});
        if (result->exit_code != 0 && outcome.response.cached_result() && !anew) {
            anew = true;  // some engines remember failures, which may have been their own
            continue;
        }
        if (result->exit_code != 0)
            return error({Outcome::Kind::failed,
                          "the command ended with " + std::to_string(result->exit_code) + ": " + complaint(node, *result),
                          {}});
        JobResult out;
        out.cached = outcome.response.cached_result();
        outcome = fetch(node, job, *result, out);
        if (outcome.kind == Outcome::Kind::done) return out;
        if (outcome.kind != Outcome::Kind::missing || anew || !out.cached) break;
        anew = true;  // a result that the engine remembers, but whose files are gone
        outcome.kind = Outcome::Kind::done;
    }
    return error(outcome);
}

std::string ReapiEngine::complaint(ReapiNode& node, const ActionResult& result) {
    if (!result.stderr_raw.empty() || !result.stderr_digest || result.stderr_digest->size > 64 * 1024)
        return one_line(as_text(result.stderr_raw));
    const RemoteBlob blob{result.stderr_digest->digest, result.stderr_digest->size};
    return one_line(as_text(node.blobs().get_blobs({&blob, 1}).front().bytes));
}

Outcome ReapiEngine::fetch(ReapiNode& node, const Job& job, const ActionResult& result, JobResult& out) {
    const auto hostile = [](const std::string& what) { return Outcome{Outcome::Kind::failed, what, {}}; };
    std::map<std::string, const ActionResult::File*> files;
    for (const ActionResult::File& file : result.files) {
        if (!stays_below(file.path)) return hostile("its result has a path outside the job's folder");
        files.emplace(file.path, &file);
    }
    std::vector<RemoteBlob> wanted;
    std::vector<size_t> places;
    out.outputs.resize(job.outputs.size());
    for (size_t i = 0; i < job.outputs.size(); ++i) {
        const auto found = files.find(job.outputs[i]);
        if (found == files.end()) return hostile("its result lacks " + job.outputs[i]);
        const ActionResult::File& file = *found->second;
        if (file.blob.size > largest_output) return hostile("its " + job.outputs[i] + " is too large");
        if (file.contents.size() == file.blob.size && sha256(file.contents) == file.blob.digest) {
            out.outputs[i] = file.contents;
            continue;
        }
        wanted.push_back({file.blob.digest, file.blob.size});
        places.push_back(i);
    }
    if (wanted.empty()) return {Outcome::Kind::done, {}, {}};
    std::vector<RemoteAnswer> answers = node.blobs().get_blobs(wanted);
    for (size_t i = 0; i < answers.size(); ++i) {
        const std::string& path = job.outputs[places[i]];
        if (answers[i].kind == RemoteAnswer::Kind::absent) return {Outcome::Kind::missing, "it lost " + path, {}};
        if (answers[i].kind == RemoteAnswer::Kind::denied) return hostile(answers[i].problem);
        if (answers[i].kind == RemoteAnswer::Kind::failed) return {Outcome::Kind::no_node, answers[i].problem, {}};
        if (answers[i].bytes.size() != wanted[i].size || sha256(answers[i].bytes) != wanted[i].digest)
            return hostile("its " + path + " has other bytes than it says");
        out.outputs[places[i]] = std::move(answers[i].bytes);
    }
    return {Outcome::Kind::done, {}, {}};
}

}  // namespace

}  // namespace kiln

__attribute__((visibility("default"))) kiln::OpenReapiEngine kiln_grpc_open_engine_2 __asm__("kiln_grpc_open_engine_2");

kiln::Result<std::unique_ptr<kiln::Engine>> kiln_grpc_open_engine_2(std::span<const kiln::RemoteUrl> nodes,
                                                                    const kiln::ReapiOptions& options) {
    auto engine = std::make_unique<kiln::ReapiEngine>(options);
    for (const kiln::RemoteUrl& url : nodes) KILN_TRY(engine->add(url));
    return std::unique_ptr<kiln::Engine>(std::move(engine));
}
