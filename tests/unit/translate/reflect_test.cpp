#include <gtest/gtest.h>

#include "compiler/interfaces/mismatch.h"
#include "tests/unit/translate/mini_build.h"

namespace kiln {
namespace {

const Resource* find(const Reflection& r, const std::string& name) {
    for (const Resource& x : r.resources)
        if (x.name == name) return &x;
    ADD_FAILURE() << "no resource " << name;
    static const Resource none;
    return &none;
}

const Member* find(const Resource& r, const std::string& name) {
    for (const Member& m : r.members)
        if (m.name == name) return &m;
    ADD_FAILURE() << "no member " << name;
    static const Member none;
    return &none;
}

TEST(Reflect, UniformBlockOffsets) {
    const Reflection r = reflection_of(Stage::fragment, R"(
struct Light { vec4 at; vec3 colour; float range; };
layout(set=1, binding=3) uniform Scene {
    mat4 view; vec3 eye; float time; mat3 turn; layout(row_major) mat4x2 rows;
    float weights[3]; Light lights[4]; vec2 pair[2]; ivec3 n; bool on;
} s;
layout(location=0) out vec4 o;
void main() { o = s.view[0] + s.eye.xyzz * s.time + s.turn[1].x + s.rows[2].x + s.weights[1] + s.lights[2].at
                  + s.lights[1].range + s.lights[0].colour.x + s.pair[1].x + float(s.n.x) + float(s.on); })");
    ASSERT_EQ(r.resources.size(), 1U);
    const Resource& b = r.resources[0];
    EXPECT_EQ(b.name, "Scene");
    EXPECT_EQ(b.kind, ResourceKind::uniform_block);
    EXPECT_EQ(b.set, 1U);
    EXPECT_EQ(b.binding, 3U);
    const struct {
        const char* name;
        uint32_t offset, size, stride, matrix_stride;
        const char* type;
        bool rows;
    } want[] = {{"view", 0, 64, 0, 16, "mat4", false},
                {"eye", 64, 12, 0, 0, "vec3", false},
                {"time", 76, 4, 0, 0, "float", false},
                {"turn", 80, 48, 0, 16, "mat3", false},
                {"rows", 128, 32, 0, 16, "mat4x2", true},
                {"weights", 160, 48, 16, 0, "float[3]", false},
                {"lights[].at", 208, 16, 32, 0, "vec4[4]", false},
                {"lights[].colour", 224, 12, 32, 0, "vec3[4]", false},
                {"lights[].range", 236, 4, 32, 0, "float[4]", false},
                {"pair", 336, 32, 16, 0, "vec2[2]", false},
                {"n", 368, 12, 0, 0, "ivec3", false},
                {"on", 380, 4, 0, 0, "uint", false}};
    ASSERT_EQ(b.members.size(), std::size(want));
    for (const auto& w : want) {
        const Member& m = *find(b, w.name);
        EXPECT_EQ(m.offset, w.offset) << w.name;
        EXPECT_EQ(m.size, w.size) << w.name;
        EXPECT_EQ(m.array_stride, w.stride) << w.name;
        EXPECT_EQ(m.matrix_stride, w.matrix_stride) << w.name;
        EXPECT_EQ(m.row_major, w.rows) << w.name;
        ValueType t = m.type;
        std::string name = t.columns > 1
                               ? "mat" + std::to_string(t.columns) + (t.rows != t.columns ? "x" + std::to_string(t.rows) : "")
                           : t.rows > 1 ? (t.base == BaseType::int32 ? "ivec" : "vec") + std::to_string(t.rows)
                                        : (t.base == BaseType::uint32 ? "uint" : "float");
        for (const uint32_t n : t.array) name += "[" + std::to_string(n) + "]";
        EXPECT_EQ(name, w.type) << w.name;
    }
    EXPECT_EQ(b.bytes, 384U);
}

TEST(Reflect, StorageBlocksAndRuntimeArrays) {
    const Reflection r = reflection_of(Stage::compute, R"(
layout(local_size_x=8, local_size_y=4) in;
struct P { vec3 at; float w[2]; };
layout(std430, binding=0) readonly buffer In { uint n; P parts[]; };
layout(std430, binding=1) writeonly buffer Out { vec4 data[]; } o[2];
layout(binding=4, rgba8) uniform readonly image2D img;
layout(binding=5, r32ui) uniform uimageBuffer texels;
void main() { o[1].data[gl_GlobalInvocationID.x] = vec4(parts[n].at, parts[n].w[1]) + imageLoad(img, ivec2(0));
              imageStore(texels, 0, uvec4(1)); })");
    EXPECT_EQ(r.workgroup, (std::array<uint32_t, 3>{8, 4, 1}));
    const Resource& in = *find(r, "In");
    EXPECT_TRUE(in.readonly);
    EXPECT_FALSE(in.writeonly);
    EXPECT_EQ(in.bytes, 16U);  // up to the run-time array, which starts on a boundary of 16
    const Member& w = *find(in, "parts[].w");
    EXPECT_EQ(w.type.array, (std::vector<uint32_t>{0, 2}));
    EXPECT_EQ(w.strides, (std::vector<uint32_t>{32, 4}));
    EXPECT_EQ(w.offset, 28U);
    const Resource& out = *find(r, "Out");
    EXPECT_EQ(out.array, std::vector<uint32_t>{2});
    EXPECT_TRUE(out.writeonly);
    EXPECT_EQ(find(out, "data")->size, 0U);
    EXPECT_EQ(find(r, "img")->kind, ResourceKind::storage_image);
    EXPECT_EQ(find(r, "img")->format, 4U);  // Rgba8
    EXPECT_TRUE(find(r, "img")->readonly);
    EXPECT_EQ(find(r, "texels")->kind, ResourceKind::storage_texels);
    EXPECT_EQ(find(r, "texels")->sampled, BaseType::uint32);
}

TEST(Reflect, ImagesAndSamplers) {
    const Reflection r = reflection_of(Stage::fragment, R"(
layout(binding=0) uniform sampler2DShadow shadow;
layout(binding=1) uniform samplerCubeArray cubes;
layout(binding=2) uniform texture2D plain;
layout(binding=3) uniform sampler smp;
layout(binding=4) uniform texture2D depth_map;
layout(binding=5) uniform samplerShadow cmp;
layout(binding=6) uniform isampler3D volume;
layout(binding=7) uniform samplerBuffer texels;
layout(binding=8) uniform sampler2D many[3];
layout(binding=9, input_attachment_index=0) uniform subpassInput sub;
layout(binding=10) uniform sampler2DMS ms;
layout(location=0) out vec4 o;
void main() { o = vec4(texture(shadow, vec3(0))) + texture(cubes, vec4(0)) + texture(sampler2D(plain, smp), vec2(0))
                + texture(sampler2DShadow(depth_map, cmp), vec3(0)) + vec4(texture(volume, vec3(0))) + texelFetch(texels, 1)
                + texture(many[2], vec2(0)) + subpassLoad(sub) + texelFetch(ms, ivec2(0), 1); })");
    EXPECT_TRUE(find(r, "shadow")->depth);
    EXPECT_EQ(find(r, "cubes")->dim, ImageDim::cube);
    EXPECT_TRUE(find(r, "cubes")->arrayed);
    EXPECT_EQ(find(r, "plain")->kind, ResourceKind::separate_image);
    EXPECT_FALSE(find(r, "plain")->depth);
    EXPECT_EQ(find(r, "smp")->kind, ResourceKind::separate_sampler);
    EXPECT_FALSE(find(r, "smp")->depth);
    EXPECT_TRUE(find(r, "depth_map")->depth);
    EXPECT_TRUE(find(r, "cmp")->depth);
    EXPECT_EQ(find(r, "volume")->sampled, BaseType::int32);
    EXPECT_EQ(find(r, "volume")->dim, ImageDim::d3);
    EXPECT_EQ(find(r, "texels")->kind, ResourceKind::uniform_texels);
    EXPECT_EQ(find(r, "many")->array, std::vector<uint32_t>{3});
    EXPECT_EQ(find(r, "sub")->kind, ResourceKind::input_attachment);
    EXPECT_TRUE(find(r, "ms")->multisampled);
}

TEST(Reflect, VaryingsByLocation) {
    const Reflection r = reflection_of(Stage::vertex, R"(
layout(location=0) in vec3 at;
layout(location=1) in mat3 turn;
layout(location=4) in ivec2 ids;
layout(location=2) out Block { vec3 n; flat int k; mat2 m; layout(location=9) vec2 far_; } b;
layout(location=6, component=1) out vec2 uv;
layout(location=7) out vec4 arr[2];
struct S { vec3 a; vec2 c; };
layout(location=10) noperspective out S s;
void main() { gl_Position = vec4(turn * at, ids.x); b.n = at; b.k = 1; b.m = mat2(1); b.far_ = at.xy; uv = at.xy;
              arr[0] = vec4(1); arr[1] = vec4(2); s.a = at; s.c = at.xy; gl_PointSize = 1.0; })");
    ASSERT_EQ(r.inputs.size(), 3U);
    EXPECT_EQ(r.inputs[1].type.columns, 3);
    EXPECT_EQ(r.inputs[2].location, 4U);
    EXPECT_EQ(r.inputs[2].type.base, BaseType::int32);
    const struct {
        const char* name;
        uint32_t location, component;
        bool flat;
    } want[] = {{"Block.n", 2, 0, false}, {"Block.k", 3, 0, true},     {"Block.m", 4, 0, false}, {"uv", 6, 1, false},
                {"arr", 7, 0, false},     {"Block.far_", 9, 0, false}, {"s.a", 10, 0, false},    {"s.c", 11, 0, false}};
    ASSERT_EQ(r.outputs.size(), std::size(want));
    for (size_t i = 0; i < std::size(want); ++i) {
        EXPECT_EQ(r.outputs[i].name, want[i].name);
        EXPECT_EQ(r.outputs[i].location, want[i].location) << want[i].name;
        EXPECT_EQ(r.outputs[i].component, want[i].component) << want[i].name;
        EXPECT_EQ(r.outputs[i].flat, want[i].flat) << want[i].name;
    }
    EXPECT_TRUE(r.outputs[6].no_perspective);
}

TEST(Reflect, PushConstantsDepthAndDiscard) {
    const Reflection r = reflection_of(Stage::fragment, R"(
layout(push_constant) uniform Push { layout(offset=16) vec4 tint; float cut; };
layout(location=0) out vec4 o;
void main() { if (cut > 0.5) discard; gl_FragDepth = cut; o = tint; })");
    ASSERT_EQ(r.resources.size(), 1U);
    EXPECT_EQ(r.resources[0].kind, ResourceKind::push_constants);
    EXPECT_EQ(r.resources[0].name, "Push");
    EXPECT_EQ(r.resources[0].bytes, 36U);
    EXPECT_EQ(r.resources[0].members[0].offset, 16U);
    EXPECT_TRUE(r.writes_depth);
    EXPECT_TRUE(r.discards);
}

TEST(Reflect, PerVertexArraysAreLeftOut) {
    const Reflection r = reflection_of(Stage::geometry, R"(
layout(triangles) in; layout(triangle_strip, max_vertices=3) out;
layout(location=0) in vec4 a[]; layout(location=0) out vec4 b;
void main() { for (int i = 0; i < 3; ++i) { b = a[i]; gl_Position = gl_in[i].gl_Position; EmitVertex(); } })");
    ASSERT_EQ(r.inputs.size(), 1U);
    EXPECT_TRUE(r.inputs[0].type.array.empty());
}

TEST(Reflect, PerVertexInputsOfAFragmentStageTakeOneLocation) {
    const Reflection r = reflection_of(Stage::fragment, R"(
#extension GL_EXT_fragment_shader_barycentric : require
layout(location=0) pervertexEXT in vec2 a[3]; layout(location=1) pervertexEXT in vec2 b[3];
layout(location=0) out vec4 o;
void main() { o = vec4(a[0] * gl_BaryCoordEXT.x + a[1] * gl_BaryCoordEXT.y, b[2]); })");
    ASSERT_EQ(r.inputs.size(), 2U);
    EXPECT_TRUE(r.inputs[0].type.array.empty());
    EXPECT_TRUE(overlapping_varyings(r).empty());
}

TEST(Reflect, RefusesWhatCannotBeWalked) {
    const Words good = spirv_of(Stage::fragment, "layout(location=0) out vec4 o; void main() { o = vec4(1); }");
    ASSERT_TRUE(reflect_words(good).ok());
    for (size_t n = 0; n < good.size(); ++n) {
        const Words cut(good.begin(), good.begin() + static_cast<ptrdiff_t>(n));
        (void)reflect_words(cut);  // an error or not: some prefixes are whole instructions; never a crash
    }
    EXPECT_FALSE(reflect_words({}).ok());
    EXPECT_FALSE(reflect_words(Words{0x07230203, 0x10000, 0, 0, 0}).ok());
    Words two_entries = good;
    for (size_t at = 5; at < good.size(); at += good[at] >> 16)
        if ((good[at] & 0xffff) == 15) {
            two_entries.insert(two_entries.begin() + static_cast<ptrdiff_t>(at), good.begin() + static_cast<ptrdiff_t>(at),
                               good.begin() + static_cast<ptrdiff_t>(at + (good[at] >> 16)));
            break;
        }
    EXPECT_FALSE(reflect_words(two_entries).ok());
    for (size_t i = 5; i < good.size(); ++i)
        for (const uint32_t flip : {1U, 0x80000000U, 0x10000U, 0xffffffffU}) {
            Words bad = good;
            bad[i] ^= flip;
            (void)reflect_words(bad);
        }
}

TEST(Reflect, TypesThatContainThemselvesAreRefused) {
    // struct %2 { %3 }, struct %3 { %2 }
    const Words cycle = {0x07230203, 0x10000, 0, 8, 0, 4U << 16 | 15, 4, 1, 0x006e, 3U << 16 | 30, 2, 3, 3U << 16 | 30, 3, 2};
    EXPECT_FALSE(reflect_words(cycle).ok());
}

}  // namespace
}  // namespace kiln
