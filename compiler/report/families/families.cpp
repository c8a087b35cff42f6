#include "compiler/report/families/families.h"

namespace kiln::report {

std::vector<Family> all_families(bool quick, const std::string& bc_encoder) {
    std::vector<Family> out;
    for (Family (*const make)(bool) : {diffuse_family, environment_family, specular_family, fresnel_family, visibility_family,
                                       shadow_family, cascade_family, precision_family})
        out.push_back(make(quick));
    out.push_back(lightmap_family(quick, bc_encoder));
    for (Family (*const make)(bool) : {subsurface_family, hair_family, indirect_family, specialisation_family})
        out.push_back(make(quick));
    return out;
}

}  // namespace kiln::report
