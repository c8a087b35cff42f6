// The deferred passes against the renderer in double: each over the very g-buffer that the device drew, and all of them, over one
// in a renderer's formats, against the forward pass that they take apart.

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>

#include "tests/images/gbuffer.h"

namespace kiln::test {
namespace {

bool directional(const Values& values) {
    const auto light = values.find("light");
    return light != values.end() && light->second == "directional";
}

// The part of a picture that may be left out: as in surface.cpp, most where filters make many decisions.
double most_masked(const reference::SurfaceAxes& axes) {
    using reference::SurfaceShadow;
    // Depth's quantum moves places, and these read 32 of a table.
    if (axes.shadow == SurfaceShadow::vssm) return 0.7;
    return axes.shadow > SurfaceShadow::hard || axes.cascades > 1 || axes.reflection != reference::SurfaceReflection::none ? 0.2
                                                                                                                           : 0.15;
}

Expect expected(const Scene& s, const Gbuffer& g, const Values& pass, const Points& points) {
    return [&, pass](const Points::Point& p) {
        const auto c = deferred_expected(s, g, pass, static_cast<size_t>(&p - points.at.data()));
        return std::vector{c.x, c.y, c.z, Bounded(0)};
    };
}

const Values rough_walls = {{"material", "pbr_mr"}, {"normal_map", "true"}, {"lightmap", "sh_hq"}};
const Values props = {{"material", "pbr_sg"}, {"normal_map", "true"}, {"two_sided", "true"}};
const Values far_away = {{"material", "blinn_phong"}, {"lightmap", "flat"}};

TEST(Deferred, EveryVariantOverADrawnGbuffer) {
    const std::vector<Values> passes = pairwise("renderer.yaml", "deferred", 7);
    EXPECT_GE(passes.size(), 20u);
    std::map<std::pair<bool, size_t>, Gbuffer> drawn;
    const Values* const objects[] = {&rough_walls, &props, &far_away};
    size_t pixels = 0, next = 0;
    double worst = 0, masked = 0;
    for (const Values& pass : passes) {
        const Scene& s = scene(directional(pass), false);
        const size_t object = next++ % std::size(objects);
        Gbuffer& g = drawn[{directional(pass), object}];
        if (g.size == 0) g = drawn_gbuffer(s, *objects[object]);
        const RunOutput run = deferred_pass(s, g, pass);
        const ReadBack* got = output(run, "output 0");
        ASSERT_NE(got, nullptr);
        const Points points = pixels_of(g);
        const Judged j = judge(points, expected(s, g, pass, points), *got);
        std::string name;
        for (const auto& [axis, value] : pass) name += axis + "=" + value + " ";
        EXPECT_EQ(j.wrong, 0u) << name << ": " << j.example;
        EXPECT_LT(j.masked_share(), most_masked(axes_of(pass))) << name << j.close << " close decisions, " << j.loose << " loose";
        EXPECT_GT(j.compared, 4000u) << name;
        pixels += j.compared, worst = std::max(worst, j.worst), masked = std::max(masked, j.masked_share());
    }
    std::printf("KILN_IMAGES deferred: %zu pictures, %zu pixels, worst error %.3g of the allowed; masked at most %.2f %%\n",
                passes.size(), pixels, worst, 100 * masked);
}

// What passes add up to, with the emission that they are added to, is the forward pass's radiance: off by what the g-buffer's
// formats have rounded away, half a step of each channel passed on through the reference, and by rounding.
TEST(Deferred, AddsUpToTheForwardPass) {
    struct Case {
        const char* what;
        Values object, view;         // of both; view: of the forward pass, beside
        std::vector<Values> passes;  // of deferred
    };
    const Values sun_pcf7 = {{"light", "directional"}, {"shadow", "pcf7"}, {"cascades", "4"}};
    const Values sun_pcf3 = {{"light", "directional"}, {"shadow", "pcf3"}};
    const Values sky = {{"ibl", "split_sum"}}, mirrored = {{"ibl", "split_sum"}, {"reflection", "box"}}, none;
    const auto both = [](Values a, const Values& b) {
        a.insert(b.begin(), b.end());
        return a;
    };
    const Values walls = {{"material", "pbr_mr"}, {"normal_map", "true"}, {"lightmap", "sh_hq"}};
    const Values moving = {{"material", "pbr_sg"}, {"normal_map", "true"}, {"probes", "sh_l1"}};
    const Values open = {{"material", "pbr_mr"}, {"normal_map", "true"}};
    const Case cases[] = {
        {"baked, sky", walls, sky, {sky}},
        {"baked, sky, a room's reflection, sun", walls, both(mirrored, sun_pcf7), {mirrored, sun_pcf7}},
        {"probes, sky", moving, sky, {sky}},
        {"sky alone", open, sky, {sky}},
        {"ambient light, sun by a normal map", open, sun_pcf3, {none, sun_pcf3}},
        {"flat lightmap, Blinn-Phong, sun", far_away, sun_pcf3, {none, sun_pcf3}},
    };
    for (const Case& c : cases) {
        const bool sun = directional(c.view);
        const Scene& s = scene(sun, false);
        const Values forward = both(both(c.object, c.view), {{"pass", "forward"}});
        const Gbuffer g = quantised(drawn_gbuffer(s, c.object));
        ReadBack sum;
        for (const Values& pass : c.passes) {
            const RunOutput run = deferred_pass(s, g, pass);
            const ReadBack* got = output(run, "output 0");
            ASSERT_NE(got, nullptr);
            if (sum.words.empty()) {
                sum = *got;
                for (size_t i = 0; i < sum.words.size(); ++i)
                    sum.words[i] = std::bit_cast<uint32_t>(as_float(sum.words[i]) + g.targets[4][i]);
            } else {
                for (size_t i = 0; i < sum.words.size(); ++i)
                    sum.words[i] = std::bit_cast<uint32_t>(as_float(sum.words[i]) + as_float(got->words[i]));
            }
        }
        const Variant v = variant_of("renderer.yaml", "surface", forward);
        const Points points = drawn_points(v.stages.front(), inputs_of(s), visible_points(s));
        const reference::SurfaceAxes axes = axes_of(forward);
        const Expect expect = [&](const Points::Point& p) {
            const size_t pixel = static_cast<size_t>(&p - points.at.data());
            reference::Vec3<Bounded> radiance = reference::surface_radiance(axes, s.blocks, s.maps, p.in, p.front);
            for (const Values& pass : c.passes) {
                const V3 steps = deferred_steps(s, g, pass, pixel);
                const auto rounding = deferred_expected(s, g, pass, pixel);
                radiance.x.error += rounding.x.error + steps.x / reference::reassociation_margin;
                radiance.y.error += rounding.y.error + steps.y / reference::reassociation_margin;
                radiance.z.error += rounding.z.error + steps.z / reference::reassociation_margin;
            }
            // Emission in half floats; half as much again as the first order, for the second.
            for (Bounded* const x : {&radiance.x, &radiance.y, &radiance.z})
                x->error = 1.5 * x->error + 0x1p-11 * 0.03 / reference::reassociation_margin;
            return std::vector{radiance.x, radiance.y, radiance.z, Bounded(1)};
        };
        const Judged j = judge(points, expect, sum);
        EXPECT_EQ(j.wrong, 0u) << c.what << ": " << j.example;
        EXPECT_LT(j.masked_share(), 0.25) << c.what << ": " << j.silhouettes << " silhouettes, " << j.close
                                          << " close decisions, " << j.loose << " loose bounds";
        std::printf(
            "KILN_IMAGES deferred as forward, %s: %zu pixels, worst error %.3g of the allowed, %.3g relative RMS; masked "
            "%.2f %%\n",
            c.what, j.compared, j.worst, j.relative, 100 * j.masked_share());
    }
}

TEST(Deferred, WrongPassesAreCaught) {
    struct Wrong {
        const char* what;
        Edits edits;
        Values object, pass;
    };
    const Values sun = {{"light", "directional"}, {"shadow", "pcf3"}}, sky = {{"ibl", "split_sum"}};
    const Wrong all[] = {
        {"a receiver's plane by the normal map", {{"p.position, p.geometric_n, l", "p.position, p.n, l"}}, props, sun},
        {"a base that baked light reaches past the coat",
         {{"p.baked ? p.irradiance_over_pi * pi :", "p.baked ? vec3(0.0) :"},
          {"p.drawn ? added", "p.drawn ? added + p.diffuse * p.irradiance_over_pi"}},
         rough_walls,
         sky},
        {"a sky over what is baked",
         {{"p.baked ? p.irradiance_over_pi * pi :", "p.baked ? sky_irradiance(p.n) :"}},
         rough_walls,
         sky},
        {"places half a pixel to the side",
         {{"world_of_clip, screen_uv", "world_of_clip, screen_uv + 1.0 / 256.0"}},
         props,
         {{"light", "spot"}, {"shadow", "hard"}}},
        {"one model for all", {{"p.ggx ? glossy : shiny", "glossy"}}, far_away, sun},
    };
    for (const Wrong& w : all) {
        const Scene& s = scene(directional(w.pass), false);
        const Gbuffer g = drawn_gbuffer(s, w.object);
        const Points points = pixels_of(g);
        const RunOutput run = deferred_pass(s, g, w.pass, w.edits);
        const ReadBack* got = output(run, "output 0");
        ASSERT_NE(got, nullptr);
        const Judged j = judge(points, expected(s, g, w.pass, points), *got);
        EXPECT_GT(j.wrong, 100u) << w.what;
        std::printf("KILN_IMAGES %s: %zu of %zu pixels wrong\n", w.what, j.wrong, j.compared);
    }
}

}  // namespace
}  // namespace kiln::test
