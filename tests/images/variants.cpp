#include "tests/images/variants.h"

#include "compiler/device/compute.h"
#include "compiler/pass.h"
#include "compiler/validate/validate_tasks.h"
#include "tests/device/glsl.h"

namespace kiln::test {

using namespace reference;

namespace {

std::string text_of(const std::string& path, const std::string& defines) {
    DiskFiles files;
    const Result<std::optional<std::string>> read = files.read(std::string(KILN_SOURCE_DIR) + "/" + path);
    EXPECT_TRUE(read.ok() && *read) << path;
    std::string out;
    if (!read.ok() || !*read) return out;
    for (size_t at = 0; at < (*read)->size();) {
        const size_t end = std::min((*read)->find('\n', at), (*read)->size());
        const std::string line = (*read)->substr(at, end - at);
        at = end + 1;
        if (line.rfind("#include", 0) == 0) {
            const size_t open = line.find('"') + 1;
            out += text_of(join_path(folder_of(path), line.substr(open, line.rfind('"') - open)), "");
        } else {
            out += line + "\n";
        }
        if (line.rfind("#version", 0) == 0) out += defines;
    }
    return out;
}

// By the manifest's order of values.
int place_of(const std::string& value, std::initializer_list<const char*> values) {
    int i = 0;
    for (const char* v : values) {
        if (value == v) return i;
        ++i;
    }
    ADD_FAILURE() << "no axis value " << value;
    return 0;
}

struct AxisText {
    const char* axis;
    const char* macro;
    std::initializer_list<const char*> values;
};
constexpr std::initializer_list<const char*> light_values = {"none", "directional", "point", "spot"},
                                             pass_values = {"forward", "gbuffer", "depth", "velocity"},
                                             material_values = {"blinn_phong", "pbr_mr", "pbr_sg"},
                                             lightmap_values = {"none", "flat", "sh_lq", "sh_hq"},
                                             bool_values = {"false", "true"}, shadow_values = {"none", "hard"};

std::string value_of(const Values& values, const std::string& axis, const std::string& otherwise) {
    const auto found = values.find(axis);
    return found == values.end() ? otherwise : found->second;
}

int place_of(const Values& values, const std::string& axis, std::initializer_list<const char*> names) {
    return place_of(value_of(values, axis, *names.begin()), names);
}

}  // namespace

std::vector<Variant> pipelines_of(const std::string& manifest) {
    std::vector<Variant> out;
    DiskFiles files;
    MemoryStore store;
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    const Jobs jobs(2);
    PassContext context{files, store, *tools, jobs, {}};
    BuildOptions options;
    options.manifest = std::string(KILN_SOURCE_DIR) + "/manifests/" + manifest;
    options.targets = {Target::spirv};
    const Build build = run_pass(options, context);
    EXPECT_TRUE(build.ok()) << manifest;
    if (!build.ok()) return out;
    Result<std::unique_ptr<TableView>> table = TableView::open(build.files.table);
    EXPECT_TRUE(table.ok());
    if (!table.ok()) return out;
    TaskMaker maker(**table, nullptr, *tools);
    for (TableShader& shader : (*table)->shaders())
        for (const TablePipeline& pipeline : shader.pipelines) {
            Result<Task> task = maker.make(shader, pipeline);
            EXPECT_TRUE(task.ok()) << (task.ok() ? "" : task.error().message);
            if (!task.ok()) return out;
            Variant v;
            v.name = shader.space.describe_variant(pipeline.witness);
            for (size_t a = 0; a < shader.space.axes.size(); ++a)
                v.values[shader.space.axes[a].name] = shader.space.axes[a].values[pipeline.witness[a]].name;
            for (const StagePtr& s : task->job.optimised) v.stages.push_back(*s);
            out.push_back(std::move(v));
        }
    return out;
}

Variant surface_variant(const Values& values, const std::vector<std::pair<std::string, std::string>>& edits) {
    const std::pair<std::string, int> macros[] = {
        {"LIGHT_TYPE", place_of(values, "light", light_values)},     {"PASS", place_of(values, "pass", pass_values)},
        {"MATERIAL", place_of(values, "material", material_values)}, {"LIGHTMAP", place_of(values, "lightmap", lightmap_values)},
        {"TWO_SIDED", place_of(values, "two_sided", bool_values)},   {"SHADOW", place_of(values, "shadow", shadow_values)}};
    std::string defines;
    for (const auto& [macro, number] : macros) defines += "#define " + macro + " " + std::to_string(number) + "\n";
    Variant out;
    out.values = values;
    std::string fragment_text = text_of("uber/surface.frag", defines);
    for (const auto& [from, to] : edits) {
        // Everywhere: of alike texts in files that the variant's axes leave out, none counts.
        size_t at = fragment_text.find(from);
        EXPECT_NE(at, std::string::npos) << "the shader has no text '" << from << "'";
        for (; at != std::string::npos; at = fragment_text.find(from, at + to.size())) fragment_text.replace(at, from.size(), to);
    }
    for (const auto& [stage, text] :
         {std::pair{Stage::vertex, text_of("uber/surface.vert", defines)}, {Stage::fragment, fragment_text}})
        out.stages.push_back(compile(stage, text));
    return out;
}

SurfaceAxes axes_of(const Values& values) {
    SurfaceAxes a;
    a.light = static_cast<SurfaceLight>(place_of(values, "light", light_values));
    a.material = static_cast<SurfaceMaterial>(place_of(values, "material", material_values));
    a.lightmap = static_cast<SurfaceLightmap>(place_of(values, "lightmap", lightmap_values));
    a.two_sided = place_of(values, "two_sided", bool_values) == 1;
    a.shadow = place_of(values, "shadow", shadow_values) == 1;
    return a;
}

std::vector<RunOutput> draw(const std::vector<StageCode>& stages, const std::vector<NamedInputs>& inputs, uint32_t size) {
    PipelineRequest request;
    request.stages = stages;
    request.size = size;
    request.depth_test = true;
    for (const NamedInputs& in : inputs) request.inputs.push_back(bound(stages, in));
    Result<PipelineOutput> out = device().run(request);
    std::vector<RunOutput> runs;
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    if (out.ok()) {
        EXPECT_TRUE(out->errors.empty()) << out->errors.front();
        EXPECT_EQ(out->unsupported, "");
        EXPECT_EQ(out->runs.size(), inputs.size());
        runs = std::move(out->runs);
    }
    runs.resize(inputs.size());
    return runs;
}

Points drawn_points(const StageCode& vertex, const NamedInputs& inputs, const Points& reference) {
    std::string text = "#version 450\n", body;
    uint32_t outputs = 0;
    for (const Varying& v : vertex.reflection.outputs) {
        const std::string type = "vec" + std::to_string(v.type.rows), at = std::to_string(v.location);
        text += "layout(location = " + at + ") in " + type + " v" + at + ";\nlayout(location = " + std::to_string(outputs) +
                ") out vec4 c" + at + ";\n";
        const char* rest[] = {"", ", 0.0, 0.0, 0.0", ", 0.0, 0.0", ", 0.0", ""};
        body += "    c" + at + " = vec4(v" + at + rest[v.type.rows] + ");\n";
        ++outputs;
    }
    text += "layout(location = " + std::to_string(outputs) + ") out vec4 facing;\nvoid main() {\n" + body +
            "    facing = vec4(gl_FrontFacing ? 1.0 : 2.0);\n}\n";
    const RunOutput run = draw({vertex, compile(Stage::fragment, text)}, {inputs}, reference.size).front();
    Points out = reference;
    const ReadBack* facing = output(run, "output " + std::to_string(outputs));
    EXPECT_NE(facing, nullptr);
    if (facing == nullptr) return out;
    for (size_t i = 0; i < out.at.size(); ++i) {
        Points::Point& p = out.at[i];
        const float side = as_float(facing->words[4 * i]);
        if (side == 0) p.silhouette = true;
        p.front = side == 1.0f;
        uint32_t o = 0;
        for (const Varying& v : vertex.reflection.outputs) {
            const ReadBack* read = output(run, "output " + std::to_string(o++));
            double x[4], largest = 0;
            for (size_t c = 0; c < 4; ++c) {
                x[c] = static_cast<double>(as_float(read->words[4 * i + c]));
                largest = std::max(largest, std::fabs(x[c]));
            }
            const auto take = [&](auto... components) {
                size_t c = 0;
                const auto one = [&](Bounded* to) {
                    *to = Bounded(x[c++], p.body < 0 ? 0 : std::min(4 * bounds::ulp * largest, to->error));
                };
                (one(components), ...);
            };
            SurfaceVaryings<Bounded>& in = p.in;
            if (v.name == "world_position") take(&in.world_position.x, &in.world_position.y, &in.world_position.z);
            if (v.name == "world_normal") take(&in.world_normal.x, &in.world_normal.y, &in.world_normal.z);
            if (v.name == "material_uv") take(&in.material_uv.x, &in.material_uv.y);
            if (v.name == "atlas_uv") take(&in.atlas_uv.x, &in.atlas_uv.y);
            for (const auto& [name, to] :
                 {std::pair{"clip_position", &in.clip_position}, {"previous_clip_position", &in.previous_clip_position}})
                if (v.name == name) take(&to->x, &to->y, &to->z, &to->w);
        }
    }
    return out;
}

std::map<std::string, Expect> expectations(const Values& values, const Scene& from) {
    const SurfaceAxes axes = axes_of(values);
    const std::string pass = value_of(values, "pass", "forward");
    std::map<std::string, Expect> out;
    out["depth"] = [](const Points::Point& p) { return std::vector{p.depth}; };
    if (pass == "forward")
        out["output 0"] = [axes, &from](const Points::Point& p) {
            const Vec3<Bounded> c = surface_radiance(axes, from.blocks, from.maps, p.in, p.front);
            return std::vector{c.x, c.y, c.z, Bounded(1)};
        };
    if (pass == "velocity")
        out["output 0"] = [&from](const Points::Point& p) {
            const Vec2<Bounded> m = surface_velocity(from.blocks, p.in);
            return std::vector{m.x, m.y};
        };
    if (pass == "gbuffer") {
        const auto part = [&](auto pick) {
            return [axes, &from, pick](const Points::Point& p) {
                return pick(surface_gbuffer(axes, from.blocks, from.maps, p.in, p.front));
            };
        };
        const auto four = [](const Vec4<Bounded>& v) { return std::vector{v.x, v.y, v.z, v.w}; };
        using G = SurfaceGbuffer<Bounded>;
        out["output 0"] = part([four](const G& g) { return four(g.diffuse); });
        out["output 1"] = part([four](const G& g) { return four(g.specular); });
        out["output 2"] = part([](const G& g) { return std::vector{g.normal.x, g.normal.y}; });
        out["output 3"] = part([four](const G& g) { return four(g.radiance); });
    }
    return out;
}

}  // namespace kiln::test
