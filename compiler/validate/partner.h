#pragma once
// Stages that a pipeline lacks, as GLSL: a full-screen patch for a lone fragment stage, a fragment stage that shows what a lone
// vertex stage puts out.

#include <string>

#include "compiler/validate/device.h"

namespace kiln {

// A vertex stage that draws a full-screen grid (inputs.h) and feeds every one of `inputs`, a fragment stage's, with values
// that vary smoothly over it: in [0.1, 1) when gl_InstanceIndex is 0, of either sign when it is 1; flat integers 0 to 3.
std::string vertex_partner(const std::vector<Varying>& inputs);

// A fragment stage that writes each of `outputs`, those of the stage before it, to an attachment of its own as far as there
// are attachments; an empty one where there is nothing to show.
std::string fragment_partner(const std::vector<Varying>& outputs, uint32_t attachments);
// What that stage writes: one value an attachment, from location 0.
std::vector<Varying> fragment_partner_outputs(const std::vector<Varying>& outputs, uint32_t attachments);

}  // namespace kiln
