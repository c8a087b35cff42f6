#include <gtest/gtest.h>

#include <set>

#include "compiler/translate/translate.h"
#include "tests/unit/translate/mini_build.h"

namespace kiln {
namespace {

const char* const everything = R"(
layout(set=0, binding=0) uniform Scene { mat4 view; };
#if WITH
layout(set=0, binding=1) uniform sampler2D detail;
layout(set=0, binding=2) uniform Extra { vec4 more; };
layout(std430, set=0, binding=3) buffer Log { uint n; };
layout(set=1, binding=0, r32ui) uniform uimage2D counts;
#endif
layout(set=1, binding=1) uniform sampler2D albedo[2];
layout(set=1, binding=2) uniform sampler2DShadow shadow;
layout(set=2, binding=0) uniform Last { vec4 last; };
layout(std430, set=2, binding=1) readonly buffer Table { vec4 rows[]; };
layout(push_constant) uniform Push { vec4 tint; };
layout(location=0) out vec4 a; layout(location=2) out vec4 b;
void main() {
    a = view[0] + texture(albedo[1], vec2(0)) + last + rows[1] + tint; b = vec4(texture(shadow, vec3(0)));
#if WITH
    a += texture(detail, vec2(0)) + more; n = 1u; imageAtomicAdd(counts, ivec2(0), 1u);
#endif
})";

const Slot& slot(const SlotLayout& layout, const std::string& name) {
    for (const Slot& s : layout.slots)
        if (s.name == name) return s;
    ADD_FAILURE() << name;
    return layout.slots.front();
}

TEST(Slots, TheUnionDecidesAndEveryVariantAgrees) {
    const Reflection with = reflection_of(Stage::fragment, std::string("#define WITH 1\n") + everything);
    const Reflection without = reflection_of(Stage::fragment, std::string("#define WITH 0\n") + everything);
    const SlotLayout layout = assign_slots({&without, &with});
    EXPECT_EQ(layout, assign_slots({&with, &without}));
    EXPECT_EQ(layout.slots.size(), 10U);
    EXPECT_EQ(slot(layout, "Scene").buffer, 0U);
    EXPECT_EQ(slot(layout, "Extra").buffer, 1U);
    EXPECT_EQ(slot(layout, "Last").buffer, 2U);
    EXPECT_EQ(slot(layout, "Push").buffer, 3U);
    EXPECT_EQ(slot(layout, "Log").buffer, 0U);  // storage blocks count by themselves in GL
    EXPECT_EQ(slot(layout, "Table").buffer, 1U);
    EXPECT_EQ(slot(layout, "detail").texture, 0U);
    EXPECT_EQ(slot(layout, "albedo").texture, 1U);  // and 2
    EXPECT_EQ(slot(layout, "shadow").texture, 3U);
    EXPECT_EQ(slot(layout, "Log").uav, 3U);  // after three render targets
    EXPECT_EQ(slot(layout, "counts").uav, 4U);
    EXPECT_EQ(layout.slots.back().kind, ResourceKind::push_constants);

    // Metal has one space of buffers, and an image for atomics has one as well.
    std::set<uint32_t> buffers;
    for (const Slot& s : layout.slots)
        if (s.kind == ResourceKind::uniform_block || s.kind == ResourceKind::storage_block ||
            s.kind == ResourceKind::push_constants || s.name == "counts") {
            EXPECT_TRUE(buffers.insert(s.metal_buffer).second) << s.name;
        }
    EXPECT_EQ(*buffers.rbegin(), buffers.size() - 1);
}

TEST(Slots, NamesAreDistinctAndKindsApart) {
    Reflection a, b;
    a.stage = b.stage = Stage::fragment;
    Resource r;
    r.name = "thing";
    r.kind = ResourceKind::uniform_block;
    a.resources = {r};
    r.kind = ResourceKind::combined_image;
    b.resources = {r};
    r.binding = 1;
    b.resources.push_back(r);
    const SlotLayout layout = assign_slots({&a, &b});
    ASSERT_EQ(layout.slots.size(), 3U);
    std::set<std::string> names;
    for (const Slot& s : layout.slots) names.insert(s.name);
    EXPECT_EQ(names.size(), 3U);
}

TEST(Slots, UnsizedArraysComeLast) {
    Reflection m;
    Resource r;
    r.kind = ResourceKind::combined_image;
    r.name = "all";
    r.array = {0};
    m.resources.push_back(r);
    r.name = "one";
    r.array = {};
    r.binding = 1;
    m.resources.push_back(r);
    const SlotLayout layout = assign_slots({&m});
    EXPECT_EQ(slot(layout, "one").texture, 0U);
    EXPECT_EQ(slot(layout, "all").texture, 1U);
}

TEST(Slots, SeparateSamplersGiveEachPairAUnit) {
    Reflection m;
    Resource r;
    for (uint32_t i = 0; i < 4; ++i) {
        r.kind = i < 2 ? ResourceKind::separate_image : ResourceKind::separate_sampler;
        r.binding = i;
        r.name = "r" + std::to_string(i);
        m.resources.push_back(r);
    }
    const SlotLayout layout = assign_slots({&m});
    std::set<uint32_t> units;
    for (const char* image : {"r0", "r1"}) {
        for (const char* sampler : {"r2", "r3"}) units.insert(slot(layout, image).texture + slot(layout, sampler).unit_offset);
        units.insert(slot(layout, image).texture + slot(layout, image).unit_offset);
    }
    EXPECT_EQ(units.size(), 6U);
}

TEST(Slots, TheLastStageBeforeTheRasteriser) {
    Reflection v, g, e, c, f;
    v.stage = Stage::vertex, g.stage = Stage::geometry, e.stage = Stage::tess_evaluation, c.stage = Stage::tess_control;
    f.stage = Stage::fragment;
    EXPECT_EQ(assign_slots({&v, &f}).rasterised, Stage::vertex);
    EXPECT_EQ(assign_slots({&v, &c, &e, &f}).rasterised, Stage::tess_evaluation);
    EXPECT_EQ(assign_slots({&v, &c, &e, &g, &f}).rasterised, Stage::geometry);
}

}  // namespace
}  // namespace kiln
