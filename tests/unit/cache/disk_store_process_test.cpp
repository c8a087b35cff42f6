// Several processes in one folder, and processes that are killed in the middle of a write.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <thread>

#include "cache/disk_store.h"
#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

// Blob i of a set that every process knows; sizes from 0 to 40,000 bytes.
std::string blob(uint32_t i) {
    std::string text(i * 7919u % 40'001u, '\0');
    for (size_t at = 0; at < text.size(); ++at) text[at] = static_cast<char>(at * (i + 1) >> 3);
    return text + std::to_string(i);
}

// What an action's record says: a text that names its own key, so that a reader can tell a whole one.
std::string record(const Digest& key, uint32_t writer) {
    return key.hex() + std::string(500 + writer * 100, static_cast<char>('p' + writer)) + key.hex();
}

bool is_record(std::string_view text, const Digest& key) {
    const std::string hex = key.hex();
    return text.size() >= 628 && text.substr(0, 64) == hex && text.substr(text.size() - 64) == hex &&
           text.find_first_not_of(text[64], 64) == text.size() - 64;
}

// Puts and gets at random; returns the number of wrong answers.
int hammer(DiskStore& store, uint32_t seed, int rounds) {
    std::mt19937 random(seed);
    int wrong = 0;
    for (int i = 0; i < rounds; ++i) {
        const auto n = static_cast<uint32_t>(random() % 60);
        const std::string text = blob(n);
        const Digest key = sha256(as_bytes(text));
        const Keyspace space = random() % 2 == 0 ? Keyspace::blob : Keyspace::action;
        if (random() % 2 == 0) {
            const std::string bytes = space == Keyspace::blob ? text : record(key, seed % 8);
            if (!store.put(space, key, as_bytes(bytes)).ok()) ++wrong;
        } else {
            const auto got = store.get(space, key);
            if (!got.ok())
                ++wrong;
            else if (got->has_value() && space == Keyspace::blob)
                wrong += as_text(**got) != text;
            else if (got->has_value())
                wrong += !is_record(as_text(**got), key);
        }
    }
    return wrong;
}

TEST(DiskStoreProcesses, FourProcessesOfTwoThreadsShareAFolder) {
    const TestFolder folder;
    std::vector<pid_t> children;
    for (uint32_t p = 0; p < 4; ++p) {
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            auto store = DiskStore::open(folder.path(), unflushed());
            if (!store.ok()) ::_exit(100);
            int wrong[2] = {};
            std::thread other([&] { wrong[1] = hammer(**store, 100 + p, 600); });
            wrong[0] = hammer(**store, p, 600);
            other.join();
            // Nobody damages entries here, so none may look damaged.
            const bool clean = (*store)->counters().corrupt == 0;
            ::_exit(clean ? std::min(wrong[0] + wrong[1], 99) : 101);
        }
        children.push_back(child);
    }
    for (const pid_t child : children) {
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 0);
    }
    const auto stats = (*DiskStore::open(folder.path(), unflushed()))->stats();
    EXPECT_EQ(stats->temporary.entries, 0u);
    EXPECT_LE(stats->blob.entries, 60u);
    EXPECT_GT(stats->blob.entries, 40u);
}

TEST(DiskStoreProcesses, ClearingUnderWritersCostsOnlyMisses) {
    const TestFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        auto store = DiskStore::open(folder.path(), unflushed());
        // A temporary file may be cleared before its rename; that put is an Error, and the only wrong answer there can be.
        int bad = 0;
        for (int i = 0; i < 800; ++i) {
            const std::string text = blob(static_cast<uint32_t>(i % 60));
            const Digest key = sha256(as_bytes(text));
            (void)(*store)->put(Keyspace::blob, key, as_bytes(text)).ok();
            const auto got = (*store)->get(Keyspace::blob, key);
            bad += !got.ok() || (got->has_value() && as_text(**got) != text);
        }
        ::_exit(bad == 0 ? 0 : 1);
    }
    auto store = DiskStore::open(folder.path(), unflushed());
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) EXPECT_TRUE((*store)->clear().ok());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(DiskStoreProcesses, KilledWritersLeaveNothingHalfWritten) {
    const TestFolder folder;
    std::mt19937 random(20);
    for (uint32_t round = 0; round < 25; ++round) {
        int written[2];  // a byte a pair of entries: a busy machine must not kill writers before they have written
        ASSERT_EQ(::pipe(written), 0);
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            auto store = DiskStore::open(folder.path(), unflushed());
            for (uint32_t i = 0;; ++i) {
                if (i != 0 && i < 300) (void)!::write(written[1], "", 1);
                const std::string text = blob(round * 1000 + i % 300);
                (void)(*store)->put(Keyspace::blob, sha256(as_bytes(text)), as_bytes(text)).ok();
                const Digest key = sha256(as_bytes(text));
                (void)(*store)->put(Keyspace::action, key, as_bytes(record(key, i % 8))).ok();
            }
        }
        ::close(written[1]);
        char byte;
        for (uint64_t pairs = 5 + random() % 15; pairs != 0; --pairs) ASSERT_EQ(::read(written[0], &byte, 1), 1);
        ::usleep(static_cast<useconds_t>(random() % 5'000));
        ::kill(child, SIGKILL);
        ::close(written[0]);
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFSIGNALED(status));
    }
    // Every entry that is visible is whole.
    auto store = DiskStore::open(folder.path(), unflushed());
    uint64_t seen = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder.path())) {
        const std::string name = file.path().filename().string();
        const auto key = Digest::from_hex(name);
        if (!file.is_regular_file() || !key) continue;
        const bool is_blob = file.path().string().find("/blob/") != std::string::npos;
        const auto got = (*store)->get(is_blob ? Keyspace::blob : Keyspace::action, *key);
        ASSERT_TRUE(got.ok() && got->has_value()) << name;
        EXPECT_TRUE(is_blob || is_record(as_text(**got), *key));
        ++seen;
    }
    EXPECT_GT(seen, 100u);
    EXPECT_EQ((*store)->counters().corrupt, 0u);
}

}  // namespace
}  // namespace kiln
