#pragma once
// Sets of variants as nodes of one reduced, ordered, multi-valued decision diagram with shared nodes. Equal sets are the
// same node, so equality is one comparison; counts never enumerate. Not safe to use from two threads at once.
//
// A Diagram is over axes 0..n-1 with `radices[i]` digits each; `order` says which axis is tested at which level. Edges are
// runs of neighbouring digits with one child, so an axis of thousands of values asked one question costs a few edges.
// At most 65,534 axes and 65,535 digits an axis; nodes live as long as the diagram. The node limit bounds edges as well, at
// eight a node (and never below a million).

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "compiler/manifest/axis.h"
#include "compiler/space/count.h"

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
    Set choose(Set condition, Set then, Set otherwise);
    bool subset(Set a, Set b);    // makes no nodes
    bool disjoint(Set a, Set b);  // makes no nodes
    bool contains(Set s, const Digits& digits) const;
    Set cofactor(Set s, uint32_t axis, uint32_t digit);  // with the axis fixed, then free
    Set project(Set s, const std::vector<bool>& keep);   // for some digits of the axes not kept
    // A set that agrees with `s` on `care` and is free outside, chosen to ask less; `care` must not be empty.
    Set simplify(Set s, Set care);
    std::vector<uint32_t> support(Set s) const;               // axes it depends on, ascending
    std::vector<std::vector<bool>> digits_used(Set s) const;  // per axis, the digits that some member has

    Count count(Set s);                                       // members, over all axes
    std::vector<Count> count_by_digit(Set s, uint32_t axis);  // one per digit
    std::vector<std::vector<Count>> count_by_digits(Set s);   // the same of every axis
    std::optional<Digits> witness(Set s);                     // the smallest member, axes compared in index order
    Count rank(Set s, const Digits& member);                  // its place among the members, axes in index order
    std::optional<Digits> unrank(Set s, const Count& rank);   // none when the rank is not below the count
    // Calls visit for every member in ascending order (axes in index order) until it returns false.
    void enumerate(Set s, const std::function<bool(const Digits&)>& visit);

    // Structure, for whoever writes a diagram down. Terminals (nodes 0 and 1) have no axis. Spans stay valid.
    struct Edge {
        uint32_t last;  // the run's last digit, inclusive; the run begins after the edge before
        Set child;
    };
    uint32_t axis_of(Set s) const;
    std::span<const Edge> edges(Set s) const;
    // The set that is `child` where the axis has a digit of the run; runs must cover the axis. Cheap when every child tests
    // only axes of later levels, right in any case.
    Set branch(uint32_t axis, std::span<const Edge> runs);
    // The same set from a diagram over the same radices, whatever its order.
    Set import(const Diagram& from, Set s);
    // Nodes that are reachable from these sets, terminals left out: children before parents.
    std::vector<Set> reachable(std::span<const Set> roots) const;

    const std::vector<uint32_t>& radices() const;
    const std::vector<uint32_t>& order() const;
    uint32_t level_of_axis(uint32_t axis) const;
    size_t nodes() const;
    size_t node_limit() const;
    // True once an operation ran past the node limit or the steps; results since then are meaningless.
    bool exhausted() const;
    // For questions that may stay unanswered: so many results more are worked out. Few nodes can still mean years, since the
    // cache of results is bounded.
    void limit_steps(size_t steps);

private:
    struct Body;
    std::unique_ptr<Body> body_;
};

}  // namespace kiln
