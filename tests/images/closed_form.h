#pragma once
// What the scenes of closed form share: a floor under occluders, the share of light that a variant lets through, and what a
// filter's taps make of an edge.

#include "tests/images/variants.h"
#include "uber/reference/shadow_truth.h"

namespace kiln::test {

using Triangles = std::vector<std::array<V3, 3>>;

// A floor y = 0 that is drawn, seen from `eye`; returned with what stands over it, which is in the maps alone. Occluders are in
// the lamp's coordinates: x, and y for z; distance from a lamp lamp_height over the floor, which shines down.
inline constexpr double lamp_height = 10;
Triangles set_floor(Scene& s, const std::vector<reference::Occluder>& occluders, const V3& eye);

struct Seen {
    V3 place;
    double visible = 0;
    size_t pixel = 0;
};

// What share of the light arrives at each pixel: a picture with shadows over one without.
std::vector<Seen> visibility(const Scene& s, Values values, const Edits& edits = {});

Values with(Values v, const std::string& axis, const std::string& value);

// n x n taps over a box of width w along an edge at x = 0 between two texels, lit on the right: each tap is a comparison's ramp,
// a texel wide. side: of a texel, metres.
double taps_along_an_edge(double x, double w, int n, double side);
// What samplers and rounding may add: those of the taps that are on their ramps, by a step of the sampler's weights each.
double taps_allowed(double w, int n, double side);

}  // namespace kiln::test
