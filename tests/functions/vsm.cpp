#include "uber/reference/vsm.h"

#include "tests/functions/shadow_maps.h"
#include "uber/reference/texture.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Vsm) {
    Functions vsm("vsm.glsl");
    const auto mean = [] { return number("m", linear(-0.5, 0.5)); };
    // Any two numbers, variance or none, so that no compiler sees through a difference of moments.
    const auto moments = [] { return vector2("moments", linear(-0.5, 0.5)); };
    vsm.test(
        "shadow_moments(distance, far, reference)",
        [](auto distance, auto far, auto reference) { return shadow_moments(distance, far, reference); },
        number("distance", linear(0, 100)), number("far", logarithmic(1, 100)), number("reference", linear(0, 1)));
    vsm.test(
           "shadow_moments(distance, 20.0, 0.5, gradient)",
           [](auto distance, auto gradient) {
               using T = decltype(distance);
               return shadow_moments(distance, T(20), T(0.5), gradient);
           },
           number("distance", linear(0, 20)), vector2("gradient", linear(-0.1, 0.1)))
        .named("shadow_moments_of_a_slope");
    vsm.test(
        "moments_variance(moments, 1e-9)", [](auto m) { return moments_variance(m, decltype(m.x)(1e-9)); }, moments());
    vsm.test(
        "chebyshev_upper_bound(moments, t, 1e-9)", [](auto m, auto t) { return chebyshev_upper_bound(m, t, decltype(t)(1e-9)); },
        moments(), number("t", linear(-0.5, 0.5)));
    vsm.test(
        "reduce_light_bleeding(lit, amount)", [](auto lit, auto amount) { return reduce_light_bleeding(lit, amount); },
        number("lit", linear(0, 1)), number("amount", linear(0, 0.9)));
    vsm.test(
           "vssm_blocker(vec2(m, 0.0), t, lit)",
           [](auto m, auto t, auto lit) {
               using T = decltype(m);
               return lit > T(0.999) ? t : m - (t - m) * lit / max(T(1) - lit, T(0.001));
           },
           mean(), number("t", linear(-0.5, 0.5)), number("lit", linear(0, 1)))
        .exactly([](double m, double t, double lit) {
            // Between the float above which all is lit and the number that it stands for, either answer is right.
            return vssm_blocker(Vec2<double>{m, 0}, t, lit);
        });
    vsm.test(
        "vsm_factor(moments, distance, 20.0, 0.5, 1e-9, 0.2)",
        [](auto m, auto distance) {
            using T = decltype(distance);
            return vsm_factor(m, distance, T(20), T(0.5), T(1e-9), T(0.2));
        },
        moments(), number("distance", linear(0, 20)));

    // Moments that are multiples of 1/64 and 1/4096: sums of 64 x 64 of them are exact in fp32, so that the table is right and
    // what is left is the arithmetic on it.
    const LightView view{1, 16, 2};
    constexpr double middle = 0.5;
    MomentMap map = moment_map(distance_map(square_scene(6), view, 64), 64, view.far, middle);
    const MomentMap sums = summed(map);
    vsm.texture("sampler2D sat", moments_image(floats_of(sums), 64), nearest(false));
    const auto table = [&sums](auto zero) {
        using T = decltype(zero);
        return [&sums](int x, int y) { return Vec2<T>{T(sums.at(x, y).x), T(sums.at(x, y).y)}; };
    };
    vsm.test(
        "sat_sum(sat, place)", [table](auto place) { return sat_sum(table(place.x), 64, place); },
        vector2("place", linear(0, 64).also({1, 32, 63})));
    vsm.test(
           "sat_average(sat, centre, width)",
           [table](auto centre, auto width) { return sat_average(table(centre.x), 64, centre, width); },
           vector2("centre", linear(0, 1)), vector2("width", logarithmic(1e-3, 2)))
        // Adding up texels instead: the same but for double's own rounding of sums up to 1e3.
        .truth([&map](auto centre, auto width) { return map.average(centre, width); }, 0, 1e-12);
    vsm.test(
        "vssm_factor(sat, vec4(x, y, (16.0 / 15.0) * w - (16.0 / 15.0), w), size, 1.0, 16.0, 2.0, 1.0 / 64.0, 0.5, 1e-4, 0.1)",
        [table](auto x, auto y, auto w, auto size) {
            using T = decltype(x);
            const auto average = [&](auto centre, auto width) { return sat_average(table(centre.x), 64, centre, width); };
            return vssm_factor(average, Vec4<T>{x, y, T(16.0 / 15) * w - T(16.0 / 15), w}, size, T(1), T(16), T(2), T(1.0 / 64),
                               T(middle), T(1e-4), T(0.1));
        },
        number("x", linear(-6, 6)), number("y", linear(-6, 6)), number("w", linear(-1, 17).also({0, 1, 10, 16})),
        number("size", linear(0, 2)));

    // The same map as mips, unfiltered: which texel of which level is a decision, and what a filter adds is in
    // ShadowTables.MipsAverageAsTheTableDoes.
    std::vector<float> chain;
    std::vector<Texture2D> levels;
    for (int side = 64; side >= 1; side /= 2) {
        std::vector<float> rgba;
        const int step = 64 / side;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                Vec2<double> sum;
                for (int j = 0; j < step; ++j)
                    for (int i = 0; i < step; ++i) sum = sum + map.at(x * step + i, y * step + j);
                const float m[] = {static_cast<float>(sum.x / (step * step)), static_cast<float>(sum.y / (step * step))};
                chain.insert(chain.end(), {m[0], m[1]});
                rgba.insert(rgba.end(), {m[0], m[1], 0, 1});
            }
        levels.emplace_back(side, side, rgba, false, TextureWrap::clamp);
    }
    const MomentMips mips(std::move(levels));
    vsm.texture("sampler2D chain", moments_image(chain, 64, 7),
                SamplerState{Filter::nearest, MipFilter::nearest, Wrap::clamp, Comparison::off});
    vsm.test(
        "mip_average(chain, centre, width, 7.0)",
        [&mips](auto centre, auto width) {
            using T = decltype(centre.x);
            return mip_average(mips, 64, centre, width, T(7));
        },
        vector2("centre", linear(0, 1)), vector2("width", logarithmic(1e-3, 2)));
    vsm.test(
        "vssm_factor_mips(chain, 7.0, vec4(x, y, (16.0 / 15.0) * w - (16.0 / 15.0), w), size, 1.0, 16.0, 2.0, 1.0 / 64.0, 0.5, "
        "1e-4, "
        "0.1)",
        [&mips](auto x, auto y, auto w, auto size) {
            using T = decltype(x);
            return vssm_factor_mips(mips, 64, T(7), Vec4<T>{x, y, T(16.0 / 15) * w - T(16.0 / 15), w}, size, T(1), T(16), T(2),
                                    T(1.0 / 64), T(middle), T(1e-4), T(0.1));
        },
        number("x", linear(-6, 6)), number("y", linear(-6, 6)), number("w", linear(-1, 17).also({0, 1, 10, 16})),
        number("size", linear(0, 2)));
    vsm.run();
}

}  // namespace
}  // namespace kiln::test
