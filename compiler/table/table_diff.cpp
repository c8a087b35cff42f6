// Both shaders' sets are carried into one diagram over the union of their axes and value names. There a stage's content is a
// map from sets to digests, and "unchanged" is the union, over digests that both tables have, of the variants that have them
// in both: linear in the number of modules, where comparing modules in pairs would be quadratic.

#include "compiler/table/table_diff.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "compiler/space/describe.h"

namespace kiln {

namespace {

// The union of two shaders' axes, and how digits of one side read there.
class Joint {
public:
    Joint(TableShader* a, TableShader* b) {
        for (TableShader* side : {a, b}) {
            if (side == nullptr) continue;
            for (const Axis& axis : side->space.axes) {
                Axis& to = space.axes[index_of(axis)];
                for (const AxisValue& v : axis.values)
                    if (digit_of(to, v.name) == to.values.size()) to.values.push_back(v);
            }
        }
        space.shader = (a != nullptr ? a : b)->space.shader;
        std::vector<uint32_t> radices, order;
        for (const Axis& axis : space.axes) radices.push_back(static_cast<uint32_t>(axis.values.size()));
        // The order of the side with more axes keeps its diagrams as small as they were; what it lacks comes last.
        const bool b_leads = a == nullptr || (b != nullptr && b->space.axes.size() > a->space.axes.size());
        for (TableShader* side : {b_leads ? b : a, b_leads ? a : b}) {
            if (side == nullptr) continue;
            for (const uint32_t axis : side->space.diagram->order()) {
                const auto joint = static_cast<uint32_t>(index_of(side->space.axes[axis]));
                if (std::find(order.begin(), order.end(), joint) == order.end()) order.push_back(joint);
            }
        }
        space.diagram = std::make_unique<Diagram>(radices, order);
    }

    // A set of one side's diagram, with every axis that the side lacks at its first value.
    Set bring(TableShader& side, Set set) {
        Diagram& d = *space.diagram;
        std::vector<uint32_t> axes;
        std::vector<bool> has(space.axes.size());
        std::vector<std::vector<uint32_t>> digits;
        for (const Axis& axis : side.space.axes) {
            axes.push_back(static_cast<uint32_t>(index_of(axis)));
            has[axes.back()] = true;
            digits.emplace_back();
            for (const AxisValue& v : axis.values)
                digits.back().push_back(static_cast<uint32_t>(digit_of(space.axes[axes.back()], v.name)));
        }
        std::unordered_map<uint32_t, Set> seen;
        Set out = bring_step(*side.space.diagram, set, axes, digits, seen);
        for (uint32_t a = 0; a < space.axes.size(); ++a) {
            if (!has[a]) {
                out = d.both(out, d.where(a, 0));
                continue;
            }
            // Values that only the other side has belong to none of this side's variants.
            std::vector<bool> own(space.axes[a].values.size());
            for (size_t i = 0; i < axes.size(); ++i)
                if (axes[i] == a)
                    for (const uint32_t digit : digits[i]) own[digit] = true;
            if (std::find(own.begin(), own.end(), false) != own.end()) out = d.both(out, d.where(a, own));
        }
        return out;
    }

    Space space;

private:
    size_t index_of(const Axis& axis) {
        for (size_t i = 0; i < space.axes.size(); ++i)
            if (space.axes[i].name == axis.name) return i;
        space.axes.push_back(axis);
        space.axes.back().values.clear();
        return space.axes.size() - 1;
    }
    static size_t digit_of(const Axis& axis, const std::string& value) {
        size_t i = 0;
        while (i < axis.values.size() && axis.values[i].name != value) ++i;
        return i;
    }
    Set bring_step(const Diagram& from, Set set, const std::vector<uint32_t>& axes,
                   const std::vector<std::vector<uint32_t>>& digits, std::unordered_map<uint32_t, Set>& seen) {
        if (set == Diagram::none() || set == Diagram::all()) return set;
        if (const auto it = seen.find(set.node); it != seen.end()) return it->second;
        const uint32_t axis = from.axis_of(set), joint = axes[axis];
        std::vector<Set> child(space.axes[joint].values.size(), Diagram::none());
        uint32_t digit = 0;
        for (const Diagram::Edge& e : from.edges(set)) {
            const Set below = bring_step(from, e.child, axes, digits, seen);
            for (; digit <= e.last; ++digit) child[digits[axis][digit]] = below;
        }
        std::vector<Diagram::Edge> runs;
        for (uint32_t d = 0; d < child.size(); ++d) runs.push_back({d, child[d]});
        return seen[set.node] = space.diagram->branch(joint, runs);
    }
};

struct Side {
    TableView& table;
    TableShader& shader;
    Set needed;                                      // in the joint diagram
    std::map<Stage, std::map<Digest, Set>> content;  // by what a stage's module and its texts are
    std::map<uint32_t, Set> modules;                 // variants that use each module, in any stage
};

std::vector<Target> common_targets(const TableView& a, const TableView& b) {
    std::vector<Target> out;
    for (const Target t : a.targets())
        if (std::find(b.targets().begin(), b.targets().end(), t) != b.targets().end()) out.push_back(t);
    return out;
}

Digest content_of(TableView& table, const TableShader& shader, uint32_t module, const std::vector<Target>& targets) {
    KeyHasher hasher("kiln.diff.v1");
    hasher.field("module", table.module(module).digest);
    for (const TableText& text : table.texts(shader, module)) {
        if (std::find(targets.begin(), targets.end(), text.target) == targets.end()) continue;
        hasher.field("target", name_of(text.target)).field("hole", text.refusal);
        hasher.field("text", text.artifact ? table.text(*text.artifact) : std::string());
    }
    return hasher.finish();
}

Side side_of(TableView& table, TableShader& shader, Joint& joint, const std::vector<Target>& targets) {
    Side out{table, shader, joint.bring(shader, shader.space.needed), {}, {}};
    Diagram& d = *joint.space.diagram;
    for (size_t s = 0; s < shader.stages.size(); ++s)
        for (const uint32_t m : shader.stages[s].modules) {
            const Set users = joint.bring(shader, shader.variants_of(s, m));
            Set& same = out.content[shader.stages[s].stage][content_of(table, shader, m, targets)];
            same = d.either(same, users);
            Set& uses = out.modules[m];
            uses = d.either(uses, users);
        }
    return out;
}

// Variants needed in both that have the same content in every stage.
Set unchanged(Diagram& d, const Side& a, const Side& b) {
    Set out = d.both(a.needed, b.needed);
    std::set<Stage> stages;
    for (const auto& [stage, content] : a.content) stages.insert(stage);
    for (const auto& [stage, content] : b.content) stages.insert(stage);
    for (const Stage stage : stages) {
        const auto in_a = a.content.find(stage), in_b = b.content.find(stage);
        if (in_a == a.content.end() || in_b == b.content.end()) return Diagram::none();
        Set same = Diagram::none();
        for (const auto& [digest, set] : in_a->second)
            if (const auto other = in_b->second.find(digest); other != in_b->second.end())
                same = d.either(same, d.both(set, other->second));
        out = d.both(out, same);
    }
    return out;
}

void by_axis(DiffShader& out, Joint& joint, const Side* a, const Side* b) {
    Diagram& d = *joint.space.diagram;
    for (uint32_t axis = 0; axis < joint.space.axes.size(); ++axis) {
        DiffAxis to{joint.space.axes[axis].name, {}};
        for (uint32_t digit = 0; digit < joint.space.axes[axis].values.size(); ++digit) {
            const Set here = d.where(axis, digit);
            DiffValue value;
            value.name = joint.space.axes[axis].values[digit].name;
            const auto fill = [&](const Side* side, Count& count, size_t& modules, uint64_t& bytes) {
                if (side == nullptr) return;
                count = d.count(d.both(side->needed, here));
                for (const auto& [module, users] : side->modules)
                    if (!d.disjoint(users, here)) {
                        ++modules;
                        bytes += side->table.module(module).words.size_bytes();
                    }
            };
            fill(a, value.before, value.modules_before, value.bytes_before);
            fill(b, value.after, value.modules_after, value.bytes_after);
            to.values.push_back(std::move(value));
        }
        out.axes.push_back(std::move(to));
    }
}

DiffShader diff_shader(TableView& before, TableShader* a, TableView& after, TableShader* b) {
    DiffShader out;
    Joint joint(a, b);
    Diagram& d = *joint.space.diagram;
    const std::vector<Target> targets = common_targets(before, after);
    std::optional<Side> in_a, in_b;
    if (a != nullptr) in_a.emplace(side_of(before, *a, joint, targets));
    if (b != nullptr) in_b.emplace(side_of(after, *b, joint, targets));
    out.name = joint.space.shader;
    out.only_before = b == nullptr;
    out.only_after = a == nullptr;
    const Set none = Diagram::none(), had = in_a ? in_a->needed : none, has = in_b ? in_b->needed : none;
    const Set lost = d.minus(had, has), added = d.minus(has, had);
    const Set both = d.both(had, has);
    const Set changed = in_a && in_b ? d.minus(both, unchanged(d, *in_a, *in_b)) : none;
    out.before = d.count(had);
    out.after = d.count(has);
    out.lost = d.count(lost);
    out.added = d.count(added);
    out.changed = d.count(changed);
    if (lost != none) out.lost_when = describe_condition(joint.space, lost, had);
    if (added != none) out.added_when = describe_condition(joint.space, added, has);
    if (changed != none) out.changed_when = describe_condition(joint.space, changed, both);
    if (a != nullptr && b != nullptr) {
        const auto missing = [](const TableShader& from, const TableShader& in, std::vector<std::string>& names) {
            for (const Axis& axis : from.space.axes)
                if (std::none_of(in.space.axes.begin(), in.space.axes.end(),
                                 [&](const Axis& other) { return other.name == axis.name; }))
                    names.push_back(axis.name);
        };
        missing(*a, *b, out.axes_lost);
        missing(*b, *a, out.axes_added);
    }
    by_axis(out, joint, in_a ? &*in_a : nullptr, in_b ? &*in_b : nullptr);
    return out;
}

std::string change(const std::string& what, uint64_t before, uint64_t after) {
    if (before == after) return what + " " + Count(before).grouped();
    return what + " " + Count(before).grouped() + " -> " + Count(after).grouped();
}

}  // namespace

bool TableDiff::same() const {
    return targets_lost.empty() && targets_added.empty() &&
           std::all_of(shaders.begin(), shaders.end(), [](const DiffShader& s) { return s.same(); });
}

TableDiff diff_tables(TableView& before, TableView& after) {
    TableDiff out;
    out.bytes_before = before.bytes().size();
    out.bytes_after = after.bytes().size();
    out.modules_before = before.info().module_count;
    out.modules_after = after.info().module_count;
    out.spirv_before = before.info().spirv_bytes;
    out.spirv_after = after.info().spirv_bytes;
    out.packed_before = before.info().packed_bytes;
    out.packed_after = after.info().packed_bytes;
    out.tools_before = before.tools();
    out.tools_after = after.tools();
    const std::vector<Target> common = common_targets(before, after);
    for (const Target t : before.targets())
        if (std::find(common.begin(), common.end(), t) == common.end()) out.targets_lost.push_back(t);
    for (const Target t : after.targets())
        if (std::find(common.begin(), common.end(), t) == common.end()) out.targets_added.push_back(t);
    for (TableShader& s : before.shaders()) out.shaders.push_back(diff_shader(before, &s, after, after.shader(s.space.shader)));
    for (TableShader& s : after.shaders())
        if (before.shader(s.space.shader) == nullptr) out.shaders.push_back(diff_shader(before, nullptr, after, &s));
    return out;
}

std::string render(const TableDiff& diff) {
    std::string out = change("bytes", diff.bytes_before, diff.bytes_after) + ", " +
                      change("modules", diff.modules_before, diff.modules_after) + ", " +
                      change("SPIR-V bytes", diff.spirv_before, diff.spirv_after) + ", " +
                      change("packed text bytes", diff.packed_before, diff.packed_after) + "\n";
    if (diff.tools_before != diff.tools_after) out += "tools: " + diff.tools_before + " -> " + diff.tools_after + "\n";
    for (const Target t : diff.targets_lost) out += std::string("target ") + name_of(t) + " is gone\n";
    for (const Target t : diff.targets_added) out += std::string("target ") + name_of(t) + " is new\n";
    for (const DiffShader& s : diff.shaders) {
        out += s.name + ": ";
        if (s.only_before) out += "gone, ";
        if (s.only_after) out += "new, ";
        out += s.before.grouped() + " -> " + s.after.grouped() + " variants: " + s.added.grouped() + " added, " +
               s.lost.grouped() + " lost, " + s.changed.grouped() + " changed\n";
        for (const std::string& axis : s.axes_lost) out += "  axis " + axis + " is gone\n";
        for (const std::string& axis : s.axes_added) out += "  axis " + axis + " is new\n";
        if (!s.added_when.empty()) out += "  added " + s.added_when + "\n";
        if (!s.lost_when.empty()) out += "  lost " + s.lost_when + "\n";
        if (!s.changed_when.empty()) out += "  changed " + s.changed_when + "\n";
        if (s.same()) continue;
        for (const DiffAxis& axis : s.axes)
            for (const DiffValue& v : axis.values) {
                if (v.before == v.after && v.modules_before == v.modules_after && v.bytes_before == v.bytes_after) continue;
                out += "  " + axis.name + "=" + v.name + ": variants " + v.before.grouped() + " -> " + v.after.grouped() + ", " +
                       change("modules", v.modules_before, v.modules_after) + ", " +
                       change("bytes", v.bytes_before, v.bytes_after) + "\n";
            }
    }
    return out;
}

}  // namespace kiln
