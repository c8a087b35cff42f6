// One process, one folder: what goes in comes out, and nothing damaged ever does.
#include "cache/disk_store.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

namespace fs = std::filesystem;

constexpr Keyspace both[] = {Keyspace::action, Keyspace::blob};

std::unique_ptr<DiskStore> open_store(const std::string& folder) {
    auto store = DiskStore::open(folder);
    EXPECT_TRUE(store.ok()) << store.error().message;
    return std::move(*store);
}

// The entry's text, "(absent)" or "(error)".
std::string look(Store& store, Keyspace space, const Digest& key) {
    const auto got = store.get(space, key);
    if (!got.ok()) return "(error)";
    return got->has_value() ? std::string(as_text(**got)) : "(absent)";
}

TEST(DiskStore, KeepsBothKeyspacesApart) {
    const TestFolder folder;
    const auto store = open_store(folder.path() + "/made/on/demand");
    const Digest key = name_of("text");
    EXPECT_EQ(look(*store, Keyspace::action, key), "(absent)");
    ASSERT_TRUE(store->put(Keyspace::action, key, as_bytes("record")).ok());
    EXPECT_EQ(look(*store, Keyspace::blob, key), "(absent)");
    ASSERT_TRUE(store->put(Keyspace::blob, key, as_bytes("text")).ok());
    EXPECT_EQ(look(*store, Keyspace::action, key), "record");
    EXPECT_EQ(look(*store, Keyspace::blob, key), "text");
    EXPECT_EQ(look(*open_store(store->folder()), Keyspace::blob, key), "text");
    EXPECT_EQ(store->counters().hits, 2u);
    EXPECT_EQ(store->counters().misses, 2u);
}

TEST(DiskStore, ActionRecordsAreReplacedAndBlobsWrittenOnce) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const Digest key = name_of("blob");
    ASSERT_TRUE(store->put(Keyspace::action, key, as_bytes("one")).ok());
    ASSERT_TRUE(store->put(Keyspace::action, key, as_bytes("three")).ok());
    EXPECT_EQ(look(*store, Keyspace::action, key), "three");
    ASSERT_TRUE(store->put(Keyspace::blob, key, as_bytes("blob")).ok());
    ASSERT_TRUE(store->put(Keyspace::blob, key, as_bytes("blob")).ok());
    EXPECT_EQ(store->counters().written, 3u);
    EXPECT_EQ(store->counters().already_there, 1u);
}

TEST(DiskStore, HoldsEmptyAndLargeEntries) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const std::string large(9'000'001, 'x');
    for (const Keyspace space : both) {
        for (const std::string& text : {std::string(), large}) {
            ASSERT_TRUE(store->put(space, name_of(text), as_bytes(text)).ok());
            EXPECT_TRUE(look(*store, space, name_of(text)) == text);
        }
    }
}

TEST(DiskStore, RefusesABlobUnderAForeignName) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    EXPECT_FALSE(store->put(Keyspace::blob, name_of("a"), as_bytes("b")).ok());
    EXPECT_EQ(look(*store, Keyspace::blob, name_of("a")), "(absent)");
    EXPECT_EQ(store->stats()->blob.entries, 0u);
    EXPECT_EQ(store->counters().failures, 1u);
}

TEST(DiskStore, EveryTruncationIsAMissThatHeals) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const std::string text = "the record's payload";
    const Digest key = name_of(text);
    for (const Keyspace space : both) {
        const std::string path = path_of(folder.path(), space, key);
        ASSERT_TRUE(store->put(space, key, as_bytes(text)).ok());
        const std::string whole = read_file(path);
        ASSERT_GE(whole.size(), text.size());
        for (size_t length = 0; length < whole.size(); ++length) {
            write_file(path, std::string_view(whole).substr(0, length));
            EXPECT_EQ(look(*store, space, key), "(absent)") << length;
            EXPECT_FALSE(fs::exists(path));
            ASSERT_TRUE(store->put(space, key, as_bytes(text)).ok());
            EXPECT_EQ(look(*store, space, key), text);
        }
        write_file(path, whole + '\0');
        EXPECT_EQ(look(*store, space, key), "(absent)");
    }
}

TEST(DiskStore, EveryFlippedBitIsAMiss) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const std::string text = "payload";
    const Digest key = name_of(text);
    uint64_t flips = 0;
    for (const Keyspace space : both) {
        const std::string path = path_of(folder.path(), space, key);
        ASSERT_TRUE(store->put(space, key, as_bytes(text)).ok());
        const std::string whole = read_file(path);
        for (size_t bit = 0; bit < whole.size() * 8; ++bit) {
            std::string bad = whole;
            bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
            write_file(path, bad);
            EXPECT_EQ(look(*store, space, key), "(absent)") << "bit " << bit;
            ++flips;
        }
    }
    EXPECT_EQ(store->counters().corrupt, flips);
}

TEST(DiskStore, AnEntryMovedToAnotherNameIsAMiss) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    for (const Keyspace space : both) {
        const Digest here = name_of("here"), there = name_of("there");
        ASSERT_TRUE(store->put(space, here, as_bytes("here")).ok());
        fs::create_directories(fs::path(path_of(folder.path(), space, there)).parent_path());
        fs::copy_file(path_of(folder.path(), space, here), path_of(folder.path(), space, there));
        EXPECT_EQ(look(*store, space, there), "(absent)");
        EXPECT_EQ(look(*store, space, here), "here");
    }
}

TEST(DiskStore, StrangeThingsUnderAnEntrysNameAreMisses) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    const Digest key = name_of("x");
    const std::string path = path_of(folder.path(), Keyspace::blob, key);
    fs::create_directories(path + "/full");
    EXPECT_EQ(look(*store, Keyspace::blob, key), "(absent)");
    EXPECT_FALSE(store->put(Keyspace::blob, key, as_bytes("x")).ok());  // never removes a folder
    EXPECT_TRUE(fs::exists(path + "/full"));
    fs::remove_all(path);
    ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
    EXPECT_EQ(look(*store, Keyspace::blob, key), "(absent)");  // and does not hang
    ASSERT_TRUE(store->put(Keyspace::blob, key, as_bytes("x")).ok());
    EXPECT_EQ(look(*store, Keyspace::blob, key), "x");
}

TEST(DiskStore, CountsAndClearsOnlyItsOwnFiles) {
    const TestFolder folder;
    const auto store = open_store(folder.path());
    ASSERT_TRUE(store->put(Keyspace::blob, name_of("12345"), as_bytes("12345")).ok());
    ASSERT_TRUE(store->put(Keyspace::blob, name_of("123"), as_bytes("123")).ok());
    ASSERT_TRUE(store->put(Keyspace::action, name_of("k"), as_bytes("v")).ok());
    write_file(folder.path() + "/tmp/0123456789abcdef.part", "left over");
    const std::string hex = name_of("12345").hex();
    const std::string kept[] = {folder.path() + "/notes.txt", folder.path() + "/tmp/mine.part",
                                folder.path() + "/blob/" + hex.substr(0, 2) + "/" + hex + ".bak"};
    for (const std::string& path : kept) write_file(path, "keep");
    const auto stats = store->stats();
    ASSERT_TRUE(stats.ok());
    EXPECT_EQ(stats->blob.entries, 2u);
    EXPECT_EQ(stats->blob.bytes, 8u);
    EXPECT_EQ(stats->action.entries, 1u);
    EXPECT_EQ(stats->action.bytes, 65u);  // the frame's 64 bytes and the payload
    EXPECT_EQ(stats->temporary.entries, 1u);
    const auto removed = store->clear();
    ASSERT_TRUE(removed.ok());
    EXPECT_EQ(removed->blob.entries + removed->action.entries + removed->temporary.entries, 4u);
    EXPECT_EQ(store->stats()->blob.entries, 0u);
    EXPECT_EQ(look(*store, Keyspace::action, name_of("k")), "(absent)");
    for (const std::string& path : kept) EXPECT_TRUE(fs::exists(path)) << path;
    ASSERT_TRUE(store->put(Keyspace::action, name_of("k"), as_bytes("v")).ok());
}

TEST(DiskStore, SweepsOldTemporariesOnOpenAndLeavesYoungOnes) {
    const TestFolder folder;
    fs::create_directories(folder.path() + "/tmp");
    const std::string old_one = folder.path() + "/tmp/0123456789abcdef.part";
    const std::string young = folder.path() + "/tmp/fedcba9876543210.part";
    write_file(old_one, "x");
    write_file(young, "x");
    fs::last_write_time(old_one, fs::file_time_type::clock::now() - std::chrono::hours(2));
    open_store(folder.path());
    EXPECT_FALSE(fs::exists(old_one));
    EXPECT_TRUE(fs::exists(young));
}

TEST(DiskStore, SurvivesItsFolderBeingRemoved) {
    const TestFolder folder;
    const auto store = open_store(folder.path() + "/store");
    ASSERT_TRUE(store->put(Keyspace::blob, name_of("a"), as_bytes("a")).ok());
    fs::remove_all(store->folder());
    EXPECT_EQ(look(*store, Keyspace::blob, name_of("a")), "(absent)");
    ASSERT_TRUE(store->put(Keyspace::blob, name_of("a"), as_bytes("a")).ok());
    EXPECT_EQ(look(*store, Keyspace::blob, name_of("a")), "a");
}

TEST(DiskStore, StaysWhereItWasOpenedWhenTheProcessMoves) {
    const TestFolder folder, elsewhere;
    const std::string before = fs::current_path().string();
    fs::current_path(folder.path());
    const auto store = open_store("relative");
    fs::current_path(elsewhere.path());
    const bool put = store->put(Keyspace::blob, name_of("a"), as_bytes("a")).ok();
    fs::current_path(before);
    EXPECT_TRUE(put);
    EXPECT_TRUE(fs::exists(path_of(folder.path() + "/relative", Keyspace::blob, name_of("a"))));
}

TEST(DiskStore, AFileInTheWayIsAnError) {
    const TestFolder folder;
    write_file(folder.path() + "/file", "x");
    EXPECT_FALSE(DiskStore::open(folder.path() + "/file").ok());
    EXPECT_FALSE(DiskStore::open(folder.path() + "/file/below").ok());
    EXPECT_FALSE(DiskStore::open("").ok());
}

TEST(DefaultCacheFolder, FollowsTheEnvironment) {
    const char* xdg = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    const std::string old_xdg = xdg ? xdg : "", old_home = home ? home : "";
    ::setenv("HOME", "/home/someone", 1);
    ::setenv("XDG_CACHE_HOME", "/cache", 1);
    EXPECT_EQ(default_cache_folder(), "/cache/kiln");
    ::setenv("XDG_CACHE_HOME", "not/absolute", 1);
    EXPECT_EQ(default_cache_folder(), "/home/someone/.cache/kiln");
    ::unsetenv("XDG_CACHE_HOME");
    ::unsetenv("HOME");
    EXPECT_EQ(default_cache_folder(), "");
    if (xdg) ::setenv("XDG_CACHE_HOME", old_xdg.c_str(), 1);
    if (home) ::setenv("HOME", old_home.c_str(), 1);
}

}  // namespace
}  // namespace kiln
