// Disks that say no: full, read-only, forbidden, out of descriptors. Each is an Error, and what was there stays.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "cache/disk_store.h"
#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

constexpr int skipped = 77;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool sanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(undefined_behavior_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif
#else
constexpr bool sanitized = false;
#endif

// Runs `body` in a child, where limits and identities may be changed; its result is the exit code.
int in_child(const std::function<int()>& body) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(body());
    int status = 0;
    if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 99;
    return WEXITSTATUS(status);
}

bool holds(DiskStore& store, std::string_view text) {
    const auto got = store.get(Keyspace::blob, name_of(text));
    return got.ok() && got->has_value() && as_text(**got) == text;
}

Status put(DiskStore& store, std::string_view text) { return store.put(Keyspace::blob, name_of(text), as_bytes(text)); }

TEST(DiskStoreFaults, AFileSizeLimitFailsInTheMiddleOfAWrite) {
    const TestFolder folder;
    const int code = in_child([&] {
        auto store = DiskStore::open(folder.path());
        if (!put(**store, "before").ok()) return 1;
        ::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{10'000, 10'000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        const std::string big(50'000, 'b');
        const Status failed = put(**store, big);
        if (failed.ok() || failed.error().fault != Fault::environment) return 2;
        if (holds(**store, big) || !holds(**store, "before") || !put(**store, "after").ok()) return 3;
        return (*store)->stats()->temporary.entries == 0 ? 0 : 4;
    });
    EXPECT_EQ(code, 0);
}

TEST(DiskStoreFaults, NoFreeDescriptorIsAnErrorAndNoMiss) {
    if (sanitized) GTEST_SKIP() << "the undefined-behaviour sanitizer needs descriptors of its own";
    const TestFolder folder;
    const int code = in_child([&] {
        auto store = DiskStore::open(folder.path());
        if (!put(**store, "before").ok()) return 1;
        const rlimit limit{0, 0};
        ::setrlimit(RLIMIT_NOFILE, &limit);
        if ((*store)->get(Keyspace::blob, name_of("before")).ok()) return 2;
        if (put(**store, "after").ok()) return 3;
        return (*store)->counters().failures == 2 && (*store)->counters().corrupt == 0 ? 0 : 4;
    });
    EXPECT_EQ(code, 0);
}

// Gives up root, whom no permission stops. False when this process may not be held back at all.
bool become_ordinary(const std::string& folder) {
    if (::geteuid() != 0) return true;
    constexpr uid_t nobody = 65534;
    std::filesystem::permissions(folder, std::filesystem::perms(0755));
    return ::setgid(nobody) == 0 && ::setuid(nobody) == 0;
}

TEST(DiskStoreFaults, AReadOnlyFolderServesReads) {
    const TestFolder folder;
    ASSERT_TRUE(put(**DiskStore::open(folder.path()), "before").ok());
    const std::string damaged = path_of(folder.path(), Keyspace::action, name_of("bad"));
    std::filesystem::create_directories(std::filesystem::path(damaged).parent_path());
    write_file(damaged, "not a record");
    const auto all = std::filesystem::perms(0555);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
        if (entry.is_directory()) std::filesystem::permissions(entry.path(), all);
    std::filesystem::permissions(folder.path(), all);
    const int code = in_child([&] {
        if (!become_ordinary(folder.path())) return skipped;
        auto store = DiskStore::open(folder.path());
        if (!store.ok()) return 1;
        if (!holds(**store, "before")) return 2;
        if (put(**store, "after").ok()) return 3;
        const auto got = (*store)->get(Keyspace::action, name_of("bad"));
        if (!got.ok() || got->has_value()) return 4;  // damaged and not removable: still absent
        if ((*store)->clear().ok()) return 5;
        return holds(**store, "before") ? 0 : 6;
    });
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
        if (entry.is_directory()) std::filesystem::permissions(entry.path(), std::filesystem::perms(0755));
    if (code == skipped) GTEST_SKIP() << "cannot give up root here";
    EXPECT_EQ(code, 0);
}

TEST(DiskStoreFaults, AFolderThatMayNotBeEnteredIsAnError) {
    const TestFolder folder;
    const std::string inner = folder.path() + "/closed";
    std::filesystem::create_directories(inner);
    std::filesystem::permissions(inner, std::filesystem::perms::none);
    const int code = in_child([&] {
        if (!become_ordinary(folder.path())) return skipped;
        if (DiskStore::open(inner).ok()) return 1;
        return DiskStore::open(inner + "/below").ok() ? 2 : 0;
    });
    if (code == skipped) GTEST_SKIP() << "cannot give up root here";
    EXPECT_EQ(code, 0);
}

TEST(DiskStoreFaults, AFailureAtAnyStepIsAnErrorThatLeavesNothing) {
    const TestFolder folder;
    for (const Sync sync : {Sync::none, Sync::file, Sync::folder}) {
        for (const int code : {EIO, ENOSPC, EDQUOT, EACCES, EMFILE}) {
            for (const DiskStep bad : {DiskStep::create, DiskStep::write, DiskStep::sync, DiskStep::lock, DiskStep::rename}) {
                DiskOptions options;
                options.sync = sync;
                std::vector<DiskStep> seen;
                options.before = [&](DiskStep step) {
                    seen.push_back(step);
                    return step == bad ? code : 0;
                };
                const auto store = std::move(*DiskStore::open(folder.path(), options));
                const std::string text = std::to_string(code) + " " + std::to_string(static_cast<int>(bad));
                if (sync == Sync::none && bad == DiskStep::sync) continue;
                EXPECT_FALSE(put(*store, text).ok());
                EXPECT_EQ(seen.back(), bad);
                EXPECT_FALSE(holds(*store, text));
                EXPECT_EQ(store->stats()->temporary.entries, 0u);
            }
        }
    }
}

TEST(DiskStoreFaults, BytesAreFlushedBeforeTheyGetTheirName) {
    const TestFolder folder;
    DiskOptions options;
    options.sync = Sync::folder;
    std::vector<DiskStep> seen;
    options.before = [&](DiskStep step) {
        seen.push_back(step);
        return 0;
    };
    const auto store = std::move(*DiskStore::open(folder.path(), options));
    EXPECT_TRUE(put(*store, "text").ok());
    using S = DiskStep;
    EXPECT_EQ(seen, (std::vector<DiskStep>{S::create, S::create, S::write, S::sync, S::lock, S::account, S::rename}));
}

TEST(DiskStoreFaults, ASlowDiskOnlyTakesLonger) {
    const TestFolder folder;
    DiskOptions options = unflushed();
    options.before = [](DiskStep step) {
        if (step == DiskStep::rename || step == DiskStep::write) std::this_thread::sleep_for(std::chrono::milliseconds(10));
        return 0;
    };
    const auto one = std::move(*DiskStore::open(folder.path(), options));
    const auto two = std::move(*DiskStore::open(folder.path(), options));
    std::vector<std::thread> threads;
    std::atomic<int> failed{0};
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 5; ++i) {
                DiskStore& store = t % 2 == 0 ? *one : *two;
                const std::string text = std::to_string(t * 100 + i);
                failed += !put(store, text).ok() || !holds(store, text);
            }
        });
    }
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(failed, 0);
    EXPECT_EQ(one->stats()->blob.entries, 20u);
}

TEST(DiskStoreFaults, AStoppedProcessThatHoldsTheLockCostsOneWait) {
    const TestFolder folder;
    ASSERT_TRUE(put(**DiskStore::open(folder.path()), "before").ok());
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        FolderLock lock(folder.path() + "/lock", std::chrono::seconds(1));
        const auto held = lock.take();
        ::raise(SIGSTOP);
        ::_exit(held.ok() ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, WUNTRACED), child);
    ASSERT_TRUE(WIFSTOPPED(status));
    DiskOptions options = unflushed();
    options.lock_wait = std::chrono::milliseconds(50);
    const auto store = std::move(*DiskStore::open(folder.path(), options));
    size_t waits = 0;
    for (int i = 0; i < 100; ++i) {
        const auto start = std::chrono::steady_clock::now();
        EXPECT_FALSE(put(*store, std::to_string(i)).ok());
        waits += std::chrono::steady_clock::now() - start > std::chrono::milliseconds(45);
        EXPECT_TRUE(holds(*store, "before"));  // reads need no lock
    }
    EXPECT_LT(waits, 50u);
    EXPECT_EQ(store->stats()->temporary.entries, 0u);
    ::kill(child, SIGKILL);  // whose lock goes with it
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(put(**DiskStore::open(folder.path(), options), "after").ok());
}

TEST(DiskStoreFaults, AFullDiskIsAnErrorAndLosesNothing) {
    const TestFolder folder;
    if (::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=1m") != 0)
        GTEST_SKIP() << "may not mount a small tmpfs (needs root)";
    {
        auto store = DiskStore::open(folder.path());
        ASSERT_TRUE(store.ok());
        std::vector<std::string> kept;
        size_t refused = 0;
        for (int i = 0; i < 60; ++i) {
            const std::string text = std::to_string(i) + std::string(50'000, 'f');
            if (put(**store, text).ok())
                kept.push_back(text);
            else
                ++refused;
        }
        EXPECT_GT(kept.size(), 10u);
        EXPECT_GT(refused, 10u);
        for (const std::string& text : kept) EXPECT_TRUE(holds(**store, text));
        EXPECT_EQ((*store)->stats()->temporary.entries, 0u);
        EXPECT_EQ((*store)->counters().corrupt, 0u);
        EXPECT_TRUE((*store)->clear().ok());
        EXPECT_TRUE(put(**store, "room again").ok());
    }
    EXPECT_EQ(::umount(folder.path().c_str()), 0);
}

}  // namespace
}  // namespace kiln
