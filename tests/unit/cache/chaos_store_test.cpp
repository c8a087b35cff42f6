#include "cache/chaos_store.h"

#include <gtest/gtest.h>

#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

TEST(Chaos, IsReadFromText) {
    const auto all = Chaos::parse("seed=7,loss=0.25,error=1,flip=0,delay=3");
    ASSERT_TRUE(all.ok());
    EXPECT_EQ(all->seed, 7u);
    EXPECT_EQ(all->loss, 0.25);
    EXPECT_EQ(all->error, 1.0);
    EXPECT_EQ(all->delay, 3u);
    EXPECT_TRUE(Chaos::parse("").ok());
    for (const char* bad : {"loss", "loss=", "loss=1.5", "loss=-1", "loss=nan", "loss=0..1", "lose=0.1", "seed=x", "delay=60001",
                            "seed=1,,loss=0.1", "seed=1;loss=0.1"})
        EXPECT_FALSE(Chaos::parse(bad).ok()) << bad;
}

// What a run with that chaos did, over 200 puts and gets of a disk store.
ChaosStore::Counters run(const std::string& spec, int& wrong, int& found) {
    const TestFolder folder;
    const auto disk = std::move(*DiskStore::open(folder.path(), unflushed()));
    ChaosStore store(*disk, *Chaos::parse(spec),
                     [&](Keyspace space, const Digest& key, uint64_t dice) { return flip_bit(disk->path_of(space, key), dice); });
    wrong = found = 0;
    for (int i = 0; i < 200; ++i) {
        const std::string text = "text " + std::to_string(i);
        const Keyspace space = i % 2 == 0 ? Keyspace::blob : Keyspace::action;
        (void)store.put(space, name_of(text), as_bytes(text)).ok();
        const auto got = store.get(space, name_of(text));
        if (!got.ok() || !got->has_value()) continue;
        ++found;
        wrong += as_text(**got) != text;
    }
    return store.counters();
}

TEST(Chaos, WithoutChancesNothingHappens) {
    int wrong = 0, found = 0;
    const auto did = run("seed=1", wrong, found);
    EXPECT_EQ(did.lost + did.failed + did.flipped + did.delayed, 0u);
    EXPECT_EQ(found, 200);
    EXPECT_EQ(wrong, 0);
}

TEST(Chaos, HurtsAsOftenAsAskedAndNeverGivesWrongBytes) {
    int wrong = 0, found = 0;
    const auto did = run("seed=1,loss=0.2,error=0.2,flip=0.2,delay=1", wrong, found);
    // Of 400 calls about 80 fail and 64 of the rest are lost; about 51 gets that would have found something meet a flip.
    EXPECT_NEAR(static_cast<double>(did.failed), 80, 40);
    EXPECT_NEAR(static_cast<double>(did.lost), 64, 35);
    EXPECT_GT(did.flipped, 5u);
    EXPECT_EQ(did.delayed, 400u);
    EXPECT_GT(found, 20);
    EXPECT_EQ(wrong, 0);
}

TEST(Chaos, FollowsFromItsSeed) {
    int wrong = 0, first = 0, second = 0, other = 0;
    const auto a = run("seed=5,loss=0.3,error=0.1", wrong, first);
    const auto b = run("seed=5,loss=0.3,error=0.1", wrong, second);
    const auto c = run("seed=6,loss=0.3,error=0.1", wrong, other);
    EXPECT_EQ(a.lost, b.lost);
    EXPECT_EQ(a.failed, b.failed);
    EXPECT_EQ(first, second);
    EXPECT_TRUE(a.lost != c.lost || a.failed != c.failed || first != other);
}

TEST(Chaos, EveryFlipIsFound) {
    int wrong = 0, found = 0;
    const auto did = run("seed=3,flip=1", wrong, found);
    EXPECT_EQ(did.flipped, 200u);
    EXPECT_EQ(found, 0);
}

}  // namespace
}  // namespace kiln
