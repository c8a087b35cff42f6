#include "cache/client/remote_record.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "cache/client/private_file.h"
#include "cache/client/remote_url.h"
#include "cache/protocol/action_result.h"
#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

Digest key_of(const std::string& text) { return sha256(as_bytes(text)); }

TEST(RemoteRecord, GoesThereAndBack) {
    const Digest key = key_of("key");
    const Bytes frame = write_frame(key, bytes_of("record"), nullptr);
    const std::vector<RemoteBlob> blobs{{key_of("a"), 1}, {key_of("b"), 0}, {key_of("c"), uint64_t{1} << 40}};
    const auto value = read_action_value(write_action_value(frame, blobs, std::nullopt));
    ASSERT_TRUE(value && value->frame);
    EXPECT_EQ(*value->frame, frame);
    ASSERT_EQ(value->blobs.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(value->blobs[i].digest, blobs[i].digest);
        EXPECT_EQ(value->blobs[i].size, blobs[i].size);
    }
    Bytes record;
    EXPECT_EQ(read_frame(key, frame, nullptr, record), FrameCheck::good);
    EXPECT_EQ(record, bytes_of("record"));
    EXPECT_EQ(read_frame(key_of("other"), frame, nullptr, record), FrameCheck::damaged);

    const RemoteBlob place{sha256(frame), frame.size()};
    const auto elsewhere = read_action_value(write_action_value({}, blobs, place));
    ASSERT_TRUE(elsewhere);
    EXPECT_FALSE(elsewhere->frame);
    EXPECT_EQ(elsewhere->frame_blob.digest, place.digest);
    EXPECT_EQ(elsewhere->blobs.size(), 3u);
}

TEST(RemoteRecord, EveryTruncationIsRefused) {
    const Digest key = key_of("key");
    const Bytes frame = write_frame(key, bytes_of("record"), nullptr);
    Bytes record;
    for (size_t n = 0; n < frame.size(); ++n)
        EXPECT_EQ(read_frame(key, Bytes(frame.begin(), frame.begin() + static_cast<long>(n)), nullptr, record),
                  FrameCheck::damaged);
    const Bytes value = write_action_value(frame, {{key_of("a"), 5}}, std::nullopt);
    for (size_t n = 0; n < value.size(); ++n)
        EXPECT_FALSE(read_action_value(Bytes(value.begin(), value.begin() + static_cast<long>(n)))) << n;
    EXPECT_TRUE(read_action_value(value));
}

TEST(RemoteRecord, RefusesWhatKilnWouldNotWrite) {
    const Bytes frame = write_frame(key_of("key"), bytes_of("record"), nullptr);
    const BlobName blob{key_of("a"), 5};
    const std::string path = "blob/" + blob.digest.hex();
    ActionResult good;
    good.files.push_back({path, blob, false, {}});
    good.stdout_raw = frame;
    ASSERT_TRUE(read_action_value(serialise(good)));
    const struct {
        const char* name;
        std::function<void(ActionResult&)> change;
    } cases[] = {
        {"no record", [](ActionResult& r) { r.stdout_raw.clear(); }},
        {"two records",
         [&](ActionResult& r) {
             r.files.push_back({"record", blob, false, {}});
         }},
        {"two records elsewhere",
         [&](ActionResult& r) {
             r.stdout_raw.clear();
             r.files.push_back({"record", blob, false, {}});
             r.files.push_back({"record", blob, false, {}});
         }},
        {"a failure", [](ActionResult& r) { r.exit_code = 1; }},
        {"a path upwards", [](ActionResult& r) { r.files[0].path = "../" + r.files[0].path; }},
        {"an absolute path", [](ActionResult& r) { r.files[0].path = "/etc/cron.d/x"; }},
        {"another blob's path", [](ActionResult& r) { r.files[0].path = "blob/" + key_of("b").hex(); }},
        {"too many blobs", [&](ActionResult& r) { r.files.resize(most_named_blobs + 1, r.files[0]); }},
    };
    for (const auto& c : cases) {
        ActionResult bad = good;
        c.change(bad);
        EXPECT_FALSE(read_action_value(serialise(bad))) << c.name;
    }
    // What a server adds is passed over.
    ActionResult more = good;
    more.metadata = bytes_of("when and where");
    more.files[0].contents = bytes_of("inlin");
    EXPECT_TRUE(read_action_value(serialise(more)));
}

// --- signatures ---

struct Keys : TestFolder {
    std::string make(const std::string& name, const char* kind = "ed25519") {
        const std::string secret = path() + "/" + name, open = secret + ".pub";
        const std::string command = "openssl genpkey -algorithm " + std::string(kind) + " -out " + secret +
                                    " 2>/dev/null && chmod 600 " + secret + " && openssl pkey -in " + secret + " -pubout -out " +
                                    open;
        EXPECT_EQ(std::system(command.c_str()), 0);
        return secret;
    }
};

TEST(Signature, GoodOnlyFromWhoIsTrusted) {
    Keys keys;
    const std::string main = keys.make("main"), other = keys.make("other");
    const auto signer = Signer::open(main), stranger = Signer::open(other);
    const auto trust = Verifier::open(main + ".pub");
    ASSERT_TRUE(signer.ok() && stranger.ok() && trust.ok());
    const Digest key = key_of("key");
    const Bytes frame = write_frame(key, bytes_of("record"), signer->get());
    Bytes record;
    EXPECT_EQ(read_frame(key, frame, trust->get(), record), FrameCheck::good);
    EXPECT_EQ(read_frame(key, frame, nullptr, record), FrameCheck::good);
    EXPECT_EQ(read_frame(key, write_frame(key, bytes_of("record"), stranger->get()), trust->get(), record),
              FrameCheck::untrusted);
    EXPECT_EQ(read_frame(key, write_frame(key, bytes_of("record"), nullptr), trust->get(), record), FrameCheck::untrusted);
    // A good signature of another record, or of the same for another key.
    const Bytes swapped = write_frame(key, bytes_of("recorD"), signer->get());
    Bytes mixed = frame;
    std::copy(swapped.end() - 64, swapped.end(), mixed.end() - 64);
    EXPECT_EQ(read_frame(key, mixed, trust->get(), record), FrameCheck::untrusted);
    Bytes moved = write_frame(key_of("other"), bytes_of("record"), signer->get());
    std::copy(key.bytes.begin(), key.bytes.end(), moved.begin() + 8);
    EXPECT_EQ(read_frame(key, moved, trust->get(), record), FrameCheck::untrusted);
    for (size_t bit = 0; bit < frame.size() * 8; ++bit) {
        Bytes flipped = frame;
        flipped[bit / 8] ^= static_cast<uint8_t>(1u << (bit % 8));
        EXPECT_NE(read_frame(key, flipped, trust->get(), record), FrameCheck::good) << bit;
    }
    // Both keys in one file: while keys are changed, either is good.
    const std::string both = keys.path() + "/both";
    ASSERT_EQ(std::system(("cat " + other + ".pub " + main + ".pub > " + both).c_str()), 0);
    const auto two = Verifier::open(both);
    ASSERT_TRUE(two.ok());
    EXPECT_EQ(read_frame(key, frame, two->get(), record), FrameCheck::good);
    EXPECT_EQ(read_frame(key, write_frame(key, bytes_of("record"), stranger->get()), two->get(), record), FrameCheck::good);
}

TEST(Signature, RefusesOtherKeysAndOpenFiles) {
    Keys keys;
    const std::string good = keys.make("good"), other = keys.make("rsa", "RSA");
    EXPECT_TRUE(Signer::open(good).ok());
    EXPECT_FALSE(Signer::open(other).ok());
    EXPECT_FALSE(Verifier::open(other + ".pub").ok());
    EXPECT_FALSE(Signer::open(good + ".pub").ok());
    EXPECT_FALSE(Verifier::open(good).ok());
    EXPECT_FALSE(Signer::open(keys.path() + "/none").ok());
    EXPECT_FALSE(Verifier::open(keys.path() + "/none").ok());
    ::chmod(good.c_str(), 0640);
    EXPECT_FALSE(Signer::open(good).ok());
}

TEST(PrivateFile, TokensAreOneVisibleLine) {
    EXPECT_EQ(*token_of(" abc-1.2_3~+/= \r\n", "t"), "abc-1.2_3~+/=");
    for (const char* bad : {"", " \n", "a b", "a\nb", "a\r\nX-Header: b", "\x01", "\xc3\xa4"}) {
        const auto token = token_of(bad, "here");
        ASSERT_FALSE(token.ok()) << bad;
        EXPECT_EQ(token.error().message.find("X-Header"), std::string::npos);
    }
    EXPECT_FALSE(token_of(std::string(5000, 'a'), "t").ok());
    TestFolder folder;
    const std::string path = folder.path() + "/token";
    std::ofstream(path) << "secret\n";
    ::chmod(path.c_str(), 0600);
    EXPECT_EQ(*read_private_file(path, "token", 100), "secret\n");
    EXPECT_FALSE(read_private_file(path, "token", 3).ok());
    ::chmod(path.c_str(), 0604);
    EXPECT_FALSE(read_private_file(path, "token", 100).ok());
    EXPECT_FALSE(read_private_file(folder.path(), "token", 100).ok());
}

TEST(RemoteUrl, TakesAddressesAndNothingElse) {
    const struct {
        const char* text;
        const char* whole;
    } good[] = {{"http://localhost:8080", "http://localhost:8080"},
                {"http://h", "http://h:80"},
                {"https://h.example/a/b/", "https://h.example:443/a/b"},
                {"grpc://h:1/main", "grpc://h:1/main"},
                {"http://[::1]:9/x", "http://[::1]:9/x"},
                {"grpcs://10.0.0.1", "grpcs://10.0.0.1:8980"}};
    for (const auto& g : good) {
        const auto url = RemoteUrl::parse(g.text);
        ASSERT_TRUE(url.ok()) << g.text;
        EXPECT_EQ(url->text(), g.whole);
    }
    for (const char* bad : {"",
                            "http://",
                            "http:///a",
                            "ftp://h",
                            "file:///etc/passwd",
                            "http://h:0",
                            "http://h:70000",
                            "http://h:x",
                            "http://h:",
                            "http://user:secret@h/",
                            "http://h/a?b",
                            "http://h/a#b",
                            "http://h/%2e%2e",
                            "http://h/../a",
                            "http://h/a/..",
                            "http://h//a",
                            "http://h/./a",
                            "http://h h/",
                            "http://[::1",
                            "http://h\n",
                            "HTTP://h",
                            "http://h\\a"}) {
        const auto url = RemoteUrl::parse(bad);
        ASSERT_FALSE(url.ok()) << bad;
        EXPECT_EQ(url.error().fault, Fault::usage);
        EXPECT_EQ(url.error().message.find("secret"), std::string::npos);
    }
    EXPECT_TRUE(RemoteUrl::parse("http://127.0.0.1:1")->loopback());
    EXPECT_FALSE(RemoteUrl::parse("http://10.0.0.1:1")->loopback());
}

}  // namespace
}  // namespace kiln
