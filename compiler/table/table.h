#pragma once
// Writes the variant table (.kiln) and its proof. The byte layout is written down in runtime/table_format.h, the proof's in
// proof.h; compiler/runtime reads tables.

#include "compiler/base/jobs.h"
#include "compiler/interfaces/interfaces.h"

namespace kiln {

struct TableInput {
    const Manifest* manifest = nullptr;
    std::string tool_versions;
    std::vector<Target> targets;
    std::vector<std::string> scenes;  // names, for what a miss says; empty: everything legal is needed
    std::vector<StageClasses> stages;
    std::vector<Space*> left_out;  // shaders of which nothing is needed: in the table without stages, so that a miss is told
    const Modules* modules = nullptr;
    const Artifacts* artifacts = nullptr;
    const Interfaces* interfaces = nullptr;
};

struct TableFiles {
    Bytes table;
    Bytes proof;
};

// Deterministic: equal inputs give equal bytes. An Error when two classes of a stage claim the same variant, or when a size
// passes what the format can say.
Result<TableFiles> write_table(const TableInput& input, const Jobs& jobs = Jobs(1));

// A C++17 header with the key's bit fields as constexpr, one namespace a shader.
std::string write_key_header(const TableInput& input);

// The shaders of the input: numbers of their stages in `stages`, in order of first appearance.
std::vector<std::vector<size_t>> stages_by_shader(const std::vector<StageClasses>& stages);

}  // namespace kiln
