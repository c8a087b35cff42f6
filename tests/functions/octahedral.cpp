#include "uber/reference/octahedral.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Octahedral) {
    Functions octahedral("octahedral.glsl");
    octahedral.test(
        "encode_octahedral(n)", [](auto n) { return encode_octahedral(n); }, unit("n"));
    octahedral.test(
        "decode_octahedral(p)", [](auto p) { return decode_octahedral(p); }, vector2("p", linear(-1, 1)));
    // There and back, folds and edges among the samples.
    octahedral
        .test(
            "decode_octahedral(encode_octahedral(n))", [](auto n) { return decode_octahedral(encode_octahedral(n)); }, unit("n"))
        .named("octahedral_there_and_back")
        .truth([](auto n) { return n; }, 0, 1e-6);
    octahedral.run();
}

}  // namespace
}  // namespace kiln::test
