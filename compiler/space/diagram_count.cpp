// Counting. A node's count is over the levels from its own down, so an edge that skips levels multiplies by their widths;
// what the levels above add is applied once, at the root.

#include <algorithm>
#include <cassert>

#include "compiler/space/diagram_body.h"

namespace kiln {

Count Diagram::Body::product(uint32_t from, uint32_t to) const {
    // Word by word, so that long arithmetic is done once a word and not once a level.
    Count total(1);
    uint64_t part = 1;
    for (uint32_t level = from; level < to; ++level) {
        uint64_t next = 0;
        if (__builtin_mul_overflow(part, uint64_t{width[level]}, &next)) {
            total *= Count(part);
            next = width[level];
        }
        part = next;
    }
    return total *= Count(part);
}

const Count& Diagram::Body::count_below(NodeId n) {
    // Terminals need no slot: slot 0 is zero, slot 1 is one.
    if (counts.size() == 1) counts.push_back(Count(1));
    if (n <= 1) return counts[n];
    if (count_slot.size() < nodes.size()) count_slot.resize(nodes.size(), 0);
    if (count_slot[n] != 0) return counts[count_slot[n]];
    const Node node = nodes[n];
    Count total;
    uint32_t first = 0;
    for (const Edge& e : node) {
        const uint64_t digits = e.last + 1 - first;
        first = e.last + 1;
        if (e.child.node == 0) continue;
        Count part = count_below(e.child.node);
        const uint32_t to = nodes[e.child.node].level;
        if (to > node.level + 1u) part *= product(node.level + 1u, to);
        if (digits != 1) part *= Count(digits);
        total += part;
    }
    count_slot[n] = static_cast<uint32_t>(counts.size());
    counts.push_back(std::move(total));
    return counts.back();
}

Count Diagram::count(Set s) {
    Body& b = *body_;
    Count total = b.count_below(s.node);
    if (!total.is_zero()) total *= b.product(0, b.nodes[s.node].level);
    return total;
}

void Diagram::Body::follow_paths(Set s, std::vector<Set> reached) {
    paths.of = s;
    paths.order = std::move(reached);
    paths.weight.assign(paths.order.size(), Count());
    paths.at_level.assign(levels(), {});
    marks.start(nodes.size());
    for (uint32_t i = 0; i < paths.order.size(); ++i) marks.set(paths.order[i].node, i);
    if (!paths.order.empty()) paths.weight.back() = product(0, nodes[s.node].level);  // the root comes last
    for (uint32_t i = static_cast<uint32_t>(paths.order.size()); i-- > 0;) {
        const Node node = nodes[paths.order[i].node];
        paths.at_level[node.level].push_back(i);
        uint32_t first = 0;
        for (const Edge& e : node) {
            const uint64_t digits = e.last + 1 - first;
            first = e.last + 1;
            if (e.child.node <= 1) continue;
            const uint32_t to = nodes[e.child.node].level;
            Count into = paths.weight[i] * Count(digits);
            if (to > node.level + 1u) into *= product(node.level + 1u, to);
            paths.weight[marks.get(e.child.node)] += into;
        }
    }
}

// Below a node from its count, above it from the weight of the paths that lead there. Paths that skip the axis's level share
// what they hold equally among its digits.
std::vector<Count> Diagram::count_by_digit(Set s, uint32_t axis) {
    Body& b = *body_;
    const uint32_t level = b.level_of[axis], radix = b.radices[axis];
    if (s == none()) return std::vector<Count>(radix);
    const Count total = count(s);
    if (b.paths.of != s) b.follow_paths(s, reachable({&s, 1}));
    Count tested;  // members whose path tests the axis
    std::vector<Count> rise(radix + 1), fall(radix + 1);
    for (const uint32_t i : b.paths.at_level[level]) {
        uint32_t first = 0;
        for (const Edge& e : b.nodes[b.paths.order[i].node]) {
            const uint32_t begin = first;
            first = e.last + 1;
            if (e.child.node == 0) continue;
            Count each = b.paths.weight[i] * b.count_below(e.child.node);
            const uint32_t to = b.nodes[e.child.node].level;
            if (to > level + 1) each *= b.product(level + 1, to);
            tested += each * Count(first - begin);
            rise[begin] += each;
            fall[first] += each;
        }
    }
    std::vector<Count> counts;
    Count running = (total - tested).divide(Count(radix), nullptr);
    for (uint32_t d = 0; d < radix; ++d) {
        running += rise[d];
        running -= fall[d];
        counts.push_back(running);
    }
    return counts;
}

std::vector<std::vector<Count>> Diagram::count_by_digits(Set s) {
    std::vector<std::vector<Count>> counts;
    for (uint32_t axis = 0; axis < body_->radices.size(); ++axis) counts.push_back(count_by_digit(s, axis));
    return counts;
}

}  // namespace kiln
