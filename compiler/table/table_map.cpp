// Merging is the usual product of two diagrams with three outcomes at a leaf: one side is open, both agree, or they clash. A
// clash anywhere makes the whole merge a clash, remembered like any other result. Closing a map goes from the root down:
// children that do not contradict each other are merged first, which removes whole axes, and what is left open takes its
// neighbour's answer, which joins runs. The greedy merging is tried under a budget and kept only when it made the map smaller.

#include "compiler/table/table_map.h"

#include <algorithm>
#include <cassert>

namespace kiln {

namespace {

constexpr uint64_t close_budget = 1'000'000;
constexpr size_t groups_tried = 8;

uint64_t mix(uint64_t h, uint64_t v) {
    h = (h ^ v) * 0x9E3779B97F4A7C15u;
    return h ^ (h >> 32);
}

}  // namespace

LeafMaps::LeafMaps(const Diagram& diagram)
    : diagram_(diagram), radices_(diagram.radices()), order_(diagram.order()), level_of_axis_(order_.size()) {
    for (uint32_t i = 0; i < order_.size(); ++i) level_of_axis_[order_[i]] = i;
}

LeafMaps::Ref LeafMaps::make(uint32_t level, std::vector<Edge> edges) {
    std::vector<Edge> runs;
    for (const Edge& e : edges) {
        if (!runs.empty() && runs.back().child == e.child)
            runs.back().last = e.last;
        else
            runs.push_back(e);
    }
    if (runs.size() == 1) return runs[0].child;
    uint64_t h = level;
    for (const Edge& e : runs) h = mix(mix(h, e.last), e.child);
    const auto [first, last] = unique_.equal_range(h);
    for (auto it = first; it != last; ++it)
        if (nodes_[it->second].level == level && nodes_[it->second].edges == runs) return it->second;
    const Ref ref = static_cast<Ref>(nodes_.size());
    assert(ref < conflict_);
    nodes_.push_back({level, std::move(runs)});
    unique_.emplace(h, ref);
    return ref;
}

LeafMaps::Ref LeafMaps::import(Set set, Ref inside, std::unordered_map<uint32_t, Ref>& seen) {
    if (set == Diagram::none()) return open;
    if (set == Diagram::all()) return inside;
    if (const auto it = seen.find(set.node); it != seen.end()) return it->second;
    std::vector<Edge> edges;
    for (const Diagram::Edge& e : diagram_.edges(set)) edges.push_back({e.last, import(e.child, inside, seen)});
    return seen[set.node] = make(level_of_axis_[diagram_.axis_of(set)], std::move(edges));
}

LeafMaps::Ref LeafMaps::from_set(Set set, uint32_t value) {
    std::unordered_map<uint32_t, Ref> seen;
    return import(set, leaf(value), seen);
}

LeafMaps::Ref LeafMaps::merge_step(Ref a, Ref b) {
    if (a == b || b == open) return a;
    if (a == open) return b;
    if (is_leaf(a) && is_leaf(b)) return conflict_;
    if (a > b) std::swap(a, b);
    const uint64_t key = static_cast<uint64_t>(a) << 32 | b;
    if (const auto it = merged_.find(key); it != merged_.end()) return it->second;
    const uint32_t la = level_of(a), lb = level_of(b), level = std::min(la, lb);
    const std::vector<Edge> whole_a{{radices_[order_[level]] - 1, a}}, whole_b{{radices_[order_[level]] - 1, b}};
    // Copies: making children may move the nodes.
    const std::vector<Edge> ea = la == level ? nodes_[a].edges : whole_a, eb = lb == level ? nodes_[b].edges : whole_b;
    std::vector<Edge> out;
    Ref result = conflict_;
    size_t i = 0, k = 0;
    while (i < ea.size() && k < eb.size()) {
        const Ref child = merge_step(ea[i].child, eb[k].child);
        if (child == conflict_) break;
        const uint32_t last = std::min(ea[i].last, eb[k].last);
        out.push_back({last, child});
        if (ea[i].last == last) ++i;
        if (eb[k].last == last) ++k;
    }
    if (i == ea.size() && k == eb.size()) result = make(level, std::move(out));
    if (budget_ != 0) --budget_;
    merged_[key] = result;
    return result;
}

std::optional<LeafMaps::Ref> LeafMaps::merge(Ref a, Ref b) {
    const Ref result = merge_step(a, b);
    if (result == conflict_) return std::nullopt;
    return result;
}

std::optional<LeafMaps::Ref> LeafMaps::merge_all(std::vector<Ref> maps) {
    if (maps.empty()) return open;
    while (maps.size() > 1) {
        size_t out = 0;
        for (size_t i = 0; i < maps.size(); i += 2) {
            if (i + 1 == maps.size()) {
                maps[out++] = maps[i];
                continue;
            }
            const Ref both = merge_step(maps[i], maps[i + 1]);
            if (both == conflict_) return std::nullopt;
            maps[out++] = both;
        }
        maps.resize(out);
    }
    return maps[0];
}

LeafMaps::Ref LeafMaps::forget_step(Ref map, const std::vector<bool>& axes, std::unordered_map<Ref, Ref>& seen) {
    if (is_leaf(map)) return map;
    if (const auto it = seen.find(map); it != seen.end()) return it->second;
    const std::vector<Edge> edges = nodes_[map].edges;
    const bool gone = axes[axis_of(map)];
    std::vector<Edge> out;
    Ref joined = open;
    for (const Edge& e : edges) {
        const Ref child = forget_step(e.child, axes, seen);
        if (child == conflict_) return seen[map] = conflict_;
        if (gone) {
            joined = merge_step(joined, child);
            if (joined == conflict_) return seen[map] = conflict_;
        } else {
            out.push_back({e.last, child});
        }
    }
    return seen[map] = gone ? joined : make(nodes_[map].level, std::move(out));
}

std::optional<LeafMaps::Ref> LeafMaps::forget(Ref map, const std::vector<bool>& axes) {
    std::unordered_map<Ref, Ref> seen;
    const Ref result = forget_step(map, axes, seen);
    if (result == conflict_) return std::nullopt;
    return result;
}

LeafMaps::Ref LeafMaps::close_step(Ref map, bool share, std::unordered_map<Ref, Ref>& seen) {
    if (is_leaf(map)) return map;
    if (const auto it = seen.find(map); it != seen.end()) return it->second;
    const std::vector<Edge> edges = nodes_[map].edges;
    std::vector<Ref> groups;
    std::vector<size_t> of(edges.size());
    for (size_t i = 0; i < edges.size(); ++i) {
        if (edges[i].child == open) continue;
        size_t found = groups.size();
        for (size_t back = 0; back < std::min(groups.size(), groups_tried) && found == groups.size(); ++back) {
            const size_t g = groups.size() - 1 - back;
            if (groups[g] == edges[i].child) {
                found = g;
            } else if (share && budget_ > 1) {
                if (const Ref both = merge_step(groups[g], edges[i].child); both != conflict_) {
                    groups[g] = both;
                    found = g;
                }
            }
        }
        if (found == groups.size()) groups.push_back(edges[i].child);
        of[i] = found;
    }
    size_t near = groups.size();
    for (size_t i = 0; i < edges.size() && near == groups.size(); ++i)
        if (edges[i].child != open) near = of[i];
    std::vector<Edge> out;
    for (size_t i = 0; i < edges.size(); ++i) {
        if (edges[i].child != open) near = of[i];
        out.push_back({edges[i].last, close_step(groups[near], share, seen)});
    }
    return seen[map] = make(nodes_[map].level, std::move(out));
}

LeafMaps::Ref LeafMaps::close(Ref map) {
    std::unordered_map<Ref, Ref> plain, shared;
    const Ref simple = close_step(map, false, plain);
    budget_ = close_budget;
    const Ref small = close_step(map, true, shared);
    budget_ = 0;
    return size(small) <= size(simple) ? small : simple;
}

std::optional<LeafMaps::Ref> LeafMaps::branch(uint32_t axis, std::vector<Edge> runs) {
    const uint32_t level = level_of_axis_[axis];
    if (runs.empty() || runs.back().last != radices_[axis] - 1) return std::nullopt;
    for (size_t i = 0; i < runs.size(); ++i)
        if (level_of(runs[i].child) <= level || (i != 0 && runs[i].last <= runs[i - 1].last)) return std::nullopt;
    return make(level, std::move(runs));
}

Set LeafMaps::to_set_step(Ref map, const std::vector<bool>& values, Diagram& diagram, std::unordered_map<Ref, Set>& seen) const {
    if (map == open) return Diagram::none();
    if (is_leaf(map)) return values[value_of(map)] ? Diagram::all() : Diagram::none();
    if (const auto it = seen.find(map); it != seen.end()) return it->second;
    std::vector<Diagram::Edge> runs;
    for (const Edge& e : nodes_[map].edges) runs.push_back({e.last, to_set_step(e.child, values, diagram, seen)});
    return seen[map] = diagram.branch(axis_of(map), runs);
}

Set LeafMaps::to_set(Ref map, const std::vector<bool>& values, Diagram& diagram) const {
    std::unordered_map<Ref, Set> seen;
    return to_set_step(map, values, diagram, seen);
}

LeafMaps::Ref LeafMaps::relabel_step(Ref map, const std::vector<uint32_t>& with, std::unordered_map<Ref, Ref>& seen) {
    if (map == open) return open;
    if (is_leaf(map)) return leaf(with[value_of(map)]);
    if (const auto it = seen.find(map); it != seen.end()) return it->second;
    const std::vector<Edge> edges = nodes_[map].edges;
    std::vector<Edge> out;
    for (const Edge& e : edges) out.push_back({e.last, relabel_step(e.child, with, seen)});
    return seen[map] = make(nodes_[map].level, std::move(out));
}

LeafMaps::Ref LeafMaps::relabel(Ref map, const std::vector<uint32_t>& with) {
    std::unordered_map<Ref, Ref> seen;
    return relabel_step(map, with, seen);
}

LeafMaps::Ref LeafMaps::child(Ref node, uint32_t digit) const {
    const std::vector<Edge>& e = nodes_[node].edges;
    const auto it = std::lower_bound(e.begin(), e.end(), digit, [](const Edge& edge, uint32_t d) { return edge.last < d; });
    return it->child;
}

std::vector<uint32_t> LeafMaps::support(Ref map) const {
    std::vector<bool> levels(order_.size());
    std::vector<Ref> todo{map};
    std::unordered_map<Ref, bool> seen;
    while (!todo.empty()) {
        const Ref ref = todo.back();
        todo.pop_back();
        if (is_leaf(ref) || !seen.emplace(ref, true).second) continue;
        levels[nodes_[ref].level] = true;
        for (const Edge& e : nodes_[ref].edges) todo.push_back(e.child);
    }
    std::vector<uint32_t> out;
    for (size_t i = 0; i < levels.size(); ++i)
        if (levels[i]) out.push_back(order_[i]);
    return out;
}

size_t LeafMaps::size(Ref map) const {
    size_t total = 0;
    std::vector<Ref> todo{map};
    std::unordered_map<Ref, bool> seen;
    while (!todo.empty()) {
        const Ref ref = todo.back();
        todo.pop_back();
        if (is_leaf(ref) || !seen.emplace(ref, true).second) continue;
        total += 1 + nodes_[ref].edges.size();
        for (const Edge& e : nodes_[ref].edges) todo.push_back(e.child);
    }
    return total;
}

}  // namespace kiln
