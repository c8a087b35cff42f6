// A short condition is looked for in three steps. First the axes: starting from few, each axis is dropped whose value the
// answer does not need (the projections of the set and of its complement within `care` stay apart). Then one conjunction:
// per axis the values that must be allowed and those that may be are known, and the shortest term between them is taken.
// Where that fails, a cover by up to four terms in several conjunctions is searched, growing a box around one member at a
// time; and last, a first term (a comparison of two axes, say) is split off that all members share. All of it happens in a
// scratch diagram of bounded size, and what is returned has been compared with the set.

#include "compiler/space/describe.h"

#include <algorithm>

#include "compiler/space/term.h"

namespace kiln {

namespace {

constexpr unsigned most_terms = 4;
constexpr size_t scratch_nodes = 2'000'000;
constexpr size_t most_axes_tried = 64;
constexpr unsigned most_boxes = 4'000, most_searches = 60;  // work for one description

struct Condition {
    std::string text;
    unsigned terms = 0;
    Set set;
    // Conjunctions joined by ||, each with the axes it names; ordered by these. One for a plain conjunction.
    std::vector<std::pair<std::vector<uint32_t>, std::string>> parts;
};

Condition joined(const Condition& a, const Condition& b) {
    Condition out;
    out.terms = a.terms + b.terms;
    out.parts = a.parts;
    out.parts.insert(out.parts.end(), b.parts.begin(), b.parts.end());
    std::sort(out.parts.begin(), out.parts.end());
    for (const auto& [axes, text] : out.parts) {
        const bool several = text.find(" && ") != std::string::npos;
        out.text += (out.text.empty() ? "" : " || ") + (several ? "(" + text + ")" : text);
    }
    return out;
}

bool shorter(const Condition& a, const Condition& b) {
    return a.terms != b.terms ? a.terms < b.terms : a.text.size() < b.text.size();
}

class Search {
public:
    Search(Diagram& diagram, const std::vector<Axis>& axes) : d_(diagram), axes_(axes) {}

    // With `compare` a conjunction may begin with comparisons of axes.
    std::optional<Condition> find(Set set, Set care, unsigned budget, bool compare = true) {
        if (++searches_ > most_searches) return std::nullopt;
        std::optional<Condition> best;
        const auto offer = [&](std::optional<Condition> found) {
            if (found && (!best || shorter(*found, *best))) best = std::move(found);
        };
        const Set off = d_.minus(care, set);
        const std::vector<std::vector<uint32_t>> supports = small_supports(set, off, care);
        for (const std::vector<uint32_t>& axes : supports)
            if (axes.size() <= budget) offer(cover(project(set, axes), project(off, axes), axes, budget));
        for (const std::vector<uint32_t>& axes : supports) {
            if (best && best->terms <= 2) break;
            if (compare && axes.size() <= 2 * budget) after_comparison(set, care, axes, budget, offer);
            if (axes.size() <= budget) after_term(set, care, axes, budget, offer);
        }
        if (d_.exhausted() || !best || d_.both(best->set, care) != set || d_.exhausted()) return std::nullopt;
        return best;
    }

private:
    using Flags = std::vector<bool>;
    // A product of value sets; axes that are not listed are free.
    struct Box {
        std::vector<uint32_t> axes;
        std::vector<Flags> digits;
    };

    Set project(Set s, const std::vector<uint32_t>& axes) {
        Flags keep(axes_.size(), false);
        for (const uint32_t axis : axes) keep[axis] = true;
        return d_.project(s, keep);
    }

    Flags digits_of(Set s, uint32_t axis) {
        const Set alone = project(s, {axis});
        Flags digits(axes_[axis].values.size(), alone == Diagram::all());
        if (alone.node <= 1) return digits;
        uint32_t digit = 0;
        for (const Diagram::Edge& e : d_.edges(alone))
            for (; digit <= e.last; ++digit) digits[digit] = e.child == Diagram::all();
        return digits;
    }

    Set set_of(const Box& box, size_t except = ~size_t{0}) {
        Set s = Diagram::all();
        for (size_t i = 0; i < box.axes.size(); ++i)
            if (i != except) s = d_.both(s, d_.where(box.axes[i], box.digits[i]));
        return s;
    }

    // Sets of axes that decide membership, none of which can be dropped; a few different ones.
    std::vector<std::vector<uint32_t>> small_supports(Set set, Set off, Set care) {
        std::vector<std::vector<uint32_t>> starts{d_.support(d_.simplify(set, care)), d_.support(set)};
        std::vector<uint32_t> wide = d_.support(care);
        wide.insert(wide.end(), starts[1].begin(), starts[1].end());
        std::sort(wide.begin(), wide.end());
        wide.erase(std::unique(wide.begin(), wide.end()), wide.end());
        starts.push_back(std::move(wide));
        std::vector<std::vector<uint32_t>> found;
        for (const std::vector<uint32_t>& start : starts) {
            if (start.size() > most_axes_tried) continue;
            for (const bool from_back : {true, false}) {
                std::vector<uint32_t> axes = start, candidates = start;
                if (from_back) std::reverse(candidates.begin(), candidates.end());
                for (const uint32_t axis : candidates) {
                    std::vector<uint32_t> fewer = axes;
                    fewer.erase(std::find(fewer.begin(), fewer.end(), axis));
                    if (d_.disjoint(project(set, fewer), off)) axes = std::move(fewer);
                    if (d_.exhausted()) return found;
                }
                if (std::find(found.begin(), found.end(), axes) == found.end()) found.push_back(std::move(axes));
            }
        }
        return found;
    }

    // The box in words, each axis in turn between what it must allow (to hold `covered`) and what it may (to miss `off`).
    std::optional<Condition> say(Box box, Set covered, Set off, unsigned budget) {
        Condition out;
        for (size_t i = 0; i < box.axes.size(); ++i) box.digits[i] = digits_of(covered, box.axes[i]);
        std::vector<std::pair<uint32_t, std::string>> texts;
        for (size_t i = 0; i < box.axes.size(); ++i) {
            Flags may = digits_of(d_.both(off, set_of(box, i)), box.axes[i]);
            may.flip();
            const Flags must = digits_of(covered, box.axes[i]);
            for (size_t v = 0; v < must.size(); ++v)
                if (must[v] && !may[v]) return std::nullopt;
            const auto term = shortest_term(axes_[box.axes[i]], must, may);
            if (!term || (out.terms += term->cost) > budget) return std::nullopt;
            box.digits[i] = term->digits;
            if (term->cost != 0) texts.push_back({box.axes[i], term->text});
        }
        std::sort(texts.begin(), texts.end());
        out.parts.resize(1);
        for (const auto& [axis, text] : texts) {
            out.text += (out.text.empty() ? "" : " && ") + text;
            out.parts[0].first.push_back(axis);
        }
        out.parts[0].second = out.text;
        out.set = set_of(box);
        return out;
    }

    std::optional<Condition> cover(Set on, Set off, const std::vector<uint32_t>& axes, unsigned budget) {
        // One conjunction over all members; which axis is widened first can matter.
        std::optional<Condition> best;
        std::vector<uint32_t> order = axes;
        do {
            Box box{order, std::vector<Flags>(order.size())};
            if (auto one = say(std::move(box), on, off, budget))
                if (!best || shorter(*one, *best)) best = std::move(one);
        } while (best && std::next_permutation(order.begin(), order.end()));
        if (best) return best;
        for (unsigned terms = 2; terms <= budget; ++terms) {
            if (auto found = alternatives(on, off, axes, terms)) return found;
        }
        return std::nullopt;
    }

    // Covers `on` with conjunctions of `budget` terms together.
    std::optional<Condition> alternatives(Set on, Set off, const std::vector<uint32_t>& axes, unsigned budget) {
        const auto member = d_.witness(on);
        if (!member || d_.exhausted()) return std::nullopt;
        for (unsigned size = 1; size <= budget; ++size) {
            for (unsigned chosen = 1; chosen < 1u << axes.size(); ++chosen) {
                if (static_cast<unsigned>(__builtin_popcount(chosen)) != size) continue;
                for (const bool backwards : {false, true}) {
                    if (backwards && size == 1) continue;
                    if (++boxes_ > most_boxes) return std::nullopt;
                    const Box box = grown(*member, chosen, axes, off, backwards);
                    if (box.axes.empty()) break;
                    const Set covered = d_.both(on, set_of(box));
                    auto head = say(box, covered, off, budget);
                    if (!head) continue;
                    const Set rest = d_.minus(on, head->set);
                    if (rest == Diagram::none()) return head;
                    if (head->terms >= budget) continue;
                    const auto tail = alternatives(rest, off, axes, budget - head->terms);
                    if (!tail) continue;
                    Condition both = joined(*head, *tail);
                    both.set = d_.either(head->set, tail->set);
                    return both;
                }
            }
        }
        return std::nullopt;
    }

    // The member's values on the chosen axes, each widened as far as `off` permits; no axes when even the values meet `off`.
    Box grown(const Digits& member, unsigned chosen, const std::vector<uint32_t>& axes, Set off, bool backwards) {
        Box box;
        for (size_t i = 0; i < axes.size(); ++i) {
            if ((chosen >> i & 1) == 0) continue;
            box.axes.push_back(axes[i]);
            box.digits.emplace_back(axes_[axes[i]].values.size(), false);
            box.digits.back()[member[axes[i]]] = true;
        }
        if (!d_.disjoint(set_of(box), off)) return {};
        for (size_t k = 0; k < box.axes.size(); ++k) {
            const size_t i = backwards ? box.axes.size() - 1 - k : k;
            Flags may = digits_of(d_.both(off, set_of(box, i)), box.axes[i]);
            may.flip();
            box.digits[i] = std::move(may);
        }
        return box;
    }

    // `first && ...`: a first condition that holds on all of the set, and what is left to say inside it.
    std::optional<Condition> after(Condition first, Set set, Set care, unsigned budget, bool compare) {
        const Set narrower = d_.both(care, first.set);
        if (narrower == care || first.terms > budget || d_.exhausted()) return std::nullopt;
        if (narrower == set) return first;
        const auto rest = find(set, narrower, budget - first.terms, compare);
        if (!rest) return std::nullopt;
        first.text += " && " + (rest->parts.size() > 1 ? "(" + rest->text + ")" : rest->text);
        first.terms += rest->terms;
        first.set = d_.both(first.set, rest->set);
        return first;
    }

    // `light != none && (...)`
    template <class Offer>
    void after_term(Set set, Set care, const std::vector<uint32_t>& axes, unsigned budget, const Offer& offer) {
        for (const uint32_t a : axes) {
            const Flags must = digits_of(set, a);
            if (const auto term = shortest_term(axes_[a], must, must); term && term->cost != 0)
                offer(after({term->text, term->cost, d_.where(a, term->digits), {}}, set, care, budget, false));
        }
    }

    // `first == second && ...`. What the values that each axis has alone imply is no comparison worth making.
    template <class Offer>
    void after_comparison(Set set, Set care, const std::vector<uint32_t>& axes, unsigned budget, const Offer& offer) {
        constexpr size_t most_values = 256;  // a comparison is built value by value
        for (const uint32_t a : axes) {
            for (const uint32_t b : axes) {
                const Axis &x = axes_[a], &y = axes_[b];
                const bool integers = x.kind == AxisKind::integer && y.kind == AxisKind::integer;
                const bool flags = is_flag(x) && is_flag(y);
                if (b <= a || !(integers || flags) || x.values.size() > most_values || y.values.size() > most_values) continue;
                const Set box = d_.both(d_.where(a, digits_of(set, a)), d_.where(b, digits_of(set, b)));
                for (const auto& [op, holds] : comparisons) {
                    if (flags && op != "==" && op != "!=") continue;
                    const Set both = compared(a, b, holds);
                    if (!d_.subset(set, both) || d_.subset(box, both)) continue;
                    offer(after({x.name + " " + op + " " + y.name, 1, both, {}}, set, care, budget, true));
                }
            }
        }
    }

    static bool is_flag(const Axis& axis) { return axis.kind == AxisKind::boolean || axis.kind == AxisKind::defined; }

    using Holds = bool (*)(int32_t, int32_t);
    static inline const std::pair<std::string, Holds> comparisons[] = {
        {"==", [](int32_t a, int32_t b) { return a == b; }}, {"!=", [](int32_t a, int32_t b) { return a != b; }},
        {"<", [](int32_t a, int32_t b) { return a < b; }},   {"<=", [](int32_t a, int32_t b) { return a <= b; }},
        {">", [](int32_t a, int32_t b) { return a > b; }},   {">=", [](int32_t a, int32_t b) { return a >= b; }},
    };

    Set compared(uint32_t a, uint32_t b, Holds holds) {
        const bool swapped = d_.level_of_axis(a) > d_.level_of_axis(b);
        const uint32_t upper = swapped ? b : a, lower = swapped ? a : b;
        std::vector<Diagram::Edge> runs;
        for (uint32_t d = 0; d < axes_[upper].values.size(); ++d) {
            Flags flags;
            const int32_t x = axes_[upper].values[d].number;
            for (const AxisValue& y : axes_[lower].values) flags.push_back(swapped ? holds(y.number, x) : holds(x, y.number));
            runs.push_back({d, d_.where(lower, flags)});
        }
        return d_.branch(upper, runs);
    }

    Diagram& d_;
    const std::vector<Axis>& axes_;
    unsigned boxes_ = 0, searches_ = 0;
};

}  // namespace

std::string describe_set(Space& space, Set set, Set care) {
    if (set == Diagram::none()) return "never";
    if (set == care) return "always";
    Diagram scratch(space.diagram->radices(), space.diagram->order(), scratch_nodes);
    const Set on = scratch.import(*space.diagram, set), all = scratch.import(*space.diagram, care);
    if (scratch.exhausted()) return "";
    const auto found = Search(scratch, space.axes).find(on, all, most_terms);
    return found ? found->text : "";
}

std::string describe_condition(Space& space, Set set, Set care, bool at_least) {
    set = space.diagram->both(set, care);
    std::string text = at_least ? "in at least " : "in ";
    text += space.diagram->count(set).grouped() + " of " + space.diagram->count(care).grouped() + " variants of " + space.shader;
    if (set == Diagram::none()) return text;
    if (set == care) return text + ": always";
    const std::string condition = describe_set(space, set, care);
    if (!condition.empty()) return text + (at_least ? ": whenever " : ": exactly when ") + condition;
    return text + ": for example " + space.describe_variant(*space.diagram->witness(set));
}

}  // namespace kiln
