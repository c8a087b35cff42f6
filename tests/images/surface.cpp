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

// What share of a picture may be left out. Silhouettes are 5.5 % of it.
// Shading alone has the device's own places: the edges of shadows and of unfiltered texels are as many again at most. VSSM's
// table is read at the ends of boxes whose widths its own sums say: moments are small differences of sums up to 2^8, and a
// width that may be its least or none is a close decision, so that the bound says little of a third of the picture.
// The whole renderer knows a place within 1/256 of a pixel. Variance, a difference of moments whose errors the bound takes for
// independent, loses a fifth of the picture; each of PCSS's 64 taps may be close, together a fifth as well; and a mirror that
// a normal map bends crosses more corners of cube maps, where three faces meet.
double most_masked(const reference::SurfaceAxes& axes, bool whole) {
    using reference::SurfaceShadow;
    if (!whole) return axes.shadow == SurfaceShadow::vssm ? 0.4 : 0.1;
    const double bent = axes.reflection != reference::SurfaceReflection::none && axes.normal_map ? 0.1 : 0;
    return bent + (axes.shadow == SurfaceShadow::pcss ? 0.3 : axes.shadow == SurfaceShadow::vsm ? 0.25 : 0.15);
}

// VSSM with a place that is not exact: nearly every box may begin in one texel or the next, which is a close decision in 68 % of
// the picture. Shading alone compares it.
bool wants_exact_place(const reference::SurfaceAxes& axes) { return axes.shadow == reference::SurfaceShadow::vssm; }

// Draws variants and holds them against the renderer; additive: they are the light alone.
class Comparison {
public:
    void hold(const Variant& v, bool additive = false) {
        const bool sun = directional(v.values);
        const reference::SurfaceAxes axes = axes_of(v.values);
        const Scene &filtered = scene(sun, true), &plain = scene(sun, false);
        const std::string pass = v.values.count("pass") != 0 ? v.values.at("pass") : "forward";
        const bool holes = axes.alpha_test && (pass == "depth" || pass == "velocity");
        const std::vector<RunOutput> runs = draw(v.stages, {inputs_of(filtered, axes), inputs_of(plain, axes)});
        ASSERT_EQ(v.stages.front().stage, Stage::vertex);
        for (const auto& [what, expect] : expectations(v.values, filtered, additive)) {
            if (wants_exact_place(axes) && what != "depth") continue;
            one(v, reference(sun, holes), expect, runs[0], what, own_[pass + " " + what], "renderer", most_masked(axes, true));
        }
        // The device's varyings are of what is nearest, not of what is seen through a hole.
        if (holes) return;
        for (const auto& [what, expect] : expectations(v.values, plain, additive))
            if (what != "depth")
                one(v, drawn(v.stages.front(), sun), expect, runs[1], what, given_[pass + " " + what], "shading",
                    most_masked(axes, false));
    }
    void print() const {
        for (const auto& [group, totals] : own_) totals.print(group + ", whole renderer");
        for (const auto& [group, totals] : given_) totals.print(group + ", shading alone");
    }

private:
    static void one(const Variant& v, const Points& points, const Expect& expect, const RunOutput& run, const std::string& what,
                    Totals& totals, const std::string& how, double masked) {
        const ReadBack* got = output(run, what);
        ASSERT_NE(got, nullptr) << v.name << " has no " << what;
        const Judged j = judge(points, expect, *got);
        EXPECT_EQ(j.wrong, 0u) << v.name << ", " << what << ", " << how << ": " << j.example;
        EXPECT_LT(j.masked_share(), masked) << v.name << ", " << what << ", " << how << ": " << j.silhouettes << " silhouettes, "
                                            << j.close << " close decisions, " << j.loose << " loose bounds";
        EXPECT_GT(j.compared, 4000u) << v.name << ", " << what << ", " << how;
        totals.add(j);
        show(how + " " + v.name + " " + what, points, expect, *got);
    }
    const Points& reference(bool sun, bool holes) {
        Points& p = reference_[{sun, holes}];
        if (p.size == 0) p = visible_points(scene(sun, true), picture_size, holes);
        return p;
    }
    const Points& drawn(const StageCode& vertex, bool sun) {
        Points& p = drawn_[{sun, vertex.words}];
        if (p.size == 0) p = drawn_points(vertex, inputs_of(scene(sun, false)), reference(sun, false));
        return p;
    }
    std::map<std::pair<bool, bool>, Points> reference_;
    std::map<std::pair<bool, Words>, Points> drawn_;
    std::map<std::string, Totals> own_, given_;
};

TEST(Images, EveryVariantOfSurface) {
    const std::vector<Variant> variants = pipelines_of("surface.yaml");
    ASSERT_GT(variants.size(), 100u);
    Comparison comparison;
    for (const Variant& v : variants) comparison.hold(v);
    comparison.print();
}

// The renderer's manifest has more variants than can be drawn: all pairs of axis values.
TEST(Images, PairsOfTheRenderersAxes) {
    Comparison comparison;
    for (const char* shader : {"surface", "surface_local", "surface_lecture"}) {
        const std::vector<Values> variants = pairwise("renderer.yaml", shader, 7);
        std::printf("KILN_IMAGES %s: %zu variants\n", shader, variants.size());
        EXPECT_GT(variants.size(), 3u);
        for (const Values& v : variants)
            comparison.hold(variant_of("renderer.yaml", shader, v), shader == std::string("surface_local"));
    }
    comparison.print();
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
        {"a shadow's offset by the sine to a point light", "cube_axis_cosine(away, n, shadow_texel)", "dot(n, l)",
         with(pbr, "shadow", "hard")},
        {"a layer's receiver offset by another's texels", "dot(n, l), cascade_texel[next])", "dot(n, l), cascade_texel[own])",
         with(with(sun, "shadow", "hard"), "cascades", "4")},
        {"ratios over 127", "texel * 2.0 - 1.0", "texel * (255.0 / 127.0) - 1.0", with(pbr, "lightmap", "sh_hq")},
        {"a receiver's plane by the normal map", "light_visibility(world_position, geometric_normal(), l)",
         "light_visibility(world_position, n, l)", with(with(sun, "shadow", "pcf5"), "normal_map", "true")},
        {"the blocker's share of a filter's taps", "/ float(n * n)", "/ float(n * n + 1)", with(sun, "shadow", "pcf3")},
        {"a mirror the wrong way round", "2.0 * dot(n, v) * n - v", "v - 2.0 * dot(n, v) * n", with(pbr, "ibl", "split_sum")},
        {"probes without the weights' second half", "weights.high[i - 4]", "weights.low[i - 4]", with(pbr, "probes", "sh_l2")},
        {"first band with half its weight", "0.5 * (ratio_y", "0.25 * (ratio_y", with(pbr, "lightmap", "sh_lq")},
    };
    for (const Wrong& w : all) {
        const Scene& s = scene(directional(w.values), false);
        const Points reference = visible_points(s);
        const Expect expect = expectations(w.values, s).at("output 0");
        for (const bool wrong : {false, true}) {
            const Variant v = variant_of("renderer.yaml", "surface", w.values, wrong ? Edits{{w.from, w.to}} : Edits());
            const RunOutput run = draw(v.stages, {inputs_of(s, axes_of(w.values))}).front();
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
