// Nodes from the last to the first, since references only go forward. An array's index is taken apart into the axes whose
// fields lie in its segments; entries that no valid key reaches are not looked at.

#include <algorithm>
#include <map>

#include "compiler/runtime/table_format.h"
#include "compiler/table/table_nodes.h"

namespace kiln {

namespace {

class NodeReader {
public:
    NodeReader(LeafMaps& maps, const std::vector<uint32_t>& words, uint32_t leaves, const std::vector<uint32_t>& fields)
        : maps_(maps), words_(words), leaves_(leaves) {
        for (uint32_t i = 0; i < fields.size(); ++i)
            if ((fields[i] >> 22 & 31u) != 0) axis_at_[{fields[i] & 0xffffu, fields[i] >> 16 & 63u}] = {i, fields[i] >> 22 & 31u};
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
            const auto node = words_[*it] >> 28 == kf_runs ? read_runs(*it) : read_array(*it);
            if (!node) return std::nullopt;
            nodes_[static_cast<uint32_t>(*it)] = *node;
        }
        return ref(root);
    }

private:
    struct Part {
        uint32_t axis, step;  // what one step of the axis's digit adds to the index
    };

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

    std::optional<LeafMaps::Ref> read_runs(size_t at) {
        const uint32_t n = words_[at] & 0x0fffffffu, field = words_[at + 1];
        const auto axis = axis_at_.find({field & 0xffffu, field >> 16 & 63u});
        if (axis == axis_at_.end() || axis->second.second != (field >> 22 & 31u)) return std::nullopt;
        std::vector<LeafMaps::Edge> edges;
        for (uint32_t i = 0; i < n; ++i) {
            const auto child = ref(words_[at + 2 + n + i]);
            if (!child) return std::nullopt;
            edges.push_back({words_[at + 2 + i], *child});
        }
        return maps_.branch(axis->second.first, std::move(edges));
    }

    // The axes of an array, in the order of their levels.
    bool parts_of(size_t at, std::vector<Part>& parts) const {
        const uint32_t n = words_[at] & 0x0fffffffu;
        uint64_t cells = 1;
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t field = words_[at + 2 + 2 * i];
            uint64_t step = words_[at + 3 + 2 * i];
            uint32_t shift = field >> 16 & 63u;
            const uint32_t end = shift + (field >> 22 & 31u);
            while (shift < end) {
                const auto axis = axis_at_.find({field & 0xffffu, shift});
                if (axis == axis_at_.end() || shift + axis->second.second > end || step > words_[at + 1]) return false;
                parts.push_back({axis->second.first, static_cast<uint32_t>(step)});
                cells *= maps_.radix(axis->second.first);
                if (cells > words_[at + 1]) return false;
                step <<= axis->second.second;
                shift += axis->second.second;
            }
        }
        std::sort(parts.begin(), parts.end(),
                  [&](const Part& a, const Part& b) { return maps_.level_of_axis(a.axis) < maps_.level_of_axis(b.axis); });
        uint64_t most = 0;
        for (size_t i = 0; i < parts.size(); ++i) {
            if (i != 0 && parts[i].axis == parts[i - 1].axis) return false;
            most += uint64_t{parts[i].step} * (maps_.radix(parts[i].axis) - 1);
        }
        return most < words_[at + 1];
    }

    std::optional<LeafMaps::Ref> read_array(size_t at) {
        std::vector<Part> parts;
        if (!parts_of(at, parts)) return std::nullopt;
        return read_cells(at, parts, 0, 0);
    }

    std::optional<LeafMaps::Ref> read_cells(size_t at, const std::vector<Part>& parts, size_t depth, uint32_t index) {
        if (depth == parts.size()) {
            const size_t cells = at + 2 + 2 * size_t{words_[at] & 0x0fffffffu};
            if (words_[at] >> 28 == kf_dense32) return ref(words_[cells + index]);
            return ref(KF_LEAF | (words_[cells + index / 2] >> (index % 2 * 16) & 0xffffu));
        }
        std::vector<LeafMaps::Edge> edges;
        for (uint32_t digit = 0; digit < maps_.radix(parts[depth].axis); ++digit) {
            const auto child = read_cells(at, parts, depth + 1, index + digit * parts[depth].step);
            if (!child) return std::nullopt;
            edges.push_back({digit, *child});
        }
        return maps_.branch(parts[depth].axis, std::move(edges));
    }

    LeafMaps& maps_;
    const std::vector<uint32_t>& words_;
    const uint32_t leaves_;
    std::map<std::pair<uint32_t, uint32_t>, std::pair<uint32_t, uint32_t>> axis_at_;  // word, shift -> axis, bits
    std::unordered_map<uint32_t, LeafMaps::Ref> nodes_;
};

}  // namespace

std::optional<LeafMaps::Ref> read_nodes(LeafMaps& maps, const std::vector<uint32_t>& words, uint32_t root, uint32_t leaves,
                                        const std::vector<uint32_t>& fields) {
    return NodeReader(maps, words, leaves, fields).read(root);
}

}  // namespace kiln
