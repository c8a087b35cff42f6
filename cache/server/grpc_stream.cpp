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

using StreamService = bs::ByteStream::AsyncService;

class ReadCall final : public Call {
public:
    ReadCall(CallContext& shared, grpc::ServerCompletionQueue& queue, StreamService& service)
        : Call(shared, queue, "Read"), service_(service) {
        service.RequestRead(&context_, &request_, &writer_, &queue, &queue, tag());
    }

private:
    void wait_for_next() override { new ReadCall(shared_, queue_, service_); }
    bool begin_at_once() override {
        request_.DiscardUnknownFields();
        const auto name = parse_resource_name(request_.resource_name());
        if (!name || name->upload) return end(invalid("the resource name is none to read")), true;
        if (const grpc::Status s = shared_.enter(*caller_, name->instance, Role::read); !s.ok()) return end(s), true;
        return false;
    }
    void begin() override {
        if (const grpc::Status ready = open(); !ready.ok()) return end(ready);
        const uint64_t left = end_ - at_;
        if (const grpc::Status held = hold_answer(std::min(left, zstd_ ? 2 * frame : piece), left); !held.ok()) return end(held);
        next();
    }
    void go_on(bool ok) override {
        if (!ok) return end({grpc::StatusCode::CANCELLED, "the client went away"});
        next();
    }
    void end(const grpc::Status& status) override { writer_.Finish(ended(status), tag()); }
    std::string subject() const override { return request_.resource_name(); }

    grpc::Status open() {
        const auto name = parse_resource_name(request_.resource_name());
        auto file = shared_.service.blob(*caller_, name->instance, name->blob.digest);
        if (!file.ok()) return status_of(file.refused());
        if (!file->has_value() || (*file)->size() != name->blob.size) return {grpc::StatusCode::NOT_FOUND, "not in the cache"};
        const int64_t size = static_cast<int64_t>(name->blob.size);
        if (request_.read_offset() < 0 || request_.read_offset() > size)
            return {grpc::StatusCode::OUT_OF_RANGE, "the offset is outside the blob"};
        if (request_.read_limit() < 0) return invalid("the limit is negative");
        if (request_.read_limit() != 0 && name->zstd) return invalid("a compressed blob is read to its end");
        file_ = std::move(**file);
        zstd_ = name->zstd;
        at_ = static_cast<uint64_t>(request_.read_offset());
        end_ = name->blob.size;
        if (request_.read_limit() != 0) end_ = std::min(end_, at_ + static_cast<uint64_t>(request_.read_limit()));
        return grpc::Status::OK;
    }

    void next() {
        if (zstd_ && sent_ < packed_.size()) {
            const uint64_t size = std::min<uint64_t>(piece, packed_.size() - sent_);
            response_.mutable_data()->assign(as_text(packed_).substr(sent_, size));
            sent_ += size;
            return send();
        }
        if (at_ == end_) return end(grpc::Status::OK);
        const uint64_t size = std::min(zstd_ ? frame : piece, end_ - at_);
        std::string& plain = zstd_ ? plain_ : *response_.mutable_data();
        plain.resize(size);
        if (!file_.read(at_, {reinterpret_cast<uint8_t*>(plain.data()), plain.size()}).ok())
            return end({grpc::StatusCode::INTERNAL, "the cache's disk failed"});
        at_ += size;
        if (!zstd_) return send();
        packed_ = zstd_compress(as_bytes(plain), level);
        sent_ = 0;
        next();
    }

    void send() {
        out_ += response_.data().size();
        writer_.Write(response_, tag());
    }

    StreamService& service_;
    bs::ReadRequest request_;
    grpc::ServerAsyncWriter<bs::ReadResponse> writer_{&context_};
    BlobFile file_;
    bool zstd_ = false;
    uint64_t at_ = 0, end_ = 0;
    std::string plain_;
    Bytes packed_;
    size_t sent_ = 0;
    bs::ReadResponse response_;
};

class WriteCall final : public Call {
public:
    WriteCall(CallContext& shared, grpc::ServerCompletionQueue& queue, StreamService& service)
        : Call(shared, queue, "Write"), service_(service) {
        service.RequestWrite(&context_, &reader_, &queue, &queue, tag());
    }

private:
    void wait_for_next() override { new WriteCall(shared_, queue_, service_); }
    bool begin_at_once() override {
        deadline_.set(shared_.options.patience);
        reader_.Read(&request_, tag());
        return true;
    }
    bool go_on_at_once(bool ok) override {
        const auto taken = [&]() -> grpc::Status {
            if (!ok) return invalid("the upload ended without finish_write");
            request_.DiscardUnknownFields();
            if (!name_) {
                if (grpc::Status named = name_it(); !named.ok()) return named;
            } else if (!request_.resource_name().empty() && request_.resource_name() != first_) {
                return invalid("the resource name changes within an upload");
            }
            // Memory is taken as the bytes arrive, not as they are announced.
            auto lease = shared_.service.lease(request_.data().size() * (name_->zstd ? 2 : 1));
            if (!lease.ok()) return status_of(lease.refused());
            lease_.join(std::move(*lease));
            return grpc::Status::OK;
        }();
        if (taken.ok()) return false;
        return end(taken), true;
    }
    void go_on(bool) override {
        if (!asked_) {
            asked_ = true;
            if (is_there()) return finish(name_->zstd ? -1 : static_cast<int64_t>(name_->blob.size));
        }
        if (const grpc::Status taken = take(); !taken.ok()) return end(taken);
        if (!request_.finish_write()) return reader_.Read(&request_, tag());
        store();
    }
    void end(const grpc::Status& status) override { reader_.FinishWithError(ended(status), tag()); }
    std::string subject() const override { return first_; }

    grpc::Status name_it() {
        const auto name = parse_resource_name(request_.resource_name());
        if (!name || !name->upload) return invalid("the resource name is none to write");
        if (grpc::Status s = shared_.enter(*caller_, name->instance, Role::cas_write); !s.ok()) return s;
        if (name->blob.size > shared_.service.limits().blob)
            return status_of(
                shared_.service.refuse(name->instance, *caller_, Refusal::too_large, "the blob is larger than the server takes"));
        name_ = *name;
        first_ = request_.resource_name();
        // The time of a whole upload, now that its size is known.
        deadline_.set(shared_.time_for(name->blob.size));
        return grpc::Status::OK;
    }

    bool is_there() const {
        if (!caller_->may(Role::read, name_->instance)) return false;
        const auto there = shared_.service.has_whole_blob(*caller_, name_->instance, name_->blob);
        return there.ok() && *there;
    }

    // A compressed blob may be a little larger on the wire than it is.
    uint64_t most() const { return name_->zstd ? name_->blob.size + name_->blob.size / 128 + 1024 : name_->blob.size; }

    grpc::Status take() {
        if (request_.write_offset() != static_cast<int64_t>(received_.size()))
            return invalid("the offset is not where the upload stands");
        if (request_.data().size() > most() - received_.size()) return invalid("more bytes than the blob has");
        const ByteView bytes = as_bytes(request_.data());
        received_.insert(received_.end(), bytes.begin(), bytes.end());
        in_ = received_.size();
        return grpc::Status::OK;
    }

    void store() {
        Bytes plain;
        if (name_->zstd) {
            auto lease = shared_.service.lease(name_->blob.size);
            if (!lease.ok()) return end(status_of(lease.refused()));
            lease_.join(std::move(*lease));
            if (zstd_unpack(received_, name_->blob.size, plain) != Unpacked::ok)
                return end(invalid("the bytes are no zstd of that size"));
        }
        const auto put = shared_.service.put_blob(*caller_, name_->instance, name_->blob, name_->zstd ? plain : received_);
        if (!put.ok()) return end(status_of(put.refused()));
        finish(static_cast<int64_t>(received_.size()));
    }

    void finish(int64_t committed) {
        response_.set_committed_size(committed);
        reader_.Finish(response_, ended(grpc::Status::OK), tag());
    }

    StreamService& service_;
    bs::WriteRequest request_;
    bs::WriteResponse response_;
    grpc::ServerAsyncReader<bs::WriteResponse, bs::WriteRequest> reader_{&context_};
    std::optional<ResourceName> name_;
    std::string first_;
    bool asked_ = false;  // whether the blob is there already
    Bytes received_;
    Service::Lease lease_;
};

class ByteStreamCalls final : public CallService {
public:
    explicit ByteStreamCalls(CallContext& context) : shared_(context) {}
    grpc::Service& service() override { return service_; }
    void serve(grpc::ServerCompletionQueue& queue) override {
        new ReadCall(shared_, queue, service_);
        new WriteCall(shared_, queue, service_);
        serve_unary(
            shared_, queue, "QueryWriteStatus", service_, &StreamService::RequestQueryWriteStatus,
            [this](const Caller& caller, const bs::QueryWriteStatusRequest& request) {
                const auto name = parse_resource_name(request.resource_name());
                if (!name || !name->upload) return invalid("the resource name is none to write");
                return shared_.enter(caller, name->instance, Role::read);
            },
            [this](const Caller& caller, const bs::QueryWriteStatusRequest& request, bs::QueryWriteStatusResponse& out) {
                return query(caller, request, out);
            });
    }

private:
    // Uploads are not resumed: one that was cut off begins again, so a blob is there in whole or not at all.
    grpc::Status query(const Caller& caller, const bs::QueryWriteStatusRequest& request, bs::QueryWriteStatusResponse& out) {
        const auto name = parse_resource_name(request.resource_name());
        const auto there = shared_.service.has_blob(caller, name->instance, name->blob);
        if (!there.ok()) return status_of(there.refused());
        out.set_complete(*there);
        out.set_committed_size(*there ? static_cast<int64_t>(name->blob.size) : 0);
        return grpc::Status::OK;
    }

    CallContext& shared_;
    StreamService service_;
};

}  // namespace

std::unique_ptr<CallService> make_byte_stream(CallContext& context) { return std::make_unique<ByteStreamCalls>(context); }

}  // namespace kiln
