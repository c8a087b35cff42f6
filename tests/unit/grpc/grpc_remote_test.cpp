#include <gtest/gtest.h>

#include <numeric>

#include "liar.h"

namespace kiln::testing {
namespace {

using Kind = RemoteAnswer::Kind;
using namespace std::chrono_literals;

Bytes bytes_of(size_t size, uint8_t seed) {
    Bytes out(size);
    for (size_t i = 0; i < size; ++i) out[i] = static_cast<uint8_t>(i * 31 + (i >> 8) * 7 + seed);
    return out;
}

std::string text_of(const Bytes& bytes) { return std::string(as_text(bytes)); }

struct Sample {
    Bytes bytes;
    Digest digest;
    explicit Sample(size_t size, uint8_t seed = 1) : bytes(bytes_of(size, seed)), digest(sha256(bytes)) {}
    RemoteBlob blob() const { return {digest, bytes.size()}; }
    RemoteUpload upload() const { return {digest, bytes}; }
};

RemoteAnswer get(RemoteStore& store, const RemoteBlob& blob) { return store.get_blobs({&blob, 1}).front(); }
RemoteAnswer get_action(RemoteStore& store, const Digest& key) { return store.get_actions({&key, 1}).front(); }
RemoteAnswer put(RemoteStore& store, const RemoteUpload& upload) { return store.put_blobs({&upload, 1}).front(); }
RemoteAnswer put_action(RemoteStore& store, const RemoteUpload& upload) { return store.put_actions({&upload, 1}).front(); }

Bytes action_bytes(const std::string& frame, const Digest& blob) {
    reapi::ActionResult result;
    result.set_stdout_raw(frame);
    auto& file = *result.add_output_files();
    file.set_path("blob/" + blob.hex());
    file.mutable_digest()->set_hash(blob.hex());
    file.mutable_digest()->set_size_bytes(3);
    const std::string all = result.SerializeAsString();
    return Bytes(all.begin(), all.end());
}

TEST(GrpcRemote, BlobsOfAllSizesThereAndBack) {
    Liar server;
    const auto store = server.client(20s, "a-token-of-the-test");
    std::vector<Sample> samples;
    for (const size_t size : {size_t{0}, size_t{1}, size_t{50'000}, size_t{2'000'000}, size_t{2'000'001}, size_t{9'000'000}})
        samples.emplace_back(size, static_cast<uint8_t>(size));
    std::vector<RemoteBlob> blobs;
    std::vector<RemoteUpload> uploads;
    for (const Sample& sample : samples) {
        blobs.push_back(sample.blob());
        uploads.push_back(sample.upload());
    }
    for (const RemoteAnswer& answer : store->find_blobs(blobs)) EXPECT_EQ(answer.kind, Kind::absent);
    for (const RemoteAnswer& answer : store->get_blobs(blobs)) EXPECT_EQ(answer.kind, Kind::absent);
    server.batches = server.streams = 0;
    for (const RemoteAnswer& answer : store->put_blobs(uploads)) EXPECT_EQ(answer.kind, Kind::found) << answer.problem;
    EXPECT_EQ(server.batches, 2u);  // the two that do not fit into one message
    EXPECT_EQ(server.streams, 1u);
    for (const RemoteAnswer& answer : store->find_blobs(blobs)) EXPECT_EQ(answer.kind, Kind::found);
    blobs.push_back(blobs.front());  // twice wanted, once asked
    const auto got = store->get_blobs(blobs);
    for (size_t i = 0; i < got.size(); ++i) {
        EXPECT_EQ(got[i].kind, Kind::found) << i << got[i].problem;
        EXPECT_EQ(got[i].bytes, samples[i % samples.size()].bytes) << i;
    }
    EXPECT_EQ(server.instance, "team/main");
    EXPECT_EQ(server.token, "Bearer a-token-of-the-test");
    EXPECT_EQ(get(*store, {samples[1].digest}).kind, Kind::absent);  // of no known size
}

TEST(GrpcRemote, ManyBlobsGoInFewCalls) {
    Liar server;
    const auto store = server.client();
    std::vector<Sample> samples;
    std::vector<RemoteBlob> blobs;
    std::vector<RemoteUpload> uploads;
    for (int i = 0; i < 200; ++i) samples.emplace_back(1000 + static_cast<size_t>(i), static_cast<uint8_t>(i));
    for (const Sample& sample : samples) {
        blobs.push_back(sample.blob());
        uploads.push_back(sample.upload());
    }
    for (const RemoteAnswer& answer : store->put_blobs(uploads)) EXPECT_EQ(answer.kind, Kind::found);
    const auto got = store->get_blobs(blobs);
    for (size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i].bytes, samples[i].bytes);
    EXPECT_EQ(server.calls, 3u);  // what it can do, one write, one read
}

TEST(GrpcRemote, BatchesAreAsSmallAsTheServerWants) {
    Liar server;
    server.capabilities.mutable_cache_capabilities()->set_max_batch_total_size_bytes(5000);
    const auto store = server.client();
    const Sample a(4000, 1), b(4000, 2), large(6000, 3);
    const RemoteUpload uploads[] = {a.upload(), b.upload(), large.upload()};
    for (const RemoteAnswer& answer : store->put_blobs(uploads)) EXPECT_EQ(answer.kind, Kind::found);
    EXPECT_EQ(server.batches, 2u);
    EXPECT_EQ(server.streams, 1u);
}

TEST(GrpcRemote, ActionsThereAndBackAndTheFirstOneStays) {
    Liar server;
    const auto store = server.client();
    const Sample blob(3);
    const Digest key = sha256(as_bytes(std::string_view("key")));
    EXPECT_EQ(get_action(*store, key).kind, Kind::absent);
    const Bytes first = action_bytes("frame", blob.digest), other = action_bytes("other", blob.digest);
    EXPECT_EQ(put_action(*store, {key, first}).kind, Kind::found);
    EXPECT_EQ(put_action(*store, {key, first}).kind, Kind::found);
    EXPECT_EQ(put_action(*store, {key, other}).kind, Kind::absent);
    const RemoteAnswer got = get_action(*store, key);
    EXPECT_EQ(got.kind, Kind::found);
    EXPECT_EQ(got.bytes, first);
}

TEST(GrpcRemote, WhichServersItSpeaksTo) {
    const struct {
        int low_major, low, high_major, high;
        bool good;
    } cases[] = {{2, 0, 2, 0, true}, {2, 0, 2, 11, true},   {2, 1, 2, 12, true}, {2, 3, 2, 12, true}, {2, 11, 2, 20, true},
                 {1, 0, 2, 0, true}, {2, 12, 2, 13, false}, {3, 0, 3, 1, false}, {1, 0, 1, 9, false}};
    for (const auto& c : cases) {
        Liar server;
        server.versions(c.low_major, c.low, c.high_major, c.high);
        const auto store = server.client();
        EXPECT_EQ(put(*store, Sample(10).upload()).kind, c.good ? Kind::found : Kind::denied) << c.low_major << "." << c.low;
        EXPECT_EQ(server.blobs.size(), c.good ? 1u : 0u);
    }
    Liar other;
    other.capabilities.mutable_cache_capabilities()->set_digest_functions(0, reapi::DigestFunction::BLAKE3);
    EXPECT_EQ(get(*other.client(), Sample(10).blob()).kind, Kind::denied);
    Liar old;  // says nothing about itself
    old.on_capabilities = [](ServerContext*, reapi::ServerCapabilities*) {
        return grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "");
    };
    EXPECT_EQ(put(*old.client(), Sample(10).upload()).kind, Kind::found);
}

TEST(GrpcRemote, ATokenForReadingIsNotTriedForWriting) {
    Liar server;
    server.capabilities.mutable_cache_capabilities()->mutable_action_cache_update_capabilities()->set_update_enabled(false);
    const Sample sample(100);
    server.blobs[sample.digest.hex()] = text_of(sample.bytes);
    const auto store = server.client();
    EXPECT_EQ(put(*store, sample.upload()).kind, Kind::denied);
    EXPECT_EQ(put_action(*store, {sample.digest, action_bytes("x", sample.digest)}).kind, Kind::denied);
    EXPECT_EQ(server.calls, 1u);
    EXPECT_EQ(get(*store, sample.blob()).bytes, sample.bytes);
}

// Every lie ends by itself, as `failed` or as bytes that the caller will find wrong. The control is BlobsOfAllSizes.
TEST(GrpcRemote, LiesInBatches) {
    const Sample sample(1000);
    const auto answer = [&](auto lie) {
        Liar server;
        server.on_read = lie;
        const RemoteAnswer got = get(*server.client(1s), sample.blob());
        EXPECT_NE(got.bytes, sample.bytes);
        return got;
    };
    const auto ok = grpc::Status::OK;
    EXPECT_EQ(answer([&](ServerContext*, const auto&, auto*) { return ok; }).kind, Kind::failed);  // nothing
    EXPECT_EQ(answer([&](ServerContext*, const auto& asked, auto* out) {
                  auto& one = *out->add_responses();
                  *one.mutable_digest() = asked.digests(0);
                  one.mutable_digest()->set_hash(std::string(64, 'a'));  // another
                  return ok;
              }).kind,
              Kind::failed);
    EXPECT_EQ(answer([&](ServerContext*, const auto& asked, auto* out) {  // other bytes, believed by nobody above
                  auto& one = *out->add_responses();
                  *one.mutable_digest() = asked.digests(0);
                  one.set_data("other");
                  return ok;
              })
                  .kind,
              Kind::found);
    EXPECT_EQ(answer([&](ServerContext*, const auto& asked, auto* out) {
                  auto& one = *out->add_responses();
                  *one.mutable_digest() = asked.digests(0);
                  one.set_data(std::string(5'000'000, 'x'));
                  return ok;
              }).kind,
              Kind::failed);  // a message longer than one may be
    EXPECT_EQ(answer([&](ServerContext* context, const auto& asked, auto* out) {
                  context->set_compression_algorithm(GRPC_COMPRESS_GZIP);
                  auto& one = *out->add_responses();
                  *one.mutable_digest() = asked.digests(0);
                  one.set_data(std::string(3'900'000, '\0'));
                  return ok;
              }).kind,
              Kind::failed);  // compressed without being asked
    EXPECT_EQ(answer([&](ServerContext* context, const auto&, auto*) {
                  for (int i = 0; i < 200; ++i) context->AddTrailingMetadata("more-" + std::to_string(i), std::string(1000, 'm'));
                  return ok;
              }).kind,
              Kind::failed);
    EXPECT_EQ(
        answer([&](ServerContext*, const auto&, auto*) { return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, ""); }).kind,
        Kind::denied);
    EXPECT_EQ(
        answer([&](ServerContext*, const auto&, auto*) { return grpc::Status(grpc::StatusCode::UNAUTHENTICATED, ""); }).kind,
        Kind::denied);
    EXPECT_EQ(answer([&](ServerContext*, const auto&, auto*) { return grpc::Status(grpc::StatusCode::INTERNAL, ""); }).kind,
              Kind::failed);
}

TEST(GrpcRemote, LiesInStreams) {
    const Sample sample(5'000'000);
    const auto answer = [&](auto lie, std::chrono::milliseconds timeout = 5s) {
        Liar server;
        server.on_stream = lie;
        const RemoteAnswer got = get(*server.client(timeout), sample.blob());
        EXPECT_NE(got.bytes, sample.bytes);
        return got;
    };
    std::atomic<size_t> pieces{0};
    const RemoteAnswer endless = answer([&](ServerContext*, grpc::ServerWriter<google::bytestream::ReadResponse>* out) {
        google::bytestream::ReadResponse piece;
        piece.set_data(std::string(1'000'000, 'e'));
        while (out->Write(piece)) ++pieces;
        return grpc::Status::OK;
    });
    EXPECT_EQ(endless.kind, Kind::failed);
    EXPECT_NE(endless.problem.find("longer"), std::string::npos) << endless.problem;
    EXPECT_LT(pieces, 100u);
    const RemoteAnswer part = answer([&](ServerContext*, auto* out) {
        google::bytestream::ReadResponse piece;
        piece.set_data("part");
        out->Write(piece);
        return grpc::Status::OK;
    });
    EXPECT_EQ(text_of(part.bytes), "part");  // refused above: it has another digest
}

TEST(GrpcRemote, AServerThatNeverAnswers) {
    Liar server;
    const Sample sample(1000);
    std::vector<Digest> keys(100);
    for (size_t i = 0; i < keys.size(); ++i) keys[i].bytes[0] = static_cast<uint8_t>(i);
    server.on_get_action = [&](ServerContext* context, auto*) {
        server.hang(context);
        return grpc::Status::OK;
    };
    const auto store = server.client(150ms);
    const auto answers = store->get_actions(keys);
    size_t waited = 0;
    for (const RemoteAnswer& answer : answers) {
        EXPECT_EQ(answer.kind, Kind::failed);
        waited += answer.waited ? 1 : 0;
    }
    EXPECT_GT(waited, 0u);
    EXPECT_LT(server.calls, keys.size());                       // given up before all had been tried
    EXPECT_EQ(put(*store, sample.upload()).kind, Kind::found);  // asked again, it may be well
}

TEST(GrpcRemote, TheEndEndsWhatIsUnderWay) {
    Liar server;
    std::atomic<bool> interrupted{false};
    server.on_get_action = [&](ServerContext* context, auto*) {
        server.hang(context);
        return grpc::Status::OK;
    };
    const auto store = server.client(1h, {}, &interrupted);
    std::thread later([&] {
        std::this_thread::sleep_for(50ms);
        interrupted = true;
    });
    EXPECT_EQ(get_action(*store, {}).kind, Kind::failed);
    later.join();
    interrupted = false;
    store->end_at(std::chrono::steady_clock::now() + 50ms);
    EXPECT_EQ(get_action(*store, {}).kind, Kind::failed);
    const size_t calls = server.calls;
    EXPECT_EQ(put(*store, Sample(10).upload()).kind, Kind::failed);
    EXPECT_EQ(server.calls, calls);
}

TEST(GrpcRemote, LimitsBeforeMemory) {
    Liar server;
    RemoteLimits limits;
    limits.blob = 1000;
    limits.action = 1000;
    const Sample sample(1001);
    server.blobs[sample.digest.hex()] = text_of(sample.bytes);
    server.on_get_action = [&](ServerContext*, auto* out) {
        out->set_stdout_raw(std::string(2000, 'r'));
        return grpc::Status::OK;
    };
    const auto store = server.client(20s, {}, nullptr, limits);
    EXPECT_EQ(get(*store, sample.blob()).kind, Kind::failed);
    EXPECT_EQ(server.asked, 0u);
    const RemoteAnswer action = get_action(*store, {});
    EXPECT_EQ(action.kind, Kind::failed);
    EXPECT_TRUE(action.bytes.empty());
}

TEST(GrpcRemote, AServersWordsAreNotRepeated) {
    Liar server;
    server.on_get_action = [](ServerContext*, auto*) {
        return grpc::Status(grpc::StatusCode::INTERNAL, "you sent \x1b[31m the-secret-token");
    };
    const RemoteAnswer answer = get_action(*server.client(20s, "the-secret-token"), {});
    EXPECT_EQ(answer.kind, Kind::failed);
    EXPECT_EQ(answer.problem, "it answered gRPC status 13");
}

TEST(GrpcRemote, Uploads) {
    const Sample large(5'000'000);
    Liar has;
    has.has_already = true;  // ends the stream at its first message
    EXPECT_EQ(put(*has.client(), large.upload()).kind, Kind::found);
    Liar less;
    less.takes_less = 1;
    EXPECT_EQ(put(*less.client(), large.upload()).kind, Kind::failed);
    Liar forgets;
    forgets.on_put = [](ServerContext*, const auto&, auto*) { return grpc::Status::OK; };
    EXPECT_EQ(put(*forgets.client(), Sample(10).upload()).kind, Kind::failed);
    Liar full;
    full.on_put = [](ServerContext*, const auto& asked, auto* out) {
        for (const auto& one : asked.requests()) {
            auto& said = *out->add_responses();
            *said.mutable_digest() = one.digest();
            said.mutable_status()->set_code(8);
        }
        return grpc::Status::OK;
    };
    EXPECT_EQ(put(*full.client(), Sample(10).upload()).kind, Kind::failed);
}

TEST(GrpcRemote, NobodyThere) {
    auto server = std::make_unique<Liar>();
    const auto store = server->client(20s);
    EXPECT_EQ(put(*store, Sample(10).upload()).kind, Kind::found);
    server->stop();
    EXPECT_EQ(get(*store, Sample(10).blob()).kind, Kind::failed);
}

}  // namespace
}  // namespace kiln::testing
