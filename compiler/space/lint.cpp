// Everything that can be said soundly about a manifest's rules from the diagrams of its shaders. A rule of the manifest is
// copied to every shader that has its axes, so answers are gathered per place and reported once, when they hold for every
// copy; in the same way a value is reported only when no shader can have it.

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "compiler/space/expr_set.h"
#include "compiler/space/implied.h"
#include "compiler/space/space.h"

namespace kiln {

namespace {

constexpr size_t scratch_nodes = 2'000'000;
constexpr size_t scratch_steps = 20'000'000;  // a second or two
constexpr size_t most_work = 50'000'000;      // rules times nodes of the legal set

using RuleKey = std::tuple<std::string, uint32_t, uint32_t, std::string>;
RuleKey key_of(const Rule& rule) { return {rule.place.file, rule.place.line, rule.place.column, rule.text}; }

std::string rule_line(const Rule& rule) {
    std::string text = rule.place.file + ":" + std::to_string(rule.place.line) + ":" + std::to_string(rule.place.column);
    text += (rule.forbid ? ": forbid: " : ": require: ") + rule.text;
    if (!rule.because.empty()) text += "  (" + rule.because + ")";
    return text;
}

struct RuleFacts {
    const Rule* rule = nullptr;
    unsigned copies = 0, empty = 0, implied = 0;
    const Rule* twin = nullptr;  // another rule that says the same, in the last shader looked at
};

struct AxisFacts {
    std::vector<bool> possible;            // in some shader
    std::vector<const Rule*> excluded_by;  // per value: a rule that excludes it alone, or null
};

struct Clash {
    std::vector<const Rule*> rules;
    std::vector<std::string> shaders;
};

class Linter {
public:
    Linter(const Manifest& manifest, Diags& diags) : manifest_(manifest), diags_(diags) {}

    void look_at(Space& space) {
        Diagram scratch(space.diagram->radices(), space.diagram->order(), scratch_nodes);
        scratch.limit_steps(scratch_steps);
        std::vector<Set> allowed;
        for (const Rule& rule : space.rules) {
            const Set holds = set_of(scratch, space.axes, rule.expr, static_cast<uint32_t>(rule.expr.nodes.size() - 1));
            allowed.push_back(rule.forbid ? scratch.complement(holds) : holds);
        }
        if (space.legal == Diagram::none()) {
            note_clash(space, scratch, allowed);
            return;
        }
        note_values(space, scratch, allowed);
        note_rules(space, scratch, allowed);
    }

    void report() {
        for (const RuleKey& key : rule_order_) report_rule(rules_.at(key));
        for (const Axis& axis : manifest_.axes)
            if (const auto it = axes_.find(axis.name); it != axes_.end()) report_values(axis, it->second);
        for (const Clash& clash : clashes_) report_clash(clash);
    }

private:
    RuleFacts& facts_of(const Rule& rule) {
        const auto [it, fresh] = rules_.try_emplace(key_of(rule));
        if (fresh) rule_order_.push_back(it->first);
        it->second.rule = &rule;
        return it->second;
    }

    // Rules that share no axis, directly or through others, say nothing about each other: each connected part is looked at alone.
    static std::vector<std::vector<uint32_t>> connected(const Space& space, const std::vector<uint32_t>& rules) {
        std::vector<uint32_t> parent(space.axes.size());
        std::iota(parent.begin(), parent.end(), 0u);
        const auto root = [&](uint32_t axis) {
            while (parent[axis] != axis) axis = parent[axis] = parent[parent[axis]];
            return axis;
        };
        for (const uint32_t r : rules)
            for (const uint32_t axis : space.rules[r].expr.axes) parent[root(axis)] = root(space.rules[r].expr.axes[0]);
        std::map<uint32_t, std::vector<uint32_t>> parts;
        for (const uint32_t r : rules) parts[root(space.rules[r].expr.axes[0])].push_back(r);
        std::vector<std::vector<uint32_t>> found;
        for (auto& [axis, part] : parts) found.push_back(std::move(part));
        return found;
    }

    void note_rules(const Space& space, Diagram& scratch, const std::vector<Set>& allowed) {
        std::vector<uint32_t> telling;  // rules that exclude something
        for (uint32_t r = 0; r < allowed.size(); ++r) {
            RuleFacts& facts = facts_of(space.rules[r]);
            ++facts.copies;
            if (allowed[r] == Diagram::all() && !scratch.exhausted())
                ++facts.empty;
            else if (!space.rules[r].expr.axes.empty())
                telling.push_back(r);
        }
        // Deepest first, as implied_by_others() likes it.
        const auto top = [&](uint32_t r) {
            return allowed[r].node <= 1 ? 0 : scratch.level_of_axis(scratch.axis_of(allowed[r]));
        };
        std::stable_sort(telling.begin(), telling.end(), [&](uint32_t a, uint32_t b) { return top(a) > top(b); });
        const size_t live = space.diagram->reachable({&space.legal, 1}).size();
        constexpr size_t small_part = 16;  // rules that never need a walk over what other rules leave
        std::vector<uint32_t> order;
        std::vector<bool> implied;
        bool looked = !scratch.exhausted();
        for (const std::vector<uint32_t>& part : connected(space, telling)) {
            if (!looked || (part.size() > small_part && part.size() * live > most_work)) {
                looked = false;
                break;
            }
            std::vector<Set> sets;
            for (const uint32_t r : part) sets.push_back(allowed[r]);
            const std::vector<bool> answers = implied_by_others(scratch, sets);
            looked = !scratch.exhausted();
            order.insert(order.end(), part.begin(), part.end());
            implied.insert(implied.end(), answers.begin(), answers.end());
        }
        if (!looked) {
            unlooked(space);
            return;
        }
        std::map<Set, uint32_t> first;  // rules that say the same
        for (size_t i = 0; i < order.size(); ++i) {
            if (!implied[i]) continue;
            RuleFacts& facts = facts_of(space.rules[order[i]]);
            ++facts.implied;
            const auto [it, fresh] = first.try_emplace(allowed[order[i]], order[i]);
            if (fresh) continue;
            facts.twin = &space.rules[it->second];
            facts_of(space.rules[it->second]).twin = &space.rules[order[i]];
        }
    }

    void unlooked(const Space& space) {
        diags_.add(Severity::note, space.rules[0].place,
                   "the rules of shader '" + space.shader + "' are too many or too large to look for implied ones");
    }

    void note_values(const Space& space, Diagram& scratch, const std::vector<Set>& allowed) {
        const std::vector<std::vector<bool>> possible = space.diagram->digits_used(space.legal);
        for (uint32_t a = 0; a < space.axes.size(); ++a) {
            AxisFacts& facts = axes_[space.axes[a].name];
            const size_t values = space.axes[a].values.size();
            facts.possible.resize(values, false);
            facts.excluded_by.resize(values, nullptr);
            for (uint32_t d = 0; d < values; ++d) {
                if (possible[a][d]) facts.possible[d] = true;
                if (possible[a][d] || scratch.exhausted()) continue;
                if (++value_searches_ > 10'000) continue;
                const Set value = scratch.where(a, d);
                if (scratch.exhausted()) continue;  // then it is no set of these values
                for (size_t r = 0; r < allowed.size() && facts.excluded_by[d] == nullptr; ++r)
                    if (scratch.disjoint(value, allowed[r])) facts.excluded_by[d] = &space.rules[r];
            }
        }
    }

    void note_clash(const Space& space, Diagram& scratch, const std::vector<Set>& allowed) {
        Clash clash;
        if (!scratch.exhausted())
            for (const uint32_t r : smallest_clash(scratch, allowed)) clash.rules.push_back(&space.rules[r]);
        if (clash.rules.empty() || scratch.exhausted()) {
            clash.rules.clear();
            for (const Rule& rule : space.rules) clash.rules.push_back(&rule);
        }
        for (Clash& known : clashes_) {
            const auto same = [](const Rule* a, const Rule* b) { return key_of(*a) == key_of(*b); };
            if (!std::equal(known.rules.begin(), known.rules.end(), clash.rules.begin(), clash.rules.end(), same)) continue;
            known.shaders.push_back(space.shader);
            return;
        }
        clash.shaders.push_back(space.shader);
        clashes_.push_back(std::move(clash));
    }

    void report_rule(const RuleFacts& facts) {
        const Rule& rule = *facts.rule;
        if (facts.copies == 0) return;
        if (facts.empty == facts.copies) {
            diags_.warning(rule.place,
                           rule.forbid ? "this rule excludes nothing: its expression is never true"
                                       : "this rule excludes nothing: its expression is always true",
                           rule.source_line);
        } else if (facts.implied + facts.empty == facts.copies) {
            Diag& d = diags_.warning(rule.place, "this rule is implied by all the others", rule.source_line);
            if (facts.twin != nullptr) d.notes.push_back("it says the same as " + rule_line(*facts.twin));
        }
    }

    void report_values(const Axis& axis, const AxisFacts& facts) {
        constexpr size_t most_named = 20;  // an axis
        size_t named = 0, more = 0;
        for (size_t d = 0; d < facts.possible.size(); ++d) {
            if (facts.possible[d]) continue;
            if (named++ >= most_named) {
                ++more;
                continue;
            }
            Diag& diag =
                diags_.warning(axis.place, "value '" + axis.values[d].name + "' of axis '" + axis.name + "' can never occur");
            if (facts.excluded_by[d] != nullptr) diag.notes.push_back("excluded by " + rule_line(*facts.excluded_by[d]));
        }
        if (more != 0)
            diags_.warning(axis.place, Count(more).grouped() + " further values of axis '" + axis.name + "' can never occur");
    }

    void report_clash(const Clash& clash) {
        std::string shaders = "shader '" + clash.shaders[0] + "'";
        for (size_t i = 1; i < clash.shaders.size(); ++i) shaders += ", '" + clash.shaders[i] + "'";
        const Rule& first = *clash.rules[0];
        if (clash.rules.size() == 1) {
            diags_.error(first.place, "this rule alone leaves no variant of " + shaders, first.source_line);
            return;
        }
        Diag& d = diags_.error(first.place,
                               "these " + std::to_string(clash.rules.size()) + " rules together leave no variant of " + shaders,
                               first.source_line);
        constexpr size_t most_named = 20;
        for (size_t i = 0; i < clash.rules.size() && i < most_named; ++i) d.notes.push_back(rule_line(*clash.rules[i]));
        if (clash.rules.size() > most_named)
            d.notes.push_back("and " + std::to_string(clash.rules.size() - most_named) + " more");
    }

    const Manifest& manifest_;
    Diags& diags_;
    std::map<RuleKey, RuleFacts> rules_;
    std::vector<RuleKey> rule_order_;
    std::map<std::string, AxisFacts> axes_;
    std::vector<Clash> clashes_;
    size_t value_searches_ = 0;
};

}  // namespace

void lint(const Manifest& manifest, std::vector<std::unique_ptr<Space>>& spaces, Diags& diags) {
    Linter linter(manifest, diags);
    for (const auto& space : spaces)
        if (space) linter.look_at(*space);
    linter.report();
}

}  // namespace kiln
