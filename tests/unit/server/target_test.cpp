#include "cache/server/target.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

const std::string hex(64, 'a');

std::string shown(std::string_view text) {
    const auto target = parse_target(text);
    if (!target) return "nothing";
    std::string out = name_of(target->what);
    if (!target->instance.empty()) out += " in " + target->instance;
    if (target->what == Target::What::action || target->what == Target::What::blob) out += " " + target->key.hex().substr(0, 4);
    if (target->what == Target::What::dav) out += " '" + target->path + "'" + (target->collection ? " collection" : "");
    return out;
}

TEST(Target, WhatIsTaken) {
    const std::pair<std::string, std::string> rows[] = {{"/cas/" + hex, "cas aaaa"},
                                                        {"/ac/" + hex, "ac aaaa"},
                                                        {"/main/ac/" + hex, "ac in main aaaa"},
                                                        {"/pr/7/cas/" + hex, "cas in pr/7 aaaa"},
                                                        {"/dav", "dav '' collection"},
                                                        {"/dav/", "dav '' collection"},
                                                        {"/dav/a/b.c", "dav 'a/b.c'"},
                                                        {"/dav/a/", "dav 'a' collection"},
                                                        {"/dav//.sccache_check", "dav '.sccache_check'"},
                                                        {"/x/dav/.sccache_check", "dav in x '.sccache_check'"},
                                                        {"/dav/cas/" + hex, "dav 'cas/" + hex + "'"},
                                                        {"/status", "status"},
                                                        {"/metrics", "metrics"},
                                                        {"/healthz", "healthz"},
                                                        {"/", "root"}};
    for (const auto& [text, wanted] : rows) EXPECT_EQ(shown(text), wanted) << text;
}

TEST(Target, WhatIsNot) {
    const std::string upper(64, 'A');
    const std::string bad[] = {"",
                               "cas/" + hex,
                               "/cas/" + upper,
                               "/cas/" + hex.substr(1),
                               "/cas/" + hex + "a",
                               "/cas/" + hex + "/",
                               "/cas/" + hex + "?x=1",
                               "/cas/" + hex + "#x",
                               "/cas//" + hex,
                               "//cas/" + hex,
                               "/./cas/" + hex,
                               "/../cas/" + hex,
                               "/a/../cas/" + hex,
                               "/cas/../cas/" + hex,
                               "/%63as/" + hex,
                               "/cas/%61" + hex.substr(1),
                               "/cas/" + hex.substr(0, 63) + '\0',
                               "/cas/" + std::string("../../../../etc/passwd"),
                               "/cas/..%2f..%2fetc%2fpasswd",
                               "/dav/..",
                               "/dav/../x",
                               "/dav/a/../b",
                               "/dav/a/./b",
                               "/dav///a",
                               "/dav//",
                               "/dav/a//",
                               "/dav/%2e%2e/a",
                               "/dav/a b",
                               "/dav/a\\b",
                               "/dav/" + std::string(513, 'a'),
                               "/a/b/c/d/e/f/g/h/i/cas/" + hex,
                               "/" + std::string(129, 'a') + "/cas/" + hex,
                               "http://host/cas/" + hex,
                               "*",
                               "/status/",
                               "/x/status",
                               "/CAS/" + hex};
    for (const std::string& text : bad) EXPECT_EQ(shown(text), "nothing") << text;
}

}  // namespace
}  // namespace kiln
