// Reflectance of a smooth surface by the angle: fits against Fresnel's equations.
#include "compiler/report/families/families.h"

namespace kiln::report {

namespace {

struct Index {
    double re, im;
};

// Unpolarised reflectance of a medium of index n + ik, seen from vacuum: the mean of |rs|^2 and |rp|^2.
// Born and Wolf, "Principles of Optics", 14.2, in the form of real numbers.
double exact(double cosine, Index index) {
    const double c2 = cosine * cosine, s2 = 1.0 - c2;
    const double difference = index.re * index.re - index.im * index.im - s2;
    const double modulus = std::sqrt(difference * difference + 4.0 * index.re * index.re * index.im * index.im);
    const double a = std::sqrt(std::max(0.0, 0.5 * (modulus + difference)));
    const double rs = (modulus - 2.0 * a * cosine + c2) / (modulus + 2.0 * a * cosine + c2);
    const double rp = rs * (c2 * modulus - 2.0 * a * cosine * s2 + s2 * s2) / (c2 * modulus + 2.0 * a * cosine * s2 + s2 * s2);
    return 0.5 * (rs + rp);
}

// A material's index over u.y, the cosine over u.x; what a renderer would store of the material is made from the index.
const char* const scene_text = R"(
float scene_exact(float cosine, float n, float k) {
    const float c2 = cosine * cosine, s2 = 1.0 - c2;
    const float difference = n * n - k * k - s2;
    const float modulus = sqrt(difference * difference + 4.0 * n * n * k * k);
    const float a = sqrt(max(0.5 * (modulus + difference), 0.0));
    const float rs = (modulus - 2.0 * a * cosine + c2) / (modulus + 2.0 * a * cosine + c2);
    const float rp = rs * (c2 * modulus - 2.0 * a * cosine * s2 + s2 * s2) / (c2 * modulus + 2.0 * a * cosine * s2 + s2 * s2);
    return 0.5 * (rs + rp);
}
Point point_of(float cosine, float n, float k) {
    Point p;
    p.cosine = cosine;
    p.n = n;
    p.k = k;
    p.f0 = ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
    p.f82 = scene_exact(1.0 / 7.0, n, k);
    return p;
}
)";

Scene scene(bool quick, const std::string& name, const std::string& what, const std::string& point) {
    Scene s;
    s.name = name;
    s.what = what;
    s.width = s.height = quick ? 64 : 128;
    s.glsl = scene_text + point;
    s.truth = "Fresnel's equations in double precision";
    s.reference = [w = s.width, h = s.height](const Points& points, const Effort& effort) {
        return per_point(points, w, h, effort, [&](size_t i) {
            return reference::splat3(exact(points.scalar(i, 0), {points.scalar(i, 1), points.scalar(i, 2)}));
        });
    };
    return s;
}

}  // namespace

Family fresnel_family(bool quick) {
    Family f;
    f.number = 4;
    f.name = "fresnel";
    f.title = "Fresnel reflectance";
    f.what =
        "What share of light a smooth surface reflects. Schlick's fit in four spellings and its mended form for metals, "
        "against the exact equations for a dielectric and for a conductor.";
    f.primary = Metric::max_abs;
    f.fields = {{"float", "cosine"}, {"float", "n"}, {"float", "k"}, {"float", "f0"}, {"float", "f82"}};
    f.scenes = {
        scene(quick, "dielectrics", "Index 1.1 to 2.417 from bottom to top, cosine 0 to 1 from left to right.",
              "Point point_at(vec2 u) { return point_of(u.x, mix(1.1, 2.417, u.y), 0.0); }\n"),
        scene(quick, "conductors", "Index 0.18 + 3.4i to 1.35 + 7.5i from bottom to top, cosine 0 to 1 from left to right.",
              "Point point_at(vec2 u) { return point_of(u.x, mix(0.18, 1.35, u.y), mix(3.4, 7.5, u.y)); }\n")};
    const std::string fits = "#include \"fresnel_fits.glsl\"\n", exact_forms = "#include \"fresnel_exact.glsl\"\n";
    f.members = {{"schlick_faded", "fresnel_schlick: no highlight below f0 = 0.02",
                  fits + "vec3 shade(Point p) { return fresnel_schlick(p.cosine, vec3(p.f0)); }"},
                 {"schlick_gaussian", "exponent fitted by a parabola: Karis 2013; faded as well",
                  fits + "vec3 shade(Point p) { return fresnel_spherical_gaussian(p.cosine, vec3(p.f0)); }"},
                 {"schlick_pow", "the lecture's pow(1 - cosine, 5); faded as well",
                  fits + "vec3 shade(Point p) { return fresnel_schlick_pow(p.cosine, vec3(p.f0)); }"},
                 {"schlick", "1 at grazing incidence whatever f0",
                  fits + "vec3 shade(Point p) { return fresnel_schlick_f90(p.cosine, vec3(p.f0), vec3(1.0)); }"},
                 {"f82", "Schlick less a term that is right at 82 degrees: Lazanyi 2005, Hoffman 2019",
                  fits + "vec3 shade(Point p) { return fresnel_f82(p.cosine, vec3(p.f0), vec3(p.f82)); }"},
                 {"exact_dielectric", "both polarisations of a real index",
                  exact_forms + "vec3 shade(Point p) { return vec3(fresnel_dielectric(p.cosine, p.n)); }"},
                 {"exact_conductor", "both polarisations of a complex index",
                  exact_forms + "vec3 shade(Point p) { return vec3(fresnel_conductor(p.cosine, p.n, p.k)); }"}};
    const auto below = [&](Metric metric, const char* a, const char* b, double factor, const char* scene_name,
                           const char* because) {
        f.expectations.push_back({metric, Relation::below, a, b, factor, scene_name, because});
    };
    below(Metric::time, "schlick_faded", "schlick_pow", 9.0, "", "measured before as 0.14 and 1.27 ns");
    below(Metric::time, "schlick_faded", "schlick_pow", 1.0, "", "");
    f.expectations.push_back({Metric::max_abs, Relation::near, "schlick_faded", "schlick_pow", 1.0 + 1e-5, "", "the same fit"});
    below(Metric::time, "schlick_faded", "schlick_gaussian", 1.0, "", "exp2 alone is 0.1 ns");
    below(Metric::time, "exact_dielectric", "exact_conductor", 1.0, "", "");
    below(Metric::max_abs, "f82", "schlick", 1.0, "conductors", "the dip near 82 degrees");
    below(Metric::max_abs, "exact_dielectric", "schlick", 1.0, "dielectrics", "");
    f.expectations.push_back({Metric::max_abs, Relation::at_most, "exact_dielectric", "", 2e-6, "dielectrics", "rounding alone"});
    f.expectations.push_back({Metric::max_abs, Relation::at_most, "exact_conductor", "", 2e-6, "", "rounding alone"});
    f.expectations.push_back(
        {Metric::max_abs, Relation::at_most, "schlick", "", 0.2105, "dielectrics", "the largest error at index 1.1"});
    below(Metric::max_abs, "schlick", "schlick_faded", 1.0, "dielectrics",
          "a real index below 1.33 has f0 below 0.02, and fades");
    return f;
}

}  // namespace kiln::report
