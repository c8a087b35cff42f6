#pragma once
// One function a built-in family, each in a file named after it.

#include "compiler/report/family.h"

namespace kiln::report {

Family diffuse_family(bool quick);
Family environment_family(bool quick);
Family specular_family(bool quick);
Family specialisation_family(bool quick);
Family indirect_family(bool quick);
Family cascade_family(bool quick);
Family fresnel_family(bool quick);
Family lightmap_family(bool quick, const std::string& bc_encoder);
Family precision_family(bool quick);
Family subsurface_family(bool quick);
Family hair_family(bool quick);
Family shadow_family(bool quick);
Family visibility_family(bool quick);

}  // namespace kiln::report
