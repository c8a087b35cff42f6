// Every pipeline of the shipped surface table against the renderer in double, pixel by pixel: with the renderer's own
// rasterisation, and once more, closer, with the inputs that the device's own vertex stage gives.

#include <cstdio>

#include "tests/device/glsl.h"
#include "tests/images/variants.h"

namespace kiln::test {
namespace {

bool directional(const Values& values) {
    const auto light = values.find("light");
    return light != values.end() && light->second == "directional";
}

// The worst of each comparison over many variants.
struct Totals {
    size_t pictures = 0, pixels = 0;
    double worst = 0, masked = 0, most = 0, relative = 0;
    void add(const Judged& j) {
        ++pictures;
        pixels += j.compared;
        worst = std::max(worst, j.worst);
        masked = std::max(masked, j.masked_share());
        most = std::max(most, j.most);
        relative = std::max(relative, j.relative);
    }
    void print(const std::string& what) const {
        std::printf(
            "KILN_IMAGES %s: %zu pictures, %zu pixels, worst error %.3g of the allowed, %.3g absolute, %.3g relative RMS; "
            "masked at most %.2f %%\n",
            what.c_str(), pictures, pixels, worst, most, relative, 100 * masked);
    }
};

TEST(Images, EveryVariantOfSurface) {
    const std::vector<Variant> variants = pipelines_of("surface.yaml");
    ASSERT_GT(variants.size(), 100u);
    std::map<bool, Points> reference;
    for (const bool sun : {false, true}) reference[sun] = visible_points(scene(sun, true));
    std::map<std::pair<bool, Words>, Points> drawn;
    std::map<std::string, Totals> own, given;
    for (const Variant& v : variants) {
        const bool sun = directional(v.values);
        const Scene &filtered = scene(sun, true), &plain = scene(sun, false);
        const std::vector<RunOutput> runs = draw(v.stages, {inputs_of(filtered), inputs_of(plain)});
        ASSERT_EQ(v.stages.front().stage, Stage::vertex);
        const auto key = std::pair{sun, v.stages.front().words};
        if (drawn.find(key) == drawn.end()) drawn[key] = drawn_points(v.stages.front(), inputs_of(plain), reference[sun]);
        const auto hold = [&](const Points& points, const Expect& expect, const RunOutput& run, const std::string& what,
                              std::map<std::string, Totals>& totals, const std::string& how, double most_masked) {
            const ReadBack* got = output(run, what);
            ASSERT_NE(got, nullptr) << v.name << " has no " << what;
            const Judged j = judge(points, expect, *got);
            EXPECT_EQ(j.wrong, 0u) << v.name << ", " << what << ", " << how << ": " << j.example;
            EXPECT_LT(j.masked_share(), most_masked) << v.name << ", " << what << ", " << how;
            EXPECT_GT(j.compared, 5000u) << v.name << ", " << what << ", " << how;
            totals[v.values.at("pass") + " " + what].add(j);
            show(how + " " + v.name + " " + what, points, expect, *got);
        };
        // Silhouettes are some 5 % of the covered pixels, the edges of shadows and of unfiltered texels as many again.
        for (const auto& [what, expect] : expectations(v.values, filtered))
            hold(reference[sun], expect, runs[0], what, own, "renderer", 0.15);
        for (const auto& [what, expect] : expectations(v.values, plain))
            if (what != "depth") hold(drawn[key], expect, runs[1], what, given, "shading", 0.10);
    }
    for (const auto& [group, totals] : own) totals.print(group + ", whole renderer");
    for (const auto& [group, totals] : given) totals.print(group + ", shading alone");
}

// The comparison has teeth: a shader that is wrong somewhere differs by more than rounding.
TEST(Images, WrongShadersAreCaught) {
    struct Wrong {
        const char *what, *from, *to;
        Values values;
    };
    const Values pbr = {{"light", "point"}, {"pass", "forward"}, {"material", "pbr_mr"}, {"two_sided", "true"}};
    const auto with = [](Values v, const std::string& axis, const std::string& value) {
        v[axis] = value;
        return v;
    };
    const Values blinn = with(pbr, "material", "blinn_phong"), sun = with(pbr, "light", "directional");
    const Wrong all[] = {
        {"alpha = roughness", "return r * r;", "return r;", pbr},
        {"the light's direction the wrong way round", "safe_normalize(-light_direction", "safe_normalize(light_direction", sun},
        {"no 1 / pi in the diffuse part", "passed * diffuse / pi", "passed * diffuse", pbr},
        {"a padded denominator", "0.5 / (v + l)", "0.5 / (v + l + 0.001)", pbr},
        {"pi with two decimals", "const float pi = 3.14159265358979;", "const float pi = 3.14;", pbr},
        {"average of Fresnel with 20", "/ 21.0", "/ 20.0", pbr},
        {"attenuation without its square", "window * window / max", "window / max", pbr},
        {"the fit of Blinn-Phong's factor",
         "return (shininess + 2.0) * (shininess + 4.0) / (8.0 * pi * (exp2(-0.5 * shininess) + "
         "shininess));",
         "return (shininess + 8.0) / (8.0 * pi);", blinn},
        {"a normal that does not turn", "return gl_FrontFacing ? n : -n;", "return n;", pbr},
        {"a flipped shadow map", "ndc.xy * 0.5 + 0.5", "ndc.xy * vec2(0.5, -0.5) + 0.5", with(sun, "shadow", "hard")},
        {"ratios over 127", "texel * 2.0 - 1.0", "texel * (255.0 / 127.0) - 1.0", with(pbr, "lightmap", "sh_hq")},
        {"first band with half its weight", "0.5 * (ratio_y", "0.25 * (ratio_y", with(pbr, "lightmap", "sh_lq")},
    };
    for (const Wrong& w : all) {
        const Scene& s = scene(directional(w.values), false);
        const Points reference = visible_points(s);
        const Expect expect = expectations(w.values, s).at("output 0");
        for (const bool wrong : {false, true}) {
            const Variant v = surface_variant(w.values, wrong ? std::vector{std::pair<std::string, std::string>{w.from, w.to}}
                                                              : std::vector<std::pair<std::string, std::string>>());
            const RunOutput run = draw(v.stages, {inputs_of(s)}).front();
            const ReadBack* got = output(run, "output 0");
            ASSERT_NE(got, nullptr);
            const Judged j = judge(drawn_points(v.stages.front(), inputs_of(s), reference), expect, *got);
            if (!wrong) {
                EXPECT_EQ(j.wrong, 0u) << w.what << ": " << j.example;
                continue;
            }
            // Some are wrong in a part of the picture only.
            EXPECT_GT(j.wrong, 100u) << w.what;
            std::printf("KILN_IMAGES %s: %zu of %zu pixels wrong\n", w.what, j.wrong, j.compared);
        }
    }
}

}  // namespace
}  // namespace kiln::test
