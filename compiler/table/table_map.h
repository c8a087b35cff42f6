#pragma once
// Functions from variants to small numbers, as reduced decision diagrams over the axes of one Diagram, with "open" where
// nothing was said. This is how a stage's classes become one map that asks as little as possible: outside the needed set
// any answer will do.

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "compiler/space/diagram.h"

namespace kiln {

class LeafMaps {
public:
    using Ref = uint32_t;  // a node, a leaf, or open
    static constexpr Ref open = ~0u;
    static Ref leaf(uint32_t value) { return 0x80000000u | value; }
    static bool is_leaf(Ref ref) { return (ref & 0x80000000u) != 0; }  // open counts as one
    static uint32_t value_of(Ref ref) { return ref & 0x7fffffffu; }

    explicit LeafMaps(const Diagram& diagram);

    struct Edge {
        uint32_t last;  // as in Diagram::Edge
        Ref child;
        friend bool operator==(const Edge&, const Edge&) = default;
    };

    // `value` inside the set, open outside.
    Ref from_set(Set set, uint32_t value);
    // Both maps at once; nullopt where they say different things. Maps of disjoint sets always merge.
    std::optional<Ref> merge(Ref a, Ref b);
    // All of them, pairwise, so that each map is copied a logarithmic number of times. All must agree.
    std::optional<Ref> merge_all(std::vector<Ref> maps);
    // The map with the flagged axes forgotten; nullopt when it depends on them somewhere.
    std::optional<Ref> forget(Ref map, const std::vector<bool>& axes);
    // A map that agrees wherever `map` is not open, has no open part (unless it is all open), and asks less.
    Ref close(Ref map);

    // The node that tests `axis`; nullopt unless the runs cover it and every child tests later levels only.
    std::optional<Ref> branch(uint32_t axis, std::vector<Edge> runs);
    // Where the map gives a value whose flag is set, as a set of `diagram`, which has the same axes.
    Set to_set(Ref map, const std::vector<bool>& values, Diagram& diagram) const;
    // The map with every value v replaced by with[v].
    Ref relabel(Ref map, const std::vector<uint32_t>& with);

    uint32_t axis_of(Ref node) const { return order_[nodes_[node].level]; }
    uint32_t level_of_axis(uint32_t axis) const { return level_of_axis_[axis]; }
    uint32_t level_of(Ref ref) const { return is_leaf(ref) ? static_cast<uint32_t>(order_.size()) : nodes_[ref].level; }
    const std::vector<Edge>& edges(Ref node) const { return nodes_[node].edges; }
    Ref child(Ref node, uint32_t digit) const;
    std::vector<uint32_t> support(Ref map) const;  // axes, in the order of their levels
    size_t size(Ref map) const;                    // edges and nodes that it takes to write down
    uint32_t radix(uint32_t axis) const { return radices_[axis]; }

private:
    struct Node {
        uint32_t level;
        std::vector<Edge> edges;
    };
    Ref make(uint32_t level, std::vector<Edge> edges);
    Ref merge_step(Ref a, Ref b);  // conflict_ when they clash
    Ref import(Set set, Ref inside, std::unordered_map<uint32_t, Ref>& seen);
    Ref forget_step(Ref map, const std::vector<bool>& axes, std::unordered_map<Ref, Ref>& seen);
    Set to_set_step(Ref map, const std::vector<bool>& values, Diagram& diagram, std::unordered_map<Ref, Set>& seen) const;
    Ref relabel_step(Ref map, const std::vector<uint32_t>& with, std::unordered_map<Ref, Ref>& seen);
    Ref close_step(Ref map, bool share, std::unordered_map<Ref, Ref>& seen);

    static constexpr Ref conflict_ = 0x7fffffffu;
    const Diagram& diagram_;
    std::vector<uint32_t> radices_, order_, level_of_axis_;
    std::vector<Node> nodes_;
    std::unordered_multimap<uint64_t, Ref> unique_;
    std::unordered_map<uint64_t, Ref> merged_;
    uint64_t budget_ = 0;  // merges that close() may still try
};

}  // namespace kiln
