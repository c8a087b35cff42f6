#pragma once
// Reflection together with the ids that it speaks of, for whoever edits the module before translating it.

#include "compiler/reflect/module_view.h"
#include "compiler/reflect/reflect.h"

namespace kiln {

struct DeclaredResource {
    uint32_t variable = 0;
    uint32_t type = 0;  // without arrays; of a block, its structure
    Resource resource;
};

struct Reflected {
    Reflection reflection;  // its `resources` are empty: they are below
    std::vector<DeclaredResource> resources;
};

Result<Reflected> reflect_view(const ir::View& view);

}  // namespace kiln
