#include "compiler/base/diag.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

TEST(Render, PutsTheCaretUnderTheByte) {
    Diag d;
    d.place = {"a.yaml", 3, 5};
    d.message = "bad";
    d.source_line = "abc\tdef";
    d.notes = {"in 3 of 4 variants"};
    EXPECT_EQ(render(d, false), "a.yaml:3:5: error: bad\n    abc def\n        ^\n  in 3 of 4 variants\n");
}

TEST(Render, CountsWideCharactersOnceAndHidesControlBytes) {
    Diag d;
    d.place = {"a", 1, 4};
    d.source_line = "\xC3\xA9\x1bx\xFF";
    EXPECT_EQ(render(d, false), "a:1:4: error: \n    \xC3\xA9?x?\n      ^\n");
}

TEST(Render, CutsLongLinesAroundTheCaret) {
    Diag d;
    d.place = {"a", 1, 5001};
    d.source_line = std::string(5000, 'x') + "!" + std::string(5000, 'y');
    const std::string text = render(d, false);
    EXPECT_LT(text.size(), 500u);
    const size_t mark = text.find('!'), caret = text.find('^');
    ASSERT_NE(mark, std::string::npos);
    EXPECT_EQ(mark - text.rfind('\n', mark), caret - text.rfind('\n', caret));
}

TEST(Diags, SortDropsRepeatsAndOrdersByPlace) {
    Diags diags;
    diags.error({"b", 1, 1}, "x");
    diags.error({"a", 2, 1}, "x");
    diags.warning({"a", 1, 9}, "w");
    diags.error({"b", 1, 1}, "x");
    diags.sort();
    ASSERT_EQ(diags.list().size(), 3u);
    EXPECT_EQ(diags.list()[0].message, "w");
    EXPECT_EQ(diags.list()[2].place.file, "b");
    EXPECT_EQ(diags.errors(), 2u);
}

TEST(Diags, SortJoinsTheNotesOfEqualMistakes) {
    Diags diags;
    diags.error({"a", 1, 1}, "x", "line").notes = {"in A", "hint"};
    diags.error({"a", 1, 1}, "y", "line").notes = {"in C"};
    diags.error({"a", 1, 1}, "x", "line").notes = {"in B", "hint"};
    diags.sort();
    ASSERT_EQ(diags.list().size(), 2u);
    EXPECT_EQ(diags.list()[0].notes, (std::vector<std::string>{"in A", "hint", "in B"}));
    EXPECT_EQ(diags.errors(), 2u);
}

TEST(Nearest, FindsAMisspeltNameAndRefusesAStranger) {
    const std::vector<std::string> names{"light", "material", "lightmap"};
    EXPECT_EQ(nearest("ligth", names), "light");
    EXPECT_EQ(nearest("materal", names), "material");
    EXPECT_EQ(nearest("zebra", names), "");
}

TEST(LineOf, CutsLineEnds) {
    EXPECT_EQ(line_of("a\r\nbc\n", 1), "a");
    EXPECT_EQ(line_of("a\r\nbc\n", 2), "bc");
    EXPECT_EQ(line_of("a\r\nbc\n", 9), "");
}

}  // namespace
}  // namespace kiln
