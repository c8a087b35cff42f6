// Hair and subsurface scattering, form by form.

#include "tests/images/study.h"
#include "uber/reference/study_hair.h"
#include "uber/reference/study_subsurface.h"

namespace kiln::test {
namespace {

using namespace reference;

std::vector<double> three(const V3& v) { return {v.x, v.y, v.z}; }

Judged hold_hair(const std::string& form, const Edits& edits = {}) {
    HairBlock b;
    b.towards_eye = f32(V3{0.3, 0.2, 0.9});
    b.hair_colour = f32(V3{0.7, 0.5, 0.3});
    b.lamp_brightness = f32(V3{1.5, 1.25, 1});
    b.beta_m = f32(0.4), b.beta_n = f32(0.6), b.across = 0.25, b.tilt = 0.375, b.backlit = 0.75, b.specular_level = 0.5;
    b.shininess = 24;
    NamedInputs in;
    auto& m = in.members;
    m["towards_eye"] = three(b.towards_eye);
    m["hair_colour"] = three(b.hair_colour);
    m["lamp_brightness"] = three(b.lamp_brightness);
    m["beta_m"] = {b.beta_m};
    m["beta_n"] = {b.beta_n};
    m["across"] = {b.across};
    m["tilt"] = {b.tilt};
    m["backlit"] = {b.backlit};
    m["specular_level"] = {b.specular_level};
    m["shininess"] = {b.shininess};
    // Where light comes from behind, an azimuth jumps from pi to -pi.
    return hold_study(
        "study_hair", {{"hair", form}}, in, [&](const Vec2<Bounded>& uv) { return study_hair(form, b, uv); }, 0.3, edits);
}

struct SubsurfaceStudy {
    SubsurfaceBlock b;
    SubsurfaceMaps maps;
    SubsurfaceStudy() {
        b.lamp_bearing = f32(V3{0.7, 0.5, 0.6});
        b.surface_albedo = f32(V3{0.85, 0.6, 0.5});
        b.free_path = f32(V3{1.2, 0.7, 0.4});
        b.scattering = f32(V3{0.9, 0.6, 0.3});
        b.absorption = f32(V3{0.75, 0.5, 0.6});
        b.wrap = 0.5, b.curvature = 0.375, b.picture_width = 16, b.index = f32(1.4), b.turn = 0.25;
        std::vector<float> table, picture;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x)
                for (const double v : {preintegrated_texel<double>(x, y, 32, 32, 32), 0.0, 0.0, 1.0})
                    table.push_back(static_cast<float>(v));
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                const double lit = (x > 9 && x < 20) != (y > 14) ? 1.0 : 0.1;
                for (const double v : {lit, lit * 0.9, lit * 0.8, 1.0}) picture.push_back(static_cast<float>(v));
            }
        maps.preintegrated_table = Texture2D(32, 32, table, true, TextureWrap::clamp);
        maps.irradiance_picture = Texture2D(32, 32, picture, true, TextureWrap::clamp);
    }
    Judged hold(const std::string& form, const Edits& edits = {}) const {
        NamedInputs in;
        auto& m = in.members;
        m["lamp_bearing"] = three(b.lamp_bearing);
        m["surface_albedo"] = three(b.surface_albedo);
        m["free_path"] = three(b.free_path);
        m["scattering"] = three(b.scattering);
        m["absorption"] = three(b.absorption);
        m["wrap"] = {b.wrap};
        m["curvature"] = {b.curvature};
        m["picture_width"] = {b.picture_width};
        m["index"] = {b.index};
        m["turn"] = {b.turn};
        in.textures["preintegrated_table"] = study_texture(maps.preintegrated_table);
        in.textures["irradiance_picture"] = study_texture(maps.irradiance_picture);
        return hold_study(
            "study_subsurface", {{"subsurface", form}}, in,
            [&](const Vec2<Bounded>& uv) { return study_subsurface(form, b, maps, uv); }, 0.3, edits);
    }
};

TEST(Study, EveryHair) {
    const std::vector<Values> variants = legal("library.yaml", "study_hair");
    EXPECT_GE(variants.size(), 8u);
    for (const Values& v : variants) hold_hair(v.at("hair"));
}

TEST(Study, WrongHairIsCaught) {
    const std::pair<const char*, Edits> all[] = {
        {"chiang", {{"p == 0 ? -2.0", "p == 0 ? 2.0"}}},
        {"karis", {{"exp(-3.65 * cos_phi - 3.98)", "exp(-3.0 * cos_phi - 3.98)"}}},
        {"longitudinal_log", {{"0.6931", "0.75"}}},
    };
    for (const auto& [form, edits] : all) EXPECT_GT(hold_hair(form, edits).wrong, 500u) << form;
}

TEST(Study, EverySubsurface) {
    const SubsurfaceStudy study;
    const std::vector<Values> variants = legal("library.yaml", "study_subsurface");
    EXPECT_GE(variants.size(), 10u);
    for (const Values& v : variants) study.hold(v.at("subsurface"));
}

TEST(Study, WrongSubsurfaceIsCaught) {
    const SubsurfaceStudy study;
    const std::pair<const char*, Edits> all[] = {
        {"wrap", {{"(scale * scale)", "scale"}}},
        {"separable_skin", {{"0.358 / 1.99", "0.258 / 1.99"}}},
        {"profile_dipole", {{"-1.440", "-1.340"}}},
        {"preintegrated_table", {{"curvature / s.x", "curvature / s.y"}}},
    };
    for (const auto& [form, edits] : all) EXPECT_GT(study.hold(form, edits).wrong, 500u) << form;
}

}  // namespace
}  // namespace kiln::test
