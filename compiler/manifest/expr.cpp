// Parsed by operator precedence over two explicit stacks, so that no input can exhaust the call stack. A comparison decides
// what a bare name beside it means, hence an operand may stay a name without a node until the operator around it is known.
#include "compiler/manifest/expr.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <unordered_map>

#include "compiler/manifest/expr_token.h"

namespace kiln {

namespace {

// A word of the text for a message, cut when very long.
std::string shown(std::string_view word) {
    size_t size = std::min<size_t>(word.size(), 64);
    while (size > 0 && size < word.size() && (static_cast<unsigned char>(word[size]) & 0xC0) == 0x80) --size;
    return "'" + std::string(word.substr(0, size)) + (size < word.size() ? "...'" : "'");
}

// Finds things by name. Looks through short lists, and through any for the first few questions, since most expressions ask few.
class NameIndex {
public:
    template <class Named>
    std::optional<uint32_t> find(const std::vector<Named>& list, std::string_view name) {
        if (list.size() <= 16 || ++asked_ <= 64) {
            for (uint32_t i = 0; i < list.size(); ++i)
                if (list[i].name == name) return i;
            return std::nullopt;
        }
        if (index_.empty())
            for (uint32_t i = 0; i < list.size(); ++i) index_.emplace(list[i].name, i);
        const auto found = index_.find(name);
        return found == index_.end() ? std::nullopt : std::optional(found->second);
    }

private:
    std::unordered_map<std::string_view, uint32_t> index_;
    unsigned asked_ = 0;
};

// What stands on the operand stack: a node, or a name that no operator has claimed yet.
struct Operand {
    std::optional<uint32_t> node;
    std::string_view name;
    uint32_t offset = 0;
    bool compared = false;  // the result of a comparison without parentheses around it
};

struct Pending {
    enum class What : uint8_t { open, negate, binary } what = What::open;
    Op op = Op::literal;
    uint32_t offset = 0;
};

int strength(const Pending& p) {
    if (p.what == Pending::What::open) return 0;
    if (p.what == Pending::What::negate) return 4;
    switch (p.op) {
        case Op::implies:
            return 1;
        case Op::disjunction:
            return 2;
        case Op::conjunction:
            return 3;
        default:
            return 5;
    }
}

class Parser {
public:
    // Blanks behind the text are not part of it, so that what is missing at its end is pointed at right behind the last word.
    Parser(std::string_view text, const std::vector<Axis>& axes)
        : text_(text.substr(0, text.find_last_not_of(" \t\r\n") + 1)), axes_(axes), lexer_(text_) {}

    std::variant<Expr, ExprError> run() {
        if (text_.size() > expr_size_limit)
            return ExprError{0, "an expression may have at most " + std::to_string(expr_size_limit) + " bytes", std::nullopt};
        token_ = lexer_.next();
        bool want_operand = true;
        for (;;) {
            if (token_.kind == TokenKind::bad) {
                fail(token_.offset, shown(token_.text) + ": " + token_.problem);
            } else if (want_operand) {
                want_operand = !operand();
            } else if (token_.kind == TokenKind::end) {
                break;
            } else {
                want_operand = after_operand();
            }
            if (error_) return *error_;
        }
        while (!pending_.empty() && !error_) {
            if (pending_.back().what == Pending::What::open)
                fail(pending_.back().offset, "this '(' is not closed");
            else
                reduce();
        }
        if (!error_) resolve_axis(operands_.back());
        if (error_) return *error_;
        std::sort(expr_.axes.begin(), expr_.axes.end());
        expr_.axes.erase(std::unique(expr_.axes.begin(), expr_.axes.end()), expr_.axes.end());
        return std::move(expr_);
    }

private:
    void fail(uint32_t offset, std::string message) {
        if (!error_) error_ = ExprError{offset, std::move(message), std::nullopt};
    }
    void advance() { token_ = lexer_.next(); }
    bool after_comparison() const { return !pending_.empty() && strength(pending_.back()) == 5; }

    // Takes what may stand where an operand is expected. True when an operand was completed.
    bool operand() {
        const ExprToken t = token_;
        const bool word_not = t.kind == TokenKind::name && t.text == "not" && !after_comparison();
        if (t.kind == TokenKind::bang || word_not || t.kind == TokenKind::open) {
            if (after_comparison() && t.kind == TokenKind::bang) {
                fail(t.offset, "'!' binds looser than a comparison: put parentheses around what it negates");
                return false;
            }
            if (++level_ > expr_level_limit) {
                fail(t.offset, "nested deeper than " + std::to_string(expr_level_limit) + " levels");
                return false;
            }
            const auto what = t.kind == TokenKind::open ? Pending::What::open : Pending::What::negate;
            pending_.push_back({what, Op::negate, t.offset});
            advance();
            return false;
        }
        if (t.kind == TokenKind::name) {
            operands_.push_back({std::nullopt, t.text, t.offset, false});
            advance();
            return true;
        }
        if (t.kind == TokenKind::integer) {
            operands_.push_back({literal(t.number, t.offset), {}, t.offset, false});
            advance();
            return true;
        }
        if (t.kind == TokenKind::end)
            fail(t.offset, text_.empty() ? "the expression is empty"
                                         : "the expression ends where an axis, a value or an integer is expected");
        else
            fail(t.offset, "expected an axis, a value, an integer or '(' before " + shown(t.text));
        return false;
    }

    // Takes what may stand after an operand. True when an operand is expected next.
    bool after_operand() {
        const ExprToken t = token_;
        if (t.kind == TokenKind::op) {
            binary(t);
            advance();
            return true;
        }
        if (t.kind == TokenKind::name && t.text == "in") {
            member(t);
            return false;
        }
        if (t.kind == TokenKind::close) {
            close(t);
            return false;
        }
        std::string hint;
        if (t.kind == TokenKind::name && t.text == "and") hint = " (write '&&')";
        if (t.kind == TokenKind::name && t.text == "or") hint = " (write '||')";
        if (t.kind == TokenKind::name && t.text == "not") hint = " (write !(axis in {...}) for 'not in')";
        if (t.kind == TokenKind::bang) hint = " (write '!=' to compare)";
        fail(t.offset, "expected an operator before " + shown(t.text) + hint);
        return false;
    }

    void binary(const ExprToken& t) {
        const Pending next{Pending::What::binary, t.op, t.offset};
        const int power = strength(next);
        while (!pending_.empty() && !error_) {
            const int top = strength(pending_.back());
            if (power == 5 && top == 5) return chained(t);
            if (top < power || (top == power && t.op == Op::implies)) break;
            reduce();
        }
        if (power == 5 && operands_.back().compared) return chained(t);
        pending_.push_back(next);
    }

    void chained(const ExprToken& t) { fail(t.offset, "comparisons do not chain: join two of them with '&&'"); }

    void member(const ExprToken& in) {
        if (after_comparison() || operands_.back().compared) return chained(in);
        advance();
        if (token_.kind != TokenKind::open_brace) return fail(token_.offset, "expected '{' after 'in'");
        const uint32_t brace = token_.offset;
        Operand& left = operands_.back();
        resolve_axis(left);
        if (error_) return;
        std::vector<uint32_t> args{*left.node};
        advance();
        for (;;) {
            if (token_.kind == TokenKind::integer) {
                args.push_back(literal(token_.number, token_.offset));
            } else if (token_.kind == TokenKind::name) {
                if (expr_.nodes[*left.node].op != Op::axis)
                    return fail(token_.offset, shown(token_.text) + ": only an axis has named values");
                const uint32_t axis = expr_.nodes[*left.node].axis;
                const std::optional<int32_t> number = value_of(axis, token_.text);
                if (!number) return no_value(token_.offset, axis, token_.text);
                args.push_back(literal(*number, token_.offset));
            } else if (token_.kind == TokenKind::close_brace) {
                return fail(token_.offset,
                            args.size() == 1 ? "'in {}' holds never: name at least one value" : "expected a value after ','");
            } else {
                return fail(token_.kind == TokenKind::end ? brace : token_.offset,
                            token_.kind == TokenKind::end ? "this '{' is not closed" : "expected a value or an integer");
            }
            advance();
            if (token_.kind == TokenKind::close_brace) break;
            if (token_.kind == TokenKind::end) return fail(brace, "this '{' is not closed");
            if (token_.kind != TokenKind::comma) return fail(token_.offset, "expected ',' or '}'");
            advance();
        }
        advance();
        left.node = node({Op::in, 0, 0, std::move(args), in.offset});
        left.compared = true;
    }

    void close(const ExprToken& t) {
        while (!pending_.empty() && pending_.back().what != Pending::What::open && !error_) reduce();
        if (error_) return;
        if (pending_.empty()) return fail(t.offset, "this ')' was never opened");
        pending_.pop_back();
        --level_;
        resolve_axis(operands_.back());
        operands_.back().compared = false;
        advance();
    }

    void reduce() {
        const Pending p = pending_.back();
        pending_.pop_back();
        Operand right = operands_.back();
        if (p.what == Pending::What::negate) {
            --level_;
            resolve_axis(right);
            if (error_) return;
            operands_.back() = {node({Op::negate, 0, 0, {*right.node}, p.offset}), {}, p.offset, false};
            return;
        }
        operands_.pop_back();
        Operand left = operands_.back();
        const bool comparison = strength(p) == 5;
        if (comparison) resolve_pair(left, right);
        resolve_axis(left);
        resolve_axis(right);
        if (error_) return;
        operands_.back() = {node({p.op, 0, 0, {*left.node, *right.node}, p.offset}), {}, left.offset, comparison};
    }

    uint32_t node(ExprNode n) {
        expr_.nodes.push_back(std::move(n));
        return static_cast<uint32_t>(expr_.nodes.size() - 1);
    }
    uint32_t literal(int32_t number, uint32_t offset) { return node({Op::literal, number, 0, {}, offset}); }

    std::optional<uint32_t> axis_named(std::string_view name) { return axis_names_.find(axes_, name); }
    std::optional<uint32_t> axis_of(const Operand& o) {
        if (!o.node) return axis_named(o.name);
        const ExprNode& n = expr_.nodes[*o.node];
        return n.op == Op::axis ? std::optional(n.axis) : std::nullopt;
    }
    std::optional<int32_t> value_of(uint32_t axis, std::string_view name) {
        const std::vector<AxisValue>& values = axes_[axis].values;
        const std::optional<uint32_t> digit = value_names_[axis].find(values, name);
        return digit ? std::optional(values[*digit].number) : std::nullopt;
    }

    void no_value(uint32_t offset, uint32_t axis, std::string_view name) {
        std::vector<std::string> names;
        for (const AxisValue& v : axes_[axis].values) names.push_back(v.name);
        fail(offset, shown(name) + " is not a value of axis '" + axes_[axis].name + "'" + did_you_mean(name, names));
        error_->axis = axis;
    }

    // Settles the names beside a comparison: first as a value of the other side's axis, then as an axis.
    void resolve_pair(Operand& left, Operand& right) {
        const std::optional<uint32_t> left_axis = axis_of(left), right_axis = axis_of(right);
        if (!right.node && left_axis) {
            if (const auto number = value_of(*left_axis, right.name)) right.node = literal(*number, right.offset);
        }
        if (!right.node && !right_axis && left_axis) return no_value(right.offset, *left_axis, right.name);
        if (!left.node && right_axis && !is_literal(right)) {
            if (const auto number = value_of(*right_axis, left.name)) left.node = literal(*number, left.offset);
            if (!left.node && !left_axis) return no_value(left.offset, *right_axis, left.name);
        }
    }
    bool is_literal(const Operand& o) const { return o.node && expr_.nodes[*o.node].op == Op::literal; }

    void resolve_axis(Operand& o) {
        if (o.node || error_) return;
        const std::optional<uint32_t> axis = axis_named(o.name);
        if (!axis) {
            std::vector<std::string> names;
            for (const Axis& a : axes_) names.push_back(a.name);
            return fail(o.offset, "unknown axis " + shown(o.name) + did_you_mean(o.name, names));
        }
        o.node = node({Op::axis, 0, *axis, {}, o.offset});
        expr_.axes.push_back(*axis);
    }

    std::string_view text_;
    const std::vector<Axis>& axes_;
    ExprLexer lexer_;
    ExprToken token_;
    Expr expr_;
    std::vector<Operand> operands_;
    std::vector<Pending> pending_;
    unsigned level_ = 0;
    std::optional<ExprError> error_;
    NameIndex axis_names_;
    std::unordered_map<uint32_t, NameIndex> value_names_;
};

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string best = word.size() < 2 ? std::string() : nearest(word, candidates);
    if (!best.empty()) return " (did you mean '" + best + "'?)";
    if (candidates.empty() || candidates.size() > 8) return {};
    std::string all;
    for (const std::string& candidate : candidates) all += (all.empty() ? "" : ", ") + candidate;
    return all.size() > 200 ? std::string() : " (known: " + all + ")";
}

std::variant<Expr, ExprError> parse_expr(std::string_view text, const std::vector<Axis>& axes) {
    return Parser(text, axes).run();
}

bool evaluate(const Expr& expr, const std::vector<int32_t>& numbers) {
    assert(!expr.nodes.empty());
    std::vector<int32_t> result(expr.nodes.size());
    for (size_t i = 0; i < expr.nodes.size(); ++i) {
        const ExprNode& n = expr.nodes[i];
        const auto arg = [&](size_t k) { return result[n.args[k]]; };
        switch (n.op) {
            case Op::literal:
                result[i] = n.number;
                break;
            case Op::axis:
                result[i] = numbers[n.axis];
                break;
            case Op::negate:
                result[i] = arg(0) == 0;
                break;
            case Op::conjunction:
                result[i] = arg(0) != 0 && arg(1) != 0;
                break;
            case Op::disjunction:
                result[i] = arg(0) != 0 || arg(1) != 0;
                break;
            case Op::implies:
                result[i] = arg(0) == 0 || arg(1) != 0;
                break;
            case Op::equal:
                result[i] = arg(0) == arg(1);
                break;
            case Op::unequal:
                result[i] = arg(0) != arg(1);
                break;
            case Op::less:
                result[i] = arg(0) < arg(1);
                break;
            case Op::less_equal:
                result[i] = arg(0) <= arg(1);
                break;
            case Op::greater:
                result[i] = arg(0) > arg(1);
                break;
            case Op::greater_equal:
                result[i] = arg(0) >= arg(1);
                break;
            case Op::in:
                result[i] = std::any_of(n.args.begin() + 1, n.args.end(), [&](uint32_t a) { return result[a] == arg(0); });
                break;
        }
    }
    return result.back() != 0;
}

}  // namespace kiln
