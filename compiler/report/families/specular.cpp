// The specular lobe under one light: forms from Blinn's to a measured table, against GGX with height-correlated Smith.
#include "compiler/report/families/families.h"
#include "compiler/report/resources.h"
#include "uber/reference/merl_file.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::report {

namespace {

const Vec3d gold{1.0, 0.78, 0.34};

// BRDF times n.l as printed: Walter et al. 2007, Heitz 2014, Schlick 1994. n is z.
Vec3d lobe(const Vec3d& v, const Vec3d& l, double roughness, const Vec3d& f0) {
    if (l.z <= 0.0 || v.z <= 0.0) return {};
    const Vec3d h = normalize(v + l);
    const double alpha = roughness * roughness, a2 = alpha * alpha;
    // 1 - h.z^2 as a sum of squares: the printed denominator without its cancellation.
    const double t = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
    const double d = a2 / (reference::pi * t * t);
    const double g = reference::smith_g2(reference::SmithForm::height_correlated, l.z, v.z, roughness);
    const Vec3d f = f0 + (reference::splat3(1.0) - f0) * std::pow(1.0 - std::min(dot(v, h), 1.0), 5.0);
    return f * (d * g / (4.0 * l.z * v.z) * l.z);
}

struct Setting {
    std::string name, what;
    double roughness, view;  // view: angle from the normal, degrees; 0 in the furnace, where it varies
};

const char* const sweep_text = R"(
const vec3 n = vec3(0.0, 0.0, 1.0);
Point point_at(vec2 u) {
    Point p;
    const float theta = (u.x * 2.0 - 1.0) * 1.5, phi = u.y * 1.5707963;
    p.l = vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
    p.v = view;
    return p;
}
)";
const char* const furnace_text = R"(
const vec3 n = vec3(0.0, 0.0, 1.0);
Point point_at(vec2 u) {
    Point p;
    const float c = mix(0.05, 0.999, u.x);
    p.v = vec3(sqrt(1.0 - c * c), 0.0, c);
    p.l = n;
    return p;
}
)";
// Albedo over half vectors of the GGX lobe of this roughness: weight D n.h in the plane of (w, phi), 4 v.h from h to l.
const char* const albedo_text = R"(
vec3 shade(Point p) {
    const float alpha = roughness * roughness;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 32; ++i) {
        const float w = (float(i) + 0.5) * (1.57079633 / 32.0);
        const float t = alpha * tan(w), c = inversesqrt(1.0 + t * t), s = t * c;
        const float a2 = alpha * alpha, q = s * s + a2 * c * c;
        for (int k = 0; k < 32; ++k) {
            const float phi = (float(k) + 0.5) * (3.14159265 / 32.0);
            const vec3 h = vec3(s * cos(phi), s * sin(phi), c);
            const float v_dot_h = dot(p.v, h);
            const vec3 l = normalize(2.0 * v_dot_h * h - p.v);
            if (v_dot_h > 0.0 && l.z > 0.0) sum += brdf(n, p.v, l, f0, roughness) * (4.0 * v_dot_h * sin(w) * cos(w) * q * q / (a2 * c));
        }
    }
    // dw dphi / pi of the lobe's own measure is brdf 4 v.h / (D n.h), and D = a2 / (pi q^2); both halves of phi.
    return sum * (2.0 * (1.57079633 / 32.0) * (3.14159265 / 32.0));
}
)";

Scene scene_of(const Setting& setting, bool quick) {
    Scene s;
    s.name = setting.name;
    s.what = setting.what;
    const bool furnace = setting.view == 0.0;
    s.width = furnace ? (quick ? 32 : 64) : (quick ? 64 : 128);
    s.height = furnace ? 8 : s.width;
    char text[300];
    const double angle = setting.view * reference::pi / 180.0;
    std::snprintf(text, sizeof text,
                  "const float roughness = %.9g;\nconst vec3 f0 = vec3(%.9g, %.9g, %.9g), view = vec3(%.9g, 0.0, %.9g);\n",
                  setting.roughness, 1.0, furnace ? 1.0 : gold.y, furnace ? 1.0 : gold.z, -std::sin(angle), std::cos(angle));
    s.glsl = std::string(text) + (furnace ? furnace_text : sweep_text);
    s.truth = furnace ? "a lossless mirror reflects all: 1" : "Walter et al. 2007 with Heitz 2014 in double precision";
    s.reference = [setting, furnace, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        return per_point(points, w, h, effort, [&](size_t i) {
            return furnace ? reference::splat3(1.0)
                           : lobe(normalize(points.vector(i, 3)), normalize(points.vector(i, 0)), setting.roughness, gold);
        });
    };
    return s;
}

}  // namespace

Family specular_family(bool quick) {
    Family f;
    f.number = 3;
    f.name = "specular";
    f.title = "The specular lobe";
    f.what = "What a gold surface reflects of a directional light. In the furnace f0 is 1 and all light should come back.";
    f.primary = Metric::max_rel;
    f.fields = {{"vec3", "l"}, {"vec3", "v"}};
    const std::vector<Setting> settings{
        {"smooth", "Roughness 0.1, viewed at 45 degrees. The light's angle from left to right, its azimuth from bottom to top.",
         0.1, 45.0},
        {"glossy", "Roughness 0.3, viewed at 45 degrees. Axes as before.", 0.3, 45.0},
        {"grazing", "Roughness 0.3, viewed at 80 degrees. Axes as before.", 0.3, 80.0},
        {"rough", "Roughness 0.7, viewed at 45 degrees. Axes as before.", 0.7, 45.0},
        {"furnace", "Uniform light on roughness 0.7, n.v from left to right; each form integrated over 1024 half vectors.", 0.7,
         0.0}};
    for (const Setting& s : settings) f.scenes.push_back(scene_of(s, quick));

    const auto add = [&](const std::string& name, const std::string& what, const std::string& text) -> Member& {
        Member m;
        m.name = name;
        m.what = what;
        for (const Setting& s : settings)
            m.scene_glsl[s.name] =
                text + (s.view == 0.0 ? albedo_text : "vec3 shade(Point p) { return brdf(n, p.v, p.l, f0, roughness); }\n");
        f.members.push_back(std::move(m));
        return f.members.back();
    };
    const std::string open = "vec3 brdf(vec3 n, vec3 v, vec3 l, vec3 f0, float roughness) {\n";
    const std::string power = "    const float a = roughness * roughness, shininess = 2.0 / (a * a) - 2.0;\n";
    add("blinn_phong_raw", "(n.h)^p as it is: Blinn 1977",
        "#include \"blinn_phong_raw.glsl\"\n" + open + power +
            "    return blinn_phong_raw(n, v, l, vec3(0.0), f0, shininess);\n}\n");
    add("blinn_phong", "the same with the factor that keeps energy",
        "#include \"blinn_phong.glsl\"\n" + open + power + "    return blinn_phong(n, v, l, vec3(0.0), f0, shininess);\n}\n");
    add("ggx_lecture", "the lecture's code: alpha = roughness, padded denominator",
        "#include \"lecture_brdf.glsl\"\n" + open +
            "    const vec3 h = normalize(v + l);\n    const float n_dot_l = max(dot(n, l), 0.0);\n"
            "    return specular_lecture(n_dot_l, abs(dot(n, v)), max(dot(n, h), 0.0), max(dot(v, h), 0.0), f0, roughness) * "
            "n_dot_l;\n}\n");
    const std::string ggx =
        "#include \"ggx.glsl\"\n#include \"ggx_forms.glsl\"\n#include \"smith.glsl\"\n#include \"fresnel.glsl\"\n"
        "#include \"vectors.glsl\"\n#include \"energy.glsl\"\n#include \"ibl.glsl\"\n";
    const std::string terms =
        "    const vec3 h = safe_normalize(v + l, n);\n    const float a = ggx_alpha(roughness), n_dot_l = saturate(dot(n, l));\n"
        "    const float n_dot_v = clamp(dot(n, v), 1e-4, 1.0);\n";
    add("ggx_karis", "n.h in D, Karis' k of analytic lights",
        ggx + open + terms +
            "    return ggx_distribution_cosine(dot(n, h), a) * visibility_karis_direct(n_dot_l, n_dot_v, roughness) * "
            "fresnel_schlick(dot(v, h), f0) * n_dot_l;\n}\n");
    add("ggx_correlated", "h - n in D, height-correlated Smith",
        ggx + open + terms +
            "    return ggx_distribution(n, h, a) * ggx_visibility(max(n_dot_l, 1e-4), n_dot_v, a) * fresnel_schlick(dot(v, h), "
            "f0) * n_dot_l;\n}\n");
    Member& scattered = add("ggx_multiscatter", "the same times 1 + f0 (1 / E - 1), E from a table",
                            ggx + open + terms +
                                "    const vec2 ab = split_sum_lookup(table, n_dot_v, roughness, 32.0);\n"
                                "    return ggx_distribution(n, h, a) * ggx_visibility(max(n_dot_l, 1e-4), n_dot_v, a) * "
                                "fresnel_schlick(dot(v, h), f0) *\n"
                                "           multiscatter_scale(f0, ab.x + ab.y) * n_dot_l;\n}\n");
    scattered.resources = [](size_t, Bench&, const Effort& effort) -> Result<std::vector<Resource>> {
        std::vector<float> texels(size_t{32} * 32 * 2);
        const reference::TanhSinh quadrature(16);
        effort.jobs.each(32, [&](size_t y) {
            for (size_t x = 0; x < 32; ++x) {
                const double r = std::max(static_cast<double>(y) / 31.0, 0.045),
                             v = std::max(static_cast<double>(x) / 31.0, 1e-3);
                const auto ab = reference::split_sum(reference::SmithForm::height_correlated, v, r, quadrature);
                texels[2 * (y * 32 + x)] = static_cast<float>(ab.a);
                texels[2 * (y * 32 + x) + 1] = static_cast<float>(ab.b);
            }
        });
        SamplerState sampler;
        sampler.wrap = Wrap::clamp;
        sampler.mips = MipFilter::none;
        return std::vector<Resource>{picture_map("table", TexelFormat::rg32_float, 32, 32, {texels}, sampler)};
    };
    // GGX itself as a file of the MERL database would have it, in full: three colours, Fresnel included, -1 below the horizon.
    const auto measured = [settings](size_t scene, TexelFormat format) -> Resource {
        const double roughness = settings[scene].roughness;
        const Vec3d f0 = settings[scene].view == 0.0 ? reference::splat3(1.0) : gold;
        const reference::MerlFile file =
            reference::parse_merl(settings[scene].name, reference::merl_bytes([&](const Vec3d& l, const Vec3d& v) {
                                      return l.z > 1e-3 && v.z > 1e-3 ? lobe(v, l, roughness, f0) / l.z : Vec3d{};
                                  }));
        return volume_map("table", format, {reference::merl_columns, reference::merl_rows, reference::merl_slices},
                          {reference::merl_texels(file)});
    };
    const auto table = [&](const std::string& name, const std::string& what, const std::string& look_up, TexelFormat format) {
        add(name, what,
            "#include \"merl.glsl\"\n#include \"vectors.glsl\"\n" + open +
                "    const vec3 h = safe_normalize(v + l, n);\n    return " + look_up +
                "(table, merl_coordinates(n, l, h)) * saturate(dot(n, l));\n}\n")
            .resources = [measured, format](size_t scene, Bench&, const Effort&) -> Result<std::vector<Resource>> {
            return std::vector<Resource>{measured(scene, format)};
        };
    };
    table("merl_table", "GGX in a MERL file, eight bins fetched and interpolated, 32-bit floats", "merl_lookup",
          TexelFormat::rgba32_float);
    table("merl_filtered", "the same by one filtered look-up", "merl_lookup_filtered", TexelFormat::rgba32_float);
    table("merl_filtered_half", "the same in 16-bit floats", "merl_lookup_filtered", TexelFormat::rgba16_float);
    table("merl_nearest", "the bin that holds the directions, as the database's own reader", "merl_lookup_nearest",
          TexelFormat::rgba32_float);

    for (const char* s : {"smooth", "glossy"})
        for (Expectation& e : ascending(Metric::max_rel, {"ggx_correlated", "ggx_karis", "ggx_lecture"}, s))
            f.expectations.push_back(e);
    for (const char* s : {"smooth", "glossy", "grazing"})
        for (const char* m : {"ggx_karis", "ggx_correlated", "ggx_multiscatter", "merl_table"})
            f.expectations.push_back(
                {Metric::relmse, Relation::below, m, "ggx_lecture", 1.0, s, "alpha = roughness is the largest error below 0.7"});
    f.expectations.push_back({Metric::max_rel, Relation::at_most, "ggx_correlated", "", 1e-3, "glossy", "rounding alone"});
    f.expectations.push_back(
        {Metric::relmse, Relation::below, "blinn_phong", "blinn_phong_raw", 1.0, "smooth", "raw error grows with the exponent"});
    f.expectations.push_back(
        {Metric::max_abs, Relation::at_most, "ggx_multiscatter", "", 0.02, "furnace", "what is lost comes back"});
    f.expectations.push_back({Metric::max_abs, Relation::below, "ggx_multiscatter", "ggx_correlated", 1.0, "furnace", ""});
    for (Expectation& e : ascending(Metric::time, {"blinn_phong_raw", "blinn_phong"}, "glossy")) f.expectations.push_back(e);
    for (Expectation& e : ascending(Metric::time, {"ggx_karis", "ggx_correlated", "ggx_multiscatter", "merl_table"}, "glossy"))
        f.expectations.push_back(e);
    for (const char* s : {"smooth", "glossy", "rough"}) {
        f.expectations.push_back({Metric::relmse, Relation::below, "merl_table", "merl_nearest", 4.0, s, "a chord for a step"});
        f.expectations.push_back(
            {Metric::relmse, Relation::near, "merl_filtered", "merl_table", 1.1, s, "filter weights of 8 bits are fine enough"});
        f.expectations.push_back(
            {Metric::relmse, Relation::near, "merl_filtered_half", "merl_filtered", 1.1, s, "and so are 11 bits of a value"});
    }
    for (Expectation& e : ascending(Metric::time, {"merl_nearest", "merl_filtered", "merl_table"}, "glossy"))
        f.expectations.push_back(e);
    f.timed_scene = 1;
    return f;
}

}  // namespace kiln::report
