// Light scattered by a hair: cheap lobes and fits against a dielectric fibre.
#include "uber/reference/hair.h"
#include "compiler/report/families/families.h"

namespace kiln::report {

namespace {

struct Setting {
    std::string name, what;
    double theta, beta, absorption;
};

const char* const point_text = R"(
Point point_at(vec2 u) {
    Point p;
    const float theta = (u.y - 0.5) * 3.10, phi = (u.x - 0.5) * 6.28;
    p.to_light = vec3(sin(theta), cos(theta) * cos(phi), cos(theta) * sin(phi));
    return p;
}
)";

Scene scene_of(const Setting& setting, bool quick) {
    Scene s;
    s.name = setting.name;
    s.what = setting.what +
             " The light's azimuth from left to right, its inclination from bottom to top; the eye at inclination " +
             std::to_string(setting.theta).substr(0, 3) + ".";
    s.width = quick ? 48 : 96;
    s.height = quick ? 48 : 96;
    char text[400];
    std::snprintf(text, sizeof text,
                  "const vec3 to_eye = vec3(%.9g, %.9g, 0.0);\nconst float beta = %.9g, absorption = %.9g;\n"
                  "const vec3 tangent = vec3(1.0, 0.0, 0.0);\n",
                  std::sin(setting.theta), std::cos(setting.theta), setting.beta, setting.absorption);
    s.glsl = std::string(text) + point_text;
    s.truth = "Chiang et al. 2016 over 256 offsets in double precision";
    s.reference = [setting, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        reference::HairFibre<double> fibre;
        fibre.absorption = reference::splat3(setting.absorption);
        fibre.beta_m = fibre.beta_n = setting.beta;
        const Vec3d eye{std::sin(setting.theta), std::cos(setting.theta), 0.0};
        return per_point(points, w, h, effort,
                         [&](size_t i) { return reference::hair_chiang_width(fibre, normalize(points.vector(i, 0)), eye, 256); });
    };
    return s;
}

}  // namespace

Family hair_family(bool quick) {
    Family f;
    f.number = 11;
    f.name = "hair";
    f.title = "Hair";
    f.what =
        "What a fibre across the light sends to the eye. Kajiya and Kay's lobes, Karis' fits of Marschner's, and Chiang's fibre "
        "averaged "
        "over its width with few and many steps.";
    f.primary = Metric::relmse;
    f.fields = {{"vec3", "to_light"}};
    const std::vector<Setting> settings{{"brown_rough", "Brown hair, roughness 0.6.", 0.0, 0.6, 0.4},
                                        {"brown", "Brown hair, roughness 0.3.", 0.5, 0.3, 0.4},
                                        {"smooth", "Brown hair, roughness 0.1.", 0.5, 0.1, 0.4},
                                        {"white", "No absorption, roughness 0.3: all light comes back.", 0.5, 0.3, 0.0}};
    for (const Setting& s : settings) f.scenes.push_back(scene_of(s, quick));

    const auto add = [&](const std::string& name, const std::string& what, const std::string& glsl) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = glsl;
        f.members.push_back(std::move(m));
    };
    add("kajiya_kay", "two lobes, exponent from the longitudinal variance",
        "#include \"hair.glsl\"\n#include \"hair_cheap.glsl\"\n"
        "vec3 shade(Point p) {\n    const float exponent = clamp(1.0 / hair_variance(0, beta), 1.0, 2048.0);\n"
        "    return hair_kajiya_kay(tangent, p.to_light, to_eye, exp(vec3(-4.0 * absorption)) / 9.8696, vec3(0.05), "
        "exponent);\n}");
    add("scheuermann", "one lobe over the half vector and Kajiya and Kay's diffuse term",
        "#include \"hair.glsl\"\n#include \"hair_cheap.glsl\"\n"
        "vec3 shade(Point p) {\n    const float exponent = clamp(1.0 / hair_variance(0, beta), 1.0, 2048.0);\n"
        "    const float tl = dot(tangent, p.to_light);\n"
        "    return exp(vec3(-4.0 * absorption)) / 9.8696 * sqrt(max(1.0 - tl * tl, 0.0)) +\n"
        "           vec3(0.05 * hair_scheuermann(tangent, p.to_light, to_eye, exponent));\n}");
    add("karis", "three fitted lobes: Karis 2016",
        "#include \"hair_cheap.glsl\"\n"
        "vec3 shade(Point p) { return hair_karis(tangent, p.to_light, to_eye, exp(vec3(-2.0 * absorption)), beta, 0.5, 1.0); }");
    std::vector<int> steps{1, 4, 16};
    if (!quick) steps.push_back(64);
    for (const int n : steps)
        add("chiang_" + std::to_string(n), "R, TT, TRT and the rest, " + std::to_string(n) + " offsets across the fibre",
            "#define HAIR_WIDTH_STEPS " + std::to_string(n) +
                "\n#include \"hair.glsl\"\n"
                "vec3 shade(Point p) {\n    HairFibre fibre;\n    fibre.absorption = vec3(absorption);\n    fibre.eta = 1.55;\n"
                "    fibre.beta_m = beta;\n    fibre.beta_n = beta;\n    fibre.tilt = 0.0;\n"
                "    return hair_chiang_width(fibre, p.to_light, to_eye);\n}");

    for (Expectation& e : ascending(Metric::relmse, {"chiang_16", "chiang_4", "karis", "kajiya_kay"}))
        f.expectations.push_back(e);
    for (Expectation& e : ascending(Metric::time, {"kajiya_kay", "karis", "chiang_1", "chiang_4", "chiang_16"}))
        f.expectations.push_back(e);
    f.expectations.push_back({Metric::bias, Relation::at_most, "chiang_16", "", 1e-2, "white", "energy is kept"});
    f.expectations.push_back({Metric::bias, Relation::at_least, "kajiya_kay", "", 0.1, "white", "not conserving"});
    return f;
}

}  // namespace kiln::report
