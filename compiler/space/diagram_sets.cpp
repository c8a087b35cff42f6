// Questions about sets and the operations that rebuild one set: fixing, forgetting and simplifying. The two questions that
// the preprocessor asks most (is this a subset, are these apart) stop at the first counterexample and make no nodes.

#include <algorithm>
#include <cassert>

#include "compiler/space/diagram_body.h"

namespace kiln {

bool Diagram::Body::subset(NodeId a, NodeId b) {
    if (a == b || a == 0 || b == 1) return true;
    if (b == 0 || a == 1) return false;  // reduced: only node 1 is everything
    uint32_t known = 0;
    if (exhausted) return false;
    if (lookup(op_subset, a, b, &known)) return known != 0;
    const Node na = nodes[a], nb = nodes[b];
    bool holds = true;
    if (na.level < nb.level) {
        for (const Edge* e = na.begin(); holds && e != na.end(); ++e) holds = subset(e->child.node, b);
    } else if (nb.level < na.level) {
        for (const Edge* e = nb.begin(); holds && e != nb.end(); ++e) holds = subset(a, e->child.node);
    } else {
        for (const Edge *x = na.begin(), *y = nb.begin(); holds && x != na.end();) {
            if (x->child.node == 0 && x->last > y->last) y = run_at(y, nb.end(), x->last);
            if (y->child.node == 1 && y->last > x->last) x = run_at(x, na.end(), y->last);
            const uint32_t last = std::min(x->last, y->last);
            holds = subset(x->child.node, y->child.node);
            const bool step_x = x->last == last, step_y = y->last == last;
            x += step_x;
            y += step_y;
        }
    }
    remember(op_subset, a, b, holds);
    return holds;
}

bool Diagram::Body::disjoint(NodeId a, NodeId b) {
    if (a == 0 || b == 0) return true;
    if (a == 1 || b == 1 || a == b) return false;
    if (a > b) std::swap(a, b);
    uint32_t known = 0;
    if (exhausted) return false;
    if (lookup(op_disjoint, a, b, &known)) return known != 0;
    const Node na = nodes[a], nb = nodes[b];
    bool holds = true;
    if (na.level < nb.level) {
        for (const Edge* e = na.begin(); holds && e != na.end(); ++e) holds = disjoint(e->child.node, b);
    } else if (nb.level < na.level) {
        for (const Edge* e = nb.begin(); holds && e != nb.end(); ++e) holds = disjoint(a, e->child.node);
    } else {
        for (const Edge *x = na.begin(), *y = nb.begin(); holds && x != na.end();) {
            if (x->child.node == 0 && x->last > y->last) y = run_at(y, nb.end(), x->last);
            if (y->child.node == 0 && y->last > x->last) x = run_at(x, na.end(), y->last);
            const uint32_t last = std::min(x->last, y->last);
            holds = disjoint(x->child.node, y->child.node);
            const bool step_x = x->last == last, step_y = y->last == last;
            x += step_x;
            y += step_y;
        }
    }
    remember(op_disjoint, a, b, holds);
    return holds;
}

NodeId Diagram::Body::cofactor(NodeId s, uint32_t level, uint32_t digit) {
    const Node n = nodes[s];
    if (n.level > level || exhausted) return s;
    if (n.level == level) return child(n, digit);
    NodeId result = 0;
    const uint32_t what = level << 16 | digit;
    if (lookup(op_cofactor, s, what, &result)) return result;
    const size_t base = runs.size();
    for (const Edge& e : n) push_run(base, e.last, cofactor(e.child.node, level, digit));
    result = finish_runs(n.level, base);
    remember(op_cofactor, s, what, result);
    return result;
}

NodeId Diagram::Body::project(NodeId s, const std::vector<bool>& keep_level, uint32_t deepest, uint32_t op) {
    const Node n = nodes[s];
    if (n.level > deepest || exhausted) return s;
    NodeId result = 0;
    if (lookup(op, s, 0, &result)) return result;
    if (keep_level[n.level]) {
        const size_t base = runs.size();
        for (const Edge& e : n) push_run(base, e.last, project(e.child.node, keep_level, deepest, op));
        result = finish_runs(n.level, base);
    } else {
        for (const Edge* e = n.begin(); e != n.end() && result != 1; ++e)
            result = apply<op_either>(result, project(e->child.node, keep_level, deepest, op));
    }
    remember(op, s, 0, result);
    return result;
}

// Coudert and Madre's "restrict" for many-valued levels: a run on which `care` is empty takes its neighbour's answer, and a
// level that only `care` tests is forgotten there.
NodeId Diagram::Body::simplify(NodeId s, NodeId care) {
    if (s <= 1 || care == 1 || exhausted) return s;
    if (care == 0) return 0;
    if (s == care) return 1;
    NodeId result = 0;
    if (lookup(op_simplify, s, care, &result)) return result;
    const Node ns = nodes[s], nc = nodes[care];
    if (nc.level < ns.level) {
        NodeId any = 0;
        for (const Edge* e = nc.begin(); e != nc.end() && any != 1; ++e) any = apply<op_either>(any, e->child.node);
        result = simplify(s, any);
    } else if (ns.level < nc.level) {
        const size_t base = runs.size();
        for (const Edge& e : ns) push_run(base, e.last, simplify(e.child.node, care));
        result = finish_runs(ns.level, base);
    } else {
        const size_t base = runs.size();
        constexpr NodeId no_answer = ~0u;
        NodeId latest = no_answer;  // the answer of the last run that matters; runs before the first wait for it
        for (const Edge *x = ns.begin(), *y = nc.begin(); x != ns.end();) {
            const uint32_t last = std::min(x->last, y->last);
            if (y->child.node != 0) {
                const bool first = latest == no_answer;
                latest = simplify(x->child.node, y->child.node);
                if (first) runs.resize(base);
            }
            if (latest != no_answer) push_run(base, last, latest);
            const bool step_x = x->last == last, step_y = y->last == last;
            x += step_x;
            y += step_y;
        }
        result = finish_runs(ns.level, base);
    }
    remember(op_simplify, s, care, result);
    return result;
}

bool Diagram::subset(Set a, Set b) { return body_->subset(a.node, b.node); }
bool Diagram::disjoint(Set a, Set b) { return body_->disjoint(a.node, b.node); }

Set Diagram::cofactor(Set s, uint32_t axis, uint32_t digit) {
    assert(digit < body_->radices[axis]);
    return {body_->cofactor(s.node, body_->level_of[axis], digit)};
}

Set Diagram::project(Set s, const std::vector<bool>& keep) {
    Body& b = *body_;
    assert(keep.size() == b.radices.size());
    uint32_t deepest = 0;
    bool any = false;
    std::vector<bool> keep_level(keep.size());
    for (uint32_t level = 0; level < b.levels(); ++level) {
        keep_level[level] = keep[b.order[level]];
        if (keep_level[level]) continue;
        deepest = level;
        any = true;
    }
    if (!any) return s;
    if (keep != b.last_keep) {
        b.last_keep = keep;
        ++b.last_projection;
    }
    return {b.project(s.node, keep_level, deepest, b.last_projection)};
}

Set Diagram::simplify(Set s, Set care) {
    assert(care != none());
    return {body_->simplify(s.node, care.node)};
}

std::vector<Set> Diagram::reachable(std::span<const Set> roots) const {
    // An explicit stack: (node, next edge to look at).
    Body& b = *body_;
    std::vector<Set> found;
    std::vector<std::pair<NodeId, uint32_t>> stack;
    b.marks.start(b.nodes.size());
    for (const Set root : roots) {
        if (root.node <= 1 || b.marks.has(root.node)) continue;
        b.marks.set(root.node, 1);
        stack.push_back({root.node, 0});
        while (!stack.empty()) {
            const NodeId n = stack.back().first;
            if (stack.back().second == b.nodes[n].count) {
                found.push_back({n});
                stack.pop_back();
                continue;
            }
            const NodeId to = b.nodes[n].edges[stack.back().second++].child.node;
            if (to <= 1 || b.marks.has(to)) continue;
            b.marks.set(to, 1);
            stack.push_back({to, 0});
        }
    }
    return found;
}

std::vector<uint32_t> Diagram::support(Set s) const {
    std::vector<bool> used(body_->radices.size());
    for (const Set n : reachable({&s, 1})) used[axis_of(n)] = true;
    std::vector<uint32_t> axes;
    for (uint32_t axis = 0; axis < used.size(); ++axis)
        if (used[axis]) axes.push_back(axis);
    return axes;
}

std::vector<std::vector<bool>> Diagram::digits_used(Set s) const {
    const Body& b = *body_;
    std::vector<std::vector<bool>> used;
    for (const uint32_t radix : b.radices) used.emplace_back(radix, false);
    if (s == none()) return used;
    // An edge that skips levels leaves all their digits open.
    std::vector<bool> open(b.levels() + 1, false);
    const auto skip = [&](uint32_t from, uint32_t to) {
        for (uint32_t level = from; level < to; ++level) open[level] = true;
    };
    skip(0, b.nodes[s.node].level);
    for (const Set n : reachable({&s, 1})) {
        const Body::Node& node = b.nodes[n.node];
        uint32_t digit = 0;
        for (const Edge& e : node) {
            if (e.child != none()) {
                skip(node.level + 1u, b.nodes[e.child.node].level);
                for (; digit <= e.last; ++digit) used[b.order[node.level]][digit] = true;
            }
            digit = e.last + 1;
        }
    }
    for (uint32_t level = 0; level < b.levels(); ++level)
        if (open[level]) used[b.order[level]].assign(b.width[level], true);
    return used;
}

Set Diagram::branch(uint32_t axis, std::span<const Edge> runs) {
    Body& b = *body_;
    const uint32_t level = b.level_of[axis];
    assert(!runs.empty() && runs.back().last + 1 == b.width[level]);
    bool below = true;
    for (const Edge& e : runs) below = below && b.nodes[e.child.node].level > level;
    if (below) {
        const size_t base = b.runs.size();
        for (const Edge& e : runs) b.push_run(base, e.last, e.child.node);
        return {b.finish_runs(level, base)};
    }
    // One term for each distinct child.
    std::vector<Set> children;
    for (const Edge& e : runs) children.push_back(e.child);
    std::sort(children.begin(), children.end());
    children.erase(std::unique(children.begin(), children.end()), children.end());
    Set result = none();
    for (const Set child : children) {
        if (child == none()) continue;
        const size_t base = b.runs.size();
        for (const Edge& e : runs) b.push_run(base, e.last, e.child == child ? 1 : 0);
        const Set here{b.finish_runs(level, base)};
        result = either(result, both(here, child));
    }
    return result;
}

Set Diagram::import(const Diagram& from, Set s) {
    assert(from.radices() == radices());
    if (s.node <= 1) return s;
    const std::vector<Set> order = from.reachable({&s, 1});
    Body::Marks& place = from.body_->marks;  // reachable() has marked every node of `order`; values become the copies
    std::vector<Edge> copied;
    for (const Set n : order) {
        copied.clear();
        for (const Edge& e : from.edges(n)) {
            const NodeId to = e.child.node;
            copied.push_back({e.last, {to <= 1 ? to : place.get(to)}});
        }
        const Set copy = branch(from.axis_of(n), copied);
        if (exhausted()) return none();
        place.set(n.node, copy.node);
    }
    return {place.get(s.node)};
}

}  // namespace kiln
