// The renderer and the textures of the image tests against plain geometry.

#include "uber/reference/render.h"

#include <gtest/gtest.h>

#include "uber/reference/random.h"
#include "uber/reference/texture.h"

namespace kiln::reference {
namespace {

using V2 = Vec2<double>;
using V3 = Vec3<double>;
using V4 = Vec4<double>;

// Pixels of a plane below a camera against rays: weights are those of the point that a ray through the pixel meets, also where
// the triangle reaches behind the eye.
TEST(Render, WeightsAreOfThePointThatARayMeets) {
    const V3 eye{0.3, 1.5, 2}, corners[3] = {{-30, 0, 30}, {40, 0, 20}, {1, 0, -30}};
    const Mat4<double> view = look_at(eye, {0, 0, -1}, {0, 1, 0}), clip = perspective(0.5, 0.1, 100) * view;
    RasterTriangle t;
    for (int k = 0; k < 3; ++k) t.clip[k] = clip * V4{corners[k].x, corners[k].y, corners[k].z, 1};
    ASSERT_LT(std::min({t.clip[0].w, t.clip[1].w, t.clip[2].w}), 0);
    constexpr int size = 48;
    const std::vector<Fragment> fragments = rasterise({t}, size, size);
    const V3 right{view.columns[0].x, view.columns[1].x, view.columns[2].x},
        up{view.columns[0].y, view.columns[1].y, view.columns[2].y},
        back{view.columns[0].z, view.columns[1].z, view.columns[2].z};
    int drawn = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double reach = std::tan(0.5), u = (2 * (x + 0.5) / size - 1) * reach, v = (2 * (y + 0.5) / size - 1) * reach;
            const V3 along = right * u - up * v - back;
            const V3 met = eye + along * (-eye.y / along.y);
            const Fragment& f = fragments[static_cast<size_t>(y * size + x)];
            EXPECT_TRUE(along.y < 0 || f.triangle < 0) << x << ' ' << y;
            if (f.triangle < 0) continue;
            ++drawn;
            const V3 here = corners[0] * f.weight[0] + corners[1] * f.weight[1] + corners[2] * f.weight[2];
            EXPECT_NEAR(length(here - met), 0, 1e-9 * (1 + length(met)));
            const V4 c = clip * V4{met.x, met.y, met.z, 1};
            EXPECT_NEAR(f.depth, c.z / c.w, 1e-12);
        }
    EXPECT_GT(drawn, 500);
}

TEST(Render, NearestSurfaceAndItsFace) {
    const auto square = [](double z, bool turned) {
        RasterTriangle t{{{-3, -3, z, 1}, {3, -3, z, 1}, {0, 3, z, 1}}};
        if (turned) std::swap(t.clip[0], t.clip[1]);
        return t;
    };
    for (const bool turned : {false, true}) {
        const Fragment f = rasterise({square(0.6, turned), square(0.4, turned), square(0.5, turned)}, 4, 4)[5];
        EXPECT_EQ(f.triangle, 1);
        EXPECT_DOUBLE_EQ(f.depth, 0.4);
        // Left to right along the top, then down: clockwise as seen, with y down.
        EXPECT_EQ(f.front, turned);
    }
    EXPECT_EQ(rasterise({square(-0.1, false), square(1.1, false)}, 4, 4)[5].triangle, -1);
}

// Six faces drawn about a point, looked up by direction: the depth of the wall that the direction meets.
TEST(Render, CubeFacesMeetTheirLookUp) {
    const V3 centre{0.4, -0.2, 0.1};
    constexpr double near = 0.1, far = 20;
    // A box whose walls are all at other distances.
    const V3 low = centre - V3{1, 2, 3}, high = centre + V3{1.5, 2.5, 3.5};
    std::vector<std::array<V3, 3>> walls;
    const auto corner = [&](unsigned i) { return V3{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; };
    for (const auto& f :
         {std::array{1u, 3u, 7u, 5u}, {0u, 2u, 6u, 4u}, {2u, 3u, 7u, 6u}, {0u, 1u, 5u, 4u}, {4u, 5u, 7u, 6u}, {0u, 1u, 3u, 2u}})
        for (const auto& t : {std::array{f[0], f[1], f[2]}, {f[0], f[2], f[3]}})
            walls.push_back({corner(t[0]), corner(t[1]), corner(t[2])});
    constexpr int size = 64;
    std::vector<DepthMap> faces;
    for (int f = 0; f < 6; ++f) faces.emplace_back(size, size, depths_of(walls, cube_face(f, centre, near, far), size));
    const DepthCube cube(std::move(faces));
    Random random(3);
    int compared = 0;
    for (int i = 0; i < 2000; ++i) {
        const V3 d{2 * random() - 1, 2 * random() - 1, 2 * random() - 1};
        const auto steps = [](double x, double to_low, double to_high) { return x > 0 ? to_high / x : to_low / -x; };
        const double t = std::min({steps(d.x, 1, 1.5), steps(d.y, 2, 2.5), steps(d.z, 3, 3.5)});
        const double z = t * std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
        const double depth = far / (far - near) - far * near / ((far - near) * z);
        decision_was_close = false;
        // A texel's width before the wall it is lit, as far behind it is not; corners of the box are between.
        const double lit = cube(d, depth - 0.004), dark = cube(d, depth + 0.004);
        if (decision_was_close || lit != 1 || dark != 0) continue;
        ++compared;
    }
    decision_was_close = false;
    EXPECT_GT(compared, 1500);
}

TEST(Render, BoundsHoldWhatACoordinateWithinItsErrorReads) {
    Random random(7);
    std::vector<float> texels(8 * 8 * 4);
    for (float& x : texels) x = static_cast<float>(random());
    const Texture2D image(8, 8, texels, true, TextureWrap::repeat);
    EXPECT_EQ(image.channel(V2{2.5 / 8, 3.5 / 8}, 1), static_cast<double>(texels[(3 * 8 + 2) * 4 + 1]));
    EXPECT_NEAR(image.channel(V2{3.0 / 8, 3.5 / 8}, 0),
                0.5 * static_cast<double>(texels[(3 * 8 + 2) * 4] + texels[(3 * 8 + 3) * 4]), 1e-7);
    for (int i = 0; i < 4000; ++i) {
        const double error = std::pow(2.0, -4 - 16 * random()), u = 2 * random() - 0.5, v = 2 * random() - 0.5;
        const Bounded read = image.channel(Vec2<Bounded>{Bounded(u, error / 8), Bounded(v, error / 8)}, 2);
        for (int k = 0; k < 4; ++k) {
            const double at = image.channel(V2{u + (2 * random() - 1) * error / 8, v + (2 * random() - 1) * error / 8}, 2);
            EXPECT_LE(std::fabs(at - read.value), read.error) << u << ' ' << v << ' ' << error;
        }
    }
}

TEST(Render, UnfilteredTexelsNearTheirEdgeAreFlagged) {
    std::vector<float> texels(4 * 4 * 4, 0.5f);
    const Texture2D image(4, 4, texels, false, TextureWrap::clamp);
    for (const auto& [u, close] : {std::pair{0.3, false}, {0.5001, true}, {0.51, false}}) {
        decision_was_close = false;
        EXPECT_EQ(image.channel(Vec2<Bounded>{Bounded(u, 0.001), Bounded(0.1, 0.001)}, 0).value, 0.5);
        EXPECT_EQ(decision_was_close, close) << u;
    }
    decision_was_close = false;
}

}  // namespace
}  // namespace kiln::reference
