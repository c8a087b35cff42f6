// Diffuse light from an environment: one number, harmonics, a map, Monte Carlo.
#include "compiler/report/families/families.h"
#include "compiler/report/resources.h"
#include "uber/reference/skies.h"

namespace kiln::report {

namespace {

using reference::pi;

// A sky of one colour: radiance as GLSL for those who sample it, irradiance and harmonics in double precision for those who do
// not.
struct Sky {
    std::string name, what, truth;
    std::string radiance;                             // body of float sky(vec3 d), without the sun
    double sun_half_angle = 0.0, sun_radiance = 0.0;  // what is a light of its own when split off
    double lamp_half_angle = pi;                      // of the cone around `up` that light comes from most
    std::function<double(const Vec3d&)> irradiance;
    reference::ShL2<double> sh;
};

const Vec3d up = normalize(Vec3d{0.3, 0.9, 0.2});

reference::ShL2<double> scaled(const reference::ShL2<double>& sh, double factor) {
    reference::ShL2<double> out;
    for (size_t i = 0; i < 9; ++i) out.c[i] = sh.c[i] * factor;
    return out;
}
reference::ShL2<double> sum(const reference::ShL2<double>& a, const reference::ShL2<double>& b) {
    reference::ShL2<double> out;
    for (size_t i = 0; i < 9; ++i) out.c[i] = a.c[i] + b.c[i];
    return out;
}
// The whole sphere at radiance 1 is a cap of half-angle pi.
reference::ShL2<double> linear_sh(double a, double b) {
    reference::ShL2<double> out = scaled(reference::cap_sh(up, pi), a);
    const auto m = reference::sh_l1_of(reference::linear_sky_moments(a, b, up));
    for (size_t i = 1; i < 4; ++i) out.c[i] = m.c[i];
    return out;
}

Sky furnace() {
    Sky s;
    s.name = "furnace";
    s.what = "Radiance 1 from everywhere: irradiance pi.";
    s.truth = "closed form";
    s.radiance = "return 1.0;";
    s.irradiance = [](const Vec3d&) { return pi; };
    s.sh = linear_sh(1.0, 0.0);
    return s;
}
Sky linear() {
    Sky s;
    s.name = "linear_sky";
    s.what = "Radiance 1 + 0.8 cos of the angle to the zenith.";
    s.truth = "closed form";
    s.radiance = "return 1.0 + 0.8 * dot(d, up);";
    s.irradiance = [](const Vec3d& n) { return reference::linear_sky_irradiance(1.0, 0.8, dot(up, n)); };
    s.sh = linear_sh(1.0, 0.8);
    return s;
}
Sky cap(int degrees) {
    const double angle = degrees * pi / 180.0;
    Sky s;
    s.name = "cap_" + std::to_string(degrees);
    s.what = "A round light of half-angle " + std::to_string(degrees) + " degrees and nothing else.";
    s.truth = "closed form (Lagarde and de Rousiers 2014)";
    s.radiance = "return dot(d, up) >= " + std::to_string(std::cos(angle)) + " ? 1.0 : 0.0;";
    s.irradiance = [angle](const Vec3d& n) { return reference::cap_irradiance(dot(up, n), angle); };
    s.sh = reference::cap_sh(up, angle);
    s.lamp_half_angle = angle;
    return s;
}
Sky sunny() {
    const double angle = 0.2664 * pi / 180.0, radiance = 5.0 / (2.0 * pi * (1.0 - std::cos(angle)));
    Sky s = linear();
    s.name = "sky_and_sun";
    s.what = "The linear sky and a sun of half-angle 0.2664 degrees, five times pi of it.";
    s.sun_half_angle = s.lamp_half_angle = angle;
    s.sun_radiance = radiance;
    const auto sky = s.irradiance;
    s.irradiance = [=](const Vec3d& n) { return sky(n) + radiance * reference::cap_irradiance(dot(up, n), angle); };
    s.sh = sum(s.sh, scaled(reference::cap_sh(up, angle), radiance));
    return s;
}

// Six patches, light and dark by turns: the upper and the lower half, each in three slices. Unlike a checker of even counts,
// whose odd symmetry leaves nothing in the first two bands, this one has light in both. All edges are great circles.
constexpr double patch_radiance[2] = {2.0, 0.1};

Vec3d on_the_horizon(int slice) {
    const double phi = -pi + slice * 2.0 * pi / 3.0;
    return {std::cos(phi), 0.0, std::sin(phi)};
}

// Irradiance from a spherical polygon of radiance 1, cut at the receiver's horizon: Lambert's sum over its edges.
double polygon_irradiance(const std::vector<Vec3d>& polygon, const Vec3d& n) {
    std::vector<Vec3d> above;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double at_a = dot(a, n), at_b = dot(b, n);
        if (at_a >= 0.0) above.push_back(a);
        if ((at_a >= 0.0) != (at_b >= 0.0)) above.push_back(normalize((a * at_b - b * at_a) * (at_a >= 0.0 ? -1.0 : 1.0)));
    }
    double sum = 0.0;
    for (size_t i = 0; i < above.size(); ++i) {
        const Vec3d c = cross(above[i], above[(i + 1) % above.size()]);
        const double sine = length(c);
        if (sine > 0.0) sum += std::atan2(sine, dot(above[i], above[(i + 1) % above.size()])) * dot(c, n) / sine;
    }
    return std::fabs(sum) / 2.0;
}

Sky checker() {
    Sky s;
    s.name = "checker";
    s.what = "Two heights of three slices, radiance 2 and 0.1 by turns.";
    s.truth = "closed form (Lambert's polygons)";
    s.radiance =
        "const int j = clamp(int(1.5 + 1.5 / 3.14159265 * atan(d.z, d.x)), 0, 2);\n"
        "    return (((d.y >= 0.0 ? 1 : 0) + j) & 1) == 0 ? 2.0 : 0.1;";
    s.irradiance = [](const Vec3d& n) {
        double e = 0.0;
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 3; ++j)
                e += patch_radiance[(i + j) & 1] *
                     polygon_irradiance({{0.0, i == 1 ? 1.0 : -1.0, 0.0}, on_the_horizon(j), on_the_horizon(j + 1)}, n);
        return e;
    };
    constexpr int nodes = 300;
    double sums[9] = {};
    for (int i = 0; i < 2 * nodes; ++i)
        for (int j = 0; j < 3 * nodes; ++j) {
            const double y = -1.0 + (i + 0.5) / nodes, r = std::sqrt(1.0 - y * y), phi = -pi + (j + 0.5) * 2.0 * pi / (3 * nodes);
            const auto basis = reference::sh_l2_basis(Vec3d{r * std::cos(phi), y, r * std::sin(phi)});
            for (size_t k = 0; k < 9; ++k) sums[k] += patch_radiance[(i / nodes + j / nodes) & 1] * basis[k];
        }
    for (size_t k = 0; k < 9; ++k) s.sh.c[k] = reference::splat3(sums[k] * 4.0 * pi / (6.0 * nodes * nodes));
    return s;
}

std::vector<float> coefficients(const reference::ShL2<double>& sh, size_t n) {
    std::vector<float> out;
    for (size_t i = 0; i < n; ++i)
        for (const double c : {sh.c[i].x, sh.c[i].y, sh.c[i].z, 0.0}) out.push_back(static_cast<float>(c));
    return out;
}

const char* const scene_text = R"(
const vec3 up = vec3(0.30942637, 0.92827912, 0.20628425);
Point point_at(vec2 u) {
    const vec2 q = u * 2.0 - 1.0;
    vec3 n = vec3(q, 1.0 - abs(q.x) - abs(q.y));
    const float fold = max(-n.z, 0.0);
    n.x += n.x >= 0.0 ? -fold : fold;
    n.y += n.y >= 0.0 ? -fold : fold;
    Point p;
    p.n = n * inversesqrt(dot(n, n));
    return p;
}
)";

Scene scene_of(const Sky& sky, bool quick) {
    Scene s;
    s.name = sky.name;
    s.what = sky.what + " Normals over an unfolded octahedron.";
    s.width = s.height = quick ? 48 : 96;
    s.truth = sky.truth;
    // A cone by the square of a difference: the cosine of a sun's angle has lost its digits in single precision.
    const double lamp_height = 2.0 * std::pow(std::sin(0.5 * sky.lamp_half_angle), 2);
    char text[400];
    std::snprintf(text, sizeof text,
                  "const float lamp_height = %.9g, sun_height = %.9g, sun_radiance = %.9g, sun_normal_irradiance = %.9g;\n",
                  lamp_height, 2.0 * std::pow(std::sin(0.5 * sky.sun_half_angle), 2), sky.sun_radiance,
                  sky.sun_radiance * pi * std::pow(std::sin(sky.sun_half_angle), 2));
    s.glsl =
        std::string(scene_text) + text + "float sky(vec3 d) {\n    " + sky.radiance +
        "\n}\nfloat sun(vec3 d) { return sun_radiance > 0.0 && dot(d - up, d - up) <= 2.0 * sun_height ? sun_radiance : 0.0; "
        "}\n";
    s.reference = [w = s.width, h = s.height, irradiance = sky.irradiance](const Points& points, const Effort& effort) {
        return per_point(points, w, h, effort,
                         [&](size_t i) { return reference::splat3(irradiance(normalize(points.vector(i, 0)))); });
    };
    return s;
}

}  // namespace

Family diffuse_family(bool quick) {
    Family f;
    f.number = 1;
    f.name = "diffuse";
    f.title = "Diffuse light from an environment";
    f.what =
        "Irradiance on every normal: the environment kept as one number, as four or nine harmonics, as an irradiance cube map, "
        "or "
        "sampled anew at every pixel.";
    f.primary = Metric::relmse;
    f.fields = {{"vec3", "n"}};
    f.timed_scene = 7;
    std::vector<Sky> skies{furnace(), linear(), cap(5), cap(30), cap(60), cap(90), sunny(), checker()};
    for (const Sky& s : skies) f.scenes.push_back(scene_of(s, quick));

    const auto harmonics = [&](const char* name, const char* what, size_t count, const std::string& body) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = "#include \"sh.glsl\"\n#include \"lecture_sh.glsl\"\n" + body;
        m.resources = [skies, count](size_t scene, Bench&, const Effort&) -> Result<std::vector<Resource>> {
            return std::vector<Resource>{uniform_buffer("uniform Harmonics { vec4 harmonics[" + std::to_string(count) + "]; }",
                                                        coefficients(skies[scene].sh, count))};
        };
        f.members.push_back(std::move(m));
    };
    const std::string l1 =
        "ShL1 l1() { return ShL1(vec3[4](harmonics[0].rgb, harmonics[1].rgb, harmonics[2].rgb, harmonics[3].rgb)); }\n";
    const std::string l2 =
        "ShL2 l2() { return ShL2(vec3[9](harmonics[0].rgb, harmonics[1].rgb, harmonics[2].rgb, harmonics[3].rgb, "
        "harmonics[4].rgb, harmonics[5].rgb, harmonics[6].rgb, harmonics[7].rgb, harmonics[8].rgb)); }\n";
    harmonics("ambient", "the mean radiance times pi", 1, "vec3 shade(Point p) { return harmonics[0].rgb * (pi * sh_y0); }");
    harmonics("sh_l1_lecture", "the lecture's slides read in order", 4,
              "vec3 shade(Point p) { return vec3(sh_irradiance_lecture(vec4(harmonics[0].r, harmonics[1].r, harmonics[2].r, "
              "harmonics[3].r), p.n),\n"
              "    sh_irradiance_lecture(vec4(harmonics[0].g, harmonics[1].g, harmonics[2].g, harmonics[3].g), p.n),\n"
              "    sh_irradiance_lecture(vec4(harmonics[0].b, harmonics[1].b, harmonics[2].b, harmonics[3].b), p.n)); }");
    harmonics("sh_l1", "two bands", 4, l1 + "vec3 shade(Point p) { return sh_irradiance_from_radiance(l1(), p.n); }");
    harmonics("sh_l1_clamped", "two bands, not below 0", 4,
              l1 + "vec3 shade(Point p) { return sh_irradiance_clamped(sh_moments_of(l1()), p.n); }");
    harmonics("sh_l1_nonlinear", "two bands, Hazel's non-linear form", 4,
              l1 + "vec3 shade(Point p) { return sh_irradiance_nonlinear(sh_moments_of(l1()), p.n); }");
    harmonics("sh_zh3", "two bands and a third guessed about each channel's axis: ZH3, 2024", 4,
              l1 + "vec3 shade(Point p) { return sh_irradiance_zh3(sh_moments_of(l1()), p.n); }");
    harmonics("sh_zh3_clamped", "the same, not below 0", 4,
              l1 + "vec3 shade(Point p) { return max(sh_irradiance_zh3(sh_moments_of(l1()), p.n), vec3(0.0)); }");
    harmonics("sh_zh3_luminance", "the same about one axis, that of the luminance", 4,
              l1 + "vec3 shade(Point p) { return sh_irradiance_zh3_luminance(sh_moments_of(l1()), p.n); }");
    harmonics("sh_l2", "three bands", 9, l2 + "vec3 shade(Point p) { return sh_irradiance_from_radiance(l2(), p.n); }");
    harmonics("sh_l2_clamped", "three bands, not below 0", 9,
              l2 + "vec3 shade(Point p) { return sh_irradiance_clamped(l2(), p.n); }");

    for (const uint32_t size : {16u, 32u, 64u}) {
        Member m;
        m.name = "cube_" + std::to_string(size);
        m.what = "irradiance cube map, RGBA16F, E / pi";
        m.glsl = "vec3 shade(Point p) { return textureLod(irradiance_map, p.n, 0.0).rgb * 3.14159265; }";
        m.resources = [skies, size](size_t scene, Bench&, const Effort& effort) -> Result<std::vector<Resource>> {
            std::vector<float> texels(size_t{6} * size * size * 4, 1.0f);
            effort.jobs.each(size_t{6} * size, [&](size_t row) {
                const uint32_t face = static_cast<uint32_t>(row / size);
                const double y = 2.0 * (static_cast<double>(row % size) + 0.5) / size - 1.0;
                for (uint32_t x = 0; x < size; ++x) {
                    const double e =
                        skies[scene].irradiance(normalize(cube_direction(face, 2.0 * (x + 0.5) / size - 1.0, y))) / pi;
                    for (size_t c = 0; c < 3; ++c) texels[4 * (row * size + x) + c] = static_cast<float>(e);
                }
            });
            return std::vector<Resource>{cube_map("irradiance_map", TexelFormat::rgba16_float, size, {texels})};
        };
        f.members.push_back(std::move(m));
    }

    const std::string frame_text =
        "void frame(vec3 z, out vec3 x, out vec3 y) {\n"
        "    const float side = z.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (side + z.z), b = z.x * z.y * a;\n"
        "    x = vec3(1.0 + side * z.x * z.x * a, side * b, -side * z.x);\n    y = vec3(b, side + z.y * z.y * a, -z.y);\n}\n"
        "vec2 place(uint seed, uint i) {\n    return vec2(fract(unit(seed) + float(i) * 0.754877666), fract(unit(hash(seed)) + "
        "float(i) * 0.569840291));\n}\n"
        "uint seed_of(vec3 n) { return hash(floatBitsToUint(n.x) ^ hash(floatBitsToUint(n.y) ^ hash(floatBitsToUint(n.z)))); }\n"
        "vec3 cosine_direction(vec3 t, vec3 s, vec3 n, vec2 u) {\n    const float r = sqrt(u.x), phi = 6.28318531 * u.y;\n"
        "    return t * (r * cos(phi)) + s * (r * sin(phi)) + n * sqrt(max(1.0 - u.x, 0.0));\n}\n";
    const auto sampled = [&](const std::string& name, const std::string& what, int count, bool split) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = frame_text +
                 "vec3 shade(Point p) {\n    vec3 t, s;\n    frame(p.n, t, s);\n    const uint seed = seed_of(p.n);\n"
                 "    float total = 0.0;\n    for (uint i = 0u; i < " +
                 std::to_string(count) +
                 "u; ++i) {\n        const vec3 d = cosine_direction(t, s, p.n, place(seed, i));\n        total += sky(d)" +
                 (split ? "" : " + sun(d)") + ";\n    }\n    return vec3(total * (3.14159265 / " + std::to_string(count) + ".0)" +
                 (split ? " + sun_normal_irradiance * max(dot(p.n, up), 0.0)" : "") + ");\n}";
        f.members.push_back(std::move(m));
    };
    // Half of the directions by the cosine, half evenly over the lamp's cone; the balance heuristic of Veach and Guibas 1995.
    const auto weighed = [&](int count) {
        Member m;
        m.name = "mc_" + std::to_string(count) + "_mis";
        m.what = "half of the directions cosine-weighted, half towards where the light is, weighed by the balance heuristic";
        m.glsl = frame_text +
                 "vec3 shade(Point p) {\n    vec3 t, s, ut, us;\n    frame(p.n, t, s);\n    frame(up, ut, us);\n"
                 "    const uint seed = seed_of(p.n);\n    float total = 0.0;\n    for (uint i = 0u; i < " +
                 std::to_string(count / 2) +
                 "u; ++i) {\n        for (uint which = 0u; which < 2u; ++which) {\n"
                 "            const vec2 u = place(which == 0u ? seed : hash(seed + 1u), i);\n"
                 "            const float h = u.x * lamp_height, r = sqrt(h * (2.0 - h)), phi = 6.28318531 * u.y;\n"
                 "            const vec3 d = which == 0u ? cosine_direction(t, s, p.n, u) : ut * (r * cos(phi)) + us * (r * "
                 "sin(phi)) + up * (1.0 - h);\n"
                 "            const float cosine = max(dot(p.n, d), 0.0);\n"
                 "            const float density = cosine / 3.14159265 +\n"
                 "                (dot(d - up, d - up) <= 2.0 * lamp_height ? 1.0 / (6.28318531 * lamp_height) : 0.0);\n"
                 "            total += cosine > 0.0 ? (sky(d) + sun(d)) * cosine / density : 0.0;\n        }\n    }\n"
                 "    return vec3(total * " +
                 std::to_string(2.0 / count) + ");\n}";
        f.members.push_back(std::move(m));
    };
    std::vector<int> counts{1, 4, 16, 64, 256, 1024};
    if (!quick) counts.push_back(4096);
    for (const int n : counts)
        sampled("mc_" + std::to_string(n), "cosine-weighted directions of a rank-2 lattice, turned by the pixel", n, false);
    sampled("mc_64_split", "64 directions, the sun as a light of its own", 64, true);
    weighed(64);
    weighed(256);

    for (const char* s : {"cap_5", "cap_30", "cap_60", "sky_and_sun", "checker"})
        for (Expectation& e : ascending(Metric::relmse, {"sh_l2", "sh_l1", "ambient"}, s)) f.expectations.push_back(std::move(e));
    for (const char* s : {"cap_5", "sky_and_sun"})
        f.expectations.push_back({Metric::relmse, Relation::below, "cube_64", "sh_l2", 1.0, s, ""});
    for (const char* s : {"cap_5", "cap_30", "cap_60", "sky_and_sun"}) {
        for (Expectation& e : ascending(Metric::relmse, {"sh_l2", "sh_zh3", "sh_l1"}, s)) f.expectations.push_back(std::move(e));
        f.expectations.push_back({Metric::relmse, Relation::below, "sh_zh3", "sh_l1_nonlinear", 1.0, s, "as the paper finds"});
    }
    f.expectations.push_back({Metric::relmse, Relation::below, "sh_l1", "sh_zh3", 1.0, "linear_sky",
                              "two bands are all there is; a third is made up"});
    f.expectations.push_back(
        {Metric::relmse, Relation::near, "sh_zh3_luminance", "sh_zh3", 1.01, "checker", "light of one colour has one axis"});
    for (Expectation& e : ascending(Metric::time, {"sh_l1", "sh_zh3_luminance", "sh_zh3", "sh_l1_nonlinear"}))
        f.expectations.push_back(std::move(e));
    for (const char* m :
         {"ambient", "sh_l1", "sh_l1_clamped", "sh_l1_nonlinear", "sh_zh3", "sh_l2", "cube_16", "cube_64", "mc_1", "mc_64_mis"})
        f.expectations.push_back(
            {Metric::max_rel, Relation::at_most, m, "", 1e-3, "furnace", "every method is right in a furnace"});
    f.expectations.push_back(
        {Metric::max_rel, Relation::at_least, "sh_l1_lecture", "", 0.7, "furnace", "0.886227 in place of pi"});
    f.expectations.push_back({Metric::max_rel, Relation::at_most, "sh_l1", "", 1e-5, "linear_sky", "a linear sky is two bands"});
    f.expectations.push_back(
        {Metric::relmse, Relation::below, "sh_l2", "cube_64", 1.0, "linear_sky", "the map's fp16 and filter against rounding"});
    for (Expectation& e : ascending(Metric::time, {"ambient", "sh_l1", "sh_l2", "cube_64", "mc_4"}))
        f.expectations.push_back(std::move(e));
    f.expectations.push_back({Metric::rmse, Relation::near, "mc_256", "mc_1024", 2.6, "checker", "N^-1/2 would be 2"});
    f.expectations.push_back({Metric::relmse, Relation::below, "mc_1024", "sh_l2", 1.0, "cap_60", "some 1e3 samples to pass L2"});
    f.expectations.push_back(
        {Metric::relmse, Relation::below, "sh_l2", "mc_1024", 1.0, "sky_and_sun", "never passes on a sun that is not split off"});
    f.expectations.push_back(
        {Metric::relmse, Relation::below, "mc_64_split", "mc_1024", 100.0, "sky_and_sun", "split the sun off, never sample it"});
    f.expectations.push_back(
        {Metric::relmse, Relation::below, "mc_64_mis", "mc_1024", 100.0, "sky_and_sun", "or send half of the directions to it"});
    for (const char* s : {"cap_5", "cap_30", "cap_60"})
        f.expectations.push_back({Metric::relmse, Relation::below, "mc_64_mis", "mc_64", 1.0, s, "as many directions, aimed"});
    mark_random(f, {"mc_"});
    return f;
}

}  // namespace kiln::report
