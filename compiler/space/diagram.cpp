// Nodes, the unique table and the set operations. Two choices make these fast: the unique table stores node numbers only and
// compares the 32-bit hash kept in the node before looking at edges; the computed cache is direct-mapped and bounded, so a
// collision costs a repetition, never memory. Result runs are built on one shared stack, so that an operation that meets
// only known nodes allocates nothing. Recursion is as deep as there are levels.

#include <algorithm>
#include <cassert>
#include <cstring>
#include <numeric>

#include "compiler/space/diagram_body.h"

namespace kiln {

namespace {

constexpr size_t first_table = 1u << 8;
constexpr size_t first_cache = 1u << 9;
constexpr size_t most_cache = 1u << 21;  // entries; 32 MiB
constexpr size_t edges_a_node = 8, least_edges = 1u << 20;
constexpr size_t most_chunk = 1u << 17;  // edges; 1 MiB

uint64_t mix(uint64_t v) {
    v *= 0x9E3779B97F4A7C15u;
    return v ^ (v >> 29);
}

uint32_t hash_of(uint32_t level, const Diagram::Edge* edges, size_t count) {
    uint64_t h = mix(level + 1);
    for (size_t i = 0; i < count; ++i) h = mix(h ^ (static_cast<uint64_t>(edges[i].last) << 32 | edges[i].child.node));
    return static_cast<uint32_t>(h ^ (h >> 32));
}

size_t slot_of(uint32_t op, uint32_t a, uint32_t b, size_t size) {
    const uint64_t h = mix(mix(static_cast<uint64_t>(a) << 32 | b) + op);
    return static_cast<size_t>(h >> 7) & (size - 1);
}

bool same_edges(const Diagram::Edge* a, const Diagram::Edge* b, size_t count) {
    for (size_t i = 0; i < count; ++i)
        if (a[i].last != b[i].last || a[i].child != b[i].child) return false;
    return true;
}

}  // namespace

Diagram::Body::Body(std::vector<uint32_t> radices_, std::vector<uint32_t> order_, size_t node_limit)
    : radices(std::move(radices_)), order(std::move(order_)), limit(std::max<size_t>(node_limit, 2)) {
    edge_limit = limit > SIZE_MAX / edges_a_node ? SIZE_MAX : std::max(limit * edges_a_node, least_edges);
    assert(order.size() == radices.size() && order.size() < 0xFFFF);
    level_of.assign(radices.size(), ~0u);
    for (uint32_t level = 0; level < order.size(); ++level) {
        assert(order[level] < radices.size() && level_of[order[level]] == ~0u);
        assert(radices[order[level]] >= 1 && radices[order[level]] <= 0xFFFF);
        level_of[order[level]] = level;
        width.push_back(radices[order[level]]);
    }
    Node terminal;
    terminal.level = static_cast<uint16_t>(order.size());
    nodes.assign(2, terminal);
    table_.assign(first_table, 0);
    cache_.assign(first_cache, {});
}

void Diagram::Body::Marks::start(size_t size) {
    if (stamp.size() < size) {
        stamp.resize(size, 0);
        value.resize(size, 0);
    }
    if (++now == 0) {
        std::fill(stamp.begin(), stamp.end(), 0);
        now = 1;
    }
}

NodeId Diagram::Body::child(const Node& node, uint32_t digit) {
    const Edge* e = node.edges;
    if (node.count > 8)
        e = run_at(node.begin(), node.end(), digit);
    else
        while (e->last < digit) ++e;
    return e->child.node;
}

Diagram::Edge* Diagram::Body::allocate(size_t count) {
    if (edges_left_ < count) {
        edges_left_ = std::max(next_chunk_, count);
        next_chunk_ = std::min(next_chunk_ * 2, most_chunk);
        chunks_.push_back(std::make_unique<Edge[]>(edges_left_));
        next_edge_ = chunks_.back().get();
    }
    Edge* got = next_edge_;
    next_edge_ += count;
    edges_left_ -= count;
    return got;
}

void Diagram::Body::grow_table() {
    table_.assign(table_.size() * 2, 0);
    const size_t mask = table_.size() - 1;
    for (NodeId n = 2; n < nodes.size(); ++n) {
        size_t i = nodes[n].hash & mask;
        while (table_[i] != 0) i = (i + 1) & mask;
        table_[i] = n;
    }
    if (cache_.size() < most_cache && cache_.size() < table_.size()) {
        std::vector<Cached> old(cache_.size() * 2);
        old.swap(cache_);
        for (const Cached& c : old)
            if (c.op != 0) cache_[slot_of(c.op, c.a, c.b, cache_.size())] = c;
    }
}

NodeId Diagram::Body::intern(uint32_t level, const Edge* edges, size_t count) {
    assert(count >= 2 && edges[count - 1].last + 1 == width[level]);
    const uint32_t hash = hash_of(level, edges, count);
    size_t mask = table_.size() - 1;
    size_t i = hash & mask;
    for (; table_[i] != 0; i = (i + 1) & mask) {
        const Node& n = nodes[table_[i]];
        if (n.hash == hash && n.level == level && n.count == count && same_edges(n.edges, edges, count)) return table_[i];
    }
    if (nodes.size() >= limit || edges_made + count > edge_limit) exhausted = true;
    if (exhausted) return 0;
    Edge* kept = allocate(count);
    std::copy(edges, edges + count, kept);
    const NodeId id = static_cast<NodeId>(nodes.size());
    nodes.push_back({kept, hash, static_cast<uint16_t>(level), static_cast<uint16_t>(count)});
    table_[i] = id;
    edges_made += count;
    if (nodes.size() * 2 > table_.size()) grow_table();
    return id;
}

NodeId Diagram::Body::finish_runs(uint32_t level, size_t base) {
    const size_t count = runs.size() - base;
    const NodeId result = count == 1 ? runs[base].child.node : intern(level, &runs[base], count);
    runs.resize(base);
    return result;
}

bool Diagram::Body::lookup(uint32_t op, uint32_t a, uint32_t b, uint32_t* result) const {
    const Cached& c = cache_[slot_of(op, a, b, cache_.size())];
    if (c.op != op || c.a != a || c.b != b) return false;
    *result = c.result;
    return true;
}

void Diagram::Body::remember(uint32_t op, uint32_t a, uint32_t b, uint32_t result) {
    if (steps_left-- == 0) exhausted = true;
    if (!exhausted) cache_[slot_of(op, a, b, cache_.size())] = {a, b, op, result};
}

template <uint32_t op>
NodeId Diagram::Body::apply(NodeId a, NodeId b) {
    if constexpr (op == op_both) {
        if (a == b || b == 1) return a;
        if (a == 1) return b;
        if (a == 0 || b == 0) return 0;
        if (a > b) std::swap(a, b);
    } else if constexpr (op == op_either) {
        if (a == b || b == 0) return a;
        if (a == 0) return b;
        if (a == 1 || b == 1) return 1;
        if (a > b) std::swap(a, b);
    } else {
        if (a == b || a == 0 || b == 1) return 0;
        if (b == 0) return a;
    }
    NodeId result = 0;
    if (exhausted || lookup(op, a, b, &result)) return result;
    const Node na = nodes[a], nb = nodes[b];
    const size_t base = runs.size();
    const uint32_t level = std::min(na.level, nb.level);
    if (na.level < nb.level) {
        for (const Edge& e : na) push_run(base, e.last, apply<op>(e.child.node, b));
    } else if (nb.level < na.level) {
        for (const Edge& e : nb) push_run(base, e.last, apply<op>(a, e.child.node));
    } else {
        // A run that settles the result alone is passed in one step, however finely the other node divides it.
        constexpr NodeId settles_a = op == op_either, settles_b = op != op_both;
        for (const Edge *x = na.begin(), *y = nb.begin(); x != na.end();) {
            if (x->child.node == settles_a && x->last > y->last) y = run_at(y, nb.end(), x->last);
            if (y->child.node == settles_b && y->last > x->last) x = run_at(x, na.end(), y->last);
            const uint32_t last = std::min(x->last, y->last);
            push_run(base, last, apply<op>(x->child.node, y->child.node));
            const bool step_x = x->last == last, step_y = y->last == last;
            x += step_x;
            y += step_y;
        }
    }
    result = finish_runs(level, base);
    remember(op, a, b, result);
    return result;
}

template NodeId Diagram::Body::apply<Diagram::Body::op_both>(NodeId, NodeId);
template NodeId Diagram::Body::apply<Diagram::Body::op_either>(NodeId, NodeId);
template NodeId Diagram::Body::apply<Diagram::Body::op_minus>(NodeId, NodeId);

Diagram::Diagram(std::vector<uint32_t> radices, std::vector<uint32_t> order, size_t node_limit)
    : body_(std::make_unique<Body>(std::move(radices), std::move(order), node_limit)) {}
Diagram::~Diagram() = default;

Set Diagram::both(Set a, Set b) { return {body_->apply<Body::op_both>(a.node, b.node)}; }
Set Diagram::either(Set a, Set b) { return {body_->apply<Body::op_either>(a.node, b.node)}; }
Set Diagram::minus(Set a, Set b) { return {body_->apply<Body::op_minus>(a.node, b.node)}; }
Set Diagram::choose(Set condition, Set then, Set otherwise) { return either(both(condition, then), minus(otherwise, condition)); }

Set Diagram::where(uint32_t axis, const std::vector<bool>& digits) {
    Body& b = *body_;
    const uint32_t level = b.level_of[axis];
    assert(digits.size() == b.width[level]);
    const size_t base = b.runs.size();
    for (uint32_t d = 0; d < digits.size(); ++d) b.push_run(base, d, digits[d] ? 1 : 0);
    return {b.finish_runs(level, base)};
}

Set Diagram::where(uint32_t axis, uint32_t digit) {
    Body& b = *body_;
    const uint32_t level = b.level_of[axis], last = b.width[level] - 1;
    assert(digit <= last);
    const size_t base = b.runs.size();
    if (digit > 0) b.push_run(base, digit - 1, 0);
    b.push_run(base, digit, 1);
    if (digit < last) b.push_run(base, last, 0);
    return {b.finish_runs(level, base)};
}

Set Diagram::point(const Digits& digits) {
    Body& b = *body_;
    assert(digits.size() == b.radices.size());
    NodeId below = 1;
    for (uint32_t level = b.levels(); level-- > 0;) {
        const uint32_t digit = digits[b.order[level]], last = b.width[level] - 1;
        assert(digit <= last);
        const size_t base = b.runs.size();
        if (digit > 0) b.push_run(base, digit - 1, 0);
        b.push_run(base, digit, below);
        if (digit < last) b.push_run(base, last, 0);
        below = b.finish_runs(level, base);
    }
    return {below};
}

bool Diagram::contains(Set s, const Digits& digits) const {
    NodeId n = s.node;
    while (n > 1) n = Body::child(body_->nodes[n], digits[body_->order[body_->nodes[n].level]]);
    return n == 1;
}

uint32_t Diagram::axis_of(Set s) const {
    assert(s.node > 1);
    return body_->order[body_->nodes[s.node].level];
}
std::span<const Diagram::Edge> Diagram::edges(Set s) const {
    const Body::Node& n = body_->nodes[s.node];
    return {n.edges, n.count};
}
const std::vector<uint32_t>& Diagram::radices() const { return body_->radices; }
const std::vector<uint32_t>& Diagram::order() const { return body_->order; }
uint32_t Diagram::level_of_axis(uint32_t axis) const { return body_->level_of[axis]; }
size_t Diagram::nodes() const { return body_->nodes.size(); }
size_t Diagram::node_limit() const { return body_->limit; }
bool Diagram::exhausted() const { return body_->exhausted; }
void Diagram::limit_steps(size_t steps) { body_->steps_left = steps; }

}  // namespace kiln
