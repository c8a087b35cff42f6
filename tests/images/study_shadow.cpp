#include "uber/reference/study_shadow.h"

#include <cstring>

#include "tests/images/study.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr int side = 64;
constexpr double near_plane = 1, far_plane = 16;

// Distance of what the lamp sees first: a beam over a post over the floor, with some slope.
double distance_at(int x, int y) {
    const double u = (x + 0.5) / side, v = (y + 0.5) / side;
    if (u > 0.18 && u < 0.42) return 4 + v;
    if (std::fabs(u - 0.75) < 0.08 && v > 0.3) return 6;
    return 11;
}
float depth_of(double distance) {
    return static_cast<float>(far_plane * (distance - near_plane) / (distance * (far_plane - near_plane)));
}

MomentMips mips(const std::function<double(int, int)>& value) {
    std::vector<Texture2D> levels;
    std::vector<std::array<double, 2>> now;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) now.push_back({value(x, y), value(x, y) * value(x, y)});
    for (int n = side; n >= 4; n /= 2) {
        std::vector<float> texels;
        for (const auto& m : now)
            for (const double v : {m[0], m[1], 0.0, 1.0}) texels.push_back(static_cast<float>(v));
        levels.emplace_back(n, n, texels, true, TextureWrap::clamp);
        std::vector<std::array<double, 2>> next;
        const auto at = [&](int x, int y, size_t c) { return now[static_cast<size_t>(y * n + x)][c]; };
        for (int y = 0; y < n / 2; ++y)
            for (int x = 0; x < n / 2; ++x) {
                std::array<double, 2> m{};
                for (size_t c = 0; c < 2; ++c)
                    m[c] =
                        (at(2 * x, 2 * y, c) + at(2 * x + 1, 2 * y, c) + at(2 * x, 2 * y + 1, c) + at(2 * x + 1, 2 * y + 1, c)) /
                        4;
                next.push_back(m);
            }
        now = next;
    }
    return MomentMips(levels);
}

struct ShadowStudy {
    ShadowBlock b;
    ShadowMaps maps;
    ShadowStudy() {
        const M4 whole{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
        const M4 half{{{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1, 0}, {0.125, 0.125, 0, 1}}};
        b.cascade_view_projection = {half, whole};
        b.receiver_share = {0.3125, 0.875};
        b.shadow_near = near_plane, b.shadow_far = far_plane, b.shadow_extent = 1, b.light_width = 0.5;
        b.filter_width = 0.0625, b.map_texel = 1.0 / side, b.filter_turn = 0.25;
        b.moments_middle = 0.5, b.moments_least = f32(1e-3), b.moments_bleeding = f32(0.2), b.moments_levels = 5;
        b.cascade_end = f32(0.9);
        std::vector<float> depths, turned, sums(size_t{side} * side * 4);
        const auto q = [](int x, int y) { return f32(distance_at(x, y) / far_plane - 0.5); };
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                depths.push_back(depth_of(distance_at(x, y)));
                turned.push_back(depth_of(distance_at(y, x)));
                double sum[2] = {};
                for (int j = 0; j <= y; ++j)
                    for (int i = 0; i <= x; ++i) sum[0] += q(i, j), sum[1] += q(i, j) * q(i, j);
                for (size_t c = 0; c < 2; ++c) sums[4 * static_cast<size_t>(y * side + x) + c] = static_cast<float>(sum[c]);
            }
        maps.shadow_map = DepthMap(side, side, depths);
        maps.cascade_maps = {maps.shadow_map, DepthMap(side, side, turned)};
        maps.moment_map = mips(q);
        maps.depth_moments = mips([](int x, int y) { return static_cast<double>(depth_of(distance_at(x, y))); });
        maps.moment_sums = Texture2D(side, side, sums, false, TextureWrap::clamp);
    }

    NamedInputs inputs() const {
        NamedInputs in;
        auto& m = in.members;
        for (size_t i = 0; i < 4; ++i)
            for (const V4& c : b.cascade_view_projection[std::min<size_t>(i, 1)].columns)
                for (const double x : {c.x, c.y, c.z, c.w}) m["cascade_view_projection"].push_back(x);
        m["receiver_share"] = {b.receiver_share.x, b.receiver_share.y};
        m["shadow_near"] = {b.shadow_near};
        m["shadow_far"] = {b.shadow_far};
        m["shadow_extent"] = {b.shadow_extent};
        m["light_width"] = {b.light_width};
        m["filter_width"] = {b.filter_width};
        m["map_texel"] = {b.map_texel};
        m["filter_turn"] = {b.filter_turn};
        m["moments_middle"] = {b.moments_middle};
        m["moments_least"] = {b.moments_least};
        m["moments_bleeding"] = {b.moments_bleeding};
        m["moments_levels"] = {b.moments_levels};
        m["cascade_end"] = {b.cascade_end};
        in.textures["shadow_map"] = depth({maps.shadow_map}, false);
        in.textures["cascade_maps"] = depth(maps.cascade_maps, true);
        std::vector<float> values;
        for (const float d : maps.shadow_map.texels()) values.insert(values.end(), {d, 0, 0, 1});
        in.textures["shadow_values"] = study_texture(Texture2D(side, side, values, false, TextureWrap::clamp));
        in.textures["moment_sums"] = study_texture(maps.moment_sums);
        in.textures["moment_map"] = chain(maps.moment_map);
        in.textures["depth_moments"] = chain(maps.depth_moments);
        return in;
    }
    Judged hold(const std::string& filter, const Edits& edits = {}) const {
        // Soft filters make a decision a tap or two a box. As printed a penumbra without a blocker is 0 / 0, and a flat map's
        // variance is what rounding leaves of it: nothing bounds either.
        const bool searching = filter.find("pcss") != std::string::npos || filter.rfind("vssm", 0) == 0;
        const bool unbounded = filter == "lecture_pcss" || filter == "lecture_variance";
        return hold_study(
            "study_shadow", {{"filter", filter}}, inputs(),
            [&](const Vec2<Bounded>& uv) {
                const Bounded lit = study_shadow(filter, b, maps, uv);
                return Vec3<Bounded>{lit, lit, lit};
            },
            unbounded   ? 0.85
            : searching ? 0.75
                        : 0.4,
            edits);
    }

private:
    static NamedTexture depth(const std::vector<DepthMap>& layers, bool arrayed) {
        auto image = std::make_shared<ImageData>();
        image->depth = true;
        image->arrayed = arrayed;
        image->width = image->height = side;
        image->layers = static_cast<uint32_t>(layers.size());
        for (const DepthMap& l : layers) {
            const auto* bytes = reinterpret_cast<const uint8_t*>(l.texels().data());
            image->texels.insert(image->texels.end(), bytes, bytes + l.texels().size() * sizeof(float));
        }
        return {image, SamplerState{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal}};
    }
    static NamedTexture chain(const MomentMips& from) {
        NamedTexture out = study_texture(from.levels().front());
        auto image = std::make_shared<ImageData>(*out.image);
        image->texels.clear();
        image->mips = static_cast<uint32_t>(from.levels().size());
        for (const Texture2D& level : from.levels()) {
            const auto* bytes = reinterpret_cast<const uint8_t*>(level.texels().data());
            image->texels.insert(image->texels.end(), bytes, bytes + level.texels().size() * sizeof(float));
        }
        out.image = image;
        out.sampler.mips = MipFilter::linear;
        return out;
    }
};

TEST(Study, EveryShadow) {
    const ShadowStudy study;
    const std::vector<Values> variants = legal("library.yaml", "study_shadow");
    EXPECT_GE(variants.size(), 15u);
    for (const Values& v : variants) study.hold(v.at("filter"));
}

TEST(Study, WrongShadowsAreCaught) {
    const ShadowStudy study;
    const std::pair<const char*, Edits> all[] = {
        {"poisson_16", {{"lit / 16.0", "lit / 15.0"}}},
        {"pcss_disk", {{"lit / float(PCSS_FILTER_TAPS)", "lit / float(PCSS_FILTER_TAPS + 4)"}}},
        {"vsm", {{"variance + beyond * beyond", "variance + 2.0 * beyond * beyond"}}},
        {"vssm_mips", {{"min(log2(texels), levels - 1.0)", "0.0"}}},
        {"lecture", {{"real_depth = real_depth * 0.5 + 0.5", "real_depth = real_depth * 1.0"}}},
        {"lecture_variance", {{"moments.y - moments.x * moments.x", "moments.y + moments.x * moments.x"}}},
        {"lecture_cascades", {{"return lit[index]", "return lit[1 - index]"}}},
    };
    for (const auto& [filter, edits] : all) EXPECT_GT(study.hold(filter, edits).wrong, 200u) << filter;
}

}  // namespace
}  // namespace kiln::test
