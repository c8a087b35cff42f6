// The bound and who goes first, with a clock of our own; and an index that may be lost at any time.
#include "cache/disk_bound.h"

#include <gtest/gtest.h>

#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t page = 4096;
constexpr int64_t minute = int64_t{60} * 1'000'000'000;
const int64_t start = int64_t{1'000'000} * minute;

// One-page entries: the text names itself.
std::string text_of(int i) { return "entry " + std::to_string(i); }

struct Bounded {
    TestFolder folder;
    int64_t time = start;
    std::unique_ptr<DiskStore> store;

    explicit Bounded(uint64_t pages, bool index = true) { open(pages, index); }
    void open(uint64_t pages, bool index = true) {
        store.reset();
        DiskOptions options = unflushed(pages * page);
        options.now = [this] { return time; };
        options.index = index;
        store = std::move(*DiskStore::open(folder.path(), options));
    }
    Status put(int i) {
        time += 2 * minute;
        return store->put(Keyspace::blob, name_of(text_of(i)), as_bytes(text_of(i)));
    }
    bool get(int i) {
        time += 2 * minute;
        const auto got = store->get(Keyspace::blob, name_of(text_of(i)));
        return got.ok() && got->has_value();
    }
    bool there(int i) const { return fs::exists(path_of(folder.path(), Keyspace::blob, name_of(text_of(i)))); }
    int count() const { return static_cast<int>(store->stats()->blob.entries); }
    // What the index says, once the store has closed it.
    IndexTotals index() {
        store.reset();
        const auto index = DiskIndex::open(folder.path());
        if (!index.ok() || !(*index)->built()) return {};
        const IndexTotals totals = (*(*index)->change())->totals();
        (*index)->close();
        return totals;
    }
};

class Bound : public testing::TestWithParam<bool> {};

TEST_P(Bound, TheLeastRecentlyUsedGoUntilTheLowWatermark) {
    Bounded b(20, GetParam());
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(b.put(i).ok());
    EXPECT_EQ(b.count(), 20);  // at the bound, not over it
    EXPECT_TRUE(b.get(0));     // a use, which the index does not hear of
    ASSERT_TRUE(b.put(20).ok());
    EXPECT_EQ(b.count(), 18);  // nine tenths
    EXPECT_TRUE(b.there(0));
    for (int i = 1; i <= 3; ++i) EXPECT_FALSE(b.there(i)) << i;
    for (int i = 4; i <= 20; ++i) EXPECT_TRUE(b.there(i)) << i;
    EXPECT_EQ(b.store->counters().evicted, 3u);
}

TEST_P(Bound, HoldsAfterEveryPut) {
    Bounded b(10, GetParam());
    for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(b.put(i).ok());
        ASSERT_LE(b.store->stats()->entries().charged, 10 * page);
        ASSERT_TRUE(b.there(i));
    }
}

TEST_P(Bound, CountsWholePagesAndRefusesWhatNeverFits) {
    Bounded b(4, GetParam());
    const std::string big(2 * page + 1, 'b'), huge(4 * page + 1, 'h');
    ASSERT_TRUE(b.put(1).ok());
    b.time += minute;
    ASSERT_TRUE(b.store->put(Keyspace::blob, name_of(big), as_bytes(big)).ok());
    EXPECT_EQ(b.store->stats()->entries().charged, 4 * page);  // one page and three: at the bound
    EXPECT_TRUE(b.there(1));
    EXPECT_FALSE(b.store->put(Keyspace::blob, name_of(huge), as_bytes(huge)).ok());
    EXPECT_TRUE(fs::exists(path_of(b.folder.path(), Keyspace::blob, name_of(big))));
    EXPECT_EQ(b.store->stats()->temporary.entries, 0u);
}

TEST_P(Bound, AReplacedRecordIsCountedOnce) {
    Bounded b(8, GetParam());
    for (int i = 0; i < 200; ++i) {
        const std::string record(static_cast<size_t>(i % 3) * page, 'r');
        b.time += 2 * minute;
        ASSERT_TRUE(b.store->put(Keyspace::action, name_of("k"), as_bytes(record + std::to_string(i))).ok());
        ASSERT_LE(b.store->stats()->entries().charged, 8 * page);
    }
    EXPECT_EQ(b.store->counters().evicted, 0u);
}

TEST_P(Bound, TwoStoresOfOneFolderKeepOneBound) {
    Bounded b(12, GetParam());
    DiskOptions options = unflushed(12 * page);
    options.now = [&] { return b.time; };
    options.index = GetParam();
    const auto other = std::move(*DiskStore::open(b.folder.path(), options));
    for (int i = 0; i < 60; i += 2) {
        ASSERT_TRUE(b.put(i).ok());
        ASSERT_TRUE(other->put(Keyspace::blob, name_of(text_of(i + 1)), as_bytes(text_of(i + 1))).ok());
        // Without an index each may pass the bound by a sixteenth before it looks again: here, one page each.
        ASSERT_LE(b.store->stats()->entries().charged, (GetParam() ? 12 : 14) * page);
    }
}

INSTANTIATE_TEST_SUITE_P(ByIndexAndByScan, Bound, testing::Bool(),
                         [](const auto& which) { return which.param ? "Index" : "Scan"; });

TEST(DiskBound, GcStopsAtItsTargetAndLeavesAnIndexThatAgrees) {
    Bounded b(100);
    for (int i = 0; i < 50; ++i) ASSERT_TRUE(b.put(i).ok());
    const auto shrunk = b.store->gc(20 * page);
    ASSERT_TRUE(shrunk.ok());
    EXPECT_EQ(shrunk->before.entries, 50u);
    EXPECT_EQ(shrunk->evicted.entries, 30u);
    for (int i = 0; i < 50; ++i) EXPECT_EQ(b.there(i), i >= 30) << i;
    const IndexTotals totals = b.index();
    EXPECT_EQ(totals.entries, 20u);
    EXPECT_EQ(totals.charged, 20 * page);
}

// Whatever was done to the index: nothing is lost, and the next put knows what is there.
TEST(DiskBound, ALostOrDamagedIndexCostsAScanAndNoEntry) {
    const auto lose = [](const std::string& folder) { fs::remove_all(folder + "/index"); };
    const auto truncate = [](const std::string& folder) { fs::resize_file(folder + "/index/data.mdb", 5000); };
    const auto empty = [](const std::string& folder) { fs::resize_file(folder + "/index/data.mdb", 0); };
    const auto rubbish = [](const std::string& folder) { write_file(folder + "/index/data.mdb", std::string(40'960, '\xa5')); };
    const auto no_mark = [](const std::string& folder) { fs::remove(folder + "/index/clean"); };
    const auto bad_mark = [](const std::string& folder) { write_file(folder + "/index/clean", "clean"); };
    const auto a_folder = [](const std::string& folder) {
        fs::remove(folder + "/index/data.mdb");
        fs::create_directories(folder + "/index/data.mdb/x");
    };
    const auto a_file = [](const std::string& folder) {
        fs::remove_all(folder + "/index");
        write_file(folder + "/index", "x");
    };
    const std::function<void(const std::string&)> hurts[] = {lose, truncate, empty, rubbish, no_mark, bad_mark, a_folder, a_file};
    for (size_t h = 0; h < std::size(hurts); ++h) {
        Bounded b(20);
        for (int i = 0; i < 20; ++i) ASSERT_TRUE(b.put(i).ok());
        ASSERT_EQ(b.index().entries, 20u);
        hurts[h](b.folder.path());
        b.open(20);
        EXPECT_EQ(b.count(), 20) << h;
        ASSERT_TRUE(b.put(20).ok()) << h;
        EXPECT_EQ(b.count(), 18) << h;
        EXPECT_FALSE(b.there(0)) << h;
        EXPECT_TRUE(b.there(19)) << h;
        if (h < 6) {
            EXPECT_EQ(b.index().entries, 18u) << h;
        }
    }
}

TEST(DiskBound, EveryFlippedByteOfTheIndexIsNoticed) {
    Bounded b(20);
    for (int i = 0; i < 12; ++i) ASSERT_TRUE(b.put(i).ok());
    b.store.reset();
    const std::string data = b.folder.path() + "/index/data.mdb", mark = b.folder.path() + "/index/clean";
    const std::string whole = read_file(data), clean = read_file(mark);
    ASSERT_GT(whole.size(), 3 * page);
    for (size_t at = 0; at < whole.size(); at += 97) {
        std::string bad = whole;
        bad[at] = static_cast<char>(bad[at] ^ (1 << (at % 8)));
        write_file(data, bad);
        write_file(mark, clean);
        const auto index = DiskIndex::open(b.folder.path());
        ASSERT_TRUE(index.ok());
        ASSERT_FALSE((*index)->built()) << at;
    }
    // And unharmed it is taken as it is.
    write_file(data, whole);
    write_file(mark, clean);
    EXPECT_EQ(b.index().entries, 12u);
}

TEST(DiskBound, AnIndexTakenAwayWhileItIsOpenIsBuiltAgain) {
    Bounded b(20);
    for (int i = 0; i < 19; ++i) ASSERT_TRUE(b.put(i).ok());
    fs::remove_all(b.folder.path() + "/index");
    ASSERT_TRUE(b.put(19).ok());
    EXPECT_EQ(b.count(), 20);
    ASSERT_TRUE(b.put(20).ok());
    EXPECT_EQ(b.count(), 18);
    EXPECT_EQ(b.index().entries, 18u);
}

TEST(DiskBound, AFailingIndexFallsBackToScans) {
    Bounded b(20);
    DiskOptions options = unflushed(20 * page);
    options.now = [&] { return b.time; };
    options.before = [](DiskStep step) { return step == DiskStep::account ? EIO : 0; };
    b.store = std::move(*DiskStore::open(b.folder.path(), options));
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(b.put(i).ok());
    EXPECT_LE(b.count(), 20);
    EXPECT_TRUE(b.there(29));
    EXPECT_FALSE(b.there(0));
}

TEST(DiskBound, EntriesThatCannotBeRemovedMakeThePutAnError) {
    Bounded b(10);
    DiskOptions options = unflushed(10 * page);
    options.now = [&] { return b.time; };
    options.before = [](DiskStep step) { return step == DiskStep::evict ? EACCES : 0; };
    for (const bool index : {true, false}) {
        options.index = index;
        b.store = std::move(*DiskStore::open(b.folder.path(), options));
        size_t refused = 0;
        for (int i = 0; i < 20; ++i) refused += !b.put(i).ok();
        EXPECT_EQ(refused, 10u);
        EXPECT_EQ(b.count(), 10);
    }
}

}  // namespace
}  // namespace kiln
