// Environment look-up through real textures: levels, edges, poles and seams; the split-sum table and the sampled truth.

#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>

#include "tests/bakes/shader.h"
#include "uber/reference/environment.h"
#include "uber/reference/ibl.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::test {
namespace {

using V = reference::Vec3<double>;
using Four = std::array<float, 4>;

// One result for each of `at`, from an expression over the vec4 p, the files of uber/lib and the texture t.
std::vector<Four> look(const std::vector<std::string>& files, const std::string& type, const std::string& expression,
                       const std::vector<Four>& at, const std::shared_ptr<ImageData>& image, SamplerState sampler) {
    std::string text = "#version 450\n";
    for (const std::string& file : files) text += uber_text("lib/" + file);
    text +=
        "layout(local_size_x = 64) in;\nlayout(set = 0, binding = 0) uniform " + type +
        " t;\nlayout(set = 0, binding = 1) readonly buffer In { vec4 at[]; };\n"
        "layout(set = 0, binding = 2) buffer Out { vec4 seen[]; };\n"
        "void main() { uint i = gl_GlobalInvocationID.x; if (i >= uint(at.length())) return; vec4 p = at[i]; seen[i] = vec4(" +
        expression + "); }\n";
    ComputeData data;
    data.buffers = {{"In", bytes_of(at)}, {"Out", Bytes(at.size() * sizeof(Four))}};
    data.images = {{"t", image, sampler}};
    data.groups = {static_cast<uint32_t>((at.size() + 63) / 64), 1, 1};
    std::vector<Four> out = values_of<Four>(run_text(text, data).buffer("Out"));
    EXPECT_EQ(out.size(), at.size());
    out.resize(at.size());
    return out;
}

const SamplerState smooth{Filter::linear, MipFilter::linear, Wrap::repeat, Comparison::off};

Four four(const V& d, double w = 0) {
    return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z), static_cast<float>(w)};
}

std::shared_ptr<ImageData> cube(uint32_t size, uint32_t mips, const std::function<float(const V&, uint32_t mip)>& value) {
    auto image = std::make_shared<ImageData>();
    image->format = TexelFormat::rgba32_float;
    image->dim = ImageDim::cube;
    image->layers = 6;
    image->mips = mips;
    image->width = image->height = size;
    std::vector<float> all;
    for (uint32_t mip = 0; mip < mips; ++mip) {
        const int side = static_cast<int>(size >> mip);
        for (int face = 0; face < 6; ++face) {
            for (int i = 0; i < side * side; ++i) {
                const auto p = reference::cube_texel_centre<double>(i % side, i / side, side);
                const float v = value(normalize(reference::cube_direction(face, p)), mip);
                all.insert(all.end(), {v, v, v, 1.0f});
            }
        }
    }
    image->texels = bytes_of(all);
    return image;
}

// Mip m holds m, so that what comes back is the level. Devices may round levels to 1/16 (mipmapPrecisionBits is 4 at least).
TEST(Environment, RoughnessChoosesTheLevel) {
    const auto image = cube(32, 6, [](const V&, uint32_t mip) { return static_cast<float>(mip); });
    std::vector<Four> at;
    for (const double r : {-1.0, 0.0, 0.1, 0.37, 0.5, 0.9, 1.0, 4.0}) {
        at.push_back(four(V{0.3, -0.2, 0.9}, r));
        at.push_back(four(V{0, 0, 0}, r));
        at.push_back(four(V{-1e8, 3e7, 2.0}, r));
    }
    const auto seen = look({"environment.glsl"}, "samplerCube", "sample_environment(t, p.xyz, p.w, 6.0), 1.0", at, image, smooth);
    for (size_t i = 0; i < at.size(); ++i) EXPECT_NEAR(seen[i][0], 5.0f * std::clamp(at[i][3], 0.0f, 1.0f), 1.0 / 16 + 1e-6) << i;
}

// Seamless cubes: two directions on either side of an edge, much nearer than a texel, read what is nearly the same. Face
// corners as well, where three texels meet.
TEST(Environment, FacesJoin) {
    const auto value = [](const V& d) { return d.x + 2.0 * d.y * d.z - d.z; };
    const auto image = cube(16, 1, [&](const V& d, uint32_t) { return static_cast<float>(value(d)); });
    std::vector<Four> at;
    for (int i = 0; i <= 20; ++i) {
        const double t = -1.0 + 0.1 * i;
        for (const double s : {-1.0, 1.0}) {
            for (const double off : {-1e-4, 1e-4}) {
                at.push_back(four(V{s, 1.0 + off, t}));
                at.push_back(four(V{s, t, 1.0 + off}));
                at.push_back(four(V{t, s, -1.0 + off}));
            }
        }
    }
    const auto seen = look({"environment.glsl"}, "samplerCube", "sample_environment(t, p.xyz, 0.0, 1.0), 1.0", at, image, smooth);
    for (size_t i = 0; i < at.size(); ++i) {
        const V d = normalize(V{at[i][0], at[i][1], at[i][2]});
        // A texel is at most 2 / 16 wide, and |gradient| of the value at most 4.
        EXPECT_NEAR(static_cast<double>(seen[i][0]), value(d), 4.0 * 2.0 / 16) << i;
    }
    for (size_t i = 0; i + 5 < at.size(); i += 6) {
        for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(seen[i + k][0], seen[i + k + 3][0], 4.0f * 2.0f / 16 * 0.01f) << i + k;
    }
}

// A picture 64 x 32 of a smooth sky, its sampler repeating both ways: right at the seam and at both poles too.
TEST(Environment, EquirectHasNeitherSeamNorPoles) {
    const auto value = [](const V& d) { return 1.0 + d.x + 2.0 * d.y; };
    std::vector<float> texels;
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) {
            const auto v =
                static_cast<float>(value(reference::equirect_direction(reference::Vec2<double>{(x + 0.5) / 64, (y + 0.5) / 32})));
            texels.insert(texels.end(), {v, v, v, 1.0f});
        }
    }
    auto image = std::make_shared<ImageData>();
    image->format = TexelFormat::rgba32_float;
    image->width = 64;
    image->height = 32;
    image->texels = bytes_of(texels);
    std::vector<Four> at = {four(V{0, 1, 0}), four(V{0, -1, 0}), four(V{0, 5, 0}), four(V{1e-9, -1, 1e-9})};
    for (int i = 0; i < 40; ++i) {
        const double polar = 0.02 + 3.1 * i / 40;
        for (const double azimuth : {3.14159, -3.14159, 3.0, 0.0, 1.2})
            at.push_back(four(V{std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)}));
    }
    const auto seen = look({"environment.glsl"}, "sampler2D", "sample_equirect(t, p.xyz, 0.0), 1.0", at, image, smooth);
    for (size_t i = 0; i < at.size(); ++i) {
        // Bilinear: h^2 / 8 times the second derivative (3) both ways; within half a row of a pole that row: half a row times
        // the slope (1 + 2 h).
        const double h = reference::pi / 32;
        EXPECT_NEAR(static_cast<double>(seen[i][0]), value(normalize(V{at[i][0], at[i][1], at[i][2]})),
                    2 * 3 * h * h / 8 + h / 2 * 1.3)
            << i;
    }
}

// Tables of 32^2 and 64^2 exact at their texels, read between them: what interpolation costs, over roughness 0.1 to 1 and n.v
// 0.05 to 1.
TEST(Environment, SplitSumTablesBetweenTexels) {
    const reference::TanhSinh quadrature(24);
    double before = 1;
    for (const int size : {32, 64}) {
        std::vector<float> texels;
        for (int i = 0; i < size * size; ++i) {
            const auto p = reference::split_sum_texel(i % size, i / size, size);
            const reference::SplitSum s = reference::split_sum(reference::SmithForm::height_correlated, std::max(p.x, 1e-4),
                                                               std::max(p.y, 0.045), quadrature);
            texels.insert(texels.end(), {static_cast<float>(s.a), static_cast<float>(s.b)});
        }
        auto image = std::make_shared<ImageData>();
        image->format = TexelFormat::rg32_float;
        image->width = image->height = static_cast<uint32_t>(size);
        image->texels = bytes_of(texels);
        std::vector<Four> at;
        std::vector<reference::SplitSum> truth;
        for (int i = 0; i < 40; ++i) {
            for (int j = 0; j < 40; ++j) {
                const double r = 0.1 + 0.9 * (i + 0.5) / 40, n_dot_v = 0.05 + 0.95 * (j + 0.5) / 40;
                at.push_back({static_cast<float>(n_dot_v), static_cast<float>(r), static_cast<float>(size), 0});
                truth.push_back(reference::split_sum(reference::SmithForm::height_correlated, n_dot_v, r, quadrature));
            }
        }
        SamplerState clamped = smooth;
        clamped.wrap = Wrap::clamp;
        const auto seen = look({"ibl.glsl"}, "sampler2D", "split_sum_lookup(t, p.x, p.y, p.z), 0.0, 1.0", at, image, clamped);
        double a = 0, b = 0;
        for (size_t i = 0; i < at.size(); ++i) {
            a = std::max(a, std::fabs(static_cast<double>(seen[i][0]) - truth[i].a));
            b = std::max(b, std::fabs(static_cast<double>(seen[i][1]) - truth[i].b));
        }
        std::printf("KILN_BAKE split_sum_lookup size=%d a=%.4g b=%.4g\n", size, a, b);
        EXPECT_LE(a, size == 32 ? 0.0136 : 0.0058);
        EXPECT_LE(b, size == 32 ? 0.0199 : 0.0077);
        EXPECT_LT(a, before);
        before = a;
    }
}

// The truth by samples in a furnace: F0 = 1 reflects A + B, F0 = 0.04 reflects 0.04 A + B, plain or with filtered levels.
TEST(Environment, SampledSpecularInAFurnace) {
    const auto image = cube(8, 4, [](const V&, uint32_t) { return 1.0f; });
    const reference::TanhSinh quadrature(40);
    for (const char* filtered : {"false", "true"}) {
        std::vector<Four> at;
        for (const double r : {0.25, 0.5, 1.0}) {
            for (const double n_dot_v : {0.25, 0.5, 1.0}) {
                at.push_back({static_cast<float>(n_dot_v), static_cast<float>(r), 1.0f, 0});
                at.push_back({static_cast<float>(n_dot_v), static_cast<float>(r), 0.04f, 0});
            }
        }
        const auto seen = look(
            {"ibl_bake.glsl"}, "samplerCube",
            std::string("environment_specular_sampled(t, vec3(0.6, 0.0, 0.8), mat3(vec3(0.8, 0.0, -0.6), vec3(0.0, 1.0, 0.0), "
                        "vec3(0.6, 0.0, 0.8)) * vec3(sqrt(1.0 - p.x * p.x), 0.0, p.x), vec3(p.z), p.y * p.y, 4096u, ") +
                filtered + "), 1.0",
            at, image, smooth);
        for (size_t i = 0; i < at.size(); ++i) {
            const auto s = reference::split_sum(reference::SmithForm::height_correlated, static_cast<double>(at[i][0]),
                                                static_cast<double>(at[i][1]), quadrature);
            EXPECT_NEAR(static_cast<double>(seen[i][0]), static_cast<double>(at[i][2]) * s.a + s.b, 0.003) << i;
        }
    }
}

}  // namespace
}  // namespace kiln::test
