// Rows 21 to 27: receivers outside the map, moments without variance, penumbrae without a blocker, cascades at their ends.
// What whole maps and planes show is in tests/functions (shadow_filters.cpp, shadow_tables.cpp, cascades.cpp).

#include <cmath>

#include "tests/stability/raw.h"
#include "uber/reference/half.h"

namespace kiln::test {
namespace {

const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

// A square map of one depth, as it is and by comparison; layered for cascades.
std::shared_ptr<ImageData> flat(float depth, uint32_t layers = 0) {
    auto image = image_of(TexelFormat::d32_float, 4, 4, bytes_of(std::vector<float>(16 * std::max(layers, 1u), depth)));
    image->depth = true;
    image->arrayed = layers > 0;
    image->layers = std::max(layers, 1u);
    return image;
}
const SamplerState compares{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal};
const SamplerState reads{Filter::nearest, MipFilter::none, Wrap::clamp, Comparison::off};

// Every look-up of the library at the clip position x[0..3] in a map of 0.25, whose moments are those of a distance of 0.25 far.
Shader every_lookup() {
    Shader s{
        {"shadow_map.glsl", "shadow_receiver.glsl", "pcf.glsl", "pcss.glsl", "vsm.glsl", "cascades.glsl", "lecture_shadow.glsl"},
        "vec4 clip() { return vec4(x[0], x[1], x[2], x[3]); }\n",
        "",
        {}};
    std::vector<float> moments;
    for (int y = 1; y <= 4; ++y)
        for (int x = 1; x <= 4; ++x) {
            const float q = -0.25f * static_cast<float>(x * y);
            moments.insert(moments.end(), {q, -0.25f * q});
        }
    s.textures = {{"sampler2DShadow map", {"map", flat(0.25f), compares}},
                  {"sampler2D depths", {"depths", flat(0.25f), reads}},
                  {"sampler2DArrayShadow layers", {"layers", flat(0.25f, 4), compares}},
                  {"sampler2D sat", {"sat", image_of(TexelFormat::rg32_float, 4, 4, bytes_of(moments)), reads}}};
    return s;
}
const std::vector<Expression> lookups{
    {"hard", "shadow_factor_2d(map, clip(), 1e-5)"},
    {"pcf",
     "vec4 p = shadow_coordinates(clip()); result = vec4(p.w == 0.0 ? 1.0 : pcf_5(map, p.xyz, vec2(0.0), 1e-5, vec2(0.1)));"},
    {"poisson",
     "vec4 p = shadow_coordinates(clip()); result = vec4(p.w == 0.0 ? 1.0 : pcf_poisson_16(map, p.xyz, vec2(0.0), 1e-5, "
     "vec2(0.1), 0.3));"},
    {"pcss", "pcss_factor(depths, map, clip(), vec2(0.0), 1e-5, 0.5, 1.0, 16.0, 2.0, 0.25, vec2(0.0))"},
    {"pcss directional", "pcss_factor_directional(depths, map, clip(), vec2(0.0), 1e-5, 0.05, 16.0, 2.0, 0.25, vec2(0.0))"},
    {"vssm", "vssm_factor(sat, clip(), 0.5, 1.0, 16.0, 2.0, 0.25, 0.5, 1e-6, 0.0)"},
    {"cascade", "cascade_factor(layers, clip(), 1, 1e-5)"},
    {"cascades", "cascaded_shadow(layers, clip(), clip(), vec2(1e-5), CascadeChoice(0, 1, 0.5))"},
    {"vssm of mips", "vssm_factor_mips(sat, 1.0, clip(), 0.5, 1.0, 16.0, 2.0, 0.25, 0.5, 1e-6, 0.0)"}};

TEST(Stability, Row21_ReceiversBehindTheLight) {
    std::vector<Sample> samples;
    for (const float w : neighbourhood({-1e30f, -1, -1e-20f, 0}))
        if (w <= 0)
            for (const float x : {-2.0f, -0.3f, 0.0f, 0.3f, 1e30f})
                for (const float z : {-1.0f, 0.0f, 0.5f, 2.0f}) samples.push_back({x, 0.2f, z, w});
    for (const Raw& r : raw(every_lookup(), samples, lookups)) {
        expect_finite(r, samples);
        expect_each(
            r, samples, [](const Raw& q, size_t i) { return q.at(i) == 1; }, "not lit behind the light");
    }
    // As printed: mirrored there, and shadowed by what is before the light; at w = 0 whatever inf and NaN compare to.
    const std::vector<Sample> at{{0, 0, -0.5f, -1}, {0, 0, 0, 0}};
    for (const Raw& r :
         raw(every_lookup(), at,
             {{"lecture", "vec2(shadow_factor_unbiased_lecture(depths, clip()), shadow_factor_lecture(depths, clip()))"},
              {"coordinates", "clip().xyz / clip().w"}})) {
        if (r.name[0] == 'l') {
            EXPECT_EQ(r.at(0), 0.0) << r.name << ": in shadow of what is on the other side";
            EXPECT_EQ(r.at(1), 1.0) << r.name << ": 0 / 0 compares false";
        } else {
            EXPECT_TRUE(std::isnan(r.at(1))) << r.name;
        }
    }
}

TEST(Stability, Row22_ReceiversOutsideTheMap) {
    std::vector<Sample> samples;
    for (const float x : neighbourhood({-1e30f, -1.5f, -1, 0, 1, 1.5f, 1e30f}))
        for (const float y : {-1.25f, -1.0f, 0.1f, 1.0f, 1.25f})
            for (const float z : neighbourhood({-1e30f, -0.5f, 0, 0.1f, 0.2f, 0.3f, 1, 1.5f, 1e30f}))
                samples.push_back({x, y, z, 1});
    for (const float bad : {nan, infinity, -infinity}) samples.push_back({bad, 0, 0.5f, 1});
    std::vector<Expression> hard{lookups[0], lookups[6], lookups[7]};
    for (const Raw& r : raw(every_lookup(), samples, hard)) {
        EXPECT_EQ(r.non_finite(), 0u) << r.name;
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const Sample& s = samples[i];
                // u = x / 2 + 1/2 rounds: next to 1 either answer is that of a float beside it.
                if (std::fabs(std::fabs(s[0]) - 1) < 2e-7f || std::fabs(std::fabs(s[1]) - 1) < 2e-7f)
                    return q.at(i) == 0 || q.at(i) == 1;
                const bool inside = std::fabs(s[0]) <= 1 && std::fabs(s[1]) <= 1 && s[2] >= 0 && s[2] <= 1;
                return q.at(i) == (inside && s[2] > 0.25f ? 0 : 1);
            },
            "not the analytic answer");
    }
    std::vector<Expression> soft{lookups.begin() + 1, lookups.begin() + 6};
    soft.push_back(lookups.back());
    for (const Raw& r : raw(every_lookup(), samples, soft)) {
        EXPECT_EQ(r.non_finite(), 0u) << r.name;
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const Sample& s = samples[i];
                const bool outside = !(std::fabs(s[0]) <= 1.0000002f && std::fabs(s[1]) <= 1.0000002f && s[2] >= 0 && s[2] <= 1);
                return q.at(i) >= 0 && q.at(i) <= 1 && (!outside || q.at(i) == 1);
            },
            "outside [0, 1], or not lit outside the map");
    }
    // As printed the edge texel repeats for ever, and everything beyond the far plane is in shadow.
    for (const Raw& r : raw(every_lookup(), {{5, 5, 0.5f, 1}, {0, 0, 1.5f, 1}},
                            {{"lecture", "shadow_factor_unbiased_lecture(depths, clip())"}, lookups[0]}))
        for (size_t i = 0; i < 2; ++i) EXPECT_EQ(r.at(i), r.name[0] == 'l' ? 0.0 : 1.0) << r.name;
}

TEST(Stability, Row23_ReceiverIsTheBlocker) {
    // A plane's own depth from its own map: (z w) / w against z, in fp32. Without a bias some points shadow themselves.
    Directions directions(23);
    std::vector<Sample> samples;
    for (int k = 0; k < 100'000; ++k)
        samples.push_back(
            {static_cast<float>(directions.uniform(0, 1)), static_cast<float>(std::pow(2.0, directions.uniform(0, 7)))});
    for (const Raw& r :
         raw({{"shadow_receiver.glsl"}, "", "", {}}, samples,
             {{"lecture", "precise float zw = x[0] * x[1]; precise float z = zw / x[1]; result = vec4(x[0] < z ? 1.0 : 0.0);"},
              {"biased",
               "precise float zw = x[0] * x[1]; precise float z = zw / x[1]; result = vec4(x[0] < z - "
               "receiver_depth_bias(vec2(0.0), vec2(0.0), 1.1920929e-7) ? 1.0 : 0.0);"}})) {
        double shadowed = 0;
        for (size_t i = 0; i < samples.size(); ++i) shadowed += r.at(i) / static_cast<double>(samples.size());
        std::printf("KILN_ROW 23 %s shadowed %.4f\n", r.name.c_str(), shadowed);
        if (r.name[0] == 'l') {
            EXPECT_GT(shadowed, 0.02) << r.name;  // 5.46 % with this spread of z and w
            EXPECT_LT(shadowed, 0.15) << r.name;
        } else {
            EXPECT_EQ(shadowed, 0.0) << r.name;
        }
    }
}

TEST(Stability, Row24_VarianceOfMoments) {
    // A filter of 64 taps over two depths x[0] - x[1] and x[0] + x[1], whose variance is x[1]^2; x[2]: the reference.
    Directions directions(24);
    std::vector<Sample> at;
    for (int k = 0; k < 1000; ++k) {
        const double middle = k % 2 == 0 ? directions.uniform(0.98, 0.999) : directions.uniform(0.85, 0.95);
        at.push_back({static_cast<float>(middle), k % 2 == 0 ? 1e-4f : 1e-3f, static_cast<float>(middle + 1e-3)});
    }
    const auto filter = [](const std::string& moments, const std::string& variance) {
        return "vec2 m = vec2(0.0); for (int k = 0; k < 64; ++k) { float z = k % 2 == 0 ? x[0] - x[1] : x[0] + x[1]; m += " +
               moments + " / 64.0; } result = vec4(" + variance + ");";
    };
    for (const Raw& r : raw({{"vsm.glsl", "lecture_shadow.glsl"}, "", "", {}}, at,
                            {{"lecture", filter("shadow_moments_lecture(z)", "moments_variance_lecture(m)")},
                             {"centred", filter("shadow_moments(z, 1.0, x[2])", "moments_variance(m, 1e-9)")}})) {
        int negative = 0;
        double lowest = 0, worst = 0;
        for (size_t i = 0; i < at.size(); ++i) {
            const float low = at[i][0] - at[i][1], high = at[i][0] + at[i][1];
            const double half = (static_cast<double>(high) - static_cast<double>(low)) / 2, exact = half * half;
            if (i % 2 == 0) negative += r.at(i) < 0 ? 1 : 0, lowest = std::min(lowest, r.at(i));
            if (i % 2 == 1 || r.name[0] == 'c') worst = std::max(worst, std::fabs(r.at(i) / exact - 1));
        }
        std::printf("KILN_ROW 24 %s negative %.3f lowest %.3g relative %.3g\n", r.name.c_str(), negative / 500.0, lowest, worst);
        if (r.name[0] == 'c') {
            EXPECT_EQ(negative, 0) << r.name;
            EXPECT_LE(worst, 1e-3) << r.name;
        } else {
            EXPECT_GT(negative, 100) << r.name;
            EXPECT_LT(lowest, -2e-7) << r.name;
            EXPECT_GT(worst, 0.3) << r.name << " at a deviation of 1e-3";
        }
    }
    // Any moments at all, consistent or not: a variance of at least the least, a share in [0, 1].
    std::vector<Sample> samples;
    const std::vector<float> means = neighbourhood({-1, -0.5f, 0, 1e-20f, 0.5f, 1}),
                             squares = neighbourhood({-1, 0, 1e-9f, 0.25f, 1});
    for (const float m : means)
        for (const float s : squares)
            for (const float t : {-1.0f, m, std::nextafter(m, 2.0f), 0.25f, 1.0f}) samples.push_back({m, s, t});
    for (const Raw& r : raw({{"vsm.glsl"}, "", "", {}}, samples,
                            {{"variance", "moments_variance(u2(0), 1e-9)"},
                             {"bound", "chebyshev_upper_bound(u2(0), x[2], 1e-9)"},
                             {"less bleeding", "reduce_light_bleeding(chebyshev_upper_bound(u2(0), x[2], 1e-9), 0.3)"}})) {
        expect_finite(r, samples);
        const double least = static_cast<double>(1e-9f);
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) { return r.name[0] == 'v' ? q.at(i) >= least : q.at(i) >= 0 && q.at(i) <= 1; },
            "below the least variance, or no share");
    }
    // Never in half precision: its quantum at 1 is a variance of 5e-4.
    using reference::Half;
    const Half low(0.9899f), high(0.9901f), mean = Half(0.5f) * (low + high);
    EXPECT_LT(reference::value(Half(0.5f) * (low * low + high * high) - mean * mean), 1e-7);
}

TEST(Stability, Row25_VssmWithoutBlockers) {
    // p -> 1, no variance, t = mean.
    std::vector<Sample> samples;
    for (const float m : neighbourhood({-0.5f, 0, 0.25f}))
        for (const float lit : neighbourhood({0, 0.5f, 0.999f, 1}))
            for (const float t : {m, std::nextafter(m, 1.0f), m + 1e-4f, m + 0.25f}) samples.push_back({m, m * m, t, lit});
    for (const Raw& r : raw({{"vsm.glsl"}, "", "", {}}, samples,
                            {{"blocker", "vssm_blocker(u2(0), x[2], x[3])"},
                             {"bound", "chebyshev_upper_bound(u2(0), x[2], 1e-9)"},
                             {"factor", "vsm_factor(u2(0), x[2] + 0.5, 1.0, 0.5, 1e-9, 0.2)"}})) {
        expect_finite(r, samples);
        if (r.name[1] == 'o')  // bound
            expect_each(
                r, samples, [&](const Raw& q, size_t i) { return samples[i][2] > samples[i][0] || q.at(i) == 1; },
                "t at the mean is not lit");
    }
    for (const Raw& r :
         raw({{"lecture_shadow.glsl"}, "", "", {}}, {{0.5f, 0.25f, 0.5f, 1}},
             {{"lecture", "chebyshev_lecture(u2(0), x[2])"}, {"mean blocker", "(x[0] - x[3] * x[2]) / (1.0 - x[3])"}}))
        EXPECT_TRUE(std::isnan(r.at(0))) << r.name << " " << r.at(0);
}

TEST(Stability, Row26_PcssWithoutBlockers) {
    const std::vector<float> distances = neighbourhood({0, 1e-40f, 1e-20f, 1e-6f, 1e-3f, 1, 10, 1e6f});
    std::vector<Sample> samples;
    for (const float receiver : distances)
        for (const float blocker : distances)
            for (const float size : {0.0f, 1.5f, 100.0f})
                if (receiver >= 0 && blocker >= 0) samples.push_back({receiver, blocker, size});
    for (const Raw& r : raw({{"pcss.glsl"}, "", "", {}}, samples,
                            {{"width", "pcss_penumbra_width(x[0], x[1], x[2], 0.01, 4.0)"},
                             {"directional", "pcss_penumbra_width_directional(x[0], x[1], x[2], 0.01, 4.0)"},
                             {"search", "pcss_search_width(x[0], 0.1, x[2])"},
                             {"distance", "light_distance(min(x[0], 1.0), 0.1, 1000.0)"}})) {
        expect_finite(r, samples);
        const bool width = r.name[0] == 'w' || r.name.find("directional") == 0;
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) { return width ? q.at(i) >= static_cast<double>(0.01f) && q.at(i) <= 4 : q.at(i) >= 0; },
            "out of its limits");
    }
    // Maps that hold nothing, all, or the near plane itself, from every receiver and for every size of the light.
    for (const float depth : {0.0f, 1e-20f, 0.5f, 1.0f}) {
        Shader shader = every_lookup();
        for (auto& t : shader.textures)
            if (t.second.name != "sat") t.second.image = flat(depth, t.second.name == "layers" ? 4 : 0);
        std::vector<Sample> receivers;
        for (const float w : neighbourhood({1e-20f, 0.5f, 1, 4, 16, 1e6f}))
            for (const float size : {0.0f, 0.5f, 100.0f})
                receivers.push_back({0.1f * w, 0.1f * w, (16.0f / 15.0f) * (w - 1), w, size});
        for (const Raw& r :
             raw(shader, receivers,
                 {{"pcss", "pcss_factor(depths, map, clip(), vec2(0.0), 1e-5, x[4], 1.0, 16.0, 2.0, 0.25, vec2(0.0))"},
                  {"directional",
                   "pcss_factor_directional(depths, map, clip(), vec2(0.0), 1e-5, x[4], 16.0, 2.0, 0.25, vec2(0.0))"},
                  {"vssm", "vssm_factor(sat, clip(), x[4], 1.0, 16.0, 2.0, 0.25, 0.5, 1e-6, 0.0)"},
                  {"vssm of mips", "vssm_factor_mips(sat, 1.0, clip(), x[4], 1.0, 16.0, 2.0, 0.25, 0.5, 1e-6, 0.0)"}})) {
            expect_finite(r, receivers);
            expect_each(
                r, receivers,
                [&](const Raw& q, size_t i) {
                    return q.at(i) >= 0 && q.at(i) <= 1 && (depth < 1 || r.name[0] == 'v' || q.at(i) == 1);
                },
                "no share, or not lit without a blocker");
        }
    }
    const std::vector<Sample> at{{0, 0, 1.5f}, {10, 1e-3f, 1.5f}, {5, 6, 1.5f}};
    for (const Raw& r :
         raw({{"lecture_shadow.glsl"}, "", "", {}}, at,
             {{"mean", "pcss_mean_blocker_lecture(x[0], x[1])"}, {"width", "pcss_penumbra_width_lecture(x[0], x[1], x[2])"}})) {
        if (r.name[0] == 'm') {
            EXPECT_TRUE(std::isnan(r.at(0))) << r.name;
        } else {
            EXPECT_TRUE(std::isnan(r.at(0))) << r.name;
            EXPECT_NEAR(r.at(1), 14998.5, 0.02) << r.name;
            EXPECT_LT(r.at(2), 0.0) << r.name;
        }
    }
}

TEST(Stability, Row27_CascadesAtTheirEnds) {
    // Every float next to an end has exactly one slice, and a weight in [0, 1]; counts 1 to 4.
    std::vector<Sample> samples;
    const float ends[] = {6.690506f, 14.884208f, 32.093346f, 100};
    for (const float count : {1.0f, 2.0f, 3.0f, 4.0f})
        for (const float band : {0.0f, 1e-7f, 0.1f, 1.0f})
            for (float z : neighbourhood({-infinity, -1, 0, 0.1f, ends[0], ends[1], ends[2], ends[3], 1e30f, infinity})) {
                samples.push_back({z, count, band});
                if (std::isfinite(z)) samples.push_back({std::nextafter(std::nextafter(z, infinity), infinity), count, band});
            }
    Shader shader{{"cascades.glsl"}, "", "", {}};
    shader.declared = "const vec4 ends = vec4(6.690506, 14.884208, 32.093346, 100.0);\n";
    for (const Raw& r : raw(shader, samples,
                            {{"choice",
                              "CascadeChoice c = choose_cascade(x[0], 0.1, ends, int(x[1]), x[2]); result = vec4(float(c.index), "
                              "float(c.next), c.blend, 0.0);"}})) {
        EXPECT_EQ(r.non_finite(), 0u) << r.name;
        expect_each(
            r, samples,
            [&](const Raw& q, size_t i) {
                const float z = samples[i][0];
                const int count = static_cast<int>(samples[i][1]);
                int index = -1, number = 0;
                for (int k = 0; k < count; ++k) {
                    const bool after = k == 0 || z >= ends[k - 1], before = k + 1 < count ? z < ends[k] : z <= ends[k];
                    if (after && before) index = k, ++number;
                }
                return number <= 1 && q.at(i) == index && q.at(i, 2) >= 0 && q.at(i, 2) <= 1 &&
                       q.at(i, 1) == (index >= 0 && index + 1 < count ? index + 1 : -1);
            },
            "not the one slice of this depth");
    }
    for (const Raw& r : raw(shader, {{nan, 4, 0.1f}}, {{"NaN", "float(cascade_index(x[0], ends, int(x[1])))"}}))
        EXPECT_EQ(r.at(0), -1.0) << r.name;
    // Open or closed at both ends, as the slide's comparison may be read, an end has no slice or two.
    const std::string both = "float(x[0] >= 0.1 && x[0] <= ends.x) + float(x[0] >= ends.x && x[0] <= ends.y)";
    const std::string none = "float(x[0] > 0.1 && x[0] < ends.x) + float(x[0] > ends.x && x[0] < ends.y)";
    for (const Raw& r : raw(shader, {{ends[0]}}, {{"closed", both}, {"open", none}}))
        EXPECT_EQ(r.at(0), r.name[0] == 'c' ? 2.0 : 0.0) << r.name;
}

}  // namespace
}  // namespace kiln::test
