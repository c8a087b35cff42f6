// Shadow filters on the device over maps that are right, against closed forms; the lecture's forms failing as predicted; and
// all filters side by side over scenes whose visibility is known exactly.

#include <random>

#include "tests/functions/shadow_images.h"
#include "uber/reference/shadow_receiver.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr int size = 512;
const LightView view{2, 16, 2};
// Clip coordinates of p.xyz, the light's view space, for `view`.
const std::string clip_of_p = "vec4(p.xy, (16.0 / 14.0) * p.z - (32.0 / 14.0), p.z)";
const std::string place_of_p = "shadow_coordinates(" + clip_of_p + ").xyz";

std::vector<Sampled> maps_of(const ShadowScene& scene) {
    const std::shared_ptr<const ImageData> image = depth_texture(scene, view, size).image();
    return {{"sampler2D depth_map", image, nearest(false)}, {"sampler2DShadow shadow_map", image, nearest(true)}};
}

std::vector<Texel> across(double width, double receiver, int count = 400) {
    std::vector<Texel> at;
    for (int i = 0; i <= count; ++i)
        at.push_back({static_cast<float>((i / static_cast<double>(count) - 0.5) * 1.5 * width + 1e-5), 0.21f,
                      static_cast<float>(receiver), 0});
    return at;
}

double worst_off(const std::vector<Texel>& lit, const std::vector<Texel>& at, double w) {
    double worst = 0;
    for (size_t i = 0; i < at.size(); ++i)
        worst = std::max(worst, std::fabs(static_cast<double>(lit[i][0]) - square_light_edge(static_cast<double>(at[i][0]), w)));
    return worst;
}

TEST(ShadowFilters, PcfIsWithinHalfALevelOfTheRamp) {
    // The edge lies between two texels, so that a nearest comparison is that of an ideal map.
    const ShadowScene scene = edge_scene(6);
    const double w = edge_penumbra(10, 6, 1);
    const std::vector<Texel> at = across(w, 10);
    const std::string width = std::to_string(w / (view.extent * 10));
    for (const int n : {3, 5, 7}) {
        const std::vector<Texel> lit =
            evaluate(uber_text("lib/pcf.glsl") + uber_text("lib/shadow_receiver.glsl"),
                     "pcf_" + std::to_string(n) + "(shadow_map, " + place_of_p + ", vec2(0.0), 1e-5, vec2(" + width + "))", at,
                     maps_of(scene));
        const double worst = worst_off(lit, at, w);
        std::printf("KILN_SHADOW ramp pcf_%d %.6f of %.6f\n", n, worst, 0.5 / n);
        EXPECT_LE(worst, 0.5 / n + 1e-5);
        EXPECT_GE(worst, 0.5 / n - 0.01);
    }
}

TEST(ShadowFilters, PcssIsExactAlongAnEdgeAtEveryHeight) {
    for (const double blocker : {4.0, 6.0, 9.0})
        for (const int n : {16, 32, 64}) {
            const double w = edge_penumbra(10, blocker, 1);
            const std::vector<Texel> at = across(w, 10);
            const std::string taps =
                "#define PCSS_BLOCKER_TAPS " + std::to_string(n) + "\n#define PCSS_FILTER_TAPS " + std::to_string(n) + "\n";
            const std::vector<Texel> lit = evaluate(taps + uber_text("lib/pcss.glsl"),
                                                    "pcss_factor(depth_map, shadow_map, " + clip_of_p +
                                                        ", vec2(0.0), 1e-5, 1.0, 2.0, 16.0, 2.0, 1.0 / 512.0, vec2(0.0))",
                                                    at, maps_of(edge_scene(blocker)));
            const double worst = worst_off(lit, at, w);
            std::printf("KILN_SHADOW ramp pcss_%d at %.0f m %.6f of %.6f\n", n, blocker, worst, 0.5 / n);
            EXPECT_LE(worst, 0.5 / n + 1e-4) << blocker;
        }
}

TEST(ShadowFilters, PcssFollowsARoundLight) {
    // A chord crosses about 2 sqrt(n / pi) of n equal cells of the disk and misjudges half of each at worst.
    const ShadowScene scene = edge_scene(6);
    const double w = edge_penumbra(10, 6, 1);
    const std::vector<Texel> at = across(w, 10);
    for (const int n : {16, 64}) {
        const std::string taps = "#define PCSS_DISK_LIGHT 1\n#define PCSS_BLOCKER_TAPS " + std::to_string(n) +
                                 "\n#define PCSS_FILTER_TAPS " + std::to_string(n) + "\n";
        const std::vector<Texel> lit = evaluate(
            taps + uber_text("lib/pcss.glsl"),
            "pcss_factor(depth_map, shadow_map, " + clip_of_p + ", vec2(0.0), 1e-5, 1.0, 2.0, 16.0, 2.0, 1.0 / 512.0, vec2(0.0))",
            at, maps_of(scene));
        double worst = 0;
        for (size_t i = 0; i < at.size(); ++i)
            worst = std::max(worst,
                             std::fabs(static_cast<double>(lit[i][0]) - disk_light_edge(2 * static_cast<double>(at[i][0]) / w)));
        std::printf("KILN_SHADOW disk pcss_%d %.6f of %.6f\n", n, worst, std::sqrt(n / pi) / n);
        EXPECT_LE(worst, std::sqrt(n / pi) / n + 1e-4) << n;
    }
}

TEST(ShadowFilters, NoPlaneShadowsItself) {
    // Row 23. In the light's view space z = 10 + a x + b y, which is 10 / (1 - a X - b Y) along the ray (X, Y, 1).
    const LightView wide{2, 60, 2};
    std::mt19937 random(8);
    std::uniform_real_distribution<double> unit(-1, 1);
    uint64_t unbiased = 0, looked = 0;
    for (const auto& [a, b] : {std::pair{0.0, 0.0}, {0.5, 0.3}, {-0.7, 0.1}, {0.05, -0.4}})
        for (const bool d16 : {false, true}) {
            const auto z_of = [a = a, b = b](double x, double y) { return 10 / (1 - a * x - b * y); };
            std::vector<float> depths;
            std::vector<uint16_t> coarse;
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const double d = wide.depth(z_of(2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1));
                    depths.push_back(static_cast<float>(d));
                    coarse.push_back(static_cast<uint16_t>(std::lround(d * 65535)));
                }
            const auto image = image_of(d16 ? TexelFormat::d16_unorm : TexelFormat::d32_float, size, size,
                                        d16 ? bytes_of(coarse) : bytes_of(depths));
            image->depth = true;
            std::vector<Texel> at;
            for (int i = 0; i < 20'000; ++i) {
                const double x = 0.99 * unit(random), y = 0.99 * unit(random), z = z_of(x, y);
                at.push_back({static_cast<float>(x * z), static_cast<float>(y * z), static_cast<float>(z), 0});
            }
            // World plane (a, b, -1) . p + 10 = 0 over W = z: a X + b Y - 1 + 10 / z, and 1 / z = (1 - depth / f) / near.
            const double f = wide.far / (wide.far - wide.near);
            const auto number = [](double x) { return std::to_string(x); };
            const std::string plane = "vec4(" + number(a) + ", " + number(b) + ", " + number(-10 / (f * wide.near)) + ", " +
                                      number(10 / wide.near - 1) + ")";
            const std::string clip = "vec4(p.xy, (60.0 / 58.0) * p.z - (120.0 / 58.0), p.z)";
            const std::string quantum = d16 ? "1.0 / 65535.0" : "1.1920929e-7";
            const std::string text = uber_text("lib/shadow_map.glsl") + uber_text("lib/shadow_receiver.glsl");
            const SamplerState bilinear{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal};
            for (const auto& [sampler, reach] : {std::pair{nearest(true), "0.5 / 512.0"}, {bilinear, "1.0 / 512.0"}}) {
                const std::string bias =
                    "receiver_depth_bias(receiver_depth_slope(" + plane + ", 64.0), vec2(" + reach + "), " + quantum + ")";
                const std::vector<Texel> lit = evaluate(
                    text, "shadow_factor_2d(map, " + clip + ", " + bias + "), shadow_factor_2d(map, " + clip + ", 0.0), 0.0, 0.0",
                    at, {{"sampler2DShadow map", image, sampler}});
                uint64_t wrong = 0;
                for (const Texel& t : lit) wrong += t[0] != 1.0f, unbiased += t[1] != 1.0f;
                looked += lit.size();
                EXPECT_EQ(wrong, 0u) << a << ' ' << b << (d16 ? " D16" : " D32F");
            }
        }
    std::printf("KILN_SHADOW plane without a bias %.4f shadowed\n", static_cast<double>(unbiased) / static_cast<double>(looked));
    EXPECT_GT(unbiased, looked / 4);
}

TEST(ShadowFilters, LecturesFormsFailAsPredicted) {
    // An empty scene: the map holds the receiver's plane at 10 m and everything is lit.
    const ShadowScene open{{}, 10, 1, false};
    std::vector<Texel> at;
    for (int i = 0; i < 400; ++i) at.push_back({static_cast<float>(i % 20) - 9.5f, static_cast<float>(i / 20) - 9.5f, 10.0f, 0});
    const std::vector<Texel> lit = evaluate(
        uber_text("lib/lecture_shadow.glsl") + uber_text("lib/shadow_map.glsl"),
        "shadow_factor_lecture(depth_map, " + clip_of_p + "), shadow_factor_2d(shadow_map, " + clip_of_p + ", 2.4e-7), 0.0, 0.0",
        at, maps_of(open));
    for (const Texel& t : lit) {
        EXPECT_EQ(t[0], 0.0f);  // B5: all in shadow
        EXPECT_EQ(t[1], 1.0f);
    }
    // B32: huge, infinite, negative, not a number.
    const std::vector<Texel> cases{{10, 1e-3f, 1.5f, 0}, {10, 0, 1.5f, 0}, {5, 6, 1.5f, 0}, {0, 0, 0, 0}};
    const std::vector<Texel> width = evaluate(uber_text("lib/lecture_shadow.glsl") + uber_text("lib/pcss.glsl"),
                                              "pcss_penumbra_width_lecture(p.x, p.y, p.z), pcss_mean_blocker_lecture(p.x, p.y), "
                                              "pcss_penumbra_width(p.x, p.y, p.z, 0.01, 4.0), 0.0",
                                              cases);
    EXPECT_NEAR(static_cast<double>(width[0][0]), 14998.5, 0.02);
    EXPECT_TRUE(std::isinf(width[1][0]));
    EXPECT_LT(width[2][0], 0.0f);
    EXPECT_TRUE(std::isnan(width[3][1]));
    for (const Texel& t : width) EXPECT_TRUE(t[2] >= 0.01f && t[2] <= 4.0f);
    // Row 24: moments of 0.99 +- 1e-4 in fp16, whose quantum there is 2^-11; the variance is 1e-8.
    const std::vector<Texel> half = evaluate(uber_text("lib/lecture_shadow.glsl"),
                                             "moments_variance_lecture(unpackHalf2x16(packHalf2x16(0.5 * "
                                             "(shadow_moments_lecture(p.x) + shadow_moments_lecture(p.y)))))",
                                             {{0.9899f, 0.9901f, 0, 0}});
    EXPECT_NEAR(static_cast<double>(half[0][0]), 2007 * 0x1p-11 - 2028 * 2028 * 0x1p-22, 1e-7);  // -5.8e-4
    // 5 taps of a plane near depth 1.
    std::mt19937 random(9);
    std::uniform_real_distribution<float> depth(0.95f, 0.999f), slope(-1e-5f, 1e-5f);
    std::vector<Texel> planes;
    for (int i = 0; i < 10'000; ++i) planes.push_back({depth(random), slope(random), 0, 0});
    const std::vector<Texel> variance = evaluate(
        uber_text("lib/lecture_shadow.glsl") + uber_text("lib/vsm.glsl") +
            "vec4 both(vec4 p) {\n    vec2 plain = vec2(0.0), centred = vec2(0.0);\n    for (int k = -2; k <= 2; ++k) {\n"
            "        plain += shadow_moments_lecture(p.x + p.y * float(k)) / 5.0;\n"
            "        centred += shadow_moments(p.x + p.y * float(k), 1.0, 0.97) / 5.0;\n    }\n"
            "    return vec4(moments_variance_lecture(plain), chebyshev_lecture(plain, plain.x), moments_variance(centred, "
            "1e-9),\n"
            "                chebyshev_upper_bound(centred, p.x - 0.97, 1e-9));\n}\n",
        "both(p)", planes);
    int negative = 0;
    for (const Texel& t : variance) {
        negative += t[0] < 0.0f ? 1 : 0;
        EXPECT_TRUE(t[2] >= 1e-9f && t[3] >= 0.0f && t[3] <= 1.0f);
    }
    std::printf("KILN_SHADOW variance of planar taps negative in %.3f\n", negative / 1e4);
    EXPECT_GT(negative, 2'500);
}

struct Errors {
    double penumbra = 0, outside = 0;
};

TEST(ShadowFilters, SideBySide) {
    struct Scene {
        const char* name;
        ShadowScene scene;
    };
    const std::string box = std::to_string(edge_penumbra(10, 6, 1) / (view.extent * 10));  // right for a blocker at 6 m only
    const std::string half_box = "vec2(0.5 * " + box + ")";
    struct Kind {
        std::string name, expression, text;
    };
    std::vector<Kind> kinds{{"hard", "shadow_factor_2d(shadow_map, " + clip_of_p + ", 1e-5)", uber_text("lib/shadow_map.glsl")}};
    const std::string pcf = uber_text("lib/pcf.glsl") + uber_text("lib/shadow_receiver.glsl");
    for (const char* n : {"3", "5", "7"})
        kinds.push_back({std::string("pcf_") + n,
                         std::string("pcf_") + n + "(shadow_map, " + place_of_p + ", vec2(0.0), 1e-5, vec2(" + box + "))", pcf});
    for (const char* n : {"16", "32"})
        kinds.push_back({std::string("poisson_") + n,
                         std::string("pcf_poisson_") + n + "(shadow_map, " + place_of_p + ", vec2(0.0), 1e-5, " + half_box +
                             ", pixel_hash(uvec2(i, 0u)))",
                         pcf});
    kinds.push_back({"vsm", "vsm_factor(sat_average(sat, " + place_of_p + ".xy, vec2(" + box + ")), p.z, 16.0, 0.5, 1e-6, 0.0)",
                     uber_text("lib/vsm.glsl")});
    kinds.push_back({"vssm", "vssm_factor(sat, " + clip_of_p + ", 1.0, 2.0, 16.0, 2.0, 1.0 / 512.0, 0.5, 1e-6, 0.0)",
                     uber_text("lib/vsm.glsl")});
    kinds.push_back({"vssm_mips",
                     "vssm_factor_mips(chain, 10.0, " + clip_of_p + ", 1.0, 2.0, 16.0, 2.0, 1.0 / 512.0, 0.5, 1e-6, 0.0)",
                     uber_text("lib/vsm.glsl")});
    for (const char* n : {"16", "32", "64"})
        kinds.push_back({std::string("pcss_") + n,
                         "pcss_factor(depth_map, shadow_map, " + clip_of_p +
                             ", vec2(0.0), 1e-5, 1.0, 2.0, 16.0, 2.0, 1.0 / 512.0, vec2(0.0))",
                         std::string("#define PCSS_BLOCKER_TAPS ") + n + "\n#define PCSS_FILTER_TAPS " + n + "\n" +
                             uber_text("lib/pcss.glsl")});
    std::map<std::string, std::map<std::string, Errors>> all;
    for (const Scene& s : {Scene{"edge_6", edge_scene(6)},
                           {"square_3", square_scene(3)},
                           {"square_6", square_scene(6)},
                           {"square_9", square_scene(9)},
                           {"stacked", stacked_scene()},
                           {"fence", fence_scene()}}) {
        std::vector<Texel> at;
        std::vector<double> truth;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                at.push_back({static_cast<float>((x + 0.37) / 8 - 4), static_cast<float>((y + 0.61) / 8 - 4), 10.0f, 0});
                truth.push_back(visible_share(s.scene, static_cast<double>(at.back()[0]), static_cast<double>(at.back()[1])));
            }
        std::vector<Sampled> textures = maps_of(s.scene);
        const MomentMap moments = moment_map(distance_map(s.scene, view, size), size, view.far, 0.5);
        textures.push_back(
            {"sampler2D sat", moments_image(table_by_device(floats_of(moments), size, size), size), nearest(false)});
        textures.push_back({"sampler2D chain", moments_image(mips_by_device(floats_of(moments), size), size, 10),
                            SamplerState{Filter::linear, MipFilter::linear, Wrap::clamp, Comparison::off}});
        for (const Kind& kind : kinds) {
            std::vector<Sampled> used;
            for (const Sampled& t : textures)
                if (kind.expression.find(t.declaration.substr(t.declaration.find(' ') + 1)) != std::string::npos)
                    used.push_back(t);
            const std::vector<Texel> lit = evaluate(kind.text, kind.expression, at, used);
            double sums[2]{};
            int counts[2]{};
            for (size_t i = 0; i < at.size(); ++i) {
                const double e = static_cast<double>(lit[i][0]) - truth[i];
                ASSERT_TRUE(lit[i][0] >= 0.0f && lit[i][0] <= 1.0f) << kind.name;
                const int part = truth[i] > 0 && truth[i] < 1 ? 0 : 1;
                sums[part] += e * e, ++counts[part];
            }
            const auto root = [&](int part) { return counts[part] > 0 ? std::sqrt(sums[part] / counts[part]) : 0; };
            all[s.name][kind.name] = {root(0), root(1)};
            std::printf("KILN_SHADOW %s %s penumbra %.4f outside %.4f\n", s.name, kind.name.c_str(), root(0), root(1));
        }
    }
    // PCSS's edge is displaced by up to half a texel, and its model leaves corners; a hard edge is worst wherever the penumbra
    // is wider than texels.
    for (const auto& [scene, blocker] : {std::pair{"edge_6", 6}, {"square_3", 3}, {"square_6", 6}, {"square_9", 9}}) {
        const double texels = edge_penumbra(10, blocker, 1) / (view.extent * 10) * size;
        EXPECT_LT(all[scene]["pcss_64"].penumbra, 0.5 / texels + 0.03) << scene;
        if (texels > 4) {
            EXPECT_LT(all[scene]["pcss_64"].penumbra, all[scene]["hard"].penumbra / 2) << scene;
        }
    }
    // A filter of one width is right at one distance.
    EXPECT_LT(all["square_6"]["pcf_7"].penumbra, all["square_3"]["pcf_7"].penumbra);
    // Under two blockers nothing is lit: taps say so, moments bleed.
    EXPECT_LT(all["stacked"]["pcss_64"].outside, 1e-6);
    EXPECT_GT(all["stacked"]["vssm"].outside, 0.05);
    EXPECT_GT(all["stacked"]["vsm"].outside, 0.05);
    EXPECT_GT(all["stacked"]["vssm_mips"].outside, 0.05);
    // Trilinear texels are no box: at a corner they are worse than the table, and still better than one comparison.
    EXPECT_GT(all["square_6"]["vssm_mips"].penumbra, all["square_6"]["vssm"].penumbra);
    for (const char* scene : {"edge_6", "square_3", "square_6", "square_9"})
        EXPECT_LT(all[scene]["vssm_mips"].penumbra, all[scene]["hard"].penumbra) << scene;
}

}  // namespace
}  // namespace kiln::test
