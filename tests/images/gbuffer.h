#pragma once
// The g-buffer as the device draws it, kept at full precision or in the formats that a renderer would give it, and what the
// deferred passes make of it.

#include "tests/images/variants.h"
#include "uber/reference/deferred.h"

namespace kiln::test {

struct Gbuffer {
    uint32_t size = 0;
    // Four floats a texel, in the order of SurfaceGbuffer: diffuse, specular, normal, irradiance, radiance.
    std::array<std::vector<float>, 5> targets;
    std::vector<float> depth;
    M4 world_of_clip;  // of fp32
};

// object: values of surface's axes in renderer.yaml; the pass is gbuffer.
Gbuffer drawn_gbuffer(const Scene& scene, Values object, uint32_t size = picture_size);

// As RGBA8, RGBA8, RGBA16 signed, RGBA16F, RGBA16F and D32F keep it.
Gbuffer quantised(Gbuffer g);

// A texel as deferred_radiance reads it.
template <class T, class Read>
reference::SurfaceGbuffer<T> texel_of(const Gbuffer& g, size_t pixel, const Read& read) {
    const auto four = [&](size_t target) {
        const float* const x = g.targets[target].data() + 4 * pixel;
        return reference::Vec4<T>{read(x[0]), read(x[1]), read(x[2]), read(x[3])};
    };
    return {four(0), four(1), four(2), four(3), four(4)};
}

// One pass on the device: values of deferred's axes; edits as in variant_of.
RunOutput deferred_pass(const Scene& scene, const Gbuffer& g, const Values& pass, const Edits& edits = {});

// The same by the reference, at a pixel: what it adds, and how much of it the steps of `quantised` may move, to first order.
reference::Vec3<Bounded> deferred_expected(const Scene& scene, const Gbuffer& g, const Values& pass, size_t pixel);
V3 deferred_steps(const Scene& scene, const Gbuffer& g, const Values& pass, size_t pixel);

// Every pixel by itself: body 0 where something was drawn, else -1.
Points pixels_of(const Gbuffer& g);

}  // namespace kiln::test
