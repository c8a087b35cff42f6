// Lightmaps: the first harmonics band or one colour, in formats from 32 bytes a texel to 2.5, through real textures.
#include <array>
#include <mutex>

#include "compiler/bake/bc_encoder.h"
#include "compiler/report/families/families.h"
#include "compiler/report/resources.h"
#include "uber/reference/cornell.h"
#include "uber/reference/sh_lightmap.h"

namespace kiln::report {

namespace {

using Moments = reference::ShMomentsL1<double>;

constexpr uint32_t side = 32;
constexpr size_t texels = size_t{side} * side;
constexpr int gathered = 512;                    // directions of a gather; the lamp's are added to them
const Vec3d sun{0.9682458365518543, 0.25, 0.0};  // n.l = 1/4 on the floor

enum Map : size_t { cornell, even, stripes, sunlit, maps };

struct Setting {
    const char *name, *what, *truth, *glsl;
    Map map;
};

// Sixteen normals around the floor's own, +y: it, five at 25 degrees, ten at 50.
const char* const normals_text = R"(
vec3 normal_of(int k) {
    const float tilt = k == 0 ? 0.0 : k < 6 ? 0.4363323 : 0.8726646;
    const float phi = float(k) * (k < 6 ? 1.2566371 : 0.6283185) + (k < 6 ? 0.0 : 0.3);
    return vec3(sin(tilt) * cos(phi), cos(tilt), sin(tilt) * sin(phi));
}
vec2 centre_of(vec2 at) { return (floor(at * 32.0) + 0.5) / 32.0; }
)";

const char* const gathered_text = "the light of the bake's own directions on every normal, in double precision";

const Setting settings[] = {
    {"floor", "The floor of a box like Cornell's, in the middle of texels, with the floor's own normal.", gathered_text,
     "Point point_at(vec2 u) { Point p; p.uv = centre_of(u); p.n = vec3(0.0, 1.0, 0.0); return p; }", cornell},
    {"bumped", "The same with sixteen normals, one a tile, up to 50 degrees from the floor's.", gathered_text,
     "Point point_at(vec2 u) {\n    Point p;\n    const vec2 tile = floor(u * 4.0);\n    p.uv = centre_of(fract(u * 4.0));\n"
     "    p.n = normal_of(int(tile.x + 4.0 * tile.y));\n    return p;\n}",
     cornell},
    {"between", "The same sixteen normals between the middles of texels, where a sampler filters.", gathered_text,
     "Point point_at(vec2 u) {\n    Point p;\n    const vec2 tile = floor(u * 4.0);\n"
     "    p.uv = mix(vec2(0.5 / 32.0), vec2(31.5 / 32.0), fract(u * 4.0));\n"
     "    p.n = normal_of(int(tile.x + 4.0 * tile.y));\n    return p;\n}",
     cornell},
    {"encoding",
     "The directions of that floor at one brightness, m0 = 4, and the sixteen normals: maxAbs is the error of E over m0 / 4.",
     "the same two bands, not encoded, in double precision",
     "Point point_at(vec2 u) {\n    Point p;\n    const vec2 tile = floor(u * 4.0);\n    p.uv = centre_of(fract(u * 4.0));\n"
     "    p.n = normal_of(int(tile.x + 4.0 * tile.y));\n    return p;\n}",
     even},
    {"contrast",
     "From a texel lit brightly from the right to one a hundred times darker, lit from the left; normals tilted left to right "
     "from bottom to top.",
     "moments mixed linearly, in double precision",
     "Point point_at(vec2 u) {\n    Point p;\n    p.uv = vec2(mix(15.5, 16.5, u.x) / 32.0, 0.5);\n"
     "    const float a = (u.y * 2.0 - 1.0) * 0.4;\n    p.n = vec3(sin(a), cos(a), 0.0);\n    return p;\n}",
     stripes},
    {"sunlit", "A sun of unit irradiance, n.l = 1/4 on the floor, and all normals of the sphere, equal areas for equal areas.",
     "closed form: n.l, not below 0",
     "Point point_at(vec2 u) {\n    Point p;\n    const float y = 1.0 - 2.0 * u.y, r = sqrt(max(1.0 - y * y, 0.0)), phi = "
     "6.2831853 * u.x;\n    p.n = vec3(r * cos(phi), y, r * sin(phi));\n    p.uv = u;\n    return p;\n}",
     sunlit}};

const reference::CornellBox& box() {
    static const reference::CornellBox one{reference::CornellRoom{}};
    return one;
}

Vec3d gathered_light(double x, double z, const Vec3d& n) {
    Vec3d e{};
    box().light_at({x, 0.0, z}, {0.0, 1.0, 0.0}, gathered, [&](const reference::ArrivingLight& l) {
        e = e + l.radiance * (l.solid_angle * std::max(0.0, dot(l.direction, n)));
    });
    return e;
}

// What a renderer would have baked, before any encoding.
struct Bake {
    std::array<std::vector<Moments>, maps> moments;
    std::array<std::vector<Vec3d>, maps> flat;  // E with the floor's normal
};

Bake make_bake(const Jobs& jobs) {
    Bake out;
    for (size_t m = 0; m < maps; ++m) out.moments[m].resize(texels), out.flat[m].resize(texels);
    jobs.each(side, [&](size_t y) {
        for (size_t x = 0; x < side; ++x) {
            const size_t i = y * side + x;
            const double u = (static_cast<double>(x) + 0.5) / side, v = (static_cast<double>(y) + 0.5) / side;
            Moments m{};
            box().light_at({u, 0.0, v}, {0.0, 1.0, 0.0}, gathered, [&](const reference::ArrivingLight& l) {
                m = reference::sh_moments_accumulate(m, l.direction, l.radiance, l.solid_angle);
            });
            out.moments[cornell][i] = m;
            const Vec3d to_even = reference::splat3(4.0) / m.m0;
            out.moments[even][i] = {m.m0 * to_even, m.m1_y * to_even, m.m1_z * to_even, m.m1_x * to_even};
            const double bright = x < side / 2 ? 1.0 : 0.01;
            out.moments[stripes][i] = {reference::splat3(bright), {}, {}, reference::splat3(x < side / 2 ? bright : -bright)};
            out.moments[sunlit][i] = {reference::splat3(1.0), reference::splat3(sun.y), reference::splat3(sun.z),
                                      reference::splat3(sun.x)};
            for (size_t map = 0; map < maps; ++map)
                out.flat[map][i] = map == cornell  ? gathered_light(u, v, {0.0, 1.0, 0.0})
                                   : map == sunlit ? reference::splat3(sun.y)
                                                   : reference::sh_irradiance_clamped(out.moments[map][i], {0.0, 1.0, 0.0});
        }
    });
    return out;
}

// The four coefficients of all maps as images, and their blocks: every format is encoded once, all images in one, since most
// of the encoder's time is its start. Blocks know nothing of one another.
class Textures {
public:
    explicit Textures(std::string encoder) : encoder_(std::move(encoder)) {}

    const Bake& bake(const Jobs& jobs) {
        std::call_once(baked_, [&] { bake_ = make_bake(jobs); });
        return bake_;
    }

    // Coefficient k of m0, m1_y, m1_z, m1_x; m1 as 0.5 + 0.5 m1 / m0 when `ratio`.
    std::vector<float> image(Map map, size_t k, bool ratio, const Jobs& jobs) {
        std::vector<float> out;
        for (const Moments& m : bake(jobs).moments[map]) {
            const Vec3d c = k == 0 ? m.m0 : k == 1 ? m.m1_y : k == 2 ? m.m1_z : m.m1_x;
            const Vec3d t = ratio && k != 0 ? reference::encode_sh_ratio(m.m0, c) : c;
            for (const double v : {t.x, t.y, t.z, 1.0}) out.push_back(static_cast<float>(v));
        }
        return out;
    }

    Result<Bytes> blocks(BcFormat format, Map map, size_t k, const Jobs& jobs) {
        std::vector<std::pair<size_t, size_t>> order;  // images in the atlas
        for (size_t m = 0; m < maps; ++m)
            for (size_t c = format == BcFormat::bc6h ? 0 : 1; c < (format == BcFormat::bc6h ? 1u : 4u); ++c)
                order.push_back({m, c});
        Bytes& all = blocks_[format];
        if (all.empty()) {
            FloatImage atlas{side, static_cast<uint32_t>(side * order.size()), {}};
            for (const auto& [m, c] : order) {
                const std::vector<float> one = image(static_cast<Map>(m), c, true, jobs);
                atlas.rgba.insert(atlas.rgba.end(), one.begin(), one.end());
            }
            auto encoded = encode_bc(format, std::move(atlas), "lightmap", encoder_);
            KILN_TRY(encoded);
            if (!encoded->warnings.empty()) return input_error(encoded->warnings.front());
            all = std::move(encoded->blocks);
        }
        const size_t size = texels / 16 * bc_block_bytes(format);
        const auto at = static_cast<size_t>(std::find(order.begin(), order.end(), std::pair{size_t{map}, k}) - order.begin());
        return Bytes(all.begin() + static_cast<std::ptrdiff_t>(at * size),
                     all.begin() + static_cast<std::ptrdiff_t>((at + 1) * size));
    }

private:
    std::string encoder_;
    std::once_flag baked_;
    Bake bake_;
    std::map<BcFormat, Bytes> blocks_;
};

SamplerState linear() {
    SamplerState s;
    s.mips = MipFilter::none;
    s.wrap = Wrap::clamp;
    return s;
}

Scene scene_of(size_t index, const std::shared_ptr<Textures>& textures, bool quick) {
    const Setting& setting = settings[index];
    Scene s;
    s.name = setting.name;
    s.what = setting.what;
    s.truth = setting.truth;
    s.width = s.height = quick ? 64 : 128;
    s.glsl = std::string(normals_text) + setting.glsl;
    s.reference = [&setting, textures, w = s.width, h = s.height](const Points& points, const Effort& effort) {
        const Bake& bake = textures->bake(effort.jobs);
        return per_point(points, w, h, effort, [&](size_t i) -> Vec3d {
            const double u = points.scalar(i, 0), v = points.scalar(i, 1);
            const Vec3d n = normalize(points.vector(i, 2));
            if (setting.map == cornell) return gathered_light(u, v, n);
            if (setting.map == sunlit) return reference::splat3(std::max(0.0, dot(n, sun)));
            const std::vector<Moments>& m = bake.moments[setting.map];
            if (setting.map == even)
                return reference::sh_irradiance_clamped(m[static_cast<size_t>(v * side) * side + static_cast<size_t>(u * side)],
                                                        n);
            const double t = u * side - 15.5;
            const Moments &a = m[15], &b = m[16];
            return reference::sh_irradiance_clamped(
                Moments{mix(a.m0, b.m0, t), mix(a.m1_y, b.m1_y, t), mix(a.m1_z, b.m1_z, t), mix(a.m1_x, b.m1_x, t)}, n);
        });
    };
    return s;
}

const char* const ratio_text =
    "#include \"sh_lightmap.glsl\"\n"
    "vec3 shade(Point p) {\n    return sh_l1_irradiance(textureLod(m0, p.uv, 0.0).rgb, decode_sh_ratio(textureLod(m1_y, p.uv, "
    "0.0).rgb),\n        decode_sh_ratio(textureLod(m1_z, p.uv, 0.0).rgb), decode_sh_ratio(textureLod(m1_x, p.uv, 0.0).rgb), "
    "p.n);\n}";
const char* const names[] = {"m0", "m1_y", "m1_z", "m1_x"};

}  // namespace

Family lightmap_family(bool quick, const std::string& bc_encoder) {
    Family f;
    f.number = 9;
    f.name = "lightmap";
    f.title = "Lightmaps";
    f.what =
        "Irradiance from a lightmap of 32 x 32 texels: one colour, or the first harmonics band as a brightness and three "
        "directions over it, filtered by the sampler. Bytes are those of all its textures: 1024 for every byte a texel.";
    f.primary = Metric::relmse;
    f.fields = {{"vec2", "uv"}, {"vec3", "n"}};
    f.timed_scene = 2;
    const auto textures = std::make_shared<Textures>(bc_encoder);
    for (size_t i = 0; i < std::size(settings); ++i) f.scenes.push_back(scene_of(i, textures, quick));

    using Resources = Result<std::vector<Resource>>;
    const auto add = [&](const char* name, const char* what, const char* glsl,
                         std::function<Resources(Map, const Jobs&)> maps_of) {
        Member m;
        m.name = name;
        m.what = what;
        m.glsl = glsl;
        m.resources = [maps_of = std::move(maps_of)](size_t scene, Bench&, const Effort& effort) -> Resources {
            return maps_of(settings[scene].map, effort.jobs);
        };
        f.members.push_back(std::move(m));
    };
    const auto flat = [&](const char* name, const char* what, TexelFormat format) {
        add(name, what,
            "#include \"sh_lightmap.glsl\"\n"
            "vec3 shade(Point p) { return decode_flat_lightmap(textureLod(light, p.uv, 0.0).rgb, range.x); }",
            [textures, format](Map map, const Jobs& jobs) -> Resources {
                double range = 0.0;
                std::vector<float> image;
                for (const Vec3d& e : textures->bake(jobs).flat[map]) range = std::max(range, reference::max_component(e));
                for (const Vec3d& e : textures->bake(jobs).flat[map])
                    for (const double v : {e.x / range, e.y / range, e.z / range, 1.0}) image.push_back(static_cast<float>(v));
                Resource block = uniform_buffer("uniform Range { vec4 range; }", {static_cast<float>(range), 0, 0, 0});
                block.bytes = 0;  // of the draw, not of the map
                return std::vector<Resource>{picture_map("light", format, side, side, {image}, linear()), block};
            });
    };
    // One texture a coefficient, each in its format; `ratio`: m1 / m0.
    const auto harmonics = [&](const char* name, const char* what, const char* glsl, TexelFormat first, TexelFormat others,
                               bool ratio) {
        add(name, what, glsl, [textures, first, others, ratio](Map map, const Jobs& jobs) -> Resources {
            std::vector<Resource> out;
            for (size_t k = 0; k < 4; ++k) {
                const TexelFormat format = k == 0 ? first : others;
                if (format < TexelFormat::bc1_rgb_unorm || format > TexelFormat::bc7_srgb) {
                    out.push_back(picture_map(names[k], format, side, side, {textures->image(map, k, ratio, jobs)}, linear()));
                    continue;
                }
                const BcFormat blocks = format == TexelFormat::bc6h_ufloat ? BcFormat::bc6h
                                        : format == TexelFormat::bc7_unorm ? BcFormat::bc7
                                                                           : BcFormat::bc1;
                auto encoded = textures->blocks(blocks, map, k, jobs);
                KILN_TRY(encoded);
                out.push_back(block_map(names[k], format, side, side, std::move(*encoded), linear()));
            }
            return out;
        });
    };
    constexpr auto half = TexelFormat::rgba16_float;
    flat("flat_rgba8", "one colour, sRGB transfer: 4 bytes a texel, one fetch", TexelFormat::rgba8_srgb);
    flat("flat_unorm8", "one colour, linear: 4 bytes", TexelFormat::rgba8_unorm);
    flat("flat_rgba16f", "one colour, half floats: 8 bytes", half);
    harmonics(
        "sh_rgba16f", "four moments in half floats: 32 bytes, four fetches",
        "#include \"sh.glsl\"\n"
        "vec3 shade(Point p) {\n    return sh_irradiance_clamped(ShMomentsL1(textureLod(m0, p.uv, 0.0).rgb, textureLod(m1_y, "
        "p.uv, 0.0).rgb,\n        textureLod(m1_z, p.uv, 0.0).rgb, textureLod(m1_x, p.uv, 0.0).rgb), p.n);\n}",
        half, half, false);
    harmonics("sh_ratio16f", "m1 over m0, half floats: 32 bytes", ratio_text, half, half, true);
    harmonics("sh_ratio8", "m0 in half floats, m1 over m0 in RGBA8: 20 bytes", ratio_text, half, TexelFormat::rgba8_unorm, true);
    if (!bc_encoder.empty()) {
        constexpr auto bc6h = TexelFormat::bc6h_ufloat, bc7 = TexelFormat::bc7_unorm, bc1 = TexelFormat::bc1_rgb_unorm;
        harmonics("sh_hq", "BC6H and three BC7: 4 bytes", ratio_text, bc6h, bc7, true);
        harmonics("sh_lq", "BC6H and three BC1: 2.5 bytes", ratio_text, bc6h, bc1, true);
        harmonics("sh_hq_nonlinear", "the same textures as sh_hq, Hazel's non-linear form",
                  "#include \"sh.glsl\"\n#include \"sh_lightmap.glsl\"\n"
                  "vec3 shade(Point p) {\n    const vec3 m = textureLod(m0, p.uv, 0.0).rgb;\n"
                  "    return sh_irradiance_nonlinear(ShMomentsL1(m, m * decode_sh_ratio(textureLod(m1_y, p.uv, 0.0).rgb),\n"
                  "        m * decode_sh_ratio(textureLod(m1_z, p.uv, 0.0).rgb), m * decode_sh_ratio(textureLod(m1_x, p.uv, "
                  "0.0).rgb)), p.n);\n}",
                  bc6h, bc7, true);
        harmonics("sh_bc6h_alone", "m0 in BC6H, the rest in half floats: 25 bytes", ratio_text, bc6h, half, true);
        harmonics("sh_bc7_alone", "m0 in half floats, the rest in BC7: 11 bytes", ratio_text, half, bc7, true);
        harmonics("sh_bc1_alone", "m0 in half floats, the rest in BC1: 9.5 bytes", ratio_text, half, bc1, true);
    } else {
        f.remarks = [](const TimeOf&) -> std::vector<std::string> {
            return {
                "Left out: members in BC6H, BC7 and BC1, since their encoder (bake/encode_bc.mjs with its package, run by Node) "
                "is not installed."};
        };
    }

    const auto expect = [&](Metric metric, Relation relation, const char* a, const char* b, double factor, const char* scene,
                            const char* because) {
        f.expectations.push_back({metric, relation, a, b, factor, scene, because});
    };
    // Quantisation: 2 sqrt(3) half steps of m1 / m0, of 8 bits and of BC1's 5.
    for (const Metric metric : {Metric::max_abs, Metric::rmse}) {
        expect(metric, Relation::at_most, "sh_ratio8", "", 0.0136, "encoding", "2 sqrt 3 half steps of 8 bits");
        expect(metric, Relation::at_most, "sh_bc7_alone", "", 0.0136, "encoding", "2 sqrt 3 half steps of 8 bits");
        expect(metric, Relation::at_most, "sh_bc1_alone", "", 0.112, "encoding", "2 sqrt 3 half steps of 5 bits");
    }
    for (const char* scene : {"encoding", "bumped"})
        for (Expectation& e : ascending(Metric::relmse, {"sh_rgba16f", "sh_hq", "sh_lq", "flat_rgba8"}, scene))
            f.expectations.push_back(std::move(e));
    expect(Metric::relmse, Relation::below, "flat_rgba8", "sh_hq", 1.0, "floor", "one normal needs no direction");
    expect(Metric::relmse, Relation::near, "sh_hq", "sh_lq", 1.1, "bumped", "what two bands leave out outweighs the encoding");
    expect(Metric::relmse, Relation::near, "flat_rgba8", "flat_rgba16f", 1.05, "bumped", "and for one colour still more");
    expect(Metric::relmse, Relation::below, "flat_rgba8", "flat_unorm8", 1.0, "floor", "sRGB steps where it is dark");
    expect(Metric::relmse, Relation::below, "sh_rgba16f", "sh_ratio16f", 1e3, "contrast",
           "moments filter linearly, their ratio does not: m1 is lost between the texels");
    expect(Metric::rmse, Relation::at_least, "flat_rgba16f", "", 0.32, "sunlit", "0.79 of the RMS: a constant for a delta");
    expect(Metric::rmse, Relation::at_most, "flat_rgba16f", "", 0.326, "sunlit", "0.79 of the RMS: a constant for a delta");
    for (const char* m : {"sh_rgba16f", "sh_hq", "sh_lq"})
        expect(Metric::rmse, Relation::at_most, m, "", 0.127, "sunlit", "0.125: two bands, clamped");
    for (Expectation& e : ascending(Metric::bytes, {"sh_lq", "sh_hq", "sh_rgba16f"})) f.expectations.push_back(std::move(e));
    expect(Metric::bytes, Relation::near, "flat_rgba8", "sh_hq", 1.0, "", "4 bytes a texel, both");
    expect(Metric::time, Relation::below, "flat_rgba8", "sh_hq", 1.0, "", "one fetch for four");
    expect(Metric::time, Relation::below, "flat_rgba16f", "sh_rgba16f", 2.0, "", "one fetch for four");
    expect(Metric::time, Relation::near, "sh_lq", "sh_hq", 1.1, "", "as many fetches");
    expect(Metric::time, Relation::below, "sh_hq", "sh_rgba16f", 1.0, "", "an eighth of the bytes");
    return f;
}

}  // namespace kiln::report
