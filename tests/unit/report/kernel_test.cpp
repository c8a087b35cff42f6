// Every shader of every family compiles, and its text does what the data says.
#include "compiler/report/kernel.h"

#include <gtest/gtest.h>

#include <set>

namespace kiln::report {
namespace {

TEST(Kernel, IncludesAreGivenOnce) {
    MemoryFiles files({{"lib/a.glsl", "#include \"b.glsl\"\nA\n"}, {"lib/b.glsl", "B\n"}});
    Library library(files, "lib");
    const auto text = library.expanded("#include \"a.glsl\"\n#include \"b.glsl\"\nend\n");
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(*text, "B\nA\nend\n");
    EXPECT_EQ(library.expanded("#include \"c.glsl\"\n").error().fault, Fault::input);
}

TEST(Kernel, CountsInstructionsInsideFunctions) {
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    const std::vector<Field> fields{{"float", "x"}};
    const std::string scene = "Point point_at(vec2 u) { Point p; p.x = u.x; return p; }";
    const auto one =
        compile_kernel(kernel_text(Job::picture, fields, {}, scene, "vec3 shade(Point p) { return vec3(p.x); }"), *tools);
    const auto more = compile_kernel(
        kernel_text(Job::picture, fields, {}, scene, "vec3 shade(Point p) { return vec3(sqrt(p.x) + 1.0); }"), *tools);
    ASSERT_TRUE(one.ok() && more.ok());
    EXPECT_EQ(more->operations, one->operations + 2);
    EXPECT_EQ(more->bytes, more->code.words.size() * 4);
    const auto wrong =
        compile_kernel(kernel_text(Job::picture, fields, {}, scene, "vec3 shade(Point p) { return p.y; }"), *tools);
    ASSERT_FALSE(wrong.ok());
    EXPECT_NE(wrong.error().message.find("return p.y"), std::string::npos);
}

TEST(Families, AreSoundAsData) {
    for (const bool quick : {true, false}) {
        std::set<unsigned> numbers;
        for (const Family& f : all_families(quick, "bake")) {
            EXPECT_TRUE(numbers.insert(f.number).second) << f.name;
            EXPECT_FALSE(f.fields.empty()) << f.name;
            EXPECT_FALSE(f.expectations.empty()) << f.name;
            std::set<std::string> members, scenes;
            for (const Member& m : f.members) EXPECT_TRUE(members.insert(m.name).second) << m.name;
            for (const Scene& s : f.scenes) {
                EXPECT_TRUE(scenes.insert(s.name).second) << s.name;
                EXPECT_NE(static_cast<bool>(s.reference), members.count(s.truth_member) == 1) << s.name;
            }
            for (const Member& m : f.members)
                for (const auto& [scene, text] : m.scene_glsl) EXPECT_TRUE(scenes.count(scene)) << f.name << " " << scene;
            for (const Expectation& e : f.expectations) {
                const bool one = e.relation == Relation::at_most || e.relation == Relation::at_least;
                // A dear member may be left out of the quick report; the full one has all that are spoken of.
                EXPECT_TRUE(quick || members.count(e.a) == 1) << f.name << ": " << e.a;
                EXPECT_TRUE(quick || one == (members.count(e.b) == 0)) << f.name << ": " << e.b;
                EXPECT_TRUE(e.scene.empty() || scenes.count(e.scene)) << f.name << ": " << e.scene;
            }
        }
    }
}

TEST(Families, LightmapsDoWithoutTheirEncoder) {
    const auto named = [](const std::string& encoder, const std::string& member) {
        for (const Family& f : all_families(true, encoder))
            if (f.name == "lightmap")
                return std::count_if(f.members.begin(), f.members.end(), [&](const Member& m) { return m.name == member; });
        return std::ptrdiff_t{-1};
    };
    EXPECT_EQ(named("bake", "sh_hq"), 1);
    EXPECT_EQ(named("", "sh_hq"), 0);
    EXPECT_EQ(named("", "sh_ratio8"), 1);
    for (const Family& f : all_families(true, ""))
        if (f.name == "lightmap") {
            ASSERT_TRUE(f.remarks);
            const std::vector<std::string> said = f.remarks([](const std::string&, const std::string&) { return std::nullopt; });
            ASSERT_EQ(said.size(), 1u);
            EXPECT_NE(said[0].find("BC7"), std::string::npos);
        }
}

TEST(Families, ScenesCompile) {
    DiskFiles files;
    Library library(files, std::string(KILN_SOURCE_DIR) + "/uber/lib");
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    for (const Family& f : all_families(true, "bake"))
        for (const Scene& s : f.scenes)
            for (const Job job : {Job::points, Job::baseline}) {
                const auto text = library.expanded(kernel_text(job, f.fields, s.resources, s.glsl, ""));
                ASSERT_TRUE(text.ok()) << f.name << ": " << text.error().message;
                const auto kernel = compile_kernel(*text, *tools);
                EXPECT_TRUE(kernel.ok()) << f.name << ", " << s.name << ": " << kernel.error().message;
            }
}

}  // namespace
}  // namespace kiln::report
