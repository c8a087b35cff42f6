// Hair, subsurface and indirect light as whole loops on the device: furnaces, closed forms and the Monte Carlo references.

#include "tests/functions/library_run.h"
#include "uber/reference/gi_ambient.h"
#include "uber/reference/gi_cornell.h"
#include "uber/reference/gi_truth.h"
#include "uber/reference/subsurface.h"
#include "uber/reference/subsurface_separable.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(TransportScenes, WhiteHairGivesBackAllLight) {
    // 4 roughnesses x 3 angles x 4 offsets; 160 x 160 directions resolve lobes from beta 0.25 on.
    const auto energy = compute("", {"hair.glsl"}, R"(
    const float beta = 0.25 + 0.25 * float(i % 4);
    const float theta_o = 0.1 + 0.65 * float(i / 4 % 3);
    const float h = -0.9 + 0.6 * float(i / 12);
    const vec3 eye = vec3(sin(theta_o), cos(theta_o), 0.0);
    const HairFibre fibre = HairFibre(vec3(0.0), 1.55, beta, beta, 0.035);
    for (int a = 0; a < 160; ++a) {
        const float theta = pi * ((float(a) + 0.5) / 160.0 - 0.5);
        float row = 0.0;
        for (int b = 0; b < 160; ++b) {
            const float phi = 2.0 * pi * (float(b) + 0.5) / 160.0;
            row += hair_chiang(fibre, vec3(sin(theta), cos(theta) * cos(phi), cos(theta) * sin(phi)), eye, h).x;
        }
        result.x += row * cos(theta);
    }
    result.x *= pi / 160.0 * 2.0 * pi / 160.0;
)",
                                48);
    double worst = 0;
    for (const Texel& e : energy) {
        EXPECT_NEAR(at(e, 0), 1, 1e-3);
        worst = std::fmax(worst, std::fabs(at(e, 0) - 1));
    }
    std::printf("white hair furnace: worst |energy - 1| %.2g\n", worst);
}

TEST(TransportScenes, LongitudinalLobesOfRow34) {
    const double v[] = {1e-4, 1e-3, 5e-3, 0.01, 0.0112, 0.02, 0.1, 0.5, 2};
    const auto integral = compute("", {"hair.glsl", "hair_published.glsl"}, R"(
    const float vs[9] = float[](1e-4, 1e-3, 5e-3, 0.01, 0.0112, 0.02, 0.1, 0.5, 2.0);
    for (int a = 0; a < 2000; ++a) {
        const float theta = pi * ((float(a) + 0.5) / 2000.0 - 0.5);
        const float s = sin(theta);
        const float c = cos(theta);
        result.x += hair_longitudinal(s, c, sin(0.4), cos(0.4), vs[i]) * c;
        result.y += hair_longitudinal_printed(s, c, sin(0.4), cos(0.4), vs[i]) * c;
        result.z += hair_longitudinal_log(s, c, sin(0.4), cos(0.4), vs[i]) * c;
    }
    result *= pi / 2000.0;
)",
                                  9);
    for (std::size_t i = 0; i < 9; ++i) {
        std::printf("v %-7g stable %.7f printed %.7f log %.7f\n", v[i], at(integral[i], 0), at(integral[i], 1),
                    at(integral[i], 2));
        EXPECT_NEAR(at(integral[i], 0), 1, 1e-3) << v[i];
        // As printed sinh(1/v) leaves the format, and whatever the device makes of infinity is not the lobe.
        if (v[i] < 0.0111) {
            EXPECT_FALSE(std::fabs(at(integral[i], 1) - 1) < 0.5) << v[i];
        }
        if (v[i] > 0.3) {
            EXPECT_NEAR(at(integral[i], 1), 1, 1e-3) << v[i];
        }
    }
    // The 1/(8x) inside the bracket: 1 - 1/(16 x) on average over the lobe, x near cos(0.4)^2 / v.
    EXPECT_NEAR(at(integral[3], 2), 1 - 0.01 / (16 * 0.848), 2e-4);
}

TEST(TransportScenes, FurnaceRoomIsTheGeometricSeries) {
    const auto radiance = compute("#define GI_SCENE 1\n#define GI_FURNACE_ALBEDO 0.9\n#define GI_PATHS 4\n",
                                  {"gi_cornell.glsl", "gi_path.glsl"}, R"(
    uint state = uint(i);
    result.x = gi_path_irradiance(gi_cornell_lamp(), vec3(0.3, -1.0, 0.2), vec3(0.0, 1.0, 0.0), i, state).x / pi;
)",
                                  11);
    for (int n = 0; n <= 10; ++n) {
        const double exact = interreflection_textbook(splat3(1.0), splat3(0.9), n).x;
        // Every bounce rounds a product and a sum: 2 n ulp.
        EXPECT_NEAR(at(radiance[static_cast<std::size_t>(n)], 0), exact, exact * (2 * n + 8) * 0x1p-23) << n;
    }
}

TEST(TransportScenes, PlatesExchangeTheirFormFactor) {
    const int side = 48, paths = 64;
    const auto e = compute("#define GI_SCENE 2\n#define GI_PATHS 64\n#define SIDE 48\n", {"gi_cornell.glsl", "gi_path.glsl"}, R"(
    uint state = uint(i) * 9781u + 17u;
    const vec3 x = vec3((float(i % SIDE) + 0.5) / SIDE - 0.5, -0.5, (float(i / SIDE) + 0.5) / SIDE - 0.5);
    result.x = gi_path_irradiance(gi_cornell_lamp(), x, vec3(0.0, 1.0, 0.0), 0, state).x;
)",
                           side * side);
    double sum = 0;
    for (const Texel& t : e) sum += at(t, 0) / (pi * side * side);
    // A path hits or does not: of independent ones sqrt(F (1 - F) / n); stratified ones do no worse. The grid's own error is
    // below 1e-4, as the reference's test has it.
    const double exact = form_factor_parallel(1, 1, 1), error = std::sqrt(exact * (1 - exact) / (side * side * paths));
    std::printf("plates: exact %.6f device %.6f +- %.6f\n", exact, sum, error);
    EXPECT_NEAR(sum, exact, 4.5 * error + 1e-4);
}

TEST(TransportScenes, CornellBoxIsThePathTracersOfTheReference) {
    // 256 independent groups of 64 paths at one point of the floor, two bounces; their spread is the device's error.
    const auto groups = compute("#define GI_PATHS 64\n", {"gi_cornell.glsl", "gi_path.glsl"}, R"(
    uint state = uint(i) * 7919u + 3u;
    result.rgb = gi_path_irradiance(gi_cornell_lamp(), vec3(0.8, -1.0, 0.3), vec3(0.0, 1.0, 0.0), 2, state);
)",
                                256);
    const auto exact = gi_irradiance(gi_cornell_quads(), gi_cornell_lamp(), {0.8, -1, 0.3}, {0, 1, 0}, 2, 30000, 5);
    for (std::size_t c = 0; c < 3; ++c) {
        Samples samples;
        for (const Texel& t : groups) samples.add(at(t, c));
        const Estimate device = samples.estimate();
        std::printf("cornell %zu: reference %.6f +- %.6f device %.6f +- %.6f\n", c, exact[c].mean, exact[c].standard_error,
                    device.mean, device.standard_error);
        EXPECT_NEAR(device.mean, exact[c].mean, 4.5 * std::hypot(device.standard_error, exact[c].standard_error)) << c;
        EXPECT_LT(device.standard_error, 0.1 * device.mean);
    }
}

TEST(TransportScenes, DistanceFieldMeetsWhatRaysMeet) {
    // The Cornell box as a field of 48^3 texels over [-1, 1]^3.
    const uint32_t side = 48;
    const auto room = gi_cornell_quads();
    std::vector<float> field;
    const auto place = [&](uint32_t k) { return 2 * (k + 0.5) / side - 1; };
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                field.push_back(static_cast<float>(gi_distance(room, Vec3<double>{place(x), place(y), place(z)})));
    const auto hits = compute("#define SDF_STEPS 128\n", {"gi_cornell.glsl", "gi_path.glsl", "gi_sdf.glsl"}, R"(
    uint state = uint(i) * 31u;
    const vec3 origin = vec3(0.1, 0.5, 0.6);
    const vec3 direction = normalize(vec3(gi_random(state), gi_random(state), gi_random(state)) * 2.0 - 1.0);
    float t;
    const bool met = gi_trace(origin, direction, 1e-4, 10.0, t) >= 0;
    const SdfVolume volume = SdfVolume(vec3(-1.0), vec3(2.0));
    result = vec4(met ? t : -1.0, sdf_trace(field, volume, origin, direction, 0.0, 3.0, 2.0 / 48.0),
                  sdf_distance(field, volume, origin + direction * 0.3), gi_distance(origin + direction * 0.3));
)",
                              500, {{"field", volume_of(TexelFormat::r32_float, side, bytes_of(field)), smooth}},
                              "layout(set = 0, binding = 1) uniform sampler3D field;\n");
    int alike = 0, early = 0, met = 0;
    for (const Texel& h : hits) {
        // A field with slope 1 read by trilinear weights between texels 2/48 apart is off by less than half their diagonal.
        EXPECT_NEAR(at(h, 2), at(h, 3), std::sqrt(3.0) / side);
        if (at(h, 0) < 0) continue;
        ++met;
        alike += std::fabs(at(h, 0) - at(h, 1)) < 0.15 ? 1 : 0;
        early += at(h, 1) >= 0 && at(h, 1) < at(h, 0) - 0.15 ? 1 : 0;
    }
    std::printf("field: %d rays meet a wall, %d within 0.15 of it, %d earlier\n", met, alike, early);
    EXPECT_GT(met, 300);
    // Rays that graze a block stop beside it: the field knows no direction.
    EXPECT_GT(alike, met * 9 / 10);
}

TEST(TransportScenes, ConesThroughAFullAndAnEmptyVolume) {
    const std::vector<float> full(8 * 8 * 8 * 4, 1.0f), empty(8 * 8 * 8 * 4, 0.0f);
    for (const bool filled : {true, false}) {
        const auto light =
            compute("", {"gi_cones.glsl"}, "    result = cone_gather(volume, vec3(0.5), vec3(0.0, 0.0, 1.0), 0.125, 2.0);\n", 1,
                    {{"volume", volume_of(TexelFormat::rgba32_float, 8, bytes_of(filled ? full : empty)), smooth}},
                    "layout(set = 0, binding = 1) uniform sampler3D volume;\n");
        EXPECT_NEAR(at(light[0], 0), filled ? pi : 0.0, 1e-5);
        EXPECT_NEAR(at(light[0], 3), filled ? 1.0 : 0.0, 1e-6);
    }
}

TEST(TransportScenes, SubsurfaceGathersAcrossAnEdgeOfLight) {
    // 256 x 1 texels over [-8, 8] mean free paths, lit for x > 0.
    const uint32_t width = 256;
    std::vector<float> texels;
    for (uint32_t x = 0; x < width; ++x)
        for (int c = 0; c < 4; ++c) texels.push_back(x >= width / 2 ? 1.0f : 0.0f);
    const auto lit = [&](const Vec2<double>& uv) {
        const double x = std::fmin(std::fmax(uv.x * width - 0.5, 0.0), width - 1.0);
        return splat3(std::fmin(std::fmax(x - (width / 2 - 1.0), 0.0), 1.0));
    };
    const auto seen =
        compute("#define BURLEY_TAPS 64\n#define SEPARABLE_TAPS 25\n", {"subsurface.glsl", "subsurface_separable.glsl"}, R"(
    const vec3 s = vec3(1.0, 1.5, 3.0);
    const vec2 uv = vec2((float(i) + 0.5) / float(count), 0.5);
    vec4 kernel[SEPARABLE_TAPS];
    separable_kernel_burley(s, 9.0, kernel);
    const vec3 a = burley_gather(light, uv, vec2(1.0 / 16.0, 0.0), s, 1.0, 0.7);
    const vec3 b = separable_gather(light, uv, vec2(1.0 / 16.0, 0.0), kernel);
    result = vec4(a.x, a.z, b.x, b.z);
)",
                64, {{"light", image_of(TexelFormat::rgba32_float, width, 1, bytes_of(texels)), smooth}},
                "layout(set = 0, binding = 1) uniform sampler2D light;\n");
    const Vec3<double> s{1, 1.5, 3};
    const auto kernel = separable_kernel_burley(s, 9.0, 25);
    double worst = 0;
    for (int i = 0; i < 64; ++i) {
        const Texel& t = seen[static_cast<std::size_t>(i)];
        const Vec2<double> uv{(i + 0.5) / 64, 0.5}, axis{1.0 / 16, 0};
        const Vec3<double> a = burley_gather(lit, uv, axis, s, 1.0, 0.7, 64), b = separable_gather(lit, uv, axis, kernel);
        // The edge is one texel, 1/16, wide. sin and cos may be off by 2^-11 (Vulkan): 64 taps of radius r move by r / 2048, and
        // so a share 16 r / 2048 of one of them; filter weights come in steps of 2^-8.
        EXPECT_NEAR(at(t, 0), a.x, 0.01) << i;
        EXPECT_NEAR(at(t, 1), a.z, 0.01) << i;
        EXPECT_NEAR(at(t, 2), b.x, 0x1p-8) << i;
        EXPECT_NEAR(at(t, 3), b.z, 0x1p-8) << i;
        // Against the closed form of an edge: the line spread's integral.
        const double x = 16 * uv.x - 8;
        double exact = 0.5;
        const int n = 2000;
        for (int k = 0; k < n; ++k) {  // x' = x q^2 takes the pole away
            const double q = (k + 0.5) / n;
            exact += burley_line_spread(std::fabs(x) * q * q, s.x) * 2 * q * x / n;
        }
        worst = std::fmax(worst, std::fabs(at(t, 2) - exact));
    }
    std::printf("separable, 25 taps, edge: worst error %.4f of the lit side\n", worst);
    // One cell of the kernel next to the centre holds this share of the light, and a step falls somewhere inside a cell.
    double cell = 0;
    for (const auto& k : kernel) cell = std::fmax(cell, k.x);
    EXPECT_LT(worst, cell);
}

}  // namespace
}  // namespace kiln::test
