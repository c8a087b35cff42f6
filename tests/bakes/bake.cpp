// The bakes of uber/bake.comp on the device, against closed forms and quadrature.

#include <cmath>
#include <cstdio>
#include <functional>

#include "tests/bakes/shader.h"
#include "uber/reference/environment.h"
#include "uber/reference/skies.h"
#include "uber/reference/split_sum_quadrature.h"

namespace kiln::test {
namespace {

using V = reference::Vec3<double>;
using reference::pi;
using Sky = std::function<V(const V& direction)>;

// A cube map of a sky, fp32, with box-filtered mips.
std::shared_ptr<ImageData> cube_of(uint32_t size, const Sky& sky, uint32_t cubes = 1) {
    auto image = std::make_shared<ImageData>();
    image->format = TexelFormat::rgba32_float;
    image->dim = ImageDim::cube;
    image->arrayed = cubes > 1;
    image->layers = 6 * cubes;
    image->width = image->height = size;
    image->mips = static_cast<uint32_t>(std::bit_width(size));
    std::vector<float> level, all;
    for (uint32_t layer = 0; layer < image->layers; ++layer) {
        for (uint32_t y = 0; y < size; ++y) {
            for (uint32_t x = 0; x < size; ++x) {
                const auto p =
                    reference::cube_texel_centre<double>(static_cast<int>(x), static_cast<int>(y), static_cast<int>(size));
                const V l = sky(normalize(reference::cube_direction(static_cast<int>(layer % 6), p)));
                level.insert(level.end(), {static_cast<float>(l.x), static_cast<float>(l.y), static_cast<float>(l.z), 1.0f});
            }
        }
    }
    for (uint32_t side = size;; side /= 2) {
        all.insert(all.end(), level.begin(), level.end());
        if (side == 1) break;
        std::vector<float> next;
        for (size_t layer = 0; layer < image->layers; ++layer) {
            for (uint32_t y = 0; y < side / 2; ++y) {
                for (uint32_t i = 0; i < side / 2 * 4; ++i) {
                    const size_t at = ((layer * side + 2 * y) * side + 2 * (i / 4)) * 4 + i % 4;
                    next.push_back(0.25f * (level[at] + level[at + 4] + level[at + 4 * side] + level[at + 4 * side + 4]));
                }
            }
        }
        level = std::move(next);
    }
    image->texels = bytes_of(all);
    return image;
}

std::shared_ptr<ImageData> target_of(uint32_t width, uint32_t height, uint32_t layers) {
    auto image = std::make_shared<ImageData>();
    image->arrayed = layers > 1;
    image->width = width;
    image->height = height;
    image->layers = layers;
    image->texels.resize(size_t{width} * height * layers * 16);
    return image;
}

struct Push {
    float roughness = 0;
    uint32_t samples = 1024;
    int32_t level = 0;
    float limit = 65504;
};

std::string axes(int what, int sampling, int smith) {
    return "#define WHAT " + std::to_string(what) + "\n#define SAMPLING " + std::to_string(sampling) + "\n#define SMITH " +
           std::to_string(smith) + "\n";
}

float as_float(uint32_t w) { return std::bit_cast<float>(w); }

struct Cell {
    V direction, value;
};
// Runs one of the bakes that fill a cube, 8 texels a side.
std::vector<Cell> bake_cube(int what, int sampling, const std::shared_ptr<ImageData>& environment, const Push& push) {
    const uint32_t side = 8;
    ComputeData data;
    data.images = {{"environment", environment, SamplerState{Filter::linear, MipFilter::linear, Wrap::clamp, Comparison::off}},
                   {"target", target_of(side, side, 6), {}}};
    data.push_constants = bytes_of(std::vector<Push>{push});
    data.groups = {1, 1, 6};
    const ComputeResult result = run_text(uber_text("bake.comp", axes(what, sampling, 0)), data);
    const ReadBack* picture = result.image("target");
    std::vector<Cell> out;
    if (picture == nullptr || picture->words.size() != size_t{6} * side * side * picture->components) {
        ADD_FAILURE() << "no picture";
        return out;
    }
    for (uint32_t i = 0; i < 6 * side * side; ++i) {
        const auto p = reference::cube_texel_centre<double>(static_cast<int>(i % side), static_cast<int>(i / side % side), side);
        const uint32_t* w = &picture->words[size_t{i} * picture->components];
        out.push_back({normalize(reference::cube_direction(static_cast<int>(i / (side * side)), p)),
                       {as_float(w[0]), as_float(w[1]), as_float(w[2])}});
    }
    return out;
}

const V axis = normalize(V{0.3, 0.8, -0.5});

// Red: furnace of 1; green: linear sky; blue: a cap of 60 degrees around `axis`.
V test_sky(const V& d) { return {1.0, 1.0 + 0.8 * dot(axis, d), dot(axis, d) > std::cos(pi / 3) ? 1.0 : 0.0}; }

const double half_float = 0x1p-11;  // relative rounding of the target

struct Worst {
    double red = 0, green = 0, blue = 0;
};
Worst irradiance_errors(int sampling, uint32_t size, const Push& push) {
    Worst worst;
    for (const Cell& c : bake_cube(0, sampling, cube_of(size, test_sky), push)) {
        const double cosine = dot(axis, c.direction);
        worst.red = std::max(worst.red, std::fabs(c.value.x - 1.0));
        worst.green = std::max(worst.green, std::fabs(c.value.y - reference::linear_sky_irradiance(1.0, 0.8, cosine) / pi));
        worst.blue = std::max(worst.blue, std::fabs(c.value.z - reference::cap_irradiance(cosine, pi / 3) / pi));
    }
    std::printf("KILN_BAKE irradiance sampling=%d size=%u samples=%u furnace=%.3g linear=%.3g cap=%.3g\n", sampling, size,
                push.samples, worst.red, worst.green, worst.blue);
    return worst;
}

// Sums over all texels: midpoints of N x N texels a face err by about 1 / N^2 for a smooth sky (the linear one), and by the
// texels that the cap's edge cuts, of 2 pi sin(60) N pi / 2 with random signs, for the cap.
TEST(Bake, IrradianceSummed) {
    const Worst worst = irradiance_errors(2, 32, {});
    EXPECT_LE(worst.red, half_float);
    EXPECT_LE(worst.green, 1.8 * half_float + 2.0 / (32 * 32));
    EXPECT_LE(worst.blue, half_float + 0.01);
}

// 1024 Hammersley points: discrepancy below (log2 N + 1) / N for what varies over half the square, times the sky's contrast.
TEST(Bake, IrradianceSampled) {
    for (const int sampling : {0, 1}) {
        const Worst worst = irradiance_errors(sampling, 32, {});
        EXPECT_LE(worst.red, half_float);
        EXPECT_LE(worst.green, 1.8 * half_float + 0.011);
        EXPECT_LE(worst.blue, half_float + 0.025);
    }
}

// A constant sky stays constant at every roughness and by every way of sampling; the summed and sampled forms of one lobe agree.
TEST(Bake, PrefilterFurnaceAndAgreement) {
    const auto sky = cube_of(32, test_sky);
    for (const float roughness : {0.0f, 0.25f, 0.5f, 1.0f}) {
        for (const int sampling : {0, 1, 2}) {
            if (sampling == 2 && roughness < 0.5f) continue;  // the lobe is narrower than a few texels
            const Push push{roughness, 4096, 0, 65504};
            double furnace = 0;
            for (const Cell& c : bake_cube(1, sampling, sky, push)) furnace = std::max(furnace, std::fabs(c.value.x - 1.0));
            EXPECT_LE(furnace, half_float) << roughness << " " << sampling;
        }
        if (roughness < 0.5f) continue;
        const std::vector<Cell> sampled = bake_cube(1, 1, sky, {roughness, 4096, 0, 65504}),
                                summed = bake_cube(1, 2, sky, {roughness, 4096, 0, 65504});
        ASSERT_EQ(sampled.size(), summed.size());
        double apart = 0;
        for (size_t i = 0; i < sampled.size(); ++i) apart = std::max(apart, std::fabs(sampled[i].value.y - summed[i].value.y));
        std::printf("KILN_BAKE prefilter roughness=%.2f sampled_against_summed=%.3g\n", static_cast<double>(roughness), apart);
        EXPECT_LE(apart, 2 * 1.8 * half_float + 2.0 / (32 * 32) + 0.005);
    }
}

// The 32^2 table at its texels (rows above roughness 0.045), against quadrature. 4096 points are off by up to 0.0015 in A at
// n.v >= 0.05 and more below, where nearly all of the lobe is under the horizon.
TEST(Bake, SplitSumTables) {
    const reference::TanhSinh quadrature(40);
    const struct {
        int axis;
        reference::SmithForm form;
        const char* name;
    } forms[] = {{0, reference::SmithForm::height_correlated, "height_correlated"},
                 {1, reference::SmithForm::karis_ibl, "karis"}};
    for (const auto& form : forms) {
        ComputeData data;
        data.images = {{"table", target_of(32, 32, 1), {}}};
        data.push_constants = bytes_of(std::vector<Push>{{0, 4096, 0, 0}});
        data.groups = {4, 4, 1};
        const ComputeResult result = run_text(uber_text("bake.comp", axes(2, 0, form.axis)), data);
        const ReadBack* table = result.image("table");
        ASSERT_NE(table, nullptr);
        double worst_a = 0, worst_b = 0, edge_a = 0;
        for (int y = 2; y < 32; ++y) {
            for (int x = 1; x < 32; ++x) {
                const uint32_t* w = &table->words[static_cast<size_t>(y * 32 + x) * table->components];
                const reference::SplitSum truth = reference::split_sum(form.form, x / 31.0, y / 31.0, quadrature);
                const double a = std::fabs(static_cast<double>(as_float(w[0])) - truth.a),
                             b = std::fabs(static_cast<double>(as_float(w[1])) - truth.b);
                (x == 1 ? edge_a : worst_a) = std::max(x == 1 ? edge_a : worst_a, a);
                worst_b = std::max(worst_b, b);
            }
        }
        std::printf("KILN_BAKE split_sum smith=%s a=%.3g b=%.3g a_at_first_column=%.3g\n", form.name, worst_a, worst_b, edge_a);
        EXPECT_LE(worst_a, half_float + 0.005);
        EXPECT_LE(edge_a, half_float + 0.015);
        EXPECT_LE(worst_b, half_float + 0.002);
    }
}

// The lecture's Fresnel weight at roughness 0.5, n.v 0.5 in a table whose 3 x 3 texels hit both: albedo 0.0877 for 0.0557.
TEST(Bake, LectureTableIsTooBright) {
    double albedo[2]{};
    for (const int smith : {0, 2}) {
        ComputeData data;
        data.images = {{"table", target_of(3, 3, 1), {}}};
        data.push_constants = bytes_of(std::vector<Push>{{0, 65536, 0, 0}});
        const ComputeResult result = run_text(uber_text("bake.comp", axes(2, 0, smith)), data);
        const ReadBack* table = result.image("table");
        ASSERT_NE(table, nullptr);
        const uint32_t* w = &table->words[4 * table->components];
        albedo[smith / 2] = 0.04 * static_cast<double>(as_float(w[0])) + static_cast<double>(as_float(w[1]));
    }
    EXPECT_NEAR(albedo[0], 0.055744, 3e-4);
    EXPECT_NEAR(albedo[1], 0.087685, 3e-4);
}

std::vector<float> bake_numbers(int what, size_t vectors, const std::string& name, const std::shared_ptr<ImageData>& map,
                                const Push& push, uint32_t groups = 1) {
    ComputeData data;
    data.buffers = {{"Result", Bytes(vectors * 16)}};
    data.images = {{name, map, SamplerState{Filter::linear, MipFilter::nearest, Wrap::clamp, Comparison::off}}};
    if (what == 6) data.images.push_back({"target", target_of(map->width, map->width, 6), {}});
    data.push_constants = bytes_of(std::vector<Push>{push});
    data.groups = {groups, 1, 1};
    const ComputeResult result = run_text(uber_text("bake.comp", axes(what, 0, 0)), data);
    std::vector<float> numbers = values_of<float>(result.buffer("Result"));
    numbers.resize(vectors * 4);
    if (what == 6) {
        const ReadBack* picture = result.image("target");
        EXPECT_NE(picture, nullptr);
        if (picture != nullptr) {
            for (const uint32_t w : picture->words) EXPECT_LE(as_float(w), push.limit * (1.0f + 0x1p-10f));
        }
    }
    return numbers;
}

// Midpoint sums over 32^2 texels a face: solid angles sum to 4 pi within 0.4 / 32^2; the cap's edge cuts texels.
TEST(Bake, SphericalHarmonicsOfTheTestSky) {
    const auto sky = cube_of(32, test_sky);
    const std::vector<float> l2 = bake_numbers(4, 9, "environment", sky, {}), l1 = bake_numbers(3, 4, "environment", sky, {});
    const reference::ShL2<double> cap = reference::cap_sh(axis, pi / 3);
    const reference::ShL1<double> linear = reference::sh_l1_of(reference::linear_sky_moments(1.0, 0.8, axis));
    double worst_cap = 0, worst_linear = 0, worst_furnace = 0;
    for (size_t i = 0; i < 9; ++i) {
        worst_furnace = std::max(worst_furnace, std::fabs(static_cast<double>(l2[4 * i]) - (i == 0 ? 3.544907702 : 0.0)));
        worst_linear = std::max(worst_linear, std::fabs(static_cast<double>(l2[4 * i + 1]) - (i < 4 ? linear.c[i].x : 0.0)));
        worst_cap = std::max(worst_cap, std::fabs(static_cast<double>(l2[4 * i + 2]) - cap.c[i].x));
        if (i < 4) {
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(l1[4 * i + c], l2[4 * i + c], 1e-5f) << "the same sums";
        }
    }
    std::printf("KILN_BAKE sh_l2 size=32 furnace=%.3g linear=%.3g cap=%.3g\n", worst_furnace, worst_linear, worst_cap);
    EXPECT_LE(worst_furnace, 3.5449 / (32 * 32));
    EXPECT_LE(worst_linear, 2 * 3.5449 / (32 * 32));
    EXPECT_LE(worst_cap, 0.02);
}

TEST(Bake, ProbesAreRawMoments) {
    const std::vector<float> moments = bake_numbers(5, 8, "probes", cube_of(16, test_sky, 2), {}, 2);
    const reference::ShMomentsL1<double> linear = reference::linear_sky_moments(1.0, 0.8, axis);
    for (const size_t probe : {size_t{0}, size_t{4}}) {
        EXPECT_NEAR(moments[4 * probe], 4 * pi, 4 * pi / (16 * 16));
        EXPECT_NEAR(moments[4 * probe + 1], linear.m0.x, 4 * pi / (16 * 16));
        EXPECT_NEAR(moments[4 * (probe + 1) + 1], linear.m1_y.x, 4 * pi / (16 * 16));
        EXPECT_NEAR(moments[4 * (probe + 2) + 1], linear.m1_z.x, 4 * pi / (16 * 16));
        EXPECT_NEAR(moments[4 * (probe + 3) + 1], linear.m1_x.x, 4 * pi / (16 * 16));
    }
}

// A sun of 1e9 in three texels: the map keeps at most the limit, and what is cut is exactly what the light gets.
TEST(Bake, SunIsSplitWithoutLoss) {
    const V sun = normalize(V{0.2, 0.9, 0.3});
    const Sky sky = [&](const V& d) { return dot(d, sun) > 0.9975 ? V{1.2e9, 1.0e9, 0.7e9} : V{0.5, 0.7, 1.0}; };
    const auto map = cube_of(32, sky);
    const Push push{0, 0, 0, 100.0f};
    const std::vector<float> light = bake_numbers(6, 2, "environment", map, push);
    double removed[3]{};
    for (int face = 0; face < 6; ++face) {
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x < 32; ++x) {
                const auto p = reference::cube_texel_centre<double>(x, y, 32);
                const V l = sky(normalize(reference::cube_direction(face, p)));
                const double sr = reference::cube_texel_solid_angle(p, 32.0);
                const double cut[3] = {l.x - std::min(l.x, 100.0), l.y - std::min(l.y, 100.0), l.z - std::min(l.z, 100.0)};
                for (int c = 0; c < 3; ++c) removed[c] += cut[c] * sr;
            }
        }
    }
    ASSERT_GT(removed[0], 0.0);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(static_cast<double>(light[c]) / removed[c], 1.0, 1e-5);
    EXPECT_GT(light[4] * static_cast<float>(sun.x) + light[5] * static_cast<float>(sun.y) + light[6] * static_cast<float>(sun.z),
              0.998f);
    EXPECT_GT(light[7], 0.99f) << "all from about one direction";
}

}  // namespace
}  // namespace kiln::test
