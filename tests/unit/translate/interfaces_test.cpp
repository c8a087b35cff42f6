#include "compiler/interfaces/interfaces.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "compiler/interfaces/mismatch.h"
#include "tests/unit/translate/mini_build.h"

namespace kiln {
namespace {

const char* const plain_vertex = R"(
layout(location=0) in vec4 at; layout(location=0) out vec2 uv;
void main() { gl_Position = at; uv = at.xy; })";

TEST(Pipelines, AreTheProductOfThePartitions) {
    MiniBuild b("s", {{"A", 2}, {"B", 3}, {"C", 2}});
    b.forbid(b.space.diagram->both(b.space.diagram->where(0, 1), b.space.diagram->where(1, 2)));
    b.add(Stage::vertex, R"(layout(location=0) out vec4 o; void main() { gl_Position = o = vec4(A); })");
    b.add(Stage::fragment,
          R"(layout(location=0) in vec4 i; layout(location=0) out vec4 o; void main() { o = i * float(B == 1); })");
    const Interfaces got = check_interfaces(b.stages, b.modules);
    EXPECT_TRUE(got.diags.empty()) << all_text(got.diags);
    // A in {0, 1} times (B == 1) in {false, true}
    ASSERT_EQ(got.pipelines.size(), 4U);
    Count sum;
    Set all = Diagram::none();
    for (const Pipeline& p : got.pipelines) {
        EXPECT_TRUE(b.space.diagram->disjoint(all, p.variants));
        all = b.space.diagram->either(all, p.variants);
        sum += p.count;
        EXPECT_EQ(p.witness, *b.space.diagram->witness(p.variants));
    }
    EXPECT_EQ(all, b.space.needed);
    EXPECT_EQ(sum, b.space.diagram->count(b.space.needed));
    EXPECT_TRUE(std::is_sorted(got.pipelines.begin(), got.pipelines.end(),
                               [](const Pipeline& x, const Pipeline& y) { return x.witness < y.witness; }));
    EXPECT_EQ(got.pipelines[0].count, Count(4));  // A=0, B in {0, 2}, C
    EXPECT_EQ(got.pipelines[2].count, Count(2));  // A=1, B=0, C
}

TEST(Interfaces, AnInputNobodyWritesIsAnErrorWithItsCondition) {
    MiniBuild b("sky", {{"A", 2}, {"B", 2}, {"C", 2}});
    b.add(Stage::vertex, R"(
layout(location=0) out vec2 uv;
#if !A
layout(location=1) out vec3 n;
#endif
void main() { gl_Position = vec4(0); uv = vec2(0);
#if !A
 n = vec3(1);
#endif
})");
    b.add(Stage::fragment, R"(
layout(location=0) in vec2 uv; layout(location=0) out vec4 o;
#if B
layout(location=1) in vec3 n;
#endif
void main() { o = uv.xyxy;
#if B
 o += n.xyzx;
#endif
})");
    const Interfaces got = check_interfaces(b.stages, b.modules);
    ASSERT_EQ(got.diags.list().size(), 1U) << all_text(got.diags);
    const Diag& d = got.diags.list()[0];
    EXPECT_EQ(d.severity, Severity::error);
    EXPECT_EQ(d.message, "fragment input 'n' (location 1) is not written by the vertex stage");
    EXPECT_EQ(d.place.file, "test.fragment");
    ASSERT_EQ(d.notes.size(), 1U);
    EXPECT_EQ(d.notes[0], "in 2 of 8 variants of sky: exactly when A == 1 && B == 1");
}

std::vector<Mismatch> match(const std::string& vertex, const std::string& fragment) {
    return match_varyings(reflection_of(Stage::vertex, vertex), reflection_of(Stage::fragment, fragment));
}

TEST(Interfaces, VaryingsByComponent) {
    const struct {
        const char *out, *write, *in, *read, *want;
    } cases[] = {
        {"layout(location=0) out vec4 a;", "a = vec4(1);", "layout(location=0) in vec4 b;", "b", ""},
        {"layout(location=0) out vec4 a;", "a = vec4(1);", "layout(location=0) in vec3 b;", "b.xyzx", "maintenance4"},
        {"layout(location=0) out vec2 a;", "a = vec2(1);", "layout(location=0) in vec4 b;", "b", "which is less"},
        {"layout(location=0) out uvec4 a;", "a = uvec4(1);", "layout(location=0) flat in ivec4 b;", "vec4(b)",
         "is ivec4, but the vertex stage writes 'a' (location 0) as uvec4"},
        {"layout(location=0) out int a;", "a = 1;", "layout(location=0) in float b;", "vec4(b)", "is float"},
        {"layout(location=2) out mat3 a;", "a = mat3(1);", "layout(location=2) in mat3 b;", "b[0].xyzx", ""},
        {"layout(location=2) out mat3 a;", "a = mat3(1);", "layout(location=4) in vec3 b;", "b.xyzx", ""},
        {"layout(location=2) out mat3 a;", "a = mat3(1);", "layout(location=5) in vec3 b;", "b.xyzx", "is not written"},
        {"layout(location=1) out vec2 a; layout(location=1, component=2) out vec2 c;", "a = c = vec2(1);",
         "layout(location=1) in vec4 b;", "b", ""},
        {"layout(location=1, component=1) out vec2 a;", "a = vec2(1);", "layout(location=1, component=1) in vec2 b;", "b.xyxy",
         ""},
        {"layout(location=0) out vec4 a[3];", "a[0] = a[1] = a[2] = vec4(1);", "layout(location=2) in vec4 b;", "b", ""},
        {"layout(location=0) out V { vec3 n; vec2 u; } v;", "v.n = vec3(1); v.u = vec2(1);", "layout(location=1) in vec2 b;",
         "b.xyxy", ""},
        {"layout(location=0) out vec4 a; layout(location=1) out vec4 unused;", "a = unused = vec4(1);",
         "layout(location=0) noperspective in vec4 b;", "b", ""},
    };
    for (const auto& c : cases) {
        const auto got = match(std::string(c.out) + "void main() { gl_Position = vec4(0); " + c.write + " }",
                               std::string(c.in) + "layout(location=0) out vec4 o; void main() { o = " + c.read + "; }");
        if (*c.want == 0) {
            EXPECT_TRUE(got.empty()) << c.out << c.in << (got.empty() ? "" : got[0].message);
        } else {
            ASSERT_EQ(got.size(), 1U) << c.out << c.in;
            EXPECT_NE(got[0].message.find(c.want), std::string::npos) << got[0].message;
            EXPECT_EQ(got[0].severity, std::string(c.want) == "maintenance4" ? Severity::warning : Severity::error);
        }
    }
}

TEST(Interfaces, OverlapsWithinAStage) {
    Reflection r;
    r.stage = Stage::vertex;
    Varying a, b;
    a.name = "a", a.location = 1, a.type.rows = 3;
    b.name = "b", b.location = 1, b.component = 2;
    r.outputs = {a, b};
    ASSERT_EQ(overlapping_varyings(r).size(), 1U);
    r.outputs[1].component = 3;
    EXPECT_TRUE(overlapping_varyings(r).empty());
    r.outputs[1] = a, r.outputs[1].index = 1;
    EXPECT_TRUE(overlapping_varyings(r).empty());
}

TEST(Interfaces, ResourcesThatClashInAPipeline) {
    const struct {
        const char *vertex, *fragment, *want;
        Severity severity;
    } cases[] = {
        {"layout(binding=0) uniform A { vec4 x; } a;", "layout(binding=0) uniform A { vec4 x; } a;", "", Severity::note},
        {"layout(binding=0) uniform A { vec4 x; } a;", "layout(binding=0) uniform A { vec4 x; vec4 more; } a;", "",
         Severity::note},
        {"layout(binding=0) uniform A { vec4 x; } a;", "layout(binding=0) uniform A { vec4 pad; vec4 x; } a;",
         "member 'x' moves from 0 to 16", Severity::error},
        {"layout(binding=0) uniform A { vec4 x; } a;", "layout(binding=0) uniform A { ivec4 x; } a;",
         "member 'x' changes from vec4 to ivec4", Severity::error},
        {"layout(binding=0) uniform A { vec4 x; } a;", "layout(std430, binding=0) buffer A { vec4 x; } a;",
         "uniform block 'A' in the vertex stage, storage block 'A' in the fragment stage", Severity::error},
        {"layout(binding=0) uniform A { vec4 x; } a;", "layout(binding=0) uniform B { vec4 y; } a;",
         "resource clash at set 0, binding 0", Severity::error},
        {"layout(push_constant) uniform P { vec4 x; } a;", "layout(push_constant) uniform P { layout(offset=16) vec4 x; } a;", "",
         Severity::note},
        {"layout(push_constant) uniform P { vec4 x; } a;", "layout(push_constant) uniform P { layout(offset=8) vec2 x; } a;",
         "push constants disagree", Severity::error},
    };
    for (const auto& c : cases) {
        const std::string member = std::string(c.fragment).find(" y;") != std::string::npos ? "a.y" : "a.x";
        const Reflection v = reflection_of(Stage::vertex, std::string(c.vertex) + "void main() { gl_Position = a.x; }");
        const Reflection f =
            reflection_of(Stage::fragment,
                          std::string(c.fragment) + "layout(location=0) out vec4 o; void main() { o = vec4(" + member + ".x); }");
        const auto got = match_resources(v, f);
        if (*c.want == 0) {
            EXPECT_TRUE(got.empty()) << c.fragment << got[0].message;
        } else {
            ASSERT_EQ(got.size(), 1U) << c.fragment;
            EXPECT_NE(got[0].message.find(c.want), std::string::npos) << got[0].message;
            EXPECT_EQ(got[0].severity, c.severity);
        }
    }
}

TEST(Interfaces, ABlockThatMovesWithAnAxisIsNamedWithIt) {
    MiniBuild b("lit", {{"shadow", 2}, {"light", 3}, {"other", 2}});
    b.add(Stage::vertex, plain_vertex);
    b.add(Stage::fragment, R"(
layout(set=0, binding=0) uniform Scene {
    vec4 a;
#if light == 2
    vec4 extra;
#endif
    vec4 x;
};
layout(location=0) in vec2 uv; layout(location=0) out vec4 o;
void main() { o = x + a + uv.xyxy * float(shadow); })");
    const Interfaces got = check_interfaces(b.stages, b.modules);
    ASSERT_EQ(got.diags.list().size(), 1U) << all_text(got.diags);
    const Diag& d = got.diags.list()[0];
    EXPECT_EQ(d.severity, Severity::warning);
    EXPECT_EQ(d.message,
              "uniform block 'Scene' (set 0, binding 0): member 'x' moves from 16 to 32 with axis 'light': costs sharing and a "
              "CPU-side layout a variant");
    EXPECT_NE(all_text(got.diags).find("at 32 as vec4 in 4 of 12 variants of lit: exactly when light == 2"), std::string::npos)
        << all_text(got.diags);
}

TEST(Interfaces, TwoAxesThatMoveOrGrowABlock) {
    MiniBuild b("lit", {{"n", 2}, {"wide", 2}, {"idle", 2}});
    b.add(Stage::compute, R"(
layout(local_size_x=1) in;
layout(std430, binding=0) buffer B { float first[1 + n];
#if wide
  dvec2 pad;
#endif
  float last; };
void main() { last = first[0]; })");
    const std::string text = all_text(check_interfaces(b.stages, b.modules).diags);
    EXPECT_NE(text.find("axes 'n', 'wide'"), std::string::npos) << text;
}

TEST(Interfaces, AMemberAtTheEndMovesNothing) {
    MiniBuild b("lit", {{"more", 2}});
    b.add(Stage::compute, R"(
layout(local_size_x=1) in;
layout(std430, binding=0) buffer B { float a;
#if more
  float z;
#endif
};
void main() { a = 1.0;
#if more
  z = 2.0;
#endif
})");
    EXPECT_TRUE(check_interfaces(b.stages, b.modules).diags.empty());
}

TEST(Interfaces, KindsThatClashBetweenVariants) {
    MiniBuild b("lit", {{"tex", 2}, {"idle", 2}});
    b.add(Stage::fragment, R"(
#if tex
layout(set=1, binding=2) uniform sampler2D map;
#else
layout(set=1, binding=2) uniform Colour { vec4 c; };
#endif
layout(location=0) out vec4 o;
void main() {
#if tex
  o = texture(map, vec2(0));
#else
  o = c;
#endif
})");
    const Interfaces got = check_interfaces(b.stages, b.modules);
    EXPECT_FALSE(got.diags.has_errors());  // no variant has both
    const std::string text = all_text(got.diags);
    EXPECT_NE(text.find("resource clash at set 1, binding 2 between variants: the kind differs"), std::string::npos) << text;
    EXPECT_NE(text.find("sampler2D 'map' in 2 of 4 variants of lit: exactly when tex == 1"), std::string::npos) << text;
    EXPECT_NE(text.find("uniform block 'Colour' in 2 of 4 variants of lit: exactly when tex == 0"), std::string::npos) << text;
}

// Two blocks of one place, neither of them the first form: both are looked at.
TEST(Interfaces, BlocksBehindAnotherKindAreCompared) {
    MiniBuild b("lit", {{"kind", 3}});
    b.add(Stage::fragment, R"(
#if kind == 0
layout(set=1, binding=2) uniform sampler2D map;
#else
layout(set=1, binding=2) uniform Colour {
#if kind == 2
  vec4 pad;
#endif
  vec4 c; };
#endif
layout(location=0) out vec4 o;
void main() {
#if kind == 0
  o = texture(map, vec2(0));
#else
  o = c;
#endif
})");
    const std::string text = all_text(check_interfaces(b.stages, b.modules).diags);
    EXPECT_NE(text.find("member 'c' moves from 0 to 16"), std::string::npos) << text;
}

TEST(Interfaces, KindsThatClashWithinAVariant) {
    MiniBuild b("lit", {{"tex", 2}, {"idle", 2}});
    b.add(Stage::fragment, R"(
layout(set=1, binding=2) uniform sampler2D map;
layout(set=1, binding=2) uniform Colour { vec4 c; };
layout(location=0) out vec4 o;
void main() {
  o = c;
#if tex
  o += texture(map, vec2(0));
#endif
})");
    const Interfaces got = check_interfaces(b.stages, b.modules);
    EXPECT_TRUE(got.diags.has_errors());
    const std::string text = all_text(got.diags);
    EXPECT_NE(text.find("one layout cannot hold both kinds"), std::string::npos) << text;
    EXPECT_NE(text.find("sampler2D 'map' in 2 of 4 variants of lit: exactly when tex == 1"), std::string::npos) << text;
}

TEST(Interfaces, ImagesOrNamesThatDifferAreWarnings) {
    for (const char* other : {"samplerCube map", "sampler2D other"}) {
        MiniBuild b("lit", {{"tex", 2}});
        const std::string cube =
            std::string(other).find("Cube") != std::string::npos ? "texture(map, vec3(0))" : "texture(other, vec2(0))";
        b.add(Stage::fragment, "#if tex\nlayout(binding=2) uniform sampler2D map;\n#else\nlayout(binding=2) uniform " +
                                   std::string(other) +
                                   ";\n#endif\nlayout(location=0) out vec4 o; void main() {\n#if tex\n o = " +
                                   "texture(map, vec2(0));\n#else\n o = " + cube + ";\n#endif\n}");
        const Interfaces got = check_interfaces(b.stages, b.modules);
        EXPECT_FALSE(got.diags.has_errors());
        ASSERT_EQ(got.diags.list().size(), 1U) << all_text(got.diags);
        EXPECT_NE(all_text(got.diags).find("resource clash at set 0, binding 2"), std::string::npos);
    }
}

}  // namespace
}  // namespace kiln
