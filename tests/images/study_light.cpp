// Diffuse light from a few numbers and image-based light, form by form.

#include "tests/images/study.h"
#include "uber/reference/study_environment.h"
#include "uber/reference/study_irradiance.h"

namespace kiln::test {
namespace {

using namespace reference;

// A sky that is bright above and reddish to one side; blur 0 sharp to 1.
V3 sky(const V3& d, double blur) {
    const double sharp = 1 - 0.7 * blur;
    return {0.6 + 0.35 * sharp * d.x + 0.2 * sharp * sharp * d.x * d.y, 0.6 + 0.3 * sharp * d.y,
            0.7 + 0.2 * sharp * d.y + 0.25 * sharp * sharp * d.z * d.z};
}

CubeArray cube(long side, int levels, double scale, bool blurred) {
    std::vector<float> texels;
    for (int l = 0; l < levels; ++l) {
        const int n = static_cast<int>(side >> l);
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x) {
                    const V3 d = normalize(cube_direction(face, cube_texel_centre<double>(x, y, n)));
                    const V3 c = sky(d, blurred ? l / std::max(1.0, levels - 1.0) : 0) * scale;
                    for (const double v : {c.x, c.y, c.z, 1.0}) texels.push_back(static_cast<float>(v));
                }
    }
    return {side, levels, 1, texels, true};
}

std::vector<double> three(const V3& v) { return {v.x, v.y, v.z}; }

// ---- irradiance ----

IrradianceBlock irradiance_block() {
    IrradianceBlock b;
    for (size_t i = 0; i < 8; ++i)
        for (size_t k = 0; k < 9; ++k) {
            const double p = static_cast<double>(i), band[] = {1.4, 0.5, 0.3, -0.4, 0.1, -0.15, 0.12, 0.08, 0.2};
            const double c = band[k] * (1 + 0.15 * std::sin(3 * p + static_cast<double>(k)));
            b.probe_sh[9 * i + k] = f32(V3{c, c * 0.8 + 0.02 * p, c * 0.6});
        }
    b.tetrahedron_corner = {f32(V3{-2, -1.5, -1}), f32(V3{2.2, -1.4, -0.8}), f32(V3{0.1, 2.5, -0.9}), f32(V3{0.2, 0.1, 2.75})};
    b.grid_first = f32(V3{-0.7, -0.9, -1.2});
    b.grid_spacing = f32(V3{1.5, 1.75, 2.25});
    return b;
}

NamedInputs inputs(const IrradianceBlock& b, const CubeArray& map) {
    NamedInputs in;
    const auto padded = [&](const std::string& name, const auto& values) {
        for (const V3& v : values)
            for (const double x : {v.x, v.y, v.z, 0.0}) in.members[name].push_back(x);
    };
    padded("probe_sh", b.probe_sh);
    padded("tetrahedron_corner", b.tetrahedron_corner);
    in.members["grid_first"] = three(b.grid_first);
    in.members["grid_spacing"] = three(b.grid_spacing);
    in.textures["irradiance_map"] = study_texture(map);
    return in;
}

struct IrradianceStudy {
    IrradianceBlock block = irradiance_block();
    CubeArray map = cube(16, 1, 1, false);
    StudyPixel expected(const Values& v) const {
        const IrradianceAxes axes{v.at("irradiance"), v.at("probes")};
        return [this, axes](const Vec2<Bounded>& uv) {
            return study_irradiance(
                axes, block, [this](const auto& d, int layer, const auto& level) { return map(d, layer, level); }, uv);
        };
    }
    Judged hold(const Values& v, const Edits& edits = {}) const {
        return hold_study("study_irradiance", v, inputs(block, map), expected(v), 0.1, edits);
    }
};

TEST(Study, EveryIrradiance) {
    const IrradianceStudy study;
    const std::vector<Values> variants = legal("library.yaml", "study_irradiance");
    EXPECT_GE(variants.size(), 20u);
    for (const Values& v : variants) study.hold(v);
}

TEST(Study, WrongIrradiancesAreCaught) {
    const IrradianceStudy study;
    const Values plain{{"irradiance", "sh_l2_clamped"}, {"probes", "single"}};
    const auto with = [&](const char* axis, const char* value) {
        Values v = plain;
        v[axis] = value;
        return v;
    };
    const std::pair<Values, Edits> all[] = {
        {plain, {{"0.858085531", "0.9"}}},
        {with("irradiance", "sh_l1_moments"), {{"+ 0.5 * (m.m1_y", "+ 0.6 * (m.m1_y"}}},
        {with("irradiance", "lecture"), {{"1.023326", "1.1"}}},
        {with("probes", "trilinear_facing"), {{"wrapped * wrapped + 0.2", "wrapped * wrapped + 0.4"}}},
        {with("probes", "tetrahedral"), {{"corners[i]", "corners[3 - i]"}}},
    };
    for (const auto& [values, edits] : all) EXPECT_GT(study.hold(values, edits).wrong, 500u) << edits.front().second;
}

// ---- environment ----

struct EnvironmentStudy {
    EnvironmentBlock plain_block;
    EnvironmentMaps maps;
    EnvironmentStudy() {
        EnvironmentBlock& block = plain_block;
        block.diffuse_albedo = f32(V3{0.4, 0.35, 0.3});
        block.f0 = f32(V3{0.5, 0.4, 0.2});
        block.box_extent = f32(V3{3, 2, 4});
        block.probe_irradiance = f32(V3{1.5, 1.6, 1.7});
        block.roughness = 0.5;
        block.environment_levels = 4;
        block.split_sum_size = 16;
        block.brightest = 4;
        maps.environment_map = cube(16, 4, 1, true);
        maps.plain_map = cube(16, 4, 0.9, false);
        maps.irradiance_map = cube(16, 1, 0.8, true);
        std::vector<float> table, picture;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const Vec2<double> ab = split_sum_fit(x / 15.0, y / 15.0);
                for (const double v : {ab.x, ab.y, 0.0, 1.0}) table.push_back(static_cast<float>(v));
            }
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 64; ++x) {
                const V3 c = sky(equirect_direction(V2{(x + 0.5) / 64, (y + 0.5) / 32}), 0.5);
                for (const double v : {c.x, c.y, c.z, 1.0}) picture.push_back(static_cast<float>(v));
            }
        maps.split_sum_table = Texture2D(16, 16, table, true, TextureWrap::clamp);
        maps.sky_picture = Texture2D(64, 32, picture, true, TextureWrap::repeat);
    }
    Judged hold(const Values& v, const Edits& edits = {}) const {
        EnvironmentMaps seen = maps;
        // The level that derivatives choose is the device's own business: a map with one level leaves no choice.
        if (v.at("reflection") == "lecture_level") seen.plain_map = cube(16, 1, 0.9, false);
        // Nor has the picture more than one.
        EnvironmentBlock block = plain_block;
        if (v.at("reflection") == "equirect") block.environment_levels = 1;
        NamedInputs in;
        auto& m = in.members;
        m["diffuse_albedo"] = three(block.diffuse_albedo);
        m["f0"] = three(block.f0);
        m["box_extent"] = three(block.box_extent);
        m["probe_irradiance"] = three(block.probe_irradiance);
        m["roughness"] = {block.roughness};
        m["environment_levels"] = {block.environment_levels};
        m["split_sum_size"] = {block.split_sum_size};
        m["brightest"] = {block.brightest};
        in.textures["environment_map"] = study_texture(seen.environment_map);
        in.textures["plain_map"] = study_texture(seen.plain_map);
        in.textures["irradiance_map"] = study_texture(seen.irradiance_map);
        in.textures["split_sum_table"] = study_texture(seen.split_sum_table);
        in.textures["sky_picture"] = study_texture(seen.sky_picture);
        const EnvironmentAxes axes{v.at("reflection"), v.at("split_sum"), v.at("scatter")};
        return hold_study(
            "study_environment", v, in, [&](const Vec2<Bounded>& uv) { return study_environment(axes, block, seen, uv); }, 0.2,
            edits);
    }
};

TEST(Study, EveryEnvironment) {
    const EnvironmentStudy study;
    const std::vector<Values> variants = legal("library.yaml", "study_environment");
    EXPECT_GE(variants.size(), 15u);
    for (const Values& v : variants) study.hold(v);
}

TEST(Study, WrongEnvironmentsAreCaught) {
    const EnvironmentStudy study;
    const Values plain{{"reflection", "prefiltered"}, {"split_sum", "table"}, {"scatter", "multiple"}};
    const auto with = [&](const char* axis, const char* value) {
        Values v = plain;
        v[axis] = value;
        return v;
    };
    const std::pair<Values, Edits> all[] = {
        {plain, {{"2.0 * dot(n, v) * n - v", "v - 2.0 * dot(n, v) * n"}}},
        {with("reflection", "lecture_direction"), {{"reflect(v, n)", "reflect(-v, n)"}}},
        {with("split_sum", "lecture"), {{"1.0 - min(n_dot_l, 1.0)", "1.0 - saturate(v_dot_h)"}}},
        {with("split_sum", "fit"), {{"-9.28", "-7.0"}}},
        {with("reflection", "equirect"), {{"azimuth / (2.0 * pi) + 0.5", "azimuth / (2.0 * pi)"}}},
    };
    for (const auto& [values, edits] : all) EXPECT_GT(study.hold(values, edits).wrong, 500u) << edits.front().second;
}

}  // namespace
}  // namespace kiln::test
