// Whole pipelines of the shipped shaders under extreme inputs: no pixel of a stable variant is infinite or not a number, and
// nothing was on the way into a clamp, min or max.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>

#include "compiler/device/compute.h"
#include "compiler/space/space.h"
#include "compiler/toolchain/spirv.h"
#include "compiler/validate/blocks.h"
#include "tests/device/glsl.h"
#include "tests/stability/raw.h"
#include "tests/stability/watch.h"
#include "uber/reference/sanitise.h"

namespace kiln::test {
namespace {

const std::string root = KILN_SOURCE_DIR;

// A file with its includes in place; `after` follows the #version.
std::string text_of(const std::string& path, const std::string& after) {
    std::ifstream file(path);
    EXPECT_TRUE(file.good()) << path;
    std::string out;
    for (std::string line; std::getline(file, line);) {
        const size_t open = line.rfind("#include", 0) == 0 ? line.find('"') : std::string::npos;
        if (open == std::string::npos)
            out += line + "\n";
        else
            out += text_of(
                (std::filesystem::path(path).parent_path() / line.substr(open + 1, line.rfind('"') - open - 1)).string(), "");
        if (line.rfind("#version", 0) == 0) out += after;
    }
    return out;
}

struct Pipeline {
    std::string name;
    bool lecture = false;
    std::vector<StageCode> stages;  // vertex and fragment as the renderer has them
    StageCode fed, watched;         // the fragment stage's varyings straight from vertex data; its clamps watched
    StageCode optimised;            // the fragment stage after kiln's optimiser
    uint32_t count = 0;             // location of the watched stage's count
};

// A vertex stage that hands vertex data on: input fed_X goes to what the fragment stage reads as X.
StageCode feeding(const std::vector<Varying>& inputs) {
    std::string text = "#version 450\nlayout(location = 0) in vec3 place;\n", body;
    uint32_t i = 1;
    for (const Varying& v : inputs) {
        const std::string type = v.type.rows == 1 ? "float" : "vec" + std::to_string(v.type.rows), out = "to_" + v.name;
        text += "layout(location = " + std::to_string(i++) + ") in " + type + " fed_" + v.name +
                ";\nlayout(location = " + std::to_string(v.location) + ") out " + type + " " + out + ";\n";
        body += "    " + out + " = fed_" + v.name + ";\n";
    }
    return compile(Stage::vertex, text + "void main() {\n    gl_Position = vec4(place.xy, 0.5, 1.0);\n" + body + "}\n");
}

// What kiln makes of a stage: without what nothing reaches, and optimised. The reflection is that of the result.
StageCode built(const Words& words, Optimise optimise) {
    Options options;
    options.optimise = optimise;
    auto out = spirv_prune(words, options);
    if (out.ok() && optimise != Optimise::none) out = spirv_optimise(*out, options);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return stage_of(out.ok() ? *out : words);
}

Pipeline make(const std::string& name, const std::string& vertex, const std::string& fragment, const std::string& defines) {
    Pipeline p;
    p.name = name;
    p.lecture = name.find("lecture") != std::string::npos;
    p.stages = {compile(Stage::vertex, text_of(vertex, defines)), compile(Stage::fragment, text_of(fragment, defines))};
    const Reflection& r = p.stages[1].reflection;
    for (const Varying& v : r.outputs) p.count = std::max(p.count, v.location + 1);
    p.fed = feeding(r.inputs);
    p.watched = compile(Stage::fragment, text_of(fragment, defines + watching + "#define main watched_main\n") +
                                             "#undef main\nlayout(location = " + std::to_string(p.count) +
                                             ") out vec4 watched_count;\nvoid main() {\n    watched_main();\n    watched_count = "
                                             "vec4(float(watched_non_finite));\n}\n");
    p.optimised = built(p.stages[1].words, Optimise::performance);
    p.watched = built(p.watched.words, Optimise::none);
    p.stages[0] = built(p.stages[0].words, Optimise::performance);
    return p;
}

using Wanted = std::function<bool(const std::string& axis, const std::string& value)>;

// Legal variants that together have every axis value, or every pair of them, that the rules allow together with `wanted`.
// Chosen greedily: each next one has the first pair that is still missing and as many others as its digits can.
std::vector<Digits> covering(Space& space, bool pairs, const Wanted& wanted) {
    Diagram& d = *space.diagram;
    Set all = space.legal;
    struct Value {
        uint32_t axis, digit;
        auto operator<=>(const Value&) const = default;
    };
    std::vector<Value> values;
    for (uint32_t a = 0; a < space.axes.size(); ++a)
        for (uint32_t v = 0; v < space.axes[a].values.size(); ++v) {
            if (wanted(space.axes[a].name, space.axes[a].values[v].name))
                values.push_back({a, v});
            else
                all = d.both(all, d.complement(d.where(a, v)));
        }
    std::set<std::pair<Value, Value>> missing;
    for (const Value& x : values)
        for (const Value& y : values)
            if (x == y || (pairs && x.axis < y.axis)) missing.insert({x, y});
    std::vector<Digits> out;
    while (!missing.empty()) {
        Set s = d.both(d.both(all, d.where(missing.begin()->first.axis, missing.begin()->first.digit)),
                       d.where(missing.begin()->second.axis, missing.begin()->second.digit));
        missing.erase(missing.begin());
        if (s == Diagram::none()) continue;
        for (const auto& [x, y] : missing) {
            const Set narrower = d.both(s, d.both(d.where(x.axis, x.digit), d.where(y.axis, y.digit)));
            if (narrower != Diagram::none()) s = narrower;
        }
        const Digits digits = *d.witness(s);
        std::erase_if(missing, [&](const auto& pair) {
            return digits[pair.first.axis] == pair.first.digit && digits[pair.second.axis] == pair.second.digit;
        });
        out.push_back(digits);
    }
    return out;
}

// Of these shaders; those of the lecture's forms or the stable ones. The depth pass computes nothing.
std::vector<Pipeline> pipelines(const std::string& manifest_name, const std::set<std::string>& shaders, bool pairs,
                                bool lecture) {
    std::vector<Pipeline> out;
    DiskFiles files;
    Diags diags;
    const std::optional<Manifest> manifest = load_manifest(files, root + "/manifests/" + manifest_name, diags);
    EXPECT_TRUE(manifest.has_value()) << manifest_name;
    if (!manifest) return out;
    for (const kiln::Shader& shader : manifest->shaders) {
        if (!shaders.count(shader.name)) continue;
        std::unique_ptr<Space> space = build_space(*manifest, shader, diags);
        EXPECT_NE(space, nullptr);
        if (space == nullptr) return out;
        const auto wanted = [lecture](const std::string& axis, const std::string& value) {
            return (axis != "pass" || value != "depth") && (lecture || value.find("lecture") == std::string::npos);
        };
        for (const Digits& digits : covering(*space, pairs, wanted)) {
            const std::string name = space->describe_variant(digits);
            if (lecture && name.find("lecture") == std::string::npos) continue;
            std::string defines;
            for (const auto& [macro, body] : shader.defines) defines += "#define " + macro + " " + body + "\n";
            for (size_t a = 0; a < digits.size(); ++a) {
                const Axis& axis = space->axes[a];
                const int32_t number = axis.values[digits[a]].number;
                if (axis.kind != AxisKind::defined || number != 0)
                    defines += "#define " + axis.macro + " " + std::to_string(number) + "\n";
            }
            out.push_back(make(name, root + "/uber/" + shader.stages[0].file, root + "/uber/" + shader.stages[1].file, defines));
        }
    }
    return out;
}

// ---- inputs ----

using Numbers = std::vector<double>;

struct Extremes {
    std::string name;
    std::map<std::string, Numbers> members;  // of blocks, by name; a shorter list repeats
    std::optional<float> textures;           // every texel, of depth maps as well
    bool infinite_squares = false;           // of distances, over the range or alone: an infinity goes into max and clamp
};

const Numbers identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// What any renderer has; the extremes change parts of it.
std::map<std::string, Numbers> usual() {
    return {{"view_projection", identity},
            {"previous_view_projection", identity},
            {"model", identity},
            {"previous_model", identity},
            {"camera_position", {0.3, 0.2, 2}},
            {"light_position", {0.5, -0.5, 1}},
            {"light_direction", {0, 0, -1}},
            {"light_range", {10}},
            {"light_cos_inner", {0.9}},
            {"light_cos_outer", {0.5}},
            {"light_intensity", {3, 2, 1}},
            {"shadow_near", {0.1}},
            {"shadow_far", {20}},
            {"shadow_texel", {0.01}},
            {"shadow_depth_bias", {1e-4}},
            {"shadow_view_projection", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.5, 0, 0, 0, 0.5, 1}},
            {"lightmap_range", {4}}};
}

std::vector<Extremes> extremes() {
    const double top = reference::largest_intensity;
    std::vector<Extremes> out{{"usual", {}, {}, false}};
    const auto add = [&](const std::string& name, std::map<std::string, Numbers> members, std::optional<float> textures = {},
                         bool infinite_squares = false) {
        out.push_back({name, std::move(members), textures, infinite_squares});
    };
    for (const double r : {-1.0, 0.0, 1e-30, 0.045, 1.5, 3.0})
        add("roughness " + std::to_string(r), {{"roughness_factor", {r}}, {"glossiness_factor", {1 - r}}}, 1.0f);
    for (const double m : {-1.0, 2.0}) add("metallic " + std::to_string(m), {{"metallic_factor", {m}}}, 1.0f);
    for (const double f : {-2.0, 2.0, 1e6})
        add("colours " + std::to_string(f),
            {{"base_factor", {f}}, {"specular_factor", {f}}, {"dielectric_specular", {f}}, {"emissive", {std::fabs(f)}}});
    for (const double s : {-1.0, 0.0, 1.0, 2048.0, 1e6}) add("shininess " + std::to_string(s), {{"shininess", {s}}});
    for (const double i : {0.0, 1e-30, 65520.0, 1e20, top}) {
        std::map<std::string, Numbers> bright{{"light_intensity", {i}}, {"ambient_irradiance", {i}}, {"emissive", {i}}};
        for (const double r : {0.0, 1.0}) {
            bright["roughness_factor"] = {r};
            bright["glossiness_factor"] = {1 - r};
            add("intensity " + std::to_string(i) + " roughness " + std::to_string(r), bright, 1.0f);
        }
    }
    // FLT_MAX comes in through the loader.
    reference::Warnings warnings;
    reference::LightParameters light;
    light.intensity = {static_cast<double>(largest_float), std::numeric_limits<double>::infinity(),
                       std::numeric_limits<double>::quiet_NaN()};
    const reference::LightParameters limited = reference::sanitise("light", light, warnings);
    reference::MaterialParameters material;
    material.roughness_factor = std::numeric_limits<double>::quiet_NaN();
    material.base_factor = {std::numeric_limits<double>::infinity(), -1, std::numeric_limits<double>::quiet_NaN()};
    const reference::MaterialParameters put_right = reference::sanitise("material", material, warnings);
    EXPECT_EQ(warnings.size(), 3u);
    add("sanitised", {{"light_intensity", {limited.intensity.x, limited.intensity.y, limited.intensity.z}},
                      {"roughness_factor", {put_right.roughness_factor}},
                      {"base_factor", {put_right.base_factor.x, put_right.base_factor.y, put_right.base_factor.z, 0}}});
    // Places and directions.
    add("light at the surface", {{"light_position", {0, 0, 0}}, {"light_direction", {0, 0, 0}}});
    add("viewer at the surface", {{"camera_position", {0, 0, 0}}});
    add("light opposite the viewer",
        {{"light_position", {0.3, 0.2, -2}}, {"camera_position", {-0.3, -0.2, 2}}, {"light_direction", {0.3, 0.2, 2}}});
    add("light far away", {{"light_position", {1e20, 0, 1e20}}}, {}, true);
    add("light without range", {{"light_range", {0}}}, {}, true);
    add("cone of no width", {{"light_cos_inner", {0.7}}, {"light_cos_outer", {0.7}}});
    add("cone inside out", {{"light_cos_inner", {-1}}, {"light_cos_outer", {1}}});
    // Shadows: behind the light, at its plane, nowhere, before and beyond everything.
    add("behind the light", {{"shadow_view_projection", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1}}});
    add("in the light's plane", {{"shadow_view_projection", {1, 0, 0, 1, 0, 1, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0}}});
    add("no shadow matrix", {{"shadow_view_projection", {0}}});
    add("near is far", {{"shadow_near", {5}}, {"shadow_far", {5}}});
    add("huge texels", {{"shadow_texel", {1e10}}, {"shadow_depth_bias", {1e10}}});
    for (const float t : {0.0f, 1.0f}) add("maps of " + std::to_string(t), {}, t);
    add("lightmap without range", {{"lightmap_range", {0}}}, 0.0f);
    add("lightmap to the top", {{"lightmap_range", {1e30}}}, 1.0f);
    // Objects without a size, mirrored, and a last frame that was nowhere.
    add("no previous frame", {{"previous_view_projection", {0}}, {"previous_model", {0}}});
    add("behind the last camera", {{"previous_view_projection", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1}}});
    add("flattened", {{"model", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.2, 1}}});
    add("shrunk to a line", {{"model", {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.2, 1}}});
    add("mirrored", {{"model", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
    return out;
}

// And what the renderer's further systems have.
std::vector<Extremes> renderer_extremes() {
    std::vector<Extremes> out = extremes();
    const auto add = [&](const std::string& name, std::map<std::string, Numbers> members, std::optional<float> textures = {}) {
        out.push_back({name, std::move(members), textures, false});
    };
    add("cascades that end at the viewer", {{"cascade_ends", {1, 1, 1, 1}}, {"cascade_start", {1}}, {"cascade_band", {0}}});
    add("no cascade reaches", {{"cascade_ends", {0}}, {"cascade_band", {1}}});
    add("cascades behind the light",
        {{"cascade_ends", {100}}, {"cascade_view_projection", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1}}});
    add("no cascade matrices",
        {{"cascade_ends", {100}}, {"cascade_view_projection", {0}}, {"cascade_plane_of_world", {0}}, {"cascade_filter", {0}}});
    add("light without a size", {{"light_size", {0}}, {"shadow_filter", {0}}, {"shadow_plane_of_world", {0}}});
    add("huge light", {{"light_size", {1e6}}, {"shadow_filter", {100}}, {"moments_levels", {1}}});
    add("moments without variance", {{"moments_least", {1e-30}}, {"moments_bleeding", {0}}, {"moments_reference", {0}}}, 0.0f);
    add("moments of one", {{"moments_least", {1e-9}}, {"moments_bleeding", {0.99}}, {"moments_reference", {1}}}, 1.0f);
    add("boxes of no size", {{"reflection_box_min", {0}}, {"reflection_box_max", {0}}, {"reflection_centre", {0}}});
    add("one level, one texel", {{"environment_levels", {1}}, {"split_sum_size", {1}}});
    add("negative sky and probes", {{"sky_sh", {-1}}, {"probe_sh", {-1}}, {"ambient_irradiance", {0}}});
    add("bright sky and probes", {{"sky_sh", {1e20}}, {"probe_sh", {1e20}}});
    add("one probe", {{"probe_count", {1}}, {"probe_inverse_spacing", {0}}});
    return out;
}

// Vertex data of the varyings by name: one combination a cell of the grid.
Numbers fed_value(const std::string& name, uint32_t rows, uint32_t cell) {
    static const std::vector<Numbers> normals{{0, 0, 0},     {0, 0, 1},     {0, 0, -1},      {0.6, 0, 0.8},   {-0.3, -0.2, -2},
                                              {1e-40, 0, 0}, {0, 1e-37, 0}, {1e20, 1e20, 0}, {0, 3e38, 3e38}, {0.5, -0.5, 1}};
    static const std::vector<Numbers> positions{{0, 0, 0},          {0.3, 0.2, 2},    {0.5, -0.5, 1}, {1e-20, 0, 0},
                                                {0.50001, -0.5, 1}, {1e6, -1e6, 1e6}, {0.1, 0.2, -3}};
    static const std::vector<Numbers> tangents{{0, 0, 0, 1},     {0, 0, 1, 1},     {1, 0, 0, -1},     {0, 0, -1, 0},
                                               {1e-40, 0, 0, 1}, {0.6, 0, 0.8, 1}, {3e38, 1e20, 0, 1}};
    static const std::vector<Numbers> uvs{{0, 0}, {0.5, 0.5}, {1e6, -1e6}, {1, 1}, {-1, 2}};
    static const std::vector<Numbers> clips{{0, 0, 0, 0},      {1, 1, 0.5, 1},         {1, 1, 1, -1},
                                            {1, -1, 0, 1e-20}, {1e18, 1e18, 0, 1e-17}, {0.5, 0.5, 0.5, 1e18}};
    const auto pick = [&](const std::vector<Numbers>& from, uint32_t step) {
        Numbers v = from[(cell * step + cell / 10) % from.size()];
        v.resize(rows, 0.0);
        return v;
    };
    if (name.find("normal") != std::string::npos) return pick(normals, 1);
    if (name.find("tangent") != std::string::npos) return pick(tangents, 3);
    if (name.find("uv") != std::string::npos) return pick(uvs, 1);
    if (name.find("clip") != std::string::npos) return pick(clips, name.find("previous") == std::string::npos ? 1 : 5);
    return pick(positions, 2);
}

void set_members(Inputs& inputs, const std::vector<StageCode>& stages, const std::map<std::string, Numbers>& members,
                 std::set<std::string>& used) {
    for (const StageCode& s : stages)
        for (const Resource& r : s.reflection.resources) {
            Bytes* block = nullptr;
            if (r.kind == ResourceKind::push_constants) block = &inputs.push_constants;
            for (Binding& b : inputs.bindings)
                if (r.kind == ResourceKind::uniform_block && b.set == r.set && b.binding == r.binding && !b.buffers.empty())
                    block = &b.buffers[0];
            if (block == nullptr) continue;
            for (const Member& m : r.members) {
                const auto found = members.find(m.name);
                if (found == members.end()) continue;
                used.insert(m.name);
                Numbers each(size_t{m.type.rows} * m.type.columns);
                for (size_t i = 0; i < each.size(); ++i) each[i] = found->second[std::min(i, found->second.size() - 1)];
                for (const size_t at : element_offsets(m)) store_value(*block, at, m, each.data());
            }
        }
}

void set_textures(Inputs& inputs, float value) {
    for (Binding& b : inputs.bindings)
        for (auto& image : b.images) {
            if (image == nullptr || image->format != TexelFormat::standard || image->base != BaseType::float32) continue;
            auto flat = std::make_shared<ImageData>(*image);
            for (size_t i = 0; i + 4 <= flat->texels.size(); i += 4) std::memcpy(flat->texels.data() + i, &value, 4);
            image = flat;
        }
}

Inputs inputs_of(const std::vector<StageCode>& stages, const Extremes& e, bool fed, std::set<std::string>& used) {
    InputOptions options;
    options.position = fed ? "place" : "position";
    Inputs out = make_inputs(stages, options);
    std::set<std::string> ignored;
    std::map<std::string, Numbers> members = usual();
    set_members(out, stages, members, ignored);
    set_members(out, stages, e.members, used);
    if (e.textures) set_textures(out, *e.textures);
    for (const Varying& v : stages[0].reflection.inputs)
        for (Attribute& a : out.attributes) {
            if (a.location != v.location || v.name.rfind("fed_", 0) != 0) continue;
            std::vector<float> data;
            for (uint32_t vertex = 0; vertex < out.vertices; ++vertex) {
                const Numbers n = fed_value(v.name, a.components, vertex / 6);
                for (uint32_t c = 0; c < a.components; ++c) data.push_back(static_cast<float>(n[c]));
            }
            a.data = bytes_of(data);
        }
    return out;
}

// ---- tests ----

struct Seen {
    uint64_t pixels = 0, non_finite = 0, negative = 0, hidden = 0;
    std::string first;
};

void look_at(const RunOutput& run, const std::string& count, Seen& seen) {
    for (const ReadBack& r : run.values) {
        if (r.what.rfind("output", 0) != 0) continue;
        const bool is_count = r.what.rfind(count, 0) == 0;
        const std::vector<float> values = values_of<float>(bytes_of(r.words));
        for (const float v : values) {
            if (is_count) {
                seen.hidden += v != 0 ? 1 : 0;
            } else {
                seen.non_finite += std::isfinite(v) ? 0 : 1;
                seen.negative += v < 0 ? 1 : 0;
            }
        }
    }
    seen.pixels += run.covered;
}

std::vector<Seen> draw(const std::vector<StageCode>& stages, const std::vector<Extremes>& all, bool fed, const std::string& count,
                       std::set<std::string>& used) {
    PipelineRequest request;
    request.stages = stages;
    request.size = 40;
    for (const Extremes& e : all) request.inputs.push_back(inputs_of(stages, e, fed, used));
    Result<PipelineOutput> out = device().run(request);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    std::vector<Seen> seen(all.size());
    if (!out.ok()) return seen;
    EXPECT_TRUE(out->errors.empty()) << out->errors.front();
    EXPECT_EQ(out->unsupported, "");
    EXPECT_EQ(out->runs.size(), all.size());
    for (size_t i = 0; i < out->runs.size(); ++i) look_at(out->runs[i], count, seen[i]);
    return seen;
}

struct Kind {
    const char* name;
    std::vector<StageCode> stages;
    bool fed;
};

std::vector<Kind> kinds_of(const Pipeline& p) {
    return {{"optimised", {p.stages[0], p.optimised}, false}, {"fed, watched", {p.fed, p.watched}, true}};
}

std::string count_of(const Pipeline& p) { return "output " + std::to_string(p.count); }

void expect_finite_pixels(const std::string& manifest, const std::set<std::string>& shaders, const std::vector<Extremes>& all) {
    std::set<std::string> used;
    uint64_t pixels = 0;
    const std::vector<Pipeline> pipes = pipelines(manifest, shaders, true, false);
    for (const Pipeline& p : pipes)
        for (const Kind& kind : kinds_of(p)) {
            const std::vector<Seen> seen = draw(kind.stages, all, kind.fed, count_of(p), used);
            for (size_t i = 0; i < all.size(); ++i) {
                const std::string where = p.name + " (" + kind.name + "): " + all[i].name;
                EXPECT_EQ(seen[i].non_finite, 0u) << where;
                if (p.name.find("pass=gbuffer") == std::string::npos && p.name.find("pass=velocity") == std::string::npos) {
                    EXPECT_EQ(seen[i].negative, 0u) << where;
                }
                if (!all[i].infinite_squares) {
                    EXPECT_EQ(seen[i].hidden, 0u) << where;
                }
                pixels += seen[i].pixels;
            }
        }
    std::printf("KILN_VARIANTS %s: %zu variants, %zu extremes, %llu pixels\n", manifest.c_str(), pipes.size(), all.size(),
                static_cast<unsigned long long>(pixels));
    EXPECT_GE(pipes.size(), 10u);
    EXPECT_GT(pixels, uint64_t{all.size()} * pipes.size() * 1000);
    for (const Extremes& e : all)
        for (const auto& [member, numbers] : e.members) EXPECT_TRUE(used.count(member)) << "no variant has " << member;
}

TEST(Variants, FiniteForAnyInput) { expect_finite_pixels("surface.yaml", {"surface"}, extremes()); }

TEST(Variants, FiniteForAnyInputOfTheRenderer) {
    expect_finite_pixels("renderer.yaml", {"surface", "surface_local"}, renderer_extremes());
}

// What the deferred passes, the sky and the tone curves read: matrices without a place, g-buffers of nothing and of ones.
TEST(Variants, FiniteForAnyInputOfFullScreenPasses) {
    std::vector<Extremes> all{{"usual", {}, {}, false}};
    const auto add = [&](const std::string& name, std::map<std::string, Numbers> members, std::optional<float> textures = {}) {
        all.push_back({name, std::move(members), textures, false});
    };
    for (const float t : {0.0f, 0.5f, 1.0f, 65504.0f}) add("maps of " + std::to_string(t), {}, t);
    for (const double ev : {-20.0, 0.0, 30.0})
        for (const float t : {0.0f, 65504.0f}) add("EV " + std::to_string(ev), {{"exposure_value", {ev}}, {"white", {ev}}}, t);
    add("no screen matrix", {{"world_of_clip", {0}}});
    // 1e20 times as far: squares of distances, as of a light far away.
    add("at infinity", {{"world_of_clip", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}}});
    all.back().infinite_squares = true;
    add("bright sky", {{"sky_intensity", {1e20}}, {"sky_level", {20}}, {"sky_sh", {1e20}}});
    add("bright light", {{"light_intensity", {reference::largest_intensity}}}, 1.0f);
    add("light at the surface", {{"light_position", {0, 0, 0}}, {"light_direction", {0, 0, 0}}}, 0.5f);
    add("viewer at the surface", {{"camera_position", {0, 0, 0}}, {"world_of_clip", {0}}});
    expect_finite_pixels("renderer.yaml", {"deferred", "background", "post"}, all);
}

// The lecture's materials in whole variants: light that is negative, or not a number, or was one on the way into a clamp.
TEST(Variants, LecturesMaterialsFail) {
    const std::vector<Extremes> all = extremes();
    std::set<std::string> used;
    size_t looked = 0;
    for (const Pipeline& p : pipelines("renderer.yaml", {"surface_lecture"}, true, true)) {
        const bool lit = p.name.find("light=none") == std::string::npos;
        const bool pbr = p.name.find("material=pbr_lecture") != std::string::npos;
        if (!lit || (!pbr && p.name.find("material=blinn_phong_lecture") == std::string::npos)) continue;
        uint64_t negative = 0, not_a_number = 0;
        for (const Seen& seen : draw({p.fed, p.watched}, all, true, count_of(p), used))
            negative += seen.negative, not_a_number += seen.non_finite + seen.hidden;
        std::printf("KILN_VARIANTS %s: negative %llu, not finite %llu\n", p.name.c_str(),
                    static_cast<unsigned long long>(negative), static_cast<unsigned long long>(not_a_number));
        EXPECT_GT(not_a_number, 0u) << p.name;
        if (pbr) {
            EXPECT_GT(negative, 0u) << p.name;
        }
        ++looked;
    }
    EXPECT_GE(looked, 2u);
}

// What the loader is there for: the same numbers without it reach the pixels, or hide in a clamp, and this suite sees both.
TEST(Variants, WhatIsNotSanitisedShows) {
    const double top = static_cast<double>(largest_float), nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Extremes> all{
        {"intensity", {{"light_intensity", {top}}, {"roughness_factor", {0}}, {"glossiness_factor", {1}}}, 1.0f, false},
        {"roughness", {{"roughness_factor", {nan}}, {"glossiness_factor", {nan}}, {"shininess", {nan}}}, {}, false},
        {"emission", {{"emissive", {nan}}}, {}, false}};
    std::set<std::string> used;
    uint64_t bright = 0;
    for (const Pipeline& p : pipelines("surface.yaml", {"surface"}, false, false)) {
        if (p.name.find("pass=forward") == std::string::npos || p.name.find("light=none") != std::string::npos) continue;
        const std::vector<Seen> seen = draw({p.fed, p.watched}, all, true, count_of(p), used);
        bright += seen[0].non_finite;
        EXPECT_GT(seen[1].hidden, 0u) << p.name;
        EXPECT_GT(seen[2].non_finite, 1000u) << p.name;
    }
    EXPECT_GT(bright, 0u);
}

}  // namespace
}  // namespace kiln::test
