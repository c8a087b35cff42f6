// The emitted header is compiled with the compilers at hand; its own static_asserts check the fields, and a few more here
// check it against the reader's numbers.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "compiler/runtime/kiln.h"
#include "sample.h"

namespace kiln::test {
namespace {

std::string key_header_of(Sample& sample) { return write_key_header(sample.input()); }

// True when `compiler` accepts the header followed by `more`; true also when there is no such compiler.
bool compiles(const std::string& compiler, const std::string& header, const std::string& more) {
    if (std::system(("command -v " + compiler + " > /dev/null 2>&1").c_str()) != 0) return true;
    std::string folder = (std::filesystem::temp_directory_path() / "kiln_key_header_XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) return false;
    std::ofstream(folder + "/keys.h") << header;
    std::ofstream(folder + "/use.cpp") << "#include \"keys.h\"\n#include \"keys.h\"\n" << more;
    const std::string command =
        compiler + " -std=c++17 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only " + folder + "/use.cpp";
    const bool good = std::system(command.c_str()) == 0;
    std::filesystem::remove_all(folder);
    return good;
}

TEST(KeyHeader, CompilesAndAgreesWithTheReader) {
    Sample sample = small_sample();
    const auto files = write_table(sample.input());
    ASSERT_TRUE(files.ok());
    kiln_table table;
    ASSERT_EQ(kiln_open(&table, files->table.data(), files->table.size()), KILN_OK);
    kiln_shader shader;
    ASSERT_EQ(kiln_find_shader(&table, "surface", &shader), KILN_OK);
    const uint32_t digits[] = {2, 1, 1};
    uint64_t key[1];
    ASSERT_EQ(kiln_pack(&shader, digits, key), KILN_OK);
    const std::string more =
        "using namespace kiln_keys::sample;\n"
        "constexpr surface::Variant v{surface::light_axis::point, surface::pass_axis::depth, surface::skinned_axis::true_};\n"
        "static_assert(v.key().words[0] == " +
        std::to_string(key[0]) +
        "u, \"\");\n"
        "static_assert(surface::Variant::of(v.key()).light == surface::light_axis::point, \"\");\n"
        "static_assert(blur::Variant{blur::radius_axis::r16}.key() != blur::Key{}, \"\");\n";
    const std::string header = key_header_of(sample);
    EXPECT_TRUE(compiles("g++", header, more)) << header;
    EXPECT_TRUE(compiles("clang++-14", header, more)) << header;
    EXPECT_TRUE(compiles("clang++", header, more)) << header;
    EXPECT_FALSE(compiles("g++", header, "static_assert(kiln_keys::sample::surface::key_words == 2, \"\");\n"));
}

TEST(KeyHeader, OddNamesAndLongKeys) {
    std::vector<Axis> axes;
    for (int i = 0; i < 40; ++i) axes.push_back(named("axis" + std::to_string(i), {"a", "b", "c", "d", "e"}));
    axes.push_back(named("class", {"1", "2", "_x", "double", "x__y"}));
    axes.back().kind = AxisKind::integer;
    axes.push_back(named("Key", {"only"}));
    axes.push_back(named("Variant_", {"-7", "7"}));
    Sample sample({{"two-sided 3d", axes, {}, {{Stage::fragment, {}, {}, {"1"}}}}});
    sample.manifest.name = "my \"game\"\n*/";
    const std::string header = key_header_of(sample);
    EXPECT_TRUE(compiles("g++", header, "")) << header;
    EXPECT_TRUE(compiles("clang++-14", header, "")) << header;
    EXPECT_NE(header.find("key_words = 2"), std::string::npos) << header;
}

}  // namespace
}  // namespace kiln::test
