#include "compiler/toolchain/text_depth.h"

#include <gtest/gtest.h>

#include "compiler/toolchain/glsl.h"

namespace kiln {
namespace {

std::string repeated(const char* part, size_t times) {
    std::string out;
    for (size_t i = 0; i < times; ++i) out += part;
    return out;
}

TEST(TextDepth, RefusesWhatNests) {
    const std::string many[] = {
        "x = a" + repeated("+a", 5000) + ";",
        "x = a" + repeated("\n*\na", 5000) + ";",
        "x = (a" + repeated(",a", 5000) + ");",
        "x = a" + repeated(",a", 5000) + ";",
        "x = v" + repeated(".xyzw", 5000) + ";",
        "x = v" + repeated("[0]", 5000) + ";",
        "x = " + repeated("- ", 5000) + "a;",
        "x = f(a" + repeated("-a", 3000) + ")" + repeated("+a", 3000) + ";",
        "x = " + repeated("(", 100) + "a" + repeated(repeated("+a", 50).append(")").c_str(), 100) + ";",
        "float t[] = {1.0, a" + repeated("+a", 5000) + "};",
        repeated("struct S { float a; };\n", 3000),
    };
    for (const std::string& text : many) EXPECT_TRUE(too_deep(text).has_value()) << text.substr(0, 60);
    EXPECT_EQ(3u, too_deep("x;\ny;\nz = a" + repeated("+a", 5000) + ";\n")->line);
}

TEST(TextDepth, LetsLongButFlatTextsPass) {
    const std::string flat[] = {
        "",
        "const float t[] = float[](1.0" + repeated(",1.0+2.0", 50000) + ");",
        "const float t[] = {1.0" + repeated(",1.0", 50000) + "};",
        "const vec2 t[] = vec2[](vec2(1.0)" + repeated(",vec2(1.0, -2.0)", 50000) + ");",
        repeated("x += a * b;\n", 50000),
        repeated("if (a < b) { x = a + b; } else { x = f(a, b); }\n", 50000),
        "#define a" + repeated("+a", 5000) + "\nx = a;\n",
        repeated("float f(float a) { return a * 2.0; }\n", 5000),
    };
    for (const std::string& text : flat) EXPECT_FALSE(too_deep(text).has_value()) << text.substr(0, 60);
}

// At the limit glslang, and what follows it, still has stack to spare; past it there is an error and no crash.
TEST(TextDepth, TheLimitIsSafe) {
    const std::string head =
        "#version 450\nlayout(location = 0) in vec4 v;\nlayout(location = 0) out vec4 c;\nvoid main() { float x = v.x";
    const std::string tail = "; c = vec4(x); }\n";
    EXPECT_FALSE(glsl_compile(Stage::fragment, head + repeated("+v.y", max_operators / 2 - 10) + tail, Options()).words.empty());
    const Compiled out = glsl_compile(Stage::fragment, head + repeated("+v.y", 100000) + tail, Options());
    EXPECT_TRUE(out.words.empty());
    ASSERT_EQ(1u, out.messages.size());
    EXPECT_NE(std::string::npos, out.messages[0].text.find("too deep"));
    const std::string gl = "#version 330\nout vec4 c;\nvoid main() { float x = 1.0";
    EXPECT_EQ(1u, glsl_parse_back(Target::glsl330, Stage::fragment, gl + repeated("+gl_FragCoord.x", 100000) + tail).size());
}

}  // namespace
}  // namespace kiln
