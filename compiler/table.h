#pragma once
// Writes the variant table (.kiln) and its proof. The byte layout is written down in table_format.h; compiler/runtime reads it.

#include "compiler/interfaces.h"

namespace kiln {

struct TableInput {
    const Manifest* manifest = nullptr;
    std::string tool_versions;
    std::vector<Target> targets;
    std::vector<StageClasses> stages;
    const Modules* modules = nullptr;
    const Artifacts* artifacts = nullptr;
    const Interfaces* interfaces = nullptr;
};

struct TableFiles {
    Bytes table;
    Bytes proof;
};

// Deterministic: equal inputs give equal bytes.
Result<TableFiles> write_table(const TableInput& input);

// A C++ header with the key's bit fields as constexpr, one namespace a shader.
std::string write_key_header(const TableInput& input);

}  // namespace kiln
