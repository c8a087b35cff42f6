// Asking for each of n rules what the n-1 others leave would cost n conjunctions of everything. Instead the list is halved
// again and again, each half being looked at with the conjunction of all rules outside it at hand, down to blocks: inside a
// block only the block's own rules are conjoined, and the last step is a disjointness walk that makes no nodes.

#include "compiler/space/implied.h"

#include <algorithm>
#include <cassert>

namespace kiln {

namespace {

constexpr size_t block_size = 16;
constexpr size_t most_for_pairs = 2'000;
constexpr size_t most_for_triples = 64;

class Implied {
public:
    Implied(Diagram& diagram, std::span<const Set> allowed) : d_(diagram), allowed_(allowed), implied_(allowed.size(), false) {}

    std::vector<bool> run() {
        look(0, allowed_.size(), Diagram::all());
        return implied_;
    }

private:
    Set conjunction(size_t from, size_t to) {
        if (from >= to) return Diagram::all();
        if (to - from == 1) return allowed_[from];
        const size_t middle = from + (to - from) / 2;
        return d_.both(conjunction(from, middle), conjunction(middle, to));
    }

    void look(size_t from, size_t to, Set outside) {
        if (d_.exhausted()) return;
        if (to - from > block_size) {
            const size_t middle = from + (to - from) / 2;
            look(from, middle, d_.both(outside, conjunction(middle, to)));
            look(middle, to, d_.both(outside, conjunction(from, middle)));
            return;
        }
        for (size_t i = from; i < to; ++i) {
            const Set others = d_.both(conjunction(from, i), conjunction(i + 1, to));
            implied_[i] = d_.disjoint(outside, d_.minus(others, allowed_[i]));
        }
    }

    Diagram& d_;
    std::span<const Set> allowed_;
    std::vector<bool> implied_;
};

// From each pass the set that empties the conjunction is needed; those after it are not.
std::vector<uint32_t> irreducible_clash(Diagram& d, std::span<const Set> allowed, std::vector<uint32_t> order) {
    std::vector<uint32_t> needed;
    Set fixed = Diagram::all();
    while (fixed != Diagram::none() && !d.exhausted()) {
        Set left = fixed;
        size_t i = 0;
        while (i < order.size()) {
            left = d.both(left, allowed[order[i]]);
            if (left == Diagram::none()) break;
            ++i;
        }
        if (i == order.size()) break;
        needed.push_back(order[i]);
        fixed = d.both(fixed, allowed[order[i]]);
        order.resize(i);
    }
    std::sort(needed.begin(), needed.end());
    return needed;
}

}  // namespace

std::vector<bool> implied_by_others(Diagram& diagram, std::span<const Set> allowed) {
    if (allowed.empty()) return {};
    return Implied(diagram, allowed).run();
}

std::vector<uint32_t> smallest_clash(Diagram& d, std::span<const Set> allowed) {
    const uint32_t n = static_cast<uint32_t>(allowed.size());
    for (uint32_t i = 0; i < n; ++i)
        if (allowed[i] == Diagram::none()) return {i};
    if (n <= most_for_pairs)
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = i + 1; j < n; ++j)
                if (d.disjoint(allowed[i], allowed[j])) return {i, j};
    if (n <= most_for_triples)
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = i + 1; j < n; ++j) {
                const Set pair = d.both(allowed[i], allowed[j]);
                for (uint32_t k = j + 1; k < n; ++k)
                    if (d.disjoint(pair, allowed[k])) return {i, j, k};
            }
    std::vector<uint32_t> order(n);
    for (uint32_t i = 0; i < n; ++i) order[i] = i;
    std::vector<uint32_t> forward = irreducible_clash(d, allowed, order);
    std::reverse(order.begin(), order.end());
    const std::vector<uint32_t> backward = irreducible_clash(d, allowed, order);
    return !d.exhausted() && backward.size() < forward.size() ? backward : forward;
}

}  // namespace kiln
