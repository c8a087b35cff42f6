// Members in the order of the axes' indices, whatever order the diagram tests them in: the smallest one, rank and unrank by
// counting under a fixed prefix, and enumeration by fixing one axis after the other.

#include <algorithm>
#include <cassert>

#include "compiler/space/diagram_body.h"

namespace kiln {

namespace {

// One set, copied out flat, with a range of allowed digits per level. Makes no nodes.
class Restricted {
public:
    Restricted(const Diagram& diagram, Set s) : diagram_(diagram) {
        const size_t levels = diagram.order().size();
        low_.assign(levels, 0);
        for (const uint32_t axis : diagram.order()) high_.push_back(diagram.radices()[axis] - 1);
        const std::vector<Set> order = diagram.reachable({&s, 1});
        // Places 0 and 1 are the terminals.
        std::vector<std::pair<uint32_t, uint32_t>> place;
        level_.assign(2, static_cast<uint32_t>(levels));
        for (const Set n : order) {
            place.push_back({n.node, static_cast<uint32_t>(level_.size())});
            level_.push_back(diagram.level_of_axis(diagram.axis_of(n)));
        }
        std::sort(place.begin(), place.end());
        first_edge_.assign(3, 0);
        for (const Set n : order) {
            for (const Diagram::Edge& e : diagram.edges(n)) {
                uint32_t to = e.child.node;
                if (to > 1) to = std::lower_bound(place.begin(), place.end(), std::pair{to, 0u})->second;
                edges_.push_back({e.last, to});
            }
            first_edge_.push_back(edges_.size());
        }
        root_ = order.empty() ? s.node : static_cast<uint32_t>(level_.size() - 1);
    }

    void allow(uint32_t axis, uint32_t low, uint32_t high) {
        low_[diagram_.level_of_axis(axis)] = low;
        high_[diagram_.level_of_axis(axis)] = high;
    }

    Count count() {
        count_below();
        return product(0, level_[root_], ~0u) * below_[root_];
    }

    std::vector<Count> by_digit(uint32_t axis) {
        const uint32_t level = diagram_.level_of_axis(axis), radix = diagram_.radices()[axis];
        count_below();
        std::vector<Count> rise(radix + 1), fall(radix + 1);
        std::vector<Count> weight(level_.size());
        Count skipped;  // what every digit gets from paths that do not test the axis
        weight[root_] = product(0, level_[root_], level);
        if (level_[root_] > level) skipped = weight[root_] * below_[root_];
        for (uint32_t n = root_; n > 1; --n) {
            if (level_[n] > level || weight[n].is_zero()) continue;
            each_run(n, [&](uint32_t first, uint32_t last, uint32_t to) {
                if (level_[n] == level) {
                    const Count each = weight[n] * product(level + 1, level_[to], ~0u) * below_[to];
                    rise[first] += each;
                    fall[last + 1] += each;
                } else {
                    const Count into = weight[n] * Count(last + 1 - first) * product(level_[n] + 1, level_[to], level);
                    if (level_[to] > level)
                        skipped += into * below_[to];
                    else
                        weight[to] += into;
                }
            });
        }
        std::vector<Count> counts;
        Count running = skipped;
        for (uint32_t d = 0; d < radix; ++d) {
            running += rise[d];
            running -= fall[d];
            counts.push_back(running);
        }
        return counts;
    }

private:
    struct FlatEdge {
        uint32_t last, to;
    };

    // The parts of a node's runs that are allowed and lead anywhere.
    template <class Visit>
    void each_run(uint32_t n, const Visit& visit) const {
        const uint32_t low = low_[level_[n]], high = high_[level_[n]];
        uint32_t first = 0;
        for (size_t e = first_edge_[n]; e < first_edge_[n + 1]; ++e) {
            const uint32_t from = std::max(first, low), to = std::min(edges_[e].last, high);
            first = edges_[e].last + 1;
            if (from <= to && edges_[e].to != 0) visit(from, to, edges_[e].to);
        }
    }

    Count product(uint32_t from, uint32_t to, uint32_t except) const {
        Count total(1);
        uint64_t part = 1;
        for (uint32_t level = from; level < to; ++level) {
            const uint64_t width = level == except ? 1 : high_[level] + 1u - low_[level];
            uint64_t next = 0;
            if (__builtin_mul_overflow(part, width, &next)) {
                total *= Count(part);
                next = width;
            }
            part = next;
        }
        return total *= Count(part);
    }

    void count_below() {
        below_.assign(level_.size(), Count());
        below_[1] = Count(1);
        for (uint32_t n = 2; n < level_.size(); ++n)
            each_run(n, [&](uint32_t first, uint32_t last, uint32_t to) {
                below_[n] += Count(last + 1 - first) * product(level_[n] + 1, level_[to], ~0u) * below_[to];
            });
    }

    const Diagram& diagram_;
    std::vector<uint32_t> low_, high_;  // per level, inclusive
    std::vector<uint32_t> level_;       // per place; children before parents
    std::vector<size_t> first_edge_;    // per place, and the end
    std::vector<FlatEdge> edges_;
    std::vector<Count> below_;
    uint32_t root_ = 0;
};

}  // namespace

std::optional<Digits> Diagram::witness(Set s) {
    if (s == none()) return std::nullopt;
    Body& b = *body_;
    Digits digits(b.radices.size(), 0);
    constexpr uint32_t free = ~0u, no_digit = ~0u;
    std::vector<uint32_t> fixed(b.levels(), free);
    const std::vector<uint32_t> tested = support(s);
    uint32_t deepest_fixed = 0;  // below this level every node but 0 leads somewhere

    // Whether a member under `n` agrees with what is fixed.
    const auto feasible = [&](const auto& self, NodeId n) -> bool {
        if (n <= 1) return n == 1;
        const Body::Node& node = b.nodes[n];
        if (node.level > deepest_fixed) return true;
        if (b.marks.has(n)) return b.marks.get(n) != 0;
        bool found = false;
        if (fixed[node.level] != free) {
            found = self(self, Body::child(node, fixed[node.level]));
        } else {
            for (const Edge* e = node.begin(); !found && e != node.end(); ++e) found = self(self, e->child.node);
        }
        b.marks.set(n, found);
        return found;
    };
    // The smallest digit that members under `n` have at `level`, agreeing with what is fixed.
    const auto smallest = [&](const auto& self, NodeId n, uint32_t level) -> uint32_t {
        if (n == 0) return no_digit;
        const Body::Node& node = b.nodes[n];
        if (node.level > level) return feasible(feasible, n) ? 0 : no_digit;
        if (b.other_marks.has(n)) return b.other_marks.get(n);
        uint32_t best = no_digit, first = 0;
        if (node.level == level) {
            for (const Edge* e = node.begin(); best == no_digit && e != node.end(); ++e) {
                if (feasible(feasible, e->child.node)) best = first;
                first = e->last + 1;
            }
        } else if (fixed[node.level] != free) {
            best = self(self, Body::child(node, fixed[node.level]), level);
        } else {
            for (const Edge* e = node.begin(); best != 0 && e != node.end(); ++e)
                best = std::min(best, self(self, e->child.node, level));
        }
        b.other_marks.set(n, best);
        return best;
    };

    for (const uint32_t axis : tested) {
        const uint32_t level = b.level_of[axis];
        b.marks.start(b.nodes.size());
        b.other_marks.start(b.nodes.size());
        digits[axis] = smallest(smallest, s.node, level);
        assert(digits[axis] != no_digit);
        fixed[level] = digits[axis];
        deepest_fixed = std::max(deepest_fixed, level);
    }
    return digits;
}

Count Diagram::rank(Set s, const Digits& member) {
    assert(contains(s, member));
    Restricted within(*this, s);
    Count before;
    for (uint32_t axis = 0; axis < member.size(); ++axis) {
        if (member[axis] > 0) {
            within.allow(axis, 0, member[axis] - 1);
            before += within.count();
        }
        within.allow(axis, member[axis], member[axis]);
    }
    return before;
}

std::optional<Digits> Diagram::unrank(Set s, const Count& rank) {
    if (rank >= count(s)) return std::nullopt;
    Restricted within(*this, s);
    Digits digits;
    Count left = rank;
    for (uint32_t axis = 0; axis < radices().size(); ++axis) {
        const std::vector<Count> counts = within.by_digit(axis);
        uint32_t digit = 0;
        while (left >= counts[digit]) left -= counts[digit++];
        digits.push_back(digit);
        within.allow(axis, digit, digit);
    }
    return digits;
}

namespace {

// Fixes axis after axis in a diagram of its own, which is thrown away and refilled when it has grown: enumerating a large
// set takes bounded memory and leaves the caller's diagram as it was.
class Enumeration {
public:
    Enumeration(const Diagram& from, Set s, const std::function<bool(const Digits&)>& visit)
        : from_(from), set_(s), visit_(visit), digits_(from.radices().size(), 0), at_(from.radices().size() + 1) {}

    bool run() {
        refill(0);
        return step(0);
    }

private:
    static constexpr size_t slack = 1u << 20;  // nodes beyond those of the set itself

    void refill(uint32_t fixed) {
        scratch_ = std::make_unique<Diagram>(from_.radices(), from_.order(), ~size_t{0});
        at_[0] = scratch_->import(from_, set_);
        first_nodes_ = scratch_->nodes();
        for (uint32_t axis = 0; axis < fixed; ++axis) at_[axis + 1] = scratch_->cofactor(at_[axis], axis, digits_[axis]);
    }

    // The last digits of the runs over which the cofactor of at_[axis] cannot change.
    std::vector<uint32_t> runs(uint32_t axis) const {
        std::vector<uint32_t> lasts{from_.radices()[axis] - 1};
        const Set s = at_[axis];
        if (s == Diagram::all()) return lasts;
        if (scratch_->axis_of(s) == axis) {
            lasts.clear();
            for (const Diagram::Edge& e : scratch_->edges(s)) lasts.push_back(e.last);
            return lasts;
        }
        if (scratch_->level_of_axis(scratch_->axis_of(s)) > scratch_->level_of_axis(axis)) return lasts;
        for (const Set n : scratch_->reachable({&s, 1}))
            if (scratch_->axis_of(n) == axis)
                for (const Diagram::Edge& e : scratch_->edges(n)) lasts.push_back(e.last);
        std::sort(lasts.begin(), lasts.end());
        lasts.erase(std::unique(lasts.begin(), lasts.end()), lasts.end());
        return lasts;
    }

    bool step(uint32_t axis) {
        if (axis == digits_.size()) return visit_(digits_);
        uint32_t digit = 0;
        for (const uint32_t last : runs(axis)) {
            for (; digit <= last; ++digit) {
                digits_[axis] = digit;
                if (scratch_->nodes() > first_nodes_ + slack) refill(axis);
                at_[axis + 1] = scratch_->cofactor(at_[axis], axis, digit);
                if (at_[axis + 1] == Diagram::none()) {
                    digit = last + 1;
                    break;
                }
                if (!step(axis + 1)) return false;
            }
        }
        digits_[axis] = 0;
        return true;
    }

    const Diagram& from_;
    Set set_;
    const std::function<bool(const Digits&)>& visit_;
    Digits digits_;
    std::vector<Set> at_;  // at_[i]: the set with axes below i fixed
    std::unique_ptr<Diagram> scratch_;
    size_t first_nodes_ = 0;
};

}  // namespace

void Diagram::enumerate(Set s, const std::function<bool(const Digits&)>& visit) {
    if (s != none()) Enumeration(*this, s, visit).run();
}

}  // namespace kiln
