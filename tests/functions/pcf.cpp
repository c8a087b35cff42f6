#include "uber/reference/pcf.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Pcf) {
    Functions pcf("pcf.glsl");
    pcf.test(
        "turned(point, cos_sin)", [](auto point, auto cos_sin) { return turned(point, cos_sin); },
        vector2("point", linear(-1, 1)), vector2("cos_sin", linear(-1, 1)));
    // Integers and a division by a power of two: exact.
    pcf.test(
           "pixel_hash(uvec2(x, y)) + zero",
           [](auto zero, uint32_t x, uint32_t y) { return zero + decltype(zero)(pixel_hash(x, y)); }, number("zero", values({0})),
           bits("x"), bits("y"))
        .undecided(0)
        .unbounded(0);
    pcf.run();
}

}  // namespace
}  // namespace kiln::test
