#include "compiler/toolchain/spirv.h"

#include <gtest/gtest.h>

#include "compiler/toolchain/glsl.h"
#include "compiler/toolchain/spirv_names.h"

namespace kiln {
namespace {

Words compiled(Stage stage, const std::string& text, const Options& options = {}) {
    Compiled out = glsl_compile(stage, text, options);
    EXPECT_FALSE(out.words.empty()) << text << (out.messages.empty() ? "" : out.messages[0].text);
    return out.words;
}

std::string text_of(const Result<Words>& words) {
    EXPECT_TRUE(words.ok()) << (words.ok() ? "" : words.error().message);
    if (!words.ok()) return {};
    const Result<std::string> text = spirv_disassemble(*words);
    return text.ok() ? *text : "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string header = R"(#version 450
struct Light { vec4 position; float radius; };
layout(set = 1, binding = 2) uniform Scene { Light lights[4]; vec4 tint; } scene;
layout(binding = 3) uniform sampler2D albedo;
layout(push_constant) uniform Push { float exposure; } push;
layout(constant_id = 7) const float gain = 2.0;
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 colour;
)";

TEST(Prune, KeepsInterfaceNamesAndDropsInnerOnes) {
    const std::string text = text_of(spirv_prune(compiled(Stage::fragment, header + R"(
vec4 helper_function(vec2 inner_parameter) { vec4 inner_local = texture(albedo, inner_parameter); return inner_local; }
void main() {
    colour = helper_function(uv) * scene.lights[int(uv.x)].radius * scene.tint * push.exposure * gain;
}
)"),
                                                 Options()));
    for (const char* name : {"\"Scene\"", "\"scene\"", "\"lights\"", "\"tint\"", "\"Light\"", "\"position\"", "\"radius\"",
                             "\"albedo\"", "\"Push\"", "\"push\"", "\"exposure\"", "\"gain\"", "\"uv\"", "\"colour\""}) {
        EXPECT_TRUE(has(text, name)) << name << "\n" << text;
    }
    for (const char* name : {"helper_function", "inner_parameter", "inner_local", "OpSource"})
        EXPECT_FALSE(has(text, name)) << name;
}

TEST(Prune, DebugKeepsEverything) {
    Options options;
    options.debug = true;
    const std::string text = text_of(spirv_prune(
        compiled(Stage::fragment, header + "void main() { vec4 inner_local = scene.tint; colour = inner_local; }", options),
        options));
    for (const char* part : {"inner_local", "OpSource", "OpLine"}) EXPECT_TRUE(has(text, part)) << part;
}

TEST(Prune, MergesWhatDiffersInDeadCodeAndInnerNames) {
    const std::string a = header + R"(
float never_called(float x) { return x * scene.tint.x; }
void main() { vec4 first = texture(albedo, uv); colour = first; }
)";
    const std::string b = header + R"(
void main() { vec4 second = texture(albedo, uv); if (false) { second = scene.tint; } colour = second; }
)";
    const std::string c = header + "void main() { vec4 t = texture(albedo, uv); colour = t; }";
    const Result<Words> pa = spirv_prune(compiled(Stage::fragment, a), Options());
    const Result<Words> pb = spirv_prune(compiled(Stage::fragment, b), Options());
    const Result<Words> pc = spirv_prune(compiled(Stage::fragment, c), Options());
    EXPECT_NE(compiled(Stage::fragment, a), compiled(Stage::fragment, c));
    EXPECT_EQ(text_of(pa), text_of(pc));
    EXPECT_EQ(text_of(pb), text_of(pc));
}

TEST(Prune, UnreadInputsLeaveTheInterfaceAndOutputsStay) {
    const std::string text = text_of(spirv_prune(compiled(Stage::fragment, R"(#version 450
layout(location = 0) in vec2 read_input;
layout(location = 1) in vec2 unread_input;
layout(location = 0) out vec4 written;
layout(location = 1) out vec4 unwritten;
layout(binding = 0) uniform sampler2D unread_texture;
void main() { written = read_input.xyxy; }
)"),
                                                 Options()));
    for (const char* name : {"\"read_input\"", "\"written\"", "\"unwritten\""}) EXPECT_TRUE(has(text, name)) << name << text;
    for (const char* name : {"unread_input", "unread_texture", "SampledImage"}) EXPECT_FALSE(has(text, name)) << name << text;
}

TEST(Prune, ABranchOnAConstantIsResolvedBeforeMerging) {
    const std::string rest = R"(
void main() { if (MODE == 1) colour = scene.tint; else colour = texture(albedo, uv); switch (MODE) { case 7: colour *= gain; } }
)";
    const auto pruned = [&](const char* mode) {
        std::string text = header + rest;
        for (size_t at = text.find("MODE"); at != std::string::npos; at = text.find("MODE", at)) text.replace(at, 4, mode);
        return *spirv_prune(compiled(Stage::fragment, text), Options());
    };
    EXPECT_EQ(pruned("2"), pruned("3"));
    EXPECT_NE(pruned("1"), pruned("3"));
    EXPECT_NE(pruned("7"), pruned("3"));
    EXPECT_TRUE(spirv_validate(pruned("3"), Options()).empty());
}

TEST(Prune, AnotherInterfaceNameIsAnotherModule) {
    const std::string a = header + "void main() { colour = texture(albedo, uv); }";
    std::string b = a;
    for (size_t at = b.find("albedo"); at != std::string::npos; at = b.find("albedo", at)) b.replace(at, 6, "normal");
    EXPECT_NE(*spirv_prune(compiled(Stage::fragment, a), Options()), *spirv_prune(compiled(Stage::fragment, b), Options()));
}

TEST(Optimise, EveryLevelGivesValidModules) {
    const Words pruned = *spirv_prune(compiled(Stage::fragment, header + R"(
float f(int n) { float s = 0.0; for (int i = 0; i < n; ++i) { if (i == 3) return s; s += scene.lights[i].radius; } return s; }
void main() { if (uv.x < 0.0) discard; colour = scene.tint * f(int(uv.y)) * f(2); }
)"),
                                      Options());
    size_t none = 0;
    for (const Optimise level : {Optimise::none, Optimise::performance, Optimise::size}) {
        Options options;
        options.optimise = level;
        const Result<Words> out = spirv_optimise(pruned, options);
        ASSERT_TRUE(out.ok());
        EXPECT_TRUE(spirv_validate(*out, options).empty());
        EXPECT_TRUE(has(text_of(out), "\"tint\""));
        if (level == Optimise::none)
            none = out->size();
        else
            EXPECT_NE(pruned, *out);
    }
    EXPECT_EQ(pruned.size(), none);
}

TEST(Optimise, CooperativeMatricesAreLeftAsTheyAre) {
    Options options;
    options.vulkan = 0x103;
    options.spirv = 0x106;
    const Result<Words> pruned = spirv_prune(compiled(Stage::compute, R"(#version 450
#extension GL_KHR_memory_scope_semantics : require
#extension GL_NV_cooperative_matrix : require
layout(set = 0, binding = 0) buffer Data { float x[64]; } data;
void main() {
    fcoopmatNV<32, gl_ScopeSubgroup, 8, 8> m = fcoopmatNV<32, gl_ScopeSubgroup, 8, 8>(1.0);
    m = m + m;
    coopMatStoreNV(m, data.x, 0, 8, false);
    data.x[0] = m[1];
}
)",
                                                      options),
                                             options);
    ASSERT_TRUE(pruned.ok());
    for (const Optimise level : {Optimise::performance, Optimise::size}) {
        options.optimise = level;
        const Result<Words> out = spirv_optimise(*pruned, options);
        ASSERT_TRUE(out.ok());
        EXPECT_EQ(*out, *pruned);
        EXPECT_TRUE(spirv_validate(*out, options).empty());
    }
}

TEST(Validate, ScalarLayoutOnlyWhereTheSourceAskedForIt) {
    const std::string rest = R"(
layout(binding = 0, SCALAR) uniform U { float a; vec3 b; } u;
layout(location = 0) out vec4 colour;
void main() { colour = vec4(u.b, u.a); }
)";
    std::string text = "#version 450\n#extension GL_EXT_scalar_block_layout : require\n" + rest;
    text.replace(text.find("SCALAR"), 6, "scalar");
    const Result<Words> pruned = spirv_prune(compiled(Stage::fragment, text), Options());
    ASSERT_TRUE(pruned.ok());
    EXPECT_TRUE(spirv_validate(*pruned, Options()).empty());
}

TEST(Validate, RefusesDamage) {
    Words words = compiled(Stage::fragment, header + "void main() { colour = scene.tint; }");
    words.resize(words.size() - 2);
    EXPECT_FALSE(spirv_validate(words, Options()).empty());
    for (const Words& bad :
         {Words{}, Words{1, 2, 3}, Words{0x07230203, 0x10300, 0, 10, 0, 0}, Words{0x07230203, 0x10300, 0, 10, 0, 0x00ff0005}}) {
        EXPECT_FALSE(spirv_validate(bad, Options()).empty());
        EXPECT_FALSE(spirv_prune(bad, Options()).ok());
        EXPECT_FALSE(spirv_optimise(bad, Options()).ok());
        EXPECT_FALSE(spirv_disassemble(bad).ok());
        EXPECT_FALSE(keep_interface_names(bad).ok());
    }
}

TEST(Names, EveryTruncationIsRefusedOrWellFormed) {
    const Words words = compiled(Stage::fragment, header + "void main() { colour = scene.tint; }");
    for (size_t n = 0; n < words.size(); ++n) {
        const Words cut(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(n));
        const Result<Words> out = keep_interface_names(cut);
        EXPECT_TRUE(!out.ok() || out->size() <= n);
    }
}

}  // namespace
}  // namespace kiln
