// Parsed by operator precedence over two explicit stacks, so that no input can exhaust the call stack. A comparison decides
// what a bare name beside it means, hence an operand may stay a name without a node until the operator around it is known.
#include "compiler/expr.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <optional>
#include <unordered_map>

namespace kiln {

namespace {

enum class Kind : uint8_t { end, name, integer, open, close, open_brace, close_brace, comma, op, bang, bad };

struct Token {
    Kind kind = Kind::end;
    Op op = Op::literal;  // of Kind::op
    std::string_view text;
    uint32_t offset = 0;
    int32_t number = 0;
    const char* problem = nullptr;  // of Kind::bad
};

bool name_start(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

class Lexer {
public:
    explicit Lexer(std::string_view text) : text_(text) {}

    Token next() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) ++at_;
        Token token;
        token.offset = static_cast<uint32_t>(at_);
        if (at_ == text_.size()) return token;
        const char c = text_[at_];
        if (name_start(c)) {
            token.kind = Kind::name;
            return take(token, name_length());
        }
        if (digit(c) || (c == '-' && at_ + 1 < text_.size() && digit(text_[at_ + 1]))) return integer(token);
        static constexpr struct {
            const char* text;
            Kind kind;
            Op op;
            const char* problem;
        } table[] = {
            {"->", Kind::op, Op::implies, nullptr},
            {"||", Kind::op, Op::disjunction, nullptr},
            {"&&", Kind::op, Op::conjunction, nullptr},
            {"==", Kind::op, Op::equal, nullptr},
            {"!=", Kind::op, Op::unequal, nullptr},
            {"<=", Kind::op, Op::less_equal, nullptr},
            {">=", Kind::op, Op::greater_equal, nullptr},
            {"=>", Kind::bad, Op::literal, "write '->' for implication or '>=' for a comparison"},
            {"=<", Kind::bad, Op::literal, "write '<='"},
            {"<>", Kind::bad, Op::literal, "write '!='"},
            {"<", Kind::op, Op::less, nullptr},
            {">", Kind::op, Op::greater, nullptr},
            {"!", Kind::bang, Op::negate, nullptr},
            {"(", Kind::open, Op::literal, nullptr},
            {")", Kind::close, Op::literal, nullptr},
            {"{", Kind::open_brace, Op::literal, nullptr},
            {"}", Kind::close_brace, Op::literal, nullptr},
            {",", Kind::comma, Op::literal, nullptr},
            {"=", Kind::bad, Op::literal, "write '==' to compare"},
            {"&", Kind::bad, Op::literal, "write '&&'"},
            {"|", Kind::bad, Op::literal, "write '||'"},
        };
        for (const auto& row : table) {
            const std::string_view spelling = row.text;
            if (text_.substr(at_, spelling.size()) != spelling) continue;
            token.kind = row.kind;
            token.op = row.op;
            token.problem = row.problem;
            return take(token, spelling.size());
        }
        token.kind = Kind::bad;
        token.problem = "this character means nothing in an expression";
        size_t length = 1;  // of the whole character, not of its first byte
        while (at_ + length < text_.size() && (static_cast<unsigned char>(text_[at_ + length]) & 0xC0) == 0x80) ++length;
        return take(token, length);
    }

private:
    Token take(Token token, size_t length) {
        token.text = text_.substr(at_, length);
        at_ += length;
        return token;
    }

    size_t name_length() const {
        size_t end = at_;
        while (end < text_.size() && (name_start(text_[end]) || digit(text_[end]))) ++end;
        return end - at_;
    }

    Token integer(Token token) {
        size_t end = at_ + 1;
        while (end < text_.size() && (name_start(text_[end]) || digit(text_[end]) || text_[end] == '.')) ++end;
        token.kind = Kind::integer;
        token = take(token, end - at_);
        if (const ParsedInteger parsed = parse_integer(token.text); parsed.problem != nullptr) {
            token.kind = Kind::bad;
            token.problem = parsed.problem;
        } else {
            token.number = parsed.number;
        }
        return token;
    }

    std::string_view text_;
    size_t at_ = 0;
};

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
            if (token_.kind == Kind::bad) {
                fail(token_.offset, "'" + std::string(token_.text) + "': " + token_.problem);
            } else if (want_operand) {
                want_operand = !operand();
            } else if (token_.kind == Kind::end) {
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
        const Token t = token_;
        const bool word_not = t.kind == Kind::name && t.text == "not" && !after_comparison();
        if (t.kind == Kind::bang || word_not || t.kind == Kind::open) {
            if (after_comparison() && t.kind == Kind::bang) {
                fail(t.offset, "'!' binds looser than a comparison: put parentheses around what it negates");
                return false;
            }
            if (++level_ > expr_level_limit) {
                fail(t.offset, "nested deeper than " + std::to_string(expr_level_limit) + " levels");
                return false;
            }
            const auto what = t.kind == Kind::open ? Pending::What::open : Pending::What::negate;
            pending_.push_back({what, Op::negate, t.offset});
            advance();
            return false;
        }
        if (t.kind == Kind::name) {
            operands_.push_back({std::nullopt, t.text, t.offset, false});
            advance();
            return true;
        }
        if (t.kind == Kind::integer) {
            operands_.push_back({literal(t.number, t.offset), {}, t.offset, false});
            advance();
            return true;
        }
        if (t.kind == Kind::end)
            fail(t.offset, text_.empty() ? "the expression is empty"
                                         : "the expression ends where an axis, a value or an integer is expected");
        else
            fail(t.offset, "expected an axis, a value, an integer or '(' before '" + std::string(t.text) + "'");
        return false;
    }

    // Takes what may stand after an operand. True when an operand is expected next.
    bool after_operand() {
        const Token t = token_;
        if (t.kind == Kind::op) {
            binary(t);
            advance();
            return true;
        }
        if (t.kind == Kind::name && t.text == "in") {
            member(t);
            return false;
        }
        if (t.kind == Kind::close) {
            close(t);
            return false;
        }
        std::string hint;
        if (t.kind == Kind::name && t.text == "and") hint = " (write '&&')";
        if (t.kind == Kind::name && t.text == "or") hint = " (write '||')";
        if (t.kind == Kind::name && t.text == "not") hint = " (write !(axis in {...}) for 'not in')";
        if (t.kind == Kind::bang) hint = " (write '!=' to compare)";
        fail(t.offset, "expected an operator before '" + std::string(t.text) + "'" + hint);
        return false;
    }

    void binary(const Token& t) {
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

    void chained(const Token& t) { fail(t.offset, "comparisons do not chain: join two of them with '&&'"); }

    void member(const Token& in) {
        if (after_comparison() || operands_.back().compared) return chained(in);
        advance();
        if (token_.kind != Kind::open_brace) return fail(token_.offset, "expected '{' after 'in'");
        const uint32_t brace = token_.offset;
        Operand& left = operands_.back();
        resolve_axis(left);
        if (error_) return;
        std::vector<uint32_t> args{*left.node};
        advance();
        for (;;) {
            if (token_.kind == Kind::integer) {
                args.push_back(literal(token_.number, token_.offset));
            } else if (token_.kind == Kind::name) {
                if (expr_.nodes[*left.node].op != Op::axis)
                    return fail(token_.offset, "'" + std::string(token_.text) + "': only an axis has named values");
                const uint32_t axis = expr_.nodes[*left.node].axis;
                const std::optional<int32_t> number = value_of(axis, token_.text);
                if (!number) return no_value(token_.offset, axis, token_.text);
                args.push_back(literal(*number, token_.offset));
            } else if (token_.kind == Kind::close_brace) {
                return fail(token_.offset,
                            args.size() == 1 ? "'in {}' holds never: name at least one value" : "expected a value after ','");
            } else {
                return fail(token_.kind == Kind::end ? brace : token_.offset,
                            token_.kind == Kind::end ? "this '{' is not closed" : "expected a value or an integer");
            }
            advance();
            if (token_.kind == Kind::close_brace) break;
            if (token_.kind == Kind::end) return fail(brace, "this '{' is not closed");
            if (token_.kind != Kind::comma) return fail(token_.offset, "expected ',' or '}'");
            advance();
        }
        advance();
        left.node = node({Op::in, 0, 0, std::move(args), in.offset});
        left.compared = true;
    }

    void close(const Token& t) {
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
        fail(offset, "'" + std::string(name) + "' is not a value of axis '" + axes_[axis].name + "'" + did_you_mean(name, names));
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
            return fail(o.offset, "unknown axis '" + std::string(o.name) + "'" + did_you_mean(o.name, names));
        }
        o.node = node({Op::axis, 0, *axis, {}, o.offset});
        expr_.axes.push_back(*axis);
    }

    std::string_view text_;
    const std::vector<Axis>& axes_;
    Lexer lexer_;
    Token token_;
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

ParsedInteger parse_integer(std::string_view text) {
    constexpr const char* not_integer = "not an integer (decimal or 0x)";
    constexpr const char* out_of_range = "out of range: -2147483648 to 2147483647";
    const bool negative = !text.empty() && text.front() == '-';
    std::string_view digits = negative ? text.substr(1) : text;
    const bool hex = digits.size() > 2 && digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X');
    if (hex) digits.remove_prefix(2);
    if (digits.empty()) return {0, not_integer};
    if (!hex && digits.size() > 1 && digits[0] == '0' && digits.find_first_not_of("0123456789") == std::string_view::npos)
        return {0, "leading zeros mean octal elsewhere: write it without"};
    uint64_t magnitude = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), magnitude, hex ? 16 : 10);
    if (end != digits.data() + digits.size() || code == std::errc::invalid_argument) return {0, not_integer};
    const uint64_t limit = uint64_t{0x7FFFFFFF} + (negative ? 1 : 0);
    if (code == std::errc::result_out_of_range || magnitude > limit) return {0, out_of_range};
    const int64_t value = negative ? -static_cast<int64_t>(magnitude) : static_cast<int64_t>(magnitude);
    return {static_cast<int32_t>(value), nullptr};
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
