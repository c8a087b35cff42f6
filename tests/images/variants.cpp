#include "tests/images/variants.h"

#include <set>

#include "compiler/device/compute.h"
#include "compiler/pass.h"
#include "compiler/toolchain/spirv.h"
#include "compiler/validate/validate_tasks.h"
#include "tests/device/glsl.h"
#include "tests/device/uber_text.h"
#include "uber/reference/random.h"

namespace kiln::test {

using namespace reference;

namespace {

// As the pass makes it: pruned and optimised.
StageCode shipped(Stage stage, const std::string& text) {
    const Options options;
    const Compiled raw = glsl_compile(stage, text, options);
    EXPECT_FALSE(raw.words.empty()) << (raw.messages.empty() ? "" : raw.messages.front().text);
    if (raw.words.empty()) return {};
    const Result<Words> pruned = spirv_prune(raw.words, options);
    EXPECT_TRUE(pruned.ok()) << (pruned.ok() ? "" : pruned.error().message);
    if (!pruned.ok()) return {};
    const Result<Words> words = spirv_optimise(*pruned, options);
    EXPECT_TRUE(words.ok()) << (words.ok() ? "" : words.error().message);
    return words.ok() ? stage_of(*words) : StageCode();
}

// The manifest with its spaces, kept.
const Build& spaces_of(const std::string& manifest) {
    static std::map<std::string, Build> known;
    const auto found = known.find(manifest);
    if (found != known.end()) return found->second;
    DiskFiles files;
    MemoryStore store;
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    const Jobs jobs(1);
    PassContext context{files, store, *tools, jobs, {}};
    BuildOptions options;
    options.manifest = std::string(KILN_SOURCE_DIR) + "/manifests/" + manifest;
    Build& build = known[manifest];
    pass_spaces(build, options, context);
    EXPECT_TRUE(build.ok()) << manifest;
    return build;
}

// A shader of a manifest, and its variants.
std::pair<const Shader*, Space*> find_shader(const std::string& manifest, const std::string& name) {
    const Build& build = spaces_of(manifest);
    for (size_t i = 0; build.manifest && i < build.manifest->shaders.size() && i < build.spaces.size(); ++i)
        if (build.manifest->shaders[i].name == name) return {&build.manifest->shaders[i], build.spaces[i].get()};
    ADD_FAILURE() << manifest << " has no shader " << name;
    return {};
}

int place_of(const Values& values, const std::string& axis, std::initializer_list<const char*> names) {
    const auto found = values.find(axis);
    if (found == values.end()) return 0;
    int i = 0;
    for (const char* v : names) {
        if (found->second == v) return i;
        ++i;
    }
    ADD_FAILURE() << "axis " << axis << " has no value " << found->second;
    return 0;
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

Variant variant_of(const std::string& manifest, const std::string& shader, const Values& values, const Edits& edits) {
    const auto [from, space] = find_shader(manifest, shader);
    Variant out;
    out.values = values;
    if (from == nullptr) return out;
    std::string defines;
    for (const auto& [macro, body] : from->defines) defines += "#define " + macro + " " + body + "\n";
    for (const Axis& axis : space->axes) {
        const auto wanted = values.find(axis.name);
        const AxisValue* value = &axis.values.front();
        for (const AxisValue& v : axis.values)
            if (wanted != values.end() && v.name == wanted->second) value = &v;
        EXPECT_TRUE(wanted == values.end() || value->name == wanted->second) << axis.name << " " << wanted->second;
        out.values[axis.name] = value->name;
        if (axis.kind != AxisKind::defined || value->number != 0)
            defines += "#define " + axis.macro + " " + std::to_string(value->number) + "\n";
        out.name += (out.name.empty() ? "" : " ") + axis.name + "=" + value->name;
    }
    for (const StageFile& file : from->stages) {
        std::string text = uber_text(file.file, defines);
        for (const auto& [what, by] : edits) {
            if (file.stage != Stage::fragment) continue;
            size_t at = text.find(what);
            EXPECT_NE(at, std::string::npos) << "the shader has no text '" << what << "'";
            for (; at != std::string::npos; at = text.find(what, at + by.size())) text.replace(at, what.size(), by);
        }
        out.stages.push_back(shipped(file.stage, text));
    }
    return out;
}

std::vector<Values> pairwise(const std::string& manifest, const std::string& shader, uint64_t seed) {
    const auto [from, space] = find_shader(manifest, shader);
    std::vector<Values> out;
    if (from == nullptr) return out;
    std::set<std::array<size_t, 4>> seen;
    reference::Random random(seed);
    Diagram& diagram = *space->diagram;
    const auto digits = [&axes = space->axes](size_t axis) { return static_cast<uint32_t>(axes[axis].values.size()); };
    for (uint32_t a = 0; a < space->axes.size(); ++a)
        for (uint32_t b = a; b < space->axes.size(); ++b)
            for (uint32_t i = 0; i < digits(a); ++i)
                for (uint32_t j = 0; j < digits(b); ++j) {
                    if (seen.count({a, i, b, j}) != 0 || (a == b && i != j)) continue;
                    const Set both = diagram.both(space->legal, diagram.both(diagram.where(a, i), diagram.where(b, j)));
                    const Count count = diagram.count(both);
                    if (count == Count()) continue;
                    const double place = random() * std::stod(count.decimal());
                    std::optional<Digits> one = diagram.unrank(both, Count(static_cast<uint64_t>(place)));
                    if (!one) one = diagram.witness(both);
                    Values values;
                    for (size_t x = 0; x < one->size(); ++x) values[space->axes[x].name] = space->axes[x].values[(*one)[x]].name;
                    for (size_t x = 0; x < one->size(); ++x)
                        for (size_t y = x; y < one->size(); ++y) seen.insert({x, (*one)[x], y, (*one)[y]});
                    out.push_back(values);
                }
    return out;
}

std::vector<Values> legal(const std::string& manifest, const std::string& shader) {
    const auto [from, space] = find_shader(manifest, shader);
    std::vector<Values> out;
    if (from == nullptr) return out;
    for (uint64_t rank = 0;; ++rank) {
        const std::optional<Digits> one = space->diagram->unrank(space->legal, Count(rank));
        if (!one) return out;
        Values& values = out.emplace_back();
        for (size_t x = 0; x < one->size(); ++x) values[space->axes[x].name] = space->axes[x].values[(*one)[x]].name;
    }
}

SurfaceAxes axes_of(const Values& values) {
    SurfaceAxes a;
    const auto yes = [&](const char* axis) { return place_of(values, axis, {"false", "true"}) == 1; };
    a.light = static_cast<SurfaceLight>(place_of(values, "light", {"none", "directional", "point", "spot"}));
    a.material = static_cast<SurfaceMaterial>(
        place_of(values, "material",
                 {"blinn_phong", "pbr_mr", "pbr_sg", "disney", "blinn_phong_raw", "blinn_phong_lecture", "pbr_lecture"}));
    a.lightmap = static_cast<SurfaceLightmap>(place_of(values, "lightmap", {"none", "flat", "sh_lq", "sh_hq", "sh_lecture"}));
    a.shadow = static_cast<SurfaceShadow>(
        place_of(values, "shadow", {"none", "hard", "pcf3", "pcf5", "pcf7", "pcss", "vsm", "vssm", "lecture"}));
    a.probes = static_cast<SurfaceProbes>(place_of(values, "probes", {"none", "sh_l1", "sh_l2"}));
    a.reflection = static_cast<SurfaceReflection>(place_of(values, "reflection", {"none", "box", "blended"}));
    a.cascades = 1 + place_of(values, "cascades", {"1", "2", "3", "4"});
    a.ibl = place_of(values, "ibl", {"none", "split_sum"}) == 1;
    a.two_sided = yes("two_sided");
    a.alpha_test = yes("alpha_test");
    a.normal_map = yes("normal_map");
    a.hammon = place_of(values, "geometry", {"height_correlated", "hammon"}) == 1;
    a.mediump = place_of(values, "precision", {"fp32", "mediump"}) == 1;
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
            for (const auto& [name, to] : {std::pair{"world_tangent", &in.world_tangent},
                                           {"clip_position", &in.clip_position},
                                           {"previous_clip_position", &in.previous_clip_position}})
                if (v.name == std::string(name)) take(&to->x, &to->y, &to->z, &to->w);
        }
    }
    return out;
}

std::map<std::string, Expect> expectations(const Values& values, const Scene& from, bool additive) {
    SurfaceAxes axes = axes_of(values);
    axes.additive = additive;
    const auto wanted = values.find("pass");
    const std::string pass = wanted == values.end() ? "forward" : wanted->second;
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
        out["output 2"] = part([four](const G& g) { return four(g.normal); });
        out["output 3"] = part([four](const G& g) { return four(g.irradiance); });
        out["output 4"] = part([four](const G& g) { return four(g.radiance); });
    }
    return out;
}

}  // namespace kiln::test
