#pragma once
// Pictures of the study shaders (manifests/library.yaml) against the same functions in double: every legal variant, every pixel.

#include <gtest/gtest.h>

#include "tests/images/variants.h"

namespace kiln::test {

// Of one pixel at a place of the screen: rgb.
using StudyPixel = std::function<reference::Vec3<Bounded>(const reference::Vec2<Bounded>& uv)>;

// A texture of four floats a texel, as a study shader reads it.
NamedTexture study_texture(const reference::Texture2D& from);
NamedTexture study_texture(const reference::CubeArray& from);  // one cube

// Draws a variant and judges it. `most_masked`: the share of the pixels that may have too close a decision or too wide a bound.
Judged hold_study(const std::string& shader, const Values& values, const NamedInputs& inputs, const StudyPixel& expected,
                  double most_masked, const Edits& edits = {});

}  // namespace kiln::test
