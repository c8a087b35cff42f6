#include "cache/server/config.h"
#include "cache/server/patience.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

std::string problem_of(std::string_view yaml) {
    const auto settings = settings_of(yaml);
    if (!settings.ok()) return settings.error().message;
    Config config;
    const Status applied = apply(*settings, config);
    if (!applied.ok()) return applied.error().message;
    const Status checked = check(config);
    return checked.ok() ? "" : checked.error().message;
}

TEST(Config, AFile) {
    const auto settings = settings_of(
        "folder: /var/cache/kiln\n"
        "limit: 50GiB\n"
        "listen: \"[::1]:8443\"\n"
        "sync: none\n"
        "tokens: /etc/tokens\n"
        "anonymous: read\n"
        "tls: {certificate: c.pem, key: k.pem}\n"
        "instances:\n"
        "  - {name: main}\n"
        "  - {name: pr/*, parent: main}\n"
        "  - name: ccache\n"
        "    opaque: true\n"
        "limits: {blob: 1MiB, connections: 7}\n"
        "timeouts: {head: 250ms, idle: 3}\n"
        "log: events\n");
    ASSERT_TRUE(settings.ok()) << settings.error().message;
    Config config;
    ASSERT_TRUE(apply(*settings, config).ok());
    EXPECT_TRUE(check(config).ok());
    EXPECT_EQ(config.folder, "/var/cache/kiln");
    EXPECT_EQ(config.disk.limit, uint64_t{50} << 30);
    EXPECT_EQ(config.disk.sync, Sync::none);
    EXPECT_EQ(config.http.address, "::1");
    EXPECT_EQ(config.http.port, 8443);
    EXPECT_TRUE(config.anonymous.has(Role::read));
    EXPECT_FALSE(config.anonymous.has(Role::ac_write));
    ASSERT_EQ(config.instances.size(), 3u);
    EXPECT_EQ(config.instances[1].parent, "main");
    EXPECT_TRUE(config.instances[2].opaque && config.instances[2].replace);
    EXPECT_EQ(config.limits.blob, 1u << 20);
    EXPECT_EQ(config.http.connections, 7u);
    EXPECT_EQ(config.http.head_timeout, std::chrono::milliseconds(250));
    EXPECT_EQ(config.http.idle_timeout, std::chrono::seconds(3));
    EXPECT_EQ(config.log, LogLevel::events);
    // A flag wins.
    ASSERT_TRUE(apply({{"limit", "1GB", 0}}, config).ok());
    EXPECT_EQ(config.disk.limit, 1'000'000'000u);
}

TEST(Config, AnInstancesKeysHaveNoOrder) {
    const struct {
        const char* keys;
        bool replace;
    } rows[] = {{"opaque: true", true},
                {"opaque: false", false},
                {"replace: true", true},
                {"opaque: true, replace: false", false},
                {"replace: false, opaque: true", false},
                {"opaque: false, replace: true", true},
                {"replace: true, opaque: false", true}};
    for (const auto& row : rows) {
        const auto settings = settings_of(std::string("instances: [{name: a, ") + row.keys + "}, {name: b, opaque: true}]");
        ASSERT_TRUE(settings.ok()) << settings.error().message;
        Config config;
        ASSERT_TRUE(apply(*settings, config).ok());
        EXPECT_EQ(config.instances.at(0).replace, row.replace) << row.keys;
        EXPECT_TRUE(config.instances.at(1).replace) << "what was said of another";
    }
}

TEST(Config, Mistakes) {
    const std::pair<std::string, std::string> rows[] = {
        {"", "no folder"},
        {"folder: x\nlimt: 3", "line 2: limt: there is no such setting"},
        {"folder: x\nfolder: y", "line 2: folder is there twice"},
        {"folder: x\nlimits: {blob: 1, blob: 2}", "blob is there twice"},
        {"folder: [x]", "folder.0: there is no such setting"},
        {"folder: x\nlimit: many", "line 2: limit: wants a size"},
        {"folder: x\nlimit: 99999999999TiB", "wants a size"},
        {"folder: x\nlimit: -1", "wants a size"},
        {"folder: x\nlimit: 12", "at least"},
        {"folder: x\nlisten: localhost:80", "wants a numeric address"},
        {"folder: x\nlisten: 127.0.0.1:65536", "wants a numeric address"},
        {"folder: x\nlisten: 127.0.0.1", "wants a numeric address"},
        {"folder: x\nlisten: ::1:80", "wants a numeric address"},
        {"folder: x\nplain_text: yes", "wants true or false"},
        {"folder: x\nchaos: loss=2", "line 2: chaos: wants seed="},
        {"folder: x\nlog: loud", "wants one of off, events, requests"},
        {"folder: x\nanonymous: admin\ntokens: t", "nobody without a token administers"},
        {"folder: x\nanonymous: read", "there are no tokens"},
        {"folder: x\ntls: {key: k}", "go together"},
        {"folder: x\ninstances: [main]", "instances are a list of maps"},
        {"folder: x\ninstances:\n  - {name: a, parent: b}", "is no instance"},
        {"folder: x\ninstances:\n  - {name: ../a}", "the name is not valid"},
        {"folder: x\ninstances:\n  - {nam: a}", "is no key of an instance"},
        {"folder: &a x", "anchors"},
        {"folder: *a", "line 1"},
        {"folder: !!str x", "tags"},
        {"folder: x\n---\nfolder: y", "second document"},
        {"- folder", "not a map"},
        {"folder", "not a map"},
        {"{folder: {a: {b: {c: {d: {e: {f: {g: {h: 1}}}}}}}}}", "too deeply"},
        {"? [a]\n: b", "a key is a word"},
        {std::string("folder: x\0y", 11), "control characters"},
        {"folder: \x04", "control characters"},
        {"folder: 'x", "line"},
        {"limits.blob: 3", "no such setting"},
        {std::string(70'000, '#'), "larger than 64 KiB"}};
    for (const auto& [yaml, problem] : rows)
        EXPECT_NE(problem_of(yaml).find(problem), std::string::npos) << yaml.substr(0, 80) << "\n  gave: " << problem_of(yaml);
    EXPECT_EQ(problem_of("folder: x"), "");
}

TEST(Config, BeyondLoopbackTakesTokensAndTls) {
    const std::string open = "folder: x\nlisten: 0.0.0.0:80\n", tokens = "tokens: t\n", tls = "tls: {certificate: c, key: k}\n";
    EXPECT_NE(problem_of(open).find("takes tokens"), std::string::npos);
    EXPECT_NE(problem_of(open + tls).find("takes tokens"), std::string::npos);
    EXPECT_NE(problem_of(open + tokens).find("takes TLS"), std::string::npos);
    EXPECT_EQ(problem_of(open + tokens + tls), "");
    EXPECT_EQ(problem_of(open + tokens + "plain_text: true\n"), "");
    EXPECT_NE(problem_of("folder: x\nlisten: 127.0.0.1:80\ngrpc: 0.0.0.0:81\n").find("takes tokens"), std::string::npos);
    EXPECT_NE(problem_of("folder: x\nlisten: \"[::]:80\"\n").find("takes tokens"), std::string::npos);
    for (const char* loopback : {"127.0.0.1:80", "127.8.9.1:80", "\"[::1]:80\""})
        EXPECT_EQ(problem_of("folder: x\nlisten: " + std::string(loopback) + "\n"), "") << loopback;
}

TEST(Patience, IsBoundedWhateverTheSize) {
    using namespace std::chrono_literals;
    EXPECT_EQ(whole_time(60s, 640, 64), 70s);
    EXPECT_EQ(whole_time(1500ms, 63, 64), 1500ms);
    EXPECT_EQ(whole_time(0s, 5, 0), 5s);
    const auto longest = whole_time(std::chrono::milliseconds::max(), UINT64_MAX, 1);
    EXPECT_GT(longest, 24h * 365);
    EXPECT_GT(std::chrono::steady_clock::now() + longest, std::chrono::steady_clock::now());
}

}  // namespace
}  // namespace kiln
