#pragma once
// Leaf maps as node words of the table (grammar: runtime/table_format.h).

#include <optional>
#include <vector>

#include "compiler/table/table_map.h"

namespace kiln {

struct NodeWords {
    std::vector<uint32_t> words;
    uint32_t root = 0;           // a ref of the format
    std::vector<uint32_t> axes;  // those that it tests, ascending
};

// `fields` has one key field per axis; every leaf is below `leaves`. Small maps become dense arrays, which take one load
// however many axes they ask.
NodeWords write_nodes(const LeafMaps& maps, LeafMaps::Ref map, const std::vector<uint32_t>& fields, uint32_t leaves);

// The map that node words stand for, as the runtime reader walks them; nullopt when they are malformed or do not keep the
// diagram's order of axes.
std::optional<LeafMaps::Ref> read_nodes(LeafMaps& maps, const std::vector<uint32_t>& words, uint32_t root, uint32_t leaves,
                                        const std::vector<uint32_t>& fields);

}  // namespace kiln
