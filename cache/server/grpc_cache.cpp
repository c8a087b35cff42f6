// The calls that answer one message by one message, and GetTree.

#include <deque>
#include <set>

#include "cache/server/grpc_batch_read.h"
#include "cache/zstd.h"

namespace kiln {
namespace {

constexpr size_t most_directories = 100'000;  // of one tree

template <class Body>
grpc::ServerUnaryReactor* answer(grpc::CallbackServerContext* context, const Body& body) {
    grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
    reactor->Finish(body());
    return reactor;
}

void set_status(google::rpc::Status* out, const grpc::Status& status) {
    out->set_code(static_cast<int32_t>(status.error_code()));
    out->set_message(status.error_message());
}

Digest key_of(const BlobName& name) { return name.digest; }

class CapabilitiesCalls final : public reapi::Capabilities::CallbackService {
public:
    explicit CapabilitiesCalls(CallContext& context) : shared_(context) {}

    grpc::ServerUnaryReactor* GetCapabilities(grpc::CallbackServerContext* context, const reapi::GetCapabilitiesRequest* request,
                                              reapi::ServerCapabilities* out) override {
        return answer(context, [&] {
            const Caller caller = shared_.caller(*context);
            const auto instance = shared_.service.enter(caller, request->instance_name(), Role::read);
            if (!instance.ok()) return status_of(instance.refused());
            reapi::CacheCapabilities& cache = *out->mutable_cache_capabilities();
            cache.add_digest_functions(reapi::DigestFunction::SHA256);
            cache.mutable_action_cache_update_capabilities()->set_update_enabled(caller.may(Role::ac_write, instance->name));
            cache.set_max_batch_total_size_bytes(grpc_most_batch);
            cache.set_symlink_absolute_path_strategy(reapi::SymlinkAbsolutePathStrategy::DISALLOWED);
            cache.add_supported_compressors(reapi::Compressor::ZSTD);
            cache.add_supported_batch_update_compressors(reapi::Compressor::ZSTD);
            out->mutable_low_api_version()->set_major(2);
            out->mutable_high_api_version()->set_major(2);
            out->mutable_high_api_version()->set_minor(11);
            return grpc::Status::OK;
        });
    }

private:
    CallContext& shared_;
};

class ActionCacheCalls final : public reapi::ActionCache::CallbackService {
public:
    explicit ActionCacheCalls(CallContext& context) : shared_(context) {}

    grpc::ServerUnaryReactor* GetActionResult(grpc::CallbackServerContext* context, const reapi::GetActionResultRequest* request,
                                              reapi::ActionResult* out) override {
        return answer(context, [&] {
            const auto key = name_of(request->action_digest());
            if (!key) return invalid("the action's digest is none");
            if (grpc::Status s = check_function(request->digest_function()); !s.ok()) return s;
            return get(shared_.caller(*context), request->instance_name(), key_of(*key), *out);
        });
    }

    grpc::ServerUnaryReactor* UpdateActionResult(grpc::CallbackServerContext* context,
                                                 const reapi::UpdateActionResultRequest* request,
                                                 reapi::ActionResult* out) override {
        return answer(context, [&] {
            const auto key = name_of(request->action_digest());
            if (!key) return invalid("the action's digest is none");
            if (grpc::Status s = check_function(request->digest_function()); !s.ok()) return s;
            if (!request->has_action_result()) return invalid("no action result");
            const Caller caller = shared_.caller(*context);
            const std::string bytes = request->action_result().SerializeAsString();
            const auto written = shared_.service.put_action(caller, request->instance_name(), key_of(*key), as_bytes(bytes));
            if (!written.ok()) return status_of(written.refused());
            // What the cache now holds: with kept_first, not what was sent.
            if (*written == Written::kept_first && caller.may(Role::read, request->instance_name()))
                return get(caller, request->instance_name(), key_of(*key), *out);
            *out = request->action_result();
            return grpc::Status::OK;
        });
    }

private:
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
};

// Walks a tree of Directory messages, a page a message.
class TreeReactor final : public grpc::ServerWriteReactor<reapi::GetTreeResponse> {
public:
    TreeReactor(CallContext& shared, grpc::CallbackServerContext* context, const reapi::GetTreeRequest& request)
        : shared_(shared), caller_(shared.caller(*context)), instance_(request.instance_name()) {
        const auto root = name_of(request.root_digest());
        grpc::Status ready = check_function(request.digest_function());
        if (!root) ready = invalid("the root's digest is none");
        if (ready.ok()) {
            want(*root);
            next(true);
        } else {
            Finish(ready);
        }
    }
    void OnWriteDone(bool ok) override {
        if (!ok) return Finish({grpc::StatusCode::CANCELLED, "the client went away"});
        next(false);
    }
    void OnDone() override { delete this; }

private:
    void want(const BlobName& name) {
        if (seen_.size() < most_directories && seen_.insert(name.digest).second) queue_.push_back(name);
    }

    // What is missing below the root is left out, as the API has it.
    void next(bool first) {
        page_.Clear();
        size_t bytes = 0;
        while (!queue_.empty() && bytes < 1024 * 1024) {
            const BlobName name = queue_.front();
            queue_.pop_front();
            auto file = shared_.service.blob(caller_, instance_, name.digest);
            if (!file.ok()) return Finish(status_of(file.refused()));
            const bool there = file->has_value() && (*file)->size() == name.size && name.size <= 1024 * 1024;
            if (!there && first) return Finish({grpc::StatusCode::NOT_FOUND, "the root is not in the cache"});
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
        if (page_.directories().empty()) return Finish(grpc::Status::OK);
        StartWrite(&page_);
    }

    CallContext& shared_;
    const Caller caller_;
    const std::string instance_;
    std::deque<BlobName> queue_;
    std::set<Digest> seen_;
    reapi::GetTreeResponse page_;
};

class BlobCalls final : public reapi::ContentAddressableStorage::WithRawCallbackMethod_BatchReadBlobs<
                            reapi::ContentAddressableStorage::CallbackService> {
public:
    explicit BlobCalls(CallContext& context) : shared_(context) {}

    grpc::ServerUnaryReactor* FindMissingBlobs(grpc::CallbackServerContext* context,
                                               const reapi::FindMissingBlobsRequest* request,
                                               reapi::FindMissingBlobsResponse* out) override {
        return answer(context, [&] {
            if (grpc::Status s = check_function(request->digest_function()); !s.ok()) return s;
            const Caller caller = shared_.caller(*context);
            const auto instance = shared_.service.enter(caller, request->instance_name(), Role::read);
            if (!instance.ok()) return status_of(instance.refused());
            for (const reapi::Digest& digest : request->blob_digests()) {
                const auto name = name_of(digest);
                if (!name) return invalid("a digest is none");
                const auto there = shared_.service.has_blob(caller, request->instance_name(), *name);
                if (!there.ok()) return status_of(there.refused());
                if (!*there) *out->add_missing_blob_digests() = digest;
            }
            return grpc::Status::OK;
        });
    }

    grpc::ServerUnaryReactor* BatchUpdateBlobs(grpc::CallbackServerContext* context,
                                               const reapi::BatchUpdateBlobsRequest* request,
                                               reapi::BatchUpdateBlobsResponse* out) override {
        return answer(context, [&] {
            if (grpc::Status s = check_function(request->digest_function()); !s.ok()) return s;
            const Caller caller = shared_.caller(*context);
            const auto instance = shared_.service.enter(caller, request->instance_name(), Role::cas_write);
            if (!instance.ok()) return status_of(instance.refused());
            for (const auto& one : request->requests()) {
                auto& said = *out->add_responses();
                *said.mutable_digest() = one.digest();
                set_status(said.mutable_status(), put(caller, request->instance_name(), one));
            }
            return grpc::Status::OK;
        });
    }

    grpc::ServerUnaryReactor* BatchReadBlobs(grpc::CallbackServerContext* context, const grpc::ByteBuffer* request,
                                             grpc::ByteBuffer* out) override {
        return answer(context, [&] {
            grpc::ByteBuffer own(*request);
            return batch_read(shared_, shared_.caller(*context), own, *out);
        });
    }

    grpc::ServerWriteReactor<reapi::GetTreeResponse>* GetTree(grpc::CallbackServerContext* context,
                                                              const reapi::GetTreeRequest* request) override {
        return new TreeReactor(shared_, context, *request);
    }

private:
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
};

}  // namespace

std::unique_ptr<grpc::Service> make_capabilities(CallContext& context) { return std::make_unique<CapabilitiesCalls>(context); }
std::unique_ptr<grpc::Service> make_action_cache(CallContext& context) { return std::make_unique<ActionCacheCalls>(context); }
std::unique_ptr<grpc::Service> make_blobs(CallContext& context) { return std::make_unique<BlobCalls>(context); }

}  // namespace kiln
