// The HTTP protocol without sockets.
#include "cache/server/http_face.h"

#include <gtest/gtest.h>

#include "cache/server/facts.h"
#include "cache/server/log.h"
#include "cache/zstd.h"
#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

struct Faced {
    TestFolder folder;
    std::unique_ptr<DiskStore> store = std::move(*DiskStore::open(folder.path(), unflushed()));
    Service service{*store, std::move(*Instances::make({{"ccache", true, true, std::nullopt}})), {}, {}};
    std::shared_ptr<const Access> access = std::make_shared<const Access>(std::move(
        *Access::parse("ci 0123456789abcdef *:read,cas-write,ac-write\nro 0123456789abcdeF *:read\nnil 0123456789abcdeX\n", {})));
    HttpFace face{
        service, [this] { return access; }, {[] { return std::string("<html>"); }, [] { return std::string("metrics"); }}};

    HttpResponse ask(Method method, const std::string& target, std::string_view body = {},
                     const std::string& token = "0123456789abcdef", std::string_view coding = {}, std::string_view accept = {}) {
        const std::string authorization = token.empty() ? "" : "Bearer " + token;
        const HttpHead head{method, target, authorization, coding, accept, "0", body.size()};
        HttpWork work;
        if (auto early = face.plan(head, work)) return std::move(*early);
        auto response = face.answer(work, as_bytes(body));
        if (response) return std::move(*response);
        work.blocks = true;
        return face.answer(work, as_bytes(body)).value();
    }
    unsigned status(Method method, const std::string& target, std::string_view body = {},
                    const std::string& token = "0123456789abcdef") {
        return ask(method, target, body, token).status;
    }
};

std::string text_of(const HttpResponse& response) {
    if (!response.file) return std::string(as_text(response.body));
    return std::string(as_text(*response.file->all()));
}

TEST(HttpFace, PutAndGet) {
    Faced f;
    const std::string cas = "/cas/" + name_of("abc").hex();
    EXPECT_EQ(f.status(Method::get, cas), 404u);
    EXPECT_EQ(f.status(Method::put, cas, "abc"), 201u);
    EXPECT_EQ(f.status(Method::put, cas, "abc"), 200u);
    EXPECT_EQ(f.status(Method::put, cas, "abd"), 400u);
    EXPECT_EQ(text_of(f.ask(Method::get, cas)), "abc");
    EXPECT_EQ(f.ask(Method::head, cas).length(), 3u);
    EXPECT_EQ(text_of(f.ask(Method::get, "/ccache" + cas)), "abc") << "blobs are shared";
    EXPECT_EQ(f.status(Method::get, "/none" + cas), 404u);
    const std::string ac = "/ccache/ac/" + name_of("key").hex();
    EXPECT_EQ(f.status(Method::put, ac, "value"), 201u);
    EXPECT_EQ(text_of(f.ask(Method::get, ac)), "value");
    EXPECT_EQ(f.status(Method::get, "/ac/" + name_of("key").hex()), 404u);
}

TEST(HttpFace, RolesByVerb) {
    Faced f;
    const std::string key = name_of("abc").hex();
    const struct {
        Method method;
        std::string target;
        unsigned full, read, none, wrong, empty;
    } rows[] = {{Method::get, "/cas/" + key, 404, 404, 401, 401, 403},     {Method::head, "/cas/" + key, 404, 404, 401, 401, 403},
                {Method::get, "/ac/" + key, 404, 404, 401, 401, 403},      {Method::get, "/dav/a", 404, 404, 401, 401, 403},
                {Method::propfind, "/dav/a/", 207, 207, 401, 401, 403},    {Method::mkcol, "/dav/a/", 201, 403, 401, 401, 403},
                {Method::put, "/dav/a", 201, 403, 401, 401, 403},          {Method::put, "/cas/" + key, 201, 403, 401, 401, 403},
                {Method::put, "/ac/" + key, 201, 403, 401, 401, 403},      {Method::get, "/status", 200, 200, 401, 401, 403},
                {Method::get, "/metrics", 200, 200, 401, 401, 403},        {Method::get, "/healthz", 200, 200, 200, 200, 200},
                {Method::other, "/cas/" + key, 405, 405, 405, 405, 405},   {Method::put, "/status", 405, 405, 405, 405, 405},
                {Method::propfind, "/cas/" + key, 405, 405, 405, 405, 405}};
    for (const auto& row : rows) {
        const std::string_view body = row.method == Method::put ? "abc" : "";
        EXPECT_EQ(f.status(row.method, row.target, body, ""), row.none) << row.target;
        EXPECT_EQ(f.status(row.method, row.target, body, "wrong-wrong-wrong"), row.wrong) << row.target;
        EXPECT_EQ(f.status(row.method, row.target, body, "0123456789abcdeX"), row.empty) << row.target;
        EXPECT_EQ(f.status(row.method, row.target, body, "0123456789abcdeF"), row.read) << row.target;
        EXPECT_EQ(f.status(row.method, row.target, body), row.full) << row.target;
    }
}

TEST(HttpFace, TokensFromHeaders) {
    EXPECT_EQ(token_of(""), "");
    EXPECT_EQ(token_of("Bearer abc"), "abc");
    EXPECT_EQ(token_of("bearer  abc"), "abc");
    EXPECT_EQ(token_of("Basic dXNlcjpwYTpzcw=="), "pa:ss");
    EXPECT_EQ(token_of("Basic OnNlY3JldA"), "secret");
    for (const char* bad : {"abc", "Bearer", "Bearer ", "Digest abc", "Basic !!!", "Basic YWJj"})
        EXPECT_FALSE(token_of(bad)) << bad;
}

TEST(HttpFace, ZstdBothWays) {
    Faced f;
    const std::string text(5000, 'z');
    const std::string cas = "/cas/" + name_of(text).hex();
    const Bytes packed = zstd_compress(as_bytes(text), 1);
    const auto put = [&](std::string_view body, std::string_view coding) {
        return f.ask(Method::put, cas, body, "0123456789abcdef", coding).status;
    };
    EXPECT_EQ(put(as_text(packed), ""), 400u) << "the digest is of the plain bytes";
    EXPECT_EQ(put(as_text(packed), "gzip"), 415u);
    EXPECT_EQ(put("plain", "zstd"), 400u);
    EXPECT_EQ(put(as_text(packed), "zstd"), 201u);
    EXPECT_EQ(text_of(f.ask(Method::get, cas)), text);
    for (const auto& [accept, wanted] :
         {std::pair{"zstd", true}, {"gzip, ZSTD;q=0.5", true}, {"gzip", false}, {"zstd;q=0", false}, {"*", false}}) {
        const HttpResponse got = f.ask(Method::get, cas, {}, "0123456789abcdef", {}, accept);
        EXPECT_EQ(got.fields.find("zstd") != std::string::npos, wanted) << accept;
        Bytes back;
        if (wanted) {
            ASSERT_EQ(zstd_unpack(got.body, 5000, back), Unpacked::ok);
            EXPECT_EQ(as_text(back), text);
        } else {
            EXPECT_EQ(text_of(got), text);
        }
    }
}

TEST(HttpFace, LimitsBeforeTheBody) {
    Faced f;
    HttpWork work;
    const std::string target = "/cas/" + name_of("x").hex(), authorization = "Bearer 0123456789abcdef";
    HttpHead head{Method::put, target, authorization, {}, {}, {}, f.service.limits().blob + 1};
    const auto early = f.face.plan(head, work);
    ASSERT_TRUE(early.has_value());
    EXPECT_EQ(early->status, 413u);
    head.length = UINT64_MAX;
    EXPECT_EQ(f.face.plan(head, work)->status, 413u);
    head.length = f.service.limits().blob;
    EXPECT_FALSE(f.face.plan(head, work).has_value());
    head.method = Method::get;
    head.length = 1;
    const auto body_on_get = f.face.plan(head, work);
    ASSERT_TRUE(body_on_get.has_value()) << "what the last request left in `work` counts";
    EXPECT_EQ(body_on_get->status, 413u);
}

TEST(HttpFace, ResponsesInMemoryAreLeased) {
    Faced f;
    const std::string ac = "/ccache/ac/" + name_of("key").hex(), value(100'000, 'v');
    EXPECT_EQ(f.status(Method::put, ac, value), 201u);
    const std::string cas = "/cas/" + name_of(value).hex();
    EXPECT_EQ(f.status(Method::put, cas, value), 201u);
    std::vector<HttpResponse> held;
    while (f.service.answering() + value.size() <= f.service.limits().in_flight) {
        held.push_back(f.ask(Method::get, ac));
        ASSERT_EQ(held.back().status, 200u);
        ASSERT_EQ(f.service.answering(), held.size() * value.size());
        held.back().body = Bytes();
    }
    EXPECT_EQ(f.status(Method::get, ac), 503u);
    EXPECT_EQ(f.status(Method::head, ac), 200u);
    EXPECT_EQ(f.status(Method::get, cas), 200u) << "from its file";
    EXPECT_EQ(f.status(Method::put, ac, value + "w"), 200u) << "writers have a share of their own";
    held.clear();
    EXPECT_EQ(f.service.answering(), 0u);
    EXPECT_EQ(f.status(Method::get, ac), 200u);
}

TEST(HttpFace, PagesTakeNoBody) {
    Faced f;
    for (const auto& [method, target] : {std::pair{Method::get, "/healthz"},
                                         {Method::head, "/healthz"},
                                         {Method::get, "/"},
                                         {Method::get, "/status"},
                                         {Method::get, "/metrics"},
                                         {Method::options, "/dav/"},
                                         {Method::options, "/ccache/dav/a"}}) {
        for (const char* authorization : {"", "Bearer 0123456789abcdef"}) {
            HttpWork work;
            HttpHead head{method, target, authorization, {}, {}, {}, 0};
            EXPECT_FALSE(f.face.plan(head, work).has_value()) << target << ", the control: no body";
            head.length = 1;
            const auto early = f.face.plan(head, work);
            ASSERT_TRUE(early.has_value()) << target;
            EXPECT_EQ(early->status, 413u) << target;
            head.length = std::nullopt;  // in chunks: as many bytes as `most` are read
            EXPECT_FALSE(f.face.plan(head, work).has_value());
            EXPECT_EQ(work.most, 0u) << target;
        }
    }
}

TEST(HttpFace, WebDav) {
    Faced f;
    EXPECT_EQ(f.status(Method::get, "/dav/.sccache_check"), 404u);
    EXPECT_EQ(f.status(Method::propfind, "/dav/.sccache_check"), 404u);
    EXPECT_EQ(f.status(Method::put, "/dav/.sccache_check", "Hello"), 201u);
    EXPECT_EQ(f.status(Method::put, "/dav/.sccache_check", "World!"), 200u);
    EXPECT_EQ(text_of(f.ask(Method::get, "/dav/.sccache_check")), "World!");
    EXPECT_EQ(f.status(Method::get, "/ccache/dav/.sccache_check"), 404u);
    const std::string file = text_of(f.ask(Method::propfind, "/dav/.sccache_check"));
    EXPECT_NE(file.find("<D:getcontentlength>6<"), std::string::npos) << file;
    EXPECT_EQ(file.find("collection"), std::string::npos);
    const std::string root = text_of(f.ask(Method::propfind, "/dav/"));
    EXPECT_NE(root.find("<D:href>/dav/</D:href>"), std::string::npos) << root;
    EXPECT_NE(root.find("<D:collection/>"), std::string::npos);
    EXPECT_EQ(f.status(Method::put, "/dav/a/", "x"), 405u);
    EXPECT_EQ(f.status(Method::get, "/dav/a/"), 404u);
}

TEST(Pages, NothingFromOutsideBecomesMarkup) {
    ServerFacts facts;
    facts.version = "1";
    const std::string evil = "<script>alert(1)</script>\"'&";
    facts.instances = {{evil, Counts()}};
    facts.events = {{0, evil, evil, evil, evil}};
    const std::string page = status_page(facts);
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_NE(page.find("&lt;script&gt;"), std::string::npos) << "the control: it is there, escaped";
    const std::string metrics = metrics_page(facts);
    EXPECT_NE(metrics.find("instance=\"<script>alert(1)</script>\\\"'&\""), std::string::npos) << metrics.substr(0, 400);
}

TEST(Log, ALineStaysALine) {
    EXPECT_EQ(json_escaped("a\"b\\c\n\x01\x7f\xff"), "a\\\"b\\\\c\\u000a\\u0001\\u007f\\u00ff");
    EXPECT_EQ(json_escaped("gr\xc3\xbc\xc3\x9f"), "gr\xc3\xbc\xc3\x9f");
    EXPECT_EQ(json_escaped("\xc3"), "\\u00c3");
    EXPECT_EQ(json_escaped(std::string(300, 'x')).size(), 259u);
    const std::string line = LogLine("x").text("path", "/a\",\"status\":\"200").number("n", 7).finish();
    EXPECT_NE(line.find("\"path\":\"/a\\\",\\\"status\\\":\\\"200\",\"n\":7}\n"), std::string::npos) << line;
}

}  // namespace
}  // namespace kiln
