// An axis moves a member when two variants that differ in this axis alone see it at different places. That is a question about
// projections: forget the axis in both sets, and they meet. When no single axis does it (two axes that rules tie together),
// all axes that the sets depend on are named.

#include "compiler/interfaces/layout_moves.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "compiler/interfaces/mismatch.h"
#include "compiler/space/describe.h"

namespace kiln {
namespace {

// One way in which a resource is declared, and the variants that declare it so in some stage.
struct Form {
    const Resource* resource = nullptr;
    Set set;
    size_t stage = 0;
};

using Place3 = std::tuple<bool, uint32_t, uint32_t>;  // push constants, set, binding

bool is_block(ResourceKind kind) {
    return kind == ResourceKind::uniform_block || kind == ResourceKind::storage_block || kind == ResourceKind::push_constants;
}

class Layouts {
public:
    Layouts(const ShaderStages& shader, const std::vector<StageClasses>& stages, const Modules& modules, Diags& diags)
        : shader_(shader), stages_(stages), modules_(modules), diags_(diags), d_(*shader.space->diagram) {}

    void run() {
        for (size_t i = 0; i < shader_.stages.size(); ++i)
            for (const auto& [module, variants] : shader_.modules[i])
                for (const Resource& r : modules_.list[module].reflection.resources) add(r, variants, shader_.stages[i]);
        for (const auto& [place, forms] : forms_) {
            kinds(forms);
            std::set<std::pair<ResourceKind, std::string>> seen;
            for (const Form& f : forms)
                if (is_block(f.resource->kind) && seen.emplace(f.resource->kind, f.resource->name).second) blocks(forms, f);
        }
    }

private:
    void add(const Resource& r, Set variants, size_t stage) {
        const bool push = r.kind == ResourceKind::push_constants;
        auto& forms = forms_[{push, push ? 0 : r.set, push ? 0 : r.binding}];
        for (Form& f : forms) {
            if (*f.resource != r) continue;
            f.set = d_.either(f.set, variants);
            return;
        }
        forms.push_back({&r, variants, stage});
    }

    Place place(size_t stage) const {
        const Split& split = *stages_[stage].split;
        return {split.files.empty() ? std::string() : split.files.front(), 0, 0};
    }

    std::string condition(Set set) const { return describe_condition(*shader_.space, set, shader_.space->needed); }

    // What a descriptor is, apart from a block's members.
    static std::string shape(const Resource& r) {
        return is_block(r.kind) ? std::to_string(static_cast<int>(r.kind))
                                : std::to_string(static_cast<int>(r.kind)) + image_words(r);
    }

    void kinds(const std::vector<Form>& forms) {
        if (forms.front().resource->kind == ResourceKind::push_constants) return;
        struct Side {
            const Form* form;
            Set set;
        };
        const auto sides_by = [&](const auto& key) {
            std::map<std::string, Side> sides;
            for (const Form& f : forms) {
                const auto [at, fresh] = sides.emplace(key(*f.resource), Side{&f, f.set});
                if (!fresh) at->second.set = d_.either(at->second.set, f.set);
            }
            return sides;
        };
        const auto report = [&](const std::map<std::string, Side>& sides, Severity severity, const std::string& advice) {
            const Form& first = *sides.begin()->second.form;
            Diag& diag = diags_.add(severity, place(first.stage),
                                    "resource clash at " + resource_place(*first.resource) + " between variants: " + advice);
            for (const auto& [key, side] : sides)
                diag.notes.push_back(resource_words(*side.form->resource) + " " + condition(side.set));
        };
        const auto kinds = sides_by([](const Resource& r) { return std::to_string(static_cast<int>(r.kind)); });
        if (kinds.size() > 1) {
            Set seen = Diagram::none();
            bool together = false;
            for (const auto& [kind, side] : kinds) {
                together |= !d_.disjoint(seen, side.set);
                seen = d_.either(seen, side.set);
            }
            return together ? report(kinds, Severity::error, "one layout cannot hold both kinds; give them bindings of their own")
                            : report(kinds, Severity::warning,
                                     "the kind differs, so one descriptor set layout does not serve all variants");
        }
        const auto shapes = sides_by([](const Resource& r) { return shape(r); });
        if (shapes.size() > 1)
            return report(shapes, Severity::warning, "the kind of image differs, so one descriptor does not serve all variants");
        const auto names = sides_by([](const Resource& r) { return r.name; });
        if (names.size() > 1) report(names, Severity::warning, "one slot under two names; the first one stands for both");
    }

    // How a member is laid out, for comparing.
    static std::string layout_of(const Member& m) {
        std::string out = std::to_string(m.offset) + "|" + type_name(m.type) + "|" + std::to_string(m.matrix_stride) + "|" +
                          (m.row_major ? "r" : "c");
        for (const uint32_t s : m.strides) out += "|" + std::to_string(s);
        return out;
    }

    // Of all members that move the first one is named: the others move because of it, or are found next time.
    void blocks(const std::vector<Form>& forms, const Form& first) {
        std::map<std::string, std::vector<std::pair<const Member*, Set>>> members;  // name -> distinct layouts
        std::vector<std::string> order;
        for (const Form& f : forms) {
            if (f.resource->kind != first.resource->kind || f.resource->name != first.resource->name) continue;
            for (const Member& m : f.resource->members) {
                auto [at, fresh] = members.try_emplace(m.name);
                if (fresh) order.push_back(m.name);
                auto& ways = at->second;
                const auto known =
                    std::find_if(ways.begin(), ways.end(), [&](const auto& w) { return layout_of(*w.first) == layout_of(m); });
                if (known == ways.end())
                    ways.emplace_back(&m, f.set);
                else
                    known->second = d_.either(known->second, f.set);
            }
        }
        size_t moved = 0;
        const std::vector<std::pair<const Member*, Set>>* worst = nullptr;
        std::set<uint32_t> axes;
        for (const std::string& name : order) {
            const auto& ways = members[name];
            if (ways.size() < 2) continue;
            ++moved;
            for (const uint32_t a : moving_axes(ways)) axes.insert(a);
            if (!worst || ways.front().first->offset < worst->front().first->offset) worst = &ways;
        }
        if (worst) report_move(first, *worst, axes, moved);
    }

    std::set<uint32_t> moving_axes(const std::vector<std::pair<const Member*, Set>>& ways) {
        std::set<uint32_t> out;
        const size_t axes = shader_.space->axes.size();
        for (uint32_t a = 0; a < axes; ++a) {
            std::vector<bool> keep(axes, true);
            keep[a] = false;
            std::vector<Set> seen;
            for (const auto& [member, set] : ways) {
                const Set without = d_.project(set, keep);
                for (const Set s : seen)
                    if (!d_.disjoint(s, without)) out.insert(a);
                seen.push_back(without);
            }
        }
        if (out.empty())
            for (const auto& [member, set] : ways)
                for (const uint32_t a : d_.support(set)) out.insert(a);
        return out;
    }

    void report_move(const Form& form, const std::vector<std::pair<const Member*, Set>>& ways, const std::set<uint32_t>& axes,
                     size_t moved) {
        const Member &a = *ways[0].first, &b = *ways[1].first;
        std::string what = "member '" + a.name + "' ";
        if (a.offset != b.offset)
            what += "moves from " + std::to_string(a.offset) + " to " + std::to_string(b.offset);
        else if (a.type != b.type)
            what += "changes from " + type_name(a.type) + " to " + type_name(b.type);
        else
            what += "changes its stride or order";
        std::string names;
        for (const uint32_t axis : axes) names += (names.empty() ? "'" : ", '") + shader_.space->axes[axis].name + "'";
        const std::string where =
            form.resource->kind == ResourceKind::push_constants ? "" : " (" + resource_place(*form.resource) + ")";
        Diag& diag = diags_.warning(place(form.stage), resource_words(*form.resource) + where + ": " + what + " with " +
                                                           (axes.size() == 1 ? "axis " : "axes ") + names +
                                                           ": costs sharing and a CPU-side layout a variant");
        if (moved > 1) diag.notes.push_back(std::to_string(moved - 1) + " more members of it move");
        for (const auto& [member, set] : ways) {
            if (diag.notes.size() > 8) break;
            diag.notes.push_back("at " + std::to_string(member->offset) + " as " + type_name(member->type) + " " +
                                 condition(set));
        }
    }

    const ShaderStages& shader_;
    const std::vector<StageClasses>& stages_;
    const Modules& modules_;
    Diags& diags_;
    Diagram& d_;
    std::map<Place3, std::vector<Form>> forms_;
};

}  // namespace

void report_layouts(const ShaderStages& shader, const std::vector<StageClasses>& stages, const Modules& modules, Diags& diags) {
    Layouts(shader, stages, modules, diags).run();
}

}  // namespace kiln
