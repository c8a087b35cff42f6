#include "compiler/manifest/expr.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <random>

namespace kiln {
namespace {

Axis make_axis(const std::string& name, AxisKind kind, std::vector<AxisValue> values) {
    Axis a;
    a.name = name;
    a.macro = name;
    a.kind = kind;
    a.values = std::move(values);
    return a;
}

const std::vector<Axis>& axes() {
    static const std::vector<Axis> all{
        make_axis("light", AxisKind::named, {{"none", 0}, {"directional", 1}, {"point", 2}, {"spot", 3}}),
        make_axis("cascades", AxisKind::integer, {{"1", 1}, {"2", 2}, {"4", 4}}),
        make_axis("lightmap", AxisKind::named, {{"none", 0}, {"flat", 1}, {"light", 4}, {"in", -5}, {"not", 6}}),
        make_axis("two_sided", AxisKind::boolean, {{"false", 0}, {"true", 1}}),
        make_axis("skinned", AxisKind::defined, {{"false", 0}, {"true", 1}}),
    };
    return all;
}

// Every node once, in the order of the nodes: "or(and(a0,a1),a2)" with a<axis> and integers.
std::string shape(const Expr& e) {
    static const char* const names[] = {"", "", "not", "and", "or", "implies", "eq", "ne", "lt", "le", "gt", "ge", "in"};
    std::vector<std::string> text;
    for (const ExprNode& n : e.nodes) {
        std::string out = n.op == Op::literal ? std::to_string(n.number) : n.op == Op::axis ? "a" + std::to_string(n.axis) : "";
        if (out.empty()) {
            out = names[static_cast<size_t>(n.op)];
            for (size_t i = 0; i < n.args.size(); ++i) out += (i == 0 ? "(" : ",") + text.at(n.args[i]);
            out += ")";
        }
        text.push_back(out);
    }
    return text.back();
}

std::string parsed(std::string_view text) {
    const auto result = parse_expr(text, axes());
    if (const auto* error = std::get_if<ExprError>(&result)) return std::to_string(error->offset) + ": " + error->message;
    return shape(std::get<Expr>(result));
}

TEST(Expr, PrecedenceAndNames) {
    const std::pair<const char*, const char*> table[] = {
        {"light", "a0"},
        {"1", "1"},
        {"-3", "-3"},
        {"0x10", "16"},
        {"0X7fffffff", "2147483647"},
        {"-2147483648", "-2147483648"},
        {"(((light)))", "a0"},
        {"!light", "not(a0)"},
        {"not light", "not(a0)"},
        {"!!not light", "not(not(not(a0)))"},
        {"!light == none", "not(eq(a0,0))"},
        {"(!light) == 0", "eq(not(a0),0)"},
        {"not light in {none, 3}", "not(in(a0,0,3))"},
        {"light && cascades || skinned", "or(and(a0,a1),a4)"},
        {"light || cascades && skinned", "or(a0,and(a1,a4))"},
        {"light && cascades && skinned", "and(and(a0,a1),a4)"},
        {"light || cascades || skinned", "or(or(a0,a1),a4)"},
        {"light -> cascades -> skinned", "implies(a0,implies(a1,a4))"},
        {"(light -> cascades) -> skinned", "implies(implies(a0,a1),a4)"},
        {"light || two_sided -> cascades && skinned", "implies(or(a0,a3),and(a1,a4))"},
        {"!light && cascades", "and(not(a0),a1)"},
        {"!(light && cascades)", "not(and(a0,a1))"},
        {"light != none -> cascades <= 4", "implies(ne(a0,0),le(a1,4))"},
        {"light == spot", "eq(a0,3)"},
        {"spot == light", "eq(3,a0)"},
        {"3 < light", "lt(3,a0)"},
        {"light > point && light >= point && light < point && light <= point",
         "and(and(and(gt(a0,2),ge(a0,2)),lt(a0,2)),le(a0,2))"},
        {"two_sided == true", "eq(a3,1)"},
        {"skinned != false", "ne(a4,0)"},
        {"cascades == 0x4", "eq(a1,4)"},
        {"light == cascades", "eq(a0,a1)"},
        // A name beside a comparison is first a value of the other side's axis.
        {"lightmap == light", "eq(a2,4)"},
        {"light == lightmap", "eq(4,a2)"},
        {"(light) == lightmap", "eq(a0,a2)"},
        {"lightmap == (light)", "eq(a2,a0)"},
        {"light == light", "eq(a0,a0)"},
        // The words of the grammar are value names where only a value can stand.
        {"lightmap == in", "eq(a2,-5)"},
        {"lightmap == not && light", "and(eq(a2,6),a0)"},
        {"lightmap in {in, not}", "in(a2,-5,6)"},
        {"lightmap in {in} && light in {spot}", "and(in(a2,-5),in(a0,3))"},
        {"(light == spot) == two_sided", "eq(eq(a0,3),a3)"},
        {"(light in {spot}) in {0, 1}", "in(in(a0,3),0,1)"},
        {"1 < 2", "lt(1,2)"},
        {" \t\r\nlight\n==\r\nspot ", "eq(a0,3)"},
        {"light==spot&&!two_sided->cascades!=2", "implies(and(eq(a0,3),not(a3)),ne(a1,2))"},
        {"cascades>-1", "gt(a1,-1)"},
    };
    for (const auto& [text, expected] : table) EXPECT_EQ(parsed(text), expected) << text;
}

TEST(Expr, Mistakes) {
    const std::pair<const char*, const char*> table[] = {
        {"", "0: the expression is empty"},
        {"  \n", "0: the expression is empty"},
        {"ligth", "0: unknown axis 'ligth' (did you mean 'light'?)"},
        {"light == pont", "9: 'pont' is not a value of axis 'light' (did you mean 'point'?)"},
        {"pont == light", "0: 'pont' is not a value of axis 'light' (did you mean 'point'?)"},
        {"light in {none, sopt}", "16: 'sopt' is not a value of axis 'light' (did you mean 'spot'?)"},
        {"zzz == 3", "0: unknown axis 'zzz' (known: light, cascades, lightmap, two_sided, skinned)"},
        {"zzz == yyy", "0: unknown axis 'zzz' (known: light, cascades, lightmap, two_sided, skinned)"},
        {"light == spot == 3", "14: comparisons do not chain: join two of them with '&&'"},
        {"light < 2 < 3", "10: comparisons do not chain: join two of them with '&&'"},
        {"light in {1} == 1", "13: comparisons do not chain: join two of them with '&&'"},
        {"light == 1 in {1}", "11: comparisons do not chain: join two of them with '&&'"},
        {"light in {1} in {1}", "13: comparisons do not chain: join two of them with '&&'"},
        {"light == !two_sided", "9: '!' binds looser than a comparison: put parentheses around what it negates"},
        {"light = 3", "6: '=': write '==' to compare"},
        {"light & two_sided", "6: '&': write '&&'"},
        {"light | two_sided", "6: '|': write '||'"},
        {"light => two_sided", "6: '=>': write '->' for implication or '>=' for a comparison"},
        {"light =< 3", "6: '=<': write '<='"},
        {"light <> 3", "6: '<>': write '!='"},
        {"light and two_sided", "6: expected an operator before 'and' (write '&&')"},
        {"light or two_sided", "6: expected an operator before 'or' (write '||')"},
        {"light not in {1}", "6: expected an operator before 'not' (write !(axis in {...}) for 'not in')"},
        {"light ! two_sided", "6: expected an operator before '!' (write '!=' to compare)"},
        {"light two_sided", "6: expected an operator before 'two_sided'"},
        {"light 3", "6: expected an operator before '3'"},
        {"light -3", "6: expected an operator before '-3'"},
        {"light &&", "8: the expression ends where an axis, a value or an integer is expected"},
        {"&& light", "0: expected an axis, a value, an integer or '(' before '&&'"},
        {"light && \n ", "8: the expression ends where an axis, a value or an integer is expected"},
        {"light && )", "9: expected an axis, a value, an integer or '(' before ')'"},
        {"()", "1: expected an axis, a value, an integer or '(' before ')'"},
        {"(light", "0: this '(' is not closed"},
        {"light)", "5: this ')' was never opened"},
        {"light in", "8: expected '{' after 'in'"},
        {"light in {", "9: this '{' is not closed"},
        {"light in {1", "9: this '{' is not closed"},
        {"light in {1,", "9: this '{' is not closed"},
        {"light in {}", "10: 'in {}' holds never: name at least one value"},
        {"light in {1,}", "12: expected a value after ','"},
        {"light in {,1}", "10: expected a value or an integer"},
        {"light in {1 2}", "12: expected ',' or '}'"},
        {"light in {(1)}", "10: expected a value or an integer"},
        {"(light == 1) in {spot}", "17: 'spot': only an axis has named values"},
        {"3 in {spot}", "6: 'spot': only an axis has named values"},
        {"ligth in {1}", "0: unknown axis 'ligth' (did you mean 'light'?)"},
        {"light == 2147483648", "9: '2147483648': out of range: -2147483648 to 2147483647"},
        {"light == 0x80000000", "9: '0x80000000': out of range: -2147483648 to 2147483647"},
        {"light == -2147483649", "9: '-2147483649': out of range: -2147483648 to 2147483647"},
        {"light == 99999999999999999999999", "9: '99999999999999999999999': out of range: -2147483648 to 2147483647"},
        {"light == 0x", "9: '0x': not an integer (decimal or 0x)"},
        {"light == 3x", "9: '3x': not an integer (decimal or 0x)"},
        {"light == 1.5", "9: '1.5': not an integer (decimal or 0x)"},
        {"light == 010", "9: '010': leading zeros mean octal elsewhere: write it without"},
        {"light == \"spot\"", "9: '\"': this character means nothing in an expression"},
        {"light + 1", "6: '+': this character means nothing in an expression"},
        {"true", "0: unknown axis 'true' (known: light, cascades, lightmap, two_sided, skinned)"},
        {"(none) == light", "1: unknown axis 'none' (known: light, cascades, lightmap, two_sided, skinned)"},
    };
    for (const auto& [text, expected] : table) EXPECT_EQ(parsed(text), expected) << text;
}

TEST(Expr, Limits) {
    const auto nested = [](size_t n) { return std::string(n, '(') + "light" + std::string(n, ')'); };
    EXPECT_EQ(parsed(nested(expr_level_limit)), "a0");
    EXPECT_EQ(parsed(nested(expr_level_limit + 1)), "1000: nested deeper than 1000 levels");
    EXPECT_EQ(parsed(std::string(expr_level_limit + 1, '!') + "light"), "1000: nested deeper than 1000 levels");
    // Levels that are closed do not count.
    std::string wide = "!light";
    while (wide.size() + 20 < expr_size_limit) wide += " && !(light)";
    EXPECT_TRUE(std::holds_alternative<Expr>(parse_expr(wide, axes())));
    std::string chain = "light";
    while (chain.size() + 20 < expr_size_limit) chain += "->light";
    const auto deep = parse_expr(chain, axes());
    ASSERT_TRUE(std::holds_alternative<Expr>(deep));
    EXPECT_TRUE(evaluate(std::get<Expr>(deep), {1, 1, 0, 0, 0}));
    EXPECT_TRUE(std::holds_alternative<Expr>(parse_expr(std::string(expr_size_limit - 5, ' ') + "light", axes())));
    EXPECT_EQ(parsed(std::string(expr_size_limit - 4, ' ') + "light"), "0: an expression may have at most 65536 bytes");
}

TEST(Expr, NamesPastTheIndexThreshold) {
    std::vector<Axis> many;
    for (int i = 0; i < 300; ++i) {
        many.push_back(make_axis("axis" + std::to_string(i), AxisKind::named, {}));
        for (int j = 0; j < 100; ++j) many.back().values.push_back({"v" + std::to_string(j), j * 7});
    }
    std::string text = "0";
    for (int i = 0; i < 300; ++i) text += " || axis" + std::to_string(i) + " == v" + std::to_string(i % 100);
    const auto result = parse_expr(text, many);
    ASSERT_TRUE(std::holds_alternative<Expr>(result));
    const Expr& e = std::get<Expr>(result);
    EXPECT_EQ(e.axes.size(), 300u);
    for (int i = 0; i < 300; ++i) {
        std::vector<int32_t> numbers(300, -1);
        EXPECT_FALSE(evaluate(e, numbers));
        numbers[static_cast<size_t>(i)] = (i % 100) * 7;
        EXPECT_TRUE(evaluate(e, numbers));
    }
}

// The oracle: a tree is made at random, written down with as few parentheses as the grammar of ARCHITECTURE.md, Manifests and
// scenes needs (sometimes more), and evaluated by walking it. The parser sees only the text.
struct Tree {
    enum Kind { axis, integer, implies, either, both, negate, compare, member } kind = axis;
    int number = 0;  // axis, integer, or which comparison
    std::vector<std::unique_ptr<Tree>> args;
    std::vector<int> list;
};

int tightness(const Tree& t) {
    switch (t.kind) {
        case Tree::implies:
            return 1;
        case Tree::either:
            return 2;
        case Tree::both:
            return 3;
        case Tree::negate:
            return 4;
        case Tree::compare:
        case Tree::member:
            return 5;
        default:
            return 6;
    }
}

class Writer {
public:
    explicit Writer(std::mt19937& random) : random_(random) {}
    int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

    std::unique_ptr<Tree> make(int depth) {
        auto t = std::make_unique<Tree>();
        const int choice = depth == 0 ? below(2) : below(10);
        t->kind = choice == 0 ? Tree::axis : choice == 1 ? Tree::integer : static_cast<Tree::Kind>(2 + below(6));
        t->number = t->kind == Tree::axis ? below(3) : t->kind == Tree::integer ? below(5) - 1 : below(6);
        const int children = t->kind <= Tree::integer ? 0 : t->kind == Tree::negate || t->kind == Tree::member ? 1 : 2;
        for (int i = 0; i < children; ++i) t->args.push_back(make(depth - 1));
        if (t->kind == Tree::member)
            for (int i = 0; i <= below(3); ++i) t->list.push_back(below(5) - 1);
        return t;
    }

    std::string write(const Tree& t, int at_least) {
        const bool parens = tightness(t) < at_least || below(8) == 0;
        const std::string text = bare(t);
        return parens ? "(" + space() + text + space() + ")" : text;
    }

private:
    std::string space() { return std::string(static_cast<size_t>(below(2)), ' '); }
    std::string bare(const Tree& t) {
        static const char* const comparisons[] = {"==", "!=", "<", "<=", ">", ">="};
        const auto arg = [&](size_t i, int at_least) { return write(*t.args[i], at_least); };
        switch (t.kind) {
            case Tree::axis:
                return std::string(1, static_cast<char>('a' + t.number));
            case Tree::integer:
                return below(4) == 0 && t.number >= 0 ? "0x" + std::to_string(t.number) : std::to_string(t.number);
            case Tree::implies:
                return arg(0, 2) + " -> " + arg(1, 1);
            case Tree::either:
                return arg(0, 2) + space() + "||" + space() + arg(1, 3);
            case Tree::both:
                return arg(0, 3) + space() + "&&" + space() + arg(1, 4);
            case Tree::negate:
                return (below(2) == 0 ? "!" + space() : "not ") + arg(0, 4);
            case Tree::compare:
                return arg(0, 6) + " " + comparisons[t.number] + " " + arg(1, 6);
            case Tree::member:
                break;
        }
        std::string list;
        for (const int v : t.list) list += (list.empty() ? "" : ", ") + std::to_string(v);
        return arg(0, 6) + " in {" + list + "}";
    }

    std::mt19937& random_;
};

int walk(const Tree& t, const std::vector<int32_t>& numbers) {
    const auto arg = [&](size_t i) { return walk(*t.args[i], numbers); };
    switch (t.kind) {
        case Tree::axis:
            return numbers[static_cast<size_t>(t.number)];
        case Tree::integer:
            return t.number;
        case Tree::implies:
            return arg(0) ? arg(1) != 0 : 1;
        case Tree::either:
            return arg(0) ? 1 : arg(1) != 0;
        case Tree::both:
            return arg(0) ? arg(1) != 0 : 0;
        case Tree::negate:
            return !arg(0);
        case Tree::compare: {
            const int a = arg(0), b = arg(1);
            const bool results[] = {a == b, a != b, a<b, a <= b, a> b, a >= b};
            return results[t.number];
        }
        case Tree::member:
            break;
    }
    for (const int v : t.list)
        if (v == arg(0)) return 1;
    return 0;
}

TEST(Expr, AgreesWithTheOracleOnRandomTrees) {
    std::mt19937 random(20260131);  // the seed
    const std::vector<Axis> three{make_axis("a", AxisKind::integer, {{"0", 0}, {"1", 1}, {"2", 2}}),
                                  make_axis("b", AxisKind::integer, {{"-1", -1}, {"0", 0}, {"3", 3}}),
                                  make_axis("c", AxisKind::boolean, {{"false", 0}, {"true", 1}})};
    Writer writer(random);
    for (int round = 0; round < 20000; ++round) {
        const auto tree = writer.make(1 + round % 6);
        const std::string text = writer.write(*tree, 0);
        const auto result = parse_expr(text, three);
        if (const auto* error = std::get_if<ExprError>(&result)) {
            FAIL() << text << "\n" << std::string(error->offset, ' ') << "^ " << error->message;
        }
        for (const AxisValue& a : three[0].values)
            for (const AxisValue& b : three[1].values)
                for (const AxisValue& c : three[2].values) {
                    const std::vector<int32_t> numbers{a.number, b.number, c.number};
                    ASSERT_EQ(evaluate(std::get<Expr>(result), numbers), walk(*tree, numbers) != 0) << text;
                }
    }
}

}  // namespace
}  // namespace kiln
