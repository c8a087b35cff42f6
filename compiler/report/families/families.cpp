#include "compiler/report/families/families.h"

namespace kiln::report {

std::vector<Family> all_families(bool quick) {
    return {diffuse_family(quick), environment_family(quick), specular_family(quick),
            fresnel_family(quick), visibility_family(quick),  shadow_family(quick),
            hair_family(quick),    indirect_family(quick),    specialisation_family(quick)};
}

}  // namespace kiln::report
