// Manifest, preprocessor and the real tools together: what a user sees of a mistake, and what a module keeps.

#include <gtest/gtest.h>

#include "compiler/modules/blame.h"
#include "compiler/modules/modules.h"
#include "compiler/toolchain/glsl.h"
#include "compiler/toolchain/spirv.h"
#include "tests/unit/compile/world.h"

namespace kiln {
namespace {

class Project {
public:
    explicit Project(std::map<std::string, std::string> sources) : files(std::move(sources)) {
        Diags diags;
        manifest = load_manifest(files, "m.yaml", diags);
        if (!manifest) {
            ADD_FAILURE() << render(diags.list().front(), false);
            return;
        }
        for (const Shader& shader : manifest->shaders) {
            spaces.push_back(build_space(*manifest, shader, diags));
            for (const StageFile& stage : shader.stages) {
                SplitOptions options;
                options.lines = shader.options.debug;
                splits.push_back(std::make_unique<Split>(
                    split_stage(*manifest, shader, stage, *spaces.back(), spaces.back()->needed, files, options)));
                for (const Diag& d : splits.back()->diags.list()) ADD_FAILURE() << render(d, false);
                stages.push_back({&shader, spaces.back().get(), stage.stage, splits.back().get()});
            }
        }
    }
    Modules build(unsigned threads = 2) {
        return build_modules(stages, store, *tools, Jobs(threads), {}, source_lines(files, manifest->folder));
    }

    MemoryFiles files;
    MemoryStore store;
    std::unique_ptr<Toolchain> tools = make_toolchain();
    std::optional<Manifest> manifest;
    std::vector<std::unique_ptr<Space>> spaces;
    std::vector<std::unique_ptr<Split>> splits;
    std::vector<StageClasses> stages;
};

const std::string axes = R"(kiln: 1
name: t
axes:
  light: {macro: LIGHT, values: [none, point, area]}
  ibl: {macro: IBL, values: bool}
)";
const std::string one_stage = R"(shaders:
  - name: surface
    stages: {fragment: s.frag}
)";

TEST(Real, AMistakeIsShownAtItsTokenWithItsCondition) {
    Project project({{"m.yaml", axes + one_stage}, {"s.frag", R"(#version 450
layout(location = 0) out vec4 colour;
void main() {
    vec3 R = vec3(1.0);
#if IBL && LIGHT == 2
    vec3  R = vec3(2.0);
#endif
    colour = vec4(R, 1.0);
}
)"}});
    const Modules m = project.build();
    EXPECT_TRUE(m.list.empty());
    ASSERT_EQ(1u, m.diags.list().size());
    EXPECT_EQ(R"(s.frag:6:11: error: 'R' : redefinition
        vec3  R = vec3(2.0);
              ^
  in 1 of 6 variants of surface: exactly when light == area && ibl
)",
              render(m.diags.list()[0], false));
}

TEST(Real, AMistakeInAnIncludeOfTwoShadersIsOneMessage) {
    Project project({{"m.yaml", axes + R"(shaders:
  - name: a
    stages: {vertex: s.vert}
  - name: b
    stages: {vertex: s.vert}
    axes: [ibl]
)"},
                     {"lib.glsl", "float f() {\n\treturn wrong;\n}\n"},
                     {"s.vert", "#version 450\n#include \"lib.glsl\"\nvoid main() { gl_Position = vec4(f()); }\n"}});
    const Modules m = project.build();
    ASSERT_GE(m.diags.list().size(), 1u);
    const Diag& d = m.diags.list()[0];
    EXPECT_EQ("'wrong' : undeclared identifier", d.message);
    EXPECT_EQ((Place{"lib.glsl", 2, 9}), d.place);
    ASSERT_EQ(2u, d.notes.size());
    EXPECT_TRUE(d.notes[0].starts_with("in ") && d.notes[0].find("variants of a") != std::string::npos) << d.notes[0];
    EXPECT_NE(std::string::npos, d.notes[1].find("variants of b")) << d.notes[1];
}

TEST(Real, AMissingBraceIsShownAtTheLastToken) {
    Project project({{"m.yaml", axes + one_stage}, {"s.frag", "#version 450\nvoid main() {\n    float x;\n\n\n"}});
    const Modules m = project.build();
    ASSERT_EQ(1u, m.diags.list().size());
    EXPECT_EQ((Place{"s.frag", 3, 12}), m.diags.list()[0].place);
}

TEST(Real, MistakesAreTheSameWithDebugInfo) {
    const std::string source = "#version 450\n\nvoid main() {\n#if IBL\n    wrong = 1;\n#endif\n}\n";
    Project plain({{"m.yaml", axes + one_stage}, {"s.frag", source}});
    Project debug({{"m.yaml", axes + "options: {debug: true}\n" + one_stage}, {"s.frag", source}});
    const Modules a = plain.build(), b = debug.build();
    ASSERT_FALSE(a.diags.empty());
    EXPECT_EQ(a.diags.list(), b.diags.list());
    EXPECT_EQ((Place{"s.frag", 5, 5}), a.diags.list()[0].place);
}

TEST(Real, DebugInfoHasFilesLinesAndNames) {
    Project project(
        {{"m.yaml", axes + "options: {debug: true}\n" + one_stage},
         {"lib.glsl", "\n\nfloat twice(float x) {\n    float doubled = x * 2.0;\n    return doubled;\n}\n"},
         {"s.frag",
          "#version 450\n#include \"lib.glsl\"\nlayout(location = 0) in vec4 v;\nlayout(location = 0) out vec4 colour;\n"
          "void main() {\n    colour = vec4(twice(v.x));\n}\n"}});
    const Modules m = project.build();
    for (const Diag& d : m.diags.list()) ADD_FAILURE() << render(d, false);
    ASSERT_EQ(1u, m.list.size());
    const std::string text = *spirv_disassemble(m.list[0].unoptimised);
    for (const char* part : {"\"lib.glsl\"", "\"s.frag\"", "doubled", "OpLine"}) {
        EXPECT_NE(std::string::npos, text.find(part)) << part << "\n" << text;
    }
    EXPECT_NE(std::string::npos, text.find(" 4 0\n")) << text;
    EXPECT_NE(std::string::npos, spirv_disassemble(m.list[0].words)->find("OpLine"));
}

TEST(Real, WarningsComeBackOnAHit) {
    Project project({{"m.yaml", axes + one_stage},
                     {"s.frag", "#version 450\n#if LIGHT == 1\n#extension GL_NV_nothing : enable\n#endif\nvoid main() {}\n"}});
    const Modules cold = project.build();
    ASSERT_EQ(1u, cold.diags.list().size());
    EXPECT_EQ(Severity::warning, cold.diags.list()[0].severity);
    EXPECT_EQ(3u, cold.diags.list()[0].place.line);
    EXPECT_NE(std::string::npos, cold.diags.list()[0].notes[0].find("exactly when light == point"));
    const Modules warm = project.build();
    EXPECT_EQ(0u, warm.compiled);
    EXPECT_EQ(cold.diags.list(), warm.diags.list());
}

TEST(Real, ClassesThatDifferInDeadCodeShareAModule) {
    Project project({{"m.yaml", axes + one_stage}, {"s.frag", R"(#version 450
layout(location = 0) in vec4 v;
layout(location = 0) out vec4 colour;
layout(binding = 0) uniform sampler2D albedo;
#if LIGHT == 1
vec4 unused_point(vec2 p) { return texture(albedo, p); }
#elif LIGHT == 2
layout(binding = 1) uniform Area { vec4 corner[4]; } area;
vec4 unused_area() { return area.corner[2]; }
#endif
void main() {
    vec4 base = texture(albedo, v.xy);
#if IBL
    base *= 2.0;
#endif
    colour = base;
}
)"}});
    const Modules m = project.build();
    for (const Diag& d : m.diags.list()) ADD_FAILURE() << render(d, false);
    EXPECT_EQ(6u, m.compiled);
    EXPECT_EQ(2u, m.pruned);
    EXPECT_EQ(2u, m.list.size());
    EXPECT_EQ(2u, m.optimised);
}

TEST(Real, ThreadsAndCacheLeaveNoTrace) {
    const std::map<std::string, std::string> sources = {{"m.yaml", axes + one_stage}, {"s.frag", R"(#version 450
layout(location = 0) in vec4 v;
layout(location = 0) out vec4 colour;
void main() {
    float s = 0.0;
    for (int i = 0; i < 4 + LIGHT; ++i) s += v[i & 3] * float(IBL + LIGHT);
    colour = vec4(s);
}
)"}};
    Project one(sources), many(sources);
    const Modules a = one.build(1), b = many.build(8), c = many.build(3);
    EXPECT_EQ(6u, c.cache_hits);
    for (const Modules* other : {&b, &c}) {
        EXPECT_EQ(a.of_class, other->of_class);
        ASSERT_EQ(a.list.size(), other->list.size());
        for (size_t i = 0; i < a.list.size(); ++i) {
            EXPECT_EQ(a.list[i].words, other->list[i].words);
            EXPECT_EQ(a.list[i].unoptimised, other->list[i].unoptimised);
            EXPECT_EQ(a.list[i].reflection, other->list[i].reflection);
        }
    }
}

TEST(Real, AskingForVersionsDoesNotStartGlslang) {
    const auto check = [] {
        const std::string versions = make_toolchain()->versions();
        std::exit(versions.find("glslang") != std::string::npos && versions.find("SPIRV-Tools") != std::string::npos &&
                          !glsl_started()
                      ? 0
                      : 1);
    };
    GTEST_FLAG_SET(death_test_style, "threadsafe");  // a process of its own, in which no test has compiled
    EXPECT_EXIT(check(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace kiln
