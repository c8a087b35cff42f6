// How many cascades, where to split them, how wide to blend: edges of shadows up to a kilometre away.
#include "compiler/report/families/families.h"
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

std::vector<Choice> choices() {
    std::vector<Choice> out{{"one", 1, 0.75, 0.0}, {"two", 2, 0.75, 0.0}, {"three", 3, 0.75, 0.0}, {"four", 4, 0.75, 0.0}};
    out.push_back({"four_even", 4, 0.0, 0.0});
    out.push_back({"four_half", 4, 0.5, 0.0});
    out.push_back({"four_logarithmic", 4, 1.0, 0.0});
    out.push_back({"four_blend_5", 4, 0.75, 0.05});
    out.push_back({"four_blend_10", 4, 0.75, 0.1});
    return out;
}

struct Fitted {
    std::vector<reference::CascadeFit> layers;
    std::vector<double> ends;
};
Fitted fit(const Choice& choice, uint32_t size) {
    Fitted out;
    out.ends = reference::practical_splits(near, far, choice.count, choice.lambda);
    const reference::LightAxes axes = reference::light_axes(light);
    for (int i = 0; i < choice.count; ++i) {
        // A slice starts where the last one begins to blend into it.
        const double start = i == 0 ? near : out.ends[static_cast<size_t>(i) - 1] * (1.0 - choice.band);
        const auto ball = reference::slice_sphere(start, out.ends[static_cast<size_t>(i)], 0.6, 0.4);
        out.layers.push_back(
            reference::fit_cascade({0.0, eye_height, -ball.depth}, ball.radius, axes, static_cast<int>(size), 200.0));
    }
    return out;
}

// Depth of a layer: where each texel's ray meets a slat, else the ground.
std::vector<float> layer_depths(const reference::CascadeFit& layer, uint32_t size) {
    const reference::LightAxes axes = reference::light_axes(light);
    std::vector<float> out;
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x) {
            const Vec3d across = axes.right * (layer.origin[0] + (x + 0.5) * layer.texel) +
                                 axes.down * (layer.origin[1] + (y + 0.5) * layer.texel);
            const auto at_height = [&](double height) { return across + axes.forward * ((height - across.y) / axes.forward.y); };
            Vec3d hit = at_height(roof);
            if (!slat(hit.x, hit.z)) hit = at_height(0.0);
            const auto clip = layer.clip_of_world * reference::Vec4<double>{hit.x, hit.y, hit.z, 1.0};
            out.push_back(static_cast<float>(std::min(std::max(clip.z, 0.0), 1.0)));
        }
    return out;
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
    f.fields = {{"vec3", "position"}, {"float", "depth"}};
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
    const auto add = [&](const Choice& choice, const std::string& name, const std::string& what, const std::string& call) {
        Member m;
        m.name = name;
        m.what = what;
        // A step of a few units in the last place either way, and no other difference.
        const std::string seams = choice.count == 1
                                      ? "vec3 shade(Point p) { return vec3(1.0); }"
                                      : "vec3 shade(Point p) {\n    const float end = ends[int(p.depth * " +
                                            std::to_string(choice.count - 1) +
                                            ".0)];\n    const vec3 at = vec3(p.position.xy, -end);\n"
                                            "    return 1.0 - abs(light(at, end * 0.999999) - light(at, end * 1.000001));\n}";
        for (const Scene& s : f.scenes)
            m.scene_glsl[s.name] =
                "#include \"cascades.glsl\"\n#include \"lecture_shadow.glsl\"\nvec3 light(vec3 position, float "
                "depth) {\n" +
                call + "}\n" + (s.name == "seams" ? seams : "vec3 shade(Point p) { return light(p.position, p.depth); }");
        // The maps are the same in every scene.
        const auto made = std::make_shared<std::vector<Resource>>();
        m.resources = [choice, made](size_t, Bench&, const Effort&) -> Result<std::vector<Resource>> {
            if (!made->empty()) return *made;
            constexpr uint32_t size = 512;
            const Fitted fitted = fit(choice, size);
            std::vector<float> texels, block;
            for (size_t i = 0; i < 4; ++i) {
                const auto& layer = fitted.layers[std::min(i, fitted.layers.size() - 1)];
                if (i < fitted.layers.size()) {
                    const std::vector<float> one = layer_depths(layer, size);
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
            *made = {depth_array("maps", size, static_cast<uint32_t>(fitted.layers.size()), texels),
                     uniform_buffer("uniform Cascades { mat4 clip_of_world[4]; vec4 ends; vec4 bias; }", block)};
            return *made;
        };
        f.members.push_back(std::move(m));
    };
    for (const Choice& c : choices()) {
        const std::string n = std::to_string(c.count);
        add(c, c.name, n + " cascades, lambda " + digits(c.lambda) + ", blend " + digits(100.0 * c.band) + " %",
            "    const CascadeChoice choice = choose_cascade(depth, 2.0, ends, " + n + ", " + std::to_string(c.band) +
                ");\n"
                "    return vec3(cascaded_shadow(maps, clip_of_world, bias, position, choice));\n");
    }
    add(choices()[3], "four_no_gradients", "four cascades, no blend, and a look-up that names no level: not for divergent pixels",
        "    const CascadeChoice choice = choose_cascade(depth, 2.0, ends, 4, 0.0);\n    if (choice.index < 0) return "
        "vec3(1.0);\n"
        "    const vec4 place = shadow_coordinates(clip_of_world[choice.index] * vec4(position, 1.0));\n"
        "    const float lit = texture(maps, vec4(place.xy, float(choice.index), place.z - bias[choice.index]));\n"
        "    return vec3(place.w > 0.0 ? lit : 1.0);\n");
    add(choices()[3], "four_lecture", "the lecture's steps: all four sampled, one kept, no bias",
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
    return f;
}

}  // namespace kiln::report
