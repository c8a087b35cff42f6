#include "uber/reference/octahedral.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Octahedral) {
    Functions octahedral("octahedral.glsl");
    octahedral.test(
        "encode_octahedral(n)", [](auto n) { return encode_octahedral(n); }, unit("n"));
    octahedral.run();
}

}  // namespace
}  // namespace kiln::test
