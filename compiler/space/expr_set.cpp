// Expressions become sets bottom-up, without recursion. An operand of a comparison is a literal, an axis or a truth value
// (0 or 1); a comparison of two axes is built directly as one node per distinct question, so that two axes of 4,096 values
// cost some thousand nodes and not a product.

#include "compiler/space/expr_set.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <optional>
#include <unordered_map>

namespace kiln {

namespace {

// Nodes at and below `root`, children before parents, each once.
std::vector<uint32_t> below(const Expr& expr, uint32_t root) {
    std::vector<uint32_t> found{root};
    std::vector<uint32_t> open{root};
    while (!open.empty()) {
        const uint32_t n = open.back();
        open.pop_back();
        for (const uint32_t arg : expr.nodes[n].args) {
            found.push_back(arg);
            open.push_back(arg);
        }
    }
    std::sort(found.begin(), found.end());  // children have smaller indices
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

bool compare(Op op, int32_t a, int32_t b) {
    switch (op) {
        case Op::equal:
            return a == b;
        case Op::unequal:
            return a != b;
        case Op::less:
            return a < b;
        case Op::less_equal:
            return a <= b;
        case Op::greater:
            return a > b;
        case Op::greater_equal:
            return a >= b;
        default:
            assert(false);
            return false;
    }
}

Op mirrored(Op op) {
    switch (op) {
        case Op::less:
            return Op::greater;
        case Op::less_equal:
            return Op::greater_equal;
        case Op::greater:
            return Op::less;
        case Op::greater_equal:
            return Op::less_equal;
        default:
            return op;
    }
}

class Builder {
public:
    Builder(Diagram& diagram, const std::vector<Axis>& axes, const Expr& expr) : diagram_(diagram), axes_(axes), expr_(expr) {}

    Set build(uint32_t root) {
        for (const uint32_t n : below(expr_, root)) {
            const ExprNode& node = expr_.nodes[n];
            switch (node.op) {
                case Op::literal:
                case Op::axis:
                    break;  // what they mean depends on who asks
                case Op::negate:
                    known_[n] = diagram_.complement(truth(node.args[0]));
                    break;
                case Op::conjunction:
                    known_[n] = fold(node, true);
                    break;
                case Op::disjunction:
                    known_[n] = fold(node, false);
                    break;
                case Op::implies:
                    known_[n] = diagram_.either(diagram_.complement(truth(node.args[0])), truth(node.args[1]));
                    break;
                case Op::in:
                    known_[n] = member(node);
                    break;
                default:
                    known_[n] = comparison(node.op, node.args[0], node.args[1]);
                    break;
            }
        }
        return truth(root);
    }

private:
    static Set constant(bool holds) { return holds ? Diagram::all() : Diagram::none(); }

    template <class Predicate>
    Set digits_where(uint32_t axis, const Predicate& holds) {
        std::vector<bool> digits;
        for (const AxisValue& v : axes_[axis].values) digits.push_back(holds(v.number));
        return diagram_.where(axis, digits);
    }

    Set truth(uint32_t n) {
        const ExprNode& node = expr_.nodes[n];
        if (node.op == Op::literal) return constant(node.number != 0);
        if (node.op == Op::axis) return digits_where(node.axis, [](int32_t v) { return v != 0; });
        return known_.at(n);
    }

    Set fold(const ExprNode& node, bool all) {
        Set result = constant(all);
        for (const uint32_t arg : node.args)
            result = all ? diagram_.both(result, truth(arg)) : diagram_.either(result, truth(arg));
        return result;
    }

    Set member(const ExprNode& node) {
        std::vector<int32_t> wanted;
        for (size_t i = 1; i < node.args.size(); ++i) wanted.push_back(expr_.nodes[node.args[i]].number);
        std::sort(wanted.begin(), wanted.end());
        const auto has = [&](int32_t v) { return std::binary_search(wanted.begin(), wanted.end(), v); };
        const ExprNode& operand = expr_.nodes[node.args[0]];
        if (operand.op == Op::literal) return constant(has(operand.number));
        if (operand.op == Op::axis) return digits_where(operand.axis, has);
        return diagram_.choose(truth(node.args[0]), constant(has(1)), constant(has(0)));
    }

    // `number op n`
    Set against(int32_t number, Op op, uint32_t n) {
        const ExprNode& node = expr_.nodes[n];
        if (node.op == Op::literal) return constant(compare(op, number, node.number));
        if (node.op == Op::axis) return digits_where(node.axis, [&](int32_t v) { return compare(op, number, v); });
        return diagram_.choose(truth(n), constant(compare(op, number, 1)), constant(compare(op, number, 0)));
    }

    Set comparison(Op op, uint32_t a, uint32_t b) {
        const ExprNode& left = expr_.nodes[a];
        const ExprNode& right = expr_.nodes[b];
        if (left.op == Op::literal) return against(left.number, op, b);
        if (right.op == Op::literal) return against(right.number, mirrored(op), a);
        if (left.op == Op::axis && right.op == Op::axis) return axes_compared(op, left.axis, right.axis);
        if (left.op == Op::axis) return diagram_.choose(truth(b), against(1, mirrored(op), a), against(0, mirrored(op), a));
        return diagram_.choose(truth(a), against(1, op, b), against(0, op, b));
    }

    Set axes_compared(Op op, uint32_t a, uint32_t b) {
        if (a == b) return constant(compare(op, 0, 0));
        if (diagram_.level_of_axis(a) > diagram_.level_of_axis(b)) {
            std::swap(a, b);
            op = mirrored(op);
        }
        // b's digits by number; what holds for a number of a is then a stretch of this list (or all but one).
        std::vector<std::pair<int32_t, uint32_t>> sorted;
        for (uint32_t d = 0; d < axes_[b].values.size(); ++d) sorted.push_back({axes_[b].values[d].number, d});
        std::sort(sorted.begin(), sorted.end());
        bool ascending = true;
        for (uint32_t d = 0; d < sorted.size(); ++d) ascending = ascending && sorted[d].second == d;
        std::map<std::pair<size_t, size_t>, Set> stretches;
        const auto stretch = [&](size_t from, size_t to) {
            const auto [it, fresh] = stretches.try_emplace({from, to});
            if (fresh) it->second = ascending ? ascending_stretch(b, from, to) : listed_stretch(b, sorted, from, to);
            return it->second;
        };
        std::vector<Diagram::Edge> runs;
        for (uint32_t d = 0; d < axes_[a].values.size(); ++d) {
            const int32_t number = axes_[a].values[d].number;
            const auto equal = std::equal_range(sorted.begin(), sorted.end(), std::pair{number, 0u},
                                                [](const auto& x, const auto& y) { return x.first < y.first; });
            const size_t low = static_cast<size_t>(equal.first - sorted.begin());
            const size_t high = static_cast<size_t>(equal.second - sorted.begin());
            Set holds;
            switch (op) {
                case Op::equal:
                    holds = stretch(low, high);
                    break;
                case Op::unequal:
                    holds = diagram_.complement(stretch(low, high));
                    break;
                case Op::less:
                    holds = stretch(high, sorted.size());
                    break;
                case Op::less_equal:
                    holds = stretch(low, sorted.size());
                    break;
                case Op::greater:
                    holds = stretch(0, low);
                    break;
                default:
                    holds = stretch(0, high);
                    break;
            }
            runs.push_back({d, holds});
        }
        return diagram_.branch(a, runs);
    }

    Set ascending_stretch(uint32_t axis, size_t from, size_t to) {
        const uint32_t radix = static_cast<uint32_t>(axes_[axis].values.size());
        if (from == to) return Diagram::none();
        std::vector<Diagram::Edge> runs;
        if (from > 0) runs.push_back({static_cast<uint32_t>(from) - 1, Diagram::none()});
        runs.push_back({static_cast<uint32_t>(to) - 1, Diagram::all()});
        if (to < radix) runs.push_back({radix - 1, Diagram::none()});
        return diagram_.branch(axis, runs);
    }

    Set listed_stretch(uint32_t axis, const std::vector<std::pair<int32_t, uint32_t>>& sorted, size_t from, size_t to) {
        std::vector<bool> digits(sorted.size());
        for (size_t i = from; i < to; ++i) digits[sorted[i].second] = true;
        return diagram_.where(axis, digits);
    }

    Diagram& diagram_;
    const std::vector<Axis>& axes_;
    const Expr& expr_;
    std::unordered_map<uint32_t, Set> known_;
};

}  // namespace

std::vector<Conjunct> conjuncts(const Expr& expr, bool holds) {
    std::vector<Conjunct> parts;
    std::vector<Conjunct> open{{static_cast<uint32_t>(expr.nodes.size() - 1), holds}};
    while (!open.empty()) {
        const Conjunct c = open.back();
        open.pop_back();
        const ExprNode& node = expr.nodes[c.node];
        const bool splits = node.op == Op::negate || (node.op == Op::conjunction && c.holds) ||
                            ((node.op == Op::disjunction || node.op == Op::implies) && !c.holds);
        if (!splits) {
            parts.push_back(c);
            continue;
        }
        for (size_t i = node.args.size(); i-- > 0;) {
            const bool flips = node.op == Op::negate || (node.op == Op::implies && i == 0);
            open.push_back({node.args[i], flips ? !c.holds : c.holds});
        }
    }
    return parts;
}

std::vector<uint32_t> axes_below(const Expr& expr, uint32_t node) {
    std::vector<uint32_t> axes;
    for (const uint32_t n : below(expr, node))
        if (expr.nodes[n].op == Op::axis) axes.push_back(expr.nodes[n].axis);
    std::sort(axes.begin(), axes.end());
    axes.erase(std::unique(axes.begin(), axes.end()), axes.end());
    return axes;
}

void collect_gates(const Expr& expr, uint32_t node, size_t axes, std::vector<Gate>& gates) {
    const std::vector<uint32_t> order = below(expr, node);
    std::unordered_map<uint32_t, Op> above;  // the operator that reads a node
    for (const uint32_t n : order)
        for (const uint32_t arg : expr.nodes[n].args) above[arg] = expr.nodes[n].op;
    std::unordered_map<uint32_t, std::vector<uint32_t>> wires;  // what a node hands up: one vertex, or a chain's inputs
    for (const uint32_t n : order) {
        const ExprNode& here = expr.nodes[n];
        std::vector<uint32_t>& out = wires[n];
        if (here.op == Op::axis) out.push_back(here.axis);
        const size_t operands = here.op == Op::in ? 1 : here.args.size();
        bool all_axes = operands == 2;
        for (size_t i = 0; i < operands; ++i) {
            std::vector<uint32_t>& in = wires[here.args[i]];
            all_axes = all_axes && expr.nodes[here.args[i]].op == Op::axis;
            if (out.empty())
                out.swap(in);
            else
                out.insert(out.end(), in.begin(), in.end());
        }
        const bool chains = here.op == Op::conjunction || here.op == Op::disjunction;
        const auto reader = above.find(n);
        if (chains && reader != above.end() && reader->second == here.op) continue;
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        if (out.size() < 2) continue;
        const bool compares = all_axes && !chains && here.op != Op::implies;
        gates.push_back({out, compares});
        out.assign(1, static_cast<uint32_t>(axes + gates.size() - 1));
    }
}

Set set_of(Diagram& diagram, const std::vector<Axis>& axes, const Expr& expr, uint32_t node) {
    return Builder(diagram, axes, expr).build(node);
}

Set set_of(Diagram& diagram, const std::vector<Axis>& axes, const Expr& expr, Conjunct part) {
    const Set s = set_of(diagram, axes, expr, part.node);
    return part.holds ? s : diagram.complement(s);
}

}  // namespace kiln
