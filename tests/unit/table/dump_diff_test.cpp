#include <gtest/gtest.h>

#include "compiler/table/table_diff.h"
#include "compiler/table/table_dump.h"
#include "sample.h"

namespace kiln::test {
namespace {

std::unique_ptr<TableView> view_of(const Sample& sample) {
    auto files = write_table(sample.input());
    EXPECT_TRUE(files.ok());
    auto view = TableView::open(files->table);
    EXPECT_TRUE(view.ok());
    return std::move(*view);
}

Set pick(TableShader& shader, std::vector<std::pair<uint32_t, uint32_t>> digits) {
    Set out = Diagram::all();
    for (const auto& [axis, digit] : digits) out = shader.space.diagram->both(out, shader.space.diagram->where(axis, digit));
    return out;
}

TEST(Dump, WholeTable) {
    const auto view = view_of(small_sample());
    const TableDump dump = dump_table(*view);
    EXPECT_EQ(dump.artifacts.at(Target::spirv), dump.modules);
    EXPECT_EQ(dump.holes.at(Target::essl310), 1u);
    EXPECT_EQ(dump.holes.count(Target::glsl450), 0u);
    ASSERT_EQ(dump.shaders.size(), 2u);
    const DumpShader& s = dump.shaders[0];
    EXPECT_EQ(s.declared.decimal(), "24");
    EXPECT_EQ(s.legal.decimal(), "22");
    EXPECT_EQ(s.needed.decimal(), "16");
    EXPECT_EQ(s.axes[0].values[0].needed.decimal(), "4");
    EXPECT_EQ(s.axes[0].values[3].needed.decimal(), "0");
    EXPECT_EQ(s.stages[1].axes, (std::vector<std::string>{"light", "pass"}));
    EXPECT_EQ(s.rules, (std::vector<std::string>{"forbid: light == none && pass == forward (a test)"}));
    const std::string text = render(dump);
    EXPECT_NE(text.find("surface: 24 declared, 22 legal, 16 needed"), std::string::npos) << text;
    EXPECT_NE(text.find("essl310: "), std::string::npos) << text;
    EXPECT_NE(text.find("1 that it cannot say"), std::string::npos) << text;
    EXPECT_NE(text.find("scene corridor"), std::string::npos) << text;
}

TEST(Dump, VariantsAndTexts) {
    const auto view = view_of(small_sample());
    TableShader& shader = *view->shader("surface");
    const VariantDump one = dump_variants(*view, shader, pick(shader, {{0, 2}, {1, 1}, {2, 0}}));
    EXPECT_EQ(one.needed.decimal(), "1");
    ASSERT_EQ(one.stages.size(), 2u);
    ASSERT_EQ(one.stages[1].second.size(), 1u);
    EXPECT_EQ(one.stages[1].second[0].uses.size(), 2u);
    EXPECT_NE(render(one).find("Frame.lights[].position: float3[2] at 64"), std::string::npos) << render(one);
    const VariantDump some = dump_variants(*view, shader, pick(shader, {{1, 1}}));
    EXPECT_EQ(some.selected.decimal(), "8");
    EXPECT_EQ(some.needed.decimal(), "6");
    EXPECT_EQ(some.stages[0].second.size(), 2u);

    const auto texts = dump_texts(*view, shader, pick(shader, {{0, 2}, {1, 1}, {2, 0}}), Target::glsl450);
    ASSERT_TRUE(texts.ok());
    ASSERT_EQ(texts->size(), 2u);
    EXPECT_EQ((*texts)[1].text.rfind("// surface ", 0), 0u) << (*texts)[1].text;
    const auto open = dump_texts(*view, shader, pick(shader, {{1, 1}, {2, 0}}), Target::glsl450);
    ASSERT_FALSE(open.ok());
    EXPECT_EQ(open.error().message, "the fragment stage has 3 modules for this selection: say more about light");
    EXPECT_EQ(dump_texts(*view, shader, pick(shader, {{0, 0}, {1, 0}}), Target::glsl450).error().message,
              "the rules forbid this variant");
    EXPECT_EQ(dump_texts(*view, shader, pick(shader, {{0, 3}, {1, 0}}), Target::glsl450).error().message,
              "no scene needs this variant");
    EXPECT_EQ(dump_texts(*view, shader, Diagram::all(), Target::msl21).error().message,
              "the table has no target msl21, only spirv, glsl450, essl310");
}

// One shader; `salt` changes the text wherever light has that digit.
Sample lights(std::vector<std::string> values, std::vector<std::string> forbid, uint32_t salt, bool more_axes = false) {
    SampleShader shader;
    shader.name = "surface";
    shader.axes = {named("light", values), boolean("fog")};
    if (more_axes) shader.axes.push_back(boolean("wet"));
    shader.forbid = std::move(forbid);
    const std::vector<std::string> names = values;
    shader.stages = {{Stage::fragment, {0}, [names, salt](const Digits& d) {
                          return "f" + names[d[0]] + (d[0] == salt ? "!" : "") + (d.size() > 2 && d[2] == 1 ? "w" : "");
                      }}};
    if (more_axes) shader.stages[0].reads.push_back(2);
    return Sample({shader}, {Target::spirv});
}

TEST(Diff, SameTablesAreTheSame) {
    const auto a = view_of(small_sample()), b = view_of(small_sample());
    const TableDiff diff = diff_tables(*a, *b);
    EXPECT_TRUE(diff.same()) << render(diff);
    EXPECT_EQ(diff.bytes_before, diff.bytes_after);
}

TEST(Diff, AddedLostAndChangedAreExact) {
    const auto a = view_of(lights({"none", "point", "spot"}, {}, 9));
    const auto b = view_of(lights({"spot", "none", "point", "area"}, {"light == none && fog"}, 2));
    const TableDiff diff = diff_tables(*a, *b);
    ASSERT_EQ(diff.shaders.size(), 1u);
    const DiffShader& s = diff.shaders[0];
    EXPECT_EQ(s.before.decimal(), "6");
    EXPECT_EQ(s.after.decimal(), "7");
    EXPECT_EQ(s.added.decimal(), "2");
    EXPECT_EQ(s.added_when, "in 2 of 7 variants of surface: exactly when light == area");
    EXPECT_EQ(s.lost.decimal(), "1");
    EXPECT_EQ(s.lost_when, "in 1 of 6 variants of surface: exactly when light == none && fog");
    EXPECT_EQ(s.changed.decimal(), "2");
    EXPECT_EQ(s.changed_when, "in 2 of 5 variants of surface: exactly when light == point");
    ASSERT_EQ(s.axes.size(), 2u);
    ASSERT_EQ(s.axes[0].values.size(), 4u);
    EXPECT_EQ(s.axes[0].values[3].name, "area");
    EXPECT_EQ(s.axes[0].values[3].after.decimal(), "2");
    EXPECT_EQ(s.axes[0].values[3].modules_after, 1u);
    EXPECT_EQ(s.axes[0].values[3].modules_before, 0u);
    EXPECT_NE(render(diff).find("light=area: variants 0 -> 2, modules 0 -> 1"), std::string::npos) << render(diff);
}

TEST(Diff, AnAxisThatOneLacksIsAtItsFirstValue) {
    const auto a = view_of(lights({"none", "point"}, {}, 9)), b = view_of(lights({"none", "point"}, {}, 9, true));
    const TableDiff there = diff_tables(*a, *b), back = diff_tables(*b, *a);
    EXPECT_EQ(there.shaders[0].axes_added, (std::vector<std::string>{"wet"}));
    EXPECT_EQ(there.shaders[0].added.decimal(), "4");
    EXPECT_EQ(there.shaders[0].added_when, "in 4 of 8 variants of surface: exactly when wet");
    EXPECT_EQ(there.shaders[0].lost.decimal(), "0");
    EXPECT_EQ(there.shaders[0].changed.decimal(), "0");
    EXPECT_EQ(back.shaders[0].lost.decimal(), "4");
    EXPECT_EQ(back.shaders[0].axes_lost, (std::vector<std::string>{"wet"}));
}

TEST(Diff, ShadersOfOneTableOnlyAndChangedTexts) {
    Sample one = small_sample();
    const auto a = view_of(one), b = view_of(lights({"none", "point"}, {}, 9));
    const TableDiff diff = diff_tables(*a, *b);
    ASSERT_EQ(diff.shaders.size(), 2u);
    EXPECT_TRUE(diff.shaders[1].only_before);
    EXPECT_EQ(diff.shaders[1].lost.decimal(), "5");
    EXPECT_EQ(diff.targets_lost.size(), 2u);
    EXPECT_FALSE(diff.same());
    one.artifacts_.list[0].text += "// another translator\n";
    const auto c = view_of(one);
    const TableDiff texts = diff_tables(*a, *c);
    EXPECT_FALSE(texts.shaders[0].changed.is_zero());
    EXPECT_TRUE(texts.shaders[1].same());
}

}  // namespace
}  // namespace kiln::test
