// ByteStream: blobs that are too large for a message, or whose client likes streams.

#include <bytestream.grpc.pb.h>

#include "cache/server/grpc_call.h"
#include "cache/zstd.h"

namespace kiln {
namespace {

namespace bs = google::bytestream;

constexpr uint64_t piece = 256 * 1024;       // of a download, a message
constexpr uint64_t frame = 8 * 1024 * 1024;  // of a compressed one, a zstd frame
constexpr int level = 3;

std::chrono::seconds time_for(const CallContext& shared, uint64_t size) {
    return shared.options.patience + std::chrono::seconds(size / std::max<uint64_t>(shared.options.slowest, 1));
}

class ReadReactor final : public grpc::ServerWriteReactor<bs::ReadResponse> {
public:
    ReadReactor(CallContext& shared, grpc::CallbackServerContext* context, const bs::ReadRequest& request) {
        const grpc::Status ready = open(shared, context, request);
        if (ready.ok()) {
            timer_.emplace(context, time_for(shared, end_ - at_));
            next();
        } else {
            Finish(ready);
        }
    }
    void OnWriteDone(bool ok) override {
        if (!ok) return Finish({grpc::StatusCode::CANCELLED, "the client went away"});
        next();
    }
    void OnDone() override { delete this; }

private:
    grpc::Status open(CallContext& shared, grpc::CallbackServerContext* context, const bs::ReadRequest& request) {
        const auto name = parse_resource_name(request.resource_name());
        if (!name || name->upload) return invalid("the resource name is none to read");
        auto file = shared.service.blob(shared.caller(*context), name->instance, name->blob.digest);
        if (!file.ok()) return status_of(file.refused());
        if (!file->has_value() || (*file)->size() != name->blob.size) return {grpc::StatusCode::NOT_FOUND, "not in the cache"};
        const int64_t size = static_cast<int64_t>(name->blob.size);
        if (request.read_offset() < 0 || request.read_offset() > size)
            return {grpc::StatusCode::OUT_OF_RANGE, "the offset is outside the blob"};
        if (request.read_limit() < 0) return invalid("the limit is negative");
        if (request.read_limit() != 0 && name->zstd) return invalid("a compressed blob is read to its end");
        file_ = std::move(**file);
        zstd_ = name->zstd;
        at_ = static_cast<uint64_t>(request.read_offset());
        end_ = name->blob.size;
        if (request.read_limit() != 0) end_ = std::min(end_, at_ + static_cast<uint64_t>(request.read_limit()));
        return grpc::Status::OK;
    }

    void next() {
        std::string& data = *response_.mutable_data();
        if (zstd_ && sent_ < packed_.size()) {
            const uint64_t size = std::min<uint64_t>(piece, packed_.size() - sent_);
            data.assign(as_text(packed_).substr(sent_, size));
            sent_ += size;
            return StartWrite(&response_);
        }
        if (at_ == end_) return Finish(grpc::Status::OK);
        const uint64_t size = std::min(zstd_ ? frame : piece, end_ - at_);
        plain_.resize(size);
        if (!file_.read(at_, plain_).ok()) return Finish({grpc::StatusCode::INTERNAL, "the cache's disk failed"});
        at_ += size;
        if (!zstd_) {
            data.assign(as_text(plain_));
            return StartWrite(&response_);
        }
        packed_ = zstd_compress(plain_, level);
        sent_ = 0;
        next();
    }

    std::optional<CallTimer> timer_;
    BlobFile file_;
    bool zstd_ = false;
    uint64_t at_ = 0, end_ = 0;
    Bytes plain_, packed_;
    size_t sent_ = 0;
    bs::ReadResponse response_;
};

class WriteReactor final : public grpc::ServerReadReactor<bs::WriteRequest> {
public:
    WriteReactor(CallContext& shared, grpc::CallbackServerContext* context, bs::WriteResponse* response)
        : shared_(shared), context_(context), caller_(shared.caller(*context)), response_(response) {
        timer_.emplace(context, shared.options.patience);
        StartRead(&request_);
    }

    void OnReadDone(bool ok) override {
        if (!ok) return Finish(invalid("the upload ended without finish_write"));
        if (!name_) {
            const grpc::Status begun = begin();
            if (!begun.ok()) return Finish(begun);
            if (there_) return finish(name_->zstd ? -1 : static_cast<int64_t>(name_->blob.size));
        } else if (!request_.resource_name().empty() && request_.resource_name() != first_) {
            return Finish(invalid("the resource name changes within an upload"));
        }
        const grpc::Status taken = take();
        if (!taken.ok()) return Finish(taken);
        if (!request_.finish_write()) return StartRead(&request_);
        store();
    }
    void OnDone() override { delete this; }

private:
    grpc::Status begin() {
        const auto name = parse_resource_name(request_.resource_name());
        if (!name || !name->upload) return invalid("the resource name is none to write");
        const auto instance = shared_.service.enter(caller_, name->instance, Role::cas_write);
        if (!instance.ok()) return status_of(instance.refused());
        if (name->blob.size > shared_.service.limits().blob)
            return status_of(
                shared_.service.refuse(name->instance, caller_, Refusal::too_large, "the blob is larger than the server takes"));
        name_ = *name;
        first_ = request_.resource_name();
        if (caller_.may(Role::read, name->instance)) {
            const auto there = shared_.service.has_blob(caller_, name->instance, name->blob);
            there_ = there.ok() && *there;
            if (there_) return grpc::Status::OK;
        }
        // The time of a whole upload, now that its size is known.
        timer_.emplace(context_, time_for(shared_, name->blob.size));
        return grpc::Status::OK;
    }

    // A compressed blob may be a little larger on the wire than it is.
    uint64_t most() const { return name_->zstd ? name_->blob.size + name_->blob.size / 128 + 1024 : name_->blob.size; }

    grpc::Status take() {
        if (request_.write_offset() != static_cast<int64_t>(received_.size()))
            return invalid("the offset is not where the upload stands");
        if (request_.data().size() > most() - received_.size()) return invalid("more bytes than the blob has");
        // Memory is taken as the bytes arrive, not as they are announced.
        auto lease = shared_.service.lease(request_.data().size() * (name_->zstd ? 2 : 1));
        if (!lease.ok()) return status_of(lease.refused());
        leases_.push_back(std::move(*lease));
        const ByteView bytes = as_bytes(request_.data());
        received_.insert(received_.end(), bytes.begin(), bytes.end());
        return grpc::Status::OK;
    }

    void store() {
        Bytes plain;
        if (name_->zstd) {
            auto lease = shared_.service.lease(name_->blob.size);
            if (!lease.ok()) return Finish(status_of(lease.refused()));
            leases_.push_back(std::move(*lease));
            if (zstd_unpack(received_, name_->blob.size, plain) != Unpacked::ok)
                return Finish(invalid("the bytes are no zstd of that size"));
        }
        const auto put = shared_.service.put_blob(caller_, name_->instance, name_->blob, name_->zstd ? plain : received_);
        if (!put.ok()) return Finish(status_of(put.refused()));
        finish(static_cast<int64_t>(received_.size()));
    }

    void finish(int64_t committed) {
        response_->set_committed_size(committed);
        Finish(grpc::Status::OK);
    }

    CallContext& shared_;
    grpc::CallbackServerContext* const context_;
    const Caller caller_;
    bs::WriteResponse* const response_;
    std::optional<CallTimer> timer_;
    bs::WriteRequest request_;
    std::optional<ResourceName> name_;
    std::string first_;
    bool there_ = false;
    Bytes received_;
    std::vector<Service::Lease> leases_;
};

class ByteStreamCalls final : public bs::ByteStream::CallbackService {
public:
    explicit ByteStreamCalls(CallContext& context) : shared_(context) {}

    grpc::ServerWriteReactor<bs::ReadResponse>* Read(grpc::CallbackServerContext* context,
                                                     const bs::ReadRequest* request) override {
        return new ReadReactor(shared_, context, *request);
    }

    grpc::ServerReadReactor<bs::WriteRequest>* Write(grpc::CallbackServerContext* context, bs::WriteResponse* response) override {
        return new WriteReactor(shared_, context, response);
    }

    // Uploads are not resumed: one that was cut off begins again, so a blob is there in whole or not at all.
    grpc::ServerUnaryReactor* QueryWriteStatus(grpc::CallbackServerContext* context, const bs::QueryWriteStatusRequest* request,
                                               bs::QueryWriteStatusResponse* out) override {
        grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
        const auto name = parse_resource_name(request->resource_name());
        if (!name || !name->upload) {
            reactor->Finish(invalid("the resource name is none to write"));
            return reactor;
        }
        const auto there = shared_.service.has_blob(shared_.caller(*context), name->instance, name->blob);
        if (!there.ok()) {
            reactor->Finish(status_of(there.refused()));
            return reactor;
        }
        out->set_complete(*there);
        out->set_committed_size(*there ? static_cast<int64_t>(name->blob.size) : 0);
        reactor->Finish(grpc::Status::OK);
        return reactor;
    }

private:
    CallContext& shared_;
};

}  // namespace

std::unique_ptr<grpc::Service> make_byte_stream(CallContext& context) { return std::make_unique<ByteStreamCalls>(context); }

}  // namespace kiln
