#pragma once
// The shipped surface shader: from its table, as an engine draws it, and from its text, for shaders that are wrong on purpose.

#include <map>

#include "compiler/validate/device.h"
#include "tests/images/picture.h"

namespace kiln::test {

// Axis name to value name.
using Values = std::map<std::string, std::string>;

struct Variant {
    std::string name;
    Values values;
    std::vector<StageCode> stages;
};

// Every distinct pipeline of a manifest below manifests/, with one of its variants each, as its table has it.
std::vector<Variant> pipelines_of(const std::string& manifest);

// What is replaced in the text of a fragment stage, everywhere; it must be there.
using Edits = std::vector<std::pair<std::string, std::string>>;

// One variant of a shader straight from GLSL; axes that are left out have their first value.
Variant variant_of(const std::string& manifest, const std::string& shader, const Values& values, const Edits& edits = {});
inline Variant surface_variant(const Values& values, const Edits& edits = {}) {
    return variant_of("surface.yaml", "surface", values, edits);
}

// Legal variants of a shader among which every pair of values that some legal variant has is there once; each picked at
// random from all legal ones with a pair that the others lack, by `seed`.
std::vector<Values> pairwise(const std::string& manifest, const std::string& shader, uint64_t seed);

// All of them; for shaders with few.
std::vector<Values> legal(const std::string& manifest, const std::string& shader);

reference::SurfaceAxes axes_of(const Values& values);

// Draws one pipeline, once for each of the inputs. A message of the validation layer fails the test; what comes back has
// one run for each of the inputs in any case.
std::vector<RunOutput> draw(const std::vector<StageCode>& stages, const std::vector<NamedInputs>& inputs,
                            uint32_t size = picture_size);

// The device's own varyings of a vertex stage: points whose inputs are what the fragment stage gets, within four units of
// the last place, as another pipeline may round an interpolation otherwise; where the reference knows it closer, within that.
Points drawn_points(const StageCode& vertex, const NamedInputs& inputs, const Points& reference);

// What the variant's outputs are to hold, by the name of the output. additive: the light alone.
std::map<std::string, Expect> expectations(const Values& values, const Scene& scene, bool additive = false);

}  // namespace kiln::test
