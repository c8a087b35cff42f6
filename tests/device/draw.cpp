// What the device draws, binds and reads back.

#include <cmath>
#include <cstring>

#include "compiler/validate/partner.h"
#include "tests/device/glsl.h"

namespace kiln::test {
namespace {

float as_float(uint32_t w) {
    float v;
    std::memcpy(&v, &w, 4);
    return v;
}

PipelineOutput run(const PipelineRequest& request) {
    Result<PipelineOutput> out = device().run(request);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? std::move(*out) : PipelineOutput();
}

void expect_clean(const PipelineOutput& out, size_t runs = 2) {
    EXPECT_TRUE(out.errors.empty()) << out.errors.front();
    EXPECT_EQ(out.unsupported, "");
    EXPECT_EQ(out.runs.size(), runs);
}

TEST(Draw, NamesTheDevice) {
    const DeviceInfo& info = device().info();
    EXPECT_NE(info.name.find("llvmpipe"), std::string::npos) << info.name;
    EXPECT_NE(info.layers.find("VK_LAYER_KHRONOS_validation"), std::string::npos);
    EXPECT_NE(info.settings.find("no_aos_sampling"), std::string::npos);
}

TEST(Draw, GridCoversNearlyEverything) {
    const PipelineOutput out = run(request_of(
        {plain_vertex(), fragment("layout(location = 0) out vec4 c;\nvoid main() { c = vec4(0.25, 0.5, 0.75, 1.0); }\n")}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    EXPECT_GT(out.runs[0].covered, 64u * 64u * 85 / 100);
    const ReadBack& colour = out.runs[0].values.at(0);
    const size_t middle = (32 * 64 + 32) * 4;
    EXPECT_EQ(as_float(colour.words.at(middle)), 0.25f);
    EXPECT_EQ(as_float(colour.words.at(middle + 2)), 0.75f);
    EXPECT_EQ(as_float(colour.words.at(0)), 0.0f) << "outside the grid stays cleared";
}

TEST(Draw, BothFacings) {
    const PipelineOutput out = run(request_of(
        {plain_vertex(), fragment("layout(location = 0) out uint side;\nvoid main() { side = gl_FrontFacing ? 1u : 2u; }\n")}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    const ReadBack& side = out.runs[0].values.at(0);
    uint64_t front = 0, back = 0;
    for (size_t i = 0; i < side.words.size(); i += 4) front += side.words[i] == 1, back += side.words[i] == 2;
    EXPECT_GT(front, 1000u);
    EXPECT_GT(back, 1000u);
}

TEST(Draw, PartialOutputsKeepTheClearedComponents) {
    const PipelineOutput out = run(request_of(
        {plain_vertex(),
         fragment("layout(location = 2) out vec2 a;\nlayout(location = 0) out int b;\nvoid main() { a = vec2(1.0, 2.0); b = "
                  "-7; }\n")}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    ASSERT_EQ(out.runs[0].values.size(), 3u);
    const size_t middle = (32 * 64 + 32) * 4;
    EXPECT_EQ(out.runs[0].values[0].what, "output 0");
    EXPECT_EQ(out.runs[0].values[0].words.at(middle), static_cast<uint32_t>(-7));
    EXPECT_EQ(out.runs[0].values[1].what, "output 2");
    EXPECT_EQ(as_float(out.runs[0].values[1].words.at(middle + 1)), 2.0f);
    EXPECT_EQ(as_float(out.runs[0].values[1].words.at(middle + 3)), 0.0f);
}

// Every kind of descriptor in one fragment stage; each contributes something that is not zero.
TEST(Draw, EveryKindOfResource) {
    const std::string text = R"(
layout(set = 0, binding = 0) uniform Block { mat4 m; vec3 v; float f; int i; float list[3]; } block;
layout(set = 0, binding = 1) uniform sampler2D t2;
layout(set = 0, binding = 2) uniform samplerCube tc;
layout(set = 0, binding = 3) uniform sampler2DArray ta;
layout(set = 0, binding = 4) uniform sampler3D t3;
layout(set = 0, binding = 5) uniform sampler2DShadow ts;
layout(set = 0, binding = 6) uniform sampler2DArrayShadow tas;
layout(set = 0, binding = 7) uniform samplerCubeShadow tcs;
layout(set = 0, binding = 8) uniform usampler2D tu;
layout(set = 0, binding = 9) uniform sampler1D t1;
layout(set = 0, binding = 10) uniform sampler2DMS tm;
layout(set = 0, binding = 11) uniform samplerCubeArray tca;
layout(set = 1, binding = 0) uniform texture2D image;
layout(set = 1, binding = 1) uniform sampler smooth_sampler;
layout(set = 1, binding = 2) uniform samplerShadow compare_sampler;
layout(set = 1, binding = 3) uniform texture2D depth_image;
layout(set = 1, binding = 4) uniform samplerBuffer texels;
layout(set = 1, binding = 5, rgba32f) uniform imageBuffer texels_out;
layout(set = 1, binding = 6, rgba16f) uniform image2D picture;
layout(set = 1, binding = 7, r32ui) uniform uimage2D counter;
layout(set = 1, binding = 8) uniform sampler2D several[3];
layout(set = 3, binding = 2) buffer Out { uint hits; float value; vec4 tail[]; } result;
layout(set = 3, binding = 3) readonly buffer In { vec4 head; float tail[]; } source;
layout(push_constant) uniform Push { vec4 tint; } push;
layout(location = 0) out vec4 a;
layout(location = 1) out vec4 b;
layout(location = 2) out vec4 c;
layout(location = 3) out vec4 d;
void main() {
    vec2 uv = gl_FragCoord.xy / 64.0;
    a = vec4(texture(t2, uv).r, texture(tc, vec3(uv, 0.5)).r, texture(ta, vec3(uv, 1.0)).r, texture(t3, vec3(uv, 0.5)).r);
    b = vec4(texture(ts, vec3(uv, 0.3)) + 0.1, texture(tas, vec4(uv, 1.0, 0.3)) + 0.1, texture(tcs, vec4(uv, 0.5, 0.3)) + 0.1,
             float(texture(tu, uv).r) + 1.0);
    c = vec4(texture(t1, uv.x).r, texelFetch(tm, ivec2(3), 1).r, texture(tca, vec4(uv, 0.5, 1.0)).r,
             texture(sampler2D(image, smooth_sampler), uv).r);
    d = vec4(texture(sampler2DShadow(depth_image, compare_sampler), vec3(uv, 0.3)) + 0.1, texelFetch(texels, 5).r,
             imageLoad(picture, ivec2(gl_FragCoord.xy)).r, texture(several[2], uv).r);
    a *= block.f * length(block.v) * block.m[1][1] * block.list[2] * push.tint.x;
    b *= source.head.x * source.tail[3];
    if (ivec2(gl_FragCoord.xy) == ivec2(32, 32)) {
        atomicAdd(result.hits, 5u);
        result.value = 2.5;
        result.tail[1] = vec4(7.0);
        imageStore(texels_out, 9, vec4(3.0));
        imageStore(picture, ivec2(1, 2), vec4(0.5));
        imageAtomicAdd(counter, ivec2(4, 5), 9u);
    }
}
)";
    const PipelineOutput out = run(request_of({plain_vertex(), fragment(text)}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    const auto find = [&](const std::string& what) -> const ReadBack& {
        for (const ReadBack& r : out.runs[0].values)
            if (r.what == what) return r;
        ADD_FAILURE() << "nothing read back as '" << what << "'";
        return out.runs[0].values.front();
    };
    const size_t middle = (31 * 64 + 31) * 4;
    for (unsigned o = 0; o < 4; ++o)
        for (size_t i = 0; i < 4; ++i)
            EXPECT_GT(as_float(find("output " + std::to_string(o)).words.at(middle + i)), 1e-4f)
                << "output " << o << " component " << i;
    EXPECT_EQ(as_float(find("buffer Out").words.at(1)), 2.5f);
    EXPECT_EQ(as_float(find("buffer Out").words.at(8)), 7.0f);
    EXPECT_EQ(as_float(find("buffer texels_out").words.at(36)), 3.0f);
    EXPECT_EQ(as_float(find("image picture").words.at((2 * 64 + 1) * 4)), 0.5f);
    EXPECT_GE(find("image counter").words.at(5 * 64 + 4), 9u);
    EXPECT_EQ(find("buffer Out").types.at(0), BaseType::uint32);
    EXPECT_EQ(find("buffer Out").types.at(1), BaseType::float32);
}

TEST(Draw, Compute) {
    const std::string text = R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, r11f_g11f_b10f) uniform image2D picture;
layout(set = 0, binding = 1) buffer Out { uint sum; } result;
shared uint part;
void main() {
    if (gl_LocalInvocationIndex == 0u) part = 0u;
    barrier();
    atomicAdd(part, 1u);
    barrier();
    if (gl_LocalInvocationIndex == 0u) atomicAdd(result.sum, part);
    imageStore(picture, ivec2(gl_GlobalInvocationID.xy), vec4(0.25, 0.5, 1.0, 1.0));
}
)";
    const PipelineRequest request = request_of({compute(text)});
    const PipelineOutput out = run(request);
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    EXPECT_EQ(out.runs[0].covered, 64u);
    for (const ReadBack& r : out.runs[0].values) {
        if (r.what == "image picture") {
            EXPECT_EQ(as_float(r.words.at(3 * 1000)), 0.25f);
        } else if (r.what == "buffer Out") {
            EXPECT_EQ(r.words.at(0), 64u * 64u + request.inputs[0].bindings[1].buffers[0][0]);
        }
    }
}

TEST(Draw, InputAttachment) {
    const PipelineOutput out = run(request_of({plain_vertex(), fragment(R"(
layout(input_attachment_index = 1, set = 0, binding = 4) uniform subpassInput before;
layout(location = 0) out vec4 c;
void main() { c = subpassLoad(before); }
)")}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    EXPECT_GT(as_float(out.runs[0].values.at(0).words.at((32 * 64 + 32) * 4)), 0.0f);
}

TEST(Draw, MultisampledInputAttachmentBesideAPlainOne) {
    const PipelineOutput out = run(request_of({plain_vertex(), fragment(R"(
layout(input_attachment_index = 0, set = 0, binding = 0) uniform subpassInput before;
layout(input_attachment_index = 1, set = 0, binding = 1) uniform subpassInputMS samples;
layout(location = 0) out vec4 c;
void main() { c = subpassLoad(before) + subpassLoad(samples, 3); }
)")}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    EXPECT_GT(as_float(out.runs[0].values.at(0).words.at((32 * 64 + 32) * 4)), 0.0f);
}

TEST(Draw, TessellationAndGeometry) {
    const StageCode control = compile(Stage::tess_control, R"(#version 450
layout(vertices = 3) out;
void main() {
    gl_out[gl_InvocationID].gl_Position = gl_in[gl_InvocationID].gl_Position;
    gl_TessLevelOuter[0] = gl_TessLevelOuter[1] = gl_TessLevelOuter[2] = 2.0;
    gl_TessLevelInner[0] = 2.0;
}
)");
    const StageCode evaluation = compile(Stage::tess_evaluation, R"(#version 450
layout(triangles) in;
void main() {
    gl_Position = gl_in[0].gl_Position * gl_TessCoord.x + gl_in[1].gl_Position * gl_TessCoord.y + gl_in[2].gl_Position * gl_TessCoord.z;
}
)");
    const StageCode geometry = compile(Stage::geometry, R"(#version 450
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
layout(location = 0) out vec3 colour;
void main() {
    for (int i = 0; i < 3; ++i) { gl_Position = gl_in[i].gl_Position; colour = vec3(0.5); EmitVertex(); }
    EndPrimitive();
}
)");
    const PipelineOutput out = run(request_of(
        {plain_vertex(), control, evaluation, geometry,
         fragment("layout(location = 0) in vec3 colour;\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(colour, "
                  "1.0); }\n")}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    EXPECT_GT(out.runs[0].covered, 3000u);
}

TEST(Draw, PartnersFeedAndShowEveryType) {
    const StageCode lone = fragment(R"(
layout(location = 0) in vec3 a;
layout(location = 1) flat in ivec2 b;
layout(location = 2) in mat3 c;
layout(location = 5) in float d[2];
layout(location = 7, component = 2) in vec2 e;
layout(location = 8) flat in uint f;
layout(location = 9) noperspective in vec4 g;
layout(location = 0) out vec4 o;
void main() { o = vec4(a.x + c[2][1], d[1] + e.y, g.z, float(b.y) + float(f) + 1.0); }
)");
    StageCode made = compile(Stage::vertex, vertex_partner(lone.reflection.inputs));
    made.partner = true;
    const PipelineOutput out = run(request_of({made, lone}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    EXPECT_EQ(out.runs[0].covered, 64u * 64u);
    const ReadBack& o = out.runs[0].values.at(0);
    float least = 1e9f, most = -1e9f;
    for (size_t i = 0; i < o.words.size(); i += 4)
        least = std::min(least, as_float(o.words[i])), most = std::max(most, as_float(o.words[i]));
    EXPECT_GT(least, 0.1f);
    EXPECT_GT(most, least + 0.2f) << "the patch must vary";

    const StageCode lone_vertex = vertex(R"(
layout(location = 0) in vec3 position;
layout(location = 0) out vec3 a;
layout(location = 1) flat out ivec2 b;
layout(location = 2) out mat2 c;
void main() { gl_Position = vec4(position.xy, 0.5, 1.0); a = position * 0.5 + 0.5; b = ivec2(3); c = mat2(2.0); }
)");
    const PipelineOutput shown =
        run(request_of({lone_vertex, compile(Stage::fragment, fragment_partner(lone_vertex.reflection.outputs, 8))}));
    expect_clean(shown);
    ASSERT_EQ(shown.runs.size(), 2u);
    ASSERT_EQ(shown.runs[0].values.size(), 5u) << "four outputs and depth";
    EXPECT_EQ(as_float(shown.runs[0].values[2].words.at((32 * 64 + 32) * 4)), 2.0f);
}

TEST(Draw, DepthOnly) {
    const PipelineOutput out = run(request_of({plain_vertex(), compile(Stage::fragment, fragment_partner({}, 8))}));
    expect_clean(out);
    ASSERT_EQ(out.runs.size(), 2u);
    ASSERT_EQ(out.runs[0].values.size(), 1u);
    EXPECT_EQ(as_float(out.runs[0].values[0].words.at(32 * 64 + 32)), 0.5f);
    EXPECT_GT(out.runs[0].covered, 3000u);
}

TEST(Draw, TwiceIsTheSame) {
    const std::vector<StageCode> stages = {
        plain_vertex(),
        fragment("layout(binding = 3) uniform sampler2D t;\nlayout(binding = 0) uniform B { vec4 v; };\nlayout(location = 0) "
                 "out vec4 c;\nvoid main() { c = texture(t, gl_FragCoord.xy / 50.0) * v; }\n")};
    const PipelineOutput first = run(request_of(stages)), second = run(request_of(stages)), other = run(request_of(stages, 2));
    ASSERT_EQ(first.runs.size(), 2u);
    ASSERT_EQ(second.runs.size(), 2u);
    for (size_t r = 0; r < 2; ++r)
        for (size_t v = 0; v < first.runs[r].values.size(); ++v)
            EXPECT_EQ(first.runs[r].values[v].words, second.runs[r].values[v].words);
    EXPECT_NE(first.runs[0].values[0].words, other.runs[0].values[0].words) << "the seed matters";
    EXPECT_NE(first.runs[0].values[0].words, first.runs[1].values[0].words) << "the two sets of inputs differ";
}

// Valid words that the driver's parser may not know run, or are the device's limit; they never fail.
TEST(Draw, CopiesOfStructuresRunOrAreUnsupported) {
    Options options;
    options.vulkan = 0x102;
    options.spirv = 0x105;
    const Compiled copy = glsl_compile(Stage::fragment, R"(#version 450
struct M { vec4 tint; uint n; };
layout(set = 0, binding = 0, std140) uniform B { M m[4]; };
layout(location = 0) out vec4 c;
void main() { M one = m[1]; c = one.tint * float(one.n); }
)",
                                       options);
    ASSERT_FALSE(copy.words.empty());
    const PipelineOutput out = run(request_of({plain_vertex(), stage_of(copy.words)}));
    EXPECT_TRUE(out.errors.empty()) << out.errors.front();
    EXPECT_NE(out.unsupported.empty(), out.runs.empty());
}

TEST(Draw, MeshAndRayStagesAreUnsupportedNotFailed) {
    StageCode s = plain_vertex();
    s.stage = Stage::raygen;
    EXPECT_NE(run(request_of({s})).unsupported, "");
}

}  // namespace
}  // namespace kiln::test
