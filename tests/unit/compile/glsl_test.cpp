#include "compiler/toolchain/glsl.h"

#include <gtest/gtest.h>

#include <thread>

#include "compiler/toolchain/spirv.h"
#include "tests/unit/compile/tokens.h"

namespace kiln {
namespace {

const char* const plain = R"(#version 450
layout(location = 0) out vec4 colour;
layout(binding = 0) uniform Scene { vec4 tint; } scene;
float unused(float x) { return x * 2.0; }
void main() { vec3 local_name = scene.tint.xyz; colour = vec4(local_name, 1.0); }
)";

TEST(Glsl, VersionDoesNotStartGlslang) { EXPECT_NE(std::string::npos, glsl_version().find("glslang 1")); }

TEST(Glsl, CompilesTokens) {
    const Compiled out = glsl_compile(Stage::fragment, tokens(plain), Options());
    EXPECT_TRUE(out.messages.empty());
    ASSERT_FALSE(out.words.empty());
    EXPECT_TRUE(spirv_validate(out.words, Options()).empty());
    EXPECT_TRUE(glsl_started());
}

TEST(Glsl, OneTokenALineIsTheSameModule) {
    EXPECT_EQ(glsl_compile(Stage::fragment, plain, Options()).words,
              glsl_compile(Stage::fragment, tokens(plain), Options()).words);
}

struct Mistake {
    const char* text;
    Stage stage;
    uint32_t line;
    const char* message;
};

TEST(Glsl, Mistakes) {
    const Mistake mistakes[] = {
        {"#version 450\nvoid\nmain\n(\n)\n{\nx\n=\n1\n;\n}\n", Stage::vertex, 7, "'x' : undeclared identifier"},
        {"#version 450\nfloat f() { return 1.0; }\n", Stage::vertex, 0, "no main() in this stage"},
        {"#version 450\nvoid main() {}\nvoid main() {}\n", Stage::vertex, 3, "'main' : function already has a body"},
        {"#version 450\nvoid main() {\n", Stage::vertex, 3, "syntax error, unexpected end of file"},
        {"#version 450\nuniform sampler2D s;\nvoid main() {}\n", Stage::fragment, 2,
         "'binding' : sampler/texture/image requires layout(binding=X)"},
        {"#version 450\nuniform U { vec4 v; } u;\nvoid main() {}\n", Stage::fragment, 2,
         "'binding' : uniform/buffer blocks require layout(binding=X)"},
        {"#version 450\nin vec4 v;\nvoid main() {}\n", Stage::vertex, 2,
         "'location' : SPIR-V requires location for user input/output"},
        {"#version 450\nuniform vec4 v;\nvoid main() {}\n", Stage::vertex, 2,
         "'non-opaque uniforms outside a block' : not allowed when using GLSL for Vulkan"},
        {"void main() {}\n", Stage::vertex, 0, "no #version line in this stage: GLSL for Vulkan begins with one, 140 or higher"},
        {"", Stage::vertex, 0, ""},
        {"\xff\xfe\n", Stage::vertex, 0, ""},
        {"#version 99999999999\nvoid main() {}\n", Stage::vertex, 0, ""},
    };
    for (const Mistake& m : mistakes) {
        const Compiled out = glsl_compile(m.stage, m.text, Options());
        EXPECT_TRUE(out.words.empty()) << m.text;
        ASSERT_FALSE(out.messages.empty()) << m.text;
        if (*m.message == '\0') continue;
        EXPECT_EQ(m.message, out.messages[0].text) << m.text;
        EXPECT_EQ(m.line, out.messages[0].line) << m.text;
        EXPECT_EQ(1u, out.messages.size()) << m.text;
    }
}

TEST(Glsl, AWarningIsNoError) {
    const Compiled out =
        glsl_compile(Stage::vertex, "#version 450\n#extension GL_NV_no_such : enable\nvoid main() {}\n", Options());
    EXPECT_FALSE(out.words.empty());
    ASSERT_EQ(1u, out.messages.size());
    EXPECT_EQ(Severity::warning, out.messages[0].severity);
    EXPECT_EQ(2u, out.messages[0].line);
}

TEST(Glsl, EveryVersionOfSpirv) {
    for (const auto& [vulkan, spirv] :
         {std::pair{0x100u, 0x100u}, {0x101u, 0x103u}, {0x101u, 0x104u}, {0x102u, 0x105u}, {0x103u, 0x106u}}) {
        Options options;
        options.vulkan = vulkan;
        options.spirv = spirv;
        const Compiled out = glsl_compile(Stage::fragment, plain, options);
        ASSERT_GT(out.words.size(), 5u);
        EXPECT_EQ(spirv >> 8 << 16 | (spirv & 0xff) << 8, out.words[1]);
        EXPECT_TRUE(spirv_validate(out.words, options).empty());
    }
}

TEST(Glsl, DebugKeepsLinesAndMessagesCountTheText) {
    Options options;
    options.debug = true;
    const std::string head = "#version 450\n#extension GL_GOOGLE_cpp_style_line_directive : require\n";
    const std::string good = head + "#line 40 \"lib/a.glsl\"\nvoid main()\n{\n#line 90 \"b.glsl\"\nfloat kept_name = 1.0;\n}\n";
    const Compiled out = glsl_compile(Stage::vertex, good, options);
    ASSERT_TRUE(out.messages.empty());
    const Result<std::string> text = spirv_disassemble(out.words);
    ASSERT_TRUE(text.ok());
    EXPECT_NE(std::string::npos, text->find("lib/a.glsl")) << *text;
    EXPECT_NE(std::string::npos, text->find("b.glsl"));
    EXPECT_NE(std::string::npos, text->find("90"));
    EXPECT_NE(std::string::npos, text->find("kept_name"));

    // A block in a function is a scope to a debugger, of which glslang 12 makes what it cannot write.
    const Compiled scopes = glsl_compile(
        Stage::fragment,
        head + "layout(location = 0) out vec4 o;\nvoid main() { for (int i = 0; i < 2; ++i) { vec4 m = vec4(i); { o = m; } } }\n",
        options);
    ASSERT_FALSE(scopes.words.empty());
    EXPECT_TRUE(spirv_validate(scopes.words, options).empty());

    const Compiled bad =
        glsl_compile(Stage::vertex, head + "#line 40 \"lib/a.glsl\"\nvoid main()\n{\n#line 90\nx = 1;\n}\n", options);
    ASSERT_EQ(1u, bad.messages.size());
    EXPECT_EQ(7u, bad.messages[0].line);
    EXPECT_EQ("'x' : undeclared identifier", bad.messages[0].text);
}

TEST(Glsl, ThreadsAgree) {
    std::vector<Words> results(4);
    std::vector<std::thread> threads;
    for (Words& result : results) {
        threads.emplace_back([&result] {
            for (int i = 0; i < 20; ++i) result = glsl_compile(Stage::fragment, plain, Options()).words;
        });
    }
    for (std::thread& t : threads) t.join();
    for (const Words& result : results) EXPECT_EQ(results[0], result);
}

TEST(Glsl, ParsesBack) {
    EXPECT_TRUE(glsl_parse_back(Target::essl300, Stage::fragment,
                                "#version 300 es\nprecision mediump float;\nout vec4 c;\nuniform sampler2D t;\nvoid main() { c = "
                                "texture(t, vec2(0.0)); }\n")
                    .empty());
    const auto errors =
        glsl_parse_back(Target::glsl330, Stage::fragment, "#version 330\nout vec4 c;\nvoid main() { c = nothing; }\n");
    ASSERT_FALSE(errors.empty());
    EXPECT_EQ("'nothing' : undeclared identifier", errors[0].text);
    EXPECT_EQ(3u, errors[0].line);
}

TEST(Glsl, LinksBack) {
    const std::string es = "#version 300 es\nprecision highp float;\n";
    const std::string vertex = es + "in vec4 p;\nout vec3 v;\nuniform vec4 u;\nvoid main() { gl_Position = p * u; v = p.xyz; }\n";
    const struct {
        const char* fragment;
        const char* problem;
    } cases[] = {
        {"in vec3 v;\nout vec4 c;\nvoid main() { c = vec4(v, 1.0); }\n", ""},
        {"in vec3 w;\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n", ""},
        {"in vec3 w;\nout vec4 c;\nvoid main() { c = vec4(w, 1.0); }\n", "no output for the fragment input 'w'"},
        {"in vec2 v;\nout vec4 c;\nvoid main() { c = vec4(v, 1.0, 1.0); }\n", "ype"},
        {"uniform vec3 u;\nout vec4 c;\nvoid main() { c = vec4(u, 1.0); }\n", "ype"},
    };
    for (const auto& c : cases) {
        const auto errors = glsl_link_back(Target::essl300, vertex, es + c.fragment);
        if (*c.problem == '\0') {
            EXPECT_TRUE(errors.empty()) << c.fragment << (errors.empty() ? "" : errors[0].text);
        } else {
            ASSERT_FALSE(errors.empty()) << c.fragment;
            EXPECT_NE(std::string::npos, errors[0].text.find(c.problem)) << errors[0].text;
        }
    }
}

}  // namespace
}  // namespace kiln
