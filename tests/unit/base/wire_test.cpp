#include "compiler/base/wire.h"

#include <gtest/gtest.h>

#include "compiler/base/digest.h"
#include "compiler/base/jobs.h"
#include "compiler/base/store.h"

namespace kiln {
namespace {

Bytes sample() {
    WireWriter out;
    out.u8(7);
    out.u32(0x01020304);
    out.u64(1ull << 40);
    out.text("hello");
    return out.take();
}

bool read_sample(WireReader in) {
    const bool same = in.u8() == 7 && in.u32() == 0x01020304 && in.u64() == 1ull << 40 && in.text() == "hello";
    return same && in.ok() && in.at_end();
}

TEST(Wire, RoundTripsLittleEndian) {
    const Bytes bytes = sample();
    EXPECT_EQ(bytes[1], 4);
    EXPECT_TRUE(read_sample(WireReader(bytes)));
}

TEST(Wire, EveryTruncationFails) {
    const Bytes bytes = sample();
    for (size_t n = 0; n < bytes.size(); ++n) {
        const Bytes shorter(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
        EXPECT_FALSE(read_sample(WireReader(shorter))) << n;
    }
}

TEST(Wire, ALengthBeyondTheEndFails) {
    WireWriter out;
    out.u64(~0ull);
    const Bytes bytes = out.take();
    WireReader text(bytes);
    EXPECT_EQ(text.text(), "");
    EXPECT_FALSE(text.ok());
    WireReader count(bytes);
    EXPECT_EQ(count.count(1), 0u);
    EXPECT_FALSE(count.ok());
}

TEST(Digest, KnownValues) {
    EXPECT_EQ(sha256(as_bytes("abc")).hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256({}).hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(Digest::from_hex(sha256(as_bytes("abc")).hex()), sha256(as_bytes("abc")));
    EXPECT_FALSE(Digest::from_hex("xy").has_value());
}

TEST(KeyHasher, FieldsDoNotRunTogether) {
    const auto key = [](const char* a, const char* b) { return KeyHasher("t").field("a", a).field("b", b).finish(); };
    EXPECT_NE(key("xy", "z"), key("x", "yz"));
    EXPECT_NE(KeyHasher("t").field("a", "x").finish(), KeyHasher("u").field("a", "x").finish());
    EXPECT_EQ(key("x", "y"), key("x", "y"));
}

TEST(MemoryStore, RefusesABlobUnderAWrongName) {
    MemoryStore store;
    EXPECT_FALSE(store.put(Keyspace::blob, sha256(as_bytes("a")), as_bytes("b")).ok());
    EXPECT_TRUE(store.put(Keyspace::blob, sha256(as_bytes("a")), as_bytes("a")).ok());
    EXPECT_TRUE(store.get(Keyspace::blob, sha256(as_bytes("a"))).value().has_value());
    EXPECT_FALSE(store.get(Keyspace::action, sha256(as_bytes("a"))).value().has_value());
}

TEST(Jobs, RunsEveryIndexOnce) {
    for (const unsigned threads : {1u, 2u, 7u}) {
        std::vector<std::atomic<int>> seen(1000);
        EXPECT_TRUE(Jobs(threads).each(seen.size(), [&](size_t i) { ++seen[i]; }));
        for (const auto& n : seen) EXPECT_EQ(n, 1);
    }
}

TEST(Jobs, AnInterruptStopsTheLoop) {
    std::atomic<size_t> ran{0};
    EXPECT_FALSE(Jobs(2).each(1'000'000, [&](size_t) {
        ++ran;
        interrupted = true;
    }));
    interrupted = false;
    EXPECT_LE(ran, 2u);
}

}  // namespace
}  // namespace kiln
