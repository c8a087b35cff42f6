// Shadows whose shape is known in closed form, drawn by whole variants: the penumbra of a straight edge, and occluders above
// each other.

#include <cmath>
#include <cstdio>

#include "tests/device/glsl.h"
#include "tests/images/closed_form.h"

namespace kiln::test {
namespace {

using namespace reference;

// ---- a square lamp over a floor ----

constexpr double lamp_near = 2, lamp_far = 12;
constexpr int map_side = 256;
constexpr double texel = lamp_height / map_side;  // metres, on the floor

MomentMips mips_of(std::vector<float> level, int side) {
    std::vector<Texture2D> levels;
    for (; side >= 1; side /= 2) {
        levels.emplace_back(side, side, level, true, TextureWrap::clamp);
        std::vector<float> next;
        const size_t n = static_cast<size_t>(side);
        for (size_t y = 0; y + 1 < n; y += 2)
            for (size_t x = 0; x + 1 < n; x += 2)
                for (size_t c = 0; c < 4; ++c) {
                    const auto at = [&](size_t dx, size_t dy) { return level[((y + dy) * n + x + dx) * 4 + c]; };
                    next.push_back(0.25f * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)));
                }
        level = std::move(next);
    }
    return MomentMips(std::move(levels));
}

// Occluders in the lamp's coordinates: x, and y for z; distance from it. Edges at x = 0 lie between two texels.
Scene lamp_scene(const std::vector<Occluder>& occluders) {
    Scene s = scene(false, true);
    const Triangles world = set_floor(s, occluders, {0.1, 2.2, 0.4});
    SurfaceBlocks& b = s.blocks;
    b.light_position = {0, lamp_height, 0};
    b.light_range = 100;
    b.light_cos_inner = 0.5;
    b.light_cos_outer = 0.25;
    b.shadow_view_projection =
        f32(perspective(std::atan(0.5), lamp_near, lamp_far) * look_at(b.light_position, {0, 0, 0}, {0, 0, -1}));
    b.shadow_plane_of_world = f32(transpose(inverse(b.shadow_view_projection)));
    b.shadow_near = lamp_near;
    b.shadow_far = b.moments_far = lamp_far;
    b.shadow_extent = 1;
    b.shadow_texel_uv = 1.0 / map_side;
    b.shadow_filter = f32(0.06);
    b.light_size = 1;
    b.moments_reference = 0.5;
    b.moments_least = f32(1e-9);
    b.moments_bleeding = 0;
    b.moments_levels = 7;
    s.maps.shadow_map = std::make_shared<DepthMap>(map_side, map_side, depths_of(world, b.shadow_view_projection, map_side));
    const std::vector<float> depths = depths_of(world, b.shadow_view_projection, moments_size);
    std::vector<float> moments, sums;
    std::vector<V2> above(moments_size);
    for (size_t y = 0; y < moments_size; ++y) {
        V2 row;
        for (size_t x = 0; x < moments_size; ++x) {
            const double z = light_distance(static_cast<double>(depths[y * moments_size + x]), lamp_near, lamp_far);
            const V2 m = shadow_moments(z, lamp_far, b.moments_reference);
            moments.insert(moments.end(), {static_cast<float>(m.x), static_cast<float>(m.y), 0, 1});
            row = row + m;
            above[x] = above[x] + row;
            sums.insert(sums.end(), {static_cast<float>(above[x].x), static_cast<float>(above[x].y), 0, 1});
        }
    }
    s.maps.moment_mips = mips_of(moments, moments_size);
    s.maps.moment_sums = {moments_size, moments_size, sums, false, TextureWrap::clamp};
    return s;
}

const Values spot = {{"light", "spot"}, {"material", "pbr_mr"}};
// ---- the penumbra of a straight edge ----

struct Filter1D {
    std::string shadow;
    int taps = 1;      // a side
    double width = 0;  // of the ramp that it stands for, metres
};

struct EdgeErrors {
    double taps = 0, ramp = 0;  // worst error over what is allowed
    size_t wrong = 0;           // pixels beyond either
    double width = 0;           // measured: six times the integral of V (1 - V), which is a ramp's width
};

EdgeErrors edge_errors(const Scene& s, const Filter1D& f, const Edits& edits = {}) {
    EdgeErrors out;
    std::vector<std::pair<double, double>> profile;
    // A staircase of n levels is within half a level of the ramp; rounding its corners off by a texel costs an eighth of one.
    const double half_a_level = 0.5 / f.taps + texel / (8 * std::max(f.width, texel)) + 1e-4;
    for (const Seen& at : visibility(s, with(spot, "shadow", f.shadow), edits)) {
        EXPECT_TRUE(at.visible >= 0 && at.visible <= 1 + 1e-5) << at.visible;
        const double taps =
            std::fabs(at.visible - taps_along_an_edge(at.place.x, f.width, f.taps, texel)) / taps_allowed(f.width, f.taps, texel);
        const double ramp = f.width == 0 ? 0 : std::fabs(at.visible - square_light_edge(at.place.x, f.width)) / half_a_level;
        out.taps = std::max(out.taps, taps);
        out.ramp = std::max(out.ramp, ramp);
        out.wrong += taps > 1 || ramp > 1 ? 1 : 0;
        profile.emplace_back(at.place.x, at.visible * (1 - at.visible));
    }
    std::sort(profile.begin(), profile.end());
    for (size_t i = 1; i < profile.size(); ++i)
        out.width += 3 * (profile[i].first - profile[i - 1].first) * (profile[i].second + profile[i - 1].second);
    return out;
}

// An edge along z stops what is left of it. Under a square lamp the floor sees a linear ramp of width size (dR - dB) / dB, and
// so does PCSS; PCF's ramp is as wide as its box, whatever the edge's height.
TEST(ClosedForm, PenumbraOfAStraightEdge) {
    for (const double blocker : {6.0, 7.5}) {
        const Scene s = lamp_scene({{{-20, 0, -20, 20}, blocker}});
        const double w = edge_penumbra(lamp_height, blocker, 1), box = s.blocks.shadow_filter * lamp_height;
        for (const Filter1D& f :
             {Filter1D{"hard", 1, 0}, {"pcf3", 3, box}, {"pcf5", 5, box}, {"pcf7", 7, box}, {"pcss", 32, w}}) {
            const EdgeErrors e = edge_errors(s, f);
            EXPECT_LE(e.taps, 1) << f.shadow << ' ' << blocker;
            EXPECT_LE(e.ramp, 1) << f.shadow << ' ' << blocker;
            // Of n steps a level high, six times the integral is (1 - 1 / n^2) w; of each texel-wide riser texel / n at most.
            EXPECT_NEAR(e.width, f.width, f.width / (f.taps * f.taps) + texel) << f.shadow << ' ' << blocker;
            std::printf(
                "KILN_IMAGES edge at %.1f m, %s: %.2f of what taps allow, %.2f of what the ramp does; %.3f m wide, %.3f m by the "
                "closed form\n",
                blocker, f.shadow.c_str(), e.taps, e.ramp, e.width, f.width);
        }
    }
}

TEST(ClosedForm, WrongPenumbrasAreCaught) {
    const Scene s = lamp_scene({{{-20, 0, -20, 20}, 6}});
    const Filter1D pcf{"pcf5", 5, s.blocks.shadow_filter * lamp_height}, pcss{"pcss", 32, edge_penumbra(lamp_height, 6, 1)};
    const struct {
        const char *what, *from, *to;
        Filter1D filter;
    } all[] = {
        {"a penumbra over the receiver's distance", "/ max(blocker, 1e-6)", "/ max(receiver, 1e-6)", pcss},
        {"a blocker's depth for its distance", "sum += map_distance(depth, near, far)", "sum += depth * far", pcss},
        {"a mean over blockers and all others", "sum / blockers", "sum / float(PCSS_BLOCKER_TAPS)", pcss},
        {"the penumbra's width at 1 m", "vec2(width * uv_of_metre)", "vec2(width / extent)", pcss},
        {"taps on the box's corners", "(vec2(x, y) + 0.5) / float(n)", "vec2(x, y) / float(n - 1)", pcf},
        {"a box of half its width", "/ float(n) - 0.5) * width", "/ float(n) - 0.5) * 0.5 * width", pcf},
        {"taps about a corner of the receiver's texel", "vec3(place.xy + offset,", "vec3(place.xy + 0.001 + offset,", pcf},
    };
    for (const auto& w : all) {
        const EdgeErrors e = edge_errors(s, w.filter, {{w.from, w.to}});
        EXPECT_GT(e.wrong, 100u) << w.what;
        std::printf("KILN_IMAGES %s: %zu pixels wrong, ramp %.3f m wide for %.3f\n", w.what, e.wrong, e.width, w.filter.width);
    }
}

// ---- a floor that faces its lamp, where the map does not ----

// Nothing stands over the floor, and the lamp is straight above; its map is 45 degrees off, so that the floor's depth rises over
// it. A bias of two quanta, texels of 8 cm.
TEST(ClosedForm, FloorUnderAMapThatLeans) {
    Scene s = lamp_scene({});
    SurfaceBlocks& b = s.blocks;
    b.light_direction = f32(normalize(V3{0.7, -0.7, 0.1}));
    b.light_cos_outer = -0.5;
    b.shadow_view_projection = f32(perspective(std::atan(1.0), lamp_near, lamp_far) *
                                   look_at(b.light_position, b.light_position + b.light_direction, {0, 0, -1}));
    b.shadow_texel = f32(2.0 / map_side);
    b.shadow_depth_bias = 2 * 0x1p-23;
    Triangles world;
    for (size_t i = 0; i < s.mesh.vertices.size(); i += 3)
        world.push_back({s.mesh.vertices[i].position, s.mesh.vertices[i + 1].position, s.mesh.vertices[i + 2].position});
    s.maps.shadow_map = std::make_shared<DepthMap>(map_side, map_side, depths_of(world, b.shadow_view_projection, map_side));
    const auto shadowed = [&](const Edits& edits) {
        size_t count = 0;
        for (const Seen& at : visibility(s, with(spot, "shadow", "hard"), edits)) count += at.visible < 1 - 1e-5 ? 1 : 0;
        return count;
    };
    EXPECT_EQ(shadowed({}), 0u);
    const size_t wrong = shadowed({{"= perspective_axis_cosine(shadow_view_projection, n)", "= dot(n, l)"}});
    EXPECT_GT(wrong, 1000u);
    std::printf("KILN_IMAGES a floor under a leaning map, offset by the sine to the light: %zu pixels shadowed\n", wrong);
}

// ---- occluders above each other ----

// Two depths d1 < d2 before a receiver at t: whatever share of each a filter takes, Cantelli's bound is at most this.
double most_bleeding(double d1, double d2, double t) {
    return (d2 - d1) * (d2 - d1) / ((d2 - d1) * (d2 - d1) + 4 * (t - d1) * (t - d2));
}

double brightest(const Scene& s, const char* shadow, const Edits& edits = {}) {
    double most = 0;
    for (const Seen& at : visibility(s, with(spot, "shadow", shadow), edits)) most = std::max(most, at.visible);
    return most;
}

// An edge, and far below it what stops all the light that passes: nothing is lit. Taps say so. Moments of two depths bleed where
// a filter holds both, up to Cantelli's bound and no further, and not at all where that much is cut off.
TEST(ClosedForm, StackedOccluders) {
    Scene s = lamp_scene(stacked_scene().occluders);
    for (const char* shadow : {"hard", "pcf3", "pcf5", "pcf7", "pcss"}) EXPECT_LE(brightest(s, shadow), 1e-6) << shadow;
    const double bound = most_bleeding(3, 9, lamp_height);
    ASSERT_NEAR(bound, 0.5625, 1e-12);
    const auto average = [&](const V2& centre, const V2& width) {
        return sat_average([&](int x, int y) { return s.maps.moments_sum<double>(x, y); }, moments_size, centre, width);
    };
    // Sums of 64^2 second moments of 1/16 reach 256; eight roundings of them are 2^-24 x 2048 = 1.2e-4 of a box of one texel. The
    // bound is steepest where all is at 9 m, 1 / (t - d2)^2 = 144 a unit of variance: 0.02. Where it is largest its slope is 9:
    // 1e-3.
    for (const double cut : {0.0, 0.2, bound}) {
        s.blocks.moments_bleeding = f32(cut);
        const double most = (bound - cut) / (1 - cut);
        for (const Seen& at : visibility(s, with(spot, "shadow", "vssm"))) {
            const V4 clip = s.blocks.shadow_view_projection * V4{at.place.x, at.place.y, at.place.z, 1};
            const double said = vssm_factor(average, clip, 1.0, lamp_near, lamp_far, 1.0, s.blocks.shadow_texel_uv, 0.5,
                                            s.blocks.moments_least, s.blocks.moments_bleeding);
            EXPECT_NEAR(at.visible, said, 0.02) << at.place.x;
            EXPECT_LE(at.visible, most + 1e-3);
        }
        const double vsm = brightest(s, "vsm"), vssm = brightest(s, "vssm");
        EXPECT_LE(vsm, most + 1e-4);
        EXPECT_GE(vsm, most - 0.02) << "no pixel sees an eighth of the upper occluder";
        EXPECT_GE(vssm, most - 0.02);
        std::printf("KILN_IMAGES stacked occluders, %.2f cut off: vsm bleeds %.4f, vssm %.4f, at most %.4f\n", cut, vsm, vssm,
                    most);
    }
    s.blocks.moments_bleeding = 0;
    EXPECT_GT(brightest(s, "vsm", {{"(variance + beyond * beyond)", "(variance + 0.5 * beyond * beyond)"}}), bound + 0.05);
    EXPECT_GT(brightest(s, "vssm", {{"max(moments.y - moments.x * moments.x, least)", "max(moments.y, least)"}}), bound + 0.05);
}

}  // namespace
}  // namespace kiln::test
