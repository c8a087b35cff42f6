// Sifting works on a copy of the sets in which neighbouring levels can be swapped in place: a node keeps its number and its
// meaning while the axis it tests changes, so nothing above a swap needs touching. For many-valued runs, a node that tests x
// and then y becomes one that tests y (over the common runs of its children) and then x.

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include "compiler/space/order.h"

namespace kiln {

namespace {

class Sifter {
public:
    Sifter(const Diagram& diagram, std::span<const Set> sets, size_t budget) : order_(diagram.order()), budget_(budget) {
        place_.resize(order_.size());
        for (uint32_t level = 0; level < order_.size(); ++level) place_[order_[level]] = level;
        at_.resize(order_.size());
        nodes_.resize(2);
        const std::vector<Set> found = diagram.reachable(sets);
        std::vector<std::pair<uint32_t, uint32_t>> copy;
        for (uint32_t i = 0; i < found.size(); ++i) copy.push_back({found[i].node, i + 2});
        std::sort(copy.begin(), copy.end());
        const auto copied = [&](uint32_t n) {
            return n <= 1 ? n : std::lower_bound(copy.begin(), copy.end(), std::pair{n, 0u})->second;
        };
        for (const Set s : found) {
            std::vector<Run> runs;
            for (const Diagram::Edge& e : diagram.edges(s)) runs.push_back({e.last, copied(e.child.node)});
            add(diagram.axis_of(s), std::move(runs));
        }
        for (const Set s : sets) {
            roots_.push_back(copied(s.node));
            ++nodes_[roots_.back()].references;
        }
    }

    void run() {
        // The axes with most edges first; they have most to gain.
        std::vector<uint32_t> axes(order_.size());
        std::iota(axes.begin(), axes.end(), 0u);
        std::vector<size_t> weight(order_.size(), 0);
        for (uint32_t axis = 0; axis < axes.size(); ++axis)
            for (const uint32_t n : at_[axis]) weight[axis] += nodes_[n].runs.size();
        std::stable_sort(axes.begin(), axes.end(), [&](uint32_t a, uint32_t b) { return weight[a] > weight[b]; });
        for (const uint32_t axis : axes) {
            if (weight[axis] == 0 || work_ > budget_) break;
            sift(axis);
        }
    }

    Reordered write(const std::vector<uint32_t>& radices, size_t node_limit) const {
        Reordered out;
        out.diagram = std::make_unique<Diagram>(radices, order_, node_limit);
        std::vector<Set> written(nodes_.size());
        written[1] = Diagram::all();
        std::vector<Diagram::Edge> edges;
        for (size_t level = order_.size(); level-- > 0;) {
            for (const uint32_t n : at_[order_[level]]) {
                edges.clear();
                for (const Run& r : nodes_[n].runs) edges.push_back({r.last, written[r.to]});
                written[n] = out.diagram->branch(order_[level], edges);
            }
        }
        for (const uint32_t n : roots_) out.sets.push_back(written[n]);
        return out;
    }

private:
    struct Run {
        uint32_t last, to;
        friend bool operator==(const Run&, const Run&) = default;
    };
    struct Node {
        std::vector<Run> runs;
        uint32_t references = 0;
        uint32_t axis = ~0u;
    };

    uint32_t add(uint32_t axis, std::vector<Run> runs) {
        uint32_t id;
        if (free_.empty()) {
            id = static_cast<uint32_t>(nodes_.size());
            nodes_.emplace_back();
        } else {
            id = free_.back();
            free_.pop_back();
        }
        for (const Run& r : runs) ++nodes_[r.to].references;
        size_ += runs.size();
        nodes_[id].axis = axis;
        nodes_[id].references = 0;
        nodes_[id].runs = std::move(runs);
        at_[axis].push_back(id);
        return id;
    }

    static uint64_t hash_of(const std::vector<Run>& runs) {
        uint64_t h = runs.size();
        for (const Run& r : runs) {
            h = (h ^ (static_cast<uint64_t>(r.last) << 32 | r.to)) * 0x9E3779B97F4A7C15u;
            h ^= h >> 29;
        }
        return h;
    }

    // The nodes of one axis by their runs, for the length of one swap.
    struct Unique {
        std::vector<uint32_t> table;
        explicit Unique(size_t expected) {
            size_t size = 16;
            while (size < expected * 2) size *= 2;
            table.assign(size, 0);
        }
    };
    void insert(Unique& unique, uint32_t id) {
        size_t i = hash_of(nodes_[id].runs) & (unique.table.size() - 1);
        while (unique.table[i] != 0) i = (i + 1) & (unique.table.size() - 1);
        unique.table[i] = id;
    }
    uint32_t find_or_add(Unique& unique, uint32_t axis, std::vector<Run> runs) {
        if (runs.size() == 1) return runs[0].to;
        work_ += runs.size();
        size_t i = hash_of(runs) & (unique.table.size() - 1);
        for (; unique.table[i] != 0; i = (i + 1) & (unique.table.size() - 1))
            if (nodes_[unique.table[i]].runs == runs) return unique.table[i];
        const uint32_t id = add(axis, std::move(runs));
        unique.table[i] = id;
        if (++added_ * 2 > unique.table.size()) {
            Unique larger(unique.table.size());
            for (const uint32_t n : unique.table)
                if (n != 0) insert(larger, n);
            unique = std::move(larger);
        }
        return id;
    }

    static void push(std::vector<Run>& runs, uint32_t last, uint32_t to) {
        if (!runs.empty() && runs.back().to == to)
            runs.back().last = last;
        else
            runs.push_back({last, to});
    }

    // Swaps the axes of `level` and `level + 1`.
    void swap(uint32_t level) {
        const uint32_t x = order_[level], y = order_[level + 1];
        std::vector<uint32_t> upper;
        upper.swap(at_[x]);
        std::vector<uint32_t> turning;  // test x, then somewhere y
        for (const uint32_t n : upper) {
            const std::vector<Run>& runs = nodes_[n].runs;
            work_ += runs.size();
            const bool turns = std::any_of(runs.begin(), runs.end(), [&](const Run& r) { return nodes_[r.to].axis == y; });
            (turns ? turning : at_[x]).push_back(n);
        }
        if (!turning.empty()) {
            added_ = at_[x].size();
            Unique unique(at_[x].size() + 2 * turning.size());
            for (const uint32_t n : at_[x]) insert(unique, n);
            for (const uint32_t n : turning) turn(n, x, y, unique);
            std::vector<uint32_t> lower;
            lower.swap(at_[y]);
            for (const uint32_t n : lower) {
                if (nodes_[n].references != 0) {
                    at_[y].push_back(n);
                    continue;
                }
                for (const Run& r : nodes_[n].runs) release(r.to);
                size_ -= nodes_[n].runs.size();
                nodes_[n].runs.clear();
                nodes_[n].axis = ~0u;
                free_.push_back(n);
            }
            at_[y].insert(at_[y].end(), turning.begin(), turning.end());
        }
        std::swap(order_[level], order_[level + 1]);
        place_[x] = level + 1;
        place_[y] = level;
        ++work_;
    }

    // Nodes below both levels never lose their last reference in a swap: they are reached by other runs afterwards.
    void release(uint32_t n) { --nodes_[n].references; }

    // Edge visits that swapping `level` with the next takes: a turning node walks its runs once per stretch of the lower axis.
    size_t swap_cost(uint32_t level) const {
        const uint32_t y = order_[level + 1];
        size_t cost = 0;
        for (const uint32_t n : at_[order_[level]]) {
            size_t stretches = 0;
            for (const Run& r : nodes_[n].runs)
                if (nodes_[r.to].axis == y) stretches += nodes_[r.to].runs.size();
            cost += nodes_[n].runs.size() * (stretches + 1);
        }
        return cost;
    }

    void turn(uint32_t n, uint32_t x, uint32_t y, Unique& unique) {
        const std::vector<Run> old = nodes_[n].runs;
        std::vector<size_t> position(old.size(), 0);
        std::vector<Run> fresh;
        for (bool more = true; more;) {
            // One stretch of y over which no child changes.
            uint32_t last = ~0u;
            std::vector<Run> below;
            for (size_t i = 0; i < old.size(); ++i) {
                const Node& child = nodes_[old[i].to];
                const bool splits = child.axis == y;
                push(below, old[i].last, splits ? child.runs[position[i]].to : old[i].to);
                if (splits) last = std::min(last, child.runs[position[i]].last);
            }
            more = false;
            for (size_t i = 0; i < old.size(); ++i) {
                const Node& child = nodes_[old[i].to];
                if (child.axis != y) continue;
                if (child.runs[position[i]].last == last) ++position[i];
                more = more || position[i] < child.runs.size();
            }
            work_ += old.size();
            push(fresh, last, find_or_add(unique, x, std::move(below)));
        }
        assert(fresh.size() >= 2);
        for (const Run& r : fresh) ++nodes_[r.to].references;
        for (const Run& r : old) release(r.to);
        size_ += fresh.size();
        size_ -= old.size();
        nodes_[n].runs = std::move(fresh);
        nodes_[n].axis = y;
    }

    void sift(uint32_t axis) {
        const uint32_t home = place_[axis], last = static_cast<uint32_t>(order_.size()) - 1;
        uint32_t best = home;
        size_t best_size = size_;
        const auto note = [&] {
            if (size_ < best_size || (size_ == best_size && place_[axis] == home)) {
                best_size = size_;
                best = place_[axis];
            }
        };
        // Swaps that the budget cannot pay are not begun; the way back is always taken.
        const auto too_far = [&](uint32_t level) {
            return size_ > best_size + best_size / 4 + 16 || work_ + swap_cost(level) > budget_;
        };
        const auto down = [&] {
            while (place_[axis] < last && !too_far(place_[axis])) {
                swap(place_[axis]);
                note();
            }
        };
        const auto up = [&] {
            while (place_[axis] > 0 && !too_far(place_[axis] - 1)) {
                swap(place_[axis] - 1);
                note();
            }
        };
        const bool down_first = last - home < home;
        down_first ? down() : up();
        // Back home whatever it costs, then to the other side.
        while (place_[axis] < home) swap(place_[axis]);
        while (place_[axis] > home) swap(place_[axis] - 1);
        down_first ? up() : down();
        while (place_[axis] < best) swap(place_[axis]);
        while (place_[axis] > best) swap(place_[axis] - 1);
    }

    std::vector<uint32_t> order_, place_;
    std::vector<Node> nodes_;                // 0 and 1 are the terminals
    std::vector<std::vector<uint32_t>> at_;  // nodes that test an axis
    std::vector<uint32_t> free_, roots_;
    size_t size_ = 0, work_ = 0, budget_, added_ = 0;
};

}  // namespace

Reordered sift(std::unique_ptr<Diagram> diagram, std::span<const Set> sets, size_t budget, size_t node_limit) {
    Sifter sifter(*diagram, sets, budget);
    const std::vector<uint32_t> radices = diagram->radices();
    diagram.reset();
    if (budget != 0) sifter.run();
    return sifter.write(radices, node_limit);
}

}  // namespace kiln
