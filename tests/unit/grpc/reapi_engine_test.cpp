#include "cache/execute/reapi_engine.h"

#include <gtest/gtest.h>
#include <operations.grpc.pb.h>

#include <set>

#include "cache/execute/reapi_action.h"
#include "tests/unit/grpc/liar.h"

kiln::OpenReapiEngine kiln_grpc_open_engine_2 __asm__("kiln_grpc_open_engine_2");

namespace kiln::testing {
namespace {

using google::longrunning::Operation;
using Answers = grpc::ServerWriter<Operation>;

Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

JobFile file(const std::string& path, std::string_view text, bool executable = false) {
    auto bytes = std::make_shared<Bytes>(bytes_of(text));
    return {path, bytes, sha256(*bytes), executable};
}

Job job() {
    return {{file("in/b.txt", "two"), file("worker", "#!", true), file("in/a.txt", "one")}, {"./worker", "in", "out"}, {"out"}};
}

// An engine whose every action makes "out" of the text "made", until a test replaces its answer.
class Node final : public reapi::Execution::Service, public google::longrunning::Operations::Service {
public:
    Node()
        : store({static_cast<reapi::Execution::Service*>(this), static_cast<google::longrunning::Operations::Service*>(this)}) {
        store.versions(2, 0, 2, 3);
        // What an engine's clients usually may not.
        store.capabilities.mutable_cache_capabilities()->mutable_action_cache_update_capabilities()->set_update_enabled(false);
    }

    grpc::Status Execute(ServerContext* context, const reapi::ExecuteRequest* request, Answers* out) override {
        ++executions;
        asked = *request;
        const auto token_sent = context->client_metadata().find("authorization");
        token = token_sent == context->client_metadata().end()
                    ? ""
                    : std::string(token_sent->second.data(), token_sent->second.size());
        if (on_execute) return on_execute(context, *request, out);
        answer(out, result());
        return grpc::Status::OK;
    }
    grpc::Status WaitExecution(ServerContext*, const reapi::WaitExecutionRequest* request, Answers* out) override {
        ++waits;
        if (forgets) return {grpc::StatusCode::NOT_FOUND, ""};
        if (request->name() != "operation/1") return {grpc::StatusCode::INVALID_ARGUMENT, request->name()};
        answer(out, result());
        return grpc::Status::OK;
    }

    grpc::Status CancelOperation(ServerContext*, const google::longrunning::CancelOperationRequest* request,
                                 google::protobuf::Empty*) override {
        EXPECT_EQ(request->name(), "operation/1");
        ++cancels;
        return grpc::Status::OK;
    }
    // Says that it works, and then nothing more.
    void work(ServerContext* context, Answers* out) {
        Operation running;
        running.set_name("operation/1");
        out->Write(running);
        store.hang(context);
    }

    reapi::ActionResult result(const std::string& text = "made") {
        reapi::ActionResult out;
        auto& one = *out.add_output_files();
        one.set_path("out");
        set_digest(one.mutable_digest(), {sha256(as_bytes(text)), text.size()});
        const std::lock_guard lock(store.mutex);
        store.blobs[one.digest().hash()] = text;
        return out;
    }
    static void answer(Answers* out, const reapi::ActionResult& result, bool cached = false, int code = 0) {
        reapi::ExecuteResponse response;
        *response.mutable_result() = result;
        response.set_cached_result(cached);
        response.mutable_status()->set_code(code);
        answer(out, response);
    }
    static void answer(Answers* out, const google::protobuf::Message& response) {
        Operation done;
        done.set_name("operation/1");
        done.set_done(true);
        done.mutable_response()->PackFrom(response);
        out->Write(done);
    }
    std::string url() const { return "grpc://127.0.0.1:" + std::to_string(store.port) + "/team/main"; }

    Liar store;
    std::atomic<size_t> executions{0}, waits{0}, cancels{0};
    bool forgets = false;
    reapi::ExecuteRequest asked;
    std::string token;
    std::function<grpc::Status(ServerContext*, const reapi::ExecuteRequest&, Answers*)> on_execute;
};

std::unique_ptr<Engine> engine(std::vector<const Node*> nodes, ReapiOptions options = {}) {
    std::vector<RemoteUrl> urls;
    for (const Node* node : nodes) urls.push_back(*RemoteUrl::parse(node->url()));
    return std::move(*kiln_grpc_open_engine_2(urls, options));
}

constexpr std::chrono::seconds ample{20};

std::string text_of(const Result<JobResult>& result) {
    if (!result.ok()) return "error: " + result.error().message;
    return result->outputs.size() == 1 ? std::string(as_text(result->outputs[0]))
                                       : "outputs: " + std::to_string(result->outputs.size());
}
bool says(const Result<JobResult>& result, std::string_view what) {
    return !result.ok() && result.error().message.find(what) != std::string::npos;
}

template <class Message>
Message held(Node& node, const reapi::Digest& digest) {
    const std::lock_guard lock(node.store.mutex);
    Message out;
    EXPECT_EQ(node.store.blobs.count(digest.hash()), 1u);
    EXPECT_EQ(node.store.blobs[digest.hash()].size(), static_cast<size_t>(digest.size_bytes()));
    EXPECT_TRUE(out.ParseFromString(node.store.blobs[digest.hash()]));
    return out;
}

TEST(ReapiEngine, TheNodeHoldsEverythingThatTheActionNames) {
    Node node;
    ReapiOptions options;
    options.platform = {{"OSFamily", "linux"}};
    options.remote.token = "a-token";
    const auto result = engine({&node}, options)->run(job(), ample);
    EXPECT_EQ(text_of(result), "made");
    EXPECT_FALSE(result->cached);
    EXPECT_EQ(node.asked.instance_name(), "team/main");
    EXPECT_EQ(node.token, "Bearer a-token");
    const auto action = held<reapi::Action>(node, node.asked.action_digest());
    const auto command = held<reapi::Command>(node, action.command_digest());
    EXPECT_EQ(std::vector<std::string>(command.arguments().begin(), command.arguments().end()),
              (std::vector<std::string>{"./worker", "in", "out"}));
    ASSERT_EQ(command.output_paths_size(), 1);
    EXPECT_EQ(command.output_paths(0), "out");
    EXPECT_EQ(command.output_files(0), "out");
    EXPECT_EQ(action.platform().properties(0).value(), "linux");
    const auto root = held<reapi::Directory>(node, action.input_root_digest());
    ASSERT_EQ(root.files_size(), 1);
    EXPECT_EQ(root.files(0).name(), "worker");
    EXPECT_TRUE(root.files(0).is_executable());
    ASSERT_EQ(root.directories_size(), 1);
    const auto in = held<reapi::Directory>(node, root.directories(0).digest());
    ASSERT_EQ(in.files_size(), 2);
    EXPECT_EQ(in.files(0).name(), "a.txt");
    EXPECT_EQ(in.files(1).name(), "b.txt");
    EXPECT_FALSE(in.files(1).is_executable());
    EXPECT_EQ(node.store.blobs[in.files(1).digest().hash()], "two");
}

TEST(ReapiEngine, EqualJobsAreEqualActions) {
    Job other = job();
    std::swap(other.inputs[0], other.inputs[2]);
    const auto one = reapi_action(job(), {{"a", "1"}, {"b", "2"}}), two = reapi_action(other, {{"b", "2"}, {"a", "1"}});
    EXPECT_EQ(one->name, two->name);
    other.arguments[2] = "out2";
    EXPECT_NE(one->name, reapi_action(other, {{"a", "1"}, {"b", "2"}})->name);
    other = job();
    other.inputs[1].executable = false;
    EXPECT_NE(one->name, reapi_action(other, {{"a", "1"}, {"b", "2"}})->name);
    EXPECT_NE(one->name, reapi_action(job(), {})->name);
}

TEST(ReapiEngine, JobsThatCannotBeATree) {
    EXPECT_TRUE(reapi_action(job(), {}).ok());
    for (const char* path : {"../x", "/x", "a//b", "", "in", "in/a.txt", "worker/x", "in/a.txt/x"}) {
        Job bad = job();
        bad.inputs.push_back(file(path, "x"));
        EXPECT_FALSE(reapi_action(bad, {}).ok()) << path;
        bad = job();
        bad.outputs = {path};
        EXPECT_EQ(reapi_action(bad, {}).ok(), path[0] == 'i' || path[0] == 'w') << path;
    }
}

TEST(ReapiEngine, WhatIsThereIsNotSentAgain) {
    Node node;
    const auto client = engine({&node});
    EXPECT_EQ(text_of(client->run(job(), ample)), "made");
    const size_t sent = node.store.batches;
    node.store.on_put = [](auto*, const auto&, auto*) { return grpc::Status(grpc::StatusCode::INTERNAL, "sent again"); };
    EXPECT_EQ(text_of(client->run(job(), ample)), "made");
    EXPECT_EQ(node.store.batches, sent + 1);  // the output's
}

TEST(ReapiEngine, WhatTheNodeLostIsSentOnceMore) {
    Node node;
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest& request, Answers* out) {
        if (node.executions == 1) {
            const std::lock_guard lock(node.store.mutex);
            node.store.blobs.clear();
            return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "missing");
        }
        held<reapi::Action>(node, request.action_digest());
        node.answer(out, node.result());
        return grpc::Status::OK;
    };
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");
    EXPECT_EQ(node.executions, 2u);
    // The same said inside the answer, and for ever: an error after the second time.
    node.executions = 0;
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers* out) {
        node.answer(out, {}, false, 9);
        return grpc::Status::OK;
    };
    EXPECT_TRUE(says(engine({&node})->run(job(), ample), "misses"));
    EXPECT_EQ(node.executions, 2u);
}

TEST(ReapiEngine, ARememberedResultWithoutItsFilesIsMadeAnew) {
    Node node;
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest& request, Answers* out) {
        const reapi::ActionResult result = node.result();
        if (!request.skip_cache_lookup()) {
            const std::lock_guard lock(node.store.mutex);
            node.store.blobs.erase(result.output_files(0).digest().hash());
        }
        node.answer(out, result, !request.skip_cache_lookup());
        return grpc::Status::OK;
    };
    const auto result = engine({&node})->run(job(), ample);
    EXPECT_EQ(text_of(result), "made");
    EXPECT_FALSE(result->cached);
    EXPECT_EQ(node.executions, 2u);
}

TEST(ReapiEngine, ABrokenStreamIsTakenUpAgain) {
    Node node;
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers* out) {
        if (node.executions > 1) {
            node.answer(out, node.result());
            return grpc::Status::OK;
        }
        Operation running;
        running.set_name("operation/1");
        out->Write(running);
        return grpc::Status(grpc::StatusCode::UNAVAILABLE, "broken");
    };
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");
    EXPECT_EQ(node.executions, 1u);
    EXPECT_EQ(node.waits, 1u);
    node.executions = 0;
    node.forgets = true;  // a node that was started again
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");
    EXPECT_EQ(node.executions, 2u);
}

TEST(ReapiEngine, ADeadNodesWorkGoesToAnother) {
    Node dead, alive;
    const auto client = engine({&dead, &alive});
    for (int i = 0; i < 2; ++i) EXPECT_EQ(text_of(client->run(job(), ample)), "made");
    EXPECT_EQ(dead.executions, 1u);
    EXPECT_EQ(alive.executions, 1u);
    dead.store.stop();
    for (int i = 0; i < 4; ++i) EXPECT_EQ(text_of(client->run(job(), ample)), "made");
    EXPECT_EQ(alive.executions, 5u);
    alive.store.stop();
    EXPECT_TRUE(says(client->run(job(), ample), "cannot be reached"));
}

TEST(ReapiEngine, AHangEndsWithTheDeadline) {
    Node node;
    node.on_execute = [&](ServerContext* context, const reapi::ExecuteRequest&, Answers*) {
        node.store.hang(context);
        return grpc::Status::OK;
    };
    EXPECT_TRUE(says(engine({&node})->run(job(), std::chrono::milliseconds(300)), "in time"));
    // An operation that is "running" for ever, and says so all the time.
    node.on_execute = [&](ServerContext* context, const reapi::ExecuteRequest&, Answers* out) {
        Operation running;
        running.set_name("operation/1");
        while (!context->IsCancelled() && out->Write(running)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return grpc::Status::OK;
    };
    EXPECT_TRUE(says(engine({&node})->run(job(), std::chrono::milliseconds(300)), "in time"));
    std::atomic<bool> interrupted{true};
    ReapiOptions options;
    options.remote.interrupted = &interrupted;
    EXPECT_FALSE(engine({&node}, options)->run(job(), ample).ok());
}

TEST(ReapiEngine, WhatNobodyWaitsForIsCancelled) {
    Node node;
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");
    EXPECT_EQ(node.cancels, 0u);
    node.on_execute = [&](ServerContext* context, const reapi::ExecuteRequest&, Answers* out) {
        node.work(context, out);
        return grpc::Status::OK;
    };
    EXPECT_TRUE(says(engine({&node})->run(job(), std::chrono::milliseconds(300)), "in time"));
    EXPECT_EQ(node.cancels, 1u);
    std::atomic<bool> interrupted{false};
    ReapiOptions options;
    options.remote.interrupted = &interrupted;
    node.executions = 0;
    std::thread stop([&] {
        while (node.executions == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        interrupted = true;
    });
    EXPECT_TRUE(says(engine({&node}, options)->run(job(), ample), "interrupted"));
    stop.join();
    EXPECT_EQ(node.cancels, 2u);
}

TEST(ReapiEngine, ASilentNodeIsAskedWhetherItIsThere) {
    Node node, other;
    ReapiOptions options;
    options.silence = std::chrono::milliseconds(100);
    options.remote.timeout = std::chrono::milliseconds(500);
    std::atomic<bool> dead{false};
    node.on_execute = [&](ServerContext* context, const reapi::ExecuteRequest&, Answers* out) {
        const size_t asked = node.store.calls;
        if (dead) node.work(context, out);
        while (node.store.calls < asked + 3 && !node.store.ending) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        node.answer(out, node.result());
        return grpc::Status::OK;
    };
    EXPECT_EQ(text_of(engine({&node}, options)->run(job(), ample)), "made");  // it works, and answers
    node.store.on_capabilities = [&](ServerContext* context, reapi::ServerCapabilities* out) {
        if (dead && node.executions != 0) node.store.hang(context);
        *out = node.store.capabilities;
        return grpc::Status::OK;
    };
    dead = true;
    node.executions = 0;
    EXPECT_TRUE(says(engine({&node}, options)->run(job(), ample), "does not answer any more"));
    EXPECT_EQ(node.executions, 1u);
    node.executions = 0;
    const auto both = engine({&node, &other}, options);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(text_of(both->run(job(), ample)), "made");  // another does its work
    EXPECT_EQ(node.executions, 1u);
    EXPECT_EQ(other.executions, 3u);
}

TEST(ReapiEngine, ASlowFailureIsNotSufferedByEveryJob) {
    Node node;
    node.store.on_capabilities = [&](ServerContext* context, reapi::ServerCapabilities*) {
        node.store.hang(context);
        return grpc::Status::OK;
    };
    ReapiOptions options;
    options.remote.timeout = std::chrono::milliseconds(1500);
    const std::vector<Job> jobs(8, job());
    const auto results = engine({&node}, options)->run_all(jobs, ample, {});
    EXPECT_EQ(std::count_if(results.begin(), results.end(), [](const auto& r) { return says(r, "in time"); }), 1);
    EXPECT_EQ(std::count_if(results.begin(), results.end(), [](const auto& r) { return says(r, "a moment ago"); }), 7);
    EXPECT_EQ(node.store.calls, 1u);
}

TEST(ReapiEngine, AServerThatDoesNotExecuteIsSentNothing) {
    Node node;
    node.store.capabilities.mutable_execution_capabilities()->set_exec_enabled(false);
    EXPECT_TRUE(says(engine({&node})->run(job(), ample), "does not execute"));
    EXPECT_EQ(node.store.blobs.size(), 0u);
    EXPECT_EQ(node.executions, 0u);
    node.store.capabilities.mutable_execution_capabilities()->set_exec_enabled(true);
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");
    node.store.on_capabilities = [](ServerContext*, reapi::ServerCapabilities*) {
        return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
    };
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");  // one that does not say what it can do
}

TEST(ReapiEngine, ANodesOwnTroubleIsNotTheJobs) {
    for (const bool in_answer : {false, true}) {
        Node bad, good;
        bad.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers* out) {
            if (!in_answer) return grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED, "the queue is full");
            reapi::ExecuteResponse response;
            response.mutable_status()->set_code(grpc::StatusCode::INTERNAL);
            response.mutable_status()->set_message("its store\nis away");
            Node::answer(out, response);
            return grpc::Status::OK;
        };
        const auto client = engine({&bad, &good});
        for (int i = 0; i < 3; ++i) EXPECT_EQ(text_of(client->run(job(), ample)), "made");
        EXPECT_EQ(bad.executions, 1u);
        EXPECT_TRUE(says(engine({&bad})->run(job(), ample), in_answer ? "13: its store is away" : "8: the queue is full"));
    }
}

TEST(ReapiEngine, ARememberedFailureIsTriedAnew) {
    Node node;
    bool for_ever = false;
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest& request, Answers* out) {
        reapi::ActionResult result = node.result();
        if (!request.skip_cache_lookup() || for_ever) result.set_exit_code(137);
        node.answer(out, result, !request.skip_cache_lookup());
        return grpc::Status::OK;
    };
    EXPECT_EQ(text_of(engine({&node})->run(job(), ample)), "made");
    EXPECT_EQ(node.executions, 2u);
    for_ever = true;
    EXPECT_TRUE(says(engine({&node})->run(job(), ample), "ended with 137"));
    EXPECT_EQ(node.executions, 4u);
}

TEST(ReapiEngine, NothingThatComesBackIsBelieved) {
    Node node;
    const auto client = engine({&node});
    const auto with = [&](const std::function<void(reapi::ActionResult&)>& change) {
        node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers* out) {
            reapi::ActionResult result = node.result();
            change(result);
            node.answer(out, result);
            return grpc::Status::OK;
        };
        return client->run(job(), ample);
    };
    EXPECT_EQ(text_of(with([](auto&) {})), "made");
    EXPECT_EQ(text_of(with([](auto& r) { r.mutable_output_files(0)->set_contents("made"); })), "made");
    EXPECT_EQ(text_of(with([](auto& r) { r.mutable_output_files(0)->set_contents("lies"); })), "made");  // asked for by digest
    for (const char* path : {"/etc/passwd", "../out", "a/../../out", "", "a\\b"}) {
        const auto result = with([&](auto& r) {
            *r.add_output_files() = reapi::OutputFile(r.output_files(0));
            r.mutable_output_files(1)->set_path(path);
        });
        EXPECT_TRUE(says(result, *path == 0 ? "malformed" : "outside")) << path << ": " << text_of(result);
    }
    EXPECT_TRUE(says(with([](auto& r) { r.clear_output_files(); }), "lacks out"));
    EXPECT_TRUE(says(with([](auto& r) {
                         r.clear_output_files();
                         auto& link = *r.add_output_symlinks();
                         link.set_path("out");
                         link.set_target("/etc/passwd");
                     }),
                     "lacks out"));
    EXPECT_TRUE(says(with([](auto& r) { r.mutable_output_files(0)->mutable_digest()->set_hash("AB"); }), "malformed"));
    EXPECT_TRUE(says(with([](auto& r) { r.mutable_output_files(0)->mutable_digest()->set_size_bytes(-4); }), "malformed"));
    EXPECT_TRUE(
        says(with([](auto& r) { r.mutable_output_files(0)->mutable_digest()->set_size_bytes(int64_t{1} << 60); }), "too large"));
    EXPECT_FALSE(with([](auto& r) { r.mutable_output_files(0)->mutable_digest()->set_size_bytes(5); }).ok());
    EXPECT_TRUE(says(with([&](auto& r) {
                         const std::lock_guard lock(node.store.mutex);
                         node.store.blobs[r.output_files(0).digest().hash()] = "lies";
                     }),
                     "other bytes"));
    const auto failing = with([](auto& r) {
        r.set_exit_code(3);
        r.set_stderr_raw("no\x1b[31m such thing");
    });
    EXPECT_TRUE(says(failing, "ended with 3: no [31m such thing"));
    EXPECT_TRUE(says(with([&](auto& r) {
                         r.set_exit_code(4);
                         const std::lock_guard lock(node.store.mutex);
                         node.store.blobs[sha256(as_bytes("a long story")).hex()] = "a long story";
                         set_digest(r.mutable_stderr_digest(), {sha256(as_bytes("a long story")), 12});
                     }),
                     "ended with 4: a long story"));

    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers* out) {
        node.answer(out, reapi::Digest());  // a message of another type
        return grpc::Status::OK;
    };
    EXPECT_TRUE(says(client->run(job(), ample), "malformed"));
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers*) { return grpc::Status::OK; };
    EXPECT_TRUE(says(client->run(job(), ample), "without an answer"));
    node.on_execute = [&](ServerContext*, const reapi::ExecuteRequest&, Answers*) {
        return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "");
    };
    EXPECT_TRUE(says(client->run(job(), ample), "may not execute"));
}

TEST(ReapiEngine, ManyJobsAtOnce) {
    Node one, two;
    std::vector<Job> jobs(40, job());
    for (size_t i = 0; i < jobs.size(); ++i) jobs[i].arguments.push_back(std::to_string(i));
    size_t told = 0;
    std::mutex mutex;
    const auto results = engine({&one, &two})->run_all(jobs, ample, [&] {
        const std::lock_guard lock(mutex);
        ++told;
    });
    ASSERT_EQ(results.size(), jobs.size());
    for (const auto& result : results) EXPECT_EQ(text_of(result), "made");
    EXPECT_EQ(told, jobs.size());
    EXPECT_EQ(one.executions + two.executions, jobs.size());
    EXPECT_GT(one.executions, 0u);
    EXPECT_GT(two.executions, 0u);
}

}  // namespace
}  // namespace kiln::testing
