// The seams of cascaded shadow maps in closed form, drawn by whole variants.

#include <cmath>
#include <cstdio>

#include "tests/device/glsl.h"
#include "tests/images/closed_form.h"
#include "uber/reference/cascades.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr int layer_side = 128;

const Values sun = {{"light", "directional"}, {"material", "blinn_phong"}, {"two_sided", "true"}};
Values in_cascades(const std::string& shadow, int count) {
    return with(with(sun, "shadow", shadow), "cascades", std::to_string(count));
}

CascadeChoice<double> choice_at(const SurfaceBlocks& b, const V3& place, int count) {
    const double depth = (b.view_projection * V4{place.x, place.y, place.z, 1}).w;
    return choose_cascade(depth, b.cascade_start, b.cascade_ends, count, b.cascade_band);
}

// One layer shadows everything and the others nothing: what is missing of the light is that layer's weight. Weights are those of
// the slices, and their sum is 1 on either side of a seam, with a band between slices and without.
TEST(ClosedForm, WeightsOfCascades) {
    const struct {
        const char* shadow;
        int count;
        double band;
    } kinds[] = {{"hard", 2, 0.2}, {"pcf7", 3, 0.0}, {"pcf7", 4, 0.2}};
    for (const auto& [shadow, count, band] : kinds) {
        std::vector<std::vector<Seen>> layers;
        Scene s = scene(true, true);
        s.blocks.ambient_irradiance = s.blocks.emissive = {0, 0, 0};
        s.blocks.cascade_band = f32(band);
        for (int dark = 0; dark < count; ++dark) {
            s.maps.cascade_maps.clear();
            for (int i = 0; i < 4; ++i)
                s.maps.cascade_maps.emplace_back(layer_side, layer_side,
                                                 std::vector<float>(layer_side * layer_side, i == dark ? 0.0f : 1.0f));
            layers.push_back(visibility(s, in_cascades(shadow, count)));
        }
        size_t blended = 0, whole = 0;
        for (size_t i = 0; i < layers.front().size(); ++i) {
            const V3& at = layers.front()[i].place;
            if (at.y > 0.03) continue;  // the floor alone: a surface edge on to the lamp has a bias as deep as the map
            const CascadeChoice<double> choice = choice_at(s.blocks, at, count);
            double sum = 0;
            for (int k = 0; k < count; ++k) {
                const double weight = 1 - layers[static_cast<size_t>(k)][i].visible;
                const double expected = k == choice.index                       ? 1 - choice.blend
                                        : k == choice.next && choice.index >= 0 ? choice.blend
                                                                                : 0;
                // Depth is off by some ulp of 14 m, a band at least 0.2 of 1.2 m wide.
                EXPECT_NEAR(weight, expected, 14 * 0x1p-20 / 0.24 + 1e-5) << shadow << ' ' << k << " band " << band;
                sum += weight;
            }
            const bool fades = choice.index < 0 || (choice.next < 0 && choice.blend > 0);
            EXPECT_TRUE(fades || std::fabs(sum - 1) < 1e-4) << sum;
            ++(choice.blend > 0 ? blended : whole);
        }
        EXPECT_TRUE(band > 0 ? blended > 300 : blended == 0) << blended;
        EXPECT_GT(whole, 1000u);
    }
}

// Layers of doubling width over the floor, an edge at x = 0 between two texels of each: the filter's ramp is twice as wide beyond
// a seam as before it.
constexpr double layer_extent[4] = {4, 8, 16, 32}, filter_texels = 8;

Scene cascade_scene(double band) {
    Scene s = scene(true, true);
    const Triangles world = set_floor(s, {{{-20, 0, -20, 20}, 5}}, {0, 1.5, 3});
    SurfaceBlocks& b = s.blocks;
    s.maps.cascade_maps.clear();
    for (size_t i = 0; i < 4; ++i) {
        const M4 m = f32(orthographic(layer_extent[i] / 2, 0, 16) * look_at({0, lamp_height, 0}, {0, 0, 0}, {0, 0, -1}));
        b.cascade_view_projection[i] = m;
        b.cascade_plane_of_world[i] = f32(transpose(inverse(m)));
        s.maps.cascade_maps.emplace_back(layer_side, layer_side, depths_of(world, m, layer_side));
    }
    constexpr double width = filter_texels / layer_side;
    b.cascade_filter = {width, width, width, width};
    b.cascade_texel_uv = 1.0 / layer_side;
    b.cascade_start = 2.5;
    b.cascade_ends = {f32(3.2), f32(3.6), 4.5, 20};
    b.cascade_band = f32(band);
    return s;
}

double cascaded_edge(const SurfaceBlocks& b, const V3& at, int count, int taps) {
    const CascadeChoice<double> c = choice_at(b, at, count);
    const auto layer = [&](int i) {
        if (i < 0) return 1.0;
        const double side = layer_extent[i] / layer_side;
        return taps_along_an_edge(at.x, filter_texels * side, taps, side);
    };
    return layer(c.index) * (1 - c.blend) + layer(c.next) * c.blend;
}

// Along the edge the filter's ramp widens at a seam. Without a band that is a step, of 1/4 where the one ramp ends and the other
// is half way; with a band there is none.
TEST(ClosedForm, SeamsOfCascades) {
    double row = 0;  // depth between a pixel and the one below
    const auto steps = [&row](double band, const Edits& edits, size_t* wrong) {
        const Scene s = cascade_scene(band);
        constexpr int count = 3, taps = 7;
        std::vector<Seen> seen = visibility(s, in_cascades("pcf7", count), edits);
        std::map<size_t, const Seen*> at;
        for (const Seen& p : seen) at[p.pixel] = &p;
        // Into light beyond the last slice: a step or a slope of its own.
        const auto fades = [&](const Seen& p) {
            const CascadeChoice<double> c = choice_at(s.blocks, p.place, count);
            return c.index < 0 || (c.next < 0 && c.blend > 0);
        };
        double most = 0;
        for (const Seen& p : seen) {
            // A filter is 7 taps on eight texels: two at most on their ramps. Depth is off by some ulp of 4 m.
            const double allowed = 2 * texel_step / taps + 1e-4 + (band > 0 ? 4 * 0x1p-20 / (band * 0.4) : 0);
            const double said = cascaded_edge(s.blocks, p.place, count, taps);
            *wrong += std::fabs(p.visible - said) > allowed ? 1 : 0;
            EXPECT_TRUE(!edits.empty() || std::fabs(p.visible - said) <= allowed) << p.place.x << ' ' << p.visible << ' ' << said;
            const auto below = at.find(p.pixel + picture_size);
            if (below == at.end() || fades(p) || fades(*below->second)) continue;
            const auto depth = [&](const Seen& q) {
                return (s.blocks.view_projection * V4{q.place.x, q.place.y, q.place.z, 1}).w;
            };
            row = std::max(row, depth(p) - depth(*below->second));
            // From a pixel to the one below, of what changes with the slice alone: the same x.
            V3 moved = below->second->place;
            moved.x = p.place.x;
            const double along = std::fabs(cascaded_edge(s.blocks, moved, count, taps) -
                                           cascaded_edge(s.blocks, below->second->place, count, taps));
            most = std::max(most, std::fabs(p.visible - below->second->visible) - along);
        }
        return most;
    };
    size_t wrong = 0;
    const double sharp = steps(0, {}, &wrong), smooth = steps(0.5, {}, &wrong);
    EXPECT_EQ(wrong, 0u);
    EXPECT_NEAR(sharp, 0.25, 1.0 / 14);  // of staircases: half a level
    // The band is half of the first slice of 0.7 m and of the second of 0.4 m.
    EXPECT_LE(smooth, (0.25 + 1.0 / 14) * row / 0.2);
    std::printf("KILN_IMAGES seams of cascades: a step of %.3f without a band, %.4f with one\n", sharp, smooth);
    const struct {
        const char *what, *from, *to;
    } all[] = {{"a band after the seam", "(end - width)) / max", "end) / max"},
               {"the next layer's filter in this one", "width.y, texel, quantum, taps)", "width.y * 2.0, texel, quantum, taps)"},
               {"weights the wrong way round", "mix(lit, beyond, choice.blend)", "mix(beyond, lit, choice.blend)"}};
    for (const auto& w : all) {
        size_t off = 0;
        const double step = steps(0.5, {{w.from, w.to}}, &off);
        EXPECT_GT(off, 100u) << w.what;
        std::printf("KILN_IMAGES %s: %zu pixels wrong, a step of %.3f\n", w.what, off, step);
    }
}

}  // namespace
}  // namespace kiln::test
