// The verifier itself: every mutation of a right pipeline must be caught, and the right one must pass.

#include <algorithm>

#include "compiler/toolchain/spirv.h"
#include "compiler/validate/workers.h"
#include "tests/device/glsl.h"

namespace kiln::test {
namespace {

Verdict check(const CheckJob& job) {
    Result<Verdict> v = check_pipeline(device(), job);
    EXPECT_TRUE(v.ok()) << (v.ok() ? "" : v.error().message);
    return v.ok() ? *v : Verdict();
}

StageCode optimise(const StageCode& s) {
    const Result<Words> pruned = spirv_prune(s.words, Options());
    EXPECT_TRUE(pruned.ok());
    const Result<Words> words = spirv_optimise(*pruned, Options());
    EXPECT_TRUE(words.ok());
    return stage_of(*words);
}

const char* const lit = R"(
layout(set = 0, binding = 0) uniform Scene { vec3 light; float exponent; vec3 colour; int lights; } scene;
layout(set = 0, binding = 1) uniform sampler2D albedo;
layout(set = 0, binding = 2) uniform sampler2D gloss;
layout(set = 0, binding = 3) uniform sampler2DShadow shadow;
layout(location = 0) in vec3 normal;
layout(location = 1) in vec2 uv;
layout(location = 0) out vec4 c;
void main() {
    vec3 n = normalize(normal);
    float a = texture(gloss, uv).r;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < scene.lights; ++i) sum += scene.colour * max(dot(n, normalize(scene.light)), 0.0) * pow(a * a, scene.exponent);
    sum *= 0.5 + 0.5 * texture(shadow, vec3(uv, 0.5));
    c = vec4(texture(albedo, uv).rgb * sum, dFdx(uv.x));
}
)";

StageCode lit_vertex() {
    return vertex(R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 n;
layout(location = 2) in vec2 t;
layout(set = 1, binding = 0) uniform Camera { mat4 model; mat4 view_projection; } camera;
layout(location = 0) out vec3 normal;
layout(location = 1) out vec2 uv;
void main() {
    gl_Position = camera.view_projection * camera.model * vec4(position, 1.0);
    normal = mat3(camera.model) * n;
    uv = t;
}
)");
}

StageCode mutated(const char* from, const char* to) {
    std::string text = lit;
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, std::string(from).size(), to);
    return fragment(text);
}

TEST(Verifier, TheRightPipelinePasses) {
    const StageCode v = lit_vertex(), f = fragment(lit);
    const Verdict verdict = check(job_of({optimise(v), optimise(f)}, {v, f}));
    EXPECT_EQ(verdict.outcome, Outcome::passed) << verdict.why;
    EXPECT_TRUE(verdict.compared);
    EXPECT_GT(verdict.values, 16384u * 2);
    EXPECT_EQ(verdict.nonfinite, 0u);
    EXPECT_GT(verdict.covered, 2000u);
}

TEST(Verifier, WithoutUnoptimisedFormNothingIsCompared) {
    const Verdict verdict = check(job_of({lit_vertex(), fragment(lit)}));
    EXPECT_EQ(verdict.outcome, Outcome::passed) << verdict.why;
    EXPECT_FALSE(verdict.compared);
}

TEST(Verifier, MutationsAreCaught) {
    const struct {
        const char *from, *to;
    } mutations[] = {
        {"pow(a * a,", "pow(a,"},
        {"i < scene.lights", "i <= scene.lights"},
        {"dFdx(uv.x)", "dFdy(uv.x)"},
        {"max(dot(n, normalize(scene.light)), 0.0)", "dot(n, -normalize(scene.light))"},
        {"texture(shadow, vec3(uv, 0.5))", "texture(shadow, vec3(uv, 0.55))"},
        {"* sum,", "* sum.bgr,"},
        {"0.5 + 0.5 *", "0.5002 + 0.5 *"},
        {"binding = 1) uniform sampler2D albedo", "binding = 2) uniform sampler2D albedo"},  // and gloss stays at 2: aliased
    };
    const StageCode v = lit_vertex(), right = fragment(lit);
    for (const auto& m : mutations) {
        const Verdict verdict = check(job_of({optimise(v), optimise(mutated(m.from, m.to))}, {v, right}));
        EXPECT_EQ(verdict.outcome, Outcome::failed) << m.from << " -> " << m.to;
        EXPECT_NE(verdict.why, "");
    }
}

// The words are right and the published numbers are not: two textures swapped, an offset off, a block at another's place.
TEST(Verifier, WrongPublishedNumbersAreCaught) {
    const StageCode v = lit_vertex(), right = fragment(lit);
    StageCode swapped = right;
    for (Resource& r : swapped.reflection.resources)
        if (r.kind == ResourceKind::combined_image && !r.depth) r.binding = r.binding == 1 ? 2 : 1;
    EXPECT_EQ(check(job_of({v, swapped}, {v, right})).outcome, Outcome::failed);

    StageCode offset = right;
    for (Resource& r : offset.reflection.resources)
        for (Member& m : r.members)
            if (m.name.find("colour") != std::string::npos) m.offset += 4;
    EXPECT_EQ(check(job_of({v, offset}, {v, right})).outcome, Outcome::failed);

    StageCode missing = right;
    missing.reflection.resources.erase(missing.reflection.resources.begin());
    const Verdict verdict = check(job_of({v, missing}, {v, right}));
    EXPECT_EQ(verdict.outcome, Outcome::failed);
    EXPECT_NE(verdict.why.find("VUID"), std::string::npos) << verdict.why;

    StageCode moved_input = v;
    for (Varying& i : moved_input.reflection.inputs)
        if (i.location != 0) i.location = 3 - i.location;
    EXPECT_EQ(check(job_of({moved_input, right}, {v, right})).outcome, Outcome::failed);
}

TEST(Verifier, NotFiniteIsCaught) {
    for (const char* value : {"1.0 / (scene.exponent - scene.exponent)", "sqrt(-scene.exponent)", "log(scene.exponent * -1.0)"}) {
        const std::string text =
            "layout(set = 0, binding = 0) uniform Scene { float exponent; } scene;\nlayout(location = 0) out vec4 c;\n"
            "void main() { c = vec4(" +
            std::string(value) + "); }\n";
        const Verdict verdict = check(job_of({plain_vertex(), fragment(text)}));
        EXPECT_EQ(verdict.outcome, Outcome::failed) << value;
        EXPECT_GT(verdict.nonfinite, 1000u);
    }
}

// Negative inputs are compared and never blamed.
TEST(Verifier, NotFiniteWithMixedInputsPasses) {
    const std::string text =
        "layout(set = 0, binding = 0) uniform S { float a; float b; float c; float d; float e; } s;\n"
        "layout(location = 0) out vec4 o;\nvoid main() { o = vec4(sqrt(s.a) + sqrt(s.b) + sqrt(s.c) + sqrt(s.d) + sqrt(s.e)); "
        "}\n";
    const StageCode f = fragment(text);
    const Verdict verdict = check(job_of({plain_vertex(), f}, {plain_vertex(), f}));
    EXPECT_EQ(verdict.outcome, Outcome::passed) << verdict.why;
}

// The layer keeps talking however often it has said the same; a limit on repeats would let later pipelines pass.
TEST(Verifier, TheSameFaultIsCaughtEveryTime) {
    StageCode missing = fragment(lit);
    missing.reflection.resources.erase(missing.reflection.resources.begin());
    for (int i = 0; i < 25; ++i) {
        const Verdict verdict = check(job_of({lit_vertex(), missing}));
        ASSERT_EQ(verdict.outcome, Outcome::failed) << "time " << i;
    }
}

TEST(Verifier, InvalidModulesAreCaught) {
    StageCode broken = fragment(lit);
    broken.words[broken.words.size() / 2] ^= 0x00010001;
    EXPECT_EQ(check(job_of({lit_vertex(), broken})).outcome, Outcome::failed);
    StageCode cut = fragment(lit);
    cut.words.resize(cut.words.size() - 7);
    EXPECT_EQ(check(job_of({lit_vertex(), cut})).outcome, Outcome::failed);
}

TEST(Verifier, StagesThatDoNotFitAreCaught) {
    const Verdict verdict = check(job_of({plain_vertex(), fragment(lit)}));
    EXPECT_EQ(verdict.outcome, Outcome::failed) << "the fragment stage reads inputs that nobody writes";
}

TEST(Verifier, NothingDrawnIsAFigure) {
    const StageCode nowhere =
        vertex("layout(location = 0) in vec3 p;\nvoid main() { gl_Position = vec4(p.xy + 9.0, 0.5, 1.0); }\n");
    const Verdict verdict =
        check(job_of({nowhere, fragment("layout(location = 0) out vec4 c;\nvoid main() { c = vec4(1.0); }\n")}));
    EXPECT_EQ(verdict.outcome, Outcome::passed);
    EXPECT_EQ(verdict.covered, 0u);
}

TEST(Verifier, ThePositionMayBeAnyInput) {
    const StageCode v = vertex(
        "layout(location = 0) in vec3 normal;\nlayout(location = 3) in vec3 place;\nlayout(location = 0) out vec3 n;\n"
        "void main() { n = normal; gl_Position = vec4(normal.xy * 1e-6 + 5.0 * step(1.0, abs(normal.xy * 0.0 + 9.0 - 0.0)) - "
        "5.0 + place.xy, 0.5, 1.0); if (normal.x < 0.0) gl_Position = vec4(9.0, 9.0, 9.0, 1.0); }\n");
    const Verdict verdict =
        check(job_of({v, fragment("layout(location = 0) in vec3 n;\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(n, "
                                  "1.0); }\n")}));
    EXPECT_EQ(verdict.outcome, Outcome::passed) << verdict.why;
    EXPECT_GT(verdict.covered, 1000u);
}

}  // namespace
}  // namespace kiln::test
