// Shadows of a square light through a map: hard, filtered, by variance, by percentage-closer soft shadows, and traced.
#include "compiler/report/families/families.h"
#include "compiler/report/resources.h"
#include "uber/reference/shadow_truth.h"

namespace kiln::report {

namespace {

using reference::ShadowScene;

constexpr double moment_reference = 0.35;  // in units of far: blockers from 3 m on, the receiver at 10 m
const reference::LightView view;           // near 1, far 20, two metres wide at one metre

struct Setting {
    std::string name, what;
    ShadowScene scene;
    double span;  // metres from the middle of the picture to its sides
};

std::vector<Setting> settings() {
    return {{"edge", "A straight edge at 6 m, parallel to a side of the light.", reference::edge_scene(6), 1.5},
            {"square_4", "A square of two metres at 4 m.", reference::square_scene(4), 4.5},
            {"square_7", "A square of two metres at 7 m.", reference::square_scene(7), 2.5},
            {"square_9", "A square of two metres at 9 m.", reference::square_scene(9), 1.7},
            {"stacked",
             "An edge at 3 m and, at 9 m, a sheet that leaves only a strip at the right: no light but there.",
             {{{{-100, 0, -100, 100}, 3}, {{-100, 1.5, -100, 100}, 9}}, 10, 1, false},
             3.0},
            {"fence", "Sixteen slats at 6 m.", reference::fence_scene(), 3.0}};
}

const char* const point_text = R"(
const float light_near = 1.0, light_far = 20.0, light_extent = 2.0, light_size = 1.0, receiver = 10.0;
Point point_at(vec2 u) {
    Point p;
    p.place = (u * 2.0 - 1.0) * span;
    p.clip = vec4(p.place * (2.0 / light_extent), light_far * (receiver - light_near) / (light_far - light_near), receiver);
    const uint seed = hash(floatBitsToUint(p.place.x) ^ hash(floatBitsToUint(p.place.y)));
    p.jitter = vec2(unit(seed), unit(hash(seed)));
    return p;
}
)";

Scene scene_of(const Setting& setting, bool quick) {
    Scene s;
    s.name = setting.name;
    s.what = setting.what + " A light one metre wide shines on a plane at 10 m.";
    s.width = s.height = quick ? 64 : 128;
    s.truth = "polygons of the light cut by the occluders' shadows, exact";
    s.glsl = "const float span = " + std::to_string(setting.span) + ";\n" + point_text;
    s.reference = [setting, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        Reference out = per_point(points, w, h, effort, [&](size_t i) {
            return reference::splat3(reference::visible_share(setting.scene, points.scalar(i, 0), points.scalar(i, 1)));
        });
        for (size_t i = 0; i < out.picture.pixels(); ++i)
            out.region.push_back(out.picture.rgb[3 * i] > 1e-9 && out.picture.rgb[3 * i] < 1.0 - 1e-9);
        return out;
    };
    return s;
}

std::vector<double> distances(size_t scene, uint32_t size) {
    return reference::distance_map(settings()[scene].scene, view, static_cast<int>(size));
}

std::vector<float> depths(size_t scene, uint32_t size) {
    std::vector<float> out;
    for (const double d : distances(scene, size)) out.push_back(static_cast<float>(view.depth(d)));
    return out;
}

// (q, q^2), and every mip as a plain mean.
std::vector<std::vector<float>> moment_mips(size_t scene, uint32_t size) {
    std::vector<double> level;
    for (const double d : distances(scene, size)) {
        const auto m = reference::shadow_moments(d, view.far, moment_reference);
        level.insert(level.end(), {m.x, m.y});
    }
    std::vector<std::vector<float>> out;
    for (uint32_t n = size;; n /= 2) {
        out.emplace_back(level.begin(), level.end());
        if (n == 1) return out;
        std::vector<double> next(size_t{n / 2} * (n / 2) * 2);
        for (uint32_t y = 0; y < n / 2; ++y)
            for (uint32_t x = 0; x < n / 2; ++x)
                for (uint32_t c = 0; c < 2; ++c) {
                    const size_t at = 2 * (size_t{2 * y} * n + 2 * x) + c;
                    next[2 * (size_t{y} * (n / 2) + x) + c] =
                        (level[at] + level[at + 2] + level[at + 2 * n] + level[at + 2 * n + 2]) / 4.0;
                }
        level = std::move(next);
    }
}

std::vector<float> summed_moments(size_t scene, uint32_t size) {
    const std::vector<double> d = distances(scene, size);
    std::vector<double> sums(d.size() * 2);
    for (uint32_t y = 0; y < size; ++y) {
        double row[2] = {0, 0};
        for (uint32_t x = 0; x < size; ++x) {
            const auto m = reference::shadow_moments(d[size_t{y} * size + x], view.far, moment_reference);
            row[0] += m.x;
            row[1] += m.y;
            for (uint32_t c = 0; c < 2; ++c)
                sums[2 * (size_t{y} * size + x) + c] = row[c] + (y == 0 ? 0.0 : sums[2 * (size_t{y - 1} * size + x) + c]);
        }
    }
    return {sums.begin(), sums.end()};
}

SamplerState plain(Filter filter, MipFilter mips) {
    SamplerState s;
    s.filter = filter;
    s.mips = mips;
    s.wrap = Wrap::clamp;
    return s;
}

}  // namespace

Family shadow_family(bool quick) {
    Family f;
    f.number = 6;
    f.name = "shadow";
    f.title = "Shadows of an area light";
    f.what =
        "Visible share of a square light, from one map made at its centre or by rays. Maps of 512 x 512 texels but where the "
        "name says "
        "another size; a fixed filter is as wide as the penumbra of a blocker at 6 m.";
    f.primary = Metric::region_rmse;
    f.region = "the penumbra, where part of the light is seen";
    f.fields = {{"vec2", "place"}, {"vec4", "clip"}, {"vec2", "jitter"}};
    for (const Setting& s : settings()) f.scenes.push_back(scene_of(s, quick));

    using Maps = std::vector<Resource>;
    const auto add = [&](const std::string& name, const std::string& what, const std::string& glsl,
                         std::function<Maps(size_t)> maps) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = glsl;
        m.resources = [maps = std::move(maps)](size_t scene, Bench&, const Effort&) -> Result<Maps> { return maps(scene); };
        f.members.push_back(std::move(m));
    };
    const std::string bias = "const float bias = 1e-5;\nconst vec2 filter_width = vec2(0.0333333);  // 0.667 of 20 metres\n";
    for (const uint32_t size : quick ? std::vector<uint32_t>{512} : std::vector<uint32_t>{512, 1024, 2048, 4096})
        add(size == 512 ? "hard" : "hard_" + std::to_string(size), "one comparison with the nearest texel",
            "#include \"shadow_map.glsl\"\n" + bias + "vec3 shade(Point p) { return vec3(shadow_factor_2d(map, p.clip, bias)); }",
            [size](size_t s) { return Maps{depth_map("map", size, depths(s, size), true, Filter::nearest)}; });
    const auto filtered = [&](const std::string& name, const std::string& what, const std::string& call) {
        add(name, what,
            "#include \"pcf.glsl\"\n#include \"shadow_receiver.glsl\"\n" + bias +
                "vec3 shade(Point p) { const vec3 place = shadow_coordinates(p.clip).xyz; return vec3(" + call + "); }",
            [](size_t s) { return Maps{depth_map("map", 512, depths(s, 512), true, Filter::linear)}; });
    };
    for (const char* n : {"3", "5", "7"})
        filtered(std::string("pcf_") + n, "mean of n x n bilinear comparisons",
                 std::string("pcf_") + n + "(map, place, vec2(0.0), bias, filter_width)");
    for (const char* n : {"16", "32"})
        filtered(std::string("poisson_") + n, "points of a disk, turned by a hash of the pixel",
                 std::string("pcf_poisson_") + n + "(map, place, vec2(0.0), bias, 0.5 * filter_width, p.jitter.x)");
    for (const char* cut : {"0.0", "0.2"})
        add(std::string(cut) == "0.0" ? "vsm" : "vsm_cut", std::string("two moments from a mip chain, bleeding cut at ") + cut,
            "#include \"vsm.glsl\"\n" + bias +
                "vec3 shade(Point p) {\n    const vec2 m = mip_average(moments, shadow_coordinates(p.clip).xy, filter_width, "
                "10.0);\n"
                "    return vec3(vsm_factor(m, p.clip.w, light_far, 0.35, 1e-8, " +
                cut + "));\n}",
            [](size_t s) {
                return Maps{picture_map("moments", TexelFormat::rg32_float, 512, 512, moment_mips(s, 512),
                                        plain(Filter::linear, MipFilter::linear))};
            });
    for (const char* cut : {"0.0", "0.2"})
        add(std::string(cut) == "0.0" ? "vssm" : "vssm_cut",
            std::string("two moments from a summed-area table, penumbra from the mean blocker, cut at ") + cut,
            "#include \"vsm.glsl\"\n"
            "vec3 shade(Point p) {\n    return vec3(vssm_factor(sat, p.clip, light_size, light_near, light_far, light_extent, "
            "1.0 / 512.0, 0.35, 1e-6, " +
                std::string(cut) + "));\n}",
            [](size_t s) {
                return Maps{picture_map("sat", TexelFormat::rg32_float, 512, 512, {summed_moments(s, 512)},
                                        plain(Filter::nearest, MipFilter::none))};
            });
    add("vssm_mips", "two moments from a mip chain, penumbra from the mean blocker",
        "#include \"vsm.glsl\"\n"
        "vec3 shade(Point p) {\n    return vec3(vssm_factor_mips(moments, 10.0, p.clip, light_size, light_near, light_far, "
        "light_extent, 1.0 / 512.0, 0.35, 1e-8, 0.0));\n}",
        [](size_t s) {
            return Maps{picture_map("moments", TexelFormat::rg32_float, 512, 512, moment_mips(s, 512),
                                    plain(Filter::linear, MipFilter::linear))};
        });
    const auto pcss = [&](int taps, uint32_t size) {
        const std::string n = std::to_string(taps);
        add("pcss_" + n + "_" + n + (size == 512 ? "" : "_" + std::to_string(size)),
            n + " taps for blockers and " + n + " for the filter",
            "#define PCSS_BLOCKER_TAPS " + n + "\n#define PCSS_FILTER_TAPS " + n + "\n#include \"pcss.glsl\"\n" + bias +
                "vec3 shade(Point p) {\n    return vec3(pcss_factor(depth_map, map, p.clip, vec2(0.0), bias, light_size, "
                "light_near, light_far,\n"
                "        light_extent, 1.0 / " +
                std::to_string(size) + ".0, p.jitter));\n}",
            [size](size_t s) {
                const std::vector<float> d = depths(s, size);
                return Maps{depth_map("depth_map", size, d, false, Filter::nearest),
                            depth_map("map", size, d, true, Filter::linear)};
            });
    };
    for (const int taps : {16, 32, 64}) pcss(taps, 512);
    if (!quick) pcss(64, 2048);
    for (const int rays : {1, 4, 16, 64}) {
        const std::string n = std::to_string(rays);
        add("traced_" + n, "rays to points of the light against the occluders themselves",
            "vec3 shade(Point p) {\n    float seen = 0.0;\n    for (int i = 0; i < " + n +
                "; ++i) {\n"
                "        const vec2 at = (fract(p.jitter + float(i) * vec2(0.754877666, 0.569840291)) - 0.5) * light_size;\n"
                "        float clear = 1.0;\n        const int count = int(occluders[0].x + 0.5);\n        for (int k = 0; k < "
                "count; ++k) {\n"
                "            const vec4 shape = occluders[1 + 2 * k];\n"
                "            const vec2 hit = mix(at, p.place, occluders[2 + 2 * k].x / receiver);\n"
                "            if (hit.x >= shape.x && hit.x < shape.y && hit.y >= shape.z && hit.y < shape.w) clear = 0.0;\n      "
                "  }\n"
                "        seen += clear;\n    }\n    return vec3(seen / " +
                n + ".0);\n}",
            [](size_t s) {
                const ShadowScene scene = settings()[s].scene;
                std::vector<float> v{static_cast<float>(scene.occluders.size()), 0, 0, 0};
                for (const auto& o : scene.occluders)
                    for (const double x : {o.shape.x0, o.shape.x1, o.shape.y0, o.shape.y1, o.distance, 0.0, 0.0, 0.0})
                        v.push_back(static_cast<float>(x));
                v.resize(4 * 33);
                return Maps{storage_buffer("readonly buffer Occluders { vec4 occluders[]; }", v)};
            });
    }

    const auto expect = [&](Metric metric, const char* a, const char* b, const char* scene, const char* because) {
        f.expectations.push_back({metric, Relation::below, a, b, 1.0, scene, because});
    };
    for (const char* soft : {"pcf_5", "vsm", "vssm", "vssm_mips", "pcss_32_32"})
        expect(Metric::region_rmse, soft, "hard", "edge", "hard is worst in the penumbra");
    for (Expectation& e : ascending(Metric::rmse, {"pcf_7", "pcf_5", "pcf_3"}, "edge")) f.expectations.push_back(e);
    expect(Metric::region_rmse, "pcss_64_64", "pcf_7", "square_4", "a fixed filter is right at one distance only");
    expect(Metric::region_rmse, "pcss_64_64", "pcf_7", "square_9", "a fixed filter is right at one distance only");
    expect(Metric::rmse, "hard", "vsm", "stacked", "light bleeds between two blockers");
    expect(Metric::rmse, "hard", "vssm", "stacked", "light bleeds between two blockers");
    expect(Metric::rmse, "vssm_cut", "vssm", "stacked", "cutting the dim end");
    expect(Metric::region_rmse, "vssm", "vssm_mips", "square_7", "trilinear texels are no box");
    for (const char* scene : {"edge", "square_4", "square_7", "square_9", "fence"})
        expect(Metric::rmse, "pcss_64_64", "vssm", scene, "PCSS at most as wrong as VSSM");
    for (Expectation& e : ascending(Metric::rmse, {"traced_64", "traced_16", "traced_4", "traced_1"}))
        f.expectations.push_back(e);
    for (Expectation& e : ascending(Metric::time, {"hard", "pcf_3", "pcf_5", "pcf_7"})) f.expectations.push_back(e);
    for (Expectation& e : ascending(Metric::time, {"pcss_16_16", "pcss_32_32", "pcss_64_64"})) f.expectations.push_back(e);
    expect(Metric::region_rmse, "vssm", "vssm_mips", "square_4", "a box where the light is square, not a blend of levels");
    expect(Metric::time, "vssm", "pcss_16_16", "", "VSSM is the cheapest soft shadow");
    expect(Metric::time, "vssm_mips", "vssm", "", "two look-ups for eight");
    mark_random(f, {"poisson_", "pcss_", "traced_"});
    return f;
}

}  // namespace kiln::report
