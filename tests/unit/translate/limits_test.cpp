// The second opinion is glslang as an OpenGL front end: whatever is not refused must parse. Texts of HLSL and Metal have no
// such judge here; what is known about them stands in the list below.

#include "compiler/toolchain/limits.h"

#include <gtest/gtest.h>

#include "compiler/translate/translate.h"
#include "tests/unit/translate/feature_shaders.h"
#include "tests/unit/translate/mini_build.h"

namespace kiln {
namespace {

const std::vector<Target> gl_targets = {Target::glsl330, Target::glsl450, Target::essl300, Target::essl310};

std::vector<Target> text_targets() {
    std::vector<Target> out = all_targets();
    out.erase(out.begin());  // spirv
    return out;
}

Words words_of(const FeatureShader& shader) { return spirv_of(shader.stage, shader.text); }

std::vector<Translated> translate(const Words& words, const std::vector<Target>& targets) {
    const Result<Reflection> r = reflect_words(words);
    if (!r.ok()) return {};
    return cross_translate(words, targets, assign_slots({&*r}));
}

TEST(Limits, EveryGlTextParsesOrIsRefused) {
    size_t texts = 0, refused = 0;
    for (const FeatureShader& shader : feature_shaders) {
        const std::vector<Translated> got = translate(words_of(shader), gl_targets);
        ASSERT_EQ(got.size(), gl_targets.size()) << shader.name;
        for (size_t t = 0; t < got.size(); ++t) {
            if (!got[t].refusal.empty()) {
                EXPECT_TRUE(got[t].text.empty());
                ++refused;
                continue;
            }
            ++texts;
            for (const ToolMessage& m : glsl_parse_back(gl_targets[t], shader.stage, got[t].text))
                ADD_FAILURE() << shader.name << " " << name_of(gl_targets[t]) << " line " << m.line << ": " << m.text << "\n"
                              << got[t].text;
        }
    }
    EXPECT_GT(texts, 280U);
    EXPECT_GT(refused, 50U);
}

TEST(Limits, KnownHolesAreRefusedWithAReason) {
    const struct {
        const char* name;
        Target target;
        const char* why;
    } holes[] = {
        {"addcarry", Target::hlsl50, "uaddCarry"},
        {"subborrow", Target::hlsl60, "usubBorrow"},
        {"umulx", Target::hlsl50, "umulExtended"},
        {"imulx", Target::hlsl60, "imulExtended"},
        {"double", Target::msl21, "double"},
        {"double", Target::msl30, "double"},
        {"double", Target::essl310, "double"},
        {"gathercomp", Target::glsl330, "textureGather"},
        {"gather", Target::essl300, "textureGather"},
        {"shared", Target::essl300, "compute"},
        {"shared", Target::glsl330, "compute"},
        {"texbuf", Target::essl300, "buffer textures"},
        {"uboodd", Target::hlsl60, "cbuffer"},
        {"uboodd", Target::essl300, "std140"},
        {"ssbo", Target::essl300, "storage blocks"},
        {"imagenofmt", Target::essl300, "storage images"},
        {"vclip", Target::msl23, "gl_CullDistance"},
        {"debugprintf", Target::hlsl50, "debugPrintf"},
        {"debugprintf", Target::msl30, "debugPrintf"},
        {"numwg", Target::hlsl50, "gl_NumWorkGroups"},
        {"texarrdyn", Target::essl300, "index that is no constant"},
        {"g", Target::msl24, "geometry"},
        {"t", Target::hlsl60, "tess"},
        {"nonuniform", Target::glsl450, "nonuniform"},
        {"nonuniformsized", Target::glsl450, "nonuniformEXT"},
        {"nonuniformsized", Target::essl310, "nonuniformEXT"},
        {"ginstanced", Target::glsl330, "invocations of a geometry shader: not before GLSL 4.00"},
        {"int64", Target::hlsl50, "64-bit"},
        {"earlydepth", Target::essl310, "gl_FragDepth together"},
        {"outindex", Target::essl310, "array of fragment outputs"},
        {"interlock", Target::essl310, "interlock"},
        {"vbarrier", Target::glsl330, "barriers of memory"},
        {"vbarrier", Target::hlsl60, "barriers of memory"},
        {"vbarrier", Target::msl21, "barriers of memory"},
        {"vxfb", Target::glsl330, "transform feedback"},
        {"fstructs", Target::glsl330, "interpolated differently"},
        {"fstructs", Target::essl310, "interpolated differently"},
    };
    for (const auto& hole : holes) {
        const FeatureShader* shader = nullptr;
        for (const FeatureShader& s : feature_shaders)
            if (std::string(s.name) == hole.name) shader = &s;
        ASSERT_NE(shader, nullptr) << hole.name;
        const Translated got = translate(words_of(*shader), {hole.target}).at(0);
        EXPECT_NE(got.refusal.find(hole.why), std::string::npos)
            << hole.name << " " << name_of(hole.target) << ": '" << got.refusal << "'\n"
            << got.text;
        EXPECT_TRUE(got.text.empty()) << hole.name;
    }
}

// Beside the holes: what a limit must leave alone.
TEST(Limits, WhatIsNoHoleIsNotRefused) {
    const struct {
        const char* name;
        Target target;
    } whole[] = {
        {"earlydepth", Target::glsl450}, {"outindex", Target::glsl330}, {"interlock", Target::glsl450},
        {"vbarrier", Target::glsl450},   {"vbarrier", Target::essl310}, {"vxfb", Target::glsl450},
        {"vstruct", Target::glsl330},    {"vstruct", Target::glsl450},  {"fstruct", Target::essl300},
        {"fstruct", Target::essl310},    {"fstructs", Target::hlsl60},
    };
    for (const auto& one : whole)
        for (const FeatureShader& s : feature_shaders)
            if (std::string(s.name) == one.name) {
                EXPECT_EQ(translate(words_of(s), {one.target}).at(0).refusal, "") << one.name << " " << name_of(one.target);
            }
}

TEST(Limits, TheFirstBlendSourceAloneIsNoLimit) {
    size_t found = 0;
    for (const FeatureShader& shader : feature_shaders) {
        if (std::string(shader.name) != "firstsource") continue;
        ++found;
        for (const Translated& t : translate(words_of(shader), text_targets())) EXPECT_EQ(t.refusal, "");
    }
    EXPECT_EQ(found, 1U);
}

TEST(Limits, ReasonsHoldNoIdsAndOneLine) {
    for (const FeatureShader& shader : feature_shaders)
        for (const Translated& t : translate(words_of(shader), text_targets())) {
            EXPECT_EQ(t.refusal.find(" ID "), std::string::npos) << t.refusal;
            EXPECT_EQ(t.refusal.find('\n'), std::string::npos) << t.refusal;
            EXPECT_NE(t.text.empty(), t.refusal.empty()) << shader.name;
        }
}

TEST(Limits, TheSameWordsGiveTheSameTexts) {
    for (const FeatureShader& shader : feature_shaders) {
        const Words words = words_of(shader);
        const auto all = text_targets();
        const std::vector<Translated> together = translate(words, all);
        for (size_t t = 0; t < all.size(); ++t) {
            const Translated alone = translate(words, {all[t]}).at(0);
            EXPECT_EQ(alone.text, together[t].text) << shader.name << " " << name_of(all[t]);
            EXPECT_EQ(alone.refusal, together[t].refusal);
        }
    }
}

TEST(Limits, WordsThatAreNoModuleAreRefusedEverywhere) {
    for (const Words& words : {Words{}, Words{1, 2, 3}, Words{0x07230203, 0x10000, 0, 5, 0}})
        for (const Translated& t : cross_translate(words, text_targets(), {})) {
            EXPECT_TRUE(t.text.empty());
            EXPECT_FALSE(t.refusal.empty());
        }
}

TEST(Limits, AResourceWithoutASlotIsRefused) {
    const Words words = spirv_of(Stage::fragment,
                                 "layout(binding=0) uniform sampler2D t; layout(location=0) out vec4 o;"
                                 "void main() { o = texture(t, vec2(0)); }");
    for (const Translated& t : cross_translate(words, {Target::glsl450, Target::msl21}, {}))
        EXPECT_NE(t.refusal.find("has no slot"), std::string::npos);
}

}  // namespace
}  // namespace kiln
