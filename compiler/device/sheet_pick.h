#pragma once
// Which pipelines a contact sheet shows.

#include "compiler/table/table_read.h"

namespace kiln {

// Indices of `count` pipelines (or all of them) that spread evenly over the pairs of axis values, ascending by variant.
std::vector<size_t> pick_pipelines(const TableShader& shader, size_t count);

// The pipeline of one variant, "axis=value axis=value": axes left out take the first value with which the variant is needed.
// An input Error names what is wrong.
Result<Digits> parse_variant(TableShader& shader, const std::string& text);

// The pipeline that draws the variant, or ~0.
size_t pipeline_of(TableShader& shader, const Digits& variant);

// "point forward pbr_mr two_sided": value names, booleans by their axis, "none" and false left out.
std::string short_label(const Space& space, const Digits& variant);

}  // namespace kiln
