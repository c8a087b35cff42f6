// Randomly generated shaders: every variant against glslang's preprocessor. KILN_SEED and KILN_ROUNDS change what is drawn.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "fixture.h"

namespace {

class Generator {
public:
    explicit Generator(uint64_t seed) : random_(seed) {}

    TestShader shader() {
        TestShader out;
        const size_t axes = 1 + pick(4);
        for (size_t a = 0; a < axes; ++a) {
            const std::string macro(1, static_cast<char>('A' + a));
            switch (pick(4)) {
                case 0:
                    out.axes.push_back(flag(macro));
                    break;
                case 1:
                    out.axes.push_back(defined(macro));
                    break;
                case 2:
                    out.axes.push_back(numbered(macro, {0, 1, 2}));
                    break;
                default:
                    out.axes.push_back(numbered(macro, {0, 2, 7, 11}));
                    break;
            }
            names_.push_back(macro);
        }
        if (axes > 1 && pick(3) == 0) out.forbid = "a == 1 && b == 0";
        if (pick(3) == 0) out.defines.push_back({"FIXED", std::to_string(pick(3))}), names_.push_back("FIXED");
        out.undefined_is_zero = true;
        for (const char* const m : {"M0", "M1", "M2", "M3", "M4"}) macros_.push_back(m);
        out.files["inc.glsl"] =
            (pick(2) != 0 ? "#ifndef INC\n#define INC\n" : "#if 1\n") + block(2) + "#endif" + (pick(2) != 0 ? "\n" : "");
        out.files["main"] = std::string("#version 450\n") + helpers + block(3) + block(3) + block(3);
        return out;
    }

private:
    static constexpr const char* helpers =
        "#define F(x) x\n#define CAT(a, b) a##b\n#define XCAT(a, b) CAT(a, b)\n#define SELF SELF + 1\n";
    size_t pick(size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random_); }
    const std::string& name() { return pick(3) != 0 ? names_[pick(names_.size())] : macros_[pick(macros_.size())]; }

    std::string operand(size_t depth) {
        switch (pick(depth == 0 ? 3 : 7)) {
            case 0:
                return std::to_string(pick(4));
            case 1:
            case 2:
                return name();
            case 3:
                return "(" + expression(depth - 1) + ")";
            case 4:
                return (pick(2) != 0 ? "defined(" + name() + ")" : "defined " + name());
            case 5:
                return std::string(1, "!-~+"[pick(4)]) + operand(depth - 1);
            default:
                return "F(" + expression(depth - 1) + ")";
        }
    }
    std::string expression(size_t depth) {
        static const char* const ops[] = {"&&", "||", "==", "!=", "<",  ">=", "+",  "-",
                                          "*",  "&",  "|",  "^",  "<<", ">>", "&&", "||"};
        std::string out = operand(depth);
        for (size_t n = pick(3); n > 0; --n) out += std::string(" ") + ops[pick(std::size(ops))] + " " + operand(depth);
        return out;
    }

    std::string body() {
        switch (pick(8)) {
            case 0:
                return "";
            case 1:
                return std::to_string(pick(5));
            case 2:
                return "(" + expression(1) + ")";
            case 3:
                return name();
            case 4:
                return "-" + std::to_string(pick(3));
            case 5:
                return name() + " + 1";
            case 6:
                return "F(" + name() + ")";
            default:
                return "(1 + " + name() + ")";
        }
    }

    std::string text() {
        static const char* const words[] = {"int", "x", ";", "=", "1.5", "+",     "(",  ")",
                                            "foo", "{", "}", ",", "v1",  "0x1Fu", "<=", "*"};
        std::string out;
        for (size_t n = 1 + pick(5); n > 0; --n) {
            switch (pick(9)) {
                case 0:
                    out += name();
                    break;
                case 1:
                    out += "F(" + name() + " + " + words[pick(5)] + ")";
                    break;
                case 2:
                    out += "CAT(v, " + name() + ")";
                    break;
                case 3:
                    out += pick(2) != 0 ? "XCAT(v, F(" + names_[pick(names_.size())] + "))" : "CAT(v, 1)";
                    break;
                case 4:
                    out += pick(6) == 0 ? "__LINE__" : "SELF";
                    break;
                case 5:
                    out += macros_[pick(macros_.size())] + (pick(2) != 0 ? "(2)" : "\n(3)");
                    break;
                default:
                    out += words[pick(std::size(words))];
            }
            out += pick(6) == 0 ? " /* c\n */ " : pick(8) == 0 ? " \\\n" : " ";
        }
        return out + (pick(6) == 0 ? "// note\n" : "\n");
    }

    std::string define() {
        const std::string& m = macros_[pick(macros_.size())];
        if (pick(5) == 0) return "#undef " + m + "\n";
        const std::string parameters = pick(12) == 0 ? "(q)" : "";
        const std::string line = "#define " + m + parameters + " " + (parameters.empty() ? "" : "q + ") + body() + "\n";
        return pick(3) != 0 ? "#undef " + m + "\n" + line : "#ifndef " + m + "\n" + line + "#endif\n";
    }

    std::string condition() {
        switch (pick(4)) {
            case 0:
                return "ifdef " + name();
            case 1:
                return "ifndef " + name();
            default:
                return "if " + expression(2);
        }
    }

    std::string block(size_t depth) {
        std::string out;
        for (size_t n = 1 + pick(3); n > 0; --n) {
            switch (pick(depth == 0 ? 4 : 8)) {
                case 0:
                case 1:
                    out += text();
                    break;
                case 2:
                    out += define();
                    break;
                case 3:
                    switch (pick(7)) {
                        case 0:
                            out += "#include \"inc.glsl\"\n";
                            break;
                        case 1:
                            out += "#line " + std::to_string(pick(90) + 1) + "\n";
                            break;
                        case 2:
                            out += "#pragma optimize(off)\n";
                            break;
                        case 3:
                            out += "#extension GL_EXT_multiview : enable\n";
                            break;
                        case 4:
                            out += "# \n";
                            break;
                        case 5:
                            out += pick(8) == 0 ? "#error stop\n" : "";
                            break;
                        default:
                            out += helpers;
                            break;
                    }
                    break;
                default:
                    out += "#" + condition() + "\n" + block(depth - 1);
                    for (size_t e = pick(3); e > 0; --e) out += "#elif " + expression(1) + "\n" + block(depth - 1);
                    if (pick(2) != 0) out += "#else\n" + block(depth - 1);
                    out += "#endif\n";
            }
        }
        return out;
    }

    std::mt19937_64 random_;
    std::vector<std::string> names_, macros_;
};

uint64_t number_from(const char* variable, uint64_t otherwise) {
    const char* const text = std::getenv(variable);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

TEST(SplitRandom, LikeGlslang) {
    const uint64_t seed = number_from("KILN_SEED", 20221122), rounds = number_from("KILN_ROUNDS", 1000);
    std::printf("seed %llu, %llu shaders\n", static_cast<unsigned long long>(seed), static_cast<unsigned long long>(rounds));
    size_t good = 0;
    for (uint64_t round = 0; round < rounds; ++round) {
        Generator generator(seed * 1'000'003 + round);
        const TestShader shader = generator.shader();
        if (expect_like_oracle(shader, "KILN_SEED=" + std::to_string(seed) + " round " + std::to_string(round) + "\n")) ++good;
        if (HasFailure()) break;
    }
    std::printf("%zu of them are correct in every variant\n", good);
    EXPECT_GT(good, rounds / 10);
}

}  // namespace
