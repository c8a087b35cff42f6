// A box like Cornell's in its lightmaps, shown by whole variants.

#include <cmath>
#include <cstdio>

#include "compiler/bake/bc_encoder.h"
#include "tests/device/glsl.h"
#include "tests/images/variants.h"
#include "uber/reference/cornell.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr int chart = 32;

std::shared_ptr<ImageData> encoded(BcFormat format, TexelFormat texels, const FloatImage& image) {
    Result<BcImage> out = encode_bc(format, image, "floor", std::string(KILN_SOURCE_DIR) + "/compiler/bake");
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    auto made = std::make_shared<ImageData>();
    made->format = texels;
    made->width = made->height = chart;
    if (out.ok()) made->texels = out->blocks;
    return made;
}

// The floor of a box like Cornell's: moments of its light, and the same as block-compressed textures.
struct Floor {
    std::vector<ShMomentsL1<double>> moments;
    FloatImage l0{chart, chart, {}}, ratios[3] = {l0, l0, l0};  // y, z, x
};

Floor make_floor() {
    const CornellBox box{CornellRoom{}};
    Floor floor;
    const auto append = [](FloatImage& image, const V3& c) {
        image.rgba.insert(image.rgba.end(), {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z), 1.0f});
    };
    for (int i = 0; i < chart * chart; ++i) {
        ShMomentsL1<double> m{};
        box.light_at({(i % chart + 0.5) / chart, 0.0, (i / chart + 0.5) / chart}, V3{0, 1, 0}, 256,
                     [&](const ArrivingLight& l) { m = sh_moments_accumulate(m, l.direction, l.radiance, l.solid_angle); });
        floor.moments.push_back(m);
        append(floor.l0, m.m0);
        for (const auto& [to, c] :
             {std::pair{&floor.ratios[0], &m.m1_y}, {&floor.ratios[1], &m.m1_z}, {&floor.ratios[2], &m.m1_x}})
            append(*to, encode_sh_ratio(m.m0, *c));
    }
    return floor;
}

using Texels = std::shared_ptr<const ImageData>;

// A white square seen straight on, a pixel a texel of its chart.
Scene chart_scene() {
    Scene s = scene(true, false);
    SurfaceBlocks& b = s.blocks;
    b.model = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    b.view_projection = {{{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1, 0}, {-1, -1, 0.5, 1}}};
    b.emissive = {0, 0, 0};
    b.base_factor = {1, 1, 1, 0};
    b.lightmap_rect = {1, 1, 0, 0};
    b.lightmap_range = 1;
    s.maps.base_map = Texture2D(1, 1, {1, 1, 1, 1}, false, TextureWrap::repeat);
    return s;
}

// Irradiance that the variant shows, pi times its radiance, against what the moments have: root of the mean square over texels,
// channels and seven normals, in units of m0 / 4.
double shown_error(const Variant& v, const Floor& floor, const Texels& base, const std::vector<Texels>& first) {
    Scene s = chart_scene();
    std::vector<NamedInputs> inputs;
    std::vector<V3> normals;
    for (int tilt = 0; tilt < 7; ++tilt) {
        const double lean = tilt == 0 ? 0 : 0.6, phi = tilt * pi / 3;
        const V3 n = f32(V3{std::sin(lean) * std::cos(phi), std::cos(lean), std::sin(lean) * std::sin(phi)});
        normals.push_back(n);
        s.mesh = {};
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.0, 0.0}, {1.0, 1.0}, {1.0, 0.0}})
            s.mesh.vertices.push_back({{x, y, 0}, n, {x, y}, {x, y}, {1, 0, 0, 1}});
        s.mesh.body = {plane, plane};
        inputs.push_back(inputs_of(s));
        const SamplerState nearest{Filter::nearest, MipFilter::none, Wrap::clamp, Comparison::off};
        auto& textures = inputs.back().textures;
        textures["lightmap_l0"] = {base, nearest};
        textures["lightmap_l1_y"] = {first[0], nearest};
        textures["lightmap_l1_z"] = {first[1], nearest};
        textures["lightmap_l1_x"] = {first[2], nearest};
    }
    const std::vector<RunOutput> runs = draw(v.stages, inputs, chart);
    double squares = 0;
    size_t count = 0;
    for (size_t t = 0; t < normals.size(); ++t) {
        const ReadBack* got = output(runs[t], "output 0");
        EXPECT_NE(got, nullptr);
        for (size_t i = 0; got != nullptr && i < floor.moments.size(); ++i) {
            const ShMomentsL1<double>& m = floor.moments[i];
            const V3 e = sh_irradiance_clamped(m, normals[t]);
            const double want[3] = {e.x, e.y, e.z}, scale[3] = {m.m0.x, m.m0.y, m.m0.z};
            for (size_t c = 0; c < 3; ++c, ++count) {
                const double off = (pi * static_cast<double>(as_float(got->words[4 * i + c])) - want[c]) / (scale[c] / 4);
                squares += off * off;
            }
        }
    }
    return std::sqrt(squares / static_cast<double>(count));
}

// The floor as a white surface with normals of several tilts shows the irradiance of the lightmap's coefficients, within what
// blocks lose of them (family 9 of the report).
TEST(ClosedForm, LightmapOfACornellBox) {
    const Floor floor = make_floor();
    const Texels base = encoded(BcFormat::bc6h, TexelFormat::bc6h_ufloat, floor.l0);
    // Of a ratio 2 sqrt(3) half steps at most: 0.0136 with 8 bits, 0.112 with 5; of m0 a step of BC6H's sixteen between the ends
    // of two octaves, 0.139 at most and 1 / sqrt(3) of it in the mean (tests/bakes/lightmap.cpp).
    const struct {
        const char* lightmap;
        BcFormat format;
        TexelFormat texels;
        double allowed;
    } kinds[] = {{"sh_hq", BcFormat::bc7, TexelFormat::bc7_unorm, std::hypot(0.0136, 0.139 / 1.7320508)},
                 {"sh_lq", BcFormat::bc1, TexelFormat::bc1_rgb_unorm, std::hypot(0.112, 0.139 / 1.7320508)}};
    for (const auto& k : kinds) {
        std::vector<Texels> first;
        for (const FloatImage& r : floor.ratios) first.push_back(encoded(k.format, k.texels, r));
        const Values values = {{"pass", "forward"}, {"material", "pbr_sg"}, {"lightmap", k.lightmap}};
        const double rms = shown_error(surface_variant(values), floor, base, first);
        EXPECT_LE(rms, k.allowed) << k.lightmap;
        std::printf("KILN_IMAGES lightmap %s: RMS %.4f of m0 / 4, %.4f allowed\n", k.lightmap, rms, k.allowed);
        const struct {
            const char *what, *from, *to;
        } wrong[] = {{"the constant band over pi", "vec3(0.25) + 0.5 * (", "vec3(0.318310) + 0.5 * ("},
                     {"the first band by its basis constant", "0.5 * (ratio_y", "0.25 * (ratio_y"},
                     {"another order of the first band", "ratio_y * n.y + ratio_z * n.z", "ratio_y * n.z + ratio_z * n.y"},
                     {"ratios that are read as they are stored", "return texel * 2.0 - 1.0", "return texel"}};
        for (const auto& w : wrong) {
            const double far = shown_error(surface_variant(values, {{w.from, w.to}}), floor, base, first);
            EXPECT_GT(far, k.allowed) << k.lightmap << ", " << w.what;
            std::printf("KILN_IMAGES lightmap %s, %s: RMS %.4f\n", k.lightmap, w.what, far);
        }
    }
}

}  // namespace
}  // namespace kiln::test
