#include "uber/reference/study_indirect.h"

#include <cstring>

#include "tests/images/study.h"

namespace kiln::test {
namespace {

using namespace reference;

struct IndirectStudy {
    IndirectBlock b;
    IndirectMaps maps;
    IndirectStudy() {
        const double near = 0.1, far = 10;
        b.screen_projection.columns[0] = {1.5, 0, 0, 0};
        b.screen_projection.columns[1] = {0, -1.5, 0, 0};
        b.screen_projection.columns[2] = {0, 0, f32(far / (near - far)), -1};
        b.screen_projection.columns[3] = {0, 0, f32(near * far / (near - far)), 0};
        b.ambient = f32(V3{2, 1.75, 1.5});
        b.wall_albedo = f32(V3{0.8, 0.6, 0.4});
        b.lamp_bearing = f32(V3{0.3, 0.9, 0.2});
        b.reach = 0.75, b.tangent = 0.25, b.thickness = 0.5;
        std::vector<float> position, facing, intensity, depth, radiance, volume, field;
        const auto put = [](std::vector<float>& to, std::initializer_list<double> values) {
            for (const double v : values) to.push_back(static_cast<float>(v));
        };
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const double u = (x + 0.5) / 8 - 0.5, v = (y + 0.5) / 8 - 0.5;
                const V3 down = normalize(V3{-0.5 * u, -1, 0.3 * v});
                put(position, {u, 0.3 + 0.2 * u * v, v, 1.0 / 64});
                put(facing, {down.x, down.y, down.z, 0});
                put(intensity, {0.02 + 0.01 * x, 0.05, 0.06 - 0.005 * y, 0});
            }
        const M4& p = b.screen_projection;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const double distance = x > 4 && x < 11 ? 1.1 : 1.5;
                put(depth, {-p.columns[2].z + p.columns[3].z / distance, 0, 0, 0});
                put(radiance, {0.5 + 0.03 * x, 0.6, 0.9 - 0.03 * y, 1});
            }
        for (int n = 8; n > 0; n /= 2)
            for (int z = 0; z < n; ++z)
                for (int y = 0; y < n; ++y)
                    for (int x = 0; x < n; ++x) {
                        const double u = (x + 0.5) / n, v = (y + 0.5) / n, w = (z + 0.5) / n, a = 0.15 + 0.1 * u + 0.1 * v;
                        put(volume, {a * (0.5 + u), a * 0.9, a * (1.4 - w), a});
                    }
        for (int z = 0; z < 16; ++z)
            for (int y = 0; y < 16; ++y)
                for (int x = 0; x < 16; ++x) {
                    const auto place = [](int i) { return (i + 0.5) / 16 - 0.5; };
                    put(field, {std::sqrt(place(x) * place(x) + place(y) * place(y) + place(z) * place(z)) - 0.2, 0, 0, 0});
                }
        maps.rsm_position = Texture2D(8, 8, position, false, TextureWrap::clamp);
        maps.rsm_facing = Texture2D(8, 8, facing, false, TextureWrap::clamp);
        maps.rsm_intensity = Texture2D(8, 8, intensity, false, TextureWrap::clamp);
        maps.scene_depth = Texture2D(16, 16, depth, false, TextureWrap::clamp);
        maps.scene_radiance = Texture2D(16, 16, radiance, true, TextureWrap::clamp);
        maps.radiance_volume = VoxelCube(8, 4, volume);
        maps.distance_field = VoxelCube(16, 1, field);
    }
    Judged hold(const std::string& form, const Edits& edits = {}) const {
        NamedInputs in;
        auto& m = in.members;
        const auto three = [](const V3& v) { return std::vector<double>{v.x, v.y, v.z}; };
        for (const V4& c : b.screen_projection.columns)
            for (const double x : {c.x, c.y, c.z, c.w}) m["screen_projection"].push_back(x);
        m["ambient"] = three(b.ambient);
        m["wall_albedo"] = three(b.wall_albedo);
        m["lamp_bearing"] = three(b.lamp_bearing);
        m["reach"] = {b.reach};
        m["tangent"] = {b.tangent};
        m["thickness"] = {b.thickness};
        in.textures["rsm_position"] = study_texture(maps.rsm_position);
        in.textures["rsm_facing"] = study_texture(maps.rsm_facing);
        in.textures["rsm_intensity"] = study_texture(maps.rsm_intensity);
        in.textures["scene_depth"] = study_texture(maps.scene_depth);
        in.textures["scene_radiance"] = study_texture(maps.scene_radiance);
        in.textures["radiance_volume"] = voxels(maps.radiance_volume);
        in.textures["distance_field"] = voxels(maps.distance_field);
        // Marching decides at every step whether something is met.
        return hold_study(
            "study_indirect", {{"indirect", form}}, in,
            [&](const Vec2<Bounded>& uv) { return study_indirect(form, b, maps, uv); }, 0.85, edits);
    }

private:
    static NamedTexture voxels(const VoxelCube& from) {
        auto image = std::make_shared<ImageData>();
        image->dim = ImageDim::d3;
        image->width = image->height = image->slices = static_cast<uint32_t>(from.side());
        image->mips = static_cast<uint32_t>(from.levels());
        image->texels.resize(from.texels().size() * sizeof(float));
        std::memcpy(image->texels.data(), from.texels().data(), image->texels.size());
        return {image, SamplerState{Filter::linear, MipFilter::linear, Wrap::clamp, Comparison::off}};
    }
};

TEST(Study, EveryIndirect) {
    const IndirectStudy study;
    const std::vector<Values> variants = legal("library.yaml", "study_indirect");
    EXPECT_GE(variants.size(), 10u);
    for (const Values& v : variants) study.hold(v.at("indirect"));
}

TEST(Study, WrongIndirectIsCaught) {
    const IndirectStudy study;
    const std::pair<const char*, Edits> all[] = {
        {"multibounce", {{"2.7552", "2.5"}}},
        {"rsm_all", {{"return intensity * (cosines", "return 0.9 * intensity * (cosines"}}},
        {"cones", {{"vec4(n, 0.25)", "vec4(n, 0.5)"}}},
        {"sdf_soft_visibility", {{"open = min(open, sdf_soft_share(d, t, k))", "open = min(open, 0.5)"}}},
    };
    for (const auto& [form, edits] : all) EXPECT_GT(study.hold(form, edits).wrong, 300u) << form;
}

}  // namespace
}  // namespace kiln::test
