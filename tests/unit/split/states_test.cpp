// How much work the split does, and what it says about variants.
#include <gtest/gtest.h>

#include <algorithm>

#include "fixture.h"

namespace {

constexpr const char* head = "#version 450\n";

TEST(SplitStates, FortyFlagsOfWhichTwoAreUsed) {
    TestShader shader;
    std::string header = "#ifndef COMMON\n#define COMMON\n";
    for (int i = 0; i < 40; ++i) {
        const std::string n = std::to_string(i);
        shader.axes.push_back(flag("A" + n));
        header += "#if A" + n + "\n#define HAS_" + n + " 1\n#else\n#define HAS_" + n + " 0\n#endif\n";
    }
    shader.files["common.glsl"] = header + "#endif\n";
    shader.files["main"] =
        std::string(head) + "#include \"common.glsl\"\n#if HAS_3\nint a;\n#endif\n#if HAS_3 && HAS_7 || HAS_7\nint b;\n#endif\n";
    const auto test = run_split(shader);
    EXPECT_EQ(messages(test->split), "");
    EXPECT_EQ(test->split.classes.size(), 4u);
    EXPECT_LE(test->split.states, 200u);
    EXPECT_EQ(test->space->diagram->count(test->split.classes[0].variants).decimal(), "274877906944");
}

TEST(SplitStates, BigAxesAskedOneQuestion) {
    TestShader shader;
    std::vector<int32_t> values(64);
    for (int i = 0; i < 64; ++i) values[static_cast<size_t>(i)] = i;
    std::string text = head;
    for (const char* const id : {"IDA", "IDB", "IDC"}) {
        shader.axes.push_back(numbered(id, values));
        text += std::string("#if ") + id + " == 7\nint seven_" + id + ";\n#endif\n";
    }
    shader.files["main"] = text;
    const auto test = run_split(shader);
    EXPECT_EQ(test->split.classes.size(), 8u);
    EXPECT_LE(test->split.states, 10u);
    EXPECT_EQ(test->split.axes_read, (std::vector<uint32_t>{0, 1, 2}));
}

TEST(SplitStates, SumsOfManyFlagsAreNotEnumerated) {
    TestShader shader;
    std::string sum;
    for (int i = 0; i < 40; ++i) {
        shader.axes.push_back(flag("A" + std::to_string(i)));
        sum += (i == 0 ? "A" : " + A") + std::to_string(i);
    }
    shader.files["main"] = std::string(head) + "#define COUNT (" + sum + ")\n#if COUNT > 20\nint many;\n#endif\n";
    const auto test = run_split(shader);
    EXPECT_EQ(messages(test->split), "");
    EXPECT_EQ(test->split.classes.size(), 2u);
    EXPECT_LE(test->split.states, 5u);
}

TEST(SplitStates, ChainsOfDerivedFlags) {
    TestShader shader;
    std::string text = head;
    for (int i = 0; i < 40; ++i) {
        const std::string n = std::to_string(i);
        shader.axes.push_back(defined("A" + n));
        text += "#if defined(A" + n + ")" + (i == 0 ? "" : " || C" + std::to_string(i - 1)) + "\n#define C" + n +
                " 1\n#else\n#define C" + n + " 0\n#endif\n";
    }
    text += "int x = C39;\n";
    shader.files["main"] = text;
    const auto test = run_split(shader);
    EXPECT_EQ(messages(test->split), "");
    EXPECT_EQ(test->split.classes.size(), 2u);
    EXPECT_LE(test->split.states, 200u);
}

TEST(SplitStates, EqualBranchesMakeNoProduct) {
    TestShader shader;
    std::string text = head;
    for (int i = 0; i < 60; ++i) {
        shader.axes.push_back(flag("A" + std::to_string(i)));
        text += "#if A" + std::to_string(i) + "\nint a; // one\n#else\n  int  a;\n#endif\n";
    }
    shader.files["main"] = text;
    const auto test = run_split(shader);
    EXPECT_EQ(test->split.classes.size(), 1u);
    EXPECT_LE(test->split.states, 200u);
}

TEST(SplitStates, OppositeBranchesMakeNoProduct) {
    // Apart at every #endif, equal one line later.
    TestShader shader;
    std::string text = head;
    for (int i = 0; i < 40; ++i) {
        const std::string a = "A" + std::to_string(i);
        shader.axes.push_back(flag(a));
        text += "#if " + a + "\nint a;\n#endif\n#if !" + a + "\nint a;\n#endif\n";
    }
    shader.files["main"] = text;
    EXPECT_EQ(run_split(shader)->split.classes.size(), 1u);
}

TEST(SplitStates, LimitNamesTheAxes) {
    TestShader shader;
    std::string text = head;
    for (int i = 0; i < 30; ++i) {
        const std::string a = "A" + std::to_string(i);
        shader.axes.push_back(flag(a));
        text += "#if " + a + "\nint " + a + "_;\n#endif\n";
    }
    shader.files["main"] = text;
    shader.max_states = 1000;
    const auto test = run_split(shader);
    EXPECT_NE(messages(test->split).find("more than 1000 different texts or preprocessor states; the axes that split most: a"),
              std::string::npos)
        << messages(test->split);
    EXPECT_TRUE(test->split.classes.empty());
}

TEST(SplitStates, ClassesAreOrderedByTheirSmallestVariant) {
    const auto test = run_split(one_file(std::string(head) + "int x = A;\n", {numbered("A", {5, 3, 9})}));
    ASSERT_EQ(test->split.classes.size(), 3u);
    EXPECT_EQ(test->split.classes[0].text, "#version 450\nint\nx\n=\n5\n;\n");
    EXPECT_EQ(test->split.classes[1].text, "#version 450\nint\nx\n=\n3\n;\n");
    EXPECT_EQ(test->split.classes[0].places[2].line, 2u);
    EXPECT_EQ(test->split.classes[0].places[2].column, 5u);
    EXPECT_EQ(test->split.files, std::vector<std::string>{"main"});
    EXPECT_EQ(test->split.lexed, 1u);
}

TEST(SplitStates, GuardsDoNotReadAnAxis) {
    const auto test = run_split(one_file(std::string(head) + "#ifndef A\n#define A 7\n#endif\nint x;\n", {flag("A"), flag("B")}));
    EXPECT_EQ(messages(test->split), "");
    EXPECT_EQ(test->split.classes.size(), 1u);
    EXPECT_TRUE(test->split.axes_read.empty());
}

TEST(SplitStates, RulesTakeImpossibleBranchesAway) {
    TestShader shader = one_file(std::string(head) + "#if A && B\n#error both\n#endif\nint x;\n", {flag("A"), flag("B")});
    EXPECT_NE(messages(run_split(shader)->split), "");
    shader.forbid = "a && b";
    EXPECT_EQ(messages(run_split(shader)->split), "");
}

TEST(SplitStates, AllOverAgain) {
    // The same call twice gives the same answer, and the text of a single variant is a class of its own.
    const TestShader shader =
        one_file(std::string(head) + "#if A == 2\nint x;\n#endif\nint y = B;\n", {numbered("A", {1, 2}), flag("B")});
    const auto a = run_split(shader), b = run_split(shader);
    ASSERT_EQ(a->split.classes.size(), b->split.classes.size());
    for (size_t i = 0; i < a->split.classes.size(); ++i) EXPECT_EQ(a->split.classes[i].text, b->split.classes[i].text);
}

TEST(SplitLayout, LinesAreKept) {
    TestShader shader;
    shader.axes = {flag("A")};
    shader.files["main"] =
        std::string(head) + "\n#include \"lib/x.glsl\"\nint a; int b;\n#if A\n\nint c;\n#else\nint c;\n#endif\n";
    shader.files["lib/x.glsl"] = "\n\nint x =\n 3;\n";
    EXPECT_EQ(run_split(shader)->split.classes.size(), 1u);
    shader.lines = true;
    const auto test = run_split(shader);
    ASSERT_EQ(test->split.classes.size(), 2u);
    const kiln::Class& c = test->split.classes[1];
    EXPECT_EQ(c.text,
              "#version 450\n#extension GL_GOOGLE_cpp_style_line_directive : require\n#line 3 \"lib/x.glsl\"\nint x =\n3 ;\n"
              "#line 4 \"main\"\nint a ; int b ;\n#line 7 \"main\"\nint c ;\n");
    EXPECT_EQ(c.places.size(), 9u);
}

}  // namespace
