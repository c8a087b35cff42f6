// The calls that answer one message by one message, and GetTree.

#include <deque>
#include <set>

#include "cache/server/grpc_batch_read.h"
#include "cache/zstd.h"

namespace kiln {
namespace {

constexpr size_t most_directories = 100'000;  // of one tree

void set_status(google::rpc::Status* out, const grpc::Status& status) {
    out->set_code(static_cast<int32_t>(status.error_code()));
    out->set_message(status.error_message());
}

class CapabilitiesCalls final : public CallService {
public:
    explicit CapabilitiesCalls(CallContext& context) : shared_(context) {}
    grpc::Service& service() override { return service_; }
    void serve(grpc::ServerCompletionQueue& queue) override {
        serve_unary(
            shared_, queue, "GetCapabilities", service_, &Service::RequestGetCapabilities,
            [this](const Caller& caller, const reapi::GetCapabilitiesRequest& request) {
                return shared_.enter(caller, request.instance_name(), Role::read);
            },
            [this](const Caller& caller, const reapi::GetCapabilitiesRequest& request, reapi::ServerCapabilities& out) {
                return get(caller, request, out);
            });
    }

private:
    using Service = reapi::Capabilities::AsyncService;

    grpc::Status get(const Caller& caller, const reapi::GetCapabilitiesRequest& request, reapi::ServerCapabilities& out) {
        reapi::CacheCapabilities& cache = *out.mutable_cache_capabilities();
        cache.add_digest_functions(reapi::DigestFunction::SHA256);
        cache.mutable_action_cache_update_capabilities()->set_update_enabled(caller.may(Role::ac_write, request.instance_name()));
        cache.set_max_batch_total_size_bytes(grpc_most_batch);
        cache.set_symlink_absolute_path_strategy(reapi::SymlinkAbsolutePathStrategy::DISALLOWED);
        cache.add_supported_compressors(reapi::Compressor::ZSTD);
        cache.add_supported_batch_update_compressors(reapi::Compressor::ZSTD);
        out.mutable_low_api_version()->set_major(2);
        out.mutable_high_api_version()->set_major(2);
        out.mutable_high_api_version()->set_minor(11);
        return grpc::Status::OK;
    }

    CallContext& shared_;
    Service service_;
};

class ActionCacheCalls final : public CallService {
public:
    explicit ActionCacheCalls(CallContext& context) : shared_(context) {}
    grpc::Service& service() override { return service_; }
    void serve(grpc::ServerCompletionQueue& queue) override {
        serve_unary(
            shared_, queue, "GetActionResult", service_, &Service::RequestGetActionResult,
            [this](const Caller& caller, const reapi::GetActionResultRequest& request) {
                return admit(caller, request, Role::read);
            },
            [this](const Caller& caller, const reapi::GetActionResultRequest& request, reapi::ActionResult& out) {
                return get(caller, request.instance_name(), name_of(request.action_digest())->digest, out);
            });
        serve_unary(
            shared_, queue, "UpdateActionResult", service_, &Service::RequestUpdateActionResult,
            [this](const Caller& caller, const reapi::UpdateActionResultRequest& request) {
                if (!request.has_action_result()) return invalid("no action result");
                return admit(caller, request, Role::ac_write);
            },
            [this](const Caller& caller, const reapi::UpdateActionResultRequest& request, reapi::ActionResult& out) {
                return update(caller, request, out);
            });
    }

private:
    using Service = reapi::ActionCache::AsyncService;

    template <class Request>
    grpc::Status admit(const Caller& caller, const Request& request, Role role) const {
        if (!name_of(request.action_digest())) return invalid("the action's digest is none");
        if (grpc::Status s = check_function(request.digest_function()); !s.ok()) return s;
        return shared_.enter(caller, request.instance_name(), role);
    }

    grpc::Status update(const Caller& caller, const reapi::UpdateActionResultRequest& request, reapi::ActionResult& out) {
        const auto key = name_of(request.action_digest());
        const std::string bytes = request.action_result().SerializeAsString();
        const auto written = shared_.service.put_action(caller, request.instance_name(), key->digest, as_bytes(bytes));
        if (!written.ok()) return status_of(written.refused());
        // What the cache now holds: with kept_first, not what was sent.
        if (*written == Written::kept_first && caller.may(Role::read, request.instance_name()))
            return get(caller, request.instance_name(), key->digest, out);
        out = request.action_result();
        return grpc::Status::OK;
    }

    grpc::Status get(const Caller& caller, const std::string& instance, const Digest& key, reapi::ActionResult& out) {
        const auto found = shared_.service.action(caller, instance, key);
        if (!found.ok()) return status_of(found.refused());
        if (!found->has_value()) return {grpc::StatusCode::NOT_FOUND, "not in the cache"};
        // An opaque instance holds anything.
        if (!out.ParseFromArray((*found)->data(), static_cast<int>((*found)->size())))
            return {grpc::StatusCode::NOT_FOUND, "not an action result"};
        return grpc::Status::OK;
    }

    CallContext& shared_;
    Service service_;
};

using BlobService =
    reapi::ContentAddressableStorage::WithRawMethod_BatchReadBlobs<reapi::ContentAddressableStorage::AsyncService>;

// Walks a tree of Directory messages, a page a message.
class TreeCall final : public Call {
public:
    TreeCall(CallContext& shared, grpc::ServerCompletionQueue& queue, BlobService& service)
        : Call(shared, queue, "GetTree"), service_(service) {
        service.RequestGetTree(&context_, &request_, &writer_, &queue, &queue, tag());
    }

private:
    void wait_for_next() override { new TreeCall(shared_, queue_, service_); }
    bool begin_at_once() override {
        request_.DiscardUnknownFields();
        const auto root = name_of(request_.root_digest());
        grpc::Status s = check_function(request_.digest_function());
        if (s.ok() && !root) s = invalid("the root's digest is none");
        if (s.ok()) s = shared_.enter(*caller_, request_.instance_name(), Role::read);
        if (!s.ok()) return end(s), true;
        want(*root);
        return false;
    }
    void begin() override { next(true); }
    void go_on(bool ok) override {
        if (!ok) return end({grpc::StatusCode::CANCELLED, "the client went away"});
        next(false);
    }
    void end(const grpc::Status& status) override { writer_.Finish(ended(status), tag()); }
    std::string subject() const override { return request_.instance_name(); }

    void want(const BlobName& name) {
        if (seen_.size() < most_directories && seen_.insert(name.digest).second) ahead_.push_back(name);
    }

    // What is missing below the root is left out, as the API has it.
    void next(bool first) {
        page_.Clear();
        size_t bytes = 0;
        while (!ahead_.empty() && bytes < 1024 * 1024) {
            if (shared_.ending) return end(stopping());
            const BlobName name = ahead_.front();
            ahead_.pop_front();
            auto file = shared_.service.blob(*caller_, request_.instance_name(), name.digest);
            if (!file.ok()) return end(status_of(file.refused()));
            const bool there = file->has_value() && (*file)->size() == name.size && name.size <= 1024 * 1024;
            if (!there && first) return end({grpc::StatusCode::NOT_FOUND, "the root is not in the cache"});
            first = false;
            if (!there) continue;
            const Result<Bytes> all = (*file)->all();
            reapi::Directory directory;
            if (!all.ok() || !directory.ParseFromArray(all->data(), static_cast<int>(all->size()))) continue;
            for (const reapi::DirectoryNode& below : directory.directories())
                if (const auto named = name_of(below.digest())) want(*named);
            bytes += all->size();
            page_.add_directories()->Swap(&directory);
        }
        if (page_.directories().empty()) return end(grpc::Status::OK);
        out_ += bytes;
        if (const grpc::Status held = hold_answer(bytes); !held.ok()) return end(held);
        writer_.Write(page_, tag());
    }

    BlobService& service_;
    reapi::GetTreeRequest request_;
    grpc::ServerAsyncWriter<reapi::GetTreeResponse> writer_{&context_};
    std::deque<BlobName> ahead_;
    std::set<Digest> seen_;
    reapi::GetTreeResponse page_;
};

class BlobCalls final : public CallService {
public:
    explicit BlobCalls(CallContext& context) : shared_(context) {}
    grpc::Service& service() override { return service_; }
    void serve(grpc::ServerCompletionQueue& queue) override {
        serve_unary(
            shared_, queue, "FindMissingBlobs", service_, &BlobService::RequestFindMissingBlobs,
            [this](const Caller& caller, const reapi::FindMissingBlobsRequest& request) {
                return admit(caller, request, request.blob_digests_size(), Role::read);
            },
            [this](const Caller& caller, const reapi::FindMissingBlobsRequest& request, reapi::FindMissingBlobsResponse& out) {
                return find_missing(caller, request, out);
            });
        serve_unary(
            shared_, queue, "BatchUpdateBlobs", service_, &BlobService::RequestBatchUpdateBlobs,
            [this](const Caller& caller, const reapi::BatchUpdateBlobsRequest& request) {
                return admit(caller, request, request.requests_size(), Role::cas_write);
            },
            [this](const Caller& caller, const reapi::BatchUpdateBlobsRequest& request, reapi::BatchUpdateBlobsResponse& out) {
                return update(caller, request, out);
            });
        serve_batch_read(shared_, queue, [this](auto&&... how) { service_.RequestBatchReadBlobs(how...); });
        new TreeCall(shared_, queue, service_);
    }

private:
    template <class Request>
    grpc::Status admit(const Caller& caller, const Request& request, int entries, Role role) const {
        if (grpc::Status s = check_function(request.digest_function()); !s.ok()) return s;
        if (grpc::Status s = shared_.enter(caller, request.instance_name(), role); !s.ok()) return s;
        if (entries > grpc_most_entries) return invalid("more blobs than one message may name");
        return grpc::Status::OK;
    }

    grpc::Status find_missing(const Caller& caller, const reapi::FindMissingBlobsRequest& request,
                              reapi::FindMissingBlobsResponse& out) {
        for (const reapi::Digest& digest : request.blob_digests()) {
            if (shared_.ending) return stopping();
            const auto name = name_of(digest);
            if (!name) return invalid("a digest is none");
            const auto there = shared_.service.has_blob(caller, request.instance_name(), *name);
            if (!there.ok()) return status_of(there.refused());
            if (!*there) *out.add_missing_blob_digests() = digest;
        }
        return grpc::Status::OK;
    }

    grpc::Status update(const Caller& caller, const reapi::BatchUpdateBlobsRequest& request,
                        reapi::BatchUpdateBlobsResponse& out) {
        for (const auto& one : request.requests()) {
            if (shared_.ending) return stopping();
            auto& said = *out.add_responses();
            *said.mutable_digest() = one.digest();
            set_status(said.mutable_status(), put(caller, request.instance_name(), one));
        }
        return grpc::Status::OK;
    }

    grpc::Status put(const Caller& caller, const std::string& instance, const reapi::BatchUpdateBlobsRequest::Request& one) {
        const auto name = name_of(one.digest());
        if (!name) return invalid("the digest is none");
        if (one.compressor() == reapi::Compressor::IDENTITY) {
            const auto put = shared_.service.put_blob(caller, instance, *name, as_bytes(one.data()));
            return put.ok() ? grpc::Status::OK : status_of(put.refused());
        }
        if (one.compressor() != reapi::Compressor::ZSTD) return invalid("a compressor that is not zstd");
        if (name->size > shared_.service.limits().blob) return {grpc::StatusCode::RESOURCE_EXHAUSTED, "the blob is too large"};
        const auto lease = shared_.service.lease(name->size);
        if (!lease.ok()) return status_of(lease.refused());
        Bytes plain;
        if (zstd_unpack(as_bytes(one.data()), name->size, plain) != Unpacked::ok)
            return invalid("the bytes are no zstd of that size");
        const auto put = shared_.service.put_blob(caller, instance, *name, plain);
        return put.ok() ? grpc::Status::OK : status_of(put.refused());
    }

    CallContext& shared_;
    BlobService service_;
};

}  // namespace

std::unique_ptr<CallService> make_capabilities(CallContext& context) { return std::make_unique<CapabilitiesCalls>(context); }
std::unique_ptr<CallService> make_action_cache(CallContext& context) { return std::make_unique<ActionCacheCalls>(context); }
std::unique_ptr<CallService> make_blobs(CallContext& context) { return std::make_unique<BlobCalls>(context); }

}  // namespace kiln
