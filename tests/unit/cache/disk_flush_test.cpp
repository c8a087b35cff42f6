// What reaches the disk before put() returns: the system calls themselves, in the place of libc's. The calls are still made.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <vector>

#include "tests/unit/cache/folder.h"

namespace {

std::mutex calls_mutex;
std::vector<std::string> calls;

void note(const std::string& call) {
    const std::lock_guard lock(calls_mutex);
    calls.push_back(call);
}

std::string path_of_file(int fd) {
    char path[4096];
    const ssize_t n = ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), path, sizeof path);
    return n < 0 ? "?" : std::string(path, static_cast<size_t>(n));
}

}  // namespace

extern "C" int fdatasync(int fd) {
    note("flush " + path_of_file(fd));
    return static_cast<int>(::syscall(SYS_fdatasync, fd));
}

extern "C" int fsync(int fd) {
    note("flush " + path_of_file(fd));
    return static_cast<int>(::syscall(SYS_fsync, fd));
}

extern "C" int rename(const char* from, const char* to) noexcept {
    note(std::string("rename ") + to);
    return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace kiln {
namespace {

// What one put() did, with the folder's path taken off and the draft under one name.
std::vector<std::string> done_by_put(DiskStore& store, const std::string& text) {
    {
        const std::lock_guard lock(calls_mutex);
        calls.clear();
    }
    EXPECT_TRUE(store.put(Keyspace::blob, name_of(text), as_bytes(text)).ok());
    const std::lock_guard lock(calls_mutex);
    std::vector<std::string> done;
    for (std::string call : calls) {
        const size_t at = call.find(store.folder());
        if (at == std::string::npos) continue;
        call.erase(at, store.folder().size());
        if (call.find("/index") != std::string::npos) continue;
        done.push_back(call.find("/tmp/") == std::string::npos ? call : "flush draft");
    }
    return done;
}

using Calls = std::vector<std::string>;

TEST(DiskFlush, EachKindFlushesWhatItPromises) {
    const std::string text = "text", hex = name_of(text).hex(), shard = "/blob/" + hex.substr(0, 2), name = shard + "/" + hex;
    const std::pair<Sync, Calls> rows[] = {
        {Sync::none, {"rename " + name}},
        {Sync::file, {"flush draft", "rename " + name}},
        {Sync::folder, {"flush draft", "rename " + name, "flush " + shard, "flush /blob", "flush "}}};
    for (const auto& [sync, wanted] : rows) {
        const TestFolder folder;
        std::filesystem::create_directories(folder.path() + shard);
        std::filesystem::create_directories(folder.path() + "/tmp");
        DiskOptions options;
        options.sync = sync;
        const auto store = std::move(*DiskStore::open(folder.path(), options));
        EXPECT_EQ(done_by_put(*store, text), wanted) << static_cast<int>(sync) << ": a shard that another process has made";
        EXPECT_EQ(done_by_put(*store, text), Calls()) << "it is there";
    }
}

TEST(DiskFlush, AShardsNameIsFlushedOnceAProcessOrWhenItIsNew) {
    const TestFolder folder;
    DiskOptions options;
    options.sync = Sync::folder;
    const auto store = std::move(*DiskStore::open(folder.path(), options));
    // Three texts of one shard.
    std::vector<std::string> texts{"first"};
    for (int i = 0; texts.size() < 3; ++i)
        if (name_of(std::to_string(i)).bytes[0] == name_of(texts[0]).bytes[0]) texts.push_back(std::to_string(i));
    const std::string shard = "/blob/" + name_of(texts[0]).hex().substr(0, 2);
    const auto flushes = [&](const std::string& text) {
        Calls done = done_by_put(*store, text);
        std::erase_if(done, [](const std::string& call) { return call.substr(0, 5) != "flush"; });
        return done;
    };
    const Calls all{"flush draft", "flush " + shard, "flush /blob", "flush "};
    EXPECT_EQ(flushes(texts[0]), all);
    EXPECT_EQ(flushes(texts[1]), (Calls{"flush draft", "flush " + shard}));
    std::filesystem::remove_all(folder.path() + shard);
    EXPECT_EQ(flushes(texts[2]), all) << "it was made anew";
}

}  // namespace
}  // namespace kiln
