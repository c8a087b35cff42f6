// Fewer bits: arithmetic in less than single precision, and radiance stored in fewer than 32 bits a channel.
#include "compiler/report/families/families.h"

namespace kiln::report {

namespace {

const Vec3d gold{1.0, 0.78, 0.34};

// D V F n.l as printed, from c = |h - n|^2.
Vec3d lobe(double c, double n_dot_l, double n_dot_v, double v_dot_h, double alpha, double intensity) {
    const double a2 = alpha * alpha, cosine = 1.0 - 0.5 * c, sine2 = c * (1.0 - 0.25 * c);
    const double t = sine2 + a2 * cosine * cosine, d = a2 / (reference::pi * t * t);
    const double v = 0.5 / (n_dot_l * std::sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2) +
                            n_dot_v * std::sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2));
    return (gold + (reference::splat3(1.0) - gold) * std::pow(1.0 - v_dot_h, 5.0)) * (d * v * n_dot_l * intensity);
}

Scene scene_of(bool quick, const std::string& name, const std::string& what, double low, double high, double intensity) {
    Scene s;
    s.name = name;
    s.what = what + " Angle of the half vector from left to right, roughness from bottom to top.";
    s.width = s.height = quick ? 64 : 128;
    char text[160];
    std::snprintf(text, sizeof text, "const float low = %.9g, high = %.9g, intensity = %.9g;\n", low, high, intensity);
    s.glsl = std::string(text) + R"(
Point point_at(vec2 u) {
    Point p;
    p.alpha = mix(low, high, u.y);
    const float t = 4.0 * p.alpha * u.x;
    p.c = min(t * t, 1.2);
    p.n_dot_l = 0.25 + 0.7 * fract(u.x + 0.3);
    p.n_dot_v = 0.9 - 0.7 * u.y;
    p.v_dot_h = 0.5 + 0.4 * u.x;
    return p;
}
)";
    s.truth = "the formula in double precision";
    s.reference = [intensity, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        return per_point(points, w, h, effort, [&](size_t i) {
            return lobe(points.scalar(i, 0), points.scalar(i, 1), points.scalar(i, 2), points.scalar(i, 3), points.scalar(i, 4),
                        intensity);
        });
    };
    return s;
}

std::string lobe_text(const std::string& scalar, const std::string& vector) {
    return vector + " lobe(Point q) {\n    const " + scalar + " c = " + scalar + "(q.c), n_dot_l = " + scalar +
           "(q.n_dot_l), n_dot_v = " + scalar + "(q.n_dot_v), a = " + scalar + "(q.alpha);\n    const " + scalar +
           " one = " + scalar + "(1.0), half_one = " + scalar + "(0.5);\n    const " + scalar +
           " cosine = one - half_one * c, across = a * cosine;\n    const " + scalar + " k = a / (c * (one - " + scalar +
           "(0.25) * c) + across * across), a2 = a * a;\n    const " + scalar +
           " v = half_one / (n_dot_l * sqrt(n_dot_v * n_dot_v * (one - a2) + a2) + n_dot_v * sqrt(n_dot_l * n_dot_l * (one - a2) "
           "+ a2));\n    const " +
           scalar + " x = one - " + scalar + "(q.v_dot_h), x2 = x * x;\n    const " + vector + " f0 = " + vector +
           "(1.0, 0.78, 0.34);\n    return (f0 + (" + vector + "(1.0) - f0) * (x2 * x2 * x)) * (k * k / " + scalar +
           "(3.14159265) * v * n_dot_l * " + scalar + "(intensity));\n}\n";
}

}  // namespace

Family precision_family(bool quick) {
    Family f;
    f.number = 8;
    f.name = "precision";
    f.title = "Fewer bits";
    f.what =
        "A GGX highlight computed in single precision, with a hint that less will do, and in half precision; and the "
        "single-precision "
        "result packed into a smaller format and unpacked again. A number that is not finite was too large for its format.";
    f.primary = Metric::max_rel;
    f.fields = {{"float", "c"}, {"float", "n_dot_l"}, {"float", "n_dot_v"}, {"float", "v_dot_h"}, {"float", "alpha"}};
    f.scenes = {scene_of(quick, "broad", "Alpha 0.1 to 1, intensity 3.", 0.1, 1.0, 3.0),
                scene_of(quick, "sharp", "Alpha 0.008 to 0.1, intensity 3.", 0.008, 0.1, 3.0),
                scene_of(quick, "bright", "Alpha 0.008 to 0.1, intensity 3000.", 0.008, 0.1, 3000.0),
                scene_of(quick, "screen", "Alpha 0.3 to 1, intensity 0.5: nothing above 1.", 0.3, 1.0, 0.5)};
    const std::string full = lobe_text("float", "vec3");
    const auto add = [&](const char* name, const char* what, const std::string& text) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = text;
        f.members.push_back(std::move(m));
    };
    add("fp32", "single precision", full + "vec3 shade(Point p) { return lobe(p); }");
    std::string relaxed = full;
    for (const char* type : {"const float ", "const vec3 "}) {
        const std::string from = type, to = std::string("const mediump ") + (type + 6);
        for (size_t at = 0; (at = relaxed.find(from, at)) != std::string::npos; at += to.size())
            relaxed.replace(at, from.size(), to);
    }
    add("mediump", "the same, every name mediump", relaxed + "vec3 shade(Point p) { return lobe(p); }");
    add("fp16", "float16_t throughout", lobe_text("float16_t", "f16vec3") + "vec3 shade(Point p) { return vec3(lobe(p)); }");
    add("fp16_store", "single precision, stored as half",
        full +
            "vec3 shade(Point p) {\n    const vec3 c = lobe(p);\n"
            "    return vec3(unpackHalf2x16(packHalf2x16(c.xy)), unpackHalf2x16(packHalf2x16(vec2(c.z, 0.0))).x);\n}");
    add("rgba8", "single precision, stored as 8-bit fractions of 1",
        full + "vec3 shade(Point p) { return unpackUnorm4x8(packUnorm4x8(vec4(lobe(p), 1.0))).rgb; }");
    add("rgb10a2", "single precision, stored as 10-bit fractions of 1",
        full + "vec3 shade(Point p) { return round(clamp(lobe(p), vec3(0.0), vec3(1.0)) * 1023.0) / 1023.0; }");
    // Half precision with fewer mantissa bits: rounded at the new place by an addition below it, held at the largest finite
    // value.
    add("rg11b10", "single precision, stored as floats of 11, 11 and 10 bits",
        full +
            "vec3 shade(Point p) {\n    const vec3 c = clamp(lobe(p), vec3(0.0), vec3(65024.0, 65024.0, 64512.0));\n"
            "    const uint rg = packHalf2x16(c.xy), b = packHalf2x16(vec2(c.z, 0.0));\n"
            "    const uint r = min((rg & 0xffffu) + 8u, 0x7bffu) & 0xfff0u, g = min((rg >> 16) + 8u, 0x7bffu) & 0xfff0u;\n"
            "    return vec3(unpackHalf2x16(r | g << 16), unpackHalf2x16(min((b & 0xffffu) + 16u, 0x7bffu) & 0xffe0u).x);\n}");
    add("rgb9e5", "single precision, stored with one exponent for three channels",
        full +
            "vec3 shade(Point p) {\n    const vec3 c = clamp(lobe(p), vec3(0.0), vec3(65408.0));\n"
            "    const float most = max(c.x, max(c.y, c.z));\n"
            "    int e = max(-16, int(floatBitsToUint(most) >> 23) - 127) + 16;\n"
            "    e += floor(most * exp2(24.0 - float(e)) + 0.5) >= 512.0 ? 1 : 0;\n"
            "    return floor(c * exp2(24.0 - float(e)) + 0.5) * exp2(float(e) - 24.0);\n}");
    const auto below = [&](Metric metric, const char* a, const char* b, const char* scene, const char* because) {
        f.expectations.push_back({metric, Relation::below, a, b, 1.0, scene, because});
    };
    f.expectations.push_back({Metric::max_rel, Relation::near, "mediump", "fp32", 1.0, "", "lavapipe does not read the hint"});
    f.expectations.push_back({Metric::time, Relation::near, "mediump", "fp32", 1.05, "", "nor for speed"});
    below(Metric::max_rel, "fp32", "fp16", "", "fp16 is worse");
    below(Metric::time, "fp32", "fp16", "", "and slower here, on a host without half-precision units");
    f.expectations.push_back({Metric::nonfinite, Relation::at_least, "fp16", "", 1.0, "bright", "products pass 65504"});
    f.expectations.push_back({Metric::nonfinite, Relation::at_least, "fp16_store", "", 1.0, "bright", "so does the result"});
    for (const char* m : {"fp32", "rg11b10", "rgb9e5"})
        f.expectations.push_back({Metric::nonfinite, Relation::at_most, m, "", 0.0, "bright", ""});
    f.expectations.push_back(
        {Metric::max_rel, Relation::at_most, "fp16_store", "", 0.5e-2, "broad", "half a unit in 2048, more near 0"});
    for (const Expectation& e : ascending(Metric::max_abs, {"fp16_store", "rgb9e5", "rg11b10"}, "broad"))
        f.expectations.push_back(e);
    for (const Expectation& e : ascending(Metric::max_abs, {"fp16_store", "rgb10a2", "rgba8"}, "screen"))
        f.expectations.push_back(e);
    return f;
}

}  // namespace kiln::report
