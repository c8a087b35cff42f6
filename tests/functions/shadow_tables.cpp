// moments.comp: tables and mips against sums in double; and filters that read them.

#include <random>

#include "tests/functions/shadow_images.h"
#include "uber/reference/vsm.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(ShadowTables, SumsAreExactWhereFloatsAre) {
    // Small integers over sides that are neither squares nor multiples of a piece of 256.
    for (const auto& [width, height] : {std::pair{300u, 7u}, {1u, 1u}, {5u, 513u}, {256u, 256u}}) {
        std::vector<float> pairs(size_t{width} * height * 2);
        for (size_t i = 0; i < pairs.size(); ++i) pairs[i] = static_cast<float>(i * 7919 % 64) - 20.0f;
        const std::vector<float> table = table_by_device(pairs, width, height);
        std::vector<double> sums(pairs.size());
        uint64_t wrong = 0;
        for (size_t y = 0; y < height; ++y)
            for (size_t x = 0; x < width; ++x)
                for (size_t c = 0; c < 2; ++c) {
                    const auto at = [c, line = width](size_t i, size_t j) { return (j * line + i) * 2 + c; };
                    sums[at(x, y)] = static_cast<double>(pairs[at(x, y)]) + (x > 0 ? sums[at(x - 1, y)] : 0) +
                                     (y > 0 ? sums[at(x, y - 1)] : 0) - (x > 0 && y > 0 ? sums[at(x - 1, y - 1)] : 0);
                    wrong += static_cast<double>(table[at(x, y)]) != sums[at(x, y)];
                }
        EXPECT_EQ(wrong, 0u) << width << " x " << height;
    }
}

TEST(ShadowTables, HalvesAreMeans) {
    for (const auto& [width, height] : {std::pair{8u, 8u}, {9u, 4u}, {1u, 6u}}) {
        std::vector<float> pairs(size_t{width} * height * 2);
        for (size_t i = 0; i < pairs.size(); ++i) pairs[i] = static_cast<float>(i * 31 % 16);
        const std::vector<float> half = half_by_device(pairs, width, height);
        const uint32_t w = std::max(width / 2, 1u), h = std::max(height / 2, 1u);
        for (uint32_t y = 0; y < h; ++y)
            for (uint32_t x = 0; x < w; ++x)
                for (uint32_t c = 0; c < 2; ++c) {
                    float sum = 0;
                    for (const uint32_t j : {2 * y, 2 * y + 1})
                        for (const uint32_t i : {2 * x, 2 * x + 1})
                            sum += pairs[(size_t{std::min(j, height - 1)} * width + std::min(i, width - 1)) * 2 + c];
                    EXPECT_EQ(half[(size_t{y} * w + x) * 2 + c], sum / 4);
                }
    }
}

constexpr int size = 256;
const LightView view{2, 16, 2};
constexpr double middle = 0.5;

std::string vssm(const char* bleeding) {
    return std::string(
               "vssm_factor(sat, vec4(p.xy, (16.0 / 14.0) * p.z - (32.0 / 14.0), p.z), 1.0, 2.0, 16.0, 2.0, 1.0 / 256.0, "
               "0.5, 1e-6, ") +
           bleeding + ")";
}

TEST(ShadowTables, VssmIsExactAlongAnEdge) {
    // Two depths, so Chebyshev's bound is equality and the blocker exact; what is left is the table's rounding. Sums of q over
    // 2^16 texels reach 2^14; each corner is off by some 2^-24 of it, 1e-3, shared by the box's texels; the bound's derivative by
    // the moments is at most 2 / step for a step of q.
    for (const double blocker : {4.0, 6.0}) {
        const ShadowScene scene = edge_scene(blocker);
        const MomentMap map = moment_map(distance_map(scene, view, size), size, view.far, middle);
        const std::vector<float> table = table_by_device(floats_of(map), size, size);
        const double w = edge_penumbra(scene.receiver, blocker, scene.light);
        std::vector<Texel> at;
        for (int i = 0; i <= 200; ++i) {
            const double x = (i / 200.0 - 0.5) * 1.5 * w;
            at.push_back({static_cast<float>(x), 0.3f, static_cast<float>(scene.receiver), 0});
        }
        const std::vector<Texel> lit =
            evaluate(uber_text("lib/vsm.glsl"), vssm("0.0"), at, {{"sampler2D sat", moments_image(table, size), nearest(false)}});
        const double texels = w / (view.extent * scene.receiver) * size, step = (scene.receiver - blocker) / view.far;
        // The least variance, and the table's error twice: in the blocker and in the share.
        const double allowed = 2 * (4 * 1e-3 / (texels * texels) * 2 / step) + 2e-6 / (step * step);
        ASSERT_LT(allowed, 0.05);
        for (size_t i = 0; i < at.size(); ++i)
            EXPECT_NEAR(static_cast<double>(lit[i][0]), square_light_edge(static_cast<double>(at[i][0]), w), allowed)
                << blocker << ' ' << i;
    }
}

TEST(ShadowTables, VssmBleedsUnderTwoBlockersAsPredicted) {
    const ShadowScene scene = stacked_scene();
    const MomentMap map = moment_map(distance_map(scene, view, size), size, view.far, middle);
    const std::vector<Sampled> table{
        {"sampler2D sat", moments_image(table_by_device(floats_of(map), size, size), size), nearest(false)}};
    const std::vector<Texel> at{{0.0f, 0.0f, 10.0f, 0.0f}};
    ASSERT_EQ(visible_share(scene, 0, 0), 0.0);
    // Half the box at 3 m, half at 9, the receiver at 10: 9 / (9 + 16).
    EXPECT_NEAR(static_cast<double>(evaluate(uber_text("lib/vsm.glsl"), vssm("0.0"), at, table)[0][0]), 0.36, 1e-3);
    EXPECT_EQ(evaluate(uber_text("lib/vsm.glsl"), vssm("0.4"), at, table)[0][0], 0.0f);
}

TEST(ShadowTables, MipsAverageAsTheTableDoes) {
    // At the centre of a texel of level k, a box 2^k texels wide is that texel.
    const MomentMap map = moment_map(distance_map(square_scene(6), view, size), size, view.far, middle);
    const std::vector<float> chain = mips_by_device(floats_of(map), size);
    constexpr uint32_t mips = 9;
    const SamplerState trilinear{Filter::linear, MipFilter::linear, Wrap::clamp, Comparison::off};
    for (uint32_t k = 0; k < mips; ++k) {
        const double width = static_cast<double>(1u << k) / size;
        std::vector<Texel> at;
        for (uint32_t i = 0; i < (static_cast<uint32_t>(size) >> k); ++i)
            at.push_back({static_cast<float>((i + 0.5) * width), static_cast<float>((((size >> k) / 2) + 0.5) * width),
                          static_cast<float>(width), 0});
        if (k == mips - 1) at = {{0.5f, 0.5f, 1.0f, 0.0f}};
        const std::vector<Texel> got =
            evaluate(uber_text("lib/vsm.glsl"), "mip_average(moments, p.xy, p.zz, " + std::to_string(mips) + ".0), 0.0, 0.0", at,
                     {{"sampler2D moments", moments_image(chain, size, mips), trilinear}});
        for (size_t i = 0; i < at.size(); ++i) {
            const Vec2<double> mean = map.average({static_cast<double>(at[i][0]), static_cast<double>(at[i][1])}, {width, width});
            EXPECT_NEAR(static_cast<double>(got[i][0]), mean.x, 1e-6) << k;
            EXPECT_NEAR(static_cast<double>(got[i][1]), mean.y, 1e-6) << k;
        }
    }
}

}  // namespace
}  // namespace kiln::test
