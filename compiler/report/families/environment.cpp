// Specular light from an environment: blurred maps and tables against importance sampling and the integral.
#include <optional>

#include "compiler/report/bench.h"
#include "compiler/report/families/families.h"
#include "compiler/report/kernel.h"
#include "compiler/report/resources.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::report {

namespace {

constexpr uint32_t side = 128;  // of the environment's cube map
constexpr uint32_t levels = 6;  // of the prefiltered chain: 128 … 4

// Radiance as C++ and as GLSL, the same text twice; wide enough for a cube map of 128 texels a side.
struct Sky {
    std::string name, what, glsl;
    std::function<Vec3d(const Vec3d&)> radiance;
    std::optional<std::pair<Vec3d, double>> sun =
        {};  // a lamp of it that is narrower than what lies between half vectors: where, how narrow
};
double lamp(const Vec3d& d, const Vec3d& at, double narrow) { return std::exp(narrow * (dot(d, normalize(at)) - 1.0)); }

std::vector<Sky> skies() {
    return {{"studio", "three wide lamps in a grey room", "",
             [](const Vec3d& d) {
                 return reference::splat3(0.2) + Vec3d{6, 5, 4} * lamp(d, {0.5, 0.7, 0.5}, 30) +
                        Vec3d{1, 2, 4} * lamp(d, {-0.9, 0.1, 0.3}, 20) + Vec3d{2, 2, 2} * lamp(d, {0.1, -0.9, 0.4}, 10);
             }},
            {"sun", "a sky, a ground and a sun some degrees wide", "",
             [](const Vec3d& d) {
                 const double up = 0.5 + 0.5 * std::tanh(6.0 * d.y);
                 return Vec3d{0.25, 0.2, 0.15} * (1.0 - up) + Vec3d{0.5, 0.7, 1.0} * up +
                        Vec3d{300, 280, 240} * lamp(d, {0.4, 0.6, 0.6}, 1500);
             },
             std::pair(normalize(Vec3d{0.4, 0.6, 0.6}), 1500.0)},
            {"checker", "soft squares of 1.9 and 0.1", "", [](const Vec3d& d) {
                 return reference::splat3(
                     1.0 + 0.9 * std::tanh(6.0 * std::sin(7.0 * d.x) * std::sin(7.0 * d.y + 0.7) * std::sin(7.0 * d.z + 0.3)));
             }}};
}

const char* const point_text = R"(
const vec3 v = vec3(0.0, 0.0, 1.0);
Point point_at(vec2 u) {
    const vec2 grid = u * vec2(3.0, 2.0), tile = floor(grid), q = fract(grid) * 2.0 - 1.0;
    const float index = tile.x + 3.0 * tile.y;
    Point p;
    p.roughness = index < 0.5 ? 0.05 : index < 1.5 ? 0.1 : index < 2.5 ? 0.25 : index < 3.5 ? 0.5 : index < 4.5 ? 0.75 : 1.0;
    const float r2 = min(dot(q, q), 0.98);
    const vec2 at = q * sqrt(r2 / max(dot(q, q), 1e-6));
    p.n = vec3(at.x, -at.y, sqrt(1.0 - r2));
    return p;
}
)";

// The integral of a sky over GGX's lobe about n by the midpoint rule: over the lobe's own half vectors, tan(theta_h) = alpha
// tan(w), and, where there is a sun, over the sun's own directions, cos(theta) = 1 + ln(t) / narrow. Each takes its share by the
// balance heuristic (Veach and Guibas 1995, section 3.2), so that neither meets a peak that is narrower than its nodes.
class Lobe {
public:
    Lobe(const Sky& sky, const Vec3d& n, double roughness, const Vec3d& f0)
        : sky_(sky), n_(n), f0_(f0), roughness_(roughness), alpha_(roughness * roughness), n_dot_v_(dot(v, n)) {}

    Vec3d reflected(int nodes) const {
        Vec3d sum = over_half_vectors(nodes);
        return sky_.sun ? sum + over_sun(nodes) : sum;
    }

private:
    static constexpr Vec3d v{0, 0, 1};

    static std::pair<Vec3d, Vec3d> around(const Vec3d& axis) {
        const Vec3d t = normalize(cross(std::fabs(axis.z) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0}, axis));
        return {t, cross(axis, t)};
    }

    double cosine_to_half(const Vec3d& l) const { return dot(n_, normalize(l + v)); }
    double distribution(double c) const {
        const double d = c * c * (alpha_ * alpha_ - 1.0) + 1.0;
        return alpha_ * alpha_ / (reference::pi * d * d);
    }
    // Radiance towards the viewer of what comes from l, a steradian.
    Vec3d from(const Vec3d& l, double c) const {
        const double n_dot_l = dot(n_, l), v_dot_h = dot(v, normalize(l + v));
        if (n_dot_l <= 0.0 || v_dot_h <= 0.0) return {};
        const double g = reference::smith_g2(reference::SmithForm::height_correlated, n_dot_l, n_dot_v_, roughness_);
        const double x = 1.0 - v_dot_h, x5 = x * x * x * x * x;
        return sky_.radiance(l) * (f0_ + (reference::splat3(1.0) - f0_) * x5) * (distribution(c) * g / (4.0 * n_dot_v_));
    }
    // Of directions l, a steradian; both integrate to 1.
    double half_density(const Vec3d& l, double c) const {
        const double s2 = std::max(1.0 - c * c, 1e-300), w = std::atan2(std::sqrt(s2), alpha_ * c);
        const double slope = alpha_ / (std::cos(w) * std::cos(w) + alpha_ * alpha_ * std::sin(w) * std::sin(w));  // d theta / d w
        return 1.0 / (reference::pi * reference::pi * std::sqrt(s2) * slope * 4.0 * dot(v, normalize(l + v)));
    }
    double sun_density(const Vec3d& l) const {
        return sky_.sun ? sky_.sun->second / (2.0 * reference::pi) * std::exp(sky_.sun->second * (dot(l, sky_.sun->first) - 1.0))
                        : 0.0;
    }

    Vec3d over_half_vectors(int nodes) const {
        const auto [t, b] = around(n_);
        Vec3d sum;
        for (int i = 0; i < nodes; ++i) {
            const double w = (i + 0.5) * 0.5 * reference::pi / nodes, tangent = alpha_ * std::tan(w);
            const double c = 1.0 / std::sqrt(1.0 + tangent * tangent), s = tangent * c;
            for (int k = 0; k < 2 * nodes; ++k) {
                const double phi = (k + 0.5) * reference::pi / nodes;
                const Vec3d h = t * (s * std::cos(phi)) + b * (s * std::sin(phi)) + n_ * c;
                if (dot(v, h) <= 0.0) continue;
                const Vec3d l = h * (2.0 * dot(v, h)) - v;
                sum = sum + from(l, c) * (1.0 / (half_density(l, c) + sun_density(l)));
            }
        }
        return sum * (0.5 / nodes / nodes);
    }
    Vec3d over_sun(int nodes) const {
        const auto [t, b] = around(sky_.sun->first);
        Vec3d sum;
        for (int i = 0; i < nodes; ++i) {
            const double cosine = 1.0 + std::log((i + 0.5) / nodes) / sky_.sun->second;
            const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
            for (int k = 0; k < 2 * nodes; ++k) {
                const double phi = (k + 0.5) * reference::pi / nodes;
                const Vec3d l = t * (sine * std::cos(phi)) + b * (sine * std::sin(phi)) + sky_.sun->first * cosine;
                const double c = cosine_to_half(l);
                if (c <= 0.0 || dot(n_, l) <= 0.0) continue;
                sum = sum + from(l, c) * (1.0 / (half_density(l, c) + sun_density(l)));
            }
        }
        return sum * (0.5 / nodes / nodes);
    }

    const Sky& sky_;
    const Vec3d n_, f0_;
    const double roughness_, alpha_, n_dot_v_;
};

struct Setting {
    std::string name;
    size_t sky;
    Vec3d f0;
};

// What several members of a scene share, made once.
struct Bakes {
    std::map<size_t, std::vector<std::vector<float>>> box, filtered;  // by sky: mips
    std::map<uint32_t, std::vector<float>> tables;                    // by size
};

const std::vector<std::vector<float>>& box_mips(Bakes& bakes, size_t sky, const Effort& effort) {
    auto& mips = bakes.box[sky];
    if (!mips.empty()) return mips;
    const Sky s = skies()[sky];
    mips.emplace_back(size_t{6} * side * side * 4, 1.0f);
    effort.jobs.each(size_t{6} * side, [&](size_t row) {
        for (uint32_t x = 0; x < side; ++x) {
            const Vec3d c = s.radiance(normalize(cube_direction(static_cast<uint32_t>(row / side), 2.0 * (x + 0.5) / side - 1.0,
                                                                2.0 * (static_cast<double>(row % side) + 0.5) / side - 1.0)));
            float* const to = &mips[0][4 * (row * side + x)];
            to[0] = static_cast<float>(c.x), to[1] = static_cast<float>(c.y), to[2] = static_cast<float>(c.z);
        }
    });
    for (uint32_t n = side / 2; n >= 1; n /= 2) {
        const std::vector<float>& above = mips.back();
        std::vector<float> mip(size_t{6} * n * n * 4);
        for (size_t face = 0; face < 6; ++face)
            for (size_t y = 0; y < n; ++y)
                for (size_t x = 0; x < n; ++x)
                    for (size_t c = 0; c < 4; ++c) {
                        const size_t at = 4 * ((face * 2 * n + 2 * y) * 2 * n + 2 * x) + c, down = at + 4 * 2 * n;
                        mip[4 * ((face * n + y) * n + x) + c] =
                            0.25f * (above[at] + above[at + 4] + above[down] + above[down + 4]);
                    }
        mips.push_back(std::move(mip));
    }
    return mips;
}

Result<std::vector<std::vector<float>>> prefiltered_mips(Bakes& bakes, size_t sky, Bench& bench, const Effort& effort) {
    auto& mips = bakes.filtered[sky];
    if (!mips.empty()) return mips;
    const std::vector<Resource> source{cube_map("map", TexelFormat::rgba32_float, side, box_mips(bakes, sky, effort))};
    for (uint32_t level = 0; level < levels; ++level) {
        Draw draw;
        draw.width = side >> level;
        draw.height = draw.width * 6;
        draw.results = size_t{4} * draw.width * draw.height;
        draw.groups = (draw.width * draw.height + group_size - 1) / group_size;
        const std::string alpha =
            "#define ALPHA ggx_alpha(" + std::to_string(level) + ".0 / " + std::to_string(levels - 1) + ".0)\n";
        auto mip = bench.bake(
            bake_text(source, "#include \"ibl_bake.glsl\"\n" + alpha +
                                  "vec4 texel(uint i) {\n    const int n = int(kiln_draw.x), face = int(i) / (n * n);\n"
                                  "    const ivec2 at = ivec2(int(i) % n, (int(i) / n) % n);\n"
                                  "    const vec3 d = normalize(cube_direction(face, cube_texel_centre(at, n)));\n"
                                  "    return vec4(prefilter_sampled(map, d, ALPHA, 1024u, true), 1.0);\n}"),
            source, draw);
        KILN_TRY(mip);
        mips.push_back(std::move(*mip));
    }
    return mips;
}

Result<std::vector<float>> table_of(Bakes& bakes, uint32_t size, Bench& bench) {
    auto& table = bakes.tables[size];
    if (!table.empty()) return table;
    Draw draw;
    draw.width = draw.height = size;
    draw.results = size_t{4} * size * size;
    draw.groups = (size * size + group_size - 1) / group_size;
    const auto texels =
        bench.bake(bake_text({},
                             "#include \"ibl_bake.glsl\"\n#include \"ibl.glsl\"\nvec4 texel(uint i) {\n"
                             "    const vec2 at = split_sum_texel(ivec2(i % kiln_draw.x, i / kiln_draw.x), int(kiln_draw.x));\n"
                             "    return vec4(split_sum_sampled(max(at.x, 1e-3), ggx_alpha(at.y), 4096u), 0.0, 0.0);\n}"),
                   {}, draw);
    KILN_TRY(texels);
    for (size_t i = 0; i < texels->size(); i += 4) table.insert(table.end(), {(*texels)[i], (*texels)[i + 1]});
    return table;
}

}  // namespace

Family environment_family(bool quick) {
    Family f;
    f.number = 2;
    f.name = "environment";
    f.title = "Specular light from an environment";
    f.what =
        "Spheres of roughness 0.05, 0.1, 0.25, 0.5, 0.75 and 1 under an environment, seen from afar. Single scattering is the "
        "truth, so "
        "the form that gives lost light back is off by what it gives.";
    f.primary = Metric::relmse;
    f.fields = {{"vec3", "n"}, {"float", "roughness"}};
    const Vec3d gold{1.0, 0.78, 0.34}, plastic = reference::splat3(0.04);
    const std::vector<Setting> settings{
        {"studio_gold", 0, gold}, {"studio_plastic", 0, plastic}, {"sun_gold", 1, gold}, {"checker_gold", 2, gold}};
    for (const Setting& setting : settings) {
        Scene s;
        s.name = setting.name;
        const Sky sky = skies()[setting.sky];
        s.what = "Under " + sky.what + ".";
        s.width = quick ? 72 : 144;
        s.height = quick ? 48 : 96;
        char text[120];
        std::snprintf(text, sizeof text, "const vec3 f0 = vec3(%.9g, %.9g, %.9g);\n", setting.f0.x, setting.f0.y, setting.f0.z);
        s.glsl = std::string(text) + point_text;
        const int nodes = quick ? 32 : 64;
        s.truth = "midpoint quadrature over " + std::to_string(2 * nodes * nodes) +
                  " half vectors of the lobe, and as many directions of a sun, in double precision; its error is a third of what "
                  "half as many nodes a side change";
        s.reference = [sky, setting, nodes, w = s.width, h = s.height](const Points& points, const Effort& effort) {
            const auto at = [&](int n) {
                return per_point(points, w, h, effort, [&](size_t i) {
                    return Lobe(sky, normalize(points.vector(i, 0)), points.scalar(i, 3), setting.f0).reflected(n);
                });
            };
            Reference out = at(nodes);
            const Reference coarse = at(nodes / 2);
            for (size_t i = 0; i < out.picture.rgb.size(); ++i) {
                const double error = (out.picture.rgb[i] - coarse.picture.rgb[i]) / 3.0;  // the rule is of second order
                out.variance.push_back(error * error);
            }
            return out;
        };
        f.scenes.push_back(std::move(s));
    }
    const auto bakes = std::make_shared<Bakes>();
    SamplerState table_sampler;
    table_sampler.wrap = Wrap::clamp;
    table_sampler.mips = MipFilter::none;

    // maps: 'b' the environment with plain mips, 'p' the prefiltered one; table: its size, or 0.
    const auto add = [&](const std::string& name, const std::string& what, char map, uint32_t table, const std::string& glsl) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = "#include \"ibl.glsl\"\n#include \"ibl_bake.glsl\"\n#include \"environment.glsl\"\n" + glsl;
        m.resources = [=](size_t scene, Bench& bench, const Effort& effort) -> Result<std::vector<Resource>> {
            std::vector<Resource> out;
            if (map == 'b') {
                out.push_back(
                    cube_map("environment", TexelFormat::rgba16_float, side, box_mips(*bakes, settings[scene].sky, effort)));
            } else {
                auto mips = prefiltered_mips(*bakes, settings[scene].sky, bench, effort);
                KILN_TRY(mips);
                out.push_back(cube_map("environment", TexelFormat::rgba16_float, side, *mips));
            }
            if (table != 0) {
                auto texels = table_of(*bakes, table, bench);
                KILN_TRY(texels);
                out.push_back(picture_map("table", TexelFormat::rg32_float, table, table, {*texels}, table_sampler));
            }
            return out;
        };
        f.members.push_back(std::move(m));
    };
    add("mips", "plain mips of the environment times f0: no lobe, no table", 'b', 0,
        "vec3 shade(Point p) { return sample_environment(environment, environment_reflection(p.n, v), p.roughness, 8.0) * f0; }");
    const std::string blurred =
        "vec3 blurred(Point p) { return sample_environment(environment, environment_reflection(p.n, v), p.roughness, " +
        std::to_string(levels) + ".0); }\n";
    add("fit", "prefiltered map and Karis' fit in place of the table", 'p', 0,
        blurred + "vec3 shade(Point p) { return environment_specular(blurred(p), f0, split_sum_fit(p.n.z, p.roughness)); }");
    for (const uint32_t size : {16u, 32u, 64u, 128u})
        add("table_" + std::to_string(size), "prefiltered map and split-sum table", 'p', size,
            blurred +
                "vec3 shade(Point p) { return environment_specular(blurred(p), f0, split_sum_lookup(table, p.n.z, p.roughness, " +
                std::to_string(size) + ".0)); }");
    add("multiscatter", "the same with what is lost given back", 'p', 64,
        blurred +
            "vec3 shade(Point p) { return environment_specular_multiscatter(blurred(p), f0, split_sum_lookup(table, p.n.z, "
            "p.roughness, 64.0)); }");
    const auto sampled = [&](int count, bool filtered) {
        const std::string n = std::to_string(count);
        add("is_" + n + (filtered ? "_filtered" : ""),
            filtered ? "importance sampling, mips by density: Colbert and Krivanek" : "importance sampling of the lobe", 'b', 0,
            "vec3 shade(Point p) {\n    const mat3 frame = frame_around(p.n);\n    const float a = ggx_alpha(p.roughness);\n"
            "    const uint seed = hash(floatBitsToUint(p.n.x) ^ hash(floatBitsToUint(p.n.y)));\n"
            "    const vec2 turn = vec2(unit(seed), unit(hash(seed)));\n    vec3 sum = vec3(0.0);\n"
            "    for (uint i = 0u; i < " +
                n +
                "u; ++i) {\n"
                "        const vec3 h = sample_ggx_half(fract(hammersley(i, " +
                n +
                "u) + turn), a), w = frame * h;\n"
                "        const float v_dot_h = dot(v, w), n_dot_l = 2.0 * v_dot_h * h.z - p.n.z;\n"
                "        if (n_dot_l > 0.0 && v_dot_h > 0.0) {\n"
                "            const vec3 l = 2.0 * v_dot_h * w - v;\n"
                "            const float weight = 4.0 * ggx_visibility(n_dot_l, p.n.z, a) * n_dot_l * v_dot_h / h.z;\n" +
                std::string(
                    filtered
                        ? "            const float pdf = ggx_distribution(vec3(0.0, 0.0, 1.0), h, a) * h.z / (4.0 * v_dot_h);\n"
                          "            const float lod = filtered_lod(pdf, " +
                              n + ".0, 128.0);\n"
                        : "            const float lod = 0.0;\n") +
                "            sum += textureLod(environment, l, lod).rgb * fresnel_schlick(v_dot_h, f0) * weight;\n        }\n    "
                "}\n"
                "    return sum / " +
                n + ".0;\n}");
    };
    for (const int n : quick ? std::vector<int>{4, 16, 64, 256} : std::vector<int>{4, 16, 64, 256, 1024}) sampled(n, false);
    for (const int n : {4, 16, 64}) sampled(n, true);

    f.expectations = ascending(Metric::relmse, {"is_64_filtered", "table_64", "mips"});
    for (const Expectation& e : ascending(Metric::relmse, {"table_64", "fit"})) f.expectations.push_back(e);
    f.expectations.push_back(
        {Metric::relmse, Relation::near, "table_64", "table_128", 1.05, "", "beyond 64 texels N = V = R is what is left"});
    f.expectations.push_back(
        {Metric::relmse, Relation::near, "table_16", "table_128", 1.5, "", "even a small table is not what is left"});
    for (const char* n : {"4", "16", "64"})
        f.expectations.push_back({Metric::relmse, Relation::below, std::string("is_") + n + "_filtered", std::string("is_") + n,
                                  1.0, "", "mips take the noise"});
    for (const Expectation& e : ascending(Metric::relmse, {"is_256", "is_64", "is_16", "is_4"})) f.expectations.push_back(e);
    for (const Expectation& e : ascending(Metric::time, {"mips", "table_64", "is_4_filtered", "is_16_filtered"}))
        f.expectations.push_back(e);
    f.expectations.push_back(
        {Metric::time, Relation::near, "table_16", "table_128", 1.1, "", "size of a table costs bytes, not time"});
    return f;
}

}  // namespace kiln::report
