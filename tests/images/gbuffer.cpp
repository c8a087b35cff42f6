#include "tests/images/gbuffer.h"

#include <gtest/gtest.h>

#include <cstring>

#include "uber/reference/half.h"

namespace kiln::test {

using namespace reference;

namespace {

constexpr double unorm8 = 0.5 / 255, snorm16 = 0.5 / 32767, half_float = 0x1p-11;
// A depth near 1, and its interpolation's roundings.
constexpr double depth_step = 8 * 0x1p-24;

NamedTexture texture_of(const std::vector<float>& texels, uint32_t size) {
    auto image = std::make_shared<ImageData>();
    image->width = image->height = size;
    image->texels.resize(texels.size() * sizeof(float));
    std::memcpy(image->texels.data(), texels.data(), image->texels.size());
    return {image, SamplerState{Filter::nearest, MipFilter::none, Wrap::clamp, Comparison::off}};
}

template <class T>
Vec2<T> centre_of(const Gbuffer& g, size_t pixel, const T& x, const T& y) {
    const T side(static_cast<double>(g.size));
    return {(T(static_cast<double>(pixel % g.size)) + x) / side, (T(static_cast<double>(pixel / g.size)) + y) / side};
}

}  // namespace

Gbuffer drawn_gbuffer(const Scene& scene, Values object, uint32_t size) {
    object["pass"] = "gbuffer";
    Gbuffer g;
    g.size = size;
    g.world_of_clip = f32(inverse(scene.blocks.view_projection));
    const Variant v = variant_of("renderer.yaml", "surface", object);
    const RunOutput run = draw(v.stages, {inputs_of(scene)}, size).front();
    const auto floats_of = [&](const std::string& what) {
        const ReadBack* got = output(run, what);
        EXPECT_NE(got, nullptr) << what;
        std::vector<float> out;
        if (got != nullptr)
            for (const uint32_t word : got->words) out.push_back(as_float(word));
        return out;
    };
    for (size_t i = 0; i < g.targets.size(); ++i) {
        g.targets[i] = floats_of("output " + std::to_string(i));
        EXPECT_EQ(g.targets[i].size(), size_t{4} * size * size);
    }
    g.depth = floats_of("depth");
    return g;
}

Gbuffer quantised(Gbuffer g) {
    const auto each = [](std::vector<float>& texels, const auto& keep) {
        for (float& x : texels) x = static_cast<float>(keep(static_cast<double>(x)));
    };
    for (const size_t target : {size_t{0}, size_t{1}})
        each(g.targets[target], [](double x) { return std::nearbyint(std::clamp(x, 0.0, 1.0) * 255) / 255; });
    each(g.targets[2], [](double x) { return std::nearbyint(std::clamp(x, -1.0, 1.0) * 32767) / 32767; });
    for (const size_t target : {size_t{3}, size_t{4}})
        each(g.targets[target], [](double x) { return round_to_half(static_cast<float>(x)); });
    return g;
}

RunOutput deferred_pass(const Scene& scene, const Gbuffer& g, const Values& pass, const Edits& edits) {
    NamedInputs in = inputs_of(scene, axes_of(pass));
    std::vector<double>& matrix = in.members["world_of_clip"];
    for (const V4& c : g.world_of_clip.columns) matrix.insert(matrix.end(), {c.x, c.y, c.z, c.w});
    const char* const names[] = {"gbuffer_diffuse", "gbuffer_specular", "gbuffer_normal", "gbuffer_irradiance"};
    for (size_t i = 0; i < std::size(names); ++i) in.textures[names[i]] = texture_of(g.targets[i], g.size);
    std::vector<float> depth;
    for (const float d : g.depth) depth.insert(depth.end(), {d, 0, 0, 1});
    in.textures["gbuffer_depth"] = texture_of(depth, g.size);
    return draw(variant_of("renderer.yaml", "deferred", pass, edits).stages, {in}, g.size).front();
}

Vec3<Bounded> deferred_expected(const Scene& scene, const Gbuffer& g, const Values& pass, size_t pixel) {
    // The triangle's corners are pixels' corners; what is between is interpolated with eight roundings (render.h).
    Vec2<Bounded> uv = centre_of(g, pixel, Bounded(0.5), Bounded(0.5));
    uv.x.error = uv.y.error = 16 * bounds::ulp;
    const auto read = [](float x) { return Bounded::input(x); };
    return deferred_radiance(axes_of(pass), scene.blocks, scene.maps, g.world_of_clip, texel_of<Bounded>(g, pixel, read),
                             read(g.depth[pixel]), uv);
}

V3 deferred_steps(const Scene& scene, const Gbuffer& g, const Values& pass, size_t pixel) {
    const SurfaceAxes axes = axes_of(pass);
    const auto read = [](float x) { return static_cast<double>(x); };
    const V2 uv = centre_of(g, pixel, 0.5, 0.5);
    const SurfaceGbuffer<double> at = texel_of<double>(g, pixel, read);
    const double depth = read(g.depth[pixel]);
    const auto value = [&](const SurfaceGbuffer<double>& t, double d) {
        return deferred_radiance(axes, scene.blocks, scene.maps, g.world_of_clip, t, d, uv);
    };
    const V3 here = value(at, depth);
    V3 sum{0, 0, 0};
    // move(texel, depth, -1 or 1); colours' channels together, since Fresnel's F90 hangs on all three.
    const auto step = [&](const auto& move) {
        V3 worst{0, 0, 0};
        for (const double sign : {-1.0, 1.0}) {
            SurfaceGbuffer<double> moved = at;
            double d = depth;
            move(moved, d, sign);
            const V3 change = value(moved, d) - here;
            worst = max(worst, map(change, [](double x) { return std::fabs(x); }));
        }
        sum = sum + worst;
    };
    const auto shifted = [](V4& colour, double by) { colour.x += by, colour.y += by, colour.z += by; };
    using G = SurfaceGbuffer<double>;
    step([&](G& t, double&, double s) { shifted(t.diffuse, s * unorm8); });
    step([&](G& t, double&, double s) { shifted(t.specular, s * unorm8); });
    step([&](G& t, double&, double s) { t.specular.w += s * unorm8; });
    for (double V4::*const c : {&V4::x, &V4::y, &V4::z, &V4::w})
        step([&](G& t, double&, double s) { t.normal.*c += s * snorm16; });
    step([&](G& t, double&, double s) {
        for (double V4::*const c : {&V4::x, &V4::y, &V4::z}) t.irradiance.*c *= 1 + s * half_float;
    });
    step([&](G&, double& d, double s) { d = std::min(d + s * depth_step, 1 - 0x1p-24); });
    return sum;
}

Points pixels_of(const Gbuffer& g) {
    Points out;
    out.size = g.size;
    out.at.resize(size_t{g.size} * g.size);
    for (size_t i = 0; i < out.at.size(); ++i) out.at[i].body = g.depth[i] < 1 ? 0 : -1;
    return out;
}

}  // namespace kiln::test
