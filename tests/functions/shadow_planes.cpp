// Hard shadows of nothing but a plane, from maps that hold that plane exactly: every receiver on it is lit, wherever in the map
// it stands and however it leans.

#include <iomanip>
#include <random>
#include <sstream>

#include "tests/functions/shadow_images.h"
#include "uber/reference/environment.h"

namespace kiln::test {
namespace {

using namespace reference;
using V3 = Vec3<double>;

constexpr double near = 0.5, far = 50, plane_away = 5;

// n . p = -plane_away in the light's space: how far along d it is; beyond the far plane where d does not meet it.
double along(const V3& n, const V3& d) {
    const double falls = -dot(n, d);
    return falls > plane_away / far ? plane_away / falls : far;
}

// Depth of a place `z` along a map's axis, in the number that a map of this kind holds.
struct Format {
    bool d16 = false;
    double quantum() const { return d16 ? 1.0 / 65535 : 0x1p-23; }
    std::shared_ptr<ImageData> image(uint32_t size, const std::vector<double>& distances) const {
        std::vector<float> depths;
        std::vector<uint16_t> coarse;
        for (const double z : distances) {
            const double d = far / (far - near) - far * near / ((far - near) * z);
            depths.push_back(static_cast<float>(d));
            coarse.push_back(static_cast<uint16_t>(std::lround(d * 65535)));
        }
        auto image = image_of(d16 ? TexelFormat::d16_unorm : TexelFormat::d32_float, size, size,
                              d16 ? bytes_of(coarse) : bytes_of(depths));
        image->depth = true;
        return image;
    }
};

std::string literal(double x) {
    std::ostringstream out;
    out << std::setprecision(9) << std::fixed << x;
    return out.str();
}
std::string literal(const V3& v) { return "vec3(" + literal(v.x) + ", " + literal(v.y) + ", " + literal(v.z) + ")"; }

V3 single(const V3& v) {  // as literal() has it
    return map(v, [](double x) { return std::round(x * 1e9) / 1e9; });
}

const SamplerState bilinear{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal};

Texel texel_of(const V3& p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0}; }

// Planes that face the light along one ray, `facing` of them, and some that lean.
constexpr size_t facing = 4;
std::vector<V3> normals(std::mt19937& random) {
    std::vector<V3> out;
    for (const V3& ray : {V3{0, 0, 1}, {0.3, 0, 1}, {0.6, 0.6, 1}, {0.9, 0.9, 1}}) out.push_back(single(-normalize(ray)));
    std::normal_distribution<double> any;
    while (out.size() < 12) {
        const V3 n = single(normalize(V3{any(random), any(random), any(random)}));
        if (n.z < 0.2) out.push_back(n);
    }
    return out;
}

struct Shadowed {
    size_t pixels = 0, of = 0;
    double share() const { return static_cast<double>(pixels) / static_cast<double>(std::max<size_t>(of, 1)); }
    void add(float lit) { pixels += lit < 1 - 1e-6f ? 1 : 0, ++of; }  // weights of a filter add up to 1 with rounding
};

// A spot light's map: 90 degrees wide, its axis along z.
TEST(ShadowPlanes, NoneShadowsItselfUnderASpotLight) {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> unit(-0.98, 0.98);
    for (const Format format : {Format{false}, Format{true}}) {
        Shadowed toward_axis, toward_light;
        const std::vector<V3> planes = normals(random);
        for (size_t k = 0; k < planes.size(); ++k)
            for (const uint32_t size : {128u, 512u}) {
                const V3& n = planes[k];
                std::vector<double> distances;
                const auto centre = [&](uint32_t i) { return 2 * (i + 0.5) / size - 1; };
                for (uint32_t y = 0; y < size; ++y)
                    for (uint32_t x = 0; x < size; ++x) distances.push_back(along(n, {centre(x), centre(y), 1}));
                std::vector<Texel> at;
                // Of those that face the light off the axis, where they do.
                const bool faces = k >= 1 && k < facing;
                const auto place = [&](double x) {
                    return faces ? std::clamp(x + 0.2 * unit(random), -0.98, 0.98) : unit(random);
                };
                for (int i = 0; i < 2000; ++i) {
                    const V3 ray{place(n.x / n.z), place(n.y / n.z), 1};
                    const double z = along(n, ray);
                    if (z > near * 1.1 && z < far * 0.9) at.push_back(texel_of(ray * z));
                }
                if (at.size() < 200) continue;
                const double f = far / (far - near), texel = 2.0 / size;
                const std::string text = uber_text("lib/shadow_map.glsl") + "const vec3 n = " + literal(n) +
                                         ";\nconst mat4 m = mat4(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, " + literal(f) + ", 1, 0, 0, " +
                                         literal(-f * near) + ", 0);\n#define LIT(cosine) shadow_factor_2d(map, m * " +
                                         "vec4(offset_shadow_receiver(p.xyz, n, cosine, " + literal(texel) + " * p.z), 1.0), " +
                                         literal(2 * format.quantum()) + ")\n";
                const std::vector<Texel> lit =
                    evaluate(text, "LIT(perspective_axis_cosine(m, n)), LIT(dot(n, -normalize(p.xyz))), 0.0, 0.0", at,
                             {{"sampler2DShadow map", format.image(size, distances), bilinear}});
                for (const Texel& t : lit) {
                    toward_axis.add(t[0]);
                    if (faces) toward_light.add(t[1]);
                }
            }
        std::printf("KILN_SHADOW plane under a spot light, %s: %.4f shadowed by the axis's sine, %.4f by the light's\n",
                    format.d16 ? "D16" : "D32F", toward_axis.share(), toward_light.share());
        EXPECT_EQ(toward_axis.pixels, 0u) << "of " << toward_axis.of;
        EXPECT_GT(toward_light.share(), 0.3);
    }
}

// A point light's cube, over faces, edges and corners.
TEST(ShadowPlanes, NoneShadowsItselfUnderAPointLight) {
    std::mt19937 random(32);
    std::normal_distribution<double> any;
    for (const Format format : {Format{false}, Format{true}}) {
        Shadowed toward_axis, one_axis, toward_light;
        for (const V3& n : normals(random))
            for (const uint32_t size : {32u, 128u}) {
                std::vector<double> distances;
                for (int face = 0; face < 6; ++face)
                    for (uint32_t y = 0; y < size; ++y)
                        for (uint32_t x = 0; x < size; ++x)
                            distances.push_back(
                                along(n, cube_direction(face, cube_texel_centre<double>(static_cast<int>(x), static_cast<int>(y),
                                                                                        static_cast<int>(size)))));
                const std::shared_ptr<ImageData> image = format.image(size, distances);
                image->dim = ImageDim::cube;
                image->layers = 6;
                std::vector<Texel> at;
                for (int i = 0; i < 4000; ++i) {
                    V3 d{any(random), any(random), any(random)};
                    // Every other one within some texels of an edge of the cube.
                    if (i % 2 == 1) d.y = (d.y < 0 ? -1 : 1) * std::fabs(d.x) * (1 + 4 * any(random) / size);
                    const double k = max_component(map(d, [](double x) { return std::fabs(x); }));
                    const double z = along(n, d / k);
                    if (z > near * 1.1 && z < far * 0.9) at.push_back(texel_of(d / k * z));
                }
                const std::string bias = literal(2 * format.quantum()), texel = literal(2.0 / size);
                const std::string text =
                    uber_text("lib/shadow_map.glsl") + "const vec3 n = " + literal(n) +
                    ";\n#define LIT(cosine) shadow_factor_cube(cube, offset_shadow_receiver(p.xyz, n, cosine, " + texel +
                    " * max_component(abs(p.xyz))), " + literal(near) + ", " + literal(far) + ", " + bias + ")\n";
                const std::vector<Texel> lit =
                    evaluate(text,
                             "LIT(cube_axis_cosine(p.xyz, n, " + texel + ")), LIT(cube_axis_cosine(p.xyz, n, 0.0)), " +
                                 "LIT(dot(n, -normalize(p.xyz))), 0.0",
                             at, {{"samplerCubeShadow cube", image, bilinear}});
                for (const Texel& t : lit) toward_axis.add(t[0]), one_axis.add(t[1]), toward_light.add(t[2]);
            }
        std::printf(
            "KILN_SHADOW plane under a point light, %s: %.4f shadowed by the faces' sine, %.4f by one face's, %.4f by the "
            "light's\n",
            format.d16 ? "D16" : "D32F", toward_axis.share(), one_axis.share(), toward_light.share());
        EXPECT_EQ(toward_axis.pixels, 0u) << "of " << toward_axis.of;
        // Planes that lean are under either offset, those that face the light under the right one alone.
        EXPECT_GT(toward_light.pixels, 1000u);
        EXPECT_GT(one_axis.pixels, 50u);
    }
}

}  // namespace
}  // namespace kiln::test
