// The diagram against brute force: every answer about thousands of random small spaces equals the one found by asking
// evaluate() about every combination.

#include "compiler/space/space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/unit/space/random_space.h"

namespace kiln {
namespace {

using namespace test;

std::vector<Digits> members(Space& space, Set s) {
    std::vector<Digits> found;
    space.diagram->enumerate(s, [&](const Digits& d) {
        found.push_back(d);
        return true;
    });
    return found;
}

TEST(Space, RandomSpacesAgreeWithBruteForce) {
    for (uint32_t seed = 1; seed <= 3000; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        Case c = random_case(random);
        const std::vector<Digits> legal = legal_combinations(c);
        const auto space = c.build();
        ASSERT_TRUE(space);
        Diagram& d = *space->diagram;
        ASSERT_EQ(d.count(space->legal), Count(legal.size()));
        ASSERT_EQ(space->declared(), Count(combinations(space->axes).size()));
        ASSERT_EQ(members(*space, space->legal), legal);
        for (uint32_t axis = 0; axis < space->axes.size(); ++axis) {
            const std::vector<Count> by_digit = d.count_by_digit(space->legal, axis);
            for (uint32_t v = 0; v < by_digit.size(); ++v)
                ASSERT_EQ(by_digit[v], Count(static_cast<uint64_t>(std::count_if(
                                           legal.begin(), legal.end(), [&](const Digits& m) { return m[axis] == v; }))));
        }
        if (legal.empty()) {
            ASSERT_EQ(space->legal, Diagram::none());
            ASSERT_FALSE(d.witness(space->legal));
            ASSERT_FALSE(d.unrank(space->legal, Count(0)));
            continue;
        }
        ASSERT_EQ(d.witness(space->legal), legal[0]);
        for (int i = 0; i < 4; ++i) {
            const uint32_t rank = below(random, static_cast<uint32_t>(legal.size()));
            ASSERT_EQ(d.rank(space->legal, legal[rank]), Count(rank));
            ASSERT_EQ(d.unrank(space->legal, Count(rank)), legal[rank]);
        }
        ASSERT_FALSE(d.unrank(space->legal, Count(legal.size())));
        for (const Digits& m : legal) ASSERT_TRUE(d.contains(space->legal, m));
    }
}

TEST(Space, SetOperationsAgreeWithBruteForce) {
    for (uint32_t seed = 1; seed <= 1500; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed * 7919);
        Case c = random_case(random, 5, 4);
        const auto space = c.build();
        ASSERT_TRUE(space);
        Diagram& d = *space->diagram;
        const std::vector<Digits> all = combinations(space->axes);
        const Expr ea = must_parse(random_expr(random, space->axes, 3), space->axes);
        const Expr eb = must_parse(random_expr(random, space->axes, 3), space->axes);
        const Set a = compile_expr(*space, ea), b = compile_expr(*space, eb);
        std::set<Digits> in_a, in_b;
        for (const Digits& m : all) {
            if (holds(ea, space->axes, m)) in_a.insert(m);
            if (holds(eb, space->axes, m)) in_b.insert(m);
        }
        const Set both = d.both(a, b), either = d.either(a, b), minus = d.minus(a, b), choose = d.choose(a, b, d.complement(b));
        std::vector<bool> keep;
        for (size_t i = 0; i < space->axes.size(); ++i) keep.push_back(below(random, 2) == 0);
        const Set projected = d.project(a, keep);
        const uint32_t axis = below(random, static_cast<uint32_t>(space->axes.size()));
        const uint32_t digit = below(random, static_cast<uint32_t>(space->axes[axis].values.size()));
        const Set fixed = d.cofactor(a, axis, digit);
        const Set simple = b == Diagram::none() ? a : d.simplify(a, b);
        std::set<Digits> shadow;
        const auto masked = [&](Digits m) {
            for (size_t i = 0; i < m.size(); ++i)
                if (!keep[i]) m[i] = 0;
            return m;
        };
        for (const Digits& m : in_a) shadow.insert(masked(m));
        bool subset = true, disjoint = true;
        for (const Digits& m : all) {
            const bool x = in_a.count(m) != 0, y = in_b.count(m) != 0;
            ASSERT_EQ(d.contains(a, m), x);
            ASSERT_EQ(d.contains(both, m), x && y);
            ASSERT_EQ(d.contains(either, m), x || y);
            ASSERT_EQ(d.contains(minus, m), x && !y);
            ASSERT_EQ(d.contains(choose, m), x == y);
            ASSERT_EQ(d.contains(projected, m), shadow.count(masked(m)) != 0);
            Digits moved = m;
            moved[axis] = digit;
            ASSERT_EQ(d.contains(fixed, m), in_a.count(moved) != 0);
            if (y) {
                ASSERT_EQ(d.contains(simple, m), x);
            }
            subset = subset && (!x || y);
            disjoint = disjoint && !(x && y);
        }
        ASSERT_EQ(d.subset(a, b), subset);
        ASSERT_EQ(d.disjoint(a, b), disjoint);
        // Equal sets are the same node, however they were made.
        Set points = Diagram::none();
        for (const Digits& m : in_a) points = d.either(points, d.point(m));
        ASSERT_EQ(points, a);
        // ... and the same set in another order.
        std::vector<uint32_t> order = d.order();
        std::shuffle(order.begin(), order.end(), random);
        Diagram other(d.radices(), order);
        const Set copy = other.import(d, a);
        for (const Digits& m : all) ASSERT_EQ(other.contains(copy, m), in_a.count(m) != 0);
        ASSERT_EQ(d.import(other, copy), a);
    }
}

TEST(Space, NoAxes) {
    Case c({});
    const auto space = c.build();
    ASSERT_TRUE(space);
    EXPECT_EQ(space->declared(), Count(1));
    EXPECT_EQ(space->diagram->count(space->legal), Count(1));
    EXPECT_EQ(space->diagram->witness(space->legal), Digits());
    EXPECT_EQ(space->diagram->unrank(space->legal, Count(0)), Digits());
    EXPECT_EQ(space->diagram->rank(space->legal, {}), Count(0));
    EXPECT_EQ(members(*space, space->legal), std::vector<Digits>{Digits()});
    EXPECT_EQ(space->describe_variant({}), "");
}

TEST(Space, ChainOfSixtyFlags) {
    std::vector<Axis> axes;
    for (int i = 0; i < 60; ++i) axes.push_back(boolean_axis("f" + std::to_string(i)));
    Case c(axes);
    for (int i = 0; i + 1 < 60; ++i) c.rule(true, "f" + std::to_string(i) + " && f" + std::to_string(i + 1));
    const auto space = c.build();
    ASSERT_TRUE(space);
    EXPECT_EQ(space->diagram->count(space->legal).decimal(), "4052739537881");  // Fibonacci number 62
    EXPECT_EQ(space->declared().decimal(), "1152921504606846976");
}

TEST(Space, PairedAxesDeclaredApart) {
    std::vector<Axis> axes;
    for (const char* side : {"a", "b"})
        for (int i = 0; i < 32; ++i) axes.push_back(boolean_axis(side + std::to_string(i)));
    Case c(axes);
    for (int i = 0; i < 32; ++i) c.rule(false, "a" + std::to_string(i) + " == b" + std::to_string(i));
    const auto space = c.build();
    ASSERT_TRUE(space);
    EXPECT_EQ(space->diagram->count(space->legal).decimal(), "4294967296");
    EXPECT_LT(space->diagram->nodes(), 200u);
    const Count last(4294967295u);
    const auto digits = space->diagram->unrank(space->legal, last);
    ASSERT_TRUE(digits);
    EXPECT_EQ(*digits, Digits(64, 1));
    EXPECT_EQ(space->diagram->rank(space->legal, *digits), last);
}

TEST(Space, PairsInOneRule) {
    // The same pairs as one long conjunction inside an implication: the order comes from the parts of the expression.
    std::vector<Axis> axes{boolean_axis("on")};
    for (const char* side : {"a", "b"})
        for (int i = 0; i < 24; ++i) axes.push_back(boolean_axis(side + std::to_string(i)));
    Case c(axes);
    std::string all;
    for (int i = 0; i < 24; ++i) all += (i == 0 ? "" : " && ") + ("a" + std::to_string(i)) + " == b" + std::to_string(i);
    c.rule(false, "on -> (" + all + ")");
    const auto space = c.build();
    ASSERT_TRUE(space);
    EXPECT_EQ(space->diagram->count(space->legal), Count((uint64_t{1} << 48) + (uint64_t{1} << 24)));
}

}  // namespace
}  // namespace kiln
