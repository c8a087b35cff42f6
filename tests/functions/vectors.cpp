#include "uber/reference/vectors.h"

#include "tests/functions/function.h"

namespace kiln::test {
namespace {

using namespace reference;

TEST(Functions, Vectors) {
    Functions vectors("vectors.glsl");
    const auto textbook = [](auto v, auto fallback) {
        return max(max(abs(v.x), abs(v.y)), abs(v.z)) > value(1e-37f) ? normalize(v) : fallback;
    };
    vectors
        .test(
            "safe_normalize(v, fallback)", [](auto v, auto fallback) { return safe_normalize(v, fallback); },
            vector3("v", either_sign(1e-37, 8e37).also({1e-37})), unit("fallback"))
        .exactly(textbook);
    // Vulkan bounds no division by more than 2^126 (1 of 127 floats, and there are three): only finite is asked of those.
    vectors
        .test(
            "safe_normalize(v, fallback)", [](auto v, auto fallback) { return safe_normalize(v, fallback); },
            vector3("v", finite()), unit("fallback"))
        .named("safe_normalize_any_finite")
        .exactly(textbook)
        .unbounded(0.3);
    vectors.test(
        "transform_normal(m, n)", [](auto m, auto n) { return transform_normal(m, n); }, matrix3("m", either_sign(1e-3, 1e3)),
        unit("n"));
    vectors.run();
}

}  // namespace
}  // namespace kiln::test
