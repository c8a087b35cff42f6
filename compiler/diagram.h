#pragma once
// Sets of variants as nodes of one reduced, ordered, multi-valued decision diagram with shared nodes. Equal sets are the
// same node, so equality is one comparison; counts never enumerate. Not safe to use from two threads at once.
//
// A Diagram is over axes 0..n-1 with `radices[i]` digits each; `order` says which axis is tested at which level. Edges are
// runs of neighbouring digits with one child, so an axis of thousands of values asked one question costs a few edges.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compiler/axis.h"
#include "compiler/count.h"

namespace kiln {

struct Set {
    uint32_t node = 0;  // 0: empty, 1: everything
    friend auto operator<=>(const Set&, const Set&) = default;
};

class Diagram {
public:
    static constexpr size_t default_node_limit = 10'000'000;
    Diagram(std::vector<uint32_t> radices, std::vector<uint32_t> order, size_t node_limit = default_node_limit);
    Diagram(const Diagram&) = delete;
    Diagram& operator=(const Diagram&) = delete;
    ~Diagram();

    static Set none() { return {0}; }
    static Set all() { return {1}; }
    Set where(uint32_t axis, const std::vector<bool>& digits);  // the digits whose flag is set
    Set where(uint32_t axis, uint32_t digit);
    Set point(const Digits& digits);
    Set both(Set a, Set b);
    Set either(Set a, Set b);
    Set minus(Set a, Set b);
    Set complement(Set a) { return minus(all(), a); }
    bool subset(Set a, Set b) { return minus(a, b) == none(); }
    bool disjoint(Set a, Set b) { return both(a, b) == none(); }
    bool contains(Set s, const Digits& digits) const;
    Set cofactor(Set s, uint32_t axis, uint32_t digit);  // with the axis fixed, then free
    Set project(Set s, const std::vector<bool>& keep);   // for some digits of the axes not kept
    std::vector<uint32_t> support(Set s) const;          // axes it depends on, ascending

    Count count(Set s);                                       // members, over all axes
    std::vector<Count> count_by_digit(Set s, uint32_t axis);  // one per digit
    std::optional<Digits> witness(Set s);                     // the smallest member, axes compared in index order
    Count rank(Set s, const Digits& member);                  // its place among the members, axes in index order
    std::optional<Digits> unrank(Set s, const Count& rank);
    // Calls visit for every member in ascending order (axes in index order) until it returns false.
    void enumerate(Set s, const std::function<bool(const Digits&)>& visit);

    // Structure, for whoever writes a diagram down. Terminals (nodes 0 and 1) have no axis.
    struct Edge {
        uint32_t last;  // the run's last digit, inclusive; the run begins after the edge before
        Set child;
    };
    uint32_t axis_of(Set s) const;
    std::span<const Edge> edges(Set s) const;

    const std::vector<uint32_t>& radices() const;
    const std::vector<uint32_t>& order() const;
    size_t nodes() const;
    // True once an operation ran past the node limit; results since then are meaningless.
    bool exhausted() const;

private:
    struct Body;
    std::unique_ptr<Body> body_;
};

}  // namespace kiln
