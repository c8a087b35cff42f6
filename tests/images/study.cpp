#include "tests/images/study.h"

#include <cstdio>
#include <cstring>

#include "tests/device/glsl.h"

namespace kiln::test {

using namespace reference;

namespace {

// The device's own screen_uv at every pixel, which other pipelines may round otherwise: within four units of the last place.
const Points& screen_points(const StageCode& screen) {
    static Points points;
    if (points.size != 0) return points;
    const StageCode capture = compile(Stage::fragment,
                                      "#version 450\nlayout(location = 0) in vec2 screen_uv;\nlayout(location = 0) out vec4 "
                                      "c;\nvoid main() { c = vec4(screen_uv, 0.0, 1.0); }\n");
    const RunOutput run = draw({screen, capture}, {NamedInputs()}).front();
    const ReadBack* got = output(run, "output 0");
    EXPECT_NE(got, nullptr);
    if (got == nullptr) return points;
    points.size = picture_size;
    for (size_t i = 0; i < size_t{picture_size} * picture_size; ++i) {
        Points::Point p;
        p.body = 0;
        const auto at = [&](size_t c, size_t place) {
            const double device = static_cast<double>(as_float(got->words[4 * i + c]));
            EXPECT_NEAR(device, (static_cast<double>(place) + 0.5) / picture_size, 1e-5);
            return Bounded(device, 4 * bounds::ulp);
        };
        p.in.material_uv = {at(0, i % picture_size), at(1, i / picture_size)};
        points.at.push_back(p);
    }
    return points;
}

}  // namespace

NamedTexture study_texture(const Texture2D& from) {
    auto image = std::make_shared<ImageData>();
    image->width = static_cast<uint32_t>(from.width());
    image->height = static_cast<uint32_t>(from.height());
    image->texels.resize(from.texels().size() * sizeof(float));
    std::memcpy(image->texels.data(), from.texels().data(), image->texels.size());
    return {image, SamplerState{from.linear() ? Filter::linear : Filter::nearest, MipFilter::none,
                                from.wrap() == TextureWrap::clamp ? Wrap::clamp : Wrap::repeat, Comparison::off}};
}

NamedTexture study_texture(const CubeArray& from) {
    auto image = std::make_shared<ImageData>();
    image->dim = ImageDim::cube;
    image->width = image->height = static_cast<uint32_t>(from.side());
    image->layers = 6;
    image->mips = static_cast<uint32_t>(from.levels());
    image->texels.resize(from.texels().size() * sizeof(float));
    std::memcpy(image->texels.data(), from.texels().data(), image->texels.size());
    return {image, SamplerState{from.linear() ? Filter::linear : Filter::nearest,
                                from.linear() ? MipFilter::linear : MipFilter::nearest, Wrap::clamp, Comparison::off}};
}

Judged hold_study(const std::string& shader, const Values& values, const NamedInputs& inputs, const StudyPixel& expected,
                  double most_masked, const Edits& edits) {
    const Variant v = variant_of("library.yaml", shader, values, edits);
    const RunOutput run = draw(v.stages, {inputs}).front();
    const ReadBack* got = output(run, "output 0");
    EXPECT_NE(got, nullptr) << v.name;
    if (got == nullptr) return {};
    const Expect expect = [&](const Points::Point& p) {
        const Vec3<Bounded> c = expected(p.in.material_uv);
        return std::vector{c.x, c.y, c.z, Bounded(1)};
    };
    const Points& points = screen_points(v.stages.front());
    const Judged j = judge(points, expect, *got);
    if (edits.empty()) {
        EXPECT_EQ(j.wrong, 0u) << v.name << ": " << j.example;
        EXPECT_LT(j.masked_share(), most_masked)
            << v.name << ": " << j.close << " close decisions, " << j.loose << " loose bounds";
        double lit = 0;
        for (size_t i = 0; i < got->words.size(); i += 4) lit += as_float(got->words[i]) != 0.0f ? 1 : 0;
        EXPECT_GT(lit, 0.1 * picture_size * picture_size) << v.name << " shows next to nothing";
        std::printf("KILN_STUDY %s: worst error %.3g of the allowed, %.3g relative RMS, masked %.2f %%\n", v.name.c_str(),
                    j.worst, j.relative, 100 * j.masked_share());
        show(shader + " " + v.name, points, expect, *got);
    }
    return j;
}

}  // namespace kiln::test
