// Masking and shadowing over the specular denominator, V = G / (4 n.l n.v): forms of GGX against height-correlated Smith.
#include "compiler/report/families/families.h"

#include "uber/reference/split_sum_quadrature.h"

namespace kiln::report {

namespace {

// Heitz 2014 as printed: G2 = 1 / (1 + Lambda(l) + Lambda(v)).
double correlated(double l, double v, double alpha) {
    const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1.0 + alpha * alpha * (1.0 - c * c) / (c * c)) - 1.0); };
    return 1.0 / (1.0 + lambda(l) + lambda(v)) / (4.0 * l * v);
}

double lobe_albedo(double n_dot_v, double roughness) {
    static const reference::TanhSinh quadrature(40);
    const reference::SplitSum s = reference::split_sum(reference::SmithForm::height_correlated, n_dot_v, roughness, quadrature);
    return s.a + s.b;
}

// Directional albedo over D's own distribution of half vectors: tan(theta_h) = alpha tan(w), the weight of (w, phi) is
// sin(w) cos(w) / pi, and what is summed G2 v.h / (n.h n.v).
const char* const albedo_text = R"(
vec3 shade(Point p) {
    const float sin_v = sqrt(max(1.0 - p.n_dot_v * p.n_dot_v, 0.0));
    float sum = 0.0;
    for (int i = 0; i < 32; ++i) {
        const float w = (float(i) + 0.5) * (1.57079633 / 32.0);
        const float t = p.alpha * tan(w), n_dot_h = inversesqrt(1.0 + t * t), sin_h = t * n_dot_h;
        float ring = 0.0;
        for (int k = 0; k < 32; ++k) {
            const float phi = (float(k) + 0.5) * (3.14159265 / 32.0);
            const float v_dot_h = p.n_dot_v * n_dot_h + sin_v * sin_h * cos(phi);
            const float n_dot_l = 2.0 * v_dot_h * n_dot_h - p.n_dot_v;
            if (v_dot_h > 0.0 && n_dot_l > 0.0)
                ring += 4.0 * n_dot_l * visibility(n_dot_l, p.n_dot_v, v_dot_h, p.alpha, p.roughness) * v_dot_h;
        }
        sum += ring * sin(w) * cos(w) / n_dot_h;
    }
    return vec3(sum * (2.0 / 3.14159265) * (1.57079633 / 32.0) * (3.14159265 / 32.0));
}
)";

}  // namespace

Family visibility_family(bool quick) {
    Family f;
    f.number = 5;
    f.name = "visibility";
    f.title = "Masking and shadowing: forms of V";
    f.what =
        "V = G / (4 n.l n.v) of the specular lobe, from the constant that leaves it out to height-correlated Smith, which is the "
        "reference in double precision.";
    f.primary = Metric::max_rel;
    f.fields = {{"float", "n_dot_l"}, {"float", "n_dot_v"}, {"float", "v_dot_h"}, {"float", "alpha"}, {"float", "roughness"}};

    Scene grid;
    grid.name = "grid";
    grid.what =
        "Four tiles of roughness 0.1, 0.35, 0.65, 1; within each n.v from left to right and n.l from bottom to top, light and "
        "viewer on opposite sides.";
    grid.width = grid.height = quick ? 64 : 128;
    grid.glsl = R"(
Point point_at(vec2 u) {
    Point p;
    const vec2 tile = floor(u * 2.0);
    p.n_dot_v = mix(0.02, 1.0, fract(u.x * 2.0));
    p.n_dot_l = mix(0.02, 1.0, fract(u.y * 2.0));
    p.roughness = 0.1 + 0.25 * tile.x + 0.55 * tile.y + 0.1 * tile.x * tile.y;
    p.alpha = p.roughness * p.roughness;
    const float v_dot_l = p.n_dot_v * p.n_dot_l - sqrt((1.0 - p.n_dot_v * p.n_dot_v) * (1.0 - p.n_dot_l * p.n_dot_l));
    p.v_dot_h = sqrt(max(0.5 + 0.5 * v_dot_l, 1e-6));
    return p;
}
)";
    grid.truth = "Heitz 2014 in double precision";
    grid.reference = [w = grid.width, h = grid.height](const Points& points, const Effort& effort) {
        return per_point(points, w, h, effort, [&](size_t i) {
            return reference::splat3(correlated(points.scalar(i, 0), points.scalar(i, 1), points.scalar(i, 3)));
        });
    };

    Scene albedo;
    albedo.name = "albedo";
    albedo.what =
        "Directional albedo of the lobe at F = 1: n.v from left to right, roughness from bottom to top. Each form integrated by "
        "1024 half vectors a pixel.";
    albedo.width = albedo.height = quick ? 24 : 48;
    albedo.glsl = R"(
Point point_at(vec2 u) {
    Point p;
    p.n_dot_v = mix(0.05, 1.0, u.x);
    p.n_dot_l = 1.0;
    p.v_dot_h = 1.0;
    p.roughness = mix(0.1, 1.0, u.y);
    p.alpha = p.roughness * p.roughness;
    return p;
}
)";
    albedo.truth = "tanh-sinh quadrature of height-correlated Smith in double precision";
    albedo.reference = [w = albedo.width, h = albedo.height](const Points& points, const Effort& effort) {
        return per_point(points, w, h, effort,
                         [&](size_t i) { return reference::splat3(lobe_albedo(points.scalar(i, 1), points.scalar(i, 4))); });
    };
    f.scenes = {grid, albedo};

    const std::string head =
        "float visibility(float n_dot_l, float n_dot_v, float v_dot_h, float alpha, float roughness) {\n    ";
    const auto member = [&](const char* name, const char* what, const std::string& body, const std::string& include = "") {
        Member m;
        m.name = name;
        m.what = what;
        m.scene_glsl["grid"] =
            include + head + body +
            "\n}\nvec3 shade(Point p) { return vec3(visibility(p.n_dot_l, p.n_dot_v, p.v_dot_h, p.alpha, p.roughness)); }";
        m.scene_glsl["albedo"] = include + head + body + "\n}\n" + albedo_text;
        f.members.push_back(m);
    };
    const std::string forms = "#include \"smith.glsl\"\n";
    member("quarter", "no masking: G = n.l n.v", "return visibility_implicit();", forms);
    member("kelemen", "1 / (4 (v.h)^2): Kelemen and Szirmay-Kalos 2001", "return visibility_kelemen(v_dot_h);", forms);
    member("karis_direct", "Schlick-Smith, k = (r + 1)^2 / 8: Karis 2013, for analytic lights",
           "return visibility_karis_direct(n_dot_l, n_dot_v, roughness);", forms);
    member("karis_ibl", "Schlick-Smith, k = alpha / 2: Karis 2013, for environments",
           "return visibility_karis_ibl(n_dot_l, n_dot_v, alpha);", forms);
    member("hammon", "0.5 / mix(2 n.l n.v, n.l + n.v, alpha): Hammon 2017", "return visibility_hammon(n_dot_l, n_dot_v, alpha);",
           forms);
    member("separable", "exact Smith of both sides, uncorrelated: Walter et al. 2007",
           "return visibility_separable(n_dot_l, n_dot_v, alpha);", forms);
    member("correlated", "uber/lib/ggx.glsl: height-correlated Smith, fused", "return ggx_visibility(n_dot_l, n_dot_v, alpha);",
           "#include \"ggx.glsl\"\n");

    f.expectations = ascending(Metric::time, {"quarter", "kelemen", "karis_ibl", "separable", "correlated"}, "grid");
    f.expectations.push_back(
        {Metric::time, Relation::below, "karis_ibl", "correlated", 2.0, "grid", "measured before as 0.058 and 0.181 ns"});
    f.expectations.push_back({Metric::max_rel, Relation::at_most, "correlated", "", 1e-5, "grid", "rounding alone"});
    for (const char* scene : {"grid", "albedo"})
        for (Expectation& e :
             ascending(Metric::relmse, {"correlated", "separable", "hammon", "karis_ibl", "karis_direct", "quarter"}, scene))
            f.expectations.push_back(e);
    f.expectations.push_back({Metric::relmse, Relation::below, "karis_ibl", "karis_direct", 1.0, "albedo",
                              "the direct light's k is far too dark in an integral"});
    return f;
}

}  // namespace kiln::report
