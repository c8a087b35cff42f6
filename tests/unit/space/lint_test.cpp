#include <gtest/gtest.h>

#include <algorithm>

#include "compiler/base/diag.h"
#include "compiler/space/implied.h"
#include "tests/unit/space/random_space.h"

namespace kiln {
namespace {

using namespace test;

std::vector<std::string> lint_lines(Case& c) {
    std::vector<std::unique_ptr<Space>> spaces;
    spaces.push_back(c.build());
    Diags diags;
    lint(c.manifest, spaces, diags);
    std::vector<std::string> lines;
    for (const Diag& d : diags.list()) {
        std::string line = std::to_string(d.place.line) + ": " + d.message;
        for (const std::string& note : d.notes) line += " | " + note;
        lines.push_back(line);
    }
    return lines;
}
using Lines = std::vector<std::string>;

Case three() {
    Axis light = make_axis("light", AxisKind::named, {0, 1, 2});
    light.values[0].name = "none";
    light.values[1].name = "point";
    light.values[2].name = "spot";
    light.place.line = 3;
    return Case({light, boolean_axis("ibl"), boolean_axis("water")});
}

TEST(Lint, ImpossibleValue) {
    Case c = three();
    c.rule(true, "light == spot && ibl");
    c.rule(true, "light == spot && !ibl");
    EXPECT_EQ(lint_lines(c), Lines{"3: value 'spot' of axis 'light' can never occur"});
    Case alone = three();
    alone.rule(true, "light == spot");
    EXPECT_EQ(lint_lines(alone),
              Lines{"3: value 'spot' of axis 'light' can never occur | excluded by m.yaml:10:5: forbid: light == spot"});
}

TEST(Lint, ImpliedRules) {
    Case c = three();
    c.rule(true, "light == none && ibl");
    c.rule(true, "light == none && water");
    c.rule(true, "light == none && ibl && water");
    EXPECT_EQ(lint_lines(c), Lines{"12: this rule is implied by all the others"});
    Case twice = three();
    twice.rule(true, "light == none && ibl");
    twice.rule(false, "ibl -> light != none");
    EXPECT_EQ(
        lint_lines(twice),
        (Lines{"10: this rule is implied by all the others | it says the same as m.yaml:11:5: require: ibl -> light != none",
               "11: this rule is implied by all the others | it says the same as m.yaml:10:5: forbid: light == none && ibl"}));
    Case idle = three();
    idle.rule(true, "ibl && !ibl");
    idle.rule(false, "light <= 2");
    EXPECT_EQ(lint_lines(idle), (Lines{"10: this rule excludes nothing: its expression is never true",
                                       "11: this rule excludes nothing: its expression is always true"}));
}

TEST(Lint, Clashes) {
    Case alone = three();
    alone.rule(true, "water && ibl");
    alone.rule(false, "light == point && light == spot");
    EXPECT_EQ(lint_lines(alone), Lines{"11: this rule alone leaves no variant of shader 's'"});
    Case pair = three();
    pair.rule(false, "light != none");
    pair.rule(true, "water");
    pair.rule(false, "light == none");
    EXPECT_EQ(lint_lines(pair),
              Lines{"10: these 2 rules together leave no variant of shader 's' | m.yaml:10:5: require: light != none "
                    "| m.yaml:12:5: require: light == none"});
}

TEST(Lint, RuleOfSeveralShadersIsImpliedOnlyIfEverywhere) {
    Case c = three();
    c.rule(true, "light == none && ibl");
    c.manifest.shaders.push_back(c.manifest.shaders[0]);
    c.manifest.shaders[1].name = "t";
    c.rule(true, "light == none");  // in the first shader alone: implies the other there
    std::vector<std::unique_ptr<Space>> spaces;
    for (const Shader& s : c.manifest.shaders) spaces.push_back(build_space(c.manifest, s, c.diags));
    Diags diags;
    lint(c.manifest, spaces, diags);
    EXPECT_TRUE(diags.empty());
    spaces.pop_back();
    lint(c.manifest, spaces, diags);
    ASSERT_EQ(diags.list().size(), 2u);
    EXPECT_EQ(diags.list()[0].place.line, 10u);
}

TEST(Lint, PartsThatShareNoAxisAreLookedAtAlone) {
    // Four hundred pairs of axes of many values: far too much work if every rule were compared with all that the others leave.
    std::vector<Axis> axes;
    std::vector<int32_t> numbers;
    for (int32_t i = 0; i < 300; ++i) numbers.push_back(i);
    for (size_t i = 0; i < 800; ++i) axes.push_back(make_axis("f" + std::to_string(i), AxisKind::integer, numbers));
    Case c(axes);
    for (size_t i = 0; i < 800; i += 2) c.rule(false, "f" + std::to_string(i) + " <= f" + std::to_string(i + 1));
    c.rule(true, "f700 == 299 && f701 < 299");
    EXPECT_EQ(lint_lines(c), Lines{"410: this rule is implied by all the others"});
}

TEST(Lint, RandomRulesAgreeWithBruteForce) {
    for (uint32_t seed = 1; seed <= 1500; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed * 31337);
        Case c = random_case(random, 4, 4);
        const std::vector<Rule>& rules = c.manifest.shaders[0].rules;
        const std::vector<Axis>& axes = c.manifest.axes;
        const std::vector<Digits> all = combinations(axes);
        const auto left = [&](uint32_t chosen) {
            size_t n = 0;
            for (const Digits& m : all) {
                bool ok = true;
                for (size_t r = 0; r < rules.size(); ++r)
                    if (chosen >> r & 1) ok = ok && holds(rules[r].expr, axes, m) != rules[r].forbid;
                n += ok;
            }
            return n;
        };
        const uint32_t every = (1u << rules.size()) - 1;
        Lines expected;
        if (left(every) == 0) {
            int smallest = 99;
            for (uint32_t chosen = 1; chosen <= every; ++chosen)
                if (left(chosen) == 0) smallest = std::min(smallest, __builtin_popcount(chosen));
            const Lines lines = lint_lines(c);
            ASSERT_EQ(lines.size(), 1u);
            const std::string count = smallest == 1 ? "this rule alone" : "these " + std::to_string(smallest) + " rules";
            ASSERT_NE(lines[0].find(count), std::string::npos) << lines[0];
            continue;
        }
        for (size_t r = 0; r < rules.size(); ++r) {
            const std::string line = std::to_string(rules[r].place.line) + ": this rule ";
            if (left(1u << r) == all.size())
                expected.push_back(line + "excludes nothing");
            else if (left(every & ~(1u << r)) == left(every))
                expected.push_back(line + "is implied by all the others");
        }
        for (const Axis& axis : axes)
            for (size_t v = 0; v < axis.values.size(); ++v) {
                bool possible = false;
                for (const Digits& m : legal_combinations(c))
                    possible = possible || m[static_cast<size_t>(&axis - axes.data())] == v;
                if (!possible)
                    expected.push_back("1: value '" + axis.values[v].name + "' of axis '" + axis.name + "' can never occur");
            }
        const Lines lines = lint_lines(c);
        ASSERT_EQ(lines.size(), expected.size());
        for (size_t i = 0; i < lines.size(); ++i) ASSERT_EQ(lines[i].substr(0, expected[i].size()), expected[i]);
    }
}

TEST(Lint, LongListsOfRulesAgreeWithTheSlowWay) {
    for (uint32_t seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        Diagram d(std::vector<uint32_t>(10, 3), {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
        std::vector<Set> sets;
        for (uint32_t i = 0; i < 100; ++i) {
            const Set a = d.where(below(random, 10), below(random, 3)), b = d.where(below(random, 10), below(random, 3));
            sets.push_back(d.complement(d.both(a, d.both(b, d.where(below(random, 10), below(random, 3))))));
        }
        const std::vector<bool> implied = implied_by_others(d, sets);
        for (size_t i = 0; i < sets.size(); ++i) {
            Set others = Diagram::all();
            for (size_t k = 0; k < sets.size(); ++k)
                if (k != i) others = d.both(others, sets[k]);
            ASSERT_EQ(implied[i], d.subset(others, sets[i]));
        }
    }
}

}  // namespace
}  // namespace kiln
