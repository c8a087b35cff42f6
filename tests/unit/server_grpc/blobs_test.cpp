// Blobs in batches and streams, well-behaved and not. Every refusal stands beside the call that passes.
#include "tests/unit/server_grpc/front.h"

namespace kiln {
namespace {

TEST_F(Grpc, StoresABatchOfBlobsThatMatchTheirNamesAndNoOther) {
    start();
    const std::string bytes = "the bytes of a module";
    const BlobName name = named(bytes);
    EXPECT_TRUE(missing(name));
    re::Digest wrong = digest(named("other bytes"));
    wrong.set_size_bytes(static_cast<int64_t>(bytes.size()));
    EXPECT_EQ(put(wrong, bytes), StatusCode::INVALID_ARGUMENT);
    for (const std::string& hash :
         {std::string("../../../../tmp/evil"), name.digest.hex().substr(1), name.digest.hex() + "0", std::string(),
          std::string(64, 'F'), "/" + name.digest.hex().substr(1), std::string(64, '\0')}) {
        re::Digest bad = digest(name);
        bad.set_hash(hash);
        EXPECT_EQ(put(bad, bytes), StatusCode::INVALID_ARGUMENT) << hash;
    }
    for (const int64_t size : {int64_t{-1}, int64_t{0}, static_cast<int64_t>(bytes.size()) - 1, INT64_MAX, INT64_MIN}) {
        re::Digest bad = digest(name);
        bad.set_size_bytes(size);
        EXPECT_EQ(put(bad, bytes), StatusCode::INVALID_ARGUMENT) << size;
    }
    EXPECT_TRUE(missing(name));
    EXPECT_EQ(put(digest(name), bytes), StatusCode::OK);
    EXPECT_FALSE(missing(name));
    // Another size of a blob that is there is another blob, and a lie.
    re::Digest bad = digest(name);
    bad.set_size_bytes(5);
    EXPECT_EQ(put(bad, bytes), StatusCode::INVALID_ARGUMENT);
    EXPECT_TRUE(missing({name.digest, 5}));
    EXPECT_EQ(store_->stats()->blob.entries, 1u);
}

TEST_F(Grpc, HasTheEmptyBlobAtAllTimes) {
    start();
    EXPECT_FALSE(missing(named("")));
    std::string out;
    EXPECT_TRUE(download(read_name("main", named("")), out).ok());
    EXPECT_EQ(put(digest(named("")), ""), StatusCode::OK);
}

TEST_F(Grpc, UnpacksCompressedBlobsWithinTheirSize) {
    start();
    const std::string bytes(1'000'000, 'z');
    const Bytes packed = zstd_compress(as_bytes(bytes), 3);
    EXPECT_EQ(put(digest({named(bytes).digest, 1000}), std::string(as_text(packed)), re::Compressor::ZSTD),
              StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(put(digest(named(bytes)), "no zstd", re::Compressor::ZSTD), StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(put(digest(named(bytes)), std::string(as_text(packed)), re::Compressor::BROTLI), StatusCode::INVALID_ARGUMENT);
    EXPECT_TRUE(missing(named(bytes)));
    EXPECT_EQ(put(digest(named(bytes)), std::string(as_text(packed)), re::Compressor::ZSTD), StatusCode::OK);
    EXPECT_FALSE(missing(named(bytes)));
}

TEST_F(Grpc, ReadsBatchesWithinTheAnnouncedSize) {
    start();
    re::BatchReadBlobsRequest request;
    request.set_instance_name("main");
    std::vector<std::string> all;
    for (int i = 0; i < 40; ++i) {
        all.push_back(std::string(60'000, static_cast<char>('a' + i % 26)) + std::to_string(i));
        ASSERT_EQ(put(digest(named(all.back())), all.back()), StatusCode::OK);
        *request.add_digests() = digest(named(all.back()));
    }
    *request.add_digests() = digest(named("never stored"));
    re::BatchReadBlobsResponse response;
    ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), request, &response).ok());
    ASSERT_EQ(response.responses_size(), 41);
    for (int i = 0; i < 40; ++i) EXPECT_EQ(response.responses(i).data(), all[static_cast<size_t>(i)]);
    EXPECT_EQ(response.responses(40).status().code(), StatusCode::NOT_FOUND);
    // A second time, from memory or a trusted file, and in a batch that is small enough not to leave the thread of the sockets.
    for (const int count : {40, 3}) {
        request.mutable_digests()->DeleteSubrange(count, request.digests_size() - count);
        ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), request, &response).ok());
        ASSERT_EQ(response.responses_size(), count);
        for (int i = 0; i < count; ++i) {
            EXPECT_EQ(response.responses(i).data(), all[static_cast<size_t>(i)]);
            EXPECT_EQ(response.responses(i).digest().SerializeAsString(), request.digests(i).SerializeAsString());
        }
    }
    // Sizes on both sides of what is copied and what is kept in memory, the empty blob, and one of another size than it has.
    request.clear_digests();
    all.clear();
    for (const size_t size : {size_t{0}, size_t{1}, size_t{4095}, size_t{4096}, size_t{32'768}, size_t{32'769}}) {
        all.push_back(std::string(size, 'k'));
        ASSERT_EQ(put(digest(named(all.back())), all.back()), StatusCode::OK);
        *request.add_digests() = digest(named(all.back()));
    }
    request.add_digests()->CopyFrom(digest({named(all[1]).digest, 2}));
    for (int time = 0; time < 3; ++time) {
        ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), request, &response).ok());
        ASSERT_EQ(response.responses_size(), 7);
        for (size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(response.responses(static_cast<int>(i)).data() == all[i]);
        EXPECT_EQ(response.responses(6).status().code(), StatusCode::NOT_FOUND);
        std::this_thread::sleep_for(std::chrono::milliseconds(60));  // a file must be older than a tick to be trusted
    }
    EXPECT_EQ(service_->counters().total().blob_misses, 1u);  // the blob that was never stored
    request.add_digests()->CopyFrom(digest({named("x").digest, grpc_most_batch}));
    EXPECT_EQ(blobs_->BatchReadBlobs(context().get(), request, &response).error_code(), StatusCode::INVALID_ARGUMENT);
}

TEST_F(Grpc, RefusesAMessageThatIsTooLargeBeforeItIsRead) {
    start();
    const std::string bytes(5 * 1024 * 1024, 'b');
    EXPECT_EQ(put(digest(named(bytes)), bytes), StatusCode::RESOURCE_EXHAUSTED);
    const std::string less(grpc_most_batch - 4096, 'b');
    EXPECT_EQ(put(digest(named(less)), less), StatusCode::OK);
}

TEST_F(Grpc, StreamsBlobsBothWays) {
    start();
    std::string bytes;
    for (int64_t i = 0; bytes.size() < 5'000'000; ++i) bytes += std::to_string(i * 7919) + " ";
    const BlobName name = named(bytes);
    int64_t committed = 0;
    ASSERT_TRUE(upload({upload_name("main", "u1", name), bytes}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(bytes.size()));
    std::string out;
    ASSERT_TRUE(download(read_name("main", name), out).ok());
    EXPECT_TRUE(out == bytes);
    ASSERT_TRUE(download(read_name("main", name), out, 1'234'567, 4'321).ok());
    EXPECT_EQ(out, bytes.substr(1'234'567, 4'321));
    ASSERT_TRUE(download(read_name("main", name), out, static_cast<int64_t>(bytes.size())).ok());
    EXPECT_EQ(out, "");
    EXPECT_EQ(download(read_name("main", name), out, static_cast<int64_t>(bytes.size()) + 1).error_code(),
              StatusCode::OUT_OF_RANGE);
    EXPECT_EQ(download(read_name("main", name), out, -1).error_code(), StatusCode::OUT_OF_RANGE);
    EXPECT_EQ(download(read_name("main", name), out, 0, -1).error_code(), StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(download(read_name("main", {name.digest, 7}), out).error_code(), StatusCode::NOT_FOUND);
    const std::string packed_name = "main/compressed-blobs/zstd/" + name.digest.hex() + "/" + std::to_string(name.size);
    ASSERT_TRUE(download(packed_name, out).ok());
    EXPECT_LT(out.size(), bytes.size());
    Bytes plain;
    ASSERT_EQ(zstd_unpack(as_bytes(out), bytes.size(), plain), Unpacked::ok);
    EXPECT_TRUE(as_text(plain) == bytes);
    // What is there already is not sent again.
    ASSERT_TRUE(upload({upload_name("main", "u2", name), bytes}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(bytes.size()));
}

TEST_F(Grpc, TakesACompressedUpload) {
    start();
    const std::string bytes(3'000'000, 'q');
    const BlobName name = named(bytes);
    const std::string packed(as_text(zstd_compress(as_bytes(bytes), 3)));
    const std::string to = "main/uploads/u/compressed-blobs/zstd/" + name.digest.hex() + "/" + std::to_string(name.size);
    EXPECT_EQ(upload({"main/uploads/u/compressed-blobs/zstd/" + name.digest.hex() + "/1000", packed}).error_code(),
              StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(upload({to, packed.substr(0, packed.size() - 3)}).error_code(), StatusCode::INVALID_ARGUMENT);
    EXPECT_TRUE(missing(name));
    int64_t committed = 0;
    ASSERT_TRUE(upload({to, packed}, &committed).ok());
    EXPECT_EQ(committed, static_cast<int64_t>(packed.size()));
    EXPECT_FALSE(missing(name));
    ASSERT_TRUE(upload({to, packed}, &committed).ok());
    EXPECT_EQ(committed, -1);
}

TEST_F(Grpc, AnUploadThatIsNotWholeLeavesNothing) {
    start();
    const std::string bytes(300'000, 'w');
    const BlobName name = named(bytes);
    const std::string to = upload_name("main", "u", name);
    const auto refused = [&](const Upload& u) {
        EXPECT_EQ(upload(u).error_code(), StatusCode::INVALID_ARGUMENT) << u.name << " " << u.bytes.size();
    };
    refused({to, bytes, 100'000, false});
    refused({to, bytes.substr(1)});
    refused({to, bytes + "w"});
    refused({to, std::string(300'000, 'v')});
    refused({to, bytes, 100'000, true, 1});
    refused({to, bytes, 100'000, true, 0, upload_name("main", "other", name)});
    refused({read_name("main", name), bytes});
    refused({"", bytes});
    refused({"main/uploads/u/blobs/../../etc/passwd/300000", bytes});
    refused({"main/uploads/u/compressed-blobs/brotli/" + name.digest.hex() + "/300000", bytes});
    EXPECT_TRUE(missing(name));
    EXPECT_EQ(store_->stats()->entries().entries, 0u);
    bs::QueryWriteStatusRequest ask;
    ask.set_resource_name(to);
    bs::QueryWriteStatusResponse state;
    ASSERT_TRUE(streams_->QueryWriteStatus(context().get(), ask, &state).ok());
    EXPECT_FALSE(state.complete());
    EXPECT_EQ(state.committed_size(), 0);
    EXPECT_TRUE(upload({to, bytes}).ok());
    ASSERT_TRUE(streams_->QueryWriteStatus(context().get(), ask, &state).ok());
    EXPECT_TRUE(state.complete());
    server_.reset();  // a client hears of a call's end before the call is taken apart
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, RefusesABlobBeyondTheLimitFromItsNameAlone) {
    ServiceLimits limits;
    limits.blob = 1'000'000;
    start({}, nullptr, limits);
    EXPECT_EQ(upload({upload_name("main", "u", {named("x").digest, 1'000'001}), "x"}).error_code(),
              StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(upload({upload_name("main", "u", {named("x").digest, INT64_MAX}), "x"}).error_code(),
              StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_TRUE(upload({upload_name("main", "u", named("x")), "x"}).ok());
}

TEST_F(Grpc, EndsAnUploadThatTakesTooLong) {
    GrpcOptions options;
    options.patience = std::chrono::seconds(1);
    start(options);
    bs::WriteResponse response;
    const auto held = context();
    auto writer = streams_->Write(held.get(), &response);
    bs::WriteRequest request;
    request.set_resource_name(upload_name("main", "u", named("abc")));
    request.set_data("a");
    ASSERT_TRUE(writer->Write(request));
    EXPECT_EQ(writer->Finish().error_code(), StatusCode::CANCELLED);  // by the server: our own deadline is a minute away
    EXPECT_TRUE(upload({upload_name("main", "u", named("abc")), "abc"}).ok());
}

TEST_F(Grpc, WalksATree) {
    start();
    const auto keep = [&](const re::Directory& d) {
        const std::string bytes = d.SerializeAsString();
        EXPECT_EQ(put(digest(named(bytes)), bytes), StatusCode::OK);
        return named(bytes);
    };
    re::Directory leaf, middle, root;
    leaf.add_files()->set_name("f");
    const BlobName leaf_name = keep(leaf);
    auto& node = *middle.add_directories();
    node.set_name("leaf");
    *node.mutable_digest() = digest(leaf_name);
    const BlobName middle_name = keep(middle);
    for (const char* where : {"a", "b"}) {  // the same one twice, and one that nobody stored
        auto& below = *root.add_directories();
        below.set_name(where);
        *below.mutable_digest() = digest(middle_name);
    }
    *root.add_directories()->mutable_digest() = digest(named("gone"));
    const BlobName root_name = keep(root);
    const auto walk = [&](const BlobName& from, int& directories) {
        re::GetTreeRequest request;
        request.set_instance_name("main");
        *request.mutable_root_digest() = digest(from);
        const auto held = context();
        auto reader = blobs_->GetTree(held.get(), request);
        re::GetTreeResponse page;
        directories = 0;
        while (reader->Read(&page)) directories += page.directories_size();
        return reader->Finish().error_code();
    };
    int directories = 0;
    EXPECT_EQ(walk(root_name, directories), StatusCode::OK);
    EXPECT_EQ(directories, 3);
    EXPECT_EQ(walk(named("gone"), directories), StatusCode::NOT_FOUND);
}

}  // namespace
}  // namespace kiln
