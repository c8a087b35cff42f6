// Light after one bounce in a small room: screen rays, lamps of a shadow map, voxel cones, distance fields, paths.
#include "compiler/report/bench.h"
#include "compiler/report/families/families.h"
#include "compiler/report/kernel.h"
#include "compiler/report/resources.h"
#include "uber/reference/gi_cornell.h"
#include "uber/reference/gi_truth.h"

namespace kiln::report {

namespace {

constexpr uint32_t voxels = 32, screen = 128;

// Points of the floor, and of the blocks' tops where they stand.
const char* const point_text = R"(
Point point_at(vec2 u) {
    Point p;
    const vec2 q = u * 1.9 - 0.95;
    if (GI_SCENE == 2) {
        p.position = vec3(q.x * 0.5, -0.5, q.y * 0.5);
        return p;
    }
    const bool low = q.x > 0.05 && q.x < 0.65 && q.y > 0.05 && q.y < 0.65;
    const bool tall = q.x > -0.7 && q.x < -0.1 && q.y > -0.6 && q.y < 0.0;
    p.position = vec3(q.x, GI_SCENE != 0 ? -1.0 : low ? -0.4 : tall ? 0.2 : -1.0, q.y);
    return p;
}
uint seed_of(Point p) { return hash(floatBitsToUint(p.position.x) ^ hash(floatBitsToUint(p.position.z))); }
const vec3 up = vec3(0.0, 1.0, 0.0);
)";

const char* const room_text = "#include \"gi_cornell.glsl\"\n#include \"gi_path.glsl\"\n";

// As point_at has it in the first room.
double height_of(double x, double z) {
    const bool low = x > 0.05 && x < 0.65 && z > 0.05 && z<0.65, tall = x> - 0.7 && x < -0.1 && z > -0.6 && z < 0.0;
    return low ? -0.4 : tall ? 0.2 : -1.0;
}

Scene scene_of(bool quick, int number, const std::string& name, const std::string& what) {
    Scene s;
    s.name = name;
    s.what = what;
    s.width = s.height = quick ? 12 : 24;
    s.glsl = "#define GI_SCENE " + std::to_string(number) + "\n" + point_text;
    const int shifts = quick ? 20 : 64;
    const char* const closed[] = {"", "closed form: pi (1 + albedo)", "closed form (Lambert's polygon)"};
    s.truth = number == 0 ? std::to_string(shifts) + " lattices of 4181 directions, shifted at random, in double precision"
                          : closed[number];
    s.reference = [number, shifts, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        const auto quads = reference::gi_cornell_quads();
        const auto plate = reference::gi_plate_quads()[1];
        std::vector<double> variance(number == 0 ? 3 * points.count() : 0);
        Reference out = per_point(points, w, h, effort, [&](size_t i) {
            if (number == 1) return reference::splat3(reference::pi * 1.5);
            if (number == 2) return reference::splat3(reference::polygon_irradiance(points.vector(i, 0), {0, 1, 0}, plate));
            const auto e = reference::gi_irradiance_lattice(quads, reference::gi_cornell_lamp(), points.vector(i, 0), {0, 1, 0},
                                                            1, shifts, i + 1);
            for (size_t c = 0; c < 3; ++c) variance[3 * i + c] = e[c].standard_error * e[c].standard_error;
            return Vec3d{e[0].mean, e[1].mean, e[2].mean};
        });
        out.variance = std::move(variance);
        return out;
    };
    return s;
}

Result<std::vector<float>> baked(Bench& bench, size_t scene, uint32_t width, uint32_t height, const std::string& functions) {
    Draw draw;
    draw.width = width;
    draw.height = height;
    draw.results = size_t{4} * width * height;
    draw.groups = (width * height + group_size - 1) / group_size;
    return bench.bake(bake_text({}, "#define GI_SCENE " + std::to_string(scene) + "\n" + room_text + functions), {}, draw);
}

// Radiance times opacity, and every mip as a plain mean.
Result<std::vector<std::vector<float>>> radiance_mips(Bench& bench, size_t scene) {
    auto first = baked(bench, scene, voxels, voxels * voxels,
                       "vec4 texel(uint i) {\n    const uvec3 at = uvec3(i % 32u, (i / 32u) % 32u, i / 1024u);\n"
                       "    return gi_voxel(gi_cornell_lamp(), (vec3(at) + 0.5) * (2.0 / 32.0) - 1.0, 2.0 / 32.0);\n}");
    KILN_TRY(first);
    std::vector<std::vector<float>> mips{std::move(*first)};
    for (size_t n = voxels / 2; n >= 1; n /= 2) {
        const std::vector<float>& above = mips.back();
        std::vector<float> mip(n * n * n * 4, 0.0f);
        for (size_t z = 0; z < 2 * n; ++z)
            for (size_t y = 0; y < 2 * n; ++y)
                for (size_t x = 0; x < 2 * n; ++x)
                    for (size_t c = 0; c < 4; ++c)
                        mip[4 * ((z / 2 * n + y / 2) * n + x / 2) + c] += 0.125f * above[4 * ((z * 2 * n + y) * 2 * n + x) + c];
        mips.push_back(std::move(mip));
    }
    return mips;
}

}  // namespace

Family indirect_family(bool quick) {
    Family f;
    f.number = 12;
    f.name = "indirect";
    f.title = "Indirect light";
    f.what =
        "Irradiance after one reflection on the floor of a room of two metres. Maps and volumes are made ready before the clock "
        "starts. "
        "In the furnace and between the plates, whose walls shine by themselves, forms that know only the lamp see nothing.";
    f.primary = Metric::relmse;
    f.fields = {{"vec3", "position"}};
    f.scenes = {scene_of(quick, 0, "cornell", "A box with two blocks and a lamp under the ceiling."),
                scene_of(quick, 1, "furnace", "A closed box of emission 1 and albedo 1/2."),
                scene_of(quick, 2, "plates", "A black plate of one metre and, one metre above it, one that shines by itself.")};

    using Resources = Result<std::vector<Resource>>;
    const auto add = [&](const std::string& name, const std::string& what, const std::string& glsl,
                         std::function<Resources(size_t, Bench&, const Effort&)> resources = {}) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = glsl;
        m.resources = std::move(resources);
        f.members.push_back(std::move(m));
    };
    add("none", "no indirect light", "vec3 shade(Point p) { return vec3(0.0); }");
    add("ambient", "one colour: the mean of some points", "vec3 shade(Point p) { return ambient.rgb; }",
        [](size_t scene, Bench&, const Effort&) -> Resources {
            const double mean[] = {0.0, reference::pi * 1.5, reference::pi * reference::form_factor_parallel(1, 1, 1)};
            Vec3d sum = reference::splat3(mean[scene]);
            for (int i = 0; i < 16 && scene == 0; ++i) {
                const int row = i / 4;
                const double x = -0.7125 + 0.475 * (i % 4), z = -0.7125 + 0.475 * row;
                const auto e =
                    reference::gi_irradiance_lattice(reference::gi_cornell_quads(), reference::gi_cornell_lamp(),
                                                     {x, height_of(x, z), z}, {0, 1, 0}, 1, 1, 77 + static_cast<uint64_t>(i));
                sum = sum + Vec3d{e[0].mean, e[1].mean, e[2].mean} * (1.0 / 16.0);
            }
            return std::vector<Resource>{
                uniform_buffer("uniform Ambient { vec4 ambient; }",
                               {static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z), 0.0f})};
        });
    // A pinhole at z = 3.4 that sees the front of the box from side to side; near 0.1, far 10.
    const std::string camera =
        "const mat4 projection = mat4(vec4(2.4, 0.0, 0.0, 0.0), vec4(0.0, 2.4, 0.0, 0.0), vec4(0.0, 0.0, -10.0 / 9.9, -1.0),\n"
        "                             vec4(0.0, 0.0, -1.0 / 9.9, 0.0));\n";
    for (const int rays : {4, 16, 64})
        add("screen_" + std::to_string(rays), "rays through a depth buffer of 128 x 128",
            "#define SCREEN_RAYS " + std::to_string(rays) + "\n#include \"gi_screen.glsl\"\n" + camera +
                "vec3 shade(Point p) {\n    uint state = seed_of(p);\n"
                "    return screen_gather(depth, radiance, projection, p.position - vec3(0.0, 0.0, 3.4), up, 2.5, 0.1, "
                "state).rgb;\n}",
            [camera](size_t scene, Bench& bench, const Effort&) -> Resources {
                auto seen =
                    baked(bench, scene, screen, screen,
                          camera +
                              "vec4 texel(uint i) {\n"
                              "    const vec2 uv = (vec2(i % 128u, i / 128u) + 0.5) / 128.0;\n"
                              "    const vec3 d = normalize(vec3((uv * 2.0 - 1.0) / 2.4, -1.0)), from = vec3(0.0, 0.0, 3.4);\n"
                              "    float t;\n    const int q = gi_trace(from, d, 1e-4, 9.0, t);\n    if (q < 0) return vec4(0.0, "
                              "0.0, 0.0, 1.0);\n"
                              "    const vec3 at = from + d * t, n = normalize(cross(GI_QUAD(q).u, GI_QUAD(q).v));\n"
                              "    const float z = d.z * t;\n"
                              "    const vec3 sent = GI_QUAD(q).emission + GI_QUAD(q).albedo * gi_direct(gi_cornell_lamp(), at + "
                              "n * 1e-4, n) / pi;\n"
                              "    return vec4(sent, (projection[2][2] * z + projection[3][2]) / -z);\n}");
                KILN_TRY(seen);
                std::vector<float> depth, radiance;
                for (size_t i = 0; i < seen->size(); i += 4) {
                    depth.push_back((*seen)[i + 3]);
                    radiance.insert(radiance.end(), {(*seen)[i], (*seen)[i + 1], (*seen)[i + 2], 1.0f});
                }
                SamplerState nearest;
                nearest.filter = Filter::nearest;
                nearest.mips = MipFilter::none;
                nearest.wrap = Wrap::clamp;
                return std::vector<Resource>{
                    picture_map("depth", TexelFormat::r32_float, screen, screen, {depth}, nearest),
                    picture_map("radiance", TexelFormat::rgba16_float, screen, screen, {radiance}, nearest)};
            });
    for (const uint32_t side : {8u, 16u, 32u}) {
        const std::string define = "#define RSM_SIZE " + std::to_string(side) + "\n#include \"gi_rsm.glsl\"\n";
        add("rsm_" + std::to_string(side * side), "every lit texel as a lamp: Dachsbacher and Stamminger 2005",
            define + "vec3 shade(Point p) { return rsm_gather_all(positions, normals, intensities, p.position, up); }",
            [define, side](size_t scene, Bench& bench, const Effort&) -> Resources {
                // Three maps in one bake: positions and areas, normals, intensities, one after the other.
                auto all = baked(
                    bench, scene, side, side * 3,
                    define +
                        "vec4 texel(uint i) {\n    const uint n = uint(RSM_SIZE), k = i % (n * n), which = i / (n * n);\n"
                        "    const GiLamp lamp = gi_cornell_lamp();\n    const vec3 d = rsm_direction(ivec2(k % n, k / n), "
                        "lamp.axis);\n"
                        "    float t;\n    const int q = gi_trace(lamp.position, d, 1e-4, 1e30, t);\n    if (q < 0) return "
                        "vec4(0.0);\n"
                        "    const vec3 m = normalize(cross(GI_QUAD(q).u, GI_QUAD(q).v));\n"
                        "    const float solid_angle = 2.0 * pi / float(n * n);\n"
                        "    if (which == 0u) return vec4(lamp.position + d * t, t * t * solid_angle / max(-dot(m, d), 0.05));\n"
                        "    if (which == 1u) return vec4(dot(m, d) < 0.0 ? m : vec3(0.0), 0.0);\n"
                        "    return vec4(lamp.intensity * solid_angle * GI_QUAD(q).albedo / pi, 0.0);\n}");
                KILN_TRY(all);
                SamplerState nearest;
                nearest.filter = Filter::nearest;
                nearest.mips = MipFilter::none;
                nearest.wrap = Wrap::clamp;
                std::vector<Resource> out;
                size_t at = 0;
                for (const char* name : {"positions", "normals", "intensities"}) {
                    const size_t n = size_t{4} * side * side;
                    out.push_back(picture_map(
                        name, TexelFormat::rgba32_float, side, side,
                        {std::vector<float>(all->begin() + static_cast<long>(at), all->begin() + static_cast<long>(at + n))},
                        nearest));
                    at += n;
                }
                return out;
            });
    }
    add("voxel_cones", "six cones through 32^3 voxels of radiance",
        "#include \"gi_cones.glsl\"\n"
        "vec3 shade(Point p) { return cone_gather(volume, p.position * 0.5 + 0.5, up, 1.0 / 32.0, 1.8).rgb; }",
        [](size_t scene, Bench& bench, const Effort&) -> Resources {
            auto mips = radiance_mips(bench, scene);
            KILN_TRY(mips);
            return std::vector<Resource>{volume_map("volume", TexelFormat::rgba16_float, voxels, *mips)};
        });
    for (const int cones : {4, 16, 64})
        add("sdf_cones_" + std::to_string(cones), "cones traced through a 32^3 field of distances",
            "#define SDF_CONES " + std::to_string(cones) +
                "\n#include \"gi_sdf.glsl\"\n"
                "vec3 shade(Point p) {\n    uint state = seed_of(p);\n"
                "    return sdf_gather(field, volume, SdfVolume(vec3(-1.0), vec3(2.0)), p.position, up, 3.5, 2.0 / 32.0, 2.0 / "
                "32.0, state).rgb;\n}",
            [](size_t scene, Bench& bench, const Effort&) -> Resources {
                auto mips = radiance_mips(bench, scene);
                KILN_TRY(mips);
                auto distances = baked(bench, scene, voxels, voxels * voxels,
                                       "vec4 texel(uint i) {\n    const uvec3 at = uvec3(i % 32u, (i / 32u) % 32u, i / 1024u);\n"
                                       "    return vec4(gi_distance((vec3(at) + 0.5) * (2.0 / 32.0) - 1.0), 0.0, 0.0, 0.0);\n}");
                KILN_TRY(distances);
                std::vector<float> field;
                for (size_t i = 0; i < distances->size(); i += 4) field.push_back((*distances)[i]);
                return std::vector<Resource>{volume_map("field", TexelFormat::r32_float, voxels, {field}),
                                             volume_map("volume", TexelFormat::rgba16_float, voxels, *mips)};
            });
    // The rectangles in a storage buffer: with a constant array in the text lavapipe compiles for more than ten minutes.
    for (const int paths : quick ? std::vector<int>{4, 16} : std::vector<int>{4, 16, 64})
        add("paths_" + std::to_string(paths), "paths with a shadow ray each, against the rectangles themselves",
            "#define GI_PATHS " + std::to_string(paths) +
                "\n#define GI_QUADS int(quads[0].x)\n"
                "#define GI_QUAD(i) GiQuad(quads[1 + 5 * (i)].xyz, quads[2 + 5 * (i)].xyz, quads[3 + 5 * (i)].xyz, quads[4 + 5 * "
                "(i)].rgb, quads[5 + 5 * (i)].rgb)\n"
                "#include \"gi_path.glsl\"\n"
                "vec3 shade(Point p) {\n    uint state = seed_of(p);\n"
                "    const GiLamp lamp = GiLamp(vec3(0.0, 0.9, 0.0), vec3(0.0, -1.0, 0.0), vec3(quads[0].y));\n"
                "    return gi_path_irradiance(lamp, p.position, up, 1, state);\n}",
            [](size_t scene, Bench&, const Effort&) -> Resources {
                const auto quads = scene == 0   ? reference::gi_cornell_quads()
                                   : scene == 1 ? reference::gi_furnace_quads()
                                                : reference::gi_plate_quads();
                std::vector<float> v{static_cast<float>(quads.size()), scene == 0 ? 1.0f : 0.0f, 0.0f, 0.0f};
                for (const auto& q : quads)
                    for (const Vec3d& x : {q.origin, q.u, q.v, q.albedo, q.emission})
                        for (const double c : {x.x, x.y, x.z, 0.0}) v.push_back(static_cast<float>(c));
                return std::vector<Resource>{storage_buffer("readonly buffer Quads { vec4 quads[]; }", v)};
            });

    for (const char* better : {"screen_64", "rsm_1024", "voxel_cones", "sdf_cones_64", "paths_16"})
        f.expectations.push_back(
            {Metric::relmse, Relation::below, better, "ambient", 1.0, "cornell", "ambient is worst but for none"});
    f.expectations.push_back({Metric::relmse, Relation::below, "ambient", "none", 1.0, "cornell", ""});
    for (const Expectation& e : ascending(Metric::rmse, {"rsm_1024", "rsm_256", "rsm_64"}, "cornell"))
        f.expectations.push_back(e);
    f.expectations.push_back({Metric::rmse, Relation::below, "rsm_1024", "rsm_256", 1.6, "cornell", "N^-1/2 would be 2"});
    f.expectations.push_back({Metric::bias, Relation::near, "screen_16", "screen_64", 1.3, "cornell",
                              "what is off the screen stays off, however many rays"});
    for (const Expectation& e : ascending(Metric::rmse, {"paths_16", "paths_4"}, "cornell")) f.expectations.push_back(e);
    f.expectations.push_back({Metric::max_rel, Relation::at_most, "paths_4", "", 1e-4, "furnace", "every path carries the same"});
    f.expectations.push_back({Metric::bias, Relation::at_most, "voxel_cones", "", 0.5, "furnace",
                              "the furnace's residual, a third of it light of walls on walls, which the volume does not hold"});
    f.expectations.push_back(
        {Metric::bias, Relation::at_most, "paths_16", "", 0.05, "plates", "the form factor 0.1998 of two plates"});
    for (const char* m : {"voxel_cones", "sdf_cones_64"})
        f.expectations.push_back({Metric::bias, Relation::at_most, m, "", 0.25, "plates", "what cones make of it"});
    f.expectations.push_back(
        {Metric::bias, Relation::at_least, "screen_64", "", 0.5, "plates", "the screen has the lamp edge-on, and misses it"});
    for (const Expectation& e : ascending(Metric::time, {"ambient", "rsm_64", "rsm_256", "rsm_1024"}, "cornell"))
        f.expectations.push_back(e);
    mark_random(f, {"screen_", "sdf_cones_", "paths_"});
    return f;
}

}  // namespace kiln::report
