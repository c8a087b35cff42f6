#include "compiler/translate/translate.h"

#include <gtest/gtest.h>

#include <atomic>

#include "compiler/modules/pipelines.h"
#include "tests/unit/translate/mini_build.h"

namespace kiln {
namespace {

// The real translator and parser, counted; no compiler.
class Tools final : public Toolchain {
public:
    std::atomic<uint64_t> translates{0}, parses{0}, links{0};
    std::string spoil;  // a text that holds this gets a stray word
    std::string versions() const override { return "test"; }
    Compiled compile(Stage, std::string_view, const Options&) override { return {}; }
    Result<Words> prune(WordView, const Options&) override { return input_error("not here"); }
    Result<Words> optimise(WordView, const Options&) override { return input_error("not here"); }
    std::vector<ToolMessage> validate(WordView, const Options&) override { return {}; }
    Result<Reflection> reflect(WordView words) override { return reflect_words(words); }
    std::vector<Translated> translate(WordView words, const std::vector<Target>& targets, const SlotLayout& slots) override {
        ++translates;
        std::vector<Translated> out = cross_translate(words, targets, slots);
        for (Translated& t : out)
            if (!spoil.empty() && t.text.find(spoil) != std::string::npos) t.text += "stray\n";
        return out;
    }
    std::vector<ToolMessage> parse_back(Target target, Stage stage, std::string_view text) override {
        ++parses;
        return glsl_parse_back(target, stage, text);
    }
    std::vector<ToolMessage> link_back(Target target, std::string_view vertex, std::string_view fragment) override {
        ++links;
        return glsl_link_back(target, vertex, fragment);
    }
};

const char* const vertex = R"(
layout(set=0, binding=0) uniform Camera { mat4 view; } camera;
layout(push_constant) uniform Push { mat4 model; vec4 tint; } push;
layout(location=0) in vec3 at;
layout(location=0) out Surface { vec2 uv; vec3 n; } surface;
layout(location=4) out uint id;
layout(location=5) out vec4 extra;
void main() { gl_Position = camera.view * push.model * vec4(at, 1); surface.uv = at.xy; surface.n = at; id = 1u; extra = vec4(SKIN); })";

const char* const fragment = R"(
layout(set=0, binding=1) uniform sampler2D albedo;
#if DETAIL
layout(set=0, binding=2) uniform sampler2D detail;
#endif
layout(set=0, binding=3) uniform samplerCube sky;
layout(set=1, binding=0) uniform texture2D lut; layout(set=1, binding=1) uniform sampler point;
layout(set=1, binding=4) uniform Material { vec4 colour; };
layout(location=0) in vec2 other_name; layout(location=1) in vec3 normal; layout(location=4) flat in uint kind;
layout(location=5) flat in vec4 extra;
layout(location=0) out vec4 o;
void main() {
    o = texture(albedo, other_name) + texture(sky, normal) + float(kind) * colour + texture(sampler2D(lut, point), other_name) + extra;
#if DETAIL
    o += texture(detail, other_name);
#endif
})";

class TranslateTest : public testing::Test {
protected:
    TranslateTest() : build("surface", {{"SKIN", 2}, {"DETAIL", 2}, {"IDLE", 2}}) {
        build.add(Stage::vertex, vertex);
        build.add(Stage::fragment, fragment);
    }
    Artifacts run(const std::vector<Target>& targets, bool parse_back = false, unsigned threads = 1) {
        return translate_modules(build.stages, build.modules, {targets, parse_back}, store, tools, Jobs(threads), {});
    }
    std::vector<std::string> texts(const Artifacts& a, Target target) {
        std::vector<std::string> out;
        for (const Artifacts::Text& t : a.list)
            if (t.target == target) out.push_back(t.text);
        return out;
    }

    MiniBuild build;
    MemoryStore store;
    Tools tools;
};

// The number behind `name` in `text`, between the two marks.
std::string after(const std::string& text, const std::string& before, const std::string& end) {
    const size_t at = text.find(before);
    if (at == std::string::npos) return {};
    return text.substr(at + before.size(), text.find(end, at + before.size()) - at - before.size());
}

TEST_F(TranslateTest, SlotsAreTheSameInEveryVariant) {
    const Artifacts a = run({Target::msl21, Target::hlsl50, Target::glsl450, Target::essl310});
    EXPECT_TRUE(a.diags.empty()) << all_text(a.diags);
    size_t seen = 0;
    for (const std::string& t : texts(a, Target::msl21))
        if (t.find("texturecube<float> sky") != std::string::npos) {
            ++seen;
            EXPECT_EQ(after(t, "sky [[texture(", ")"), "2");
            EXPECT_EQ(after(t, "albedo [[texture(", ")"), "0");
        }
    EXPECT_EQ(seen, 2U);
    for (const std::string& t : texts(a, Target::hlsl50))
        if (t.find("TextureCube") != std::string::npos) {
            EXPECT_EQ(after(t, "sky : register(", ")"), "t2");
        }
    for (const Target gl : {Target::glsl450, Target::essl310})
        for (const std::string& t : texts(a, gl))
            if (t.find("samplerCube sky") != std::string::npos) {
                EXPECT_NE(t.find("in vec3 io_loc1"), std::string::npos) << t;  // the vertex stage hands over a block
                EXPECT_NE(t.find("layout(binding = 2) uniform"), std::string::npos) << t;
                EXPECT_NE(t.find("lut_point"), std::string::npos);
            }
}

TEST_F(TranslateTest, TextsOfAllGlTargetsParseAndLink) {
    const Artifacts a = run({Target::spirv, Target::glsl330, Target::glsl450, Target::essl300, Target::essl310}, true);
    EXPECT_TRUE(a.diags.empty()) << all_text(a.diags);
    EXPECT_EQ(a.list.size(), 16U);  // two vertex and two fragment texts a target
    EXPECT_EQ(tools.parses, 16U);
    EXPECT_EQ(tools.links, 16U);  // four pipelines a target
    for (const std::string& t : texts(a, Target::essl300)) {
        EXPECT_NE(t.find("io_loc0"), std::string::npos) << t;
        EXPECT_EQ(t.find("layout(binding"), std::string::npos) << t;
    }
    // Everything is answered by the store the second time.
    const Artifacts again = run({Target::spirv, Target::glsl330, Target::glsl450, Target::essl300, Target::essl310}, true);
    EXPECT_EQ(tools.parses, 16U);
    EXPECT_EQ(tools.links, 16U);
    EXPECT_EQ(again.translated, 0U);
    EXPECT_EQ(again.cache_hits, 16U);
    EXPECT_EQ(again.of, a.of);
}

TEST_F(TranslateTest, AFaultyTextIsAnErrorWithItsCondition) {
    tools.spoil = "samplerCube";
    build.shader.name = "surface";
    const Artifacts a = run({Target::essl300}, true);
    ASSERT_TRUE(a.diags.has_errors());
    const std::string text = all_text(a.diags);
    EXPECT_NE(text.find("the essl300 text of the fragment stage does not parse"), std::string::npos) << text;
    EXPECT_NE(text.find("in 8 of 8 variants of surface"), std::string::npos) << text;
    EXPECT_EQ(text.find("do not link"), std::string::npos) << text;
}

TEST_F(TranslateTest, DedupAndThreadsAndStoreChangeNothing) {
    const std::vector<Target> targets = {Target::glsl450, Target::hlsl60, Target::msl23, Target::spirv};
    const Artifacts one = run(targets);
    EXPECT_EQ(one.translated, 4U * 3U);
    EXPECT_EQ(tools.translates, 4U);  // one call a module, all targets together
    MemoryStore fresh;
    const Artifacts two = translate_modules(build.stages, build.modules, {targets, false}, fresh, tools, Jobs(3), {});
    const Artifacts warm = run(targets);
    for (const Artifacts* other : {&two, &warm}) {
        EXPECT_EQ(one.of, other->of);
        ASSERT_EQ(one.list.size(), other->list.size());
        for (size_t i = 0; i < one.list.size(); ++i) EXPECT_EQ(one.list[i].text, other->list[i].text);
    }
    EXPECT_EQ(warm.cache_hits, 12U);
    for (const auto& modules : one.of[0]) EXPECT_EQ(modules.size(), build.modules.list.size());
    EXPECT_EQ(one.of[0][3], std::vector<uint32_t>(build.modules.list.size(), no_artifact));  // spirv
}

TEST_F(TranslateTest, AStoreThatFailsCostsAWarning) {
    class Broken final : public Store {
        Result<std::optional<Bytes>> get(Keyspace, const Digest&) override { return environment_error("no disk"); }
        Status put(Keyspace, const Digest&, ByteView) override { return environment_error("no disk"); }
    } broken;
    const Artifacts a = translate_modules(build.stages, build.modules, {{Target::glsl450}, false}, broken, tools, Jobs(2), {});
    EXPECT_EQ(a.list.size(), 4U);
    EXPECT_FALSE(a.diags.has_errors());
    EXPECT_NE(all_text(a.diags).find("no disk"), std::string::npos);
    EXPECT_GT(a.store_failures, 0U);
}

TEST_F(TranslateTest, ADamagedStoreIsAMiss) {
    const Artifacts good = run({Target::glsl450});
    class Damaged final : public Store {
    public:
        explicit Damaged(Store& inner) : inner_(inner) {}
        Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override {
            auto got = inner_.get(space, key);
            if (got.ok() && got->has_value()) (*got)->at((*got)->size() / 2) ^= 1;
            return got;
        }
        Status put(Keyspace, const Digest&, ByteView) override { return {}; }

    private:
        Store& inner_;
    } damaged(store);
    const Artifacts a = translate_modules(build.stages, build.modules, {{Target::glsl450}, false}, damaged, tools, Jobs(1), {});
    ASSERT_EQ(a.list.size(), good.list.size());
    for (size_t i = 0; i < a.list.size(); ++i) EXPECT_EQ(a.list[i].text, good.list[i].text);
    EXPECT_EQ(a.cache_hits, 0U);
}

TEST(Translate, AHoleIsAWarningWithItsConditionForThatTargetAlone) {
    MiniBuild b("sky", {{"WIDE", 2}, {"IDLE", 2}});
    b.add(Stage::compute, R"(
layout(local_size_x=8) in; layout(binding=0) buffer B { uint n; float f; };
void main() {
#if WIDE
  uint c; n = uaddCarry(n, 3u, c) + c;
#else
  n = 1u;
#endif
})");
    MemoryStore store;
    Tools tools;
    const Artifacts a = translate_modules(b.stages, b.modules, {{Target::hlsl50, Target::hlsl60, Target::msl21}, false}, store,
                                          tools, Jobs(1), {});
    ASSERT_EQ(a.diags.list().size(), 1U) << all_text(a.diags);
    const Diag& d = a.diags.list()[0];
    EXPECT_EQ(d.severity, Severity::warning);
    EXPECT_EQ(d.message.find("no hlsl50, hlsl60 text of the compute stage: "), 0U) << d.message;
    ASSERT_EQ(d.notes.size(), 1U);
    EXPECT_EQ(d.notes[0], "in 2 of 4 variants of sky: exactly when WIDE == 1");
    EXPECT_EQ(a.refusals.size(), 2U);
    EXPECT_EQ(a.list.size(), 4U);  // two in MSL, one in each HLSL
}

TEST(Translate, TwoShadersShareAModuleButNotTheirSlots) {
    const char* const first = R"(
#if X
layout(binding=0) uniform sampler2D before;
#endif
layout(binding=1) uniform sampler2D map; layout(location=0) out vec4 o;
void main() { o = texture(map, vec2(0));
#if X
 o += texture(before, vec2(0));
#endif
})";
    MiniBuild a("a", {{"X", 2}}), b("b", {{"Y", 2}});
    a.add(Stage::fragment, first);
    b.add(Stage::fragment, std::string("#define X 0\n") + first);
    Modules modules = a.modules;
    uint32_t shared = no_artifact;
    for (uint32_t i = 0; i < modules.list.size(); ++i)
        if (modules.list[i].words == b.modules.list[0].words) shared = i;
    ASSERT_NE(shared, no_artifact);
    modules.of_class.push_back({shared, shared});
    std::vector<StageClasses> stages = a.stages;
    stages.push_back(b.stages[0]);
    MemoryStore store;
    Tools tools;
    const Artifacts got = translate_modules(stages, modules, {{Target::glsl450}, false}, store, tools, Jobs(1), {});
    ASSERT_EQ(got.of.size(), 2U);
    const uint32_t in_a = got.of[0][0][shared], in_b = got.of[1][0][shared];
    ASSERT_NE(in_a, no_artifact);
    ASSERT_NE(in_b, no_artifact);
    EXPECT_NE(got.list[in_a].text.find("layout(binding = 1)"), std::string::npos);
    EXPECT_NE(got.list[in_b].text.find("layout(binding = 0)"), std::string::npos);
}

TEST(Translate, BlocksThatDifferBetweenStagesStillLink) {
    MiniBuild b("split", {{"X", 1}});
    b.add(Stage::vertex, R"(
layout(binding=0) uniform Scene { mat4 view; } s; layout(push_constant) uniform P { vec4 a; } p;
layout(location=0) flat out vec4 c;
void main() { gl_Position = s.view[0] + p.a; c = p.a; })");
    b.add(Stage::fragment, R"(
layout(binding=0) uniform Scene { mat4 view; vec4 more; } s; layout(push_constant) uniform P { vec4 a; vec4 b; } p;
layout(location=0) in vec4 c; layout(location=0) out vec4 o;
void main() { o = s.more + p.b + c; })");
    MemoryStore store;
    Tools tools;
    const Artifacts a =
        translate_modules(b.stages, b.modules, {{Target::glsl330, Target::glsl450, Target::essl300, Target::essl310}, true},
                          store, tools, Jobs(1), {});
    EXPECT_TRUE(a.diags.empty()) << all_text(a.diags);
    ASSERT_EQ(a.list.size(), 8U);
    for (const Artifacts::Text& t : a.list) {
        EXPECT_NE(t.text.find("uniform Scene_"), std::string::npos) << t.text;
        EXPECT_EQ(t.text.find("flat"), std::string::npos) << t.text;  // the fragment stage reads it smoothly
    }
}

TEST(Translate, DepthIsCorrectedByTheLastStageOnly) {
    const Words words = spirv_of(Stage::vertex, "void main() { gl_Position = vec4(1); }");
    SlotLayout layout;
    EXPECT_NE(cross_translate(words, {Target::glsl450}, layout)[0].text.find("gl_Position.z = 2.0"), std::string::npos);
    layout.rasterised = Stage::geometry;
    EXPECT_EQ(cross_translate(words, {Target::glsl450}, layout)[0].text.find("gl_Position.z"), std::string::npos);
    layout.rasterised = Stage::vertex;
    for (const Target t : {Target::hlsl50, Target::msl21})
        EXPECT_EQ(cross_translate(words, {t}, layout)[0].text.find(".z ="), std::string::npos);
}

}  // namespace
}  // namespace kiln
