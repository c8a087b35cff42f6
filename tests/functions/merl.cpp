#include "uber/reference/merl.h"

#include "tests/functions/merl_tables.h"

namespace kiln::test {
namespace {

using namespace reference;

template <class T>
T as(int i) {
    return T(static_cast<double>(i));
}

TEST(Functions, Merl) {
    Functions merl("merl.glsl");
    // phi_d jumps from 180 to 0, and where h is within rounding of n, or l of h, it may be anything: its bound says so.
    merl.test(
        "merl_coordinates(n, l, h)", [](auto n, auto h, auto l) { return merl_coordinates(n, l, h); }, unit("n"),
        near("h", "n", 1.5), near("l", "h", 1.5));
    merl.test(
            "vec3 c = vec3(x, y, z); ivec3 b = merl_bin(c); result = vec4(b, merl_index(b));",
            [](auto x, auto y, auto z) {
                using T = decltype(x);
                const std::array<int, 3> b = merl_bin({value(x), value(y), value(z)});
                return Vec4<T>{as<T>(b[0]), as<T>(b[1]), as<T>(b[2]), as<T>(merl_index(b))};
            },
            number("x", linear(0, 90)), number("y", linear(0, 90)), number("z", linear(0, 179.999)))
        .named("merl_bin");
    // Of the weights only which bin they belong to may be open, where a coordinate is a centre.
    merl.test(
            "MerlCorners m = merl_corners(vec3(x, y, z)); result = mat3(m.low, m.high, m.weight);",
            [](auto x, auto y, auto z) {
                using T = decltype(x);
                const MerlCorners m = merl_corners({value(x), value(y), value(z)});
                const Vec3<T> shifted = Vec3<T>{x, y, z} - T(0.5);
                const Vec3<T> weight = shifted - map(shifted, [](const T& c) { return T(floor(c)); });
                const auto vector = [](const std::array<int, 3>& b) { return Vec3<T>{as<T>(b[0]), as<T>(b[1]), as<T>(b[2])}; };
                return Mat3<T>{{vector(m.low), vector(m.high), weight}};
            },
            number("x", linear(0, 90)), number("y", linear(0, 90)), number("z", linear(0, 179.999)))
        .named("merl_corners");
    merl.test(
        "merl_reflectance(stored)", [](auto stored) { return merl_reflectance(stored); },
        vector3("stored", either_sign(1e-3, 1e6)));

    // Gold of roughness 0.3 in a texture: coordinates at random, on centres and on bins' edges.
    static const MerlTable table(gold(0.3));
    merl.texture("sampler3D table", table.image(), merl_sampler);
    const auto coordinates = [](double last) { return linear(0, last).also({0.5, 1, 44.5, 45, last / 2, last - 0.5}); };
    const auto texel = [](auto x) {
        using T = decltype(x);
        return [](int h, int d, int phi) { return table.read<T>(h, d, phi); };
    };
    merl.test(
            "merl_lookup_nearest(table, vec3(x, y, z))",
            [texel](auto x, auto y, auto z) {
                return merl_lookup_nearest(texel(x), Vec3<decltype(x)>{x, y, z});
            },
            number("x", coordinates(90)), number("y", coordinates(90)), number("z", coordinates(179.999)))
        .named("merl_lookup_nearest");
    merl.test(
            "merl_lookup(table, vec3(x, y, z))",
            [texel](auto x, auto y, auto z) {
                return merl_lookup(texel(x), Vec3<decltype(x)>{x, y, z});
            },
            number("x", coordinates(90)), number("y", coordinates(90)), number("z", coordinates(179.999)))
        .named("merl_lookup");
    merl.run();
}

}  // namespace
}  // namespace kiln::test
