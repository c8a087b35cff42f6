// A map over few combinations is one array, indexed by a sum of digits times strides: the loads of the digits do not wait for
// each other, where every level of a diagram waits for the one above. Larger maps stay diagrams, and a node whose whole
// sub-map is small becomes an array in turn, which cuts the deepest, most visited levels.

#include "compiler/table_nodes.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <unordered_set>

#include "compiler/runtime/table_format.h"

namespace kiln {

namespace {

constexpr uint64_t root_cells = 16384;  // of an array that replaces a whole map
constexpr uint64_t inner_cells = 256;   // of one that replaces a node's sub-map
constexpr uint64_t free_bytes = 1024;   // an array up to this size is taken even when the diagram is smaller
constexpr uint64_t growth = 4;          // else it may be this much larger than the diagram

struct Item {
    LeafMaps::Ref ref = 0;
    std::vector<uint32_t> dense;  // the axes of an array; empty: a node of its own
    uint32_t at = 0;
};

class Emitter {
public:
    Emitter(const LeafMaps& maps, const std::vector<uint32_t>& fields, uint32_t leaves)
        : maps_(maps), fields_(fields), narrow_(leaves <= 0x10000) {}

    NodeWords emit(LeafMaps::Ref root) {
        NodeWords out;
        if (root == LeafMaps::open) {
            out.root = KF_NO_LEAF;
            return out;
        }
        out.axes = maps_.support(root);
        std::sort(out.axes.begin(), out.axes.end());
        if (LeafMaps::is_leaf(root)) {
            out.root = KF_LEAF | LeafMaps::value_of(root);
            return out;
        }
        order(root);
        uint64_t at = 0;
        for (Item& item : items_) {
            item.at = static_cast<uint32_t>(at);
            at += words_of(item);
        }
        assert(at < KF_LEAF);
        for (const Item& item : items_) write(item, out.words);
        assert(out.words.size() == at);
        return out;
    }

private:
    // Parents before children: the reverse of the order in which a depth-first walk leaves the nodes.
    void order(LeafMaps::Ref root) {
        struct Open {
            Item item;
            size_t next;
        };
        std::vector<Open> path;
        const auto enter = [&](LeafMaps::Ref ref) {
            if (LeafMaps::is_leaf(ref) || place_.count(ref) != 0) return;
            place_[ref] = 0;
            path.push_back({{ref, dense_axes(ref, ref == root), 0}, 0});
        };
        enter(root);
        while (!path.empty()) {
            Open& top = path.back();
            const auto& edges = maps_.edges(top.item.ref);
            if (top.item.dense.empty() && top.next < edges.size()) {
                enter(edges[top.next++].child);
                continue;
            }
            items_.push_back(std::move(top.item));
            path.pop_back();
        }
        std::reverse(items_.begin(), items_.end());
        for (size_t i = 0; i < items_.size(); ++i) place_[items_[i].ref] = i;
    }

    // The axes of an array that may stand for the whole sub-map, in the order of their levels; none when it would be too large.
    std::vector<uint32_t> dense_axes(LeafMaps::Ref ref, bool root) const {
        uint64_t cells = 1, nodes = 0, edges = 0;
        std::map<uint32_t, uint32_t> axis_of_level;
        std::unordered_set<LeafMaps::Ref> seen;
        std::vector<LeafMaps::Ref> todo{ref};
        while (!todo.empty()) {
            const LeafMaps::Ref r = todo.back();
            todo.pop_back();
            if (LeafMaps::is_leaf(r) || !seen.insert(r).second) continue;
            if (axis_of_level.emplace(maps_.level_of(r), maps_.axis_of(r)).second) cells *= maps_.radix(maps_.axis_of(r));
            if (cells > (root ? root_cells : inner_cells)) return {};
            ++nodes;
            edges += maps_.edges(r).size();
            for (const auto& e : maps_.edges(r)) todo.push_back(e.child);
        }
        const uint64_t bytes = cells * (narrow_ ? 2 : 4);
        if (axis_of_level.size() > KF_MAX_FIELDS) return {};
        if (bytes > (root ? free_bytes : 0) && bytes > growth * 8 * (nodes + edges)) return {};
        std::vector<uint32_t> axes;
        for (const auto& [level, axis] : axis_of_level) axes.push_back(axis);
        return axes;
    }

    uint64_t cells_of(const Item& item) const {
        uint64_t cells = 1;
        for (const uint32_t axis : item.dense) cells *= maps_.radix(axis);
        return cells;
    }

    // A node with an edge for nearly every digit is an array over its own axis.
    bool direct(const Item& item) const {
        const auto& edges = maps_.edges(item.ref);
        return maps_.radix(maps_.axis_of(item.ref)) <= 2 * edges.size();
    }

    uint64_t words_of(const Item& item) const {
        if (!item.dense.empty()) return 2 + 2 * item.dense.size() + (narrow_ ? (cells_of(item) + 1) / 2 : cells_of(item));
        if (direct(item)) return 4 + maps_.radix(maps_.axis_of(item.ref));
        return 2 + 2 * maps_.edges(item.ref).size();
    }

    uint32_t ref_of(LeafMaps::Ref ref) const {
        assert(ref != LeafMaps::open);
        return LeafMaps::is_leaf(ref) ? KF_LEAF | LeafMaps::value_of(ref) : items_[place_.at(ref)].at;
    }

    void write(const Item& item, std::vector<uint32_t>& out) const {
        if (!item.dense.empty()) return write_dense(item, out);
        const uint32_t axis = maps_.axis_of(item.ref);
        const auto& edges = maps_.edges(item.ref);
        if (direct(item)) {
            out.insert(out.end(), {static_cast<uint32_t>(kf_dense32) << 28 | 1u, maps_.radix(axis), fields_[axis], 1u});
            uint32_t digit = 0;
            for (const auto& e : edges)
                for (; digit <= e.last; ++digit) out.push_back(ref_of(e.child));
            return;
        }
        out.push_back(static_cast<uint32_t>(kf_runs) << 28 | static_cast<uint32_t>(edges.size()));
        out.push_back(fields_[axis]);
        for (const auto& e : edges) out.push_back(e.last);
        for (const auto& e : edges) out.push_back(ref_of(e.child));
    }

    void write_dense(const Item& item, std::vector<uint32_t>& out) const {
        const uint64_t cells = cells_of(item);
        const uint32_t kind = narrow_ ? kf_dense16 : kf_dense32;
        out.push_back(kind << 28 | static_cast<uint32_t>(item.dense.size()));
        out.push_back(static_cast<uint32_t>(cells));
        uint64_t stride = cells;
        for (const uint32_t axis : item.dense) {
            stride /= maps_.radix(axis);
            out.push_back(fields_[axis]);
            out.push_back(static_cast<uint32_t>(stride));
        }
        std::vector<uint32_t> values;
        fill(item.ref, item.dense, 0, values);
        assert(values.size() == cells);
        if (!narrow_) {
            for (const uint32_t v : values) out.push_back(KF_LEAF | v);
            return;
        }
        for (size_t i = 0; i < values.size(); i += 2)
            out.push_back(values[i] | (i + 1 < values.size() ? values[i + 1] << 16 : 0));
    }

    void fill(LeafMaps::Ref ref, const std::vector<uint32_t>& axes, size_t depth, std::vector<uint32_t>& values) const {
        if (depth == axes.size()) {
            assert(LeafMaps::is_leaf(ref) && ref != LeafMaps::open);
            values.push_back(LeafMaps::value_of(ref));
            return;
        }
        const uint32_t axis = axes[depth];
        const bool asks = !LeafMaps::is_leaf(ref) && maps_.axis_of(ref) == axis;
        for (uint32_t digit = 0; digit < maps_.radix(axis); ++digit)
            fill(asks ? maps_.child(ref, digit) : ref, axes, depth + 1, values);
    }

    const LeafMaps& maps_;
    const std::vector<uint32_t>& fields_;
    const bool narrow_;
    std::vector<Item> items_;
    std::unordered_map<LeafMaps::Ref, size_t> place_;
};

// Reads what Emitter writes: nodes from the last to the first, since references only go forward.
class NodeReader {
public:
    NodeReader(LeafMaps& maps, const std::vector<uint32_t>& words, uint32_t leaves, const std::vector<uint32_t>& fields)
        : maps_(maps), words_(words), leaves_(leaves) {
        for (uint32_t i = 0; i < fields.size(); ++i)
            if (maps.radix(i) > 1) axis_of_[fields[i]] = i;
    }

    std::optional<LeafMaps::Ref> read(uint32_t root) {
        std::vector<size_t> places;
        for (size_t at = 0; at < words_.size();) {
            const size_t size = node_size(at);
            if (size == 0) return std::nullopt;
            places.push_back(at);
            at += size;
        }
        for (auto it = places.rbegin(); it != places.rend(); ++it) {
            const auto node = read_node(*it);
            if (!node) return std::nullopt;
            nodes_[static_cast<uint32_t>(*it)] = *node;
        }
        return ref(root);
    }

private:
    // Words that the node takes; 0 when it does not fit.
    size_t node_size(size_t at) const {
        if (words_.size() - at < 2) return 0;
        const uint64_t n = words_[at] & 0x0fffffffu, cells = words_[at + 1], kind = words_[at] >> 28;
        uint64_t size = 2 + 2 * n;
        if (kind == kf_dense32) size += cells;
        if (kind == kf_dense16) size += (cells + 1) / 2;
        if (kind > kf_runs || (kind != kf_runs && n > KF_MAX_FIELDS) || n == 0 || size > words_.size() - at) return 0;
        return static_cast<size_t>(size);
    }

    std::optional<LeafMaps::Ref> ref(uint32_t word) const {
        if (word == KF_NO_LEAF) return LeafMaps::open;
        if ((word & KF_LEAF) != 0) {
            if ((word & ~KF_LEAF) >= leaves_) return std::nullopt;
            return LeafMaps::leaf(word & ~KF_LEAF);
        }
        const auto it = nodes_.find(word);
        if (it == nodes_.end()) return std::nullopt;
        return it->second;
    }

    std::optional<LeafMaps::Ref> read_node(size_t at) {
        const uint32_t n = words_[at] & 0x0fffffffu, kind = words_[at] >> 28;
        if (kind == kf_runs) {
            const auto axis = axis_of_.find(words_[at + 1]);
            if (axis == axis_of_.end()) return std::nullopt;
            std::vector<LeafMaps::Edge> edges;
            for (uint32_t i = 0; i < n; ++i) {
                const auto child = ref(words_[at + 2 + n + i]);
                if (!child) return std::nullopt;
                edges.push_back({words_[at + 2 + i], *child});
            }
            return maps_.branch(axis->second, std::move(edges));
        }
        std::vector<uint32_t> axes;
        uint64_t cells = 1;
        for (uint32_t i = 0; i < n; ++i) {
            const auto axis = axis_of_.find(words_[at + 2 + 2 * i]);
            if (axis == axis_of_.end()) return std::nullopt;
            axes.push_back(axis->second);
        }
        for (uint32_t i = n; i-- > 0;) {
            if (words_[at + 3 + 2 * i] != cells) return std::nullopt;
            cells *= maps_.radix(axes[i]);
            if (cells > words_[at + 1]) return std::nullopt;
        }
        if (cells != words_[at + 1]) return std::nullopt;
        std::vector<LeafMaps::Ref> values;
        const size_t data = at + 2 + 2 * size_t{n};
        for (size_t i = 0; i < cells; ++i) {
            const uint32_t word =
                kind == kf_dense16 ? KF_LEAF | (words_[data + i / 2] >> (i % 2 * 16) & 0xffffu) : words_[data + i];
            const auto child = ref(word);
            if (!child) return std::nullopt;
            values.push_back(*child);
        }
        // Innermost axis first: each step folds runs of radix values into one node.
        for (uint32_t i = n; i-- > 0;) {
            const uint32_t radix = maps_.radix(axes[i]);
            std::vector<LeafMaps::Ref> folded;
            for (size_t v = 0; v < values.size(); v += radix) {
                std::vector<LeafMaps::Edge> edges;
                for (uint32_t d = 0; d < radix; ++d) edges.push_back({d, values[v + d]});
                const auto node = maps_.branch(axes[i], std::move(edges));
                if (!node) return std::nullopt;
                folded.push_back(*node);
            }
            values = std::move(folded);
        }
        return values[0];
    }

    LeafMaps& maps_;
    const std::vector<uint32_t>& words_;
    const uint32_t leaves_;
    std::unordered_map<uint32_t, uint32_t> axis_of_;  // by field; axes of one value are never tested
    std::unordered_map<uint32_t, LeafMaps::Ref> nodes_;
};

}  // namespace

NodeWords write_nodes(const LeafMaps& maps, LeafMaps::Ref map, const std::vector<uint32_t>& fields, uint32_t leaves) {
    return Emitter(maps, fields, leaves).emit(map);
}

std::optional<LeafMaps::Ref> read_nodes(LeafMaps& maps, const std::vector<uint32_t>& words, uint32_t root, uint32_t leaves,
                                        const std::vector<uint32_t>& fields) {
    return NodeReader(maps, words, leaves, fields).read(root);
}

}  // namespace kiln
