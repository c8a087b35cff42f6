// One key, 64 writers, and readers meanwhile: old, new or absent, never a part and never a mixture. Run under ThreadSanitizer,
// too.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

std::string record(int writer) { return std::string(2000 + static_cast<size_t>(writer) * 113, static_cast<char>('0' + writer)); }

bool is_record(std::string_view text) { return !text.empty() && text == record(text.front() - '0'); }

TEST(DiskThreads, SixtyFourWritersOfOneKeyWithReaders) {
    const TestFolder folder;
    const auto one = std::move(*DiskStore::open(folder.path(), unflushed()));
    const auto two = std::move(*DiskStore::open(folder.path(), unflushed()));  // as a second process would
    const Digest key = name_of("the key");
    const std::string blob(30'000, 'b');
    std::atomic<int> failed{0}, wrong{0}, read{0};
    std::atomic<bool> done{false};
    std::vector<std::thread> writers, readers;
    for (int w = 0; w < 64; ++w) {
        writers.emplace_back([&, w] {
            DiskStore& store = w % 2 == 0 ? *one : *two;
            for (int i = 0; i < 4; ++i) {
                failed += !store.put(Keyspace::action, key, as_bytes(record(w))).ok();
                failed += !store.put(Keyspace::blob, name_of(blob), as_bytes(blob)).ok();
            }
        });
    }
    for (int r = 0; r < 4; ++r) {
        readers.emplace_back([&, r] {
            DiskStore& store = r % 2 == 0 ? *one : *two;
            bool seen = false;
            do {
                const auto got = store.get(Keyspace::action, key);
                if (!got.ok() || (seen && !got->has_value())) ++wrong;
                if (got.ok() && got->has_value()) {
                    seen = true;
                    ++read;
                    wrong += !is_record(as_text(**got));
                }
                const auto same = store.get(Keyspace::blob, name_of(blob));
                wrong += !same.ok() || (same->has_value() && as_text(**same) != blob);
            } while (!done);
        });
    }
    for (std::thread& t : writers) t.join();
    done = true;
    for (std::thread& t : readers) t.join();
    EXPECT_EQ(failed, 0);
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(read, 0);
    EXPECT_EQ(one->counters().corrupt + two->counters().corrupt, 0u);
    EXPECT_EQ(one->stats()->entries().entries, 2u);
    EXPECT_EQ(one->stats()->temporary.entries, 0u);
    EXPECT_TRUE(one->verify()->damaged.empty());
    // The control: a mixture would have been told apart.
    EXPECT_FALSE(is_record(record(3).substr(1)));
    EXPECT_FALSE(is_record(record(3) + record(4)));
}

TEST(DiskThreads, EverythingAtOnceUnderASmallBound) {
    const TestFolder folder;
    constexpr uint64_t limit = 60 * 4096;
    const auto store = std::move(*DiskStore::open(folder.path(), unflushed(limit)));
    std::atomic<int> wrong{0}, checked{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 6; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 120; ++i) {
                const std::string text = std::to_string(i % 100) + std::string(static_cast<size_t>(i % 7) * 1500, 'x');
                if (t == 5) {
                    // What gc() finds, it finds under the lock: a true sum, where stats() walks while others write.
                    const auto shrunk = store->gc(i % 2 == 0 ? limit : limit / 2);
                    wrong += !shrunk.ok() || shrunk->before.charged > limit || !store->verify().ok();
                    checked += shrunk.ok() && shrunk->before.charged > 0;
                    std::this_thread::sleep_for(std::chrono::milliseconds(1));
                } else if ((i + t) % 3 == 0) {
                    const auto got = store->get(Keyspace::blob, name_of(text));
                    wrong += !got.ok() || (got->has_value() && as_text(**got) != text);
                } else {
                    wrong += !store->put(Keyspace::blob, name_of(text), as_bytes(text)).ok();
                }
            }
        });
    }
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(checked, 0);
    EXPECT_GT(store->counters().evicted, 0u);
    EXPECT_EQ(store->counters().corrupt, 0u);
}

}  // namespace
}  // namespace kiln
