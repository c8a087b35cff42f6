// The background and the tone-mapped picture against the reference in double, pixel by pixel: every variant, every level of the
// sky and radiance from nothing to beyond half floats.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "tests/images/variants.h"
#include "uber/reference/background.h"
#include "uber/reference/post.h"

namespace kiln::test {
namespace {

using namespace reference;

constexpr uint32_t side = 64;

// Every pixel is drawn.
Points whole_screen() {
    Points out;
    out.size = side;
    out.at.resize(size_t{side} * side);
    for (Points::Point& p : out.at) p.body = 0;
    return out;
}

NamedTexture image_of(const std::vector<float>& texels, uint32_t width, uint32_t height, uint32_t mips, Wrap wrap) {
    auto image = std::make_shared<ImageData>();
    image->width = width;
    image->height = height;
    image->mips = mips;
    image->texels.resize(texels.size() * sizeof(float));
    std::memcpy(image->texels.data(), texels.data(), image->texels.size());
    return {image, SamplerState{Filter::linear, mips > 1 ? MipFilter::linear : MipFilter::none, wrap, Comparison::off}};
}

std::vector<double> numbers(const M4& m) {
    std::vector<double> out;
    for (const V4& c : m.columns) out.insert(out.end(), {c.x, c.y, c.z, c.w});
    return out;
}

Judged judged(const Variant& v, const NamedInputs& in, const std::function<Vec3<Bounded>(const Vec2<Bounded>&, size_t)>& expect) {
    const RunOutput run = draw(v.stages, {in}, side).front();
    const ReadBack* got = output(run, "output 0");
    EXPECT_NE(got, nullptr) << v.name;
    if (got == nullptr) return {};
    const Points points = whole_screen();
    return judge(
        points,
        [&](const Points::Point& p) {
            const size_t pixel = static_cast<size_t>(&p - points.at.data());
            const auto centre = [](size_t i) { return Bounded((static_cast<double>(i) + 0.5) / side, 16 * bounds::ulp); };
            const Vec3<Bounded> c = expect({centre(pixel % side), centre(pixel / side)}, pixel);
            return std::vector{c.x, c.y, c.z, Bounded(1)};
        },
        *got);
}

// ---- background ----

// Views: ahead, at a pole, along the seam behind (-x), on a slant; a far plane at infinity in the last.
std::vector<M4> views() {
    M4 endless = perspective(0.6, 0.1, 1e9);
    endless.columns[2].z = -1;
    endless.columns[3].z = -0.1;
    const V3 eye{0.4, 1.7, -0.3};
    std::vector<M4> out;
    for (const V3& towards : {V3{1, 0.1, 0.2}, V3{0.05, 1, 0.02}, V3{-1, 0.05, 0.01}})
        out.push_back(f32(inverse(perspective(0.6, 0.1, 100) * look_at(eye, eye + towards, {0, 0.2, 1}))));
    out.push_back(f32(inverse(endless * look_at(eye, eye + V3{0.5, -0.6, -0.7}, {0, 1, 0}))));
    return out;
}

// A picture of the sky in three mips, and the same read by the reference.
struct Picture {
    static constexpr long width = 64, height = 32;
    std::vector<float> texels;
    std::vector<Texture2D> mips;
    Picture() {
        for (long level = 0; level < 3; ++level) {
            const long w = width >> level, h = height >> level;
            std::vector<float> own;
            for (long y = 0; y < h; ++y)
                for (long x = 0; x < w; ++x) {
                    const double u = 2 * pi * (static_cast<double>(x) + 0.5) / static_cast<double>(w),
                                 t = (static_cast<double>(y) + 0.5) / static_cast<double>(h);
                    for (const double c : {1 + 0.5 * std::sin(u + 2 * t), 1.2 - t + 0.1 * std::cos(2 * u), 0.3 + t, 1.0})
                        own.push_back(static_cast<float>(c));
                }
            texels.insert(texels.end(), own.begin(), own.end());
            mips.emplace_back(w, h, own, true, TextureWrap::repeat);
        }
    }
    Vec3<Bounded> operator()(const Vec2<Bounded>& uv, const Bounded& level) const {
        return between_levels(level, 3, true, [&](int l) { return mips[static_cast<size_t>(l)].rgb(uv); });
    }
};

TEST(ScreenPasses, Background) {
    const Scene& s = scene(false, true);
    const Picture picture;
    Judged total;
    size_t pictures = 0;
    for (const char* sky : {"cube", "equirect"}) {
        const Variant v = variant_of("renderer.yaml", "background", {{"sky", sky}});
        for (const M4& world_of_clip : views())
            for (const double level : {0.0, 0.5, 2.0}) {
                const Background<Bounded> b{read<Bounded>(world_of_clip), Bounded(1.75), Bounded(level)};
                NamedInputs in = inputs_of(s);
                in.members["world_of_clip"] = numbers(world_of_clip);
                in.members["sky_intensity"] = {1.75};
                in.members["sky_level"] = {level};
                // The scene's first environment as one cube.
                const long n = s.maps.environment_maps.side();
                const int levels = s.maps.environment_maps.levels(), layers = s.maps.environment_maps.layers();
                NamedTexture cube = in.textures["environment_maps"];
                auto one = std::make_shared<ImageData>(*cube.image);
                one->arrayed = false;
                one->layers = 6;
                one->texels.clear();
                size_t from = 0;
                for (int l = 0; l < levels; ++l) {
                    const size_t bytes = static_cast<size_t>(n >> l) * static_cast<size_t>(n >> l) * 6 * 16;
                    const auto start = cube.image->texels.begin() + static_cast<std::ptrdiff_t>(from);
                    one->texels.insert(one->texels.end(), start, start + static_cast<std::ptrdiff_t>(bytes));
                    from += bytes * static_cast<size_t>(layers);
                }
                in.textures["sky_cube"] = {one, cube.sampler};
                in.textures["sky_picture"] = image_of(picture.texels, Picture::width, Picture::height, 3, Wrap::repeat);
                const Judged j = judged(v, in, [&](const Vec2<Bounded>& uv, size_t) {
                    if (v.values.at("sky") == "cube")
                        return background_of_cube(
                            b, [&](const Vec3<Bounded>& d, const Bounded& l) { return s.maps.environment_maps(d, 0, l); }, uv);
                    return background_of_picture(
                        b, picture, Bounded(static_cast<double>(Picture::height >> static_cast<int>(std::ceil(level)))), uv);
                });
                EXPECT_EQ(j.wrong, 0u) << sky << " level " << level << ": " << j.example;
                EXPECT_LT(j.masked_share(), 0.2)
                    << sky << " level " << level << ": " << j.close << " close, " << j.loose << " loose";
                total.compared += j.compared;
                total.worst = std::max(total.worst, j.worst);
                ++pictures;
            }
    }
    std::printf("KILN_IMAGES background: %zu pictures, %zu pixels, worst error %.3g of the allowed\n", pictures, total.compared,
                total.worst);
}

// ---- post ----

// Radiance along x from nothing over twenty powers of ten, greys and pure colours along y; the last columns are what should not
// come: negative, and beyond half floats.
std::vector<float> radiances() {
    std::vector<float> out;
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const double v = x == 0 ? 0 : x == side - 2 ? -3 : x == side - 1 ? 1e20 : std::pow(10.0, -6 + 0.16 * x);
            const double tint[] = {1, 0.2 + y / (1.3 * side), y % 3 == 0 ? 0 : 0.7};
            for (const double t : tint) out.push_back(static_cast<float>(v * t));
            out.push_back(1);
        }
    return out;
}

TEST(ScreenPasses, Post) {
    const std::vector<float> radiance = radiances();
    const Texture2D texture(side, side, radiance, false, TextureWrap::clamp);
    Judged total;
    size_t pictures = 0;
    for (const char* exposure : {"fixed", "metered"})
        for (const char* tone : {"clip", "reinhard", "reinhard_white", "aces"})
            for (const char* encode : {"false", "true"}) {
                const Variant v =
                    variant_of("renderer.yaml", "post", {{"exposure", exposure}, {"tone", tone}, {"encode_srgb", encode}});
                PostAxes axes;
                axes.metered = exposure == std::string("metered");
                axes.encode_srgb = encode == std::string("true");
                for (const PostTone t : {PostTone::clip, PostTone::reinhard, PostTone::reinhard_white, PostTone::aces})
                    if (tone == std::string(std::array{"clip", "reinhard", "reinhard_white", "aces"}[static_cast<size_t>(t)]))
                        axes.tone = t;
                struct Setting {
                    double value, white, mean;
                };
                for (const Setting& e : {Setting{0, 4, 0.125}, {7.25, 1, 40}, {-3, 30, 1e-9}}) {
                    NamedInputs in;
                    in.members = {{"exposure_value", {e.value}}, {"white", {e.white}}};
                    in.textures["scene_radiance"] = image_of(radiance, side, side, 1, Wrap::clamp);
                    in.textures["scene_radiance"].sampler.filter = Filter::nearest;
                    const float mean = static_cast<float>(e.mean);
                    in.textures["mean_luminance"] = image_of({mean, 0, 0, 1}, 1, 1, 1, Wrap::clamp);
                    const Judged j = judged(v, in, [&](const Vec2<Bounded>&, size_t pixel) {
                        const float* const x = radiance.data() + 4 * pixel;
                        Vec3<Bounded> c =
                            post_color(axes, Vec3<Bounded>{Bounded::input(x[0]), Bounded::input(x[1]), Bounded::input(x[2])},
                                       Bounded(e.value), Bounded(e.white), Bounded::input(mean));
                        // Reinhard's curve is 1 - 1 / (1 + x) there: a quotient and a difference near 1, absolute errors of which
                        // sRGB's slope makes at most 12.92 times as much.
                        if (axes.tone == PostTone::reinhard)
                            for (Bounded* const r : {&c.x, &c.y, &c.z})
                                r->error += 3.5 * bounds::ulp * (axes.encode_srgb ? 12.92 : 1);
                        return c;
                    });
                    EXPECT_EQ(j.wrong, 0u) << v.name << " EV " << e.value << ": " << j.example;
                    EXPECT_LT(j.masked_share(), 0.05) << v.name << ": " << j.close << " close, " << j.loose << " loose";
                    total.compared += j.compared;
                    total.worst = std::max(total.worst, j.worst);
                    ++pictures;
                }
            }
    std::printf("KILN_IMAGES post: %zu pictures, %zu pixels, worst error %.3g of the allowed\n", pictures, total.compared,
                total.worst);
}

// What an exposure means: the luminance that saturates the sensor is 1, at 1.2 2^EV; a metered mean comes out at 1 / 9.6, and
// twice as bright where the value is -1.
TEST(ScreenPasses, ExposureByItsDefinition) {
    const auto shown = [](const char* exposure, double ev, double mean, double radiance) {
        const Variant v = variant_of("renderer.yaml", "post", {{"exposure", exposure}});
        NamedInputs in;
        in.members = {{"exposure_value", {ev}}, {"white", {1}}};
        const float r = static_cast<float>(radiance), m = static_cast<float>(mean);
        in.textures["scene_radiance"] = image_of({r, r, r, 1}, 1, 1, 1, Wrap::clamp);
        in.textures["mean_luminance"] = image_of({m, 0, 0, 1}, 1, 1, 1, Wrap::clamp);
        const RunOutput run = draw(v.stages, {in}, 4).front();
        const ReadBack* got = output(run, "output 0");
        EXPECT_NE(got, nullptr);
        return got == nullptr ? 0.0 : static_cast<double>(as_float(got->words[0]));
    };
    for (const double ev : {-2.0, 0.0, 7.0, 15.0}) {
        EXPECT_NEAR(shown("fixed", ev, 1, 0.6 * std::exp2(ev)), 0.5, 1e-5) << ev;
        EXPECT_NEAR(shown("fixed", ev, 1, 1.2 * 0.999 * std::exp2(ev)), 0.999, 1e-5) << ev;
    }
    for (const double mean : {0.01, 3.0, 2000.0}) {
        EXPECT_NEAR(shown("metered", 0, mean, mean), 1 / 9.6, 1e-5) << mean;
        EXPECT_NEAR(shown("metered", -1, mean, mean), 2 / 9.6, 1e-5) << mean;
    }
}

TEST(ScreenPasses, WrongOnesAreCaught) {
    struct Wrong {
        const char *what, *shader, *from, *to;
        Values values;
    };
    const Wrong all[] = {
        {"exposure the wrong way", "post", "exp2(-ev)", "exp2(ev)", {{"exposure", "fixed"}}},
        {"no 1.2", "post", "exp2(-ev) / 1.2", "exp2(-ev)", {{"exposure", "fixed"}}},
        {"ACES with 2.50", "post", "2.51", "2.50", {{"tone", "aces"}}},
        {"Reinhard's white, not squared", "post", "l / (w * w)", "l / w", {{"tone", "reinhard_white"}}},
        {"encoding before the curve",
         "post",
         "srgb_encode(shown)",
         "tone_reinhard(srgb_encode(exposed))",
         {{"tone", "reinhard"}, {"encode_srgb", "true"}}},
    };
    const std::vector<float> radiance = radiances();
    for (const Wrong& w : all) {
        const Variant v = variant_of("renderer.yaml", w.shader, w.values, {{w.from, w.to}});
        PostAxes axes;
        axes.encode_srgb = v.values.at("encode_srgb") == "true";
        const std::string tone = v.values.at("tone");
        axes.tone = tone == "aces"             ? PostTone::aces
                    : tone == "reinhard_white" ? PostTone::reinhard_white
                    : tone == "reinhard"       ? PostTone::reinhard
                                               : PostTone::clip;
        NamedInputs in;
        in.members = {{"exposure_value", {3}}, {"white", {4}}};
        in.textures["scene_radiance"] = image_of(radiance, side, side, 1, Wrap::clamp);
        in.textures["scene_radiance"].sampler.filter = Filter::nearest;
        const Judged j = judged(v, in, [&](const Vec2<Bounded>&, size_t pixel) {
            const float* const x = radiance.data() + 4 * pixel;
            return post_color(axes, Vec3<Bounded>{Bounded::input(x[0]), Bounded::input(x[1]), Bounded::input(x[2])}, Bounded(3.0),
                              Bounded(4.0), Bounded(1.0));
        });
        EXPECT_GT(j.wrong, 100u) << w.what;
        std::printf("KILN_IMAGES %s: %zu of %zu pixels wrong\n", w.what, j.wrong, j.compared);
    }
}

}  // namespace
}  // namespace kiln::test
