// Light that comes out where it did not go in: from a wider cosine to taps over a profile, against random walks.
#include "uber/reference/subsurface.h"
#include "compiler/report/bench.h"
#include "compiler/report/families/families.h"
#include "compiler/report/kernel.h"
#include "compiler/report/resources.h"
#include "uber/reference/subsurface_walk.h"

namespace kiln::report {

namespace {

struct Setting {
    std::string name, what;
    double albedo, radius;  // radius 0: a plane
    // A slab, seen from the front and lit on its back: this thick and half lit, or below 0 lit all over and of all thicknesses.
    double slab = 0.0;
};

// x: on the plane the distance from the edge, in mean free paths; on the sphere n.l.
const char* const point_text = R"(
Point point_at(vec2 u) {
    Point p;
    p.x = radius > 0.0 ? u.x * 2.0 - 1.0 : slab < 0.0 ? 1e4 : u.x * 12.0 - 6.0;
    p.thickness = slab < 0.0 ? 0.25 * exp2(5.0 * u.x) : slab;
    p.turn = unit(hash(floatBitsToUint(u.x * 0.731 + u.y)));
    return p;
}
float clamped_cosine(Point p) { return slab != 0.0 ? 0.0 : radius > 0.0 ? max(p.x, 0.0) : step(0.0, p.x); }
float irradiance_behind(Point p, vec2 offset) { return slab != 0.0 ? step(0.0, p.x + offset.x) : 0.0; }
// Irradiance at an offset along the surface, the first axis away from the light's pole.
float irradiance_at(Point p, vec2 offset) {
    if (slab != 0.0) return 0.0;
    if (radius <= 0.0) return step(0.0, p.x + offset.x);
    const vec2 angle = offset / radius;
    const float s = sqrt(max(1.0 - p.x * p.x, 0.0));
    return max((p.x * cos(angle.x) - s * sin(angle.x)) * cos(angle.y), 0.0);
}
)";

Scene scene_of(const Setting& setting, bool quick) {
    Scene s;
    s.name = setting.name;
    s.what = setting.what + (setting.radius > 0.0 ? " n.l from left to right."
                             : setting.slab < 0.0 ? " A quarter to eight mean free paths of it from left to right."
                                                  : " Six mean free paths to either side of the edge.");
    s.width = quick ? 24 : 48;
    s.height = 4;
    char text[160];
    std::snprintf(text, sizeof text, "const float albedo = %.9g, radius = %.9g, slab = %.9g;\n", setting.albedo, setting.radius,
                  setting.slab);
    s.glsl = std::string(text) + point_text;
    constexpr int batches = 32;
    const int walks = quick ? 24000 : 250000;
    s.truth = std::to_string(batches * walks) +
              (setting.slab < 0.0 ? " random walks in double precision, shared out among the columns"
                                  : " random walks in double precision, of which every column has its own view");
    s.reference = [setting, walks, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        const reference::Medium medium{reference::single_scattering_albedo(reference::splat3(setting.albedo)).x, 1.0};
        std::vector<double> columns;
        for (size_t x = 0; x < w; ++x) columns.push_back(points.scalar(x, 0));
        std::vector<std::vector<reference::Estimate>> parts(batches);
        effort.jobs.each(batches, [&](size_t b) {
            if (setting.slab < 0.0)
                for (size_t x = 0; x < w; ++x)
                    parts[b].push_back(reference::subsurface_slab_edge(medium, points.scalar(x, 2), {1e9},
                                                                       walks / static_cast<int>(w), (b + 1) * 1000 + x)[0]);
            else if (setting.slab > 0.0)
                parts[b] = reference::subsurface_slab_edge(medium, setting.slab, columns, walks, b + 1);
            else
                parts[b] = setting.radius > 0.0 ? reference::subsurface_terminator(medium, setting.radius, columns, walks, b + 1)
                                                : reference::subsurface_edge(medium, columns, walks, b + 1);
        });
        Reference out;
        out.picture = Picture(w, h);
        out.variance.resize(out.picture.rgb.size());
        for (const auto& part : parts)
            for (size_t i = 0; i < out.picture.rgb.size() && !part.empty(); ++i) {
                const reference::Estimate& e = part[i / 3 % w];
                out.picture.rgb[i] += e.mean / batches;
                out.variance[i] += e.standard_error * e.standard_error / (batches * batches);
            }
        return out;
    };
    return s;
}

}  // namespace

Family subsurface_family(bool quick) {
    Family f;
    f.number = 10;
    f.name = "subsurface";
    f.title = "Light under a surface";
    f.what =
        "Exitance over unit irradiance of a medium whose mean free path is 1, at the edge of the light on a plane, on small "
        "spheres, and through slabs lit from behind. Planar forms spread over the distance along the sphere; a form without a "
        "term "
        "for what comes through leaves a slab's front black.";
    f.primary = Metric::rmse;
    f.fields = {{"float", "x"}, {"float", "turn"}, {"float", "thickness"}};
    const std::vector<Setting> settings{
        {"edge", "Half of a plane is lit; albedo 0.6.", 0.6, 0.0},
        {"edge_bright", "Half of a plane is lit; albedo 0.9.", 0.9, 0.0},
        {"sphere_20", "A sphere of radius 20 lit from one side; albedo 0.6.", 0.6, 20.0},
        {"sphere_5", "A sphere of radius 5 lit from one side; albedo 0.6.", 0.6, 5.0},
        {"slab", "A slab lit all over its back; albedo 0.9.", 0.9, 0.0, -1.0},
        {"slab_edge", "A slab of two mean free paths, half of its back lit; albedo 0.9.", 0.9, 0.0, 2.0}};
    for (const Setting& s : settings) f.scenes.push_back(scene_of(s, quick));
    const auto add = [&](const std::string& name, const std::string& what, const std::string& glsl) -> Member& {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = glsl;
        f.members.push_back(std::move(m));
        return f.members.back();
    };
    add("lambert", "nothing under the surface", "vec3 shade(Point p) { return vec3(albedo * clamped_cosine(p)); }");
    add("wrap", "a cosine that reaches past the terminator; at an edge Lambert's",
        "#include \"subsurface.glsl\"\n"
        "vec3 shade(Point p) { return vec3(albedo * (radius > 0.0 ? wrap_diffuse(p.x, 0.5) : clamped_cosine(p))); }");
    const std::string curved =
        "#include \"subsurface_preintegrated.glsl\"\nvec3 shade(Point p) {\n"
        "    const vec3 s = burley_shape_diffuse(vec3(albedo));\n    if (radius <= 0.0) return vec3(albedo * "
        "clamped_cosine(p));\n";
    add("preintegrated_ring", "Penner's ring in eight steps; at an edge Lambert's",
        "#define PREINTEGRATED_STEPS 8\n" + curved +
            "    return vec3(albedo * preintegrated_ring(p.x, 1.0 / radius, burley_gaussian_variance(s.x)));\n}");
    add("preintegrated_sphere", "Burley's profile over the sphere in 32 steps; at an edge Lambert's",
        "#define PREINTEGRATED_STEPS 32\n" + curved +
            "    return vec3(albedo * preintegrated_sphere(p.x, 1.0 / (radius * s.x)));\n}");
    add("preintegrated_table", "the same from a table of 64 x 64",
        curved + "    return albedo * preintegrated_lookup(table, p.x, 1.0 / radius, s);\n}")
        .resources = [](size_t, Bench& bench, const Effort&) -> Result<std::vector<Resource>> {
        Draw draw;
        draw.width = draw.height = 64;
        draw.results = size_t{4} * 64 * 64;
        draw.groups = 64;
        auto texels = bench.bake(
            bake_text(
                {},
                "#define PREINTEGRATED_STEPS 64\n#include \"subsurface_preintegrated.glsl\"\n"
                "vec4 texel(uint i) { return vec4(preintegrated_texel(ivec2(i % 64u, i / 64u), ivec2(64)), 0.0, 0.0, 0.0); }"),
            {}, draw);
        KILN_TRY(texels);
        std::vector<float> red;
        for (size_t i = 0; i < texels->size(); i += 4) red.push_back((*texels)[i]);
        SamplerState sampler;
        sampler.wrap = Wrap::clamp;
        sampler.mips = MipFilter::none;
        return std::vector<Resource>{picture_map("table", TexelFormat::r32_float, 64, 64, {red}, sampler)};
    };
    // Light varies along one axis at an edge, so one of the two blurs is all; on the sphere the second keeps what it meets.
    for (const char* n : {"7", "11", "17", "25"})
        add(std::string("separable_") + n, "line spreads, one axis; the kernel comes ready",
            std::string("vec3 shade(Point p) {\n    float sum = 0.0;\n    for (int i = 0; i < ") + n +
                "; ++i) sum += kernel[i].x * irradiance_at(p, vec2(kernel[i].w, 0.0));\n    return vec3(albedo * sum);\n}")
            .resources = [settings, n](size_t scene, Bench& bench, const Effort&) -> Result<std::vector<Resource>> {
            Draw draw;
            draw.width = static_cast<uint32_t>(std::stoi(n));
            draw.height = 1;
            draw.results = size_t{4} * draw.width;
            draw.groups = 1;
            auto kernel = bench.bake(
                bake_text({}, std::string("#define SEPARABLE_TAPS ") + n +
                                  "\n#include \"subsurface.glsl\"\n#include \"subsurface_separable.glsl\"\nvec4 texel(uint i) {\n"
                                  "    vec4 kernel[SEPARABLE_TAPS];\n    const vec3 s = burley_shape_diffuse(vec3(" +
                                  std::to_string(settings[scene].albedo) +
                                  "));\n    separable_kernel_burley(s, 9.0 / s.x, kernel);\n    return kernel[i];\n}"),
                {}, draw);
            KILN_TRY(kernel);
            return std::vector<Resource>{uniform_buffer(std::string("uniform Kernel { vec4 kernel[") + n + "]; }", *kernel)};
        };
    for (const char* n : {"16", "32", "64"})
        add(std::string("burley_") + n, "taps over the disc by the profile, turned by the pixel",
            std::string("#include \"subsurface.glsl\"\nvec3 shade(Point p) {\n    const float s = "
                        "burley_shape_diffuse(vec3(albedo)).x;\n    float sum = 0.0;\n"
                        "    for (int i = 0; i < ") +
                n + "; ++i) sum += irradiance_at(p, burley_tap(i, " + n +
                ", s, 6.2831853 * p.turn).xy);\n"
                "    return vec3(albedo * sum / " +
                n + ".0);\n}");
    for (const char* n : {"32", "64"})
        add(std::string("dipole_") + n, "Jensen's dipole over the same taps",
            std::string(
                "#include \"subsurface.glsl\"\nvec3 shade(Point p) {\n    const vec3 s = burley_shape_diffuse(vec3(albedo));\n"
                "    const float a = single_scattering_albedo(vec3(albedo)).x;\n    const float boundary = "
                "dipole_boundary(1.0);\n    float sum = 0.0;\n"
                "    for (int i = 0; i < ") +
                n + "; ++i) {\n        const vec3 tap = burley_tap(i, " + n +
                ", s.x, 6.2831853 * p.turn);\n"
                "        const float r = max(tap.z, 1e-4);\n"
                "        sum += irradiance_at(p, tap.xy) * r * dipole_profile(r, vec3(a), vec3(1.0 - a), boundary).x / "
                "burley_profile_r(r, s).x;\n    }\n"
                "    return vec3(sum / " +
                n + ".0);\n}");
    add("transmittance", "Burley's, of the thickness alone; before, Lambert's",
        "#include \"subsurface.glsl\"\nvec3 shade(Point p) {\n    const vec3 s = burley_shape_diffuse(vec3(albedo));\n"
        "    return albedo * (clamped_cosine(p) + irradiance_behind(p, vec2(0.0)) * burley_transmittance(p.thickness, s));\n}");
    add("multipole", "a slab's dipole with all its images, of the thickness alone; before, Lambert's",
        "#include \"subsurface.glsl\"\nvec3 shade(Point p) {\n    const vec3 a = single_scattering_albedo(vec3(albedo));\n"
        "    return albedo * clamped_cosine(p) +\n"
        "           irradiance_behind(p, vec2(0.0)) * multipole_transmittance(p.thickness, a, 1.0 - a, "
        "dipole_boundary(1.0));\n}");
    for (const char* n : {"16", "64"})
        add(std::string("burley_through_") + n, "taps over the disc before and the disc behind, by the profile",
            std::string(
                "#include \"subsurface.glsl\"\nvec3 shade(Point p) {\n    const float s = burley_shape_diffuse(vec3(albedo)).x;\n"
                "    float sum = 0.0;\n    for (int i = 0; i < ") +
                n + "; ++i)\n        sum += slab == 0.0 ? irradiance_at(p, burley_tap(i, " + n +
                ", s, 6.2831853 * p.turn).xy)\n"
                "             : irradiance_behind(p, burley_through_tap(i, " +
                n +
                ", s, p.thickness, 6.2831853 * p.turn).xy);\n"
                "    const float share = slab == 0.0 ? 1.0 : burley_transmittance(p.thickness, vec3(s)).x;\n"
                "    return vec3(albedo * share * sum / " +
                n + ".0);\n}");
    for (const char* scene : {"edge", "edge_bright"})
        for (const Expectation& e : ascending(Metric::rmse, {"burley_64", "separable_17", "lambert"}, scene))
            f.expectations.push_back(e);
    for (const char* scene : {"sphere_5", "sphere_20"})
        for (const Expectation& e : ascending(Metric::rmse, {"burley_64", "separable_17", "preintegrated_sphere", "wrap"}, scene))
            f.expectations.push_back(e);
    f.expectations.push_back(
        {Metric::rmse, Relation::near, "preintegrated_table", "preintegrated_sphere", 1.1, "sphere_5", "a table loses little"});
    for (const Expectation& e : ascending(Metric::time, {"burley_16", "burley_32", "burley_64"}, "edge"))
        f.expectations.push_back(e);
    for (const Expectation& e : ascending(Metric::time, {"separable_7", "separable_17", "separable_25"}, "edge"))
        f.expectations.push_back(e);
    // Through a slab.
    for (const char* black : {"lambert", "wrap", "preintegrated_sphere", "separable_25", "burley_64", "dipole_64"})
        f.expectations.push_back({Metric::bias, Relation::at_least, black, "", 0.85, "slab",
                                  "no term, no light: 1, less what the reference's noise leaves open"});
    for (const char* scene : {"slab", "slab_edge"}) {
        for (const char* through : {"transmittance", "multipole", "burley_through_64"})
            f.expectations.push_back(
                {Metric::rmse, Relation::below, through, "burley_64", 2.0, scene, "any term is better than none"});
        f.expectations.push_back({Metric::rmse, Relation::below, "multipole", "transmittance", 1.0, scene,
                                  "a slab's own diffusion, not a half space's"});
    }
    f.expectations.push_back({Metric::rmse, Relation::below, "burley_through_64", "transmittance", 2.0, "slab_edge",
                              "light that comes through comes from aside too"});
    f.expectations.push_back({Metric::rmse, Relation::near, "burley_through_64", "transmittance", 1.5, "slab",
                              "the same where all of the back is lit"});
    f.timed_scene = 3;
    mark_random(f, {"burley_", "dipole_"});
    return f;
}

}  // namespace kiln::report
