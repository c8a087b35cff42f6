// A contact sheet of a small table: every tile is drawn, and two runs give the same bytes.

#include "compiler/device/sheet.h"

#include "compiler/pass.h"
#include "tests/device/glsl.h"

namespace kiln::test {
namespace {

constexpr const char* manifest = R"(kiln: 1
name: tiny
targets: [spirv]
axes:
  tint: {macro: TINT, values: [none, red, blue]}
shaders:
  - name: tiny
    stages: {vertex: tiny.vert, fragment: tiny.frag}
)";
constexpr const char* vertex_text = R"(#version 450
layout(set = 0, binding = 0) uniform View { mat4 view_projection; };
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 0) out vec3 n;
void main() { gl_Position = view_projection * vec4(position, 1.0); n = normal; }
)";
constexpr const char* fragment_text = R"(#version 450
layout(set = 0, binding = 1) uniform Light { vec3 light_direction; vec3 light_intensity; };
layout(location = 0) in vec3 n;
layout(location = 0) out vec4 c;
void main() {
    c = vec4(light_intensity * max(dot(n, -light_direction), 0.0) / 3.14, 1.0);
#if TINT == 1
    c.gb *= 0.1;
#elif TINT == 2
    c.rg *= 0.1;
#endif
}
)";

TEST(Sheet, DrawsEveryVariantTheSameEveryTime) {
    MemoryFiles files({{"tiny.yaml", manifest}, {"tiny.vert", vertex_text}, {"tiny.frag", fragment_text}});
    MemoryStore store;
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    const Jobs jobs(1);
    PassContext context{files, store, *tools, jobs, {}};
    BuildOptions build_options;
    build_options.manifest = "tiny.yaml";
    const Build build = run_pass(build_options, context);
    ASSERT_TRUE(build.ok());
    SheetOptions options;
    options.tile = 48;
    const Result<Sheet> sheet = render_sheet(build.files.table, options, device(), *tools);
    ASSERT_TRUE(sheet.ok()) << sheet.error().message;
    EXPECT_EQ(sheet->tiles, 3u);
    EXPECT_EQ(sheet->undrawn, 0u);
    EXPECT_EQ(sheet->failed, 0u) << sheet->summary;
    ASSERT_GT(sheet->png.size(), 100u);
    EXPECT_EQ(sheet->png[1], 'P');
    const Result<Sheet> again = render_sheet(build.files.table, options, device(), *tools);
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(again->png, sheet->png);
    options.variants = {"tint=blue", "tint=blu"};
    const Result<Sheet> wrong = render_sheet(build.files.table, options, device(), *tools);
    ASSERT_FALSE(wrong.ok());
    EXPECT_NE(wrong.error().message.find("did you mean 'blue'"), std::string::npos) << wrong.error().message;
}

}  // namespace
}  // namespace kiln::test
