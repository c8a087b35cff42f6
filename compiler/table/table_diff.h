#pragma once
// Two tables compared by names, since numbers live in one table only. A variant of one table is a variant of the other when
// every axis of either has the same value name in both; an axis that one table lacks counts as at its first value there. All
// numbers are exact and nothing is enumerated.

#include <string>
#include <vector>

#include "compiler/table/table_read.h"

namespace kiln {

struct DiffValue {
    std::string name;
    Count before, after;                           // needed variants that have it
    size_t modules_before = 0, modules_after = 0;  // distinct ones that those variants use
    uint64_t bytes_before = 0, bytes_after = 0;    // of their SPIR-V
};

struct DiffAxis {
    std::string name;
    std::vector<DiffValue> values;
};

struct DiffShader {
    std::string name;
    bool only_before = false, only_after = false;
    std::vector<std::string> axes_lost, axes_added;
    Count before, after;                              // needed variants
    Count added, lost, changed;                       // changed: another module or artifact in some stage
    std::string added_when, lost_when, changed_when;  // describe_condition; empty where there are none
    std::vector<DiffAxis> axes;                       // of both, the first table's first
    bool same() const { return !only_before && !only_after && added.is_zero() && lost.is_zero() && changed.is_zero(); }
};

struct TableDiff {
    uint64_t bytes_before = 0, bytes_after = 0;
    size_t modules_before = 0, modules_after = 0;
    uint64_t spirv_before = 0, spirv_after = 0, packed_before = 0, packed_after = 0;
    std::string tools_before, tools_after;
    std::vector<Target> targets_lost, targets_added;  // artifacts are compared in the targets of both
    std::vector<DiffShader> shaders;                  // the first table's order, then what only the second has
    bool same() const;                                // the same variants with the same contents
};

TableDiff diff_tables(TableView& before, TableView& after);
std::string render(const TableDiff& diff);

}  // namespace kiln
