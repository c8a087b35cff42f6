// Messages spelt out byte by byte; protoc is the other reader of what serialise() writes.
#include "cache/protocol/action_result.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "cache/protocol/wire_message.h"

namespace kiln {
namespace {

const std::string_view text = "abc";

BlobName blob_of(std::string_view bytes) { return {sha256(as_bytes(bytes)), bytes.size()}; }

Bytes field(uint32_t number, ByteView value) {
    WireWriter out;
    out.message(number, value);
    return out.take();
}
Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}
Bytes text_field(uint32_t number, std::string_view value) { return field(number, as_bytes(value)); }
Bytes number_field(uint32_t number, uint64_t value) {
    WireWriter out;
    out.number(number, value);
    return out.take();
}
Bytes digest(std::string_view hash, uint64_t size) { return text_field(1, hash) + number_field(2, size); }
Bytes file(const Bytes& digest_bytes) { return field(2, text_field(1, "out.spv") + field(2, digest_bytes)); }

ActionResult full() {
    ActionResult result;
    result.files = {{"a/b.spv", blob_of("abc"), true, {'a', 'b', 'c'}}, {"c", blob_of(""), false, {}}};
    result.directories = {{"d", blob_of("tree"), blob_of("root"), true}, {"", blob_of("tree2"), std::nullopt, false}};
    result.file_symlinks = {{"l", "b.spv"}};
    result.directory_symlinks = {{"m", "d"}};
    result.symlinks = {{"n", "../elsewhere"}};
    result.exit_code = -1;
    result.stdout_raw = {1, 0, 2};
    result.stderr_raw = {3};
    result.stdout_digest = blob_of("out");
    result.stderr_digest = blob_of("err");
    result.metadata = {0x0a, 0x01, 'w'};
    return result;
}

TEST(ActionResult, ComesBackWhole) {
    for (const ActionResult& result : {ActionResult(), full()}) {
        const auto back = parse_action_result(serialise(result));
        ASSERT_TRUE(back.ok()) << back.error().message;
        EXPECT_EQ(*back, result);
    }
    EXPECT_TRUE(serialise(ActionResult()).empty());
}

TEST(ActionResult, ProtocReadsWhatIsWritten) {
    const Bytes bytes = serialise(full());
    std::string name = "/tmp/kiln-action-XXXXXX";
    const int fd = ::mkstemp(name.data());
    ASSERT_GE(fd, 0);
    std::FILE* out = ::fdopen(fd, "wb");
    ASSERT_EQ(std::fwrite(bytes.data(), 1, bytes.size(), out), bytes.size());
    std::fclose(out);
    std::FILE* pipe = ::popen(("protoc --decode_raw <" + name + " 2>/dev/null").c_str(), "r");
    std::string said;
    std::array<char, 4096> part;
    for (size_t n = 0; (n = std::fread(part.data(), 1, part.size(), pipe)) != 0;) said.append(part.data(), n);
    const int code = ::pclose(pipe);
    std::remove(name.c_str());
    if (code == 127 << 8) GTEST_SKIP() << "protoc is not installed";
    ASSERT_EQ(code, 0);
    EXPECT_NE(said.find("2 {\n  1: \"a/b.spv\"\n  2 {\n    1: \"" + blob_of("abc").digest.hex() + "\"\n    2: 3\n  }\n  4: 1\n"),
              std::string::npos)
        << said;
    EXPECT_NE(said.find("\n4: 18446744073709551615\n5: \"\\001\\000\\002\"\n"), std::string::npos) << said;
}

TEST(ActionResult, SkipsWhatItDoesNotKnow) {
    const Bytes known = serialise(full());
    const auto back = parse_action_result(known + number_field(99, 7) + text_field(77, "later") +
                                          Bytes{0x89, 0x06, 1, 2, 3, 4, 5, 6, 7, 8} + Bytes{0x8d, 0x06, 1, 2, 3, 4});
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(*back, full());
}

TEST(ActionResult, RefusesWhatIsNotOne) {
    const std::string hash = blob_of(text).digest.hex();
    ASSERT_TRUE(parse_action_result(file(digest(hash, 3))).ok()) << "positive control";
    std::string upper = hash;
    upper[0] = 'A';
    const std::pair<const char*, Bytes> bad[] = {
        {"text", {'h', 'e', 'l', 'l', 'o'}},
        {"field 0", {0x02, 0x00}},
        {"group", {0x0b, 0x0c}},
        {"length past the end", {0x12, 0x05, 1}},
        {"endless varint", {0x20, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}},
        {"varint past 64 bits", {0x20, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02}},
        {"unfinished varint", {0x20, 0x80}},
        {"length near 2^64", {0x12, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01}},
        {"file as a number", number_field(2, 1)},
        {"file without a digest", field(2, text_field(1, "out.spv"))},
        {"file without a path", field(2, field(2, digest(hash, 3)))},
        {"short hash", file(digest(hash.substr(1), 3))},
        {"upper-case hash", file(digest(upper, 3))},
        {"traversal as hash", file(digest("../../../../etc/passwd", 3))},
        {"negative size", file(digest(hash, UINT64_MAX))},
        {"digest without a hash", file(number_field(2, 3))},
        {"two exit codes", number_field(4, 1) + number_field(4, 2)},
        {"two hashes", file(digest(hash, 3) + text_field(1, hash))},
        {"path with NUL", field(2, text_field(1, std::string_view("a\0b", 3)) + field(2, digest(hash, 3)))},
        {"path too long", field(2, text_field(1, std::string(5000, 'a')) + field(2, digest(hash, 3)))},
        {"directory without a tree", field(3, text_field(1, "d"))},
    };
    for (const auto& [name, bytes] : bad) EXPECT_FALSE(parse_action_result(bytes).ok()) << name;
}

TEST(ActionResult, EveryTruncationIsRefusedOrShorter) {
    const Bytes whole = serialise(full());
    for (size_t n = 0; n < whole.size(); ++n) {
        const auto part = parse_action_result(ByteView(whole).first(n));
        EXPECT_TRUE(!part.ok() || *part != full()) << n;
    }
}

TEST(ActionResult, OutputsAreBounded) {
    const Bytes link = field(12, text_field(1, "n"));
    Bytes many;
    for (size_t i = 0; i < most_outputs; ++i) many.insert(many.end(), link.begin(), link.end());
    EXPECT_TRUE(parse_action_result(many).ok());
    EXPECT_FALSE(parse_action_result(many + link).ok());
}

TEST(Tree, GivesTheFilesOfAllItsDirectories) {
    const auto node = [](std::string_view name, std::string_view bytes) {
        return field(1, text_field(1, name) + field(2, digest(blob_of(bytes).digest.hex(), bytes.size())));
    };
    const Bytes below = field(2, text_field(1, "sub") + field(2, digest(blob_of("dir").digest.hex(), 3)));
    const Bytes tree = field(1, node("a", "one") + below) + field(2, node("b", "three")) + field(2, {});
    const auto files = parse_tree_files(tree);
    ASSERT_TRUE(files.ok());
    EXPECT_EQ(*files, (std::vector<BlobName>{blob_of("one"), blob_of("three")}));
    EXPECT_TRUE(parse_tree_files({})->empty());
    EXPECT_FALSE(parse_tree_files(field(1, field(1, text_field(1, "a")))).ok()) << "a file without a digest";
    EXPECT_FALSE(parse_tree_files(Bytes{0x0a, 5}).ok());
}

TEST(OutputPath, StaysBelow) {
    for (const char* good : {"a", "a/b.spv", "a..b", "..a", ".hidden"}) EXPECT_TRUE(stays_below(good)) << good;
    for (const char* bad : {"", "/", "/a", "a/", "a//b", ".", "..", "../a", "a/../../b", "a/..", "./a", "a\\..\\b"})
        EXPECT_FALSE(stays_below(bad)) << bad;
    EXPECT_FALSE(stays_below(std::string_view("a\0b", 3)));
}

}  // namespace
}  // namespace kiln
