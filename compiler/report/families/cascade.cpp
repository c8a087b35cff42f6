// How many cascades, where to split them, how wide to blend: edges of shadows up to a kilometre away.
#include <algorithm>
#include <array>

#include "compiler/report/families/families.h"
#include "compiler/report/families/terrain.h"
#include "compiler/report/resources.h"
#include "uber/reference/cascades.h"

namespace kiln::report {

namespace {

constexpr double near = 2.0, far = 1000.0, eye_height = 2.0, roof = 6.0, period = 19.7;
const Vec3d light = normalize(Vec3d{0.4, -0.8, -0.45});
const Vec3d stripes = normalize(Vec3d{0.83, 0.0, 0.56});  // what lies across them

// Slats at 6 metres over flat ground: a point is in shadow where the way to the light goes through one.
bool slat(double x, double z) {
    const double t = (x * stripes.x + z * stripes.z) / period;
    return t - std::floor(t) < 0.5;
}
bool lit(const Vec3d& ground) {
    const double up = roof / -light.y;
    return !slat(ground.x - light.x * up, ground.z - light.z * up);
}

struct Choice {
    std::string name;
    int count;
    double lambda, band;
};

// Everything: counts, splits and bands. When quick: counts alone, splits alone and bands alone.
std::vector<Choice> choices(bool quick) {
    std::vector<Choice> out{{"one", 1, 0.75, 0.0}};
    const char* const counts[] = {"one", "two", "three", "four"};
    const std::pair<double, const char*> splits[] = {{0.75, ""}, {0.0, "_even"}, {0.5, "_half"}, {1.0, "_logarithmic"}};
    const std::pair<double, const char*> bands[] = {{0.0, ""}, {0.05, "_blend_5"}, {0.1, "_blend_10"}};
    for (const auto& [band, band_name] : bands)
        for (const auto& [lambda, split_name] : splits)
            for (int count = 2; count <= 4; ++count) {
                const int odd = (count != 4 ? 1 : 0) + (lambda != 0.75 ? 1 : 0) + (band != 0.0 ? 1 : 0);
                if (!quick || odd < 2)
                    out.push_back({counts[count - 1] + std::string(split_name) + band_name, count, lambda, band});
            }
    return out;
}

struct Fitted {
    std::vector<reference::CascadeFit> layers;
    std::vector<double> ends;
};
Fitted fit(const Choice& choice, uint32_t size, const Vec3d& direction) {
    Fitted out;
    out.ends = reference::practical_splits(near, far, choice.count, choice.lambda);
    const reference::LightAxes axes = reference::light_axes(direction);
    for (int i = 0; i < choice.count; ++i) {
        // A slice starts where the last one begins to blend into it.
        const size_t at = static_cast<size_t>(i);
        const double before = i > 1 ? out.ends[at - 2] : near;
        const double start = i == 0 ? near : out.ends[at - 1] - choice.band * (out.ends[at - 1] - before);
        const auto ball = reference::slice_sphere(start, out.ends[at], 0.6, 0.4);
        out.layers.push_back(
            reference::fit_cascade({0.0, eye_height, -ball.depth}, ball.radius, axes, static_cast<int>(size), 200.0));
    }
    return out;
}

// Depth of a layer: where each texel's ray meets a slat or a hill, else the ground.
std::vector<float> layer_depths(const reference::CascadeFit& layer, uint32_t size, const Vec3d& direction, const Terrain* hills,
                                const Effort& effort) {
    const reference::LightAxes axes = reference::light_axes(direction);
    std::vector<float> out(size_t{size} * size);
    effort.jobs.each(size, [&](size_t y) {
        const double v = layer.origin[1] + (static_cast<double>(y) + 0.5) * layer.texel;
        const std::vector<size_t> row = hills ? hills->hills_near(v) : std::vector<size_t>();
        for (uint32_t x = 0; x < size; ++x) {
            const double u = layer.origin[0] + (x + 0.5) * layer.texel;
            const Vec3d across = axes.right * u + axes.down * v;
            const auto at_height = [&](double height) { return across + axes.forward * ((height - across.y) / axes.forward.y); };
            Vec3d hit = hills ? across + axes.forward * hills->first_hit(u, v, row) : at_height(roof);
            if (!hills && !slat(hit.x, hit.z)) hit = at_height(0.0);
            const auto clip = layer.clip_of_world * reference::Vec4<double>{hit.x, hit.y, hit.z, 1.0};
            out[y * size + x] = static_cast<float>(std::min(std::max(clip.z, 0.0), 1.0));
        }
    });
    return out;
}

std::string constant(const char* name, const Vec3d& v) {
    char text[120];
    std::snprintf(text, sizeof text, "const vec3 %s = vec3(%.9g, %.9g, %.9g);\n", name, v.x, v.y, v.z);
    return text;
}

}  // namespace

Family cascade_family(bool quick) {
    Family f;
    f.number = 7;
    f.name = "cascade";
    f.title = "Cascades of a directional light";
    f.what =
        "Shadows of slats on flat ground, hard and without filter, from maps of 512 x 512 texels a cascade. Where the picture is "
        "wrong an "
        "edge lies in the wrong place: RMSE squared, times the 40 metres that a row is wide, is how much of each row that is.";
    f.primary = Metric::rmse;
    f.fields = {{"vec3", "position"}, {"float", "depth"}, {"vec3", "normal"}, {"vec4", "lit"}, {"vec4", "counted"}};
    const struct {
        const char *name, *what;
        double first, last;
    } ranges[] = {{"whole", "2 m to 1 km from bottom to top, by powers.", near, far * 0.98},
                  {"close", "2 m to 20 m.", near, 20.0},
                  {"middle", "20 m to 150 m.", 20.0, 150.0},
                  {"distant", "150 m to 1 km.", 150.0, far * 0.98}};
    for (const auto& range : ranges) {
        Scene s;
        s.name = range.name;
        s.what = std::string("Depths of ") + range.what;
        s.width = s.height = quick ? 96 : 192;
        char text[120];
        std::snprintf(text, sizeof text, "const float first = %.9g, last = %.9g;\n", range.first, range.last);
        s.glsl = std::string(text) + R"(
Point point_at(vec2 u) {
    Point p;
    p.normal = vec3(0.0, 1.0, 0.0);
    p.lit = p.counted = vec4(0.0);
    p.depth = first * exp2(log2(last / first) * (1.0 - u.y));
    p.position = vec3((u.x * 2.0 - 1.0) * min(20.0, 0.5 * p.depth), 0.0, -p.depth);
    return p;
}
)";
        s.truth = "the way to the light, in double precision";
        s.reference = [w = s.width, h = s.height](const Points& points, const Effort& effort) {
            return per_point(points, w, h, effort,
                             [&](size_t i) { return reference::splat3(lit(points.vector(i, 0)) ? 1.0 : 0.0); });
        };
        f.scenes.push_back(std::move(s));
    }
    {
        Scene s;
        s.name = "seams";
        s.what =
            "1 less how much the light of a point changes where one cascade takes over from the next: points on the ends of "
            "slices, one after the other from bottom to top, forty metres wide. RMSE squared is the share of a seam that jumps; "
            "with one "
            "cascade there is none.";
        s.width = s.height = quick ? 96 : 192;
        s.glsl = R"(
Point point_at(vec2 u) {
    Point p;
    p.normal = vec3(0.0, 1.0, 0.0);
    p.lit = p.counted = vec4(0.0);
    p.position = vec3(u.x * 40.0 - 20.0, 0.0, 0.0);
    p.depth = 1.0 - u.y;
    return p;
}
)";
        s.truth = "light has no seams: 1 everywhere";
        s.reference = [w = s.width, h = s.height](const Points& points, const Effort& effort) {
            return per_point(points, w, h, effort, [](size_t) { return reference::splat3(1.0); });
        };
        f.scenes.push_back(std::move(s));
    }
    const auto terrain = std::make_shared<const Terrain>();
    const size_t first_of_hills = f.scenes.size();
    {
        Scene s;
        s.name = "terrain";
        s.what = "A kilometre of ground and round hills under a low sun, seen from two metres above it: light times n.l.";
        s.width = s.height = quick ? 96 : 192;
        s.resources = {hills_buffer(*terrain)};
        s.glsl = constant("to_light", -terrain->light()) + terrain_view;
        s.truth = "spheres along the light, in double precision";
        s.reference = [terrain, w = s.width, h = s.height](const Points& points, const Effort& effort) {
            return per_point(points, w, h, effort, [&](size_t i) {
                const double cosine = -dot(normalize(points.vector(i, 4)), terrain->light());
                const bool sky = points.scalar(i, 3) >= 2000.0;
                return reference::splat3(sky ? 1.0 : cosine > 0.0 && terrain->lit(points.vector(i, 0)) ? cosine : 0.0);
            });
        };
        f.scenes.push_back(std::move(s));
    }
    const std::vector<std::string> edge_ranges =
        quick ? std::vector<std::string>{"whole"} : std::vector<std::string>{"whole", "close", "middle", "distant"};
    for (const auto& range : ranges) {
        if (std::find(edge_ranges.begin(), edge_ranges.end(), range.name) == edge_ranges.end()) continue;
        Scene s;
        s.name = std::string(range.name) == "whole" ? "edges" : std::string("edges_") + range.name;
        s.what = std::string(
                     "1 and how many metres, of twenty along a line across an edge of a hill's shadow on the ground, are lit "
                     "wrongly: how far the edge is off. RMSE is in metres. Depths of ") +
                 range.what;
        s.width = s.height = quick ? 32 : 64;
        s.resources = {edges_buffer(terrain->edges(s.height, s.width, std::max(range.first, 5.0), range.last))};
        s.glsl =
            "const int columns = " + std::to_string(s.width) + ", rows = " + std::to_string(s.height) + ";\n" + terrain_edges;
        s.truth = "an edge is where it is: 1 everywhere";
        s.reference = [w = s.width, h = s.height](const Points& points, const Effort& effort) {
            return per_point(points, w, h, effort, [](size_t) { return reference::splat3(1.0); });
        };
        f.scenes.push_back(std::move(s));
    }
    // The ground of the hills' sun rises 2.16 texels of depth a texel; steeper places have more of the bias.
    const std::string terrain_shade =
        constant("sun", -terrain->light()) +
        "vec3 shade(Point p) {\n    const float cosine = dot(p.normal, sun);\n    if (cosine <= 0.0) return vec3(0.0);\n"
        "    const float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 1e-3);\n"
        "    return light(p.position, p.depth, clamp(slope / 2.16, 1.0, 8.0)) * cosine;\n}\n";
    const std::string edges_shade = R"(
vec3 shade(Point p) {
    float wrong = 0.0;
    for (int k = 0; k < 64; ++k) {
        const uint bit = 1u << (k % 16);
        if ((uint(p.counted[k / 16]) & bit) == 0u) continue;
        const float a = (float(k) - 32.0) / 32.0, b = a + 1.0 / 32.0, side = 0.5 * (a + b);
        const vec3 at = p.position + vec3(10.0 * side * side * side, 0.0, 0.0);
        const float truth = (uint(p.lit[k / 16]) & bit) != 0u ? 1.0 : 0.0;
        wrong += abs(light(at, p.depth, 1.0).x - truth) * 10.0 * (b * b * b - a * a * a);
    }
    return vec3(1.0 + wrong);
}
)";
    const auto add = [&](const Choice& choice, const std::string& name, const std::string& what, const std::string& call,
                         bool compared = true, const std::string& before = "") {
        Member m;
        m.name = name;
        m.what = what;
        // A step of a few units in the last place either way, and no other difference.
        const std::string seams =
            choice.count == 1
                ? "vec3 shade(Point p) { return vec3(1.0); }"
                : "vec3 shade(Point p) {\n    const float end = ends[int(p.depth * " + std::to_string(choice.count - 1) +
                      ".0)];\n    const vec3 at = vec3(p.position.xy, -end);\n"
                      "    return 1.0 - abs(light(at, end * 0.999999, 1.0) - light(at, end * 1.000001, 1.0));\n}";
        for (const Scene& s : f.scenes)
            m.scene_glsl[s.name] =
                "#include \"cascades.glsl\"\n#include \"lecture_shadow.glsl\"\n" + before +
                "vec3 light(vec3 position, float "
                "depth, float steep) {\n" +
                call + "}\n" +
                (s.name == "seams"             ? seams
                 : s.name == "terrain"         ? terrain_shade
                 : s.name.starts_with("edges") ? edges_shade
                                               : "vec3 shade(Point p) { return light(p.position, p.depth, 1.0); }");
        // The maps are the same in every scene of slats, and in every scene of hills.
        const auto made = std::make_shared<std::array<std::vector<Resource>, 2>>();
        m.resources = [choice, made, terrain, first_of_hills, compared](size_t scene, Bench&,
                                                                        const Effort& effort) -> Result<std::vector<Resource>> {
            const Terrain* const hills = scene >= first_of_hills ? terrain.get() : nullptr;
            std::vector<Resource>& out = (*made)[hills ? 1 : 0];
            if (!out.empty()) return out;
            constexpr uint32_t size = 512;
            const Vec3d& direction = hills ? hills->light() : light;
            const Fitted fitted = fit(choice, size, direction);
            std::vector<float> texels, block;
            for (size_t i = 0; i < 4; ++i) {
                const auto& layer = fitted.layers[std::min(i, fitted.layers.size() - 1)];
                if (i < fitted.layers.size()) {
                    const std::vector<float> one = layer_depths(layer, size, direction, hills, effort);
                    texels.insert(texels.end(), one.begin(), one.end());
                }
                for (const auto& c : layer.clip_of_world.columns)
                    for (const double v : {c.x, c.y, c.z, c.w}) block.push_back(static_cast<float>(v));
            }
            for (size_t i = 0; i < 4; ++i)
                block.push_back(static_cast<float>(i < fitted.ends.size() ? fitted.ends[i] : fitted.ends.back()));
            // Depth that the slanted ground rises within half a texel either way, and a little.
            for (size_t i = 0; i < 4; ++i) {
                const auto& layer = fitted.layers[std::min(i, fitted.layers.size() - 1)];
                block.push_back(static_cast<float>(1.5 * layer.texel / layer.range));
            }
            out = {depth_array("maps", size, static_cast<uint32_t>(fitted.layers.size()), texels, compared),
                   uniform_buffer("uniform Cascades { mat4 clip_of_world[4]; vec4 ends; vec4 bias; }", block)};
            return out;
        };
        f.members.push_back(std::move(m));
    };
    const std::vector<Choice> all = choices(quick);
    for (const Choice& c : all) {
        const std::string n = std::to_string(c.count);
        add(c, c.name, n + " cascades, lambda " + digits(c.lambda) + ", blend " + digits(100.0 * c.band) + " %",
            "    const CascadeChoice choice = choose_cascade(depth, 2.0, ends, " + n + ", " + std::to_string(c.band) +
                ");\n"
                "    const int own = max(choice.index, 0), next = max(choice.next, 0);\n    const vec4 at = vec4(position, "
                "1.0);\n"
                "    return vec3(cascaded_shadow(maps, clip_of_world[own] * at, clip_of_world[next] * at, vec2(bias[own], "
                "bias[next]) * steep, choice));\n");
    }
    const Choice four = *std::find_if(all.begin(), all.end(), [](const Choice& c) { return c.name == "four"; });
    add(four, "four_no_gradients", "four cascades, no blend, and a look-up that names no level: not for divergent pixels",
        "    const CascadeChoice choice = choose_cascade(depth, 2.0, ends, 4, 0.0);\n    if (choice.index < 0) return "
        "vec3(1.0);\n"
        "    const vec4 place = shadow_coordinates(clip_of_world[choice.index] * vec4(position, 1.0));\n"
        "    const float lit = texture(maps, vec4(place.xy, float(choice.index), place.z - bias[choice.index] * steep));\n"
        "    return vec3(place.w > 0.0 ? lit : 1.0);\n");
    const auto look_up = [&](const std::string& name, const std::string& what, const std::string& function, bool compared) {
        add(four, name, what,
            "    const CascadeChoice choice = choose_cascade(depth, 2.0, ends, 4, 0.0);\n    if (choice.index < 0) return "
            "vec3(1.0);\n    return vec3(" +
                function +
                "(maps, clip_of_world[choice.index] * vec4(position, 1.0), choice.index, bias[choice.index] * steep));\n",
            compared);
    };
    add(four, "four_copied", "the same, all four matrices handed to a function, which copies them",
        "    const CascadeChoice choice = choose_cascade(depth, 2.0, ends, 4, 0.0);\n"
        "    return vec3(shadow_of(clip_of_world, position, choice, steep));\n",
        true,
        "float shadow_of(mat4 matrices[4], vec3 position, CascadeChoice choice, float steep) {\n"
        "    const int own = max(choice.index, 0), next = max(choice.next, 0);\n    const vec4 at = vec4(position, 1.0);\n"
        "    return cascaded_shadow(maps, matrices[own] * at, matrices[next] * at, vec2(bias[own], bias[next]) * steep, "
        "choice);\n}\n");
    look_up("four_unblended", "four cascades, no blend and no branch for it", "cascade_factor", true);
    look_up("four_gathered", "four cascades, no blend, the nearest texel of a gather of comparisons", "cascade_factor_gathered",
            true);
    look_up("four_fetched", "four cascades, no blend, the nearest texel fetched and compared", "cascade_factor_fetched", false);
    look_up("four_linear", "four cascades, no blend, the four texels of a gather weighed as a linear filter would",
            "cascade_factor_gathered_linear", true);
    add(four, "four_lecture", "the lecture's steps: all four sampled, one kept, no bias",
        "    mat4 matrices[4] = mat4[4](clip_of_world[0], clip_of_world[1], clip_of_world[2], "
        "clip_of_world[3]);\n"
        "    return vec3(cascaded_shadow_lecture(maps, matrices, position, 4, max(cascade_index(depth, ends, 4), 0)));\n");

    for (const Expectation& e : ascending(Metric::rmse, {"four", "three", "two", "one"}, "whole")) f.expectations.push_back(e);
    f.expectations.push_back(
        {Metric::rmse, Relation::below, "four_logarithmic", "four", 1.0, "close", "a logarithm spends texels near the eye"});
    f.expectations.push_back({Metric::rmse, Relation::below, "four", "four_even", 1.0, "close", ""});
    f.expectations.push_back(
        {Metric::rmse, Relation::below, "four_even", "four_logarithmic", 1.0, "distant", "and equal slices far from it"});
    f.expectations.push_back({Metric::time, Relation::near, "one", "four", 1.5, "whole", "chosen first, then sampled once"});
    f.expectations.push_back({Metric::time, Relation::below, "four", "four_lecture", 2.0, "whole", "four look-ups for one"});
    f.expectations.push_back({Metric::time, Relation::below, "four_no_gradients", "four_lecture", 2.0, "whole",
                              "the same where no look-up names its level"});
    f.expectations.push_back(
        {Metric::time, Relation::near, "four", "four_unblended", 1.2, "whole", "a band that is empty costs its branch"});
    f.expectations.push_back(
        {Metric::time, Relation::near, "four_blend_10", "four", 1.15, "whole", "at most the band's share of a look-up"});
    for (const char* m : {"four_blend_5", "four_blend_10"})
        f.expectations.push_back(
            {Metric::max_abs, Relation::at_most, m, "", 1e-3, "seams", "a blend is over where the slice ends"});
    f.expectations.push_back(
        {Metric::rmse, Relation::at_least, "four", "", 0.05, "seams", "without one edges jump by a texel of the coarser map"});
    f.expectations.push_back(
        {Metric::rmse, Relation::below, "four", "two", 1.0, "seams", "and by less, the closer the maps' texels are in size"});
    f.expectations.push_back(
        {Metric::rmse, Relation::below, "four", "four_lecture", 1.0, "whole", "no bias shadows the ground itself"});
    // Edges of the hills' shadows, in metres.
    for (const std::string& range : edge_ranges) {
        const std::string scene = range == "whole" ? "edges" : "edges_" + range;
        const double count[] = {2.0, 3.0, 4.0};
        const char* const names[] = {"two", "three", "four"};
        for (size_t i = 0; i < 3; ++i)
            f.expectations.push_back({Metric::rmse, Relation::below, names[i], "one", 0.75 * count[i], scene,
                                      "error falls as one over the number of cascades, or within a quarter of that"});
    }
    if (!quick) {
        f.expectations.push_back(
            {Metric::rmse, Relation::below, "four_logarithmic", "four_even", 4.0, "edges_close", "texels near the eye"});
        f.expectations.push_back({Metric::rmse, Relation::below, "four_even", "four_logarithmic", 1.0, "edges_distant", ""});
    }
    f.expectations.push_back({Metric::rmse, Relation::below, "four", "one", 1.0, "terrain", ""});
    for (const char* m : {"four_gathered", "four_fetched", "four_no_gradients", "four_copied", "four_unblended"})
        for (const char* s : {"whole", "terrain", "edges"})
            f.expectations.push_back({Metric::rmse, Relation::near, m, "four", 1.001, s, "the same texels, compared alike"});
    f.expectations.push_back(
        {Metric::rmse, Relation::below, "four_linear", "four", 1.0, "edges", "a linear filter knows parts of texels"});
    f.expectations.push_back(
        {Metric::time, Relation::below, "four", "four_copied", 2.0, "whole", "64 numbers copied a pixel to read 16 of them"});
    f.expectations.push_back({Metric::time, Relation::near, "four_unblended", "four_no_gradients", 1.1, "whole",
                              "zero gradients need no level to be found"});
    for (Expectation& e : ascending(Metric::time, {"four_fetched", "four_gathered", "four_linear"}, "whole"))
        f.expectations.push_back(std::move(e));
    if (!quick) {
        // In a slice a band of b costs b of a look-up; rows are spread by powers, so that a slice has less than its share.
        f.expectations.push_back(
            {Metric::time, Relation::near, "four_blend_5", "four", 1.05, "terrain", "at most the band's share"});
        f.expectations.push_back({Metric::time, Relation::near, "four_blend_10", "four", 1.1, "terrain", ""});
    }
    return f;
}

}  // namespace kiln::report
