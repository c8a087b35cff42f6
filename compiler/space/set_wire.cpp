#include "compiler/space/set_wire.h"

#include <unordered_map>

namespace kiln {

namespace {

// Node numbers in the bytes: 0 empty, 1 everything, 2... in order of writing.
class Numbering {
public:
    explicit Numbering(const Diagram& diagram) : diagram_(diagram) {
        number_[0] = 0;
        number_[1] = 1;
    }
    uint32_t operator[](Set s) const { return number_.at(s.node); }
    const std::vector<Set>& list() const { return list_; }
    void add(Set root) {
        std::vector<std::pair<Set, size_t>> open;
        if (number_.count(root.node) == 0) open.emplace_back(root, 0);
        while (!open.empty()) {
            const Set s = open.back().first;
            const auto edges = diagram_.edges(s);
            size_t& next = open.back().second;
            while (next < edges.size() && number_.count(edges[next].child.node) != 0) ++next;
            if (next < edges.size()) {
                open.emplace_back(edges[next].child, 0);
                continue;
            }
            open.pop_back();
            if (number_.emplace(s.node, static_cast<uint32_t>(list_.size() + 2)).second) list_.push_back(s);
        }
    }

private:
    const Diagram& diagram_;
    std::unordered_map<uint32_t, uint32_t> number_;
    std::vector<Set> list_;
};

}  // namespace

void write_sets(WireWriter& out, const Diagram& diagram, const std::vector<Set>& sets) {
    Numbering numbering(diagram);
    for (const Set s : sets) numbering.add(s);
    out.u64(diagram.radices().size());
    for (const uint32_t axis : diagram.order()) {
        out.u32(axis);
        out.u32(diagram.radices()[axis]);
    }
    out.u64(numbering.list().size());
    for (const Set s : numbering.list()) {
        const auto edges = diagram.edges(s);
        out.u32(diagram.axis_of(s));
        out.u32(static_cast<uint32_t>(edges.size()));
        for (const Diagram::Edge& edge : edges) {
            out.u32(edge.last);
            out.u32(numbering[edge.child]);
        }
    }
    out.u64(sets.size());
    for (const Set s : sets) out.u32(numbering[s]);
}

bool read_sets(WireReader& in, Diagram& diagram, std::vector<Set>& sets) {
    const auto fail = [&] {
        in.fail();
        return false;
    };
    if (in.u64() != diagram.radices().size()) return fail();
    for (const uint32_t axis : diagram.order())
        if (in.u32() != axis || in.u32() != diagram.radices()[axis]) return fail();
    std::vector<uint32_t> level(diagram.radices().size());
    for (size_t i = 0; i < diagram.order().size(); ++i) level[diagram.order()[i]] = static_cast<uint32_t>(i);

    const size_t nodes = in.count(16);
    std::vector<Set> known{Diagram::none(), Diagram::all()};
    known.reserve(nodes + 2);
    for (size_t i = 0; i < nodes; ++i) {
        const uint32_t axis = in.u32();
        const uint32_t edges = in.u32();
        if (!in.ok() || axis >= level.size() || edges < 2 || edges > diagram.radices()[axis]) return fail();
        Set node = Diagram::none();
        uint32_t first = 0;
        for (uint32_t e = 0; e < edges; ++e) {
            const uint32_t last = in.u32();
            const uint32_t child = in.u32();
            if (!in.ok() || child >= known.size() || last < first || last >= diagram.radices()[axis]) return fail();
            const Set below = known[child];
            if (below.node > 1 && level[diagram.axis_of(below)] <= level[axis]) return fail();
            if (below != Diagram::none()) {
                std::vector<bool> digits(diagram.radices()[axis]);
                for (uint32_t d = first; d <= last; ++d) digits[d] = true;
                node = diagram.either(node, diagram.both(diagram.where(axis, digits), below));
            }
            first = last + 1;
        }
        if (first != diagram.radices()[axis]) return fail();
        known.push_back(node);
    }
    const size_t count = in.count(4);
    sets.clear();
    for (size_t i = 0; i < count; ++i) {
        const uint32_t number = in.u32();
        if (!in.ok() || number >= known.size()) return fail();
        sets.push_back(known[number]);
    }
    return in.ok();
}

}  // namespace kiln
