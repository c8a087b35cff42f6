// Family 9: the floor of a Cornell-like box baked to four kinds of lightmap, stored as a GPU stores them, read back through
// real textures and the library's functions, against the light that arrives, over normals.

#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>

#include "compiler/bake/bc_encoder.h"
#include "tests/bakes/shader.h"
#include "uber/reference/cornell.h"

namespace kiln::test {
namespace {

using V = reference::Vec3<double>;

constexpr int side = 32, normals = 13;

V normal_of(int k) {  // up, six at 25 degrees, six at 50
    if (k == 0) return {0, 1, 0};
    const double tilt = k <= 6 ? 0.4363 : 0.8727, phi = k * reference::pi / 3 + (k > 6 ? 0.5 : 0.0);
    return {std::sin(tilt) * std::cos(phi), std::cos(tilt), std::sin(tilt) * std::sin(phi)};
}

struct Floor {
    std::vector<reference::ShMomentsL1<double>> moments;  // by texel
    std::vector<V> truth;                                 // by texel, then normal
};

Floor bake_floor() {
    const reference::CornellBox box{reference::CornellRoom{}};
    Floor out;
    for (int i = 0; i < side * side; ++i) {
        const V p{(i % side + 0.5) / side, 0.0, (i / side + 0.5) / side};
        reference::ShMomentsL1<double> m{};
        V e[normals]{};
        box.light_at(p, V{0, 1, 0}, 512, [&](const reference::ArrivingLight& l) {
            m = reference::sh_moments_accumulate(m, l.direction, l.radiance, l.solid_angle);
            for (int k = 0; k < normals; ++k)
                e[k] = e[k] + l.radiance * (l.solid_angle * std::max(0.0, dot(l.direction, normal_of(k))));
        });
        out.moments.push_back(m);
        out.truth.insert(out.truth.end(), e, e + normals);
    }
    return out;
}

FloatImage image_of_moments(const Floor& floor, const std::function<V(const reference::ShMomentsL1<double>&)>& f) {
    FloatImage image{side, side, {}};
    for (const auto& m : floor.moments) {
        const V c = f(m);
        image.rgba.insert(image.rgba.end(), {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z), 1.0f});
    }
    return image;
}

uint16_t half_of(float x) {  // of what a half holds as a normal number, to nearest; smaller is 0
    const auto bits = std::bit_cast<uint32_t>(x);
    const uint32_t rounded = bits + 0xfff + (bits >> 13 & 1);
    const int exponent = static_cast<int>(rounded >> 23 & 255) - 127 + 15;
    if (exponent <= 0) return static_cast<uint16_t>(bits >> 16 & 0x8000);
    return static_cast<uint16_t>((bits >> 16 & 0x8000) | static_cast<uint32_t>(exponent) << 10 | (rounded >> 13 & 0x3ff));
}

std::shared_ptr<ImageData> texture(TexelFormat format, Bytes texels) {
    auto image = std::make_shared<ImageData>();
    image->format = format;
    image->width = image->height = side;
    image->texels = std::move(texels);
    return image;
}

std::shared_ptr<ImageData> halves(const FloatImage& image) {
    std::vector<uint16_t> words;
    for (const float x : image.rgba) words.push_back(half_of(x));
    return texture(TexelFormat::rgba16_float, bytes_of(words));
}

std::shared_ptr<ImageData> compressed(BcFormat format, TexelFormat texels, const FloatImage& image) {
    Result<BcImage> out = encode_bc(format, image, "floor", std::string(KILN_SOURCE_DIR) + "/compiler/bake");
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    if (!out.ok()) return nullptr;
    EXPECT_TRUE(out->warnings.empty()) << out->warnings.front();
    return texture(texels, out->blocks);
}

std::shared_ptr<ImageData> srgb8(const FloatImage& image, float range) {
    Bytes bytes;
    for (size_t i = 0; i < image.rgba.size(); ++i) {
        const double x = static_cast<double>(std::clamp(i % 4 == 3 ? 1.0f : image.rgba[i] / range, 0.0f, 1.0f));
        const double encoded = i % 4 == 3 ? x : x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
        bytes.push_back(static_cast<uint8_t>(std::lround(encoded * 255.0)));
    }
    return texture(TexelFormat::rgba8_srgb, std::move(bytes));
}

// E of every texel and normal as the device has it. images: 4 for SH, 1 for flat.
std::vector<V> shade(const std::vector<std::shared_ptr<ImageData>>& images, bool ratios, float range) {
    const bool flat = images.size() == 1;
    std::string text = "#version 450\n" + uber_text("lib/sh_lightmap.glsl") + uber_text("lib/sh.glsl") +
                       "layout(local_size_x = 64) in;\nlayout(push_constant) uniform P { float range; };\n"
                       "layout(set = 0, binding = 0) readonly buffer Normals { vec4 normals[]; };\n"
                       "layout(set = 0, binding = 1) buffer Out { vec4 e[]; };\n";
    for (size_t i = 0; i < images.size(); ++i)
        text += "layout(set = 0, binding = " + std::to_string(i + 2) + ") uniform sampler2D t" + std::to_string(i) + ";\n";
    text += "void main() {\n  int i = int(gl_GlobalInvocationID.x), texel = i / " + std::to_string(normals) +
            ";\n  vec3 n = normals[i % " + std::to_string(normals) +
            "].xyz;\n  vec2 uv = (vec2(texel % 32, texel / 32) + 0.5) / 32.0;\n";
    if (flat) {
        text += "  e[i] = vec4(decode_flat_lightmap(textureLod(t0, uv, 0.0).rgb, range), 1.0);\n}\n";
    } else if (ratios) {
        text +=
            "  e[i] = vec4(sh_l1_irradiance(textureLod(t0, uv, 0.0).rgb, decode_sh_ratio(textureLod(t1, uv, 0.0).rgb), "
            "decode_sh_ratio(textureLod(t2, uv, 0.0).rgb), decode_sh_ratio(textureLod(t3, uv, 0.0).rgb), n), 1.0);\n}\n";
    } else {
        text +=
            "  e[i] = vec4(sh_irradiance_clamped(ShMomentsL1(textureLod(t0, uv, 0.0).rgb, textureLod(t1, uv, 0.0).rgb, "
            "textureLod(t2, uv, 0.0).rgb, textureLod(t3, uv, 0.0).rgb), n), 1.0);\n}\n";
    }
    std::vector<float> directions;
    for (int k = 0; k < normals; ++k) {
        const V n = normal_of(k);
        directions.insert(directions.end(), {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z), 0.0f});
    }
    ComputeData data;
    data.buffers = {{"Normals", bytes_of(directions)}, {"Out", Bytes(size_t{side} * side * normals * 16)}};
    const SamplerState nearest{Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off};
    for (size_t i = 0; i < images.size(); ++i) data.images.push_back({"t" + std::to_string(i), images[i], nearest});
    data.push_constants = bytes_of(std::vector<float>{range});
    data.groups = {side * side * normals / 64, 1, 1};
    const std::vector<float> e = values_of<float>(run_text(text, data).buffer("Out"));
    std::vector<V> out;
    for (size_t i = 0; i + 3 < e.size(); i += 4) out.push_back({e[i], e[i + 1], e[i + 2]});
    return out;
}

struct Error {
    double encoding_rms = 0, encoding_worst = 0;  // of E against the same kind unencoded, over m0 / 4
    double absolute_worst = 0;                    // of E against the same, W/m2
    double relative_mse = 0;                      // of E against the truth
};

Error compare(const char* name, const Floor& floor, const std::vector<V>& shaded, bool flat, double bytes) {
    Error out;
    if (shaded.size() != floor.truth.size()) {
        ADD_FAILURE() << name << ": nothing was shaded";
        return out;
    }
    double mean = 0;
    for (const V& t : floor.truth) mean += (t.x + t.y + t.z) / 3 / static_cast<double>(floor.truth.size());
    size_t count = 0;
    for (size_t i = 0; i < shaded.size(); ++i) {
        const auto& m = floor.moments[i / normals];
        const V model = flat ? floor.truth[i / normals * normals]
                             : reference::sh_irradiance_clamped(m, normal_of(static_cast<int>(i % normals)));
        const double got[3] = {shaded[i].x, shaded[i].y, shaded[i].z}, want[3] = {model.x, model.y, model.z},
                     truth[3] = {floor.truth[i].x, floor.truth[i].y, floor.truth[i].z}, m0[3] = {m.m0.x, m.m0.y, m.m0.z};
        for (int c = 0; c < 3; ++c, ++count) {
            EXPECT_TRUE(std::isfinite(got[c]) && got[c] >= 0.0);
            const double e = std::fabs(got[c] - want[c]) / (0.25 * m0[c]);
            out.encoding_worst = std::max(out.encoding_worst, e);
            out.absolute_worst = std::max(out.absolute_worst, std::fabs(got[c] - want[c]));
            out.encoding_rms += e * e;
            const double d = got[c] - truth[c];
            out.relative_mse += d * d / (truth[c] * truth[c] + 0.01 * mean * mean);
        }
    }
    out.encoding_rms = std::sqrt(out.encoding_rms / static_cast<double>(count));
    out.relative_mse /= static_cast<double>(count);
    std::printf("KILN_LIGHTMAP %s bytes=%.1f relMSE=%.4g encoding_rms=%.4g encoding_worst=%.4g\n", name, bytes, out.relative_mse,
                out.encoding_rms, out.encoding_worst);
    return out;
}

TEST(Lightmap, FourKindsOfACornellBox) {
    const Floor floor = bake_floor();
    using M = reference::ShMomentsL1<double>;
    const FloatImage m0 = image_of_moments(floor, [](const M& m) { return m.m0; });
    const auto ratio = [&](auto coefficient) {
        return image_of_moments(floor, [&](const M& m) {
            const V c = coefficient(m);
            return V{0.5 + 0.5 * c.x / m.m0.x, 0.5 + 0.5 * c.y / m.m0.y, 0.5 + 0.5 * c.z / m.m0.z};
        });
    };
    const FloatImage y = ratio([](const M&m) { return m.m1_y; }), z = ratio([](const M&m) { return m.m1_z; }),
                     x = ratio([](const M&m) { return m.m1_x; });
    const auto l0 = compressed(BcFormat::bc6h, TexelFormat::bc6h_ufloat, m0);
    const auto bc = [&](BcFormat format, TexelFormat texels) {
        return std::vector{l0, compressed(format, texels, y), compressed(format, texels, z), compressed(format, texels, x)};
    };
    const auto high = bc(BcFormat::bc7, TexelFormat::bc7_unorm), low = bc(BcFormat::bc1, TexelFormat::bc1_rgb_unorm);
    const std::vector<std::shared_ptr<ImageData>> full = {halves(m0),
                                                          halves(image_of_moments(floor, [](const M& m) { return m.m1_y; })),
                                                          halves(image_of_moments(floor, [](const M& m) { return m.m1_z; })),
                                                          halves(image_of_moments(floor, [](const M& m) { return m.m1_x; }))};
    FloatImage flat{side, side, {}};
    float range = 0;
    for (int i = 0; i < side * side; ++i) {
        const V e = floor.truth[static_cast<size_t>(i * normals)];
        range = std::max(range, static_cast<float>(max_component(e)));
        flat.rgba.insert(flat.rgba.end(), {static_cast<float>(e.x), static_cast<float>(e.y), static_cast<float>(e.z), 1.0f});
    }

    const Error half = compare("rgba16f_x4", floor, shade(full, false, 1), false, 32);
    const Error hq = compare("hq_bc6h_3bc7", floor, shade(high, true, 1), false, 4);
    const Error lq = compare("lq_bc6h_3bc1", floor, shade(low, true, 1), false, 2.5);
    const Error bc6h = compare("m0_bc6h_alone", floor, shade({l0, halves(y), halves(z), halves(x)}, true, 1), false, 25);
    const Error bc7 = compare("ratios_bc7_alone", floor, shade({halves(m0), high[1], high[2], high[3]}, true, 1), false, 11);
    const Error bc1 = compare("ratios_bc1_alone", floor, shade({halves(m0), low[1], low[2], low[3]}, true, 1), false, 9.5);
    const Error rgba8 = compare("flat_rgba8_srgb", floor, shade({srgb8(flat, range)}, false, range), true, 4);

    // fp16: half an ulp of m0 and of each of three m1, which together are at most sqrt(3) m0.
    EXPECT_LE(half.encoding_worst, (1 + 2 * 1.7320508) * 0x1p-11 + 1e-5);
    // Quantisation of the ratios is at most 2 sqrt(3) half steps: 0.0136 with 8 bits (BC7), 0.112 with 5 (BC1). A block's own
    // fit to its 16 texels comes on top, so that the bounds are asked of the root mean square.
    EXPECT_LE(bc7.encoding_rms, 0.0136);
    EXPECT_LE(bc1.encoding_rms, 0.112);
    // BC6H has 16 steps, even in the logarithm, over a block's range; at the edges of shadows that is two octaves, half a step
    // 4.6 %, and E reaches 3 m0 / 4: 0.139 at most, 1 / sqrt(3) of it in the mean.
    EXPECT_LE(bc6h.encoding_rms, 0.139 / 1.7320508);
    EXPECT_LT(half.encoding_rms, hq.encoding_rms);
    EXPECT_LT(hq.encoding_rms, lq.encoding_rms);
    // sRGB is steepest at the top: half a step of 8 bits is 0.5 x 2.4 / 1.055 / 255 of the range there. A device may decode half
    // a step off again (Direct3D 11.3 functional specification, 3.2.3.8, which drivers hold Vulkan's formats to as well).
    EXPECT_LE(rgba8.absolute_worst, 2 * 0.00447 * static_cast<double>(range));
    // Against the truth: direction is worth more than precision.
    EXPECT_LT(hq.relative_mse, rgba8.relative_mse);
    EXPECT_LT(lq.relative_mse, rgba8.relative_mse);
}

// All three formats through the device's decoder: smooth ramps come back. A block spans 6/64 of the ramp; with 4 steps of BC1
// that is half a step of 0.016 and its 5-bit ends 0.016 more; 8 bits of BC7 have 16 steps. BC6H steps are relative.
TEST(Lightmap, BlocksDecodeOnTheDevice) {
    FloatImage hdr{side, side, {}}, ldr{side, side, {}};
    for (int i = 0; i < side * side; ++i) {
        const float t = static_cast<float>(i % side + i / side) / (2 * side);
        hdr.rgba.insert(hdr.rgba.end(), {0.01f + 60.0f * t * t, 1.0f + t, 300.0f * (1.0f - t), 1.0f});
        ldr.rgba.insert(ldr.rgba.end(), {t, 0.5f + 0.3f * t, 1.0f - t, 1.0f});
    }
    const struct {
        BcFormat format;
        TexelFormat texels;
        const FloatImage& image;
        double absolute, relative;
    } cases[] = {{BcFormat::bc1, TexelFormat::bc1_rgb_unorm, ldr, 0.05, 0},
                 {BcFormat::bc7, TexelFormat::bc7_unorm, ldr, 0.02, 0},
                 {BcFormat::bc6h, TexelFormat::bc6h_ufloat, hdr, 0.1, 0.1}};
    for (const auto& c : cases) {
        const auto image = compressed(c.format, c.texels, c.image);
        const std::string text =
            "#version 450\nlayout(local_size_x = 64) in;\nlayout(set = 0, binding = 0) uniform sampler2D t;\n"
            "layout(set = 0, binding = 1) buffer Out { vec4 e[]; };\nvoid main() { int i = int(gl_GlobalInvocationID.x); "
            "e[i] = texelFetch(t, ivec2(i % 32, i / 32), 0); }\n";
        ComputeData data;
        data.buffers = {{"Out", Bytes(size_t{side} * side * 16)}};
        data.images = {{"t", image, SamplerState{Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off}}};
        data.groups = {side * side / 64, 1, 1};
        const std::vector<float> e = values_of<float>(run_text(text, data).buffer("Out"));
        ASSERT_EQ(e.size(), c.image.rgba.size());
        double worst = 0;
        for (size_t i = 0; i < e.size(); ++i) {
            if (i % 4 == 3) continue;
            const double want = static_cast<double>(c.image.rgba[i]), off = std::fabs(static_cast<double>(e[i]) - want);
            worst = std::max(worst, off / (c.absolute + c.relative * want));
        }
        EXPECT_LE(worst, 1.0) << static_cast<int>(c.format);
    }
}

}  // namespace
}  // namespace kiln::test
