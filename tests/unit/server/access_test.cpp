#include "cache/server/access.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "cache/server/instances.h"
#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

const std::string token = "0123456789abcdef";

TEST(Access, TokensHaveRolesByInstance) {
    const auto access = Access::parse(
        "# a comment\n"
        "ci   " +
            token +
            "1 main:read,cas-write,ac-write\r\n"
            "\n"
            "pr\t" +
            token +
            "2 pr/*:read,ac-write main:read\n"
            "ops  sha256:" +
            sha256(as_bytes(token + "3")).hex() +
            " *:admin\n"
            "old  " +
            token + "4 *:read until=2020-03-01",
        {});
    ASSERT_TRUE(access.ok()) << access.error().message;
    EXPECT_EQ(access->tokens(), 4u);
    const Caller& ci = access->caller(token + "1", 0);
    EXPECT_EQ(ci.name(), "ci");
    EXPECT_TRUE(ci.may(Role::ac_write, "main"));
    EXPECT_FALSE(ci.may(Role::admin, "main"));
    EXPECT_FALSE(ci.may(Role::read, "pr/1"));
    const Caller& pr = access->caller(token + "2", 0);
    EXPECT_TRUE(pr.may(Role::ac_write, "pr/1"));
    EXPECT_TRUE(pr.may(Role::ac_write, "pr/1/2"));
    EXPECT_FALSE(pr.may(Role::ac_write, "pr"));
    EXPECT_FALSE(pr.may(Role::ac_write, "prx/1"));
    EXPECT_FALSE(pr.may(Role::ac_write, "main"));
    EXPECT_TRUE(pr.may(Role::read, "main"));
    EXPECT_FALSE(pr.may(Role::cas_write, "pr/1"));
    EXPECT_TRUE(access->caller(token + "3", 0).may(Role::ac_write, "any"));
    constexpr int64_t first_of_march = 1583020800;
    EXPECT_TRUE(access->caller(token + "4", first_of_march - 1).known());
    EXPECT_FALSE(access->caller(token + "4", first_of_march).known());
    for (const std::string wrong : {"", "x", "0123456789abcdef", "0123456789abcdef11"}) {
        EXPECT_FALSE(access->caller(wrong, 0).known()) << wrong;
        EXPECT_TRUE(access->caller(wrong, 0).roles("main").empty()) << wrong;
    }
    // The digest in the file is not a token.
    EXPECT_FALSE(access->caller("sha256:" + sha256(as_bytes(token + "3")).hex(), 0).known());
}

TEST(Access, AnonymousMayBeGivenReading) {
    const auto access = Access::parse("ci " + token + " *:read,ac-write\n", {Role::read});
    EXPECT_TRUE(access->caller("", 0).may(Role::read, "x"));
    EXPECT_FALSE(access->caller("", 0).may(Role::ac_write, "x"));
    // A wrong token is not the same as none.
    EXPECT_FALSE(access->caller("wrong", 0).may(Role::read, "x"));
    EXPECT_TRUE(Access::open().caller("", 0).may(Role::ac_write, "x"));
    EXPECT_FALSE(Access::open().caller("", 0).may(Role::admin, "x"));
}

TEST(Access, BadLinesAreRefusedWithoutTheirToken) {
    const struct {
        std::string line, problem;
    } bad[] = {{"ci short *:read", "a token is 16 to 512"},
               {"ci", "a token is 16 to 512"},
               {"ci " + token + " *", "a grant is INSTANCES:ROLE,ROLE"},
               {"ci " + token + " *:reed", "roles are read"},
               {"ci " + token + " *:", "roles are read"},
               {"ci " + token + " *:read,", "roles are read"},
               {"ci " + token + " a/../b:read", "a grant's instances"},
               {"ci " + token + " */x:read", "a grant's instances"},
               {"ci " + token + " *:read until=2020-13-01", "'until=' wants a day"},
               {"ci " + token + " *:read until=2020-1-1", "'until=' wants a day"},
               {"ci sha256:abcd *:read", "'sha256:' wants 64"},
               {"ci " + token + "\x01 *:read", "a token is 16 to 512"},
               {"ok " + token + " *:read\nci " + token + " *:read", "line 2: the token stands on an earlier line"},
               {"ci " + token + "1 *:read\nci " + token + "2 *:read", "line 2: the name stands on an earlier line"}};
    for (const auto& row : bad) {
        const auto access = Access::parse(row.line, {});
        ASSERT_FALSE(access.ok()) << row.line;
        EXPECT_NE(access.error().message.find(row.problem), std::string::npos) << row.line << ": " << access.error().message;
        EXPECT_EQ(access.error().message.find(token), std::string::npos) << "the message shows the token";
    }
}

TEST(Access, TheFileIsItsOwnersAlone) {
    const TestFolder folder;
    const std::string path = folder.path() + "/tokens";
    write_file(path, "ci " + token + " *:read\n");
    for (const mode_t mode : {0600u, 0400u}) {
        ::chmod(path.c_str(), mode);
        EXPECT_TRUE(Access::load(path, {}).ok());
    }
    for (const mode_t mode : {0640u, 0604u, 0620u, 0610u, 0660u}) {
        ::chmod(path.c_str(), mode);
        EXPECT_FALSE(Access::load(path, {}).ok()) << mode;
    }
    EXPECT_FALSE(Access::load(folder.path(), {}).ok());
    EXPECT_FALSE(Access::load(folder.path() + "/none", {}).ok());
}

TEST(Instances, Names) {
    for (const char* good : {"", "main", "a/b", "A-1.x_y", "pr/123"}) EXPECT_TRUE(valid_instance_name(good)) << good;
    for (const char* bad : {"/",   "a/",   "/a",   "a//b",       ".",         "..",      "a/..",   "../a",
                            "a b", "a%2e", "ac",   "x/cas",      "uploads/x", "a/blobs", "status", "a/b/c/d/e/f/g/h/i",
                            "*",   "a/*",  "\x7f", "caf\xc3\xa9"})
        EXPECT_FALSE(valid_instance_name(bad)) << bad;
    EXPECT_FALSE(valid_instance_name(std::string(129, 'a')));
    EXPECT_FALSE(valid_instance_name(std::string_view("a\0b", 3)));
}

TEST(Instances, RulesAndParents) {
    const auto instances = Instances::make(
        {{"main", false, false, std::nullopt}, {"pr/*", false, false, "main"}, {"pr/special", false, true, std::nullopt}});
    ASSERT_TRUE(instances.ok()) << instances.error().message;
    EXPECT_TRUE(instances->find(""));
    EXPECT_EQ(instances->find("pr/7")->parents, std::vector<std::string>{"main"});
    EXPECT_TRUE(instances->find("pr/special")->replace);
    EXPECT_TRUE(instances->find("pr/special")->parents.empty());
    EXPECT_FALSE(instances->find("pr"));
    EXPECT_FALSE(instances->find("pr/"));
    EXPECT_FALSE(instances->find("other"));
    EXPECT_NE(action_name("a", name_of("k")), action_name("b", name_of("k")));
    const std::vector<std::vector<InstanceRule>> bad = {{{"a", false, false, "b"}},
                                                        {{"a", false, false, "a"}},
                                                        {{"a", false, false, "b"}, {"b", false, false, "a"}},
                                                        {{"a", false, false, std::nullopt}, {"a", true, false, std::nullopt}},
                                                        {{"p/*", false, false, std::nullopt}, {"a", false, false, "p/*"}},
                                                        {{"a", true, false, ""}},
                                                        {{"../a", false, false, std::nullopt}}};
    for (const auto& rules : bad) EXPECT_FALSE(Instances::make(rules).ok()) << rules[0].names;
}

}  // namespace
}  // namespace kiln
