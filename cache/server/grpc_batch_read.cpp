// Field numbers are those of BatchReadBlobsResponse, google.rpc.Status and Digest in cache/protocol/proto/.
#include "cache/server/grpc_batch_read.h"

#include "cache/protocol/wire_message.h"

namespace kiln {

namespace {

constexpr size_t worth_a_piece = 4096;  // below, a copy costs less than another piece in the socket's list

// A message in the making: text that is written here, and pieces of others' memory between.
class Pieces {
public:
    std::string& text() { return text_; }
    void add(grpc::Slice piece) { between_.emplace_back(text_.size(), std::move(piece)); }
    grpc::ByteBuffer take() const {
        const grpc::Slice all(text_);
        std::vector<grpc::Slice> pieces;
        pieces.reserve(2 * between_.size() + 1);
        size_t from = 0;
        for (const auto& [at, piece] : between_) {
            pieces.push_back(all.sub(from, at));
            pieces.push_back(piece);
            from = at;
        }
        pieces.push_back(all.sub(from, text_.size()));
        return {pieces.data(), pieces.size()};
    }

private:
    std::string text_;
    std::vector<std::pair<size_t, grpc::Slice>> between_;
};

void put_varint(std::string& out, uint64_t value) {
    for (; value >= 0x80; value >>= 7) out.push_back(static_cast<char>(value | 0x80));
    out.push_back(static_cast<char>(value));
}

size_t varint_size(uint64_t value) {
    size_t size = 1;
    for (; value >= 0x80; value >>= 7) ++size;
    return size;
}

void put_field(std::string& out, uint32_t number, uint64_t size) {
    out.push_back(static_cast<char>(number << 3 | 2));
    put_varint(out, size);
}

grpc::Slice piece_of(std::shared_ptr<const Bytes> bytes) {
    using Holder = std::shared_ptr<const Bytes>;
    auto* const holder = new Holder(std::move(bytes));
    return {const_cast<uint8_t*>((*holder)->data()), (*holder)->size(), [](void* held) { delete static_cast<Holder*>(held); },
            holder};
}

constexpr uint64_t most_head = 112;  // bytes of one: a name, a status with the longest of our messages, tags and sizes

// Everything of one response but the bytes of its data, which stand last.
void put_head(std::string& out, const BlobName& name, const grpc::Status& status, uint64_t data) {
    WireWriter code;
    if (!status.ok()) {
        code.number(1, static_cast<uint64_t>(status.error_code()));
        code.bytes(2, as_bytes(status.error_message()));
    }
    const Bytes said = code.take();
    const std::string hash = name.digest.hex();
    const uint64_t named = 2 + hash.size() + (name.size == 0 ? 0 : 1 + varint_size(name.size));
    const uint64_t size = 1 + varint_size(named) + named + 1 + varint_size(said.size()) + said.size() +
                          (data == 0 ? 0 : 1 + varint_size(data) + data);
    put_field(out, 1, size);
    put_field(out, 1, named);
    put_field(out, 1, hash.size());
    out += hash;
    if (name.size != 0) {
        out.push_back(2 << 3);
        put_varint(out, name.size);
    }
    put_field(out, 3, said.size());
    out += as_text(said);
    if (data != 0) put_field(out, 2, data);
}

void put_blob(Pieces& out, const BlobName& name, Answer<std::optional<BlobFile>> found) {
    const auto failed = [&](const grpc::Status& status) { put_head(out.text(), name, status, 0); };
    if (!found.ok()) return failed(status_of(found.refused()));
    if (!found->has_value() || (*found)->size() != name.size) return failed({grpc::StatusCode::NOT_FOUND, "not in the cache"});
    const BlobFile& file = **found;
    if (file.shared_memory() || name.size == 0) {
        put_head(out.text(), name, grpc::Status::OK, name.size);
        if (name.size < worth_a_piece)
            out.text() += as_text(file.memory());
        else
            out.add(piece_of(file.shared_memory()));
        return;
    }
    grpc::Slice bytes(static_cast<size_t>(name.size));
    if (!file.read(0, {const_cast<uint8_t*>(bytes.begin()), bytes.size()}).ok())
        return failed({grpc::StatusCode::INTERNAL, "the cache's disk failed"});
    put_head(out.text(), name, grpc::Status::OK, name.size);
    out.add(std::move(bytes));
}

class BatchReadCall final : public Call {
public:
    BatchReadCall(CallContext& shared, grpc::ServerCompletionQueue& queue, const AskForBatchRead& ask)
        : Call(shared, queue, "BatchReadBlobs"), ask_(ask) {
        ask_(&context_, &request_, &writer_, &queue, &queue, tag());
    }

private:
    void wait_for_next() override { new BatchReadCall(shared_, queue_, ask_); }
    bool begin_at_once() override {
        in_ = request_.Length();
        if (const grpc::Status s = parse(); !s.ok()) return end(s), true;
        if (const grpc::Status held = hold_answer(total_ + most_head * names_.size()); !held.ok()) return end(held), true;
        if (total_ > small_batch || names_.size() > small_count) return false;
        bool slow = false;
        if (!read(&slow)) return false;
        return finish(), true;
    }
    void begin() override {
        if (read(nullptr)) return finish();
        end(stopping());
    }
    void end(const grpc::Status& status) override {
        ended(status);
        forget();
        writer_.FinishWithError(status, tag());
    }
    // Who reads the answer slowly does not keep the question here.
    void forget() {
        request_.Clear();
        reapi::BatchReadBlobsRequest().Swap(&asked_);
        lease_ = Service::Lease();
    }
    std::string subject() const override { return asked_.instance_name(); }

    grpc::Status parse() {
        using Request = reapi::BatchReadBlobsRequest;
        if (!grpc::SerializationTraits<Request>::Deserialize(&request_, &asked_).ok()) return invalid("no BatchReadBlobsRequest");
        if (grpc::Status s = check_function(asked_.digest_function()); !s.ok()) return s;
        auto reads = shared_.service.reads(*caller_, asked_.instance_name());
        if (!reads.ok()) return status_of(reads.refused());
        reads_.emplace(std::move(*reads));
        if (asked_.digests_size() > grpc_most_entries) return invalid("more blobs than one message may name");
        request_.Clear();
        auto lease = shared_.service.lease(asked_.SpaceUsedLong());
        if (!lease.ok()) return status_of(lease.refused());
        lease_ = std::move(*lease);
        constexpr auto most = static_cast<uint64_t>(grpc_most_batch);
        names_.reserve(static_cast<size_t>(asked_.digests_size()));
        for (const reapi::Digest& digest : asked_.digests()) {
            const auto name = name_of(digest);
            if (!name) return invalid("a digest is none");
            if (name->size > most || (total_ += name->size) > most)
                return invalid("the batch is larger than max_batch_total_size_bytes");
            names_.push_back(*name);
        }
        return grpc::Status::OK;
    }

    // False: the next blob must be hashed first, which `slow` does not want, or the server is stopping.
    bool read(bool* slow) {
        for (; next_ < names_.size(); ++next_) {
            if (shared_.ending) return false;
            auto found = reads_->open(names_[next_].digest, slow, 0);
            if (slow != nullptr && *slow) return false;
            put_blob(pieces_, names_[next_], std::move(found));
        }
        return true;
    }

    void finish() {
        reads_.reset();  // counted by the time that the client has its answer
        const grpc::ByteBuffer response = pieces_.take();
        if (response.Length() > static_cast<size_t>(grpc_most_message))
            return end(invalid("the answer does not fit into a message"));
        out_ = response.Length();
        const grpc::Status& done = ended(grpc::Status::OK);
        forget();
        writer_.Finish(response, done, tag());
    }

    // What is read on the thread that serves sockets.
    static constexpr uint64_t small_batch = 256 * 1024;
    static constexpr size_t small_count = 256;

    const AskForBatchRead ask_;
    Service::Lease lease_;
    grpc::ByteBuffer request_;
    grpc::ServerAsyncResponseWriter<grpc::ByteBuffer> writer_{&context_};
    reapi::BatchReadBlobsRequest asked_;
    std::optional<Service::BlobReads> reads_;
    std::vector<BlobName> names_;
    uint64_t total_ = 0;
    size_t next_ = 0;
    Pieces pieces_;
};

}  // namespace

void serve_batch_read(CallContext& shared, grpc::ServerCompletionQueue& queue, const AskForBatchRead& ask) {
    new BatchReadCall(shared, queue, ask);
}

}  // namespace kiln
