// Inputs are put right once, and the warning names them.

#include "uber/reference/sanitise.h"

#include <gtest/gtest.h>

#include <limits>

namespace kiln::reference {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

bool names(const Warnings& warnings, const std::string& text) {
    for (const std::string& w : warnings)
        if (w.find(text) != std::string::npos) return true;
    return false;
}

TEST(Sanitise, MaterialParametersAreLimitedOnceAndNamed) {
    const MaterialParameters good;
    Warnings warnings;
    const MaterialParameters same = sanitise("brick", good, warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(same.roughness_factor, good.roughness_factor);
    EXPECT_EQ(same.shininess, good.shininess);

    MaterialParameters bad;
    bad.base_factor = {nan, -1, 2};
    bad.specular_factor = {0.5, infinity, 0.5};
    bad.emissive = {-infinity, nan, 3e38};
    bad.dielectric_specular = nan;
    bad.shininess = 0;
    bad.roughness_factor = 3;
    bad.metallic_factor = -1;
    bad.glossiness_factor = -infinity;
    const MaterialParameters m = sanitise("brick", bad, warnings);
    EXPECT_EQ(warnings.size(), 8u);  // one an input, not one a component
    for (const char* input : {"base_factor", "specular_factor", "emissive", "dielectric_specular", "shininess",
                              "roughness_factor", "metallic_factor", "glossiness_factor"})
        EXPECT_TRUE(names(warnings, std::string("brick: ") + input)) << input;
    EXPECT_TRUE(names(warnings, "base_factor is not a number"));
    EXPECT_EQ(m.base_factor.x, 1);
    EXPECT_EQ(m.base_factor.y, 0);
    EXPECT_EQ(m.base_factor.z, 1);
    EXPECT_EQ(m.specular_factor.y, 1);
    EXPECT_EQ(m.emissive.x, 0);
    EXPECT_EQ(m.emissive.z, largest_intensity);
    EXPECT_EQ(m.dielectric_specular, 0.5);
    EXPECT_EQ(m.shininess, 1);
    EXPECT_EQ(m.roughness_factor, 1);
    EXPECT_EQ(m.metallic_factor, 0);
    EXPECT_EQ(m.glossiness_factor, 0);
    Warnings again;
    sanitise("brick", m, again);
    EXPECT_TRUE(again.empty()) << again.front();  // once is enough

    Warnings pushed;
    const MaterialParameters p = sanitise("brick", bad, pushed, true);
    EXPECT_EQ(p.roughness_factor, 3);
    EXPECT_EQ(p.metallic_factor, -1);
    EXPECT_EQ(p.base_factor.z, 2);
    EXPECT_FALSE(names(pushed, "roughness_factor"));
}

TEST(Sanitise, LightsHaveADirectionAndARange) {
    Warnings warnings;
    LightParameters light;
    light.direction = {0, 0, 0};
    light.range = 0;
    light.intensity = {std::numeric_limits<float>::max(), 1, nan};
    light.cos_inner = 1.5;
    const LightParameters l = sanitise("lamp", light, warnings);
    EXPECT_EQ(l.direction.y, -1);
    EXPECT_EQ(l.range, 1e-3);
    EXPECT_EQ(l.intensity.x, largest_intensity);
    EXPECT_EQ(l.intensity.z, 0);
    EXPECT_EQ(l.cos_inner, 1);
    EXPECT_EQ(warnings.size(), 4u);
    for (const char* input : {"direction", "range", "intensity", "cos_inner"})
        EXPECT_TRUE(names(warnings, std::string("lamp: ") + input)) << input;
    light = {};
    light.direction = {0, 3, 4};
    warnings.clear();
    EXPECT_EQ(sanitise("lamp", light, warnings).direction.z, 0.8);
    EXPECT_TRUE(warnings.empty());
}

TEST(Sanitise, MomentsThatNoLightHas) {
    Warnings warnings;
    const auto probe = [&](double m0, double x, double y, double z) {
        return sanitise("probe 7, red", ShMoments{m0, {x, y, z}}, warnings);
    };
    EXPECT_EQ(probe(2, 1, -1, 1).m1.y, -1);
    EXPECT_EQ(probe(1, 1, 0, 0).m1.x, 1);
    EXPECT_EQ(probe(0, 0, 0, 0).m0, 0);
    EXPECT_TRUE(warnings.empty());
    const ShMoments negative = probe(-0.5, 1, 0, 0);
    EXPECT_EQ(negative.m0, 0);
    EXPECT_EQ(negative.m1.x, 0);
    EXPECT_TRUE(names(warnings, "probe 7, red: negative light"));
    const ShMoments long_one = probe(1, 3, 0, 4);
    EXPECT_DOUBLE_EQ(long_one.m1.x, 0.6);
    EXPECT_DOUBLE_EQ(long_one.m1.z, 0.8);
    EXPECT_EQ(probe(0, 1, 0, 0).m1.x, 0);
    EXPECT_EQ(probe(1, nan, 0, 0).m0, 0);
    EXPECT_EQ(probe(infinity, 0, 0, 0).m0, 0);
    EXPECT_TRUE(names(warnings, "not finite"));
    EXPECT_EQ(warnings.size(), 5u);
    EXPECT_DOUBLE_EQ(probe(1e300, 3e300, 4e300, 0).m1.y, 0.8e300);
}

TEST(Sanitise, HdrImagesHoldNoInfinity) {
    Warnings warnings;
    HdrImage image{2, 2, 3, std::vector<float>(12, 1.0f)};
    EXPECT_EQ(sanitise("sky.hdr", image, warnings), "");
    EXPECT_TRUE(warnings.empty());
    image.texels[4] = static_cast<float>(infinity);
    image.texels[7] = static_cast<float>(nan);
    image.texels[8] = -1;
    image.texels[9] = 65505;
    EXPECT_EQ(sanitise("sky.hdr", image, warnings), "");
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(names(warnings, "sky.hdr: 4 of 12")) << warnings[0];
    EXPECT_TRUE(names(warnings, "(1, 0)")) << warnings[0];
    EXPECT_EQ(image.texels[4], 65504.0f);
    EXPECT_EQ(image.texels[7], 0.0f);
    EXPECT_EQ(image.texels[8], 0.0f);
    EXPECT_EQ(image.texels[9], 65504.0f);
    HdrImage none{0, 5, 3, {}};
    EXPECT_NE(sanitise("none.hdr", none, warnings).find("none.hdr"), std::string::npos);
    HdrImage torn{3, 3, 3, std::vector<float>(26)};
    EXPECT_NE(sanitise("torn.hdr", torn, warnings).find("26 values"), std::string::npos);
    HdrImage short_one{3, 3, 3, std::vector<float>(18)};
    EXPECT_NE(sanitise("short.hdr", short_one, warnings), "");
}

}  // namespace
}  // namespace kiln::reference
