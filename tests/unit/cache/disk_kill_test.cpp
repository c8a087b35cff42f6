// Processes that are killed at any moment of a mixed load, and at every step of a put in turn. After each an audit: every
// acknowledged entry is there, every visible one is whole, the bound holds, the index agrees, nothing is left over.
// KILN_KILL_ROUNDS is the number of rounds (15).
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <thread>

#include "cache/chaos_store.h"
#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

namespace fs = std::filesystem;

constexpr int64_t hour = int64_t{3600} * 1'000'000'000;

std::string blob(uint32_t i) { return std::to_string(i) + std::string(i * 7919u % 30'001u, static_cast<char>('a' + i % 26)); }
std::string record(const Digest& key, uint32_t writer) {
    return key.hex() + std::string(300 + writer * 700, static_cast<char>('p' + writer)) + key.hex();
}
bool is_record(std::string_view text, const Digest& key) {
    const std::string hex = key.hex();
    return text.size() >= 428 && text.substr(0, 64) == hex && text.substr(text.size() - 64) == hex &&
           text.find_first_not_of(text[64], 64) == text.size() - 64;
}

// What put() has acknowledged, in a file that survives the process: a byte for the keyspace and the number.
struct Acknowledged {
    explicit Acknowledged(const std::string& path) : fd(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND, 0600)) {}
    Acknowledged(const Acknowledged&) = delete;
    Acknowledged& operator=(const Acknowledged&) = delete;
    ~Acknowledged() { ::close(fd); }
    void add(Keyspace space, uint32_t i) const {
        const uint32_t row = i * 2 + (space == Keyspace::blob);
        if (::write(fd, &row, sizeof row) != sizeof row) ::_exit(90);
    }
    std::vector<uint32_t> rows() const {
        std::vector<uint32_t> out(static_cast<size_t>(::lseek(fd, 0, SEEK_END)) / 4);
        if (::pread(fd, out.data(), out.size() * 4, 0) != static_cast<ssize_t>(out.size() * 4)) out.clear();
        return out;
    }
    int fd;
};

void work(const std::string& folder, DiskOptions options, const Acknowledged& done, uint32_t seed) {
    auto store = DiskStore::open(folder, options);
    if (!store.ok()) ::_exit(91);
    std::mt19937 random(seed);
    for (;;) {
        const uint32_t i = static_cast<uint32_t>(random() % 3000);
        const std::string text = blob(i);
        const Digest key = name_of(text);
        const Keyspace space = random() % 2 == 0 ? Keyspace::blob : Keyspace::action;
        const uint32_t what = static_cast<uint32_t>(random() % 100);
        if (what < 70) {
            const std::string bytes = space == Keyspace::blob ? text : record(key, seed % 6);
            if ((*store)->put(space, key, as_bytes(bytes)).ok()) done.add(space, i);
        } else if (what < 98) {
            const auto got = (*store)->get(space, key);
            if (got.ok() && got->has_value() &&
                (space == Keyspace::blob ? as_text(**got) != text : !is_record(as_text(**got), key)))
                ::_exit(92);
        } else if (what == 98) {
            if (!(*store)->verify().ok()) ::_exit(93);
        } else {
            (void)(*store)->gc(options.limit == 0 ? ~uint64_t{0} : options.limit).ok();
        }
    }
}

std::vector<std::string> audit(const std::string& folder, DiskOptions options, const std::vector<uint32_t>& acknowledged) {
    std::vector<std::string> problems;
    options.now = [] { return system_time() + 2 * hour; };  // so that what was left being written is old
    auto store = std::move(*DiskStore::open(folder, options));
    for (const auto& file : fs::recursive_directory_iterator(folder)) {
        const auto key = Digest::from_hex(file.path().filename().string());
        if (!file.is_regular_file() || !key) continue;
        const bool is_blob = file.path().string().find("/blob/") != std::string::npos;
        const auto got = store->get(is_blob ? Keyspace::blob : Keyspace::action, *key);
        if (!got.ok() || !got->has_value() || (!is_blob && !is_record(as_text(**got), *key)))
            problems.push_back("not whole: " + file.path().string());
    }
    for (const uint32_t row : acknowledged) {
        const std::string text = blob(row / 2);
        const auto got = store->get(row % 2 == 1 ? Keyspace::blob : Keyspace::action, name_of(text));
        if (!got.ok() || !got->has_value() || (row % 2 == 1 && as_text(**got) != text))
            problems.push_back("lost: " + std::to_string(row));
    }
    const auto stats = store->stats();
    if (stats->temporary.entries != 0) problems.push_back("left over: " + std::to_string(stats->temporary.entries));
    if (stats->quarantine.entries != 0) problems.push_back("damaged: " + std::to_string(stats->quarantine.entries));
    if (options.limit != 0 && stats->entries().charged > options.limit) problems.push_back("over the bound");
    // A put of something new makes the index ready; what it counts must then be what is there.
    static int audits = 0;
    const Digest fresh = name_of("audit " + std::to_string(audits++));
    if (!store->put(Keyspace::action, fresh, as_bytes(record(fresh, 1))).ok()) problems.push_back("no put");
    const uint64_t charged = store->stats()->entries().charged;
    store.reset();
    const auto index = DiskIndex::open(folder);
    if (!index.ok() || !(*index)->built() || (*(*index)->change())->totals().charged != charged)
        problems.push_back("the index does not agree");
    if (index.ok()) (*index)->close();
    return problems;
}

std::string joined(const std::vector<std::string>& list) {
    std::string out;
    for (const std::string& text : list) out += text + "\n";
    return out;
}

void kill_and_audit(uint64_t limit, const char* what) {
    const char* given = std::getenv("KILN_KILL_ROUNDS");
    const int rounds = given == nullptr ? 15 : std::atoi(given);
    const TestFolder outer;
    const std::string folder = outer.path() + "/store";
    const Acknowledged done(outer.path() + "/acknowledged");
    std::mt19937 random(limit == 0 ? 11 : 12);
    uint64_t killed = 0;
    for (int round = 0; round < rounds; ++round) {
        DiskOptions options = unflushed(limit);
        if (round % 3 == 0) options.sync = Sync::file;
        const size_t before = done.rows().size();
        std::vector<pid_t> children;
        for (uint32_t p = 0; p < 3; ++p) {
            const pid_t child = ::fork();
            ASSERT_GE(child, 0);
            if (child == 0) {
                const uint32_t seed = static_cast<uint32_t>(round) * 3 + p;
                std::thread other([&] { work(folder, options, done, seed + 10'000); });
                work(folder, options, done, seed);
            }
            children.push_back(child);
        }
        // Each dies in the thick of it, and at its own moment.
        for (int wait = 0; wait < 5000 && done.rows().size() < before + 20; ++wait) ::usleep(1000);
        for (const pid_t child : children) {
            ::usleep(static_cast<useconds_t>(random() % 15'000));
            ::kill(child, SIGKILL);
        }
        for (const pid_t child : children) {
            int status = 0;
            ASSERT_EQ(::waitpid(child, &status, 0), child);
            ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
            ++killed;
        }
        ASSERT_GE(done.rows().size(), before + 20);
        // Under a small bound what was acknowledged may have been evicted since.
        ASSERT_EQ(joined(audit(folder, options, limit == 0 ? done.rows() : std::vector<uint32_t>())), "") << "round " << round;
    }
    std::printf("%s: %d rounds, %llu processes killed, %zu puts acknowledged, 0 lost, 0 wrong\n", what, rounds,
                static_cast<unsigned long long>(killed), done.rows().size());
}

TEST(DiskKill, NothingAcknowledgedIsLost) { kill_and_audit(0, "no bound"); }
TEST(DiskKill, ASmallBoundHolds) { kill_and_audit(uint64_t{2} << 20, "bound of 2 MiB"); }

// The audit's own control: what it must notice, it notices.
TEST(DiskKill, TheAuditSeesWhatIsWrong) {
    const TestFolder folder;
    const DiskOptions options = unflushed(uint64_t{1} << 20);
    const auto fill = [&] {
        const auto store = std::move(*DiskStore::open(folder.path(), options));
        for (uint32_t i = 0; i < 5; ++i) {
            const std::string text = blob(i);
            ASSERT_TRUE(store->put(Keyspace::blob, name_of(text), as_bytes(text)).ok());
            ASSERT_TRUE(store->put(Keyspace::action, name_of(text), as_bytes(record(name_of(text), i))).ok());
        }
    };
    const std::vector<uint32_t> all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    const auto problems = [&] { return joined(audit(folder.path(), options, all)); };
    const std::string one = path_of(folder.path(), Keyspace::blob, name_of(blob(2)));
    fill();
    EXPECT_EQ(problems(), "");
    fs::remove(one);
    EXPECT_NE(problems().find("lost: 5"), std::string::npos);
    fill();
    ASSERT_TRUE(flip_bit(one, 12'345));
    const std::string flipped = problems();
    EXPECT_NE(flipped.find("not whole"), std::string::npos);
    EXPECT_NE(flipped.find("damaged: 1"), std::string::npos);
    fs::remove_all(folder.path() + "/quarantine");
    fill();
    fs::resize_file(one, 3);
    EXPECT_NE(problems().find("not whole"), std::string::npos);
    fs::remove_all(folder.path() + "/quarantine");
    fill();
    EXPECT_EQ(problems(), "");
    // An entry that came past the store: the bound and the index.
    const std::string strange(2'000'000, 's');
    fs::create_directories(fs::path(path_of(folder.path(), Keyspace::blob, name_of(strange))).parent_path());
    write_file(path_of(folder.path(), Keyspace::blob, name_of(strange)), strange);
    const std::string over = problems();
    EXPECT_NE(over.find("over the bound"), std::string::npos);
    EXPECT_NE(over.find("index does not agree"), std::string::npos);
}

// Ends the process at the n-th step of a put that evicts, for every n that there is.
TEST(DiskKill, AtEveryStep) {
    const uint64_t limit = 5 * 4096;
    int steps = 0;
    for (bool finished = false; !finished; ++steps) {
        ASSERT_LT(steps, 200);
        const TestFolder folder;
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            int left = steps;
            DiskOptions options = unflushed(limit);
            options.sync = Sync::file;
            options.before = [&](DiskStep) {
                if (left-- == 0) ::raise(SIGKILL);
                return 0;
            };
            auto store = DiskStore::open(folder.path(), options);
            for (uint32_t i = 0; i < 7; ++i) {
                const std::string text = "step " + std::to_string(i);
                if (!(*store)->put(Keyspace::blob, name_of(text), as_bytes(text)).ok()) ::_exit(1);
            }
            ::_exit(0);
        }
        int status = 0;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        finished = WIFEXITED(status);
        if (finished) {
            EXPECT_EQ(WEXITSTATUS(status), 0);
        }
        ASSERT_EQ(joined(audit(folder.path(), unflushed(limit), {})), "") << "step " << steps;
    }
    EXPECT_GT(steps, 7 * 6);
}

}  // namespace
}  // namespace kiln
