// A white furnace of radiance 1 around whole variants with image-based light, drawn forward and by way of a g-buffer: what
// absorbs nothing cannot be told from it.

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/images/gbuffer.h"

namespace kiln::test {
namespace {

void make_furnace(Scene& s) {
    const double e = f32(4 * reference::pi);
    for (V3& c : s.blocks.sky_sh) c = {0, 0, 0};
    s.blocks.sky_sh[0] = f32(reference::splat3(2 * std::sqrt(reference::pi)));
    for (int i = 0; i < 576; ++i) s.blocks.probe_sh[i] = i % 9 == 0 ? V3{e, e, e} : V3{0, 0, 0};  // moments
    s.maps.lightmap_l0 = plain(1);
    s.maps.lightmap_l1_y = s.maps.lightmap_l1_z = s.maps.lightmap_l1_x = plain(0.5);
    s.blocks.lightmap_range = e;
    s.maps.environment_maps = {2, 2, 1, std::vector<float>(size_t{4} * 6 * (4 + 1), 1.0f), true};
    s.blocks.environment_levels = 2;
}

struct Range {
    double least = 1e9, most = 0;
    size_t pixels = 0;
};

Range drawn_range(const RunOutput& run, const std::vector<float>& depth, size_t channels = 3) {
    Range out;
    const ReadBack* got = output(run, "output 0");
    EXPECT_NE(got, nullptr);
    for (size_t i = 0; got != nullptr && i < depth.size(); ++i) {
        if (depth[i] == 1) continue;
        ++out.pixels;
        for (size_t c = 0; c < channels; ++c) {
            const double v = static_cast<double>(as_float(got->words[4 * i + c]));
            out.least = std::min(out.least, v), out.most = std::max(out.most, v);
        }
    }
    return out;
}

TEST(Furnace, ImageBasedLightForwardAndDeferred) {
    // Products and quotients of numbers near 1: some thirty roundings.
    constexpr double allowed = 32 * 0x1p-23;
    const Values sky = {{"ibl", "split_sum"}};
    for (const auto& [axis, from] : {std::pair{"lightmap", "none"}, {"lightmap", "sh_hq"}, {"probes", "sh_l1"}})
        for (const double metallic : {0.0, 1.0})
            for (const double roughness : {0.1, 0.5, 1.0}) {
                Scene s = scene(false, true);
                make_white(s, 1, 0, roughness, metallic);
                s.blocks.dielectric_specular = 0.5;
                make_furnace(s);
                const Values object = {{"material", "pbr_mr"}, {axis, from}};
                Values forward = object;
                forward.insert({{"pass", "forward"}, {"ibl", "split_sum"}});
                const Gbuffer g = quantised(drawn_gbuffer(s, object));
                const RunOutput direct = draw(variant_of("renderer.yaml", "surface", forward).stages, {inputs_of(s)}).front();
                const RunOutput deferred = deferred_pass(s, g, sky);
                for (const auto& [way, run] : {std::pair{"forward", &direct}, {"deferred", &deferred}}) {
                    const Range seen = drawn_range(*run, g.depth);
                    EXPECT_NEAR(seen.least, 1, allowed)
                        << way << ' ' << axis << ' ' << from << ' ' << metallic << ' ' << roughness;
                    EXPECT_NEAR(seen.most, 1, allowed)
                        << way << ' ' << axis << ' ' << from << ' ' << metallic << ' ' << roughness;
                    EXPECT_GT(seen.pixels, 5000u);
                }
            }
}

// The furnace tells a base that is lit as if no coat lay over it: up to 1.7 of what arrives.
TEST(Furnace, TellsABaseWithoutItsCoat) {
    Scene s = scene(false, true);
    make_white(s, 1, 0, 0.1, 0);
    make_furnace(s);
    const Gbuffer g = drawn_gbuffer(s, {{"material", "pbr_mr"}, {"lightmap", "sh_hq"}});
    const Range seen = drawn_range(deferred_pass(s, g, {{"ibl", "split_sum"}},
                                                 {{"p.baked ? p.irradiance_over_pi * pi :", "p.baked ? vec3(0.0) :"},
                                                  {"p.drawn ? added", "p.drawn ? added + p.diffuse * p.irradiance_over_pi"}}),
                                   g.depth);
    EXPECT_GT(seen.most, 1.2);
    std::printf("KILN_IMAGES furnace, base without its coat: %.3f to %.3f\n", seen.least, seen.most);
}

}  // namespace
}  // namespace kiln::test
