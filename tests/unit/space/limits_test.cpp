// Large spaces with known counts, the limits of a manifest, and what happens past the node limit.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "compiler/base/diag.h"
#include "compiler/space/describe.h"
#include "tests/unit/space/random_space.h"

namespace kiln {
namespace {

using namespace test;

std::vector<int32_t> up_to(int32_t n) {
    std::vector<int32_t> numbers;
    for (int32_t i = 0; i < n; ++i) numbers.push_back(i);
    return numbers;
}
std::string flag(size_t i) { return "f" + std::to_string(i); }

Case chain(size_t flags) {
    std::vector<Axis> axes;
    for (size_t i = 0; i < flags; ++i) axes.push_back(boolean_axis(flag(i)));
    Case c(axes);
    for (size_t i = 0; i + 1 < flags; ++i) c.rule(true, flag(i) + " && " + flag(i + 1));
    return c;
}

Count fibonacci(size_t n) {
    Count a(0), b(1);
    for (size_t i = 0; i < n; ++i) {
        const Count next = a + b;
        a = b;
        b = next;
    }
    return a;
}

TEST(Limits, ThousandAxes) {
    Case c = chain(1024);
    const auto space = c.build();
    ASSERT_TRUE(space);
    Diagram& d = *space->diagram;
    EXPECT_EQ(d.count(space->legal), fibonacci(1026));
    const auto by_digit = d.count_by_digit(space->legal, 500);
    EXPECT_EQ(by_digit[0] + by_digit[1], fibonacci(1026));
    EXPECT_EQ(by_digit[1], fibonacci(501) * fibonacci(524));  // 500 is set, so 499 and 501 are not
    EXPECT_LT(d.nodes(), 5'000u);
    Count rank = fibonacci(1025) + Count(12345);
    const auto member = d.unrank(space->legal, rank);
    ASSERT_TRUE(member);
    EXPECT_EQ((*member)[0], 1u);
    EXPECT_EQ(d.rank(space->legal, *member), rank);
    std::vector<std::unique_ptr<Space>> spaces;
    spaces.push_back(c.build());
    Diags diags;
    lint(c.manifest, spaces, diags);
    EXPECT_TRUE(diags.empty()) << render(diags.list()[0], false);
}

TEST(Limits, MillionValues) {
    std::vector<Axis> axes;
    for (size_t i = 0; i < 256; ++i) axes.push_back(make_axis(flag(i), AxisKind::integer, up_to(4096)));
    Case c(axes);
    for (size_t i = 0; i + 1 < 256; i += 2) c.rule(false, flag(i) + " < " + flag(i + 1));
    const auto space = c.build();
    ASSERT_TRUE(space);
    Count expected(1);
    for (int i = 0; i < 128; ++i) expected *= Count(4096 * 4095 / 2);
    EXPECT_EQ(space->diagram->count(space->legal), expected);
    const auto by_digit = space->diagram->count_by_digit(space->legal, 1);
    EXPECT_TRUE(by_digit[0].is_zero());
    EXPECT_EQ(by_digit[4095] * Count(4096 / 2), expected);
}

TEST(Limits, ComparedAxesStaySmall) {
    const struct {
        const char* rule;
        uint64_t count;
    } cases[] = {{"a == b", 4096u},
                 {"a != b", 4096u * 4095u},
                 {"a < b", 4096u * 4095u / 2},
                 {"a <= b", 4096u * 4097u / 2},
                 {"a > b", 4096u * 4095u / 2},
                 {"a >= b", 4096u * 4097u / 2}};
    for (const auto& t : cases) {
        for (const bool shuffled : {false, true}) {
            std::vector<int32_t> numbers = up_to(4096);
            Random random(7);
            if (shuffled) std::shuffle(numbers.begin(), numbers.end(), random);
            Case c({make_axis("a", AxisKind::named, numbers), make_axis("b", AxisKind::named, up_to(4096))});
            c.rule(false, t.rule);
            const auto space = c.build();
            ASSERT_TRUE(space) << t.rule;
            EXPECT_EQ(space->diagram->count(space->legal), Count(t.count)) << t.rule;
            EXPECT_LT(space->diagram->nodes(), 5'000u) << t.rule;
        }
    }
}

TEST(Limits, LongExpression) {
    std::vector<Axis> axes;
    for (size_t i = 0; i < 40; ++i) axes.push_back(make_axis(flag(i), AxisKind::integer, up_to(8)));
    Case c(axes);
    std::string text;
    for (size_t i = 0; i < 4000; ++i) text += (i == 0 ? "" : " || ") + flag(i * 7 % 40) + " == " + std::to_string(i % 5);
    ASSERT_LT(text.size(), 65536u);
    c.rule(true, text);
    const auto space = c.build();
    ASSERT_TRUE(space);
    EXPECT_FALSE(space->diagram->count(space->legal).is_zero());
}

TEST(Limits, PastTheNodeLimitTheRulesAreNamed) {
    // Every rule ties three of thirty axes at random.
    std::vector<Axis> axes;
    for (size_t i = 0; i < 30; ++i) axes.push_back(boolean_axis(flag(i)));
    Case c(axes);
    Random random(4);
    for (int i = 0; i < 40; ++i)
        c.rule(true, flag(below(random, 30)) + " && !" + flag(below(random, 30)) + " && " + flag(below(random, 30)));
    EXPECT_FALSE(c.build(300));
    ASSERT_EQ(c.diags.errors(), 1u);
    const Diag& d = c.diags.list()[0];
    EXPECT_EQ(d.place.file, "m.yaml");
    EXPECT_GE(d.place.line, 10u);
    EXPECT_EQ(d.place.column, 5u);
    EXPECT_NE(d.message.find("need more than 300 diagram nodes"), std::string::npos) << d.message;
    ASSERT_FALSE(d.notes.empty());
    EXPECT_EQ(d.notes[0].substr(0, 7), "m.yaml:") << d.notes[0];
    EXPECT_TRUE(c.build());
}

TEST(Limits, OneRulePastTheNodeLimit) {
    std::vector<Axis> axes;
    for (size_t i = 0; i < 20; ++i) axes.push_back(make_axis(flag(i), AxisKind::integer, up_to(16)));
    Case c(axes);
    c.rule(false, "f0 == f1 && f2 == f3");
    c.rule(false, "f4 < f5 || f6 < f7 || f8 < f9 || f10 < f11");
    EXPECT_FALSE(c.build(20));
    ASSERT_EQ(c.diags.errors(), 1u);
}

TEST(Limits, ExhaustedDiagramSaysSo) {
    Diagram d({2, 2, 2, 2}, {0, 1, 2, 3}, 4);
    const Set a = d.where(0, 1), b = d.where(1, 1);
    EXPECT_FALSE(d.exhausted());
    d.both(d.both(a, b), d.where(2, 1));
    EXPECT_TRUE(d.exhausted());
}

TEST(Limits, SameInputSameDiagram) {
    for (uint32_t seed = 1; seed <= 50; ++seed) {
        const auto build = [&] {
            Random random(seed);
            return random_case(random, 12, 6);
        };
        Case first = build(), second = build();
        const auto a = first.build(), b = second.build();
        ASSERT_TRUE(a && b);
        EXPECT_EQ(a->diagram->order(), b->diagram->order());
        EXPECT_EQ(a->legal, b->legal);
        EXPECT_EQ(a->diagram->nodes(), b->diagram->nodes());
    }
}

TEST(Limits, EnumeratesTheBeginningOfAHugeSet) {
    std::vector<Axis> axes;
    for (const char* side : {"a", "b"})
        for (int i = 0; i < 30; ++i) axes.push_back(boolean_axis(side + std::to_string(i)));
    Case c(axes);
    for (int i = 0; i < 30; ++i) c.rule(false, "a" + std::to_string(i) + " == b" + std::to_string(i));
    const auto space = c.build();
    ASSERT_TRUE(space);
    uint64_t seen = 0;
    const size_t nodes = space->diagram->nodes();
    space->diagram->enumerate(space->legal, [&](const Digits& d) {
        uint64_t a = 0, b = 0;
        for (size_t i = 0; i < 30; ++i) {
            a = a * 2 + d[i];
            b = b * 2 + d[30 + i];
        }
        EXPECT_EQ(a, seen);
        EXPECT_EQ(b, seen);
        return ++seen < 50'000;
    });
    EXPECT_EQ(seen, 50'000u);
    EXPECT_EQ(space->diagram->nodes(), nodes);  // enumeration leaves nothing behind
}

TEST(Limits, IndependentPartsDeclaredInterleaved) {
    // Four chains whose links alternate: they must not multiply.
    std::vector<Axis> axes;
    for (int i = 0; i < 200; ++i) axes.push_back(boolean_axis(flag(static_cast<size_t>(i))));
    Case c(axes);
    for (size_t i = 0; i + 4 < 200; ++i) c.rule(true, flag(i) + " && " + flag(i + 4));
    const auto space = c.build();
    ASSERT_TRUE(space);
    Count one = fibonacci(52);
    EXPECT_EQ(space->diagram->count(space->legal), one * one * one * one);
    EXPECT_LT(space->diagram->nodes(), 1'000u);
}

TEST(Limits, StepsRunOutLikeNodes) {
    const auto build = [](size_t steps) {
        std::vector<uint32_t> radices(24, 2), order(24);
        std::iota(order.begin(), order.end(), 0U);
        auto d = std::make_unique<Diagram>(radices, order);
        d->limit_steps(steps);
        Set equal = Diagram::all();  // of axes far apart, so every step doubles the work
        for (uint32_t a = 0; a < 12; ++a) {
            const Set x = d->where(a, 1), y = d->where(a + 12, 1);
            equal = d->both(equal, d->either(d->both(x, y), d->complement(d->either(x, y))));
        }
        return std::pair{std::move(d), equal};
    };
    const auto whole = build(1'000'000);
    EXPECT_FALSE(whole.first->exhausted());
    EXPECT_EQ(whole.first->count(whole.second), Count(4096));
    const auto cut = build(1'000);
    EXPECT_TRUE(cut.first->exhausted());
}

}  // namespace
}  // namespace kiln
