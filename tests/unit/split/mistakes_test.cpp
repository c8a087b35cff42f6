// Mistakes and hostile input: what is said, where, and for which variants.
#include <gtest/gtest.h>

#include "fixture.h"

namespace {

constexpr const char* head = "#version 450\n";

std::string said(const TestShader& shader) { return messages(run_split(shader)->split); }

TEST(SplitMistakes, UndefinedIdentifiers) {
    const std::vector<TestAxis> axes = {flag("SHADOWS"), numbered("LIGHT", {0, 1, 2})};
    EXPECT_EQ(said(one_file(std::string(head) + "#if SHADOW\n#endif\n", axes)),
              "m/main:2:5: 'SHADOW' is not defined; did you mean 'SHADOWS'? [in 6 of 6 variants of test: always]\n");
    EXPECT_EQ(said(one_file(std::string(head) + "#if defined(SHADOW) && SHADOW > 2\n#endif\n", axes)), "");
    EXPECT_EQ(said(one_file(std::string(head) + "#if LIGHT == 0 && FOO\n#endif\n", axes)),
              "m/main:2:19: 'FOO' is not defined [in 2 of 6 variants of test: exactly when light == 0]\n");
    EXPECT_EQ(said(one_file(std::string(head) + "#if SHADOWS\n#define N 2\n#endif\n#if N == 2\n#endif\n", axes)),
              "m/main:5:5: 'N' is not defined [in 3 of 6 variants of test: exactly when !shadows]\n");
    EXPECT_EQ(said(one_file(std::string(head) + "#if 0 && (FOO || BAR)\n#elif LIGHT < 3 || BAZ\n#endif\n", axes)), "");
    TestShader lenient = one_file(std::string(head) + "#if FOO\n#endif\n", axes);
    lenient.undefined_is_zero = true;
    EXPECT_EQ(said(lenient), "");
}

TEST(SplitMistakes, DefinedAxesCountAsZero) {
    EXPECT_EQ(said(one_file(std::string(head) + "#if SKIN == 0\nint none;\n#endif\n#if SKIN + 1 == 2\nint one;\n#endif\n",
                            {defined("SKIN")})),
              "");
}

TEST(SplitMistakes, ErrorDirectiveSuggestsARule) {
    const auto test = run_split(one_file(std::string(head) + "#if A && LIGHT == 2\n#error \"don't: mix\"\n#endif\n",
                                         {flag("A"), numbered("LIGHT", {0, 1, 2})}));
    ASSERT_EQ(test->split.diags.list().size(), 1u);
    const kiln::Diag& d = test->split.diags.list().front();
    EXPECT_EQ(d.message, "#error \"don't: mix\"");
    EXPECT_EQ(d.source_line, "#error \"don't: mix\"");
    ASSERT_EQ(d.notes.size(), 2u);
    EXPECT_EQ(d.notes[0], "in 1 of 6 variants of test: exactly when a && light == 2");
    EXPECT_NE(d.notes[1].find("- forbid: a && light == 2"), std::string::npos) << d.notes[1];
}

TEST(SplitMistakes, RedefiningAnAxis) {
    EXPECT_EQ(said(one_file(std::string(head) + "#define LIGHT 2\n", {numbered("LIGHT", {0, 1, 2})})),
              "m/main:2:9: macro 'LIGHT' redefined with another meaning [in 2 of 3 variants of test: exactly when light <= 1]\n");
    EXPECT_EQ(
        said(one_file(std::string(head) + "#undef LIGHT\n#define LIGHT 2\nint x = LIGHT;\n", {numbered("LIGHT", {0, 1, 2})})),
        "");
}

TEST(SplitMistakes, IncludesThatDoubleAtEachLevel) {
    TestShader shader;
    shader.files["main"] = std::string(head) + "#include \"0\"\n";
    for (int i = 0; i < 60; ++i) {
        const std::string line = "#include \"" + std::to_string(i + 1) + "\"\n";
        shader.files[std::to_string(i)] = line + line;
    }
    shader.files["60"] = "\n";
    EXPECT_NE(said(shader).find("once more the includes read more than"), std::string::npos) << said(shader);
}

TEST(SplitMistakes, Includes) {
    TestShader shader;
    shader.include = {"../lib"};
    shader.files["main"] = std::string(head) + "#include \"a/b.glsl\"\n";
    shader.files["a/b.glsl"] = "#include \"c.glsl\"\n";
    shader.files["a/c.glsl"] = "#include \"../../secret\"\n";
    EXPECT_EQ(said(shader),
              "m/a/c.glsl:1:10: #include: '../../secret' leaves the search path [in 1 of 1 variants of test: always]\n");
    shader.files["a/c.glsl"] = "#include \"/etc/passwd\"\n";
    EXPECT_NE(said(shader).find("absolute path"), std::string::npos);
    shader.files["a/c.glsl"] = "#include \"b.glsl\"\n";
    EXPECT_NE(said(shader).find("include cycle: a/b.glsl -> a/c.glsl -> a/b.glsl"), std::string::npos) << said(shader);
    shader.files["a/c.glsl"] = "#include \"none.glsl\"\n";
    EXPECT_NE(said(shader).find("cannot find 'none.glsl'; looked at m/a/none.glsl, m/none.glsl, lib/none.glsl"),
              std::string::npos)
        << said(shader);
    const auto test = run_split(shader);
    ASSERT_EQ(test->split.reads.size(), 6u);
    EXPECT_EQ(test->split.reads[1].path, "m/a/b.glsl");
    EXPECT_FALSE(test->split.reads[4].present);
    EXPECT_EQ(test->split.reads[3].path, "m/a/none.glsl");
}

TEST(SplitMistakes, SelfIncludeThatEnds) {
    TestShader shader;
    shader.axes = {flag("A")};
    shader.files["main"] = std::string(head) + "#define N 0\n#include \"loop\"\n";
    shader.files["loop"] =
        "#if N == 0\n#undef N\n#define N 1\n#include \"loop\"\n#elif N == 1\n#undef N\n#define N 2\nint x = A;\n#include "
        "\"loop\"\n#endif\n";
    EXPECT_EQ(said(shader), "");
    EXPECT_EQ(run_split(shader)->split.classes.size(), 2u);
}

TEST(SplitMistakes, PragmaOnce) {
    TestShader shader;
    shader.axes = {flag("A")};
    shader.files["main"] = std::string(head) + "#if A\n#include \"x\"\n#endif\n#include \"x\"\nint y;\n";
    shader.files["x"] = "#pragma once\nint x;\n";
    const auto test = run_split(shader);
    ASSERT_EQ(test->split.classes.size(), 1u);
    EXPECT_EQ(test->split.classes[0].text, "#version 450\nint\nx\n;\nint\ny\n;\n");
}

TEST(SplitMistakes, Bytes) {
    EXPECT_EQ(said(one_file("\xEF\xBB\xBF#version 450\r\n#if 1\r\nint x; // \xC3\xA9\r\n#endif", {})), "");
    EXPECT_NE(said(one_file(std::string(head) + "int \xC3\xA9;\n", {})).find("2:5: byte 0xc3 outside a comment"),
              std::string::npos);
    EXPECT_NE(said(one_file(std::string(head) + std::string("int a\0;\n", 8), {})).find("byte 0x00"), std::string::npos);
    EXPECT_NE(said(one_file("\xFF\xFE#\0v", {})).find("UTF-16"), std::string::npos);
    EXPECT_EQ(said(one_file("", {})), "");
    TestShader missing = one_file("", {});
    missing.files.clear();
    EXPECT_NE(said(missing).find("m/test.yaml:1:1: cannot find 'main'; looked at m/main"), std::string::npos) << said(missing);
}

TEST(SplitMistakes, TooMuch) {
    EXPECT_NE(said(one_file(std::string(head) + std::string(20 << 20, ' '), {})).find("larger than 16 MiB"), std::string::npos);
    std::string bomb = head;
    bomb += "#define X0 x x\n";
    for (int i = 1; i < 60; ++i)
        bomb += "#define X" + std::to_string(i) + " X" + std::to_string(i - 1) + " X" + std::to_string(i - 1) + "\n";
    EXPECT_NE(said(one_file(bomb + "X59\n", {})).find("more than can be read"), std::string::npos);
    EXPECT_NE(said(one_file(std::string(head) + "#if " + std::string(100000, '(') + "\n#endif\n", {})).find("nested more than"),
              std::string::npos);
    EXPECT_NE(said(one_file(std::string(head) + "#if " + std::string(100000, '!') + "1\n#endif\n", {})).find("nested more than"),
              std::string::npos);
    std::string calls;
    for (int i = 0; i < 2000; ++i) calls += "F(";
    EXPECT_NE(said(one_file(std::string(head) + "#define F(x) x\n" + calls + "1" + std::string(2000, ')') + "\n", {}))
                  .find("nested more than"),
              std::string::npos);
    std::string deep = head;
    for (int i = 0; i < 5000; ++i) deep += "#if 1\n";
    for (int i = 0; i < 5000; ++i) deep += "#endif\n";
    EXPECT_NE(said(one_file(deep, {})).find("nest"), std::string::npos);
}

TEST(SplitMistakes, LongLines) {
    std::string line = "float x = 0.0";
    for (int i = 0; i < 20000; ++i) line += " + A * " + std::to_string(i);
    const auto test = run_split(one_file(std::string(head) + line + ";\n", {flag("A")}));
    EXPECT_EQ(messages(test->split), "");
    EXPECT_EQ(test->split.classes.size(), 2u);
}

}  // namespace
