// Handwritten shaders, one for each construct, on every variant against glslang's own preprocessor.
#include <gtest/gtest.h>

#include "fixture.h"

namespace {

constexpr const char* head = "#version 450\n";

TEST(SplitOracle, Plain) { expect_like_oracle(one_file(std::string(head) + "void main() { gl_FragDepth = 0.5; }\n", {})); }

TEST(SplitOracle, Conditionals) {
    expect_like_oracle(one_file(std::string(head) + R"(
#if A
int a;
#elif B
int b;
#else
int c;
#endif
#ifdef A
int d;
#endif
#ifndef NOTHING
float e = B ? 1.0 : 2.5e-3;
#endif
)",
                                {flag("A"), flag("B")}));
}

TEST(SplitOracle, Joining) {
    expect_like_oracle(one_file(std::string(head) + R"(
#if A
int x;
#else
int  x; // the same
#endif
#if A
int y;
#endif
#if !A
int y;
#endif
)",
                                {flag("A")}));
}

TEST(SplitOracle, GuardedMacros) {
    expect_like_oracle(one_file(std::string(head) + R"(
#if LIGHT == 0
#define COUNT 1
#elif LIGHT == 1
#define COUNT (2 + LIGHT)
#else
#define COUNT(x) x
#endif
#ifdef SKIN
#define WEIGHT SKIN
#else
#define WEIGHT 0
#endif
int a[COUNT (3)];
#if WEIGHT
int w = WEIGHT;
#endif
int l = LIGHT, s;
)",
                                {numbered("LIGHT", {0, 1, 2}), defined("SKIN")}));
}

TEST(SplitOracle, FunctionLike) {
    expect_like_oracle(one_file(std::string(head) + R"(
#define CAT(a, b) a##b
#define XCAT(a, b) CAT(a, b)
#define F(x) x + A
#define G F
#define EMPTY
#define ID(x) x
int CAT(v, 1), XCAT(v, A), CAT(v, A);
int y = F(A) G(2) G
(3) ID(F)(4) ID(ID(F)(A)) EMPTY F (
 1, // comment
) ;
int self = ID(ID(ID(A)));
#undef F
int z = F(1);
)",
                                {numbered("A", {3, 4})}));
}

TEST(SplitOracle, Version) {
    for (const char* version : {"450", "450 core", "460", "330", "310 es", "320 es", "440 compatibility"})
        expect_like_oracle(one_file(std::string("#version ") + version + R"(
int v = __VERSION__;
#ifdef VULKAN
int k = VULKAN;
#endif
#if defined(GL_core_profile) && defined(GL_EXT_multiview)
int c = GL_core_profile;
#endif
#ifdef GL_ES
int es;
#endif
)",
                                    {}));
}

TEST(SplitOracle, LineAndFile) {
    expect_like_oracle(one_file(std::string(head) + R"(
int a = __LINE__;
#define L __LINE__
#define ID(x) x
int b = ID(
  L), c = ID(__LINE__
);
#if A
#line 100
#endif
int d = __LINE__;
#line 7 3
int e = __LINE__ + __FILE__;
)",
                                {flag("A")}));
}

TEST(SplitOracle, Includes) {
    TestShader shader;
    shader.axes = {flag("A"), flag("B")};
    shader.files["main"] = std::string(head) + R"(
#extension GL_GOOGLE_include_directive : enable
#include "lib/x.glsl"
#if B
#include <lib/x.glsl>
#include "y.glsl"
#endif
int m = X + Y + __LINE__;
)";
    shader.files["lib/x.glsl"] =
        "#ifndef X_H\n#define X_H\n#include \"../y.glsl\"\n#include \"deep/z.glsl\"\n#if A\n#define X 1\n#else\n#define X "
        "2\n#endif\n#endif";
    shader.files["y.glsl"] = "#ifndef Y\n#define Y 5\nint y;\n#endif\n";
    shader.files["lib/deep/z.glsl"] = "int z = A; // no newline";
    expect_like_oracle(shader);
}

TEST(SplitOracle, Expressions) {
    const char* const expressions[] = {
        "A",
        "A == 2",
        "A + B * 2 > 5",
        "(A + B) % 3 == 1",
        "A << B & 4",
        "~A & 1",
        "-A < -2",
        "!A || B",
        "A && B == 3",
        "defined A && defined(B)",
        "A ^ B",
        "A | B",
        "(A > 1) == (B > 1)",
        "A >> 1",
        "A - B - 1",
        "1 + + A",
        "0x10 == 16 && A",
        "010 == 8",
        "A / 2",
        "7 / (A + 1)",
        "A != B",
        "A <= B",
        "A >= B",
        "A == 1 || A == 2 && B",
        "(((A)))",
        "2147483647 + A < 0",
        "A * 65536 * 65536",
        "defined(Z) || A",
        "A && defined Z",
        "4294967295 < A",
        "!!A",
        "- -A == 2",
        "A % 2",
    };
    for (const char* e : expressions)
        expect_like_oracle(one_file(std::string(head) + "#if " + e + "\nint yes;\n#elif B == 0\nint other;\n#endif\n",
                                    {numbered("A", {0, 1, 2, 5}), numbered("B", {0, 1, 3, -2})}),
                           e);
}

TEST(SplitOracle, ExpressionErrors) {
    const char* const expressions[] = {
        "",          "A +",         "(A",     "A)",          "1.0",        "A B",       "1u",  "\"x\"", "defined", "defined(",
        "defined(A", "defined 3",   "A / 0",  "1 % (A - A)", "0 && 1 / 0", "F",         "F(",  "F(1",   "F(1)",    "F(1) + 1",
        "F()",       "F(1, 2)",     "@",      "A ? 1 : 2",   "A = 1",      "HAS",       "H2",  "EMPTY", "EMPTY 1", "08",
        "0x",        "99999999999", "A ## B", "A # B",       "CAT(A, 1)",  "CAT(1, 2)", "'a'",
    };
    for (const char* e : expressions)
        expect_like_oracle(one_file(std::string(head) +
                                        "#define F(x) (x)\n#define EMPTY\n#define HAS defined(A)\n#define H2 defined A && "
                                        "1\n#define CAT(a, b) a##b\n#if " +
                                        e + "\nint yes;\n#endif\nint after;\n",
                                    {numbered("A", {0, 1})}),
                           e);
}

TEST(SplitOracle, Errors) {
    const char* const bodies[] = {
        "#error no\n",
        "#if A\n#error no\n#endif\n",
        "#foo\n",
        "# 12\n",
        "#\n",
        "#if 1\n",
        "#endif\n",
        "#else\n",
        "#elif 1\n",
        "#if 1\n#else\n#else\n#endif\n",
        "#if 1\n#else\n#elif 1\n#endif\n",
        "#if 0\n#else x\n#endif\n",
        "#if 0\n#endif x\n",
        "#ifdef\n#endif\n",
        "#ifdef A B\n#endif\n",
        "#ifdef 3\n#endif\n",
        "#define\n",
        "#define 3\n",
        "#define F(\n",
        "#define F(x\n",
        "#define F(x,) x\n",
        "#define F(x,x) x\n",
        "#define F(3) x\n",
        "#define GL_X 1\n",
        "#undef GL_ES\n",
        "#define defined 1\n",
        "#define __X__ 1\n",
        "#define __LINE__ 1\n",
        "#undef __FILE__\n",
        "#undef\n",
        "#undef A B\n",
        "#undef Z\n",
        "#define X 1\n#define X 2\n",
        "#define X 1\n#define X 1\n",
        "#define X (1)\n#define X ( 1)\n",
        "#define X 1 +  2\n#define X 1 + 2\n",
        "#define A 1\n",
        "#define F(x) x\n#define F(y) y\n",
        "#define F(x) x\n#define F x\n",
        "#define X+1\nint a = X;\n",
        "int a # b;\n",
        "int a;#define X\n",
        "#define F(x) x\nint a = F(\n#if 1\n1)\n#endif\n;\n",
        "#define F(x) x\nint a = F\n#define B\n;\n",
        "#define F(x) x\nint a = F(1\n",
        "#define F(x,y) x\nint a = F(1);\n",
        "#define F(x,y) x\nint a = F(1,2,3);\n",
        "#define F() 1\nint a = F(), b = F(1);\n",
        "#define F(x) x\nint a = F();\n",
        "#define F(x) x\nint a = F((1,2)), b = F;\n",
        "#define P(a) ## a\nint x = P(1);\n",
        "#define P(a) a ##\nint x = P(1);\n",
        "#define P(a,b) a ## b\nint x = P(1,2);\nint P(a,1u);\n",
        "#define P(a,b) a ## b\nint x = 1 P(+,=) 2;\nint P(<,<);\n",
        "#define P(a,b) a ## b\nint x = P(-,1);\n",
        "#define P(a,b) a ## b\nint x = P(,b) P(a,);\n",
        "int x = 1.0e;\n",
        "int x = 0x;\n",
        "int x = 09;\n",
        "#if 0\nint x = 09;\n#endif\n",
        "#if 0\ndon't\n#endif\n",
        "#if 0\n\"open\n#endif\n",
        "/* open\n",
        "int x = 1f;\n",
        "#if A\nint x = 1f;\n#endif\n",
        "#line\n",
        "#line 3 4 5\n",
        "#line 3 + 4\nint x = __LINE__;\n",
        "#line A\nint l = __LINE__;\n",
        "#include\n",
        "#include foo\n",
        "#include \"no\"\n",
        "#extension GL_EXT_multiview : enable\n",
        "#extension GL_EXT_multiview enable\n",
        "#extension\n",
        "#extension GL_EXT_multiview :\n",
        "#pragma optimize(off)\n",
        "#pragma\n",
        "#version 450\n",
        "int x;\n#version 450\n",
        "int x;\n#extension GL_EXT_multiview : enable\nint y;\n",
        "int x = 4294967296;\n",
        "int x = 1.5lf + 0x1fu + 017;\n",
        "int a\\\nb = 1; // c \\\n still comment\nint c;\n",
        "#def\\\nine Q 7\nint q = Q;\n",
        "/* x */ #define W 8\nint w = W;\n",
        "int q; /* \n */ #define W 8\n",
        "#define F(x) x\n#undef F\nint a = F(1);\n",
        "#define f(x) x f\nint a = f(1)(2);\n",
        "#define foo foo + 1\nint a = foo;\n",
        "#define a b\n#define b a\nint x = a b;\n",
        "#define E\n#define C(x,y) x##y\nint z = C(E,q) C(q,E);\n",
        "#define X(a,b) a b\nint z = X(X(1,2),X(3,4));\n",
        "#define L (\n#define F(x) x\nint z = F L 1);\n",
        "#define CALL(f) f(1)\n#define G(x) x*2\nint z = CALL(G);\n",
        "#if 1 //\n#else // x\n#endif /* y */\n",
        "int x=1;;;{}[](),.;\n",
        "a+++b---c<<=d>>=e&&=f^^g||h!=i\n",
        "#if A\n#if 0\n#else\nint n;\n#endif\n#elif 1\nint k;\n#else\nint o;\n#endif\n",
        "x.y .5 5. 1.e3 1e+5f 0.0 00 0xABCDEFu\n",
        "#define D(x) defined(x)\n#if D(A)\n#endif\n",
    };
    for (const char* body : bodies) expect_like_oracle(one_file(std::string(head) + body, {flag("A")}), body);
}

}  // namespace
