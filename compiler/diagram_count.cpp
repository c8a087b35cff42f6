// Counting. A node's count is over the levels from its own down, so an edge that skips levels multiplies by their widths;
// what the levels above add is applied once, at the root.

#include <algorithm>
#include <cassert>

#include "compiler/diagram_body.h"

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

// Counts per digit of every axis in one walk: below a node from the counts, above it by pushing path weights down. A level
// that some paths skip gets what those paths hold in equal shares.
std::vector<std::vector<Count>> Diagram::count_by_digits(Set s) {
    Body& b = *body_;
    const Count total = count(s);
    std::vector<std::vector<Count>> result(b.radices.size());
    for (size_t axis = 0; axis < result.size(); ++axis) result[axis].assign(b.radices[axis], Count());
    if (s == none()) return result;

    const std::vector<Set> order = reachable({&s, 1});
    std::vector<Count> weight(order.size());
    b.marks.start(b.nodes.size());
    for (uint32_t i = 0; i < order.size(); ++i) b.marks.set(order[i].node, i);
    if (!order.empty()) weight.back() = b.product(0, b.nodes[s.node].level);  // the root comes last

    std::vector<Count> tested(b.radices.size());               // members whose path tests the axis
    std::vector<std::vector<Count>> starts(b.radices.size());  // change of the count at a digit: upwards ...
    std::vector<std::vector<Count>> ends(b.radices.size());    // ... and downwards
    for (uint32_t i = static_cast<uint32_t>(order.size()); i-- > 0;) {
        const Body::Node node = b.nodes[order[i].node];
        const uint32_t axis = b.order[node.level];
        if (starts[axis].empty()) {
            starts[axis].resize(b.radices[axis] + 1);
            ends[axis].resize(b.radices[axis] + 1);
        }
        uint32_t first = 0;
        for (const Edge& e : node) {
            const uint32_t begin = first, digits = e.last + 1 - first;
            first = e.last + 1;
            if (e.child.node == 0) continue;
            const uint32_t to = b.nodes[e.child.node].level;
            Count into = weight[i];
            if (to > node.level + 1u) into *= b.product(node.level + 1u, to);
            Count each = into * b.count_below(e.child.node);
            tested[axis] += each * Count(digits);
            starts[axis][begin] += each;
            ends[axis][e.last + 1] += each;
            if (e.child.node > 1) weight[b.marks.get(e.child.node)] += into * Count(digits);
        }
    }
    for (size_t axis = 0; axis < result.size(); ++axis) {
        Count running = (total - tested[axis]).divide(Count(b.radices[axis]), nullptr);
        for (uint32_t d = 0; d < b.radices[axis]; ++d) {
            if (!starts[axis].empty()) {
                running += starts[axis][d];
                running -= ends[axis][d];
            }
            result[axis][d] = running;
        }
    }
    return result;
}

std::vector<Count> Diagram::count_by_digit(Set s, uint32_t axis) { return std::move(count_by_digits(s)[axis]); }

}  // namespace kiln
