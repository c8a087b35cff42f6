// verify() finds every damaged entry, keeps it as evidence, and touches nothing that is good.
#include <gtest/gtest.h>

#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<DiskStore> open_store(const std::string& folder, DiskOptions options = unflushed()) {
    return std::move(*DiskStore::open(folder, std::move(options)));
}

TEST(DiskVerify, FindsEveryFlippedBit) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const std::string text = "blob!";
    const Digest key = name_of(text);
    for (const Keyspace space : {Keyspace::action, Keyspace::blob}) {
        ASSERT_TRUE(store->put(space, key, as_bytes(text)).ok());
        const std::string path = path_of(folder.path(), space, key), whole = read_file(path);
        for (size_t bit = 0; bit < whole.size() * 8; ++bit) {
            std::string bad = whole;
            bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
            write_file(path, bad);
            const auto found = store->verify();
            ASSERT_TRUE(found.ok());
            ASSERT_EQ(found->damaged.size(), 1u) << "bit " << bit;
            EXPECT_EQ(found->damaged[0].path, path);
            EXPECT_FALSE(found->damaged[0].reason.empty());
            EXPECT_EQ(read_file(found->damaged[0].kept), bad);  // the evidence, as it was
            EXPECT_FALSE(fs::exists(path));
        }
        write_file(path, whole);
        EXPECT_TRUE(store->verify()->damaged.empty());
    }
    EXPECT_EQ(store->verify()->checked.entries, 2u);
    EXPECT_LE(store->stats()->quarantine.entries, DiskStore::most_quarantined);
    EXPECT_GT(store->stats()->quarantine.entries, DiskStore::most_quarantined / 2);
}

TEST(DiskVerify, SaysWhatIsWrong) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const Digest key = name_of("k"), other = name_of("other");
    const std::string path = path_of(folder.path(), Keyspace::action, key);
    ASSERT_TRUE(store->put(Keyspace::action, key, as_bytes("record")).ok());
    ASSERT_TRUE(store->put(Keyspace::action, other, as_bytes("another")).ok());
    const std::string whole = read_file(path);
    std::string flipped = whole;
    flipped.back() = '!';
    const struct {
        std::string file, reason;
    } cases[] = {
        {whole.substr(0, 10), "shorter than its head"},
        {"KILNACT1" + whole.substr(8), "does not begin with kilnact1"},
        {whole.substr(0, whole.size() - 1), "its head says 6 bytes, it holds 5"},
        {flipped, "its checksum does not match"},
        {read_file(path_of(folder.path(), Keyspace::action, other)), "it is the record of " + other.hex()},
    };
    for (const auto& [file, reason] : cases) {
        write_file(path, file);
        const auto found = store->verify();
        ASSERT_EQ(found->damaged.size(), 1u) << reason;
        EXPECT_NE(found->damaged[0].reason.find(reason), std::string::npos) << found->damaged[0].reason;
    }
}

TEST(DiskVerify, AGoodEntryThatCameMeanwhileStays) {
    const TestFolder folder;
    const Digest key = name_of("text");
    const std::string path = path_of(folder.path(), Keyspace::blob, key);
    DiskOptions options = unflushed();
    const auto store = open_store(folder.path());
    ASSERT_TRUE(store->put(Keyspace::blob, key, as_bytes("text")).ok());
    write_file(path, "tex");
    // Another process writes it again between the read that found the damage and the lock.
    const auto other = open_store(folder.path());
    ASSERT_TRUE(other->put(Keyspace::blob, key, as_bytes("text")).ok());
    EXPECT_TRUE(store->verify()->damaged.empty());
    EXPECT_EQ(read_file(path), "text");
    EXPECT_EQ(other->counters().corrupt, 1u);  // put() found it, too
}

TEST(DiskVerify, WhatCannotBeMovedIsReportedAndStaysAbsent) {
    const TestFolder folder;
    DiskOptions options = unflushed();
    options.before = [](DiskStep step) { return step == DiskStep::quarantine ? EROFS : 0; };
    const auto store = open_store(folder.path(), options);
    const Digest key = name_of("text");
    ASSERT_TRUE(store->put(Keyspace::blob, key, as_bytes("text")).ok());
    write_file(path_of(folder.path(), Keyspace::blob, key), "tex");
    const auto found = store->verify();
    ASSERT_EQ(found->damaged.size(), 1u);
    EXPECT_TRUE(found->damaged[0].kept.empty());
    const auto got = store->get(Keyspace::blob, key);
    EXPECT_TRUE(got.ok() && !got->has_value());
}

TEST(DiskVerify, ClearTakesTheQuarantineToo) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    ASSERT_TRUE(store->put(Keyspace::blob, name_of("text"), as_bytes("text")).ok());
    write_file(path_of(folder.path(), Keyspace::blob, name_of("text")), "tex");
    EXPECT_EQ(store->verify()->damaged.size(), 1u);
    write_file(folder.path() + "/quarantine/notes", "mine");
    EXPECT_EQ(store->clear()->quarantine.entries, 1u);
    EXPECT_EQ(store->stats()->quarantine.entries, 0u);
    EXPECT_TRUE(fs::exists(folder.path() + "/quarantine/notes"));
}

TEST(DiskFind, TellsTheSizeAndCountsAsAUse) {
    const TestFolder folder;
    int64_t time = int64_t{1'000'000'000} * 1'000'000'000;
    DiskOptions options = unflushed();
    options.now = [&] { return time; };
    const auto store = open_store(folder.path(), options);
    const Digest key = name_of("text");
    EXPECT_FALSE((*store->find(Keyspace::blob, key)).has_value());
    for (const Keyspace space : {Keyspace::action, Keyspace::blob}) {
        ASSERT_TRUE(store->put(space, key, as_bytes("text")).ok());
        time += int64_t{3600} * 1'000'000'000;
        EXPECT_EQ(**store->find(space, key), 4u);
        struct stat info {};
        ASSERT_EQ(::stat(path_of(folder.path(), space, key).c_str(), &info), 0);
        EXPECT_EQ(time_of(info), time);
    }
}

}  // namespace
}  // namespace kiln
