// kiln-cached's gRPC front as its clients meet it, well-behaved and not. Every refusal stands beside the call that passes.
#include "tests/unit/server_grpc/front.h"

namespace kiln {
namespace {

TEST_F(Grpc, SaysWhatItCanDo) {
    start({}, tokens);
    const auto ask = [&](const std::string& token) {
        as(token);
        re::GetCapabilitiesRequest request;
        request.set_instance_name("main");
        re::ServerCapabilities out;
        const grpc::Status status = capabilities_->GetCapabilities(context().get(), request, &out);
        EXPECT_TRUE(status.ok()) << status.error_message();
        return out;
    };
    const re::ServerCapabilities ci = ask("cccccccccccccccccccc");
    EXPECT_EQ(ci.low_api_version().major(), 2);
    EXPECT_EQ(ci.low_api_version().minor(), 0);
    EXPECT_EQ(ci.high_api_version().minor(), 11);
    ASSERT_EQ(ci.cache_capabilities().digest_functions_size(), 1);
    EXPECT_EQ(ci.cache_capabilities().digest_functions(0), re::DigestFunction::SHA256);
    EXPECT_TRUE(ci.cache_capabilities().action_cache_update_capabilities().update_enabled());
    EXPECT_FALSE(ci.has_execution_capabilities());
    EXPECT_FALSE(ask("rrrrrrrrrrrrrrrrrrrr").cache_capabilities().action_cache_update_capabilities().update_enabled());
    EXPECT_FALSE(ask("bbbbbbbbbbbbbbbbbbbb").cache_capabilities().action_cache_update_capabilities().update_enabled());
}

TEST_F(Grpc, AnActionIsAHitOnlyWithItsBlobs) {
    start();
    const BlobName key = named("an action"), output = named("its output");
    EXPECT_EQ(get_action(key), StatusCode::NOT_FOUND);
    ASSERT_EQ(put_action(key, result(output)), StatusCode::OK);
    EXPECT_EQ(get_action(key), StatusCode::NOT_FOUND);
    ASSERT_EQ(put(digest(output), "its output"), StatusCode::OK);
    re::ActionResult got;
    ASSERT_EQ(get_action(key, &got), StatusCode::OK);
    EXPECT_EQ(got.SerializeAsString(), result(output).SerializeAsString());
}

TEST_F(Grpc, TheFirstValueOfAnActionStays) {
    start();
    const BlobName key = named("an action"), output = named("one"), other = named("two");
    for (const std::string& bytes : {std::string("one"), std::string("two")})
        ASSERT_EQ(put(digest(named(bytes)), bytes), StatusCode::OK);
    ASSERT_EQ(put_action(key, result(output)), StatusCode::OK);
    re::ActionResult held;
    EXPECT_EQ(put_action(key, result(other), &held), StatusCode::OK);
    EXPECT_EQ(held.output_files(0).digest().hash(), output.digest.hex());
    re::ActionResult got;
    ASSERT_EQ(get_action(key, &got), StatusCode::OK);
    EXPECT_EQ(got.output_files(0).digest().hash(), output.digest.hex());
    EXPECT_EQ(service_->counters().total().conflicts, 1u);
}

TEST_F(Grpc, RefusesActionsThatAreNone) {
    start();
    re::ActionResult bad = result(named("x"));
    bad.mutable_output_files(0)->mutable_digest()->set_hash("../../etc/passwd");
    EXPECT_EQ(put_action(named("a"), bad), StatusCode::INVALID_ARGUMENT);
    bad = result(named("x"));
    bad.mutable_output_files(0)->clear_digest();
    EXPECT_EQ(put_action(named("a"), bad), StatusCode::INVALID_ARGUMENT);
    re::GetActionResultRequest request;
    request.set_instance_name("main");
    re::ActionResult out;
    EXPECT_EQ(actions_->GetActionResult(context().get(), request, &out).error_code(), StatusCode::INVALID_ARGUMENT);
    *request.mutable_action_digest() = digest(named("a"));
    request.set_digest_function(re::DigestFunction::BLAKE3);
    EXPECT_EQ(actions_->GetActionResult(context().get(), request, &out).error_code(), StatusCode::INVALID_ARGUMENT);
    request.set_digest_function(re::DigestFunction::SHA256);
    request.set_instance_name("nobody/knows");
    EXPECT_EQ(actions_->GetActionResult(context().get(), request, &out).error_code(), StatusCode::INVALID_ARGUMENT);
}

// Every call with every kind of caller: what it may, and the code of what it may not.
TEST_F(Grpc, ChecksRolesOnEveryCall) {
    start({}, tokens);
    as("cccccccccccccccccccc");
    const BlobName blob = named("a blob"), key = named("a key");
    ASSERT_EQ(put(digest(blob), "a blob"), StatusCode::OK);
    ASSERT_EQ(put_action(key, result(blob)), StatusCode::OK);
    constexpr StatusCode ok = StatusCode::OK, who = StatusCode::UNAUTHENTICATED, no = StatusCode::PERMISSION_DENIED;
    struct Row {
        const char* token;
        StatusCode reads, writes_blobs, writes_actions;
    };
    for (const Row& row :
         {Row{"", who, who, who}, Row{"an unknown token....", who, who, who}, Row{"llllllllllllllllllll", who, who, who},
          Row{"rrrrrrrrrrrrrrrrrrrr", ok, no, no}, Row{"bbbbbbbbbbbbbbbbbbbb", ok, ok, no},
          Row{"cccccccccccccccccccc", ok, ok, ok}, Row{"pppppppppppppppppppp", no, no, no}}) {
        as(row.token);
        const std::string mine = std::string("written by ") + row.token;
        std::string out;
        re::FindMissingBlobsRequest find;
        find.set_instance_name("main");
        re::FindMissingBlobsResponse found;
        EXPECT_EQ(blobs_->FindMissingBlobs(context().get(), find, &found).error_code(), row.reads) << row.token;
        re::BatchReadBlobsRequest read;
        read.set_instance_name("main");
        re::BatchReadBlobsResponse got;
        EXPECT_EQ(blobs_->BatchReadBlobs(context().get(), read, &got).error_code(), row.reads) << row.token;
        re::GetCapabilitiesRequest ask;
        ask.set_instance_name("main");
        re::ServerCapabilities can;
        EXPECT_EQ(capabilities_->GetCapabilities(context().get(), ask, &can).error_code(), row.reads) << row.token;
        EXPECT_EQ(download(read_name("main", blob), out).error_code(), row.reads) << row.token;
        EXPECT_EQ(get_action(key), row.reads) << row.token;
        bs::QueryWriteStatusRequest query;
        query.set_resource_name(upload_name("main", "u", blob));
        bs::QueryWriteStatusResponse status;
        EXPECT_EQ(streams_->QueryWriteStatus(context().get(), query, &status).error_code(), row.reads) << row.token;
        re::GetTreeRequest tree;
        tree.set_instance_name("main");
        *tree.mutable_root_digest() = digest(named(""));
        const auto walk = context();
        auto pages = blobs_->GetTree(walk.get(), tree);
        re::GetTreeResponse page;
        while (pages->Read(&page)) {
        }
        EXPECT_EQ(pages->Finish().error_code(), row.reads) << row.token;
        EXPECT_EQ(put(digest(named(mine)), mine), row.writes_blobs) << row.token;
        const std::string streamed = mine + " in a stream";
        EXPECT_EQ(upload({upload_name("main", "u", named(streamed)), streamed}).error_code(), row.writes_blobs) << row.token;
        EXPECT_EQ(put_action(named(mine), result(blob)), row.writes_actions) << row.token;
    }
    // Two tokens are none, whichever they are.
    as("cccccccccccccccccccc");
    const auto both = context();
    both->AddMetadata("authorization", token_);
    re::GetCapabilitiesRequest ask;
    ask.set_instance_name("main");
    re::ServerCapabilities can;
    EXPECT_TRUE(capabilities_->GetCapabilities(context().get(), ask, &can).ok());
    EXPECT_EQ(capabilities_->GetCapabilities(both.get(), ask, &can).error_code(), StatusCode::UNAUTHENTICATED);
    // A pull request reads main, and what it writes is its own.
    as("pppppppppppppppppppp");
    instance_ = "pr/7";
    EXPECT_EQ(get_action(key), ok);
    EXPECT_EQ(put_action(named("new"), result(blob)), ok);
    as("cccccccccccccccccccc");
    instance_ = "main";
    EXPECT_EQ(get_action(named("new")), StatusCode::NOT_FOUND);
}

TEST_F(Grpc, ServesManyAtOnce) {
    start();
    std::vector<std::thread> threads;
    std::atomic<int> failures{0};
    for (int t = 0; t < 8; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < 20; ++i) {
                const std::string bytes = "blob " + std::to_string((t + i) % 10) + std::string(70'000, 's');
                if (!upload({upload_name("main", std::to_string(t), named(bytes)), bytes}).ok()) ++failures;
                std::string out;
                if (!download(read_name("main", named(bytes)), out).ok() || out != bytes) ++failures;
            }
        });
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(failures, 0);
    EXPECT_EQ(store_->stats()->blob.entries, 10u);
    server_.reset();  // a client hears of a call's end before the call is taken apart
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, LogsEveryCallWithoutItsToken) {
    start({}, tokens);
    as("cccccccccccccccccccc");
    ASSERT_EQ(put(digest(named("a blob")), "a blob"), StatusCode::OK);
    std::string out;
    ASSERT_TRUE(upload({upload_name("main", "u", named("in a stream")), "in a stream"}).ok());
    ASSERT_TRUE(download(read_name("main", named("in a stream")), out).ok());
    re::BatchReadBlobsRequest read;
    read.set_instance_name("main");
    *read.add_digests() = digest(named("a blob"));
    re::BatchReadBlobsResponse got;
    ASSERT_TRUE(blobs_->BatchReadBlobs(context().get(), read, &got).ok());
    as("a wrong token, logged?");
    instance_ = "main\"\n{\"forged\":1}";
    EXPECT_EQ(get_action(named("x")), StatusCode::UNAUTHENTICATED);
    server_.reset();
    log_.flush();
    const std::string log = read_file(log_file_);
    ::unlink(log_file_.c_str());
    const auto lines = [&](const std::string& wanted) {
        size_t count = 0;
        for (size_t at = 0, end = 0; (end = log.find('\n', at)) != std::string::npos; at = end + 1)
            count += log.substr(at, end - at).find(wanted) != std::string::npos ? 1 : 0;
        return count;
    };
    EXPECT_EQ(lines(""), 5u) << log;
    for (const char* method : {"BatchUpdateBlobs", "Write", "Read", "BatchReadBlobs"})
        EXPECT_EQ(lines("\"caller\":\"ci\",\"method\":\"" + std::string(method) + "\",\"path\":\"main"), 1u) << method << log;
    EXPECT_EQ(lines("\"method\":\"Read\",\"path\":\"" + read_name("main", named("in a stream")) +
                    "\",\"grpc_status\":0,\"in\":0,\"out\":11"),
              1u)
        << log;
    EXPECT_EQ(lines("\"caller\":\"nobody\",\"method\":\"GetActionResult\",\"path\":\"main\\\"\\u000a{"), 1u) << log;
    EXPECT_EQ(lines("\"grpc_status\":16"), 1u) << log;
    EXPECT_EQ(lines("\"peer\":\"127.0.0.1:"), 5u) << log;
    EXPECT_EQ(log.find("cccccccc"), std::string::npos);
    EXPECT_EQ(log.find("wrong token"), std::string::npos);
}

TEST_F(Grpc, SaysThatItIsWellAndWhatItDoesNotDo) {
    start();
    const auto health = grpc::health::v1::Health::NewStub(channel_);
    grpc::health::v1::HealthCheckRequest ask;
    grpc::health::v1::HealthCheckResponse state;
    ASSERT_TRUE(health->Check(context().get(), ask, &state).ok());
    EXPECT_EQ(state.status(), grpc::health::v1::HealthCheckResponse::SERVING);
    ask.set_service("another");
    EXPECT_EQ(health->Check(context().get(), ask, &state).error_code(), StatusCode::NOT_FOUND);
    const auto execution = re::Execution::NewStub(channel_);
    const auto held = context();
    auto operations = execution->Execute(held.get(), {});
    EXPECT_EQ(operations->Finish().error_code(), StatusCode::UNIMPLEMENTED);
}

// Calls that are under way when the server stops: those that can end do, the others are cut when patience is over.
TEST_F(Grpc, DrainsItsCalls) {
    start();
    bs::WriteResponse response;
    const auto held = context();
    auto writer = streams_->Write(held.get(), &response);
    bs::WriteRequest request;
    request.set_resource_name(upload_name("main", "u", named("abc")));
    request.set_data("a");
    ASSERT_TRUE(writer->Write(request));
    while (service_->in_flight() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::thread drain([&] { server_->drain(std::chrono::seconds(60)); });
    request.set_data("bc");
    request.set_write_offset(1);
    request.set_finish_write(true);
    EXPECT_TRUE(writer->Write(request));
    EXPECT_TRUE(writer->Finish().ok());
    drain.join();
    EXPECT_TRUE(*service_->has_blob(Caller::trusted(), "main", named("abc")));

    start();
    const auto other = context();
    writer = streams_->Write(other.get(), &response);
    request.set_resource_name(upload_name("main", "u", named("xyz")));
    request.set_write_offset(0);
    request.set_finish_write(false);
    ASSERT_TRUE(writer->Write(request));
    while (service_->in_flight() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    server_->drain(std::chrono::seconds(0));
    EXPECT_FALSE(writer->Finish().ok());
    EXPECT_EQ(service_->in_flight(), 0u);
}

TEST_F(Grpc, AFrontThatCannotListenSaysSo) {
    start();
    GrpcOptions taken;
    taken.port = server_->port();
    EXPECT_FALSE(GrpcServer::start(
                     *service_, log_, [this] { return access_; }, taken)
                     .ok());
    GrpcOptions tls;
    tls.certificate = tls.key = folder_.path() + "/no such file";
    EXPECT_FALSE(GrpcServer::start(
                     *service_, log_, [this] { return access_; }, tls)
                     .ok());
}

TEST_F(Grpc, SpeaksTlsToWhoTrustsItsCertificate) {
    GrpcOptions options;
    options.certificate = folder_.path() + "/cert.pem";
    options.key = folder_.path() + "/key.pem";
    options.look_again = std::chrono::seconds(1);
    const std::string make =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=localhost "
        "-addext subjectAltName=IP:127.0.0.1 -keyout " +
        options.key + " -out " + options.certificate + " 2>/dev/null";
    ASSERT_EQ(std::system(make.c_str()), 0);
    start(options);
    const auto ask = [&](const std::shared_ptr<grpc::ChannelCredentials>& credentials) {
        capabilities_ =
            re::Capabilities::NewStub(grpc::CreateChannel("127.0.0.1:" + std::to_string(server_->port()), credentials));
        re::GetCapabilitiesRequest request;
        request.set_instance_name("main");
        re::ServerCapabilities out;
        return capabilities_->GetCapabilities(context().get(), request, &out).error_code();
    };
    grpc::SslCredentialsOptions trust;
    trust.pem_root_certs = read_file(options.certificate);
    EXPECT_EQ(ask(grpc::SslCredentials(trust)), StatusCode::OK);
    EXPECT_EQ(ask(grpc::SslCredentials({})), StatusCode::UNAVAILABLE);
    EXPECT_EQ(ask(grpc::InsecureChannelCredentials()), StatusCode::UNAVAILABLE);
    // A new certificate is served to new connections without a restart.
    ASSERT_EQ(std::system(make.c_str()), 0);
    trust.pem_root_certs = read_file(options.certificate);
    StatusCode got = StatusCode::UNKNOWN;
    for (int i = 0; i < 150 && got != StatusCode::OK; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        got = ask(grpc::SslCredentials(trust));
    }
    EXPECT_EQ(got, StatusCode::OK);
}

TEST(ResourceName, ReadsAndWritesTheFourForms) {
    const BlobName blob = named("x");
    const std::string hash = blob.digest.hex();
    EXPECT_EQ(parse_resource_name(read_name("", blob)), (ResourceName{"", false, false, blob}));
    EXPECT_EQ(parse_resource_name(read_name("a/b", blob)), (ResourceName{"a/b", false, false, blob}));
    EXPECT_EQ(parse_resource_name(upload_name("", "u", blob)), (ResourceName{"", true, false, blob}));
    EXPECT_EQ(parse_resource_name(upload_name("a", "u", blob) + "/some/file.txt"), (ResourceName{"a", true, false, blob}));
    EXPECT_EQ(parse_resource_name("compressed-blobs/zstd/" + hash + "/1"), (ResourceName{"", false, true, blob}));
    EXPECT_EQ(parse_resource_name("i/uploads/u/compressed-blobs/zstd/" + hash + "/1"), (ResourceName{"i", true, true, blob}));
    for (const std::string& bad :
         {std::string(), std::string("blobs"), "blobs/" + hash, "blobs/" + hash + "/", "blobs/" + hash + "/-1",
          "blobs/" + hash + "/+1", "blobs/" + hash + "/1x", "blobs/" + hash + "/99999999999999999999", std::string("blobs//1"),
          "uploads/blobs/" + hash + "/1", "uploads//blobs/" + hash + "/1", "compressed-blobs/" + hash + "/1",
          "compressed-blobs/deflate/" + hash + "/1", "uploads/u/" + hash + "/1", hash + "/1",
          std::string(2000, 'a') + "/blobs/" + hash + "/1"})
        EXPECT_FALSE(parse_resource_name(bad)) << bad;
}

}  // namespace
}  // namespace kiln
