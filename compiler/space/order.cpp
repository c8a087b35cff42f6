// The conditions are a circuit: axes feed gates, gates feed gates. Axes that nothing joins are independent, and interleaving
// them would multiply what they need: so each connected component is ordered alone and the components follow each other.
// Inside one, several orders of axes and gates compete: the one written, two walks along the wires (Cuthill-McKee, and one
// that keeps the frontier small), and each of these improved by FORCE (Aloul, Markov, Sakallah 2003), which moves what is
// joined towards each other but finds no way out of a badly scrambled start by itself. The judge is an estimate of what the
// diagram must remember at each cut: a bit for every gate with inputs on both sides, or the axes that still matter.

#include "compiler/space/order.h"

#include <algorithm>
#include <numeric>

namespace kiln {

namespace {

using Order = std::vector<uint32_t>;

// One component. Vertices are its axes, from 0 in ascending order, and then its gates.
class Component {
public:
    Component(std::vector<uint32_t> bits, std::vector<Gate> gates) : bits_(std::move(bits)), gates_(std::move(gates)) {
        axes_ = bits_.size();
        bits_.resize(axes_ + gates_.size(), 1);
        near_.resize(bits_.size());
        nested_.assign(gates_.size(), false);
        for (uint32_t g = 0; g < gates_.size(); ++g) {
            const uint32_t gate = static_cast<uint32_t>(axes_) + g;
            for (const uint32_t input : gates_[g].inputs) {
                nested_[g] = nested_[g] || input >= axes_;
                near_[gate].push_back(input);
                near_[input].push_back(gate);
                ties_ += 2;
            }
        }
    }

    // Axes only.
    Order order() const {
        Order best(axes_);
        std::iota(best.begin(), best.end(), 0u);
        if (axes_ <= 2) return best;
        uint64_t best_cost = cost(best);
        const auto offer = [&](Order candidate) {
            candidate.erase(std::remove_if(candidate.begin(), candidate.end(), [&](uint32_t v) { return v >= axes_; }),
                            candidate.end());
            const uint64_t c = cost(candidate);
            if (c >= best_cost) return;
            best_cost = c;
            best = std::move(candidate);
        };
        const Order written = with_gates(best), along = cuthill_mckee();
        offer(along);
        offer(forced(written));
        offer(forced(along));
        constexpr size_t most_for_frontier = 20'000'000;
        if (bits_.size() * ties_ <= most_for_frontier) {
            const Order frontier = small_frontier(along[0]);
            offer(frontier);
            offer(forced(frontier));
        }
        return best;
    }

private:
    static Order places(const Order& order) {
        Order place(order.size());
        for (uint32_t level = 0; level < order.size(); ++level) place[order[level]] = level;
        return place;
    }

    // Every gate after the last of its inputs.
    Order with_gates(const Order& axes) const {
        Order at = places(axes), order = axes;
        for (uint32_t g = 0; g < gates_.size(); ++g) {
            uint32_t last = 0;
            for (const uint32_t input : gates_[g].inputs) last = std::max(last, at[input]);
            at.push_back(last);
            order.push_back(static_cast<uint32_t>(axes_) + g);
        }
        std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return at[a] < at[b]; });
        return order;
    }

    // The sum over all cuts of the states that may have to be told apart there.
    uint64_t cost(const Order& order) const {
        const Order place = places(order);
        Order first = place, last = place;        // of vertices: the levels of the axes below
        Order matters = place, compared = place;  // of axes: until when
        for (const Gate& gate : gates_) {
            uint32_t low = ~0u, high = 0;
            for (const uint32_t input : gate.inputs) {
                low = std::min(low, first[input]);
                high = std::max(high, last[input]);
            }
            first.push_back(low);
            last.push_back(high);
            for (const uint32_t input : gate.inputs) {
                if (input >= axes_) continue;
                matters[input] = std::max(matters[input], high);
                if (gate.compares) compared[input] = std::max(compared[input], high);
            }
        }
        // Two bounds: the axes that matter and the gates above gates; or one bit a gate, and the axes under comparison.
        std::vector<int64_t> by_axes(order.size() + 1, 0), by_gates(order.size() + 1, 0);
        const auto open = [](std::vector<int64_t>& bits, uint32_t from, uint32_t to, int64_t amount) {
            bits[from] += amount;
            bits[to] -= amount;
        };
        for (uint32_t axis = 0; axis < axes_; ++axis) {
            open(by_axes, place[axis], matters[axis], bits_[axis]);
            open(by_gates, place[axis], compared[axis], bits_[axis]);
        }
        for (uint32_t g = 0; g < gates_.size(); ++g) {
            const size_t vertex = axes_ + g;
            if (nested_[g]) open(by_axes, first[vertex], last[vertex], 1);
            if (!gates_[g].compares) open(by_gates, first[vertex], last[vertex], 1);
        }
        uint64_t total = 0;
        int64_t axes = 0, gates = 0;
        for (size_t level = 0; level < order.size(); ++level) {
            axes += by_axes[level];
            gates += by_gates[level];
            total += uint64_t{1} << std::min<int64_t>({axes, gates, 48});
        }
        return total;
    }

    // Breadth first from an axis at the rim, neighbours with few ties first.
    Order walk(uint32_t start) const {
        Order found{start};
        std::vector<bool> seen(bits_.size(), false);
        seen[start] = true;
        for (size_t i = 0; i < found.size(); ++i) {
            const size_t first = found.size();
            for (const uint32_t n : near_[found[i]]) {
                if (seen[n]) continue;
                seen[n] = true;
                found.push_back(n);
            }
            std::stable_sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
                             [&](uint32_t a, uint32_t b) { return near_[a].size() < near_[b].size(); });
        }
        return found;
    }
    Order cuthill_mckee() const {
        Order order = walk(0);
        for (int i = 0; i < 4; ++i) order = walk(order.back());
        return order;
    }

    // Takes next the axis that leaves the fewest axes with open ties; among equals one tied to the longest open axis.
    Order small_frontier(uint32_t start) const {
        const size_t n = bits_.size();
        std::vector<uint32_t> open_ties(n), since(n, ~0u);  // since: when the first neighbour was placed
        std::vector<bool> placed(n, false);
        for (size_t i = 0; i < n; ++i) open_ties[i] = static_cast<uint32_t>(near_[i].size());
        Order order, candidates;
        const auto place = [&](uint32_t axis) {
            placed[axis] = true;
            for (const uint32_t other : near_[axis]) {
                --open_ties[other];
                if (placed[other] || since[other] != ~0u) continue;
                since[other] = static_cast<uint32_t>(order.size());
                candidates.push_back(other);
            }
            order.push_back(axis);
        };
        place(start);
        while (!candidates.empty()) {
            size_t best = 0;
            int64_t best_growth = INT64_MAX;
            for (size_t c = 0; c < candidates.size(); ++c) {
                const uint32_t axis = candidates[c];
                int64_t growth = open_ties[axis] > 0 ? bits_[axis] : 0;
                for (const uint32_t other : near_[axis])
                    if (placed[other] && open_ties[other] == 1) growth -= bits_[other];
                const bool older = since[axis] < since[candidates[best]];
                if (growth < best_growth || (growth == best_growth && older)) {
                    best_growth = growth;
                    best = c;
                }
            }
            const uint32_t axis = candidates[best];
            candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(best));
            place(axis);
        }
        return order;
    }

    uint64_t total_span(const Order& place) const {
        uint64_t span = 0;
        for (uint32_t g = 0; g < gates_.size(); ++g) {
            uint32_t low = place[axes_ + g], high = low;
            for (const uint32_t input : gates_[g].inputs) {
                low = std::min(low, place[input]);
                high = std::max(high, place[input]);
            }
            span += high - low;
        }
        return span;
    }

    Order forced(Order order) const {
        const size_t n = order.size();
        Order place = places(order), best = order;
        uint64_t best_span = total_span(place);
        const size_t rounds = std::min<size_t>(200, 10 + 4'000'000 / (ties_ + n));
        size_t idle = 0;
        for (size_t round = 0; round < rounds && idle < 12; ++round) {
            // Centres of gravity are integers scaled by 2^16: a floating sum would tie the order to the compiler.
            std::vector<uint64_t> sum(n, 0), count(n, 0);
            for (uint32_t g = 0; g < gates_.size(); ++g) {
                const size_t vertex = axes_ + g;
                uint64_t centre = uint64_t{place[vertex]} << 16;
                for (const uint32_t input : gates_[g].inputs) centre += uint64_t{place[input]} << 16;
                centre /= gates_[g].inputs.size() + 1;
                const auto pull = [&](size_t v) {
                    sum[v] += centre;
                    ++count[v];
                };
                pull(vertex);
                for (const uint32_t input : gates_[g].inputs) pull(input);
            }
            for (size_t v = 0; v < n; ++v) sum[v] /= count[v];  // every vertex of a component belongs to a gate
            std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return sum[a] < sum[b]; });
            place = places(order);
            const uint64_t span = total_span(place);
            ++idle;
            if (span >= best_span) continue;
            best_span = span;
            best = order;
            idle = 0;
        }
        return best;
    }

    size_t axes_ = 0;
    std::vector<uint32_t> bits_;  // of an axis's digit; 1 for a gate
    std::vector<Gate> gates_;
    std::vector<bool> nested_;  // gates that have gates as inputs
    std::vector<std::vector<uint32_t>> near_;
    size_t ties_ = 0;
};

}  // namespace

std::vector<uint32_t> initial_order(const std::vector<uint32_t>& radices, const std::vector<Gate>& gates) {
    const size_t axes = radices.size();
    std::vector<uint32_t> parent(axes + gates.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (uint32_t g = 0; g < gates.size(); ++g)
        for (const uint32_t input : gates[g].inputs) {
            const uint32_t a = root(static_cast<uint32_t>(axes) + g), b = root(input);
            parent[std::max(a, b)] = std::min(a, b);
        }
    // A root is its component's smallest axis.
    std::vector<std::vector<uint32_t>> members(axes), bits(axes);
    std::vector<std::vector<Gate>> own_gates(axes);
    std::vector<uint32_t> number(parent.size());  // inside its component
    for (uint32_t axis = 0; axis < axes; ++axis) {
        number[axis] = static_cast<uint32_t>(members[root(axis)].size());
        members[root(axis)].push_back(axis);
        uint32_t b = 0;
        while ((1u << b) < radices[axis]) ++b;
        bits[root(axis)].push_back(b);
    }
    for (uint32_t g = 0; g < gates.size(); ++g) {
        const uint32_t vertex = static_cast<uint32_t>(axes) + g, component = root(vertex);
        number[vertex] = static_cast<uint32_t>(members[component].size() + own_gates[component].size());
        Gate own = gates[g];
        for (uint32_t& input : own.inputs) input = number[input];
        own_gates[component].push_back(std::move(own));
    }
    std::vector<uint32_t> order;
    for (uint32_t first = 0; first < axes; ++first) {
        if (members[first].empty()) continue;
        for (const uint32_t own : Component(std::move(bits[first]), std::move(own_gates[first])).order())
            order.push_back(members[first][own]);
    }
    return order;
}

}  // namespace kiln
