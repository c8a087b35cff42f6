#include "compiler/space/describe.h"

#include <gtest/gtest.h>

#include "tests/unit/space/random_space.h"

namespace kiln {
namespace {

using namespace test;

std::vector<Axis> surface() {
    Axis light = make_axis("light", AxisKind::named, {0, 1, 2, 3, 4, 5, 6, 7});
    const char* const lights[] = {"none", "directional", "point", "spot", "area", "tube", "sky", "portal"};
    for (size_t i = 0; i < 8; ++i) light.values[i].name = lights[i];
    return {light,
            make_axis("cascades", AxisKind::integer, {1, 2, 4}),
            boolean_axis("ibl"),
            boolean_axis("water"),
            make_axis("level", AxisKind::integer, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}),
            make_axis("limit", AxisKind::integer, {2, 5, 7})};
}

TEST(Describe, SaysWhatWasWritten) {
    Case c(surface());
    c.rule(true, "light == none && ibl");
    const auto space = c.build();
    ASSERT_TRUE(space);
    const struct {
        const char *expr, *words;
    } cases[] = {
        {"ibl", "ibl"},
        {"!ibl", "!ibl"},
        {"water && light == area", "light == area && water"},
        {"ibl && light == area", "light == area && ibl"},
        {"light != none", "light != none"},
        {"light == area || light == spot", "light in {spot, area}"},
        {"!(light in {area, spot})", "!(light in {spot, area})"},
        {"cascades <= 2", "cascades <= 2"},
        {"cascades == 4", "cascades == 4"},
        {"level >= 3 && level <= 6", "level in {3, 4, 5, 6}"},
        {"level >= 1 && level <= 7", "!(level in {0, 8, 9})"},
        {"level != 0", "level != 0"},
        {"level < limit", "level < limit"},
        {"level < limit && water", "level < limit && water"},
        {"ibl || water", "ibl || water"},
        {"(light == area && water) || level == 3", "(light == area && water) || level == 3"},
        {"water -> cascades == 2", "cascades == 2 || !water"},
        {"light in {point, spot} && (ibl || water)", "light in {point, spot} && (ibl || water)"},
        {"ibl == water", "ibl == water"},
        {"ibl && light == none", "never"},
        {"ibl || !ibl", "always"},
        {"ibl && light != none", "ibl"},  // the rule already says the rest
        {"ibl && water && cascades == 4 && level == 2 && light == area", ""},
    };
    for (const auto& t : cases) {
        const Set set = space->diagram->both(space->legal, compile_expr(*space, must_parse(t.expr, space->axes)));
        EXPECT_EQ(describe_set(*space, set, space->legal), t.words) << t.expr;
    }
}

TEST(Describe, TheContract) {
    Case c(surface());
    const auto space = c.build();
    ASSERT_TRUE(space);
    space->shader = "surface";
    Diagram& d = *space->diagram;
    const Set set = compile_expr(*space, must_parse("ibl && light == area", space->axes));
    EXPECT_EQ(describe_condition(*space, set, space->legal),
              "in 180 of 2,880 variants of surface: exactly when light == area && ibl");
    EXPECT_EQ(describe_condition(*space, set, space->legal, true),
              "in at least 180 of 2,880 variants of surface: whenever light == area && ibl");
    EXPECT_EQ(describe_condition(*space, d.all(), space->legal), "in 2,880 of 2,880 variants of surface: always");
    EXPECT_EQ(describe_condition(*space, d.point({4, 2, 1, 1, 7, 2}), space->legal),
              "in 1 of 2,880 variants of surface: for example light=area cascades=4 ibl=true water=true level=7 limit=7");
}

// Parsed back, the words hold on exactly the set within `care`; a one-axis or two-axis conjunction is always found.
TEST(Describe, RandomSetsParsedBack) {
    size_t said = 0, silent = 0;
    for (uint32_t seed = 1; seed <= 3000; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed * 104729);
        Case c = random_case(random, 5, 5);
        const auto space = c.build();
        ASSERT_TRUE(space);
        if (space->legal == Diagram::none()) continue;
        const std::string written = random_expr(random, space->axes, 2);
        const Expr expr = must_parse(written, space->axes);
        const Set set = space->diagram->both(space->legal, compile_expr(*space, expr));
        const std::string words = describe_set(*space, set, space->legal);
        if (words.empty()) {
            ++silent;
            continue;
        }
        ++said;
        if (words == "always" || words == "never") {
            ASSERT_EQ(set, words == "always" ? space->legal : Diagram::none());
            continue;
        }
        const Expr again = must_parse(words, space->axes);
        for (const Digits& m : legal_combinations(c))
            ASSERT_EQ(holds(again, space->axes, m), holds(expr, space->axes, m)) << written << " said as " << words;
        const auto conjunctions = std::count(words.begin(), words.end(), '&') / 2,
                   others = std::count(words.begin(), words.end(), '|') / 2;
        ASSERT_LE(conjunctions + others + 1, 4) << words;
        // No axis can be left out: none of those named is irrelevant.
        for (const uint32_t axis : again.axes) {
            std::vector<bool> keep(space->axes.size(), false);
            for (const uint32_t other : again.axes) keep[other] = other != axis;
            ASSERT_FALSE(space->diagram->disjoint(space->diagram->project(set, keep), space->diagram->minus(space->legal, set)))
                << words << " does not need " << space->axes[axis].name;
        }
    }
    EXPECT_GT(said, 50 * silent);  // silence is for the few that need more than four terms
}

// Whatever one conjunction of up to four simple terms can say is said.
TEST(Describe, FindsEveryShortConjunction) {
    for (uint32_t seed = 1; seed <= 1500; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed * 15485863);
        Case c = random_case(random, 7, 6);
        const auto space = c.build();
        ASSERT_TRUE(space);
        std::string written;
        std::vector<uint32_t> axes(space->axes.size());
        for (uint32_t i = 0; i < axes.size(); ++i) axes[i] = i;
        std::shuffle(axes.begin(), axes.end(), random);
        axes.resize(std::min<size_t>(axes.size(), 1 + below(random, 4)));
        for (const uint32_t a : axes) {
            const Axis& axis = space->axes[a];
            const AxisValue& v = axis.values[below(random, static_cast<uint32_t>(axis.values.size()))];
            written += (written.empty() ? "" : " && ") + axis.name + (below(random, 2) == 0 ? " == " : " != ") + v.name;
        }
        const Set set = space->diagram->both(space->legal, compile_expr(*space, must_parse(written, space->axes)));
        ASSERT_NE(describe_set(*space, set, space->legal), "") << written;
    }
}

}  // namespace
}  // namespace kiln
