#include "compiler/manifest.h"

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

}  // namespace
}  // namespace kiln
