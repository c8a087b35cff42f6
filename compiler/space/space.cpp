// Rules are taken apart into conditions that must all hold, the order is chosen so that axes of one condition stand near each
// other, and the conditions are conjoined from the deepest upwards: then each conjunction touches only the levels above what
// is already there. When the conjunction grows nevertheless, it is sifted into a better order on the way.

#include "compiler/space/space.h"

#include <algorithm>
#include <numeric>

#include "compiler/space/expr_set.h"
#include "compiler/space/order.h"

namespace kiln {

namespace {

constexpr size_t first_sift = 4'096;  // live nodes at which the order is looked at again
// Sifting is paid in edge visits, some 50 ns each.
constexpr size_t final_budget = 400'000;
constexpr size_t whole_budget = 40'000'000;  // of one space, while its rules are conjoined
constexpr size_t visits_a_node = 16;

struct Part {
    uint32_t rule = 0;
    Conjunct conjunct;
    std::vector<uint32_t> axes;
};

struct Compiled {
    std::unique_ptr<Diagram> diagram;
    Set legal;
    bool ok = true;
    std::vector<size_t> made;  // nodes made for each rule
};

class Compiler {
public:
    Compiler(const std::vector<Axis>& axes, const std::vector<Rule>& rules, size_t limit)
        : axes_(axes), rules_(rules), limit_(limit), made_(rules.size(), 0) {
        for (const Axis& axis : axes) radices_.push_back(static_cast<uint32_t>(axis.values.size()));
        std::vector<Gate> gates;
        for (uint32_t r = 0; r < rules.size(); ++r) {
            for (const Conjunct c : conjuncts(rules[r].expr, !rules[r].forbid)) {
                parts_.push_back({r, c, axes_below(rules[r].expr, c.node)});
                collect_gates(rules[r].expr, c.node, axes.size(), gates);
            }
        }
        diagram_ = std::make_unique<Diagram>(radices_, initial_order(radices_, gates), limit);
    }

    Compiled run() {
        sort_parts(0);
        size_t sift_at = first_sift, look_at = 2 * first_sift;
        for (size_t i = 0; i < parts_.size(); ++i) {
            if (!conjoin(parts_[i])) return {nullptr, {}, false, made_};
            if (diagram_->nodes() < look_at) continue;
            const size_t live = diagram_->reachable({&legal_, 1}).size();
            if (live >= sift_at) {
                reorder(std::min(visits_a_node * live, budget_));
                budget_ -= std::min(visits_a_node * live, budget_);
                sift_at = 2 * diagram_->nodes() + first_sift;
                sort_parts(i + 1);
            } else if (diagram_->nodes() > 8 * live + look_at) {
                reorder(0);
            }
            look_at = 2 * diagram_->nodes() + first_sift;
        }
        const size_t live = diagram_->reachable({&legal_, 1}).size();
        constexpr size_t most_worth_sifting = 200'000;
        if (live > axes_.size() && live < most_worth_sifting)
            reorder(final_budget);
        else if (diagram_->nodes() > 2 * live)
            reorder(0);
        return {std::move(diagram_), legal_, true, made_};
    }

private:
    // From part `first` on: deepest first; among equals the narrow ones.
    void sort_parts(size_t first) {
        const auto key = [&](const Part& p) {
            uint32_t top = ~0u, bottom = 0;
            for (const uint32_t axis : p.axes) {
                top = std::min(top, diagram_->level_of_axis(axis));
                bottom = std::max(bottom, diagram_->level_of_axis(axis));
            }
            return std::pair{~top, bottom};
        };
        std::stable_sort(parts_.begin() + static_cast<std::ptrdiff_t>(first), parts_.end(),
                         [&](const Part& a, const Part& b) { return key(a) < key(b); });
    }

    bool conjoin(const Part& part) {
        // Out of nodes: once more without what earlier conjunctions left behind, in a better order.
        for (int attempt = 0; attempt < 2; ++attempt) {
            const size_t before = diagram_->nodes();
            const Set s = set_of(*diagram_, axes_, rules_[part.rule].expr, part.conjunct);
            const Set next = diagram_->both(legal_, s);
            made_[part.rule] += diagram_->nodes() - before;
            if (!diagram_->exhausted()) {
                legal_ = next;
                return true;
            }
            if (attempt == 0) reorder(final_budget + budget_ / 2);
        }
        return false;
    }

    void reorder(size_t budget) {
        Reordered r = sift(std::move(diagram_), {&legal_, 1}, budget, limit_);
        diagram_ = std::move(r.diagram);
        legal_ = r.sets[0];
    }

    const std::vector<Axis>& axes_;
    const std::vector<Rule>& rules_;
    size_t limit_;
    std::vector<uint32_t> radices_;
    std::vector<Part> parts_;
    std::unique_ptr<Diagram> diagram_;
    Set legal_ = Diagram::all();
    std::vector<size_t> made_;
    size_t budget_ = whole_budget;
};

std::string place_text(const Place& place) {
    return place.file + ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
}

void report_growth(const Space& space, const std::vector<size_t>& made, size_t limit, Diags& diags) {
    std::vector<uint32_t> rules(made.size());
    std::iota(rules.begin(), rules.end(), 0u);
    std::stable_sort(rules.begin(), rules.end(), [&](uint32_t a, uint32_t b) { return made[a] > made[b]; });
    const Rule& worst = space.rules[rules[0]];
    Diag& d = diags.error(worst.place,
                          "the rules of shader '" + space.shader + "' need more than " + Count(limit).grouped() +
                              " diagram nodes; this rule adds " + Count(made[rules[0]]).grouped(),
                          worst.source_line);
    constexpr size_t most_named = 8;
    for (size_t i = 1; i < rules.size() && i < most_named && made[rules[i]] * 20 > made[rules[0]]; ++i)
        d.notes.push_back(place_text(space.rules[rules[i]].place) + ": this rule adds " + Count(made[rules[i]]).grouped());
    d.notes.push_back(
        "rules that tie far-apart axes together by arithmetic or by many alternatives cost most; split or drop them");
}

}  // namespace

std::unique_ptr<Space> build_space(const Manifest& manifest, const Shader& shader, Diags& diags, size_t node_limit) {
    auto space = std::make_unique<Space>();
    space->shader = shader.name;
    std::vector<uint32_t> own(manifest.axes.size(), ~0u);  // the manifest's axis -> the shader's
    for (const uint32_t axis : shader.axes) {
        own[axis] = static_cast<uint32_t>(space->axes.size());
        space->axes.push_back(manifest.axes[axis]);
    }
    for (const Rule& rule : shader.rules) {
        Rule mapped = rule;
        for (ExprNode& node : mapped.expr.nodes)
            if (node.op == Op::axis) node.axis = own[node.axis];
        for (uint32_t& axis : mapped.expr.axes) axis = own[axis];
        std::sort(mapped.expr.axes.begin(), mapped.expr.axes.end());
        space->rules.push_back(std::move(mapped));
    }
    Compiled compiled = Compiler(space->axes, space->rules, node_limit).run();
    if (!compiled.ok) {
        report_growth(*space, compiled.made, node_limit, diags);
        return nullptr;
    }
    space->diagram = std::move(compiled.diagram);
    space->legal = space->needed = compiled.legal;
    return space;
}

Set compile_expr(Space& space, const Expr& expr) {
    return set_of(*space.diagram, space.axes, expr, static_cast<uint32_t>(expr.nodes.size() - 1));
}

Count Space::declared() const {
    Count total(1);
    for (const Axis& axis : axes) total *= Count(axis.values.size());
    return total;
}

std::string Space::describe_variant(const Digits& digits) const {
    std::string text;
    for (size_t i = 0; i < axes.size(); ++i) {
        if (i != 0) text += ' ';
        text += axes[i].name + "=" + axes[i].values[digits[i]].name;
    }
    return text;
}

}  // namespace kiln
