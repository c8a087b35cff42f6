// A map over few combinations is one array. Its index is the digits' bits put side by side, so neighbouring fields of the key
// are taken out together, often all of them with one shift and mask; what no digit uses up to the next power of two repeats
// a valid entry. Larger maps stay diagrams, but of wide nodes: a node takes in the levels below it up to a few bits, which
// divides the number of loads that wait for each other, and a sub-map that is small as a whole becomes an array in turn.

#include "compiler/table/table_nodes.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <map>
#include <unordered_set>

#include "compiler/runtime/table_format.h"

namespace kiln {

namespace {

constexpr uint32_t root_bits = 14;     // index of an array that replaces a whole map
constexpr uint32_t inner_bits = 8;     // of one that replaces a node's sub-map
constexpr uint32_t window_bits = 6;    // of a node that takes in the levels below it
constexpr uint64_t free_bytes = 1024;  // an array up to this size is taken even when the diagram is smaller
constexpr uint64_t growth = 4;         // else it may be this much larger than the diagram

uint32_t word_of(uint32_t field) { return field & 0xffffu; }
uint32_t shift_of(uint32_t field) { return field >> 16 & 63u; }
uint32_t bits_of(uint32_t field) { return field >> 22 & 31u; }
uint32_t make_field(uint32_t word, uint32_t shift, uint32_t bits) { return word | shift << 16 | bits << 22; }

struct Item {
    LeafMaps::Ref ref = 0;
    std::vector<uint32_t> axes;        // of an array, in the order of their levels; none: runs
    std::vector<LeafMaps::Ref> cells;  // of an array
    bool narrow = false;               // every cell is a leaf of 16 bits
    uint32_t at = 0;
};

// How an array over some axes is indexed.
struct Index {
    std::vector<std::pair<uint32_t, uint32_t>> segments;  // field, stride
    std::vector<uint32_t> place;                          // of each axis: what one step of its digit adds
    uint32_t bits = 0;
};

class Emitter {
public:
    Emitter(const LeafMaps& maps, const std::vector<uint32_t>& fields, uint32_t leaves)
        : maps_(maps), fields_(fields), few_leaves_(leaves <= 0x10000) {}

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
    uint32_t bits(uint32_t axis) const { return bits_of(fields_[axis]); }

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
            path.push_back({choose(ref, ref == root), 0});
        };
        enter(root);
        while (!path.empty()) {
            Open& top = path.back();
            const auto& edges = maps_.edges(top.item.ref);
            const bool array = !top.item.axes.empty();
            const size_t children = array ? top.item.cells.size() : edges.size();
            if (top.next < children && !top.item.narrow) {
                const LeafMaps::Ref child = array ? top.item.cells[top.next] : edges[top.next].child;
                ++top.next;
                enter(child);
                continue;
            }
            items_.push_back(std::move(top.item));
            path.pop_back();
        }
        std::reverse(items_.begin(), items_.end());
        for (size_t i = 0; i < items_.size(); ++i) place_[items_[i].ref] = i;
    }

    Item choose(LeafMaps::Ref ref, bool root) const {
        Item item;
        item.ref = ref;
        item.axes = whole(ref, root);
        if (item.axes.empty()) item.axes = window(ref);
        if (item.axes.empty()) return item;
        const Index index = index_of(item.axes);
        item.cells.resize(size_t{1} << index.bits);
        fill(ref, item.axes, index, 0, 0, item.cells);
        item.narrow = few_leaves_ && std::all_of(item.cells.begin(), item.cells.end(), LeafMaps::is_leaf);
        return item;
    }

    // The axes of an array that may stand for the whole sub-map; none when it would be too large.
    std::vector<uint32_t> whole(LeafMaps::Ref ref, bool root) const {
        uint64_t total = 0, nodes = 0, edges = 0;
        std::map<uint32_t, uint32_t> axis_of_level;
        std::unordered_set<LeafMaps::Ref> seen;
        std::vector<LeafMaps::Ref> todo{ref};
        while (!todo.empty()) {
            const LeafMaps::Ref r = todo.back();
            todo.pop_back();
            if (LeafMaps::is_leaf(r) || !seen.insert(r).second) continue;
            if (axis_of_level.emplace(maps_.level_of(r), maps_.axis_of(r)).second) total += bits(maps_.axis_of(r));
            if (total > (root ? root_bits : inner_bits)) return {};
            ++nodes;
            edges += maps_.edges(r).size();
            for (const auto& e : maps_.edges(r)) todo.push_back(e.child);
        }
        const uint64_t bytes = (uint64_t{1} << total) * (few_leaves_ ? 2 : 4);
        if (bytes > (root ? free_bytes : 0) && bytes > growth * 8 * (nodes + edges)) return {};
        std::vector<uint32_t> axes;
        for (const auto& [level, axis] : axis_of_level) axes.push_back(axis);
        return axes;
    }

    // The axes of a node and of as many levels below it as fit; none when the node's own axis is better written as runs.
    std::vector<uint32_t> window(LeafMaps::Ref ref) const {
        std::vector<uint32_t> axes{maps_.axis_of(ref)};
        uint32_t total = bits(axes[0]);
        if (total > window_bits) {
            if ((uint64_t{1} << total) + 2 > 2 * maps_.edges(ref).size()) return {};
            return axes;
        }
        std::vector<LeafMaps::Ref> front;
        const auto descend = [&](LeafMaps::Ref r) {
            for (const auto& e : maps_.edges(r))
                if (!LeafMaps::is_leaf(e.child) && std::find(front.begin(), front.end(), e.child) == front.end())
                    front.push_back(e.child);
        };
        descend(ref);
        while (!front.empty()) {
            uint32_t level = maps_.level_of(front[0]);
            for (const LeafMaps::Ref r : front) level = std::min(level, maps_.level_of(r));
            const auto nearest = std::find_if(front.begin(), front.end(), [&](auto r) { return maps_.level_of(r) == level; });
            const uint32_t axis = maps_.axis_of(*nearest);
            if (total + bits(axis) > window_bits) break;
            total += bits(axis);
            axes.push_back(axis);
            std::vector<LeafMaps::Ref> old;
            std::swap(old, front);
            for (const LeafMaps::Ref r : old) {
                if (maps_.level_of(r) == level)
                    descend(r);
                else if (std::find(front.begin(), front.end(), r) == front.end())
                    front.push_back(r);
            }
        }
        return axes;
    }

    Index index_of(const std::vector<uint32_t>& axes) const {
        std::vector<size_t> by_place(axes.size());
        for (size_t i = 0; i < axes.size(); ++i) by_place[i] = i;
        std::sort(by_place.begin(), by_place.end(), [&](size_t a, size_t b) {
            const uint32_t fa = fields_[axes[a]], fb = fields_[axes[b]];
            return std::pair(word_of(fa), shift_of(fa)) < std::pair(word_of(fb), shift_of(fb));
        });
        Index out;
        out.place.resize(axes.size());
        for (const size_t i : by_place) {
            const uint32_t field = fields_[axes[i]];
            out.place[i] = 1u << out.bits;
            const bool joins = !out.segments.empty() && word_of(out.segments.back().first) == word_of(field) &&
                               shift_of(out.segments.back().first) + bits_of(out.segments.back().first) == shift_of(field);
            if (joins)
                out.segments.back().first = make_field(word_of(field), shift_of(out.segments.back().first),
                                                       bits_of(out.segments.back().first) + bits_of(field));
            else
                out.segments.emplace_back(field, 1u << out.bits);
            out.bits += bits_of(field);
        }
        return out;
    }

    void fill(LeafMaps::Ref ref, const std::vector<uint32_t>& axes, const Index& index, size_t depth, uint32_t base,
              std::vector<LeafMaps::Ref>& cells) const {
        if (depth == axes.size()) {
            cells[base] = ref;
            return;
        }
        const uint32_t axis = axes[depth], last = maps_.radix(axis) - 1;
        const bool asks = !LeafMaps::is_leaf(ref) && maps_.axis_of(ref) == axis;
        for (uint32_t digit = 0; digit < 1u << bits(axis); ++digit)
            fill(asks ? maps_.child(ref, std::min(digit, last)) : ref, axes, index, depth + 1, base + digit * index.place[depth],
                 cells);
    }

    uint64_t words_of(const Item& item) const {
        if (item.axes.empty()) return 2 + 2 * maps_.edges(item.ref).size();
        const uint64_t cells = item.cells.size();
        return 2 + 2 * index_of(item.axes).segments.size() + (item.narrow ? (cells + 1) / 2 : cells);
    }

    uint32_t ref_of(LeafMaps::Ref ref) const {
        assert(ref != LeafMaps::open);
        return LeafMaps::is_leaf(ref) ? KF_LEAF | LeafMaps::value_of(ref) : items_[place_.at(ref)].at;
    }

    void write(const Item& item, std::vector<uint32_t>& out) const {
        if (item.axes.empty()) {
            const auto& edges = maps_.edges(item.ref);
            out.push_back(static_cast<uint32_t>(kf_runs) << 28 | static_cast<uint32_t>(edges.size()));
            out.push_back(fields_[maps_.axis_of(item.ref)]);
            for (const auto& e : edges) out.push_back(e.last);
            for (const auto& e : edges) out.push_back(ref_of(e.child));
            return;
        }
        const Index index = index_of(item.axes);
        const uint32_t kind = item.narrow ? kf_dense16 : kf_dense32;
        out.push_back(kind << 28 | static_cast<uint32_t>(index.segments.size()));
        out.push_back(static_cast<uint32_t>(item.cells.size()));
        for (const auto& [field, stride] : index.segments) {
            out.push_back(field);
            out.push_back(stride);
        }
        for (size_t i = 0; i < item.cells.size(); ++i) {
            if (!item.narrow)
                out.push_back(ref_of(item.cells[i]));
            else if (i % 2 == 0)
                out.push_back(LeafMaps::value_of(item.cells[i]));
            else
                out.back() |= LeafMaps::value_of(item.cells[i]) << 16;
        }
    }

    const LeafMaps& maps_;
    const std::vector<uint32_t>& fields_;
    const bool few_leaves_;
    std::vector<Item> items_;
    std::unordered_map<LeafMaps::Ref, size_t> place_;
};

}  // namespace

NodeWords write_nodes(const LeafMaps& maps, LeafMaps::Ref map, const std::vector<uint32_t>& fields, uint32_t leaves) {
    return Emitter(maps, fields, leaves).emit(map);
}

}  // namespace kiln
