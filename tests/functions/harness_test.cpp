// The harness itself: what must not pass does not, and everything arrives as it was sent.

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr auto same = [](auto x) { return x; };
constexpr auto square = [](auto x) { return x * x; };

bool any_mentions(const std::vector<std::string>& breaches, const std::string& what) {
    return std::any_of(breaches.begin(), breaches.end(), [&](const std::string& b) { return b.find(what) != std::string::npos; });
}

TEST(Harness, WrongFunctionsAreCaught) {
    Functions f("math.glsl");
    f.declare("float off_by_little(float x) { return x * x * 1.000001; }");
    f.declare("float off_at_one(float x) { return x == 1.0 ? 1.00001 : x; }");
    f.declare("float not_a_number(float x) { return x == 0.0 ? uintBitsToFloat(0x7fc00000u) : x; }");
    f.declare("vec3 one_component(vec3 v) { return vec3(v.xy, v.z + 1e-5); }");
    f.declare("float zero() { return 0.0; }");
    f.test("off_by_little(x)", square, number("x", linear(0, 1)));
    f.test("off_at_one(x)", same, number("x", linear(0, 2)));
    f.test("not_a_number(x)", same, number("x", linear(0, 1)));
    f.test("one_component(v)", same, vector3("v", linear(0, 1)));
    f.test("saturate(x)", square, number("x", linear(0, 1)));
    std::vector<std::string> breaches;
    const std::vector<Figures> figures = f.evaluate(breaches);
    ASSERT_EQ(figures.size(), 5u);
    for (const Figures& wrong : figures) {
        EXPECT_GT(wrong.mismatches, 0u) << wrong.name;
        EXPECT_TRUE(any_mentions(breaches, wrong.name + ", unoptimised")) << wrong.name;
        EXPECT_TRUE(any_mentions(breaches, wrong.name + ", optimised")) << wrong.name;
    }
}

TEST(Harness, LimitsAreKept) {
    Functions f("math.glsl");
    // A step at an inexact place is undecided on both sides; a division by what may be 0 has no bound.
    const auto shaky = [](auto x) { return step(decltype(x)(0.3), x * decltype(x)(0.1) + decltype(x)(0.3)); };
    f.test("step(0.3, x * 0.1 + 0.3)", shaky, number("x", linear(-2e-7, 2e-7))).named("undecided");
    f.test(
         "1.0 / (1.0 + abs(x * 0.0))", [](auto x) { return decltype(x)(1) / (decltype(x)(1) + x * decltype(x)(0)); },
         number("x", linear(-3e38, 3e38)))
        .named("bounded");
    f.test(
         "x > 0.5 ? 1.0 : 1.0 / (x * 0.0 + 1.0)",
         [](auto x) { return x / (x - x * decltype(x)(1)) * decltype(x)(0) + decltype(x)(1); }, number("x", linear(0.1, 1)))
        .exactly([](auto) { return 1.0; })
        .named("unbounded");
    f.test("x", same, number("x", linear(0, 1))).truth([](auto x) { return x + 1e-3; }, 1e-4).named("modelled");
    std::vector<std::string> breaches;
    const std::vector<Figures> figures = f.evaluate(breaches);
    EXPECT_TRUE(any_mentions(breaches, "samples are unbounded"));
    EXPECT_TRUE(any_mentions(breaches, "the truth is"));
    EXPECT_FALSE(any_mentions(breaches, "bounded: the")) << "1 + 0 x keeps its bound";
    ASSERT_EQ(figures.size(), 4u);
    EXPECT_NEAR(figures[3].model_relative, 1, 0.1);
    EXPECT_GT(figures[0].undecided, 0u);
}

TEST(Harness, TooFewSamplesAreABreach) {
    Functions f("math.glsl");
    f.test("x", same, number("x", linear(0, 1))).skip([](auto x) { return x != 0.5; });
    std::vector<std::string> breaches;
    EXPECT_TRUE(f.evaluate(breaches).empty());
    EXPECT_TRUE(any_mentions(breaches, "x: only"));
}

TEST(Harness, TextThatDoesNotCompileIsABreach) {
    Functions f("math.glsl");
    f.test("saturate(y)", same, number("x", linear(0, 1)));
    std::vector<std::string> breaches;
    EXPECT_TRUE(f.evaluate(breaches).empty());
    EXPECT_TRUE(any_mentions(breaches, "'y' : undeclared identifier"));
}

TEST(Harness, EveryShapeArrivesAsItWasSent) {
    Functions f("math.glsl");
    f.test("x", same, number("x", finite().also({-0.0}))).named("float");
    f.test("v", same, vector2("v", either_sign(1e-30, 1e30))).named("vec2");
    f.test("v", same, unit("v")).named("vec3");
    f.test("v", same, vector4("v", logarithmic(1e-3, 10))).named("vec4");
    f.test("m", same, matrix3("m", linear(-1, 1))).named("mat3");
    f.test("m", same, matrix4("m", values({-2, 0.5, 3}))).named("mat4");
    f.test("a", same, array<9>(vector3("a", linear(-1, 1)))).named("array");
    f.test(
         "vec2(i, j)",
         [](auto x, int i, int j) {
             return Vec2<decltype(x)>{decltype(x)(i), decltype(x)(j)};
         },
         number("x", linear(0, 1)), integer("i", -7, 7), integer("j", 0, 1000))
        .named("int");
    f.test(
         "result = vec2(b >> 16u, b & 65535u);",
         [](auto x, uint32_t b) {
             using T = decltype(x);
             return Vec2<T>{T(static_cast<int>(b >> 16)), T(static_cast<int>(b & 65535u))};
         },
         number("x", linear(0, 1)), bits("b"))
        .named("uint");
    std::vector<std::string> breaches;
    const std::vector<Figures> all = f.evaluate(breaches);
    EXPECT_EQ(all.size(), 9u);
    for (const Figures& figures : all) EXPECT_EQ(figures.absolute, 0) << figures.name;
    for (const std::string& b : breaches) ADD_FAILURE() << b;
}

TEST(Harness, WithoutADriverItFails) {
    // Sorted out by the child, which sees no driver and must not pass.
    const std::string command = "KILN_ICD=/nonexistent/lvp_icd.json '" + testing::internal::GetArgvs()[0] +
                                "' --gtest_filter=Functions.Fresnel > /dev/null 2>&1";
    const int status = std::system(command.c_str());
    EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    EXPECT_NE(status, -1);
}

}  // namespace
}  // namespace kiln::test
