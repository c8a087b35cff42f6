#pragma once
// What the diagram's sources share: node storage, the unique table and the computed cache. Included by diagram_*.cpp only.

#include <algorithm>
#include <memory>
#include <vector>

#include "compiler/space/diagram.h"

namespace kiln {

using NodeId = uint32_t;

struct Diagram::Body {
    // 16 bytes. Edges live in chunks that never move, so spans over them stay valid.
    struct Node {
        const Edge* edges = nullptr;
        uint32_t hash = 0;
        uint16_t level = 0;  // terminals: the number of axes
        uint16_t count = 0;
        const Edge* begin() const { return edges; }
        const Edge* end() const { return edges + count; }
    };
    // Operations in the computed cache. Every projection gets a number of its own from `first_projection` on.
    enum Op : uint32_t { op_both = 1, op_either, op_minus, op_subset, op_disjoint, op_cofactor, op_simplify, first_projection };
    struct Cached {
        uint32_t a = 0, b = 0, op = 0, result = 0;
    };
    // A value per node for one walk; starting the next walk forgets them all without touching memory.
    struct Marks {
        std::vector<uint32_t> stamp, value;
        uint32_t now = 0;
        void start(size_t size);
        bool has(NodeId n) const { return stamp[n] == now; }
        uint32_t get(NodeId n) const { return value[n]; }
        void set(NodeId n, uint32_t v) {
            stamp[n] = now;
            value[n] = v;
        }
    };

    Body(std::vector<uint32_t> radices_, std::vector<uint32_t> order_, size_t node_limit);

    std::vector<uint32_t> radices, order;  // order[level] = axis
    std::vector<uint32_t> level_of;        // of an axis
    std::vector<uint32_t> width;           // digits at a level
    std::vector<Node> nodes;
    size_t limit, edge_limit;
    size_t edges_made = 0;
    bool exhausted = false;
    size_t steps_left = ~size_t{0};  // results that may still be worked out
    uint32_t levels() const { return static_cast<uint32_t>(order.size()); }
    static NodeId child(const Node& node, uint32_t digit);
    // The run at or after `from` that holds the digit.
    static const Edge* run_at(const Edge* from, const Edge* end, uint32_t digit) {
        return std::lower_bound(from, end, digit, [](const Edge& e, uint32_t d) { return e.last < d; });
    }

    // Result runs under construction. An operation appends above the base it saw on entry and leaves the stack as it was.
    std::vector<Edge> runs;
    void push_run(size_t base, uint32_t last, NodeId to) {
        if (runs.size() > base && runs.back().child.node == to)
            runs.back().last = last;
        else
            runs.push_back({last, {to}});
    }
    NodeId finish_runs(uint32_t level, size_t base);  // the node of runs[base..], which it pops
    NodeId intern(uint32_t level, const Edge* edges, size_t count);

    bool lookup(uint32_t op, uint32_t a, uint32_t b, uint32_t* result) const;
    void remember(uint32_t op, uint32_t a, uint32_t b, uint32_t result);

    template <uint32_t op>
    NodeId apply(NodeId a, NodeId b);
    bool subset(NodeId a, NodeId b);
    bool disjoint(NodeId a, NodeId b);
    NodeId cofactor(NodeId s, uint32_t level, uint32_t digit);
    NodeId project(NodeId s, const std::vector<bool>& keep_level, uint32_t deepest, uint32_t op);
    NodeId simplify(NodeId s, NodeId care);

    // Members of a node over the levels from its own down, kept for the nodes that were ever counted.
    std::vector<uint32_t> count_slot;  // index into counts, 0: not counted
    std::vector<Count> counts{Count()};
    const Count& count_below(NodeId n);
    Count product(uint32_t from, uint32_t to) const;  // of the widths of levels [from, to)

    // The paths into the nodes of the set whose digits were counted last, so that asking axis after axis walks them once.
    struct Paths {
        Set of;  // none() at first, which is never asked about
        std::vector<Set> order;
        std::vector<Count> weight;                    // assignments of the levels above that lead here, as `order`
        std::vector<std::vector<uint32_t>> at_level;  // places in `order`
    };
    Paths paths;
    void follow_paths(Set s, std::vector<Set> reached);

    std::vector<bool> last_keep;
    uint32_t last_projection = first_projection;
    Marks marks, other_marks;

private:
    void grow_table();
    Edge* allocate(size_t count);

    std::vector<uint32_t> table_;  // open addressing; 0: free
    std::vector<Cached> cache_;
    std::vector<std::unique_ptr<Edge[]>> chunks_;
    Edge* next_edge_ = nullptr;
    size_t edges_left_ = 0, next_chunk_ = 256;
};

}  // namespace kiln
