// The shadow passes from vertices to look-up: what is drawn is what the light sees, at the place where a receiver looks for it.

#include "tests/functions/shadow_images.h"
#include "uber/reference/pcf.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr uint32_t side = 64;
const LightView view{2, 16, 2};

enum Kind { plain = 0, moments = 1 };
enum Light { directional = 1, point = 2, spot = 3 };

// A slanted caster, off centre and alike in no direction, z = 5 + 0.4 x, over a floor at 10 m.
const Rectangle caster{0.5, 2.0, -1.5, -0.2};
double caster_distance(double x) { return 5 + 0.4 * x; }

void add_quad(std::vector<float>& out, const Rectangle& r, double (*z)(double)) {
    for (const auto& [x, y] : {std::pair{r.x0, r.y0}, {r.x1, r.y0}, {r.x1, r.y1}, {r.x0, r.y0}, {r.x1, r.y1}, {r.x0, r.y1}})
        out.insert(out.end(), {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z(x))});
}

struct Drawn {
    std::vector<float> depth, first, second;  // by texel; moments where there are any
};

Drawn draw(Kind kind, Light light, bool alpha_test, const std::vector<float>& matrix, const std::vector<float>& positions) {
    const std::string defines = "#define KIND " + std::to_string(kind) + "\n#define LIGHT_TYPE " + std::to_string(light) +
                                "\n#define ALPHA_TEST " + (alpha_test ? "1\n" : "0\n");
    PipelineRequest request = request_of({compile(Stage::vertex, uber_text("shadow_pass.vert", defines)),
                                          compile(Stage::fragment, uber_text("shadow_pass.frag", defines))});
    request.inputs.resize(1);
    request.size = side;
    request.depth_test = true;
    Inputs& inputs = request.inputs[0];
    inputs.vertices = static_cast<uint32_t>(positions.size() / 3);
    for (Attribute& a : inputs.attributes) {
        EXPECT_TRUE(a.location == 0 || alpha_test);
        // Opacity over the map: the test reads a texture whose alpha is 0 left of uv.x = 1/2.
        std::vector<float> uv;
        for (size_t i = 0; i < positions.size(); i += 3) uv.insert(uv.end(), {positions[i] > 1 ? 1.0f : 0.0f, 0.5f});
        a.data = a.location == 0 ? bytes_of(positions) : bytes_of(uv);
        a.components = a.location == 0 ? 3 : 2;
    }
    for (Binding& b : inputs.bindings) {
        std::vector<float> block;
        if (b.set == 0) {
            block = matrix;
            block.insert(block.end(), {static_cast<float>(view.far), 0.5f, 0, 0});
        } else if (b.kind == ResourceKind::uniform_block) {
            block = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        } else {
            b.images = {image_of(TexelFormat::rgba32_float, 2, 1, little<float>({1, 1, 1, 0, 1, 1, 1, 1}))};
            b.sampler = nearest(false);
            continue;
        }
        b.buffers = {bytes_of(block)};
    }
    if (alpha_test) inputs.push_constants = little<float>({0.5f});
    Result<PipelineOutput> out = device().run(request);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    Drawn drawn;
    if (!out.ok()) return drawn;
    EXPECT_TRUE(out->errors.empty()) << out->errors.front();
    EXPECT_EQ(out->runs.size(), 1u);
    if (out->runs.size() != 1) return drawn;
    for (const ReadBack& r : out->runs[0].values)
        for (size_t i = 0; i < r.words.size(); i += r.components) {
            const float value = std::bit_cast<float>(r.words[i]);
            if (r.what == "depth") drawn.depth.push_back(value);
            if (r.what != "depth") drawn.first.push_back(value), drawn.second.push_back(std::bit_cast<float>(r.words[i + 1]));
        }
    EXPECT_EQ(drawn.depth.size(), size_t{side} * side);
    EXPECT_EQ(drawn.first.size(), kind == moments ? size_t{side} * side : 0);
    return drawn;
}

// Columns of the matrix of `view`, and of an orthographic one of the same extent at 1 m scaled to 4 m, depth over 16 m from 6 m.
std::vector<float> perspective() {
    const float f = static_cast<float>(view.far / (view.far - view.near)), n = static_cast<float>(view.near);
    return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, f, 1, 0, 0, -f * n, 0};
}
std::vector<float> orthographic() { return {0.25f, 0, 0, 0, 0, 0.25f, 0, 0, 0, 0, 1.0f / 16, 0, 0, 0, -6.0f / 16, 1}; }

std::vector<float> scene() {
    std::vector<float> positions;
    add_quad(positions, {-20, 20, -20, 20}, [](double) { return 10.0; });
    add_quad(positions, caster, caster_distance);
    return positions;
}

// Whether a ray (X, Y, 1) of the light meets the caster, and how far it is there; sure says that nothing within a texel of
// it differs.
struct Seen {
    bool hit = false, sure = true;
    double distance = 10;
};
Seen look_along(double X, double Y) {
    const auto hits = [](double a, double b) {
        const double z = 5 / (1 - 0.4 * a);
        return caster.holds(a * z, b * z);
    };
    Seen seen;
    seen.hit = hits(X, Y);
    for (const double a : {-2.5 / side, 2.5 / side})
        for (const double b : {-2.5 / side, 2.5 / side}) seen.sure = seen.sure && hits(X + a, Y + b) == seen.hit;
    if (seen.hit) seen.distance = 5 / (1 - 0.4 * X);
    return seen;
}

TEST(ShadowPass, MapHoldsWhatTheLightSeesWhereAReceiverLooks) {
    const Drawn drawn = draw(plain, spot, false, perspective(), scene());
    ASSERT_EQ(drawn.depth.size(), size_t{side} * side);
    int caught = 0;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const Seen seen = look_along(2 * (x + 0.5) / side - 1, 2 * (y + 0.5) / side - 1);
            if (!seen.sure) continue;
            caught += seen.hit ? 1 : 0;
            // Depth interpolates linearly in the window, within a few units of its 24 bits.
            EXPECT_NEAR(static_cast<double>(drawn.depth[y * side + x]), view.depth(seen.distance), 1e-6) << x << ' ' << y;
        }
    EXPECT_GT(caught, 20);
    // Receivers on the floor and above it, by the same matrix: lit where nothing stands between, at no mirrored place.
    const DepthTexture map{side, drawn.depth};
    std::vector<Texel> at;
    for (int i = 0; i < 20'000; ++i) {
        const double z = 3 + 7 * pixel_hash(static_cast<uint32_t>(i), 0),
                     X = 1.9 * pixel_hash(static_cast<uint32_t>(i), 1) - 0.95;
        const double Y = 1.9 * pixel_hash(static_cast<uint32_t>(i), 2) - 0.95;
        at.push_back({static_cast<float>(X * z), static_cast<float>(Y * z), static_cast<float>(z), 0});
    }
    const std::string clip = "vec4(p.xy, (16.0 / 14.0) * p.z - (32.0 / 14.0), p.z)";
    const std::vector<Texel> lit = evaluate(uber_text("lib/shadow_map.glsl"), "shadow_factor_2d(map, " + clip + ", 1e-5)", at,
                                            {{"sampler2DShadow map", map.image(), nearest(true)}});
    int dark = 0, compared = 0;
    for (size_t i = 0; i < at.size(); ++i) {
        const double x = static_cast<double>(at[i][0]), y = static_cast<double>(at[i][1]), z = static_cast<double>(at[i][2]);
        const Seen seen = look_along(x / z, y / z);
        // Within half a texel of slope of the caster itself a map cannot tell.
        if (!seen.sure || (seen.hit && std::fabs(z - seen.distance) < 0.2)) continue;
        const bool blocked = seen.hit && z > seen.distance;
        EXPECT_EQ(lit[i][0], blocked ? 0.0f : 1.0f) << x << ' ' << y << ' ' << z;
        dark += blocked ? 1 : 0;
        ++compared;
    }
    EXPECT_GT(dark, 50);
    EXPECT_GT(compared, 15'000);
}

TEST(ShadowPass, MomentsAreOfTheDistance) {
    for (const Light light : {spot, point}) {
        const Drawn drawn = draw(moments, light, false, perspective(), scene());
        ASSERT_EQ(drawn.first.size(), size_t{side} * side);
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                const double X = 2 * (x + 0.5) / side - 1;
                const Seen seen = look_along(X, 2 * (y + 0.5) / side - 1);
                if (!seen.sure) continue;
                const double q = seen.distance / view.far - 0.5;
                EXPECT_NEAR(static_cast<double>(drawn.first[y * side + x]), q, 1e-6);
                // A step of z over a texel: its derivative at the middle, and half a texel's change of that at most.
                const double k = 1 - 0.4 * X, slope = seen.hit ? 5 * 0.4 / (k * k) * 2 / side / view.far : 0;
                const double spread = static_cast<double>(drawn.second[y * side + x]) - q * q;
                EXPECT_NEAR(spread, slope * slope / 12, 0.05 * slope * slope / 12 + 1e-7) << x << ' ' << y;
            }
    }
}

TEST(ShadowPass, CastersBeforeTheNearPlaneAreFlattenedOntoIt) {
    // The caster at 5 to 6 m, the map begins at 6: without flattening it would be cut away and cast nothing.
    const Drawn drawn = draw(plain, directional, false, orthographic(), scene());
    ASSERT_EQ(drawn.depth.size(), size_t{side} * side);
    int flat = 0;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double px = 4 * (2 * (x + 0.5) / side - 1), py = 4 * (2 * (y + 0.5) / side - 1);
            const bool hit = caster.holds(px, py);
            EXPECT_NEAR(static_cast<double>(drawn.depth[y * side + x]), hit ? 0.0 : 4.0 / 16, 1e-6) << px << ' ' << py;
            flat += hit ? 1 : 0;
        }
    EXPECT_GT(flat, 50);
}

TEST(ShadowPass, WhatIsNotOpaqueCastsNothing) {
    for (const Kind kind : {plain, moments}) {
        // The caster's uv runs from 0 to 1 across it: its left half is transparent.
        std::vector<float> positions;
        add_quad(positions, caster, caster_distance);
        const Drawn drawn = draw(kind, directional, true, orthographic(), positions);
        ASSERT_EQ(drawn.depth.size(), size_t{side} * side);
        const double texel = 8.0 / side, middle = (caster.x0 + caster.x1) / 2;
        int cast = 0;
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x) {
                const double px = 4 * (2 * (x + 0.5) / side - 1), py = 4 * (2 * (y + 0.5) / side - 1);
                if (std::fabs(px - middle) < texel) continue;
                const bool opaque = caster.holds(px, py) && px > middle;
                EXPECT_EQ(drawn.depth[y * side + x], opaque ? 0.0f : 1.0f) << px << ' ' << py;
                cast += opaque ? 1 : 0;
            }
        EXPECT_GT(cast, 20);
    }
}

}  // namespace
}  // namespace kiln::test
