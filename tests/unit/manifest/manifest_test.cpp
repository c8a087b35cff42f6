#include "compiler/manifest/manifest.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

constexpr const char* surface = R"(kiln: 1
name: surface
include: [../uber]
targets: [spirv, glsl450, essl300, hlsl60, msl21]
options: {undefined_macros: zero, optimise: size, vulkan: "1.1", spirv: "1.3", debug: true}
axes:
  light:     {macro: LIGHT_TYPE, values: [none, directional, point, spot]}
  cascades:  {macro: CASCADES, values: [1, 2, 0x4]}
  lightmap:  {macro: LIGHTMAP, values: {none: 0, flat: 1, sh_lq: 2, sh_hq: 4}}
  two_sided: {macro: TWO_SIDED, values: bool}
  skinned:   {macro: SKINNED, values: defined}
rules:
  - forbid: light == none && lightmap == none
    because: nothing to see
  - require: "light != none -> cascades <= 4"
  - forbid: skinned
shaders:
  - name: surface
    stages: {fragment: surface.frag, vertex: surface.vert}
    axes: [two_sided, light, cascades, lightmap]
    rules: []
    defines: {MAX_LIGHTS: 4, EMPTY: ""}
  - name: bones
    stages: {compute: bones.comp}
    options: {optimise: none, vulkan: "1.2", spirv: "1.5"}
)";

TEST(Manifest, ReadsTheGrammar) {
    MemoryFiles files;
    files.files["manifests/surface.yaml"] = surface;
    Diags diags;
    const auto m = load_manifest(files, "manifests/surface.yaml", diags);
    for (const Diag& d : diags.list()) ADD_FAILURE() << render(d, false);
    ASSERT_TRUE(m);
    EXPECT_EQ(m->name, "surface");
    EXPECT_EQ(m->folder, "manifests");
    EXPECT_EQ(m->include, std::vector<std::string>{"../uber"});
    EXPECT_EQ(m->targets, (std::vector<Target>{Target::spirv, Target::glsl450, Target::essl300, Target::hlsl60, Target::msl21}));
    EXPECT_EQ(m->options, (Options{UndefinedMacros::zero, Optimise::size, 0x101, 0x103, true}));
    ASSERT_EQ(m->axes.size(), 5u);
    EXPECT_EQ(m->axes[0].values, (std::vector<AxisValue>{{"none", 0}, {"directional", 1}, {"point", 2}, {"spot", 3}}));
    EXPECT_EQ(m->axes[1].kind, AxisKind::integer);
    EXPECT_EQ(m->axes[1].values, (std::vector<AxisValue>{{"1", 1}, {"2", 2}, {"4", 4}}));
    EXPECT_EQ(m->axes[2].values, (std::vector<AxisValue>{{"none", 0}, {"flat", 1}, {"sh_lq", 2}, {"sh_hq", 4}}));
    EXPECT_EQ(m->axes[3].kind, AxisKind::boolean);
    EXPECT_EQ(m->axes[4].kind, AxisKind::defined);
    EXPECT_EQ(m->axes[4].place, (Place{"manifests/surface.yaml", 11, 3}));
    ASSERT_EQ(m->shaders.size(), 2u);
    const Shader& first = m->shaders[0];
    EXPECT_EQ(first.axes, (std::vector<uint32_t>{0, 1, 2, 3}));
    ASSERT_EQ(first.rules.size(), 2u);
    EXPECT_EQ(first.rules[0].because, "nothing to see");
    EXPECT_EQ(first.rules[1].place, (Place{"manifests/surface.yaml", 15, 15}));
    ASSERT_EQ(first.stages.size(), 2u);
    EXPECT_EQ(first.stages[0].stage, Stage::vertex);
    EXPECT_EQ(first.defines, (std::vector<std::pair<std::string, std::string>>{{"MAX_LIGHTS", "4"}, {"EMPTY", ""}}));
    EXPECT_EQ(m->shaders[1].rules.size(), 3u);
    EXPECT_EQ(m->shaders[1].options, (Options{UndefinedMacros::zero, Optimise::none, 0x102, 0x105, true}));
}

constexpr const char* two_axes = "kiln: 1\naxes: {a: {macro: A, values: bool}, b: {macro: B, values: bool}}\n";

std::optional<Manifest> loaded(const std::string& text) {
    MemoryFiles files;
    files.files["folder/m.yaml"] = text;
    Diags diags;
    auto manifest = load_manifest(files, "folder/m.yaml", diags);
    for (const Diag& d : diags.list()) ADD_FAILURE() << render(d, false);
    return manifest;
}

TEST(Manifest, Defaults) {
    const auto m =
        loaded(std::string(two_axes) + "shaders: [{name: s, stages: {compute: c}}, {name: t, stages: {mesh: c}, axes: []}]\n");
    ASSERT_TRUE(m);
    EXPECT_EQ(m->name, "m");
    EXPECT_EQ(m->targets, std::vector<Target>{Target::spirv});
    EXPECT_EQ(m->options, Options());
    EXPECT_EQ(m->shaders[0].axes, (std::vector<uint32_t>{0, 1}));
    EXPECT_TRUE(m->shaders[1].axes.empty());
}

TEST(Manifest, OptionsOfAShaderBeginWithTheManifests) {
    const auto m = loaded(
        "kiln: 1\noptions: {vulkan: 1.3, optimise: size}\n"
        "shaders:\n  - {name: s, stages: {compute: c}, options: {vulkan: 1.2}}\n"
        "  - {name: t, stages: {compute: c}, options: {spirv: 1.0}}\n  - {name: u, stages: {compute: c}, options: {debug: "
        "true}}\n");
    ASSERT_TRUE(m);
    EXPECT_EQ(m->options, (Options{UndefinedMacros::error, Optimise::size, 0x103, 0x106, false}));
    EXPECT_EQ(m->shaders[0].options, (Options{UndefinedMacros::error, Optimise::size, 0x102, 0x105, false}));
    EXPECT_EQ(m->shaders[1].options, (Options{UndefinedMacros::error, Optimise::size, 0x103, 0x100, false}));
    EXPECT_EQ(m->shaders[2].options, (Options{UndefinedMacros::error, Optimise::size, 0x103, 0x106, true}));
}

TEST(Manifest, RulesOverSeveralLinesAreOneLineOfText) {
    const auto m = loaded(std::string(two_axes) +
                          "rules:\n  - forbid: |\n      a &&\n        b\n    because: >\n      not\n      both\n"
                          "shaders: [{name: s, stages: {compute: c}}]\n");
    ASSERT_TRUE(m);
    const Rule& rule = m->shaders[0].rules.at(0);
    EXPECT_EQ(rule.text, "a &&   b");
    EXPECT_EQ(rule.because, "not both");
    EXPECT_EQ(rule.place, (Place{"folder/m.yaml", 5, 7}));
    EXPECT_EQ(rule.source_line, "      a &&");
}

// Several hundred values on one line, and the whole as JSON, which is YAML too.
TEST(Manifest, ReadsJson) {
    std::string values;
    for (int i = 0; i < 500; ++i) values += (i == 0 ? "\"v" : ", \"v") + std::to_string(i) + "\"";
    const auto m = loaded("{\"kiln\": 1, \"axes\": {\"a\": {\"macro\": \"A\", \"values\": [" + values +
                          "]}}, \"rules\": [{\"forbid\": \"a in {v3, v499}\"}], \"shaders\": [{\"name\": \"s\", \"stages\": "
                          "{\"compute\": \"c\"}}]}");
    ASSERT_TRUE(m);
    EXPECT_EQ(m->axes[0].values.size(), 500u);
    EXPECT_EQ(m->axes[0].values[499], (AxisValue{"v499", 499}));
    EXPECT_EQ(m->axes[0].values[1].column, m->axes[0].values[0].column + 6);
}

std::string axis_of(size_t index, size_t values) {
    std::string out = "  axis" + std::to_string(index) + ": {macro: M" + std::to_string(index) + ", values: [";
    for (size_t i = 0; i < values; ++i) out += (i == 0 ? "v" : ", v") + std::to_string(i);
    return out + "]}\n";
}

const char* const one_shader = "shaders: [{name: s, stages: {compute: c}}]\n";

TEST(Manifest, FitsItsLimits) {
    // More than a thousand axes, one of them with thousands of values, a million values in all, and a very long rule.
    std::string text = "kiln: 1\naxes:\n" + axis_of(0, 4096);
    for (size_t i = 1; i < 1100; ++i) text += axis_of(i, 920);
    std::string rule = "axis1 == v1";
    for (size_t i = 0; rule.size() + 32 < expr_size_limit; ++i)
        rule += " || axis" + std::to_string(i % 1100) + " == v" + std::to_string(i % 920);
    const auto m = loaded(text + "rules:\n  - forbid: " + rule + "\n" + one_shader);
    ASSERT_TRUE(m);
    size_t values = 0;
    for (const Axis& a : m->axes) values += a.values.size();
    EXPECT_GT(values, 1'000'000u);
    EXPECT_EQ(m->axes.size(), 1100u);
    EXPECT_EQ(m->shaders[0].rules[0].text, rule);
}

TEST(Manifest, RefusesWhatIsPastItsLimits) {
    const auto refused = [](const std::string& text) {
        MemoryFiles files;
        files.files["m.yaml"] = text;
        Diags diags;
        EXPECT_FALSE(load_manifest(files, "m.yaml", diags));
        return diags.empty() ? "" : diags.list()[0].message;
    };
    std::string axes;
    for (size_t i = 0; i <= axis_limit; ++i) axes += axis_of(i, 1);
    EXPECT_EQ(refused("kiln: 1\naxes:\n" + axes + one_shader), "4097 axes; at most 4096 are possible");
    EXPECT_EQ(refused("kiln: 1\naxes:\n" + axis_of(0, axis_value_limit + 1) + one_shader),
              "axis 'axis0' has 65537 values; at most 65536 are possible");
    const std::string name(name_limit + 1, 'n');
    EXPECT_EQ(
        refused("kiln: 1\naxes: {" + name + ": {macro: M, values: bool}}\n" + one_shader).substr(65),
        "...' cannot be the name of an axis: names are letters, digits and '_', begin with no digit, and have at most 255 bytes");
    EXPECT_EQ(refused("kiln: 1\naxes: {a: {macro: " + name + ", values: bool}}\n" + one_shader).substr(0, 9), "the macro");
    EXPECT_EQ(refused("kiln: 1\naxes: {a: {macro: M, values: [" + name + "]}}\n" + one_shader),
              "a name may have at most 255 bytes");
    EXPECT_EQ(refused("kiln: 1\naxes: {a: {macro: M, values: bool}}\nrules: [{forbid: '" + std::string(expr_size_limit, '!') +
                      "a'}]\n" + one_shader),
              "an expression may have at most 65536 bytes");
}

}  // namespace
}  // namespace kiln
