#include "uber/reference/study_brdf.h"

#include "tests/images/study.h"
#include "uber/reference/random.h"

namespace kiln::test {
namespace {

using namespace reference;

BrdfAxes axes_named(const Values& v) {
    return {v.at("model"),   v.at("distribution"), v.at("visibility"), v.at("fresnel"),
            v.at("diffuse"), v.at("energy"),       v.at("parameters")};
}

// Numbers of fp32. Pushed parameters are out of [0, 1].
BrdfBlock block(bool pushed) {
    BrdfBlock b;
    b.lamp_bearing = f32(V3{0.8, 0.5, -0.3});
    b.lamp_height = f32(0.7);
    b.lamp_brightness = f32(V3{1.5, 1.3, 1.1});
    b.base_colour = f32(pushed ? V3{1.5, 0.75, 0.2} : V3{0.8, 0.5, 0.3});
    b.roughness = f32(pushed ? 1.3 : 0.4);
    b.metallic = f32(pushed ? 1.25 : 0.35);
    b.dielectric_specular = f32(0.6);
    b.shininess = 40;
    b.albedo_average = f32(0.85);
    b.split_sum_size = 16;
    b.fresnel_edge = f32(V3{0.9, 0.6, 0.7});
    b.ior = 1.5;
    b.eta = f32(V3{0.2, 0.9, 1.3});
    b.k = f32(V3{3.9, 2.4, 2.0});
    b.subsurface = 0.25;
    b.sheen = 0.5;
    b.specular_tint = 0.375;
    b.sheen_tint = 0.75;
    b.clearcoat = 0.5;
    b.clearcoat_gloss = f32(0.3);
    return b;
}

const BrdfMaps& maps() {
    static const BrdfMaps made = [] {
        BrdfMaps m;
        std::vector<float> table;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
                const Vec2<double> ab = split_sum_fit(x / 15.0, y / 15.0);
                table.insert(table.end(), {static_cast<float>(ab.x), static_cast<float>(ab.y), 0, 1});
            }
        m.split_sum_table = Texture2D(16, 16, table, true, TextureWrap::clamp);
        // A lobe over theta_h with some structure; a bin in a thousand was not measured.
        Random random(5);
        std::vector<std::array<float, 4>> bins;
        for (int h = 0; h < 90; ++h)
            for (int d = 0; d < 90; ++d)
                for (int p = 0; p < 180; ++p) {
                    const double lobe = 0.2 + 2 * std::exp(-h / 15.0) + 0.002 * d + 0.1 * std::sin(p * pi / 90);
                    const float x = random() < 0.001 ? 0.0f : 1.0f, y = x * static_cast<float>(lobe);
                    bins.push_back({y, y * 0.75f, y * 0.5f, x});
                }
        for (size_t row = 0; row < bins.size(); row += 180)
            for (size_t column = 0; column < 182; ++column) {
                const std::array<float, 4>& t = bins[row + (column + 179) % 180];
                m.merl.texels.insert(m.merl.texels.end(), t.begin(), t.end());
            }
        return m;
    }();
    return made;
}

NamedInputs inputs(const BrdfBlock& b) {
    NamedInputs in;
    auto& m = in.members;
    const auto three = [](const V3& v) { return std::vector<double>{v.x, v.y, v.z}; };
    m["lamp_bearing"] = three(b.lamp_bearing);
    m["lamp_height"] = {b.lamp_height};
    m["lamp_brightness"] = three(b.lamp_brightness);
    m["base_colour"] = three(b.base_colour);
    m["roughness"] = {b.roughness};
    m["metallic"] = {b.metallic};
    m["dielectric_specular"] = {b.dielectric_specular};
    m["shininess"] = {b.shininess};
    m["albedo_average"] = {b.albedo_average};
    m["split_sum_size"] = {b.split_sum_size};
    m["fresnel_edge"] = three(b.fresnel_edge);
    m["ior"] = {b.ior};
    m["eta"] = three(b.eta);
    m["k"] = three(b.k);
    m["subsurface"] = {b.subsurface};
    m["sheen"] = {b.sheen};
    m["specular_tint"] = {b.specular_tint};
    m["sheen_tint"] = {b.sheen_tint};
    m["clearcoat"] = {b.clearcoat};
    m["clearcoat_gloss"] = {b.clearcoat_gloss};
    in.textures["split_sum_table"] = study_texture(maps().split_sum_table);
    static const std::shared_ptr<const ImageData> measured = [] {
        auto table = std::make_shared<ImageData>();
        table->dim = ImageDim::d3;
        table->width = 182, table->height = 90, table->slices = 90;
        const auto* bytes = reinterpret_cast<const uint8_t*>(maps().merl.texels.data());
        table->texels.assign(bytes, bytes + maps().merl.texels.size() * sizeof(float));
        return table;
    }();
    in.textures["merl_table"] = {measured, SamplerState{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::off}};
    return in;
}

StudyPixel expected(const Values& values, const BrdfBlock& b) {
    return [axes = axes_named(values), b](const Vec2<Bounded>& uv) { return study_brdf(axes, b, maps(), uv); };
}

Values with(Values v, const char* axis, const char* value) {
    v[axis] = value;
    return v;
}

TEST(Study, EveryBrdf) {
    const std::vector<Values> variants = legal("library.yaml", "study_brdf");
    EXPECT_GT(variants.size(), 30u);
    for (const Values& v : variants) {
        const BrdfBlock b = block(v.at("parameters") == "pushed");
        // Where MERL measured is found by three arctangents, of which Vulkan promises eleven bits.
        const bool merl = v.at("model").rfind("merl", 0) == 0;
        hold_study("study_brdf", v, inputs(b), expected(v, b), merl ? 0.4 : 0.05);
    }
}

TEST(Study, WrongBrdfsAreCaught) {
    const auto plain = [] {
        Values v;
        for (const char* axis : {"model", "distribution", "visibility", "fresnel", "diffuse", "energy", "parameters"})
            v[axis] = "";
        v["model"] = "microfacets", v["distribution"] = "ggx", v["visibility"] = "height_correlated", v["fresnel"] = "schlick";
        v["diffuse"] = "none", v["energy"] = "single", v["parameters"] = "limited";
        return v;
    }();
    const BrdfBlock b = block(false);
    struct Wrong {
        Values values;
        const char *from, *to;
    };
    const Wrong all[] = {
        {with(plain, "visibility", "separable"), "return visibility_separable(", "return visibility_karis_ibl("},
        {with(plain, "fresnel", "f82"), "17.6513846", "15.0"},
        {with(plain, "energy", "scaled"), "saturate(dfg.x + dfg.y)", "saturate(dfg.x)"},
        {with(plain, "diffuse", "disney_renormalised"), "1.0 / 1.51", "1.0"},
        {with(plain, "model", "merl_nearest"), "ivec3(bin.z + 1, bin.y, bin.x)", "ivec3(bin.z + 1, bin.x, bin.y)"},
        {with(plain, "model", "merl_linear"), "merl_texel(table, ivec3(h, m.low.y, m.low.z))",
         "merl_texel(table, ivec3(0, m.low.y, m.low.z))"},
    };
    for (const Wrong& w : all)
        EXPECT_GT(hold_study("study_brdf", w.values, inputs(b), expected(w.values, b), 1, {{w.from, w.to}}).wrong, 500u) << w.to;
}

}  // namespace
}  // namespace kiln::test
