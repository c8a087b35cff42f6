#include "compiler/base/files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace kiln {
namespace {

class DiskTest : public ::testing::Test {
protected:
    void SetUp() override {
        folder_ = ::testing::TempDir() + "kiln_files_" + std::to_string(::getpid());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string folder_;
    DiskFiles files_;
};

TEST_F(DiskTest, WritesThroughMissingFoldersAndLeavesNoTemporary) {
    const std::string path = folder_ + "/a/b/c.txt";
    ASSERT_TRUE(files_.write(path, as_bytes("one")).ok());
    ASSERT_TRUE(files_.write(path, as_bytes("two")).ok());
    EXPECT_EQ(files_.read(path).value().value(), "two");
    size_t entries = 0;
    for ([[maybe_unused]] const auto& e : std::filesystem::directory_iterator(folder_ + "/a/b")) ++entries;
    EXPECT_EQ(entries, 1u);
}

TEST_F(DiskTest, KeepsAbsentUnreadableAndFoundApart) {
    EXPECT_FALSE(files_.read(folder_ + "/none").value().has_value());
    EXPECT_FALSE(files_.read(folder_ + "/none/below").value().has_value());
    EXPECT_FALSE(files_.read(folder_).ok());
}

TEST_F(DiskTest, RefusesAFolderAsTarget) { EXPECT_FALSE(files_.write(folder_, as_bytes("x")).ok()); }

TEST_F(DiskTest, WritesToADevice) { EXPECT_TRUE(files_.write("/dev/null", as_bytes("x")).ok()); }

TEST_F(DiskTest, FailedWriteKeepsTheOldFile) {
    // /dev/full fails every write: reached through a link it stands for a full disk.
    const std::string path = folder_ + "/full";
    std::filesystem::create_symlink("/dev/full", path);
    EXPECT_FALSE(files_.write(path, as_bytes("x")).ok());
}

TEST(Paths, Normalise) {
    const struct {
        const char *path, *want;
    } cases[] = {{"", "."},    {".", "."},        {"a/./b", "a/b"}, {"a/../b", "b"}, {"../a", "../a"}, {"a/../../b", "../b"},
                 {"/..", "/"}, {"/a//b/", "/a/b"}};
    for (const auto& c : cases) EXPECT_EQ(normal_path(c.path), c.want) << c.path;
}

TEST(Paths, RelativeAndJoinAreInverse) {
    const struct {
        const char *folder, *path;
    } cases[] = {{"", "a/b"},      {".", "a"},       {"m", "m/x"},         {"m", "u/x"},        {"../m", "../u/x"},
                 {"..", "../u/x"}, {"/r/m", "/r/u"}, {"m", "/absolute/x"}, {"a/b/c", "../d/e"}, {"/r", "/"}};
    for (const auto& c : cases)
        EXPECT_EQ(join_path(c.folder, relative_path(c.folder, c.path)), normal_path(c.path)) << c.folder << " " << c.path;
    EXPECT_EQ(relative_path("/one/m", "/one/u/x"), "../u/x");
}

TEST(MemoryFiles, RecordsReads) {
    MemoryFiles files{{{"a", "x"}}};
    EXPECT_TRUE(files.read("a").value().has_value());
    EXPECT_FALSE(files.read("b").value().has_value());
    EXPECT_EQ(files.reads, (std::vector<std::string>{"a", "b"}));
}

}  // namespace
}  // namespace kiln
