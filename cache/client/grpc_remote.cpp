#include "cache/client/grpc_remote.h"

#include <grpc/support/log.h>
#include <remote_execution.grpc.pb.h>

#include <map>
#include <random>

#include "cache/client/grpc_calls.h"
#include "cache/protocol/resource_name.h"

namespace kiln {

namespace {

namespace reapi = build::bazel::remote::execution::v2;
using Kind = RemoteAnswer::Kind;

constexpr int most_message = 4 * 1024 * 1024;
constexpr uint64_t most_batch = 3 * 1024 * 1024;  // of blobs in one message, if the server does not want less
constexpr uint64_t around_blob = 256;             // what a message says about a blob
constexpr size_t most_asked = 4096;               // digests in one question
constexpr size_t wide = 32;                       // calls at a time
constexpr unsigned patience = 8;
constexpr uint64_t whole_speed = 1024 * 1024;  // what a call may take: the deadline and its bytes at this speed

// Keys are digests of what was asked, not of an Action message; the API wants a size beside one.
constexpr int64_t size_of_action = 64;

RemoteAnswer answer_of(const grpc::Status& status) {
    const auto code = status.error_code();
    // A server's own words are not repeated: they may hold what it was sent.
    switch (code) {
        case grpc::StatusCode::OK:
            return {Kind::found, {}, {}, false};
        case grpc::StatusCode::NOT_FOUND:
            return {Kind::absent, {}, {}, false};
        case grpc::StatusCode::UNAUTHENTICATED:
            return {Kind::denied, {}, "it asks for a token", false};
        case grpc::StatusCode::PERMISSION_DENIED:
            return {Kind::denied, {}, "this token may not do that", false};
        case grpc::StatusCode::DEADLINE_EXCEEDED:
            return {Kind::failed, {}, "it did not answer in time", true};
        case grpc::StatusCode::UNAVAILABLE:
            return {Kind::failed, {}, "it cannot be reached or went away", false};
        case grpc::StatusCode::CANCELLED:
            return {Kind::failed, {}, "given up", false};
        default:
            return {Kind::failed, {}, "it answered gRPC status " + std::to_string(static_cast<int>(code)), false};
    }
}

RemoteAnswer answer_of(const google::rpc::Status& status) {
    return answer_of(grpc::Status(static_cast<grpc::StatusCode>(status.code()), std::string()));
}

RemoteAnswer failed(const std::string& why) { return {Kind::failed, {}, why, false}; }

std::string version(int major, int minor) { return std::to_string(major) + "." + std::to_string(minor); }

void set(reapi::Digest* out, const Digest& digest, uint64_t size) {
    out->set_hash(digest.hex());
    out->set_size_bytes(static_cast<int64_t>(size));
}

// The value that a server holds is the one that was sent; what it adds to one (who made it, when) does not count.
bool same_value(const reapi::ActionResult& a, const reapi::ActionResult& b) {
    if (a.stdout_raw() != b.stdout_raw() || a.output_files_size() != b.output_files_size()) return false;
    for (int i = 0; i < a.output_files_size(); ++i)
        if (a.output_files(i).digest().hash() != b.output_files(i).digest().hash()) return false;
    return true;
}

template <class Call>
std::vector<OneCall*> pointers(std::vector<Call>& calls) {
    std::vector<OneCall*> out;
    for (Call& call : calls) out.push_back(&call);
    return out;
}

class GrpcRemote final : public RemoteStore {
public:
    GrpcRemote(const RemoteUrl& url, const GrpcRemoteOptions& options, const RemoteLimits& limits,
               std::shared_ptr<grpc::Channel> channel)
        : name_(url.text()),
          instance_(url.path.empty() ? "" : url.path.substr(1)),
          options_(options),
          limits_(limits),
          end_(options.interrupted),
          capabilities_(reapi::Capabilities::NewStub(channel)),
          actions_(reapi::ActionCache::NewStub(channel)),
          blobs_(reapi::ContentAddressableStorage::NewStub(channel)),
          streams_(google::bytestream::ByteStream::NewStub(channel)) {}

    std::string name() const override { return name_; }
    void end_at(std::chrono::steady_clock::time_point when) override { end_.at(when); }
    std::vector<RemoteAnswer> get_actions(std::span<const Digest> keys) override;
    std::vector<RemoteAnswer> put_actions(std::span<const RemoteUpload> actions) override;
    std::vector<RemoteAnswer> find_blobs(std::span<const RemoteBlob> blobs) override;
    std::vector<RemoteAnswer> get_blobs(std::span<const RemoteBlob> blobs) override;
    std::vector<RemoteAnswer> put_blobs(std::span<const RemoteUpload> blobs) override;

private:
    template <class Request, class Response>
    struct Unary : OneCall {
        std::vector<size_t> which;  // places in the caller's batch
        Request request;
        Response response;
    };
    struct Reading : OneCall {
        size_t which = 0;
        std::unique_ptr<Download> stream;
    };
    struct Writing : OneCall {
        size_t which = 0;
        std::unique_ptr<Upload> stream;
    };

    std::optional<RemoteAnswer> refusal(bool writes);
    RemoteAnswer negotiate();
    grpc::ClientContext& context_of(OneCall& call, uint64_t bytes) const;
    // Groups of places whose blobs fit into one message; what fits into none goes to `large`.
    template <class Size>
    std::vector<std::vector<size_t>> batches(const std::vector<size_t>& places, const Size& size,
                                             std::vector<size_t>& large) const;
    template <class Call, class Start>
    void run(std::vector<Call>& calls, const Start& start) {
        run_calls(pointers(calls), wide, patience, end_, start);
    }
    void read_streams(std::span<const RemoteBlob> blobs, const std::vector<size_t>& large, std::vector<RemoteAnswer>& answers);
    void write_streams(std::span<const RemoteUpload> blobs, const std::vector<size_t>& large, std::vector<RemoteAnswer>& answers);

    const std::string name_, instance_;
    const GrpcRemoteOptions options_;
    const RemoteLimits limits_;
    CallEnd end_;
    const std::unique_ptr<reapi::Capabilities::Stub> capabilities_;
    const std::unique_ptr<reapi::ActionCache::Stub> actions_;
    const std::unique_ptr<reapi::ContentAddressableStorage::Stub> blobs_;
    const std::unique_ptr<google::bytestream::ByteStream::Stub> streams_;
    std::mutex mutex_;  // of what follows, which is set when the server has said what it can do
    std::optional<RemoteAnswer> verdict_;
    std::atomic<bool> may_write_{true};
    std::atomic<uint64_t> batch_{most_batch};
};

grpc::ClientContext& GrpcRemote::context_of(OneCall& call, uint64_t bytes) const {
    call.context = std::make_unique<grpc::ClientContext>();
    call.context->set_deadline(std::chrono::system_clock::now() + options_.timeout +
                               std::chrono::milliseconds(bytes * 1000 / whole_speed));
    if (!options_.token.empty()) call.context->AddMetadata("authorization", "Bearer " + options_.token);
    return *call.context;
}

RemoteAnswer GrpcRemote::negotiate() {
    std::vector<Unary<reapi::GetCapabilitiesRequest, reapi::ServerCapabilities>> calls(1);
    auto& call = calls.front();
    call.request.set_instance_name(instance_);
    run(calls, [&](size_t, CallDone done) {
        capabilities_->async()->GetCapabilities(&context_of(call, 0), &call.request, &call.response, std::move(done));
    });
    if (call.status.error_code() == grpc::StatusCode::UNIMPLEMENTED) return {Kind::found, {}, {}, false};
    if (!call.status.ok()) return answer_of(call.status);
    const reapi::ServerCapabilities& can = call.response;
    const auto &low = can.low_api_version(), &high = can.high_api_version();
    const bool says = can.has_low_api_version() && can.has_high_api_version();
    if (says && (low.major() > 2 || (low.major() == 2 && low.minor() > grpc_newest_minor) || high.major() < 2))
        return {Kind::denied,
                {},
                "it speaks API " + version(low.major(), low.minor()) + " to " + version(high.major(), high.minor()) +
                    ", kiln 2.0 to " + version(2, grpc_newest_minor),
                false};
    const reapi::CacheCapabilities& cache = can.cache_capabilities();
    bool sha256 = cache.digest_functions_size() == 0;
    for (const int function : cache.digest_functions()) sha256 |= function == reapi::DigestFunction::SHA256;
    if (!sha256) return {Kind::denied, {}, "it does not know SHA-256", false};
    may_write_ = !cache.has_action_cache_update_capabilities() || cache.action_cache_update_capabilities().update_enabled();
    const int64_t most = cache.max_batch_total_size_bytes();
    if (most > 0) batch_ = std::min(most_batch, static_cast<uint64_t>(most));
    return {Kind::found, {}, {}, false};
}

std::optional<RemoteAnswer> GrpcRemote::refusal(bool writes) {
    const std::lock_guard lock(mutex_);
    if (!verdict_ || verdict_->kind == Kind::failed) verdict_ = negotiate();  // a failure is no verdict for ever
    if (verdict_->kind != Kind::found) return verdict_;
    if (writes && !may_write_ && !options_.inputs) return RemoteAnswer{Kind::denied, {}, "this token may not write", false};
    return std::nullopt;
}

std::vector<RemoteAnswer> GrpcRemote::get_actions(std::span<const Digest> keys) {
    if (const auto no = refusal(false)) return std::vector<RemoteAnswer>(keys.size(), *no);
    std::vector<Unary<reapi::GetActionResultRequest, reapi::ActionResult>> calls(keys.size());
    run(calls, [&](size_t i, CallDone done) {
        auto& call = calls[i];
        call.request.set_instance_name(instance_);
        call.request.set_inline_stdout(true);
        set(call.request.mutable_action_digest(), keys[i], size_of_action);
        actions_->async()->GetActionResult(&context_of(call, 0), &call.request, &call.response, std::move(done));
    });
    std::vector<RemoteAnswer> answers;
    for (auto& call : calls) {
        answers.push_back(answer_of(call.status));
        if (!call.status.ok()) continue;
        const size_t size = call.response.ByteSizeLong();
        if (size > limits_.action) {
            answers.back() = failed("an action result longer than " + std::to_string(limits_.action) + " bytes");
            continue;
        }
        answers.back().bytes.resize(size);
        call.response.SerializeToArray(answers.back().bytes.data(), static_cast<int>(size));
    }
    return answers;
}

std::vector<RemoteAnswer> GrpcRemote::put_actions(std::span<const RemoteUpload> actions) {
    if (const auto no = refusal(true)) return std::vector<RemoteAnswer>(actions.size(), *no);
    std::vector<Unary<reapi::UpdateActionResultRequest, reapi::ActionResult>> calls(actions.size());
    run(calls, [&](size_t i, CallDone done) {
        auto& call = calls[i];
        call.request.set_instance_name(instance_);
        set(call.request.mutable_action_digest(), actions[i].key, size_of_action);
        if (!call.request.mutable_action_result()->ParseFromArray(actions[i].bytes.data(),
                                                                  static_cast<int>(actions[i].bytes.size())))
            call.request.clear_action_result();  // refused by the server; kiln wrote these bytes itself
        actions_->async()->UpdateActionResult(&context_of(call, actions[i].bytes.size()), &call.request, &call.response,
                                              std::move(done));
    });
    std::vector<RemoteAnswer> answers;
    for (auto& call : calls) {
        answers.push_back(answer_of(call.status));
        // Some servers answer nothing; one that keeps what it had answers that.
        if (call.status.ok() && call.response.ByteSizeLong() != 0 && !same_value(call.request.action_result(), call.response))
            answers.back().kind = Kind::absent;
    }
    return answers;
}

std::vector<RemoteAnswer> GrpcRemote::find_blobs(std::span<const RemoteBlob> blobs) {
    if (const auto no = refusal(false)) return std::vector<RemoteAnswer>(blobs.size(), *no);
    std::vector<Unary<reapi::FindMissingBlobsRequest, reapi::FindMissingBlobsResponse>> calls((blobs.size() + most_asked - 1) /
                                                                                              most_asked);
    for (size_t i = 0; i < blobs.size(); ++i)
        if (blobs[i].size != RemoteBlob::unknown) calls[i / most_asked].which.push_back(i);
    run(calls, [&](size_t c, CallDone done) {
        auto& call = calls[c];
        call.request.set_instance_name(instance_);
        for (const size_t i : call.which) set(call.request.add_blob_digests(), blobs[i].digest, blobs[i].size);
        blobs_->async()->FindMissingBlobs(&context_of(call, 0), &call.request, &call.response, std::move(done));
    });
    std::vector<RemoteAnswer> answers(blobs.size(), RemoteAnswer{Kind::absent, {}, {}, false});
    for (auto& call : calls) {
        std::map<std::string, bool> missing;
        for (const reapi::Digest& digest : call.response.missing_blob_digests()) missing[digest.hash()] = true;
        for (const size_t i : call.which) {
            answers[i] = answer_of(call.status);
            if (call.status.ok() && missing.count(blobs[i].digest.hex()) != 0) answers[i].kind = Kind::absent;
        }
    }
    return answers;
}

template <class Size>
std::vector<std::vector<size_t>> GrpcRemote::batches(const std::vector<size_t>& places, const Size& size,
                                                     std::vector<size_t>& large) const {
    std::vector<std::vector<size_t>> groups;
    uint64_t filled = ~uint64_t{0};
    for (const size_t i : places) {
        const uint64_t needs = size(i) + around_blob;
        if (needs > batch_) {
            large.push_back(i);
            continue;
        }
        if (groups.empty() || filled + needs > batch_) {
            groups.emplace_back();
            filled = 0;
        }
        groups.back().push_back(i);
        filled += needs;
    }
    return groups;
}

std::vector<RemoteAnswer> GrpcRemote::get_blobs(std::span<const RemoteBlob> blobs) {
    if (const auto no = refusal(false)) return std::vector<RemoteAnswer>(blobs.size(), *no);
    std::vector<RemoteAnswer> answers(blobs.size(), RemoteAnswer{Kind::absent, {}, {}, false});
    // A blob is asked for once, however often it is wanted.
    std::map<Digest, std::vector<size_t>> wanted;
    std::vector<size_t> places, large;
    for (size_t i = 0; i < blobs.size(); ++i) {
        if (blobs[i].size == RemoteBlob::unknown) continue;
        if (blobs[i].size > limits_.blob) {
            answers[i] = failed("a blob longer than " + std::to_string(limits_.blob) + " bytes");
            continue;
        }
        std::vector<size_t>& same = wanted[blobs[i].digest];
        if (same.empty()) places.push_back(i);
        same.push_back(i);
    }
    const auto groups = batches(
        places, [&](size_t i) { return blobs[i].size; }, large);
    std::vector<Unary<reapi::BatchReadBlobsRequest, reapi::BatchReadBlobsResponse>> calls(groups.size());
    run(calls, [&](size_t c, CallDone done) {
        auto& call = calls[c];
        call.request.set_instance_name(instance_);
        for (const size_t i : groups[c]) set(call.request.add_digests(), blobs[i].digest, blobs[i].size);
        blobs_->async()->BatchReadBlobs(&context_of(call, most_batch), &call.request, &call.response, std::move(done));
    });
    for (size_t c = 0; c < calls.size(); ++c) {
        std::map<std::string, reapi::BatchReadBlobsResponse::Response*> said;
        for (auto& one : *calls[c].response.mutable_responses()) said.emplace(one.digest().hash(), &one);
        for (const size_t i : groups[c]) {
            answers[i] = answer_of(calls[c].status);
            if (!calls[c].status.ok()) continue;
            const auto one = said.find(blobs[i].digest.hex());
            if (one == said.end()) {
                answers[i] = failed("it left a blob out of its answer");
                continue;
            }
            answers[i] = answer_of(one->second->status());
            const std::string& data = one->second->data();
            if (answers[i].kind == Kind::found) answers[i].bytes.assign(data.begin(), data.end());
            said.erase(one);
        }
        calls[c].response.Clear();
    }
    read_streams(blobs, large, answers);
    for (const auto& [digest, same] : wanted)
        for (size_t i = 1; i < same.size(); ++i) answers[same[i]] = answers[same.front()];
    return answers;
}

void GrpcRemote::read_streams(std::span<const RemoteBlob> blobs, const std::vector<size_t>& large,
                              std::vector<RemoteAnswer>& answers) {
    std::vector<Reading> calls(large.size());
    run(calls, [&](size_t c, CallDone done) {
        const RemoteBlob& blob = blobs[large[c]];
        calls[c].stream = std::make_unique<Download>(*streams_, context_of(calls[c], blob.size),
                                                     read_name(instance_, {blob.digest, blob.size}), blob.size, std::move(done));
    });
    for (size_t c = 0; c < calls.size(); ++c) {
        RemoteAnswer& answer = answers[large[c]] = answer_of(calls[c].status);
        if (calls[c].stream && calls[c].stream->too_long) answer = failed("a blob longer than it was to be");
        if (answer.kind == Kind::found) answer.bytes = std::move(calls[c].stream->bytes);
    }
}

std::vector<RemoteAnswer> GrpcRemote::put_blobs(std::span<const RemoteUpload> blobs) {
    if (const auto no = refusal(true)) return std::vector<RemoteAnswer>(blobs.size(), *no);
    std::vector<RemoteAnswer> answers(blobs.size());
    std::vector<size_t> places(blobs.size()), large;
    for (size_t i = 0; i < places.size(); ++i) places[i] = i;
    const auto groups = batches(
        places, [&](size_t i) { return blobs[i].bytes.size(); }, large);
    std::vector<Unary<reapi::BatchUpdateBlobsRequest, reapi::BatchUpdateBlobsResponse>> calls(groups.size());
    run(calls, [&](size_t c, CallDone done) {
        auto& call = calls[c];
        call.request.set_instance_name(instance_);
        for (const size_t i : groups[c]) {
            auto& one = *call.request.add_requests();
            set(one.mutable_digest(), blobs[i].key, blobs[i].bytes.size());
            one.set_data(blobs[i].bytes.data(), blobs[i].bytes.size());
        }
        blobs_->async()->BatchUpdateBlobs(&context_of(call, most_batch), &call.request, &call.response, std::move(done));
    });
    for (size_t c = 0; c < calls.size(); ++c) {
        std::map<std::string, const google::rpc::Status*> said;
        for (const auto& one : calls[c].response.responses()) said.emplace(one.digest().hash(), &one.status());
        for (const size_t i : groups[c]) {
            answers[i] = answer_of(calls[c].status);
            if (!calls[c].status.ok()) continue;
            const auto one = said.find(blobs[i].key.hex());
            answers[i] = one == said.end() ? failed("it left a blob out of its answer") : answer_of(*one->second);
            // Of a write there is no "not found".
            if (answers[i].kind == Kind::absent) answers[i] = failed("it answered gRPC status 5");
        }
    }
    write_streams(blobs, large, answers);
    return answers;
}

void GrpcRemote::write_streams(std::span<const RemoteUpload> blobs, const std::vector<size_t>& large,
                               std::vector<RemoteAnswer>& answers) {
    std::random_device random;
    std::vector<Writing> calls(large.size());
    run(calls, [&](size_t c, CallDone done) {
        const RemoteUpload& blob = blobs[large[c]];
        Digest dice;
        for (uint8_t& byte : dice.bytes) byte = static_cast<uint8_t>(random());
        std::string uuid = dice.hex().substr(0, 32);
        for (const size_t dash : {size_t{20}, size_t{16}, size_t{12}, size_t{8}}) uuid.insert(dash, "-");
        calls[c].stream =
            std::make_unique<Upload>(*streams_, context_of(calls[c], blob.bytes.size()),
                                     upload_name(instance_, uuid, {blob.key, blob.bytes.size()}), blob.bytes, std::move(done));
    });
    for (size_t c = 0; c < calls.size(); ++c) {
        answers[large[c]] = answer_of(calls[c].status);
        if (calls[c].status.ok() &&
            calls[c].stream->response.committed_size() != static_cast<int64_t>(blobs[large[c]].bytes.size()))
            answers[large[c]] = failed("it took a part of a blob");
    }
}

}  // namespace

std::shared_ptr<grpc::Channel> open_grpc_channel(const RemoteUrl& url, const GrpcRemoteOptions& options) {
    // What goes wrong is said once, by the build; gRPC's own lines would come between.
    if (std::getenv("GRPC_VERBOSITY") == nullptr) gpr_set_log_function([](gpr_log_func_args*) {});
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(most_message);
    arguments.SetMaxSendMessageSize(most_message);
    arguments.SetInt(GRPC_ARG_MAX_METADATA_SIZE, 64 * 1024);
    arguments.SetInt(GRPC_ARG_ENABLE_PER_MESSAGE_DECOMPRESSION, 0);
    arguments.SetInt(GRPC_COMPRESSION_CHANNEL_ENABLED_ALGORITHMS_BITSET, 1);  // identity
    arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
    arguments.SetInt(GRPC_ARG_SERVICE_CONFIG_DISABLE_RESOLUTION, 1);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    if (url.loopback()) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);  // a token may go there in clear text, and nowhere else
    // A connection that was lost is tried again soon: when to stop asking is the breaker's business.
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
    arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 2000);
    arguments.SetUserAgentPrefix("kiln");
    std::shared_ptr<grpc::ChannelCredentials> credentials = grpc::InsecureChannelCredentials();
    if (url.tls()) {
        grpc::SslCredentialsOptions ssl;
        ssl.pem_root_certs = options.authority;
        credentials = grpc::SslCredentials(ssl);
    }
    const std::string target = "dns:///" + url.host + ":" + std::to_string(url.port);
    return grpc::CreateCustomChannel(target, credentials, arguments);
}

}  // namespace kiln

__attribute__((visibility("default"))) kiln::OpenGrpcRemote kiln_grpc_open_2 __asm__("kiln_grpc_open_2");

kiln::Result<std::unique_ptr<kiln::RemoteStore>> kiln_grpc_open_2(const kiln::RemoteUrl& url,
                                                                  const kiln::GrpcRemoteOptions& options,
                                                                  const kiln::RemoteLimits& limits) {
    return std::unique_ptr<kiln::RemoteStore>(
        std::make_unique<kiln::GrpcRemote>(url, options, limits, kiln::open_grpc_channel(url, options)));
}
