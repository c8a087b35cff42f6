// One shader for all, or one for each: the same surface with its features decided when it runs, when its pipeline is made, when
// it is compiled, and written by hand for the scene.
#include <bit>

#include "compiler/report/families/families.h"
#include "compiler/report/resources.h"

namespace kiln::report {

namespace {

struct Feature {
    std::string name, macro;
};
const std::vector<Feature>& features() {
    static const std::vector<Feature> all{{"light", "LIGHT"},       {"brdf", "BRDF"}, {"shadow", "SHADOW"},
                                          {"lightmap", "LIGHTMAP"}, {"ibl", "IBL"},   {"two_sided", "TWO_SIDED"}};
    return all;
}

struct Setting {
    std::string name, what;
    std::vector<int> needs;  // in the order of features()
    std::string minimal;     // body of shade
};

const char* const point_text = R"(
const vec3 eye = vec3(0.0, 0.0, 4.0), base = vec3(0.6, 0.5, 0.4), f0 = vec3(0.04);
const vec3 sun = vec3(0.48, 0.64, 0.6), lamp = vec3(0.5, 1.0, 2.0), lamp_axis = vec3(0.0, -0.4472136, -0.8944272);
Point point_at(vec2 u) {
    Point p;
    const vec2 q = u * 2.0 - 1.0;
    p.position = vec3(q * 2.0, 0.3 * q.x * q.y);
    p.n = vec3(0.3 * q.y - 0.2, 0.3 * q.x, 1.0) * inversesqrt(1.0 + (0.3 * q.y - 0.2) * (0.3 * q.y - 0.2) + 0.09 * q.x * q.x);
    p.roughness = 0.2 + 0.6 * u.x;
    return p;
}
)";

const char* const includes = R"(
#include "lights.glsl"
#include "blinn_phong.glsl"
#include "cook_torrance.glsl"
#include "shadow_receiver.glsl"
#include "pcf.glsl"
#include "sh.glsl"
#include "environment.glsl"
#include "ibl.glsl"
ShL2 sky() { return ShL2(vec3[9](harmonics[0].rgb, harmonics[1].rgb, harmonics[2].rgb, harmonics[3].rgb, harmonics[4].rgb,
                                 harmonics[5].rgb, harmonics[6].rgb, harmonics[7].rgb, harmonics[8].rgb)); }
vec3 shadow_place(vec3 position) { return vec3(position.xy * 0.2 + 0.5, 0.5 - 0.05 * position.z); }
)";

const char* const uber = R"(
vec3 shade(Point p) {
    const vec3 v = normalize(eye - p.position);
    vec3 n = normalize(p.n);
    if (TWO_SIDED == 1) n = dot(n, v) < 0.0 ? -n : n;
    vec3 sum = vec3(0.0);
    if (LIGHT != 0) {
        vec3 l = sun;
        float e = 3.0;
        if (LIGHT != 1) {
            const vec3 to = lamp - p.position;
            const float d2 = dot(to, to);
            l = to * inversesqrt(max(d2, 1e-8));
            e = 20.0 * distance_attenuation(d2, 10.0);
            if (LIGHT == 3) e *= cone_attenuation(dot(-l, lamp_axis), 0.95, 0.8);
        }
        if (SHADOW == 1) e *= pcf_5(shadow_map, shadow_place(p.position), vec2(0.0), 1e-3, vec2(0.02));
        if (BRDF == 0) sum += base * (e * saturate(dot(n, l)) / pi);
        if (BRDF == 1) sum += e * blinn_phong(n, v, l, base, f0, 64.0);
        if (BRDF == 2) sum += e * cook_torrance(n, v, l, base, f0, p.roughness);
    }
    if (LIGHTMAP == 1) sum += base / pi * sh_irradiance_clamped(sky(), n);
    if (IBL == 1)
        sum += image_based_light(base, f0, textureLod(irradiance_map, n, 0.0).rgb,
                                 sample_environment(environment, environment_reflection(n, v), p.roughness, 4.0),
                                 split_sum_lookup(table, dot(n, v), p.roughness, 16.0));
    return sum;
}
)";

std::vector<Setting> settings() {
    return {{"valley",
             "Sun with a filtered shadow, Cook-Torrance, harmonics for the sky, two-sided leaves.",
             {1, 2, 1, 1, 0, 1},
             "vec3 shade(Point p) {\n    const vec3 v = normalize(eye - p.position);\n    vec3 n = normalize(p.n);\n"
             "    n = dot(n, v) < 0.0 ? -n : n;\n"
             "    const float e = 3.0 * pcf_5(shadow_map, shadow_place(p.position), vec2(0.0), 1e-3, vec2(0.02));\n"
             "    return e * cook_torrance(n, v, sun, base, f0, p.roughness) + base / pi * sh_irradiance_clamped(sky(), n);\n}"},
            {"corridor",
             "One lamp, Lambert, nothing else.",
             {2, 0, 0, 0, 0, 0},
             "vec3 shade(Point p) {\n    const vec3 to = lamp - p.position;\n    const float d2 = dot(to, to);\n"
             "    const vec3 l = to * inversesqrt(max(d2, 1e-8));\n    const float e = 20.0 * distance_attenuation(d2, 10.0);\n"
             "    return base * (e * saturate(dot(normalize(p.n), l)) / pi);\n}"},
            {"showroom",
             "An environment alone.",
             {0, 2, 0, 0, 1, 0},
             "vec3 shade(Point p) {\n    const vec3 v = normalize(eye - p.position), n = normalize(p.n);\n"
             "    return image_based_light(base, f0, textureLod(irradiance_map, n, 0.0).rgb,\n"
             "                             sample_environment(environment, environment_reflection(n, v), p.roughness, 4.0),\n"
             "                             split_sum_lookup(table, dot(n, v), p.roughness, 16.0));\n}"}};
}

// Smooth stand-ins: what is in the maps decides no time.
std::vector<Resource> maps(const std::vector<int>& switches) {
    std::vector<float> harmonics(36, 0.0f);
    for (size_t i = 0; i < 9; ++i)
        for (size_t c = 0; c < 3; ++c) harmonics[4 * i + c] = i == 0 ? 3.0f : 0.3f / static_cast<float>(i + c);
    std::vector<std::vector<float>> mips;
    for (uint32_t n = 32; n >= 4; n /= 2) {
        mips.emplace_back();
        for (uint32_t i = 0; i < 6 * n * n; ++i)
            for (uint32_t c = 0; c < 4; ++c) mips.back().push_back(0.5f + 0.4f * static_cast<float>(std::sin(0.37 * i / n + c)));
    }
    std::vector<float> table, depth;
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 16; ++x) {
            table.push_back(0.5f + 0.03f * static_cast<float>(x));
            table.push_back(0.01f * static_cast<float>(15 - y));
        }
    for (uint32_t i = 0; i < 256 * 256; ++i) depth.push_back((i / 4096 + i % 256 / 16) % 2 == 0 ? 0.4f : 0.9f);
    std::vector<float> on(8, 0.0f);
    for (size_t i = 0; i < switches.size(); ++i) on[i] = std::bit_cast<float>(switches[i]);
    SamplerState clamped;
    clamped.wrap = Wrap::clamp;
    clamped.mips = MipFilter::none;
    return {uniform_buffer("uniform Harmonics { vec4 harmonics[9]; }", harmonics),
            cube_map("irradiance_map", TexelFormat::rgba16_float, 32, {mips.front()}),
            cube_map("environment", TexelFormat::rgba16_float, 32, mips),
            picture_map("table", TexelFormat::rg32_float, 16, 16, {table}, clamped),
            depth_map("shadow_map", 256, depth, true, Filter::linear),
            uniform_buffer("uniform Features { ivec4 features[2]; }", on)};
}

// A plain look-up of a constant place in a uniform block would be no switch at run time on lavapipe: it compiles the shader anew,
// at every dispatch, for the values that decide branches. The shift is always 0, which the driver cannot know.
std::string switched(size_t feature) {
    return "features[" + std::to_string(feature / 4) + "u + (kiln_draw.w >> 31)][" + std::to_string(feature % 4) + "]";
}

}  // namespace

Family specialisation_family(bool quick) {
    Family f;
    f.number = 13;
    f.name = "specialisation";
    f.title = "One shader for all, or one for each";
    f.what =
        "A surface with six features in three scenes, each of which needs some of them. All members must draw one picture. The "
        "members "
        "run_time_... decide one feature when the shader runs and the rest when it is compiled: what they cost over macros is "
        "the "
        "feature's price where it is not needed.";
    f.primary = Metric::max_rel;
    f.fields = {{"vec3", "position"}, {"vec3", "n"}, {"float", "roughness"}};
    f.time_every_scene = true;
    for (const Setting& setting : settings()) {
        Scene s;
        s.name = setting.name;
        s.what = setting.what;
        s.width = s.height = quick ? 64 : 128;
        s.glsl = point_text;
        s.truth = "the picture of the variant written by hand";
        s.truth_member = "minimal";
        f.scenes.push_back(std::move(s));
    }
    const auto add = [&](const std::string& name, const std::string& what,
                         const std::function<std::string(const Setting&)>& text) {
        Member m;
        m.name = name;
        m.what = what;
        for (const Setting& s : settings()) m.scene_glsl[s.name] = text(s);
        m.resources = [](size_t scene, Bench&, const Effort&) -> Result<std::vector<Resource>> {
            return maps(settings()[scene].needs);
        };
        f.members.push_back(std::move(m));
    };
    // Which features are decided by which means.
    const auto declared = [](const Setting& s, const std::function<std::string(size_t feature, int value)>& means) {
        std::string out;
        for (size_t i = 0; i < features().size(); ++i) out += means(i, s.needs[i]) + "\n";
        return out;
    };
    const auto defined = [](size_t i, const std::string& body) { return "#define " + features()[i].macro + " " + body; };
    add("minimal", "written by hand for the scene", [](const Setting& s) { return includes + s.minimal; });
    add("macros", "the uber shader, features as macros", [=](const Setting& s) {
        return declared(s, [&](size_t i, int value) { return defined(i, std::to_string(value)); }) + includes + uber;
    });
    add("spec_constants", "the uber shader, features as specialisation constants", [=](const Setting& s) {
        return declared(s,
                        [&](size_t i, int value) {
                            return "layout(constant_id = " + std::to_string(i) + ") const int " + features()[i].macro + " = " +
                                   std::to_string(value) + ";";
                        }) +
               includes + uber;
    });
    add("run_time", "the uber shader, features in a uniform block",
        [=](const Setting& s) { return declared(s, [&](size_t i, int) { return defined(i, switched(i)); }) + includes + uber; });
    for (size_t one = 0; one < features().size(); ++one)
        add("run_time_" + features()[one].name, "only this feature in a uniform block", [=](const Setting& s) {
            return declared(s, [&](size_t i, int value) { return defined(i, i == one ? switched(i) : std::to_string(value)); }) +
                   includes + uber;
        });

    for (const Setting& s : settings()) {
        for (const char* m : {"macros", "spec_constants", "run_time"})
            f.expectations.push_back({Metric::max_rel, Relation::at_most, m, "", 1e-5, s.name, "one picture"});
        f.expectations.push_back(
            {Metric::time, Relation::near, "minimal", "macros", 1.05, s.name, "dead code goes when it is compiled"});
        f.expectations.push_back(
            {Metric::time, Relation::near, "macros", "spec_constants", 1.05, s.name, "or when the pipeline is made"});
        f.expectations.push_back(
            {Metric::time, Relation::below, "macros", "run_time", 1.0, s.name, "what is not needed costs time"});
        f.expectations.push_back({Metric::jit, Relation::below, "macros", "run_time", 1.0, s.name, "and time to compile"});
        f.expectations.push_back({Metric::spirv, Relation::below, "macros", "run_time", 1.0, s.name, "and bytes"});
        f.expectations.push_back(
            {Metric::spirv, Relation::below, "macros", "spec_constants", 1.0, s.name, "specialisation constants keep all code"});
    }
    f.remarks = [](const TimeOf& ns) {
        std::vector<std::string> out;
        for (const Setting& s : settings())
            for (size_t i = 0; i < features().size(); ++i) {
                const auto with = ns("run_time_" + features()[i].name, s.name), without = ns("macros", s.name);
                if (with && without)
                    out.push_back(features()[i].name + " decided at run time in " + s.name + ", where it is " +
                                  (s.needs[i] == 0 ? "off: " : "on: ") + digits(*with - *without) + " ns a pixel over macros (" +
                                  digits(*with) + " against " + digits(*without) + ")");
            }
        for (const Setting& s : settings()) {
            const auto all = ns("run_time", s.name), none = ns("macros", s.name);
            if (all && none)
                out.push_back("all six at run time in " + s.name + ": " + digits(*all - *none) + " ns a pixel over macros, " +
                              digits(*all / std::max(*none, 1e-9)) + " times");
        }
        return out;
    };
    return f;
}

}  // namespace kiln::report
