// An #if is evaluated once for all variants that reach it. An operand that differs between them (an axis, a macro defined
// differently here and there) becomes a symbol with a guarded value, and the operators work on guarded values; so the cost is
// the number of different values on the way, not of combinations of axes. Only where macros change the *shape* of the line
// (a function-like macro here, an unbalanced body there) is the set split and the line read once for each part.
//
// Grammar, precedence and arithmetic are those of glslang 12. Both operands of && and || are read and computed, as there;
// short circuit decides only whether an undefined identifier is a mistake.
#include "compiler/split/pp_expr.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace kiln {

namespace {

constexpr size_t max_pairs = 4'000'000;  // of values that one operator combines

int32_t wrap(int64_t v) { return static_cast<int32_t>(static_cast<uint32_t>(static_cast<uint64_t>(v))); }

struct Operator {
    uint32_t text;
    int precedence;
    int32_t (*apply)(int32_t, int32_t);
};

enum Precedence { lowest, logical_or, logical_and, bit_or, bit_xor, bit_and, equality, relation, shift, sum, product, prefix };

constexpr Operator operators[] = {
    {spelling::logical_or, logical_or, [](int32_t a, int32_t b) { return a != 0 || b != 0 ? 1 : 0; }},
    {spelling::logical_and, logical_and, [](int32_t a, int32_t b) { return a != 0 && b != 0 ? 1 : 0; }},
    {spelling::bit_or, bit_or, [](int32_t a, int32_t b) { return a | b; }},
    {spelling::bit_xor, bit_xor, [](int32_t a, int32_t b) { return a ^ b; }},
    {spelling::bit_and, bit_and, [](int32_t a, int32_t b) { return a & b; }},
    {spelling::equal, equality, [](int32_t a, int32_t b) { return a == b ? 1 : 0; }},
    {spelling::unequal, equality, [](int32_t a, int32_t b) { return a != b ? 1 : 0; }},
    {spelling::greater, relation, [](int32_t a, int32_t b) { return a > b ? 1 : 0; }},
    {spelling::greater_equal, relation, [](int32_t a, int32_t b) { return a >= b ? 1 : 0; }},
    {spelling::less, relation, [](int32_t a, int32_t b) { return a < b ? 1 : 0; }},
    {spelling::less_equal, relation, [](int32_t a, int32_t b) { return a <= b ? 1 : 0; }},
    {spelling::shift_left, shift,
     [](int32_t a, int32_t b) { return static_cast<int32_t>(static_cast<uint32_t>(a) << (static_cast<uint32_t>(b) & 31)); }},
    {spelling::shift_right, shift, [](int32_t a, int32_t b) { return a >> (static_cast<uint32_t>(b) & 31); }},
    {spelling::plus, sum, [](int32_t a, int32_t b) { return wrap(int64_t{a} + b); }},
    {spelling::minus, sum, [](int32_t a, int32_t b) { return wrap(int64_t{a} - b); }},
    {spelling::star, product, [](int32_t a, int32_t b) { return wrap(int64_t{a} * b); }},
    {spelling::slash, product,
     [](int32_t a, int32_t b) { return b == 0                                                ? a
                                       : a == std::numeric_limits<int32_t>::min() && b == -1 ? 0
                                                                                             : a / b; }},
    {spelling::percent, product,
     [](int32_t a, int32_t b) { return b == 0 || (a == std::numeric_limits<int32_t>::min() && b == -1) ? 0 : a % b; }},
};

const Operator* binary(const Token& token) {
    if (token.kind != Tok::op) return nullptr;
    const auto at =
        std::find_if(std::begin(operators), std::end(operators), [&](const Operator& o) { return o.text == token.text; });
    return at == std::end(operators) ? nullptr : at;
}

int32_t integer_value(std::string_view text) {
    uint64_t value = 0;
    if (text.size() > 1 && text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
        for (const char c : text.substr(2))
            value = value << 4 | static_cast<uint64_t>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
    } else {
        const uint64_t radix = text[0] == '0' ? 8 : 10;
        for (const char c : text) value = value * radix + static_cast<uint64_t>(c - '0');
    }
    return static_cast<int32_t>(static_cast<uint32_t>(value));
}

}  // namespace

class Evaluator::Run {
public:
    Run(Evaluator& evaluator, const Token& at, const Token* begin, const Token* end, Set set, Set live)
        : e_(evaluator),
          pp_(evaluator.pp_),
          at_(at),
          set_(set),
          live_(live),
          expander_(pp_, set, begin, end, Expander::Ends::at_newline, [this](Token& t) { return e_.symbol_for(t, set_); }) {}

    Reading run(bool whole) {
        Reading out;
        Token token = expression(expander_.scan(), lowest, live_, out.value);
        out.failed = failed_;
        while (!expander_.stopped() && token.kind != Tok::end) {
            if (whole) {
                if (!failed_) error(token, "unexpected tokens following directive");
                break;
            }
            out.rest.push_back(token);
            token = expander_.scan();
        }
        out.disagreement = e_.inner_.kind != Disagreement::nothing ? e_.inner_ : expander_.disagreement();
        out.dead = expander_.dead();
        out.undefined = std::move(undefined_);
        return out;
    }

private:
    void error(const Token& token, const std::string& message) {
        if (expander_.stopped() || e_.inner_.kind != Disagreement::nothing) return;
        Token place = token;
        if (place.line == 0) place = at_;
        pp_.findings.error(place, message, set_);
    }
    Token fail(const Token& token, const std::string& message, Guarded& value) {
        error(token, message);
        failed_ = true;
        value = Guarded();
        return token;
    }

    // Expands macros until something that is not a name comes, or `defined`.
    Token to_operand(Token token, Set live) {
        while (token.kind == Tok::identifier && token.text != spelling::defined_ && !failed_ && !expander_.stopped()) {
            const Token name = token;
            switch (expander_.expand(token, true)) {
                case Expander::Result::not_expanded:
                case Expander::Result::failed: {
                    Guarded nothing;
                    fail(
                        name,
                        "'" + std::string(pp_.spellings.text(name.text)) + "' : cannot be evaluated in a preprocessor expression",
                        nothing);
                    break;
                }
                case Expander::Result::started:
                    break;
                case Expander::Result::undefined: {
                    if (live != Diagram::none() && pp_.axis_of_macro.count(name.text) == 0) undefined_.push_back({name, live});
                    Token zero = name;
                    zero.kind = Tok::integer;
                    zero.text = spelling::zero;
                    return zero;
                }
            }
            token = expander_.scan();
        }
        return token;
    }

    Token operand(Token token, Set live, Guarded& value) {
        if (token.kind == Tok::integer) {
            value = Guarded::constant(integer_value(pp_.spellings.text(token.text)));
            return expander_.scan();
        }
        if (token.kind == Tok::symbol) {
            const Symbol& symbol = e_.symbols_[token.text];
            value = symbol.value;
            for (const Undefined& u : symbol.undefined)
                if (const Set both = pp_.diagram.both(u.set, live); both != Diagram::none()) undefined_.push_back({u.at, both});
            return expander_.scan();
        }
        if (token.kind == Tok::identifier) return defined(token, value);
        if (token.kind == Tok::op && token.text == spelling::paren_open) {
            const Token open = token;
            token = expression(expander_.scan(), lowest, live, value);
            if (failed_ || expander_.stopped()) return token;
            if (token.kind != Tok::op || token.text != spelling::paren_close) return fail(open, "expected ')'", value);
            return expander_.scan();
        }
        if (token.kind == Tok::op) {
            int32_t (*op)(int32_t) = nullptr;
            switch (token.text) {
                case spelling::plus:
                    op = [](int32_t a) { return a; };
                    break;
                case spelling::minus:
                    op = [](int32_t a) { return wrap(-int64_t{a}); };
                    break;
                case spelling::tilde:
                    op = [](int32_t a) { return ~a; };
                    break;
                case spelling::bang:
                    op = [](int32_t a) { return a == 0 ? 1 : 0; };
                    break;
                default:
                    break;
            }
            if (op != nullptr) {
                token = expression(expander_.scan(), prefix, live, value);
                value = Guarded::apply(pp_.diagram, set_, value, op);
                return token;
            }
        }
        return fail(token, token.kind == Tok::end ? "expression expected" : "bad expression", value);
    }

    Token defined(const Token& name, Guarded& value) {
        if ((name.flags & Token::from_body) != 0)
            error(name, "'defined' : cannot be used in a preprocessor expression when it comes out of a macro");
        Token token = expander_.scan();
        const bool parenthesis = token.kind == Tok::op && token.text == spelling::paren_open;
        if (parenthesis) token = expander_.scan();
        if (token.kind == Tok::symbol && e_.symbols_[token.text].several) {
            // Expanded as a macro argument; where the name is not defined it is still a name.
            e_.inner_ = {Disagreement::macro, e_.symbols_[token.text].name};
            failed_ = true;
            return token;
        }
        if (token.kind != Tok::identifier) return fail(name, "'defined' : expected an identifier", value);
        const Set where = pp_.macros.defined_in(token.text, set_);
        e_.note_definition_read(token.text, set_);
        value = where == set_ ? Guarded::constant(1)
                              : Guarded::of_parts(pp_.diagram, {{where, 1}, {pp_.diagram.minus(set_, where), 0}});
        token = expander_.scan();
        if (parenthesis) {
            if (token.kind != Tok::op || token.text != spelling::paren_close) return fail(name, "expected ')'", value);
            token = expander_.scan();
        }
        return token;
    }

    Token expression(Token token, int precedence, Set live, Guarded& value) {
        if (pp_.depth >= Preprocessing::max_depth) {
            expander_.die(token, "expression nested more than " + std::to_string(Preprocessing::max_depth) + " deep");
            return token;
        }
        ++pp_.depth;
        token = to_operand(token, live);
        if (!failed_ && !expander_.stopped()) token = operand(token, live, value);
        token = to_operand(token, live);
        while (!failed_ && !expander_.stopped()) {
            const Operator* const op = binary(token);
            if (op == nullptr || op->precedence <= precedence) break;
            const Token place = token;
            Set right_live = live;
            if (op->text == spelling::logical_and) right_live = value.nonzero(pp_.diagram, live);
            if (op->text == spelling::logical_or) right_live = pp_.diagram.minus(live, value.nonzero(pp_.diagram, live));
            Guarded right;
            token = expression(expander_.scan(), op->precedence, right_live, right);
            if (failed_ || expander_.stopped()) break;
            if (op->text == spelling::slash || op->text == spelling::percent) {
                const Set zero = pp_.diagram.minus(set_, right.nonzero(pp_.diagram, set_));
                if (zero != Diagram::none()) {
                    pp_.findings.error(place, "division by 0", zero);
                    right = Guarded::apply(pp_.diagram, set_, right, [](int32_t v) { return v == 0 ? 1 : v; });
                }
            }
            if (op->text == spelling::logical_and || op->text == spelling::logical_or) {
                const Set a = value.nonzero(pp_.diagram, set_), b = right.nonzero(pp_.diagram, set_);
                const Set holds = op->text == spelling::logical_and ? pp_.diagram.both(a, b) : pp_.diagram.either(a, b);
                value = Guarded::of_parts(pp_.diagram, {{holds, 1}, {pp_.diagram.minus(set_, holds), 0}});
                continue;
            }
            auto result = Guarded::apply(pp_.diagram, set_, value, right, op->apply, max_pairs);
            if (!result) {
                e_.too_many_ = true;
                failed_ = true;
                break;
            }
            value = std::move(*result);
        }
        --pp_.depth;
        return token;
    }

    Evaluator& e_;
    Preprocessing& pp_;
    Token at_;
    Set set_, live_;
    bool failed_ = false;
    std::vector<Undefined> undefined_;
    Expander expander_;
};

// Asking whether an axis is defined tells something only where that differs.
void Evaluator::note_definition_read(uint32_t name, Set set) {
    if (!pp_.macros.known(name)) return;
    const auto axis = pp_.axis_of_macro.find(name);
    if (axis == pp_.axis_of_macro.end()) return;
    const Set where = pp_.macros.defined_in(name, set);
    if (where != set && where != Diagram::none()) pp_.axes_read[axis->second] = true;
}

// Whether every meaning of a name is one operand by itself, so that its value may stand for its text.
bool Evaluator::can_stand_for_text(uint32_t name, size_t& budget) const {
    if (budget == 0) return false;
    --budget;
    for (const Macros::Meaning& m : pp_.macros.meanings(name)) {
        if (m.def == 0) continue;
        const MacroDef& def = pp_.macros.def(m.def);
        if (def.axis >= 0 || def.closed) continue;
        if (def.function_like || def.body.size() != 1 || def.body.front().kind != Tok::identifier) return false;
        const uint32_t inner = def.body.front().text;
        if (inner == spelling::defined_ || inner == spelling::line_macro || inner == spelling::file_macro || inner == name)
            return false;
        if (inner != spelling::version_macro && !can_stand_for_text(inner, budget)) return false;
    }
    return true;
}

bool Evaluator::symbol_for(Token& token, Set set) {
    const uint32_t name = token.text;
    if (memo_generation_ != pp_.macros.generation()) {
        memo_.clear();
        memo_generation_ = pp_.macros.generation();
    }
    const auto known = memo_.find({name, set});
    uint32_t id = 0;
    if (known != memo_.end()) {
        id = known->second;
    } else {
        size_t budget = 1000;
        if (pp_.depth >= Preprocessing::max_depth || !can_stand_for_text(name, budget)) return false;
        Symbol symbol;
        const std::vector<Macros::Meaning> meanings = pp_.macros.split(name, set);
        symbol.name = name;
        symbol.several = meanings.size() > 1;
        if (const auto axis = pp_.axis_of_macro.find(name); axis != pp_.axis_of_macro.end()) pp_.axes_read[axis->second] = true;
        std::vector<Guarded::Part> parts;
        for (const Macros::Meaning& m : meanings) {
            if (m.def == 0) {
                // An axis that is not defined counts as 0; that is not a mistake.
                if (pp_.axis_of_macro.count(name) == 0) symbol.undefined.push_back({token, m.set});
                parts.push_back({m.set, 0});
                continue;
            }
            const MacroDef& def = pp_.macros.def(m.def);
            if (def.axis >= 0) {
                const auto axis = static_cast<uint32_t>(def.axis);
                std::vector<int32_t> numbers;
                for (const AxisValue& v : pp_.space.axes[axis].values) numbers.push_back(v.number);
                pp_.axes_read[axis] = true;
                if (meanings.size() == 1) {
                    symbol.value = Guarded::of_axis(axis, std::move(numbers));
                } else {
                    for (const Guarded::Part& p : Guarded::of_axis(axis, std::move(numbers)).parts(pp_.diagram, m.set))
                        parts.push_back(p);
                }
                continue;
            }
            std::vector<Token> body = def.body;
            for (Token& t : body) t.line = token.line, t.column = token.column, t.file = token.file;
            pp_.macros.set_busy(name, true);
            ++pp_.depth;
            Reading reading = read(token, body.data(), body.data() + body.size(), m.set, m.set, true);
            --pp_.depth;
            pp_.macros.set_busy(name, false);
            if (reading.disagreement.kind != Disagreement::nothing) {
                inner_ = reading.disagreement;
                return false;
            }
            for (const Undefined& u : reading.undefined) symbol.undefined.push_back(u);
            for (const Guarded::Part& p : reading.value.parts(pp_.diagram, m.set)) parts.push_back(p);
        }
        if (!parts.empty()) symbol.value = Guarded::of_parts(pp_.diagram, std::move(parts));
        id = static_cast<uint32_t>(symbols_.size());
        symbols_.push_back(std::move(symbol));
        memo_.emplace(std::pair(name, set), id);
    }
    token.kind = Tok::symbol;
    token.text = id;
    return true;
}

Evaluator::Reading Evaluator::read(const Token& at, const Token* begin, const Token* end, Set set, Set live, bool whole) {
    Run run(*this, at, begin, end, set, live);
    return run.run(whole);
}

void Evaluator::report(const std::vector<Undefined>& undefined) {
    if (undefined_is_zero_) return;
    for (const Undefined& u : undefined) {
        const std::string name(pp_.spellings.text(u.at.text));
        std::vector<std::string> candidates;
        for (const uint32_t id : pp_.macros.names()) {
            const std::string text(pp_.spellings.text(id));
            if (text.substr(0, 3) != "GL_" && text != name) candidates.push_back(text);
        }
        const std::string close = nearest(name, candidates);
        std::string message = "'" + name + "' is not defined";
        if (!close.empty()) message += "; did you mean '" + close + "'?";
        pp_.findings.error(u.at, message, u.set);
    }
}

Evaluator::Outcome Evaluator::condition(const Token& at, const Token* begin, const Token* end, Set set) {
    Outcome out;
    std::vector<Set> todo{set};
    while (!todo.empty()) {
        const Set part = todo.back();
        todo.pop_back();
        inner_ = {};
        too_many_ = false;
        Reading reading = read(at, begin, end, part, part, true);
        if (reading.disagreement.kind != Disagreement::nothing) {
            const std::vector<Set> parts = pp_.split(reading.disagreement, part);
            todo.insert(todo.end(), parts.rbegin(), parts.rend());
            out.pieces += parts.size();
            if (out.pieces > limit_) {
                out.too_many = true;
                return out;
            }
            continue;
        }
        report(reading.undefined);
        out.too_many = out.too_many || too_many_;
        if (reading.failed || reading.dead)
            out.failed = pp_.diagram.either(out.failed, part);
        else
            out.holds = pp_.diagram.either(out.holds, reading.value.nonzero(pp_.diagram, part));
    }
    inner_ = {};
    return out;
}

bool Evaluator::leading(const Token& at, const Token* begin, const Token* end, Set set, Guarded& value, std::vector<Token>& rest,
                        Disagreement& disagreement) {
    inner_ = {};
    Reading reading = read(at, begin, end, set, set, false);
    inner_ = {};
    disagreement = reading.disagreement;
    if (disagreement.kind != Disagreement::nothing) return false;
    report(reading.undefined);
    value = reading.value;
    rest = std::move(reading.rest);
    if (reading.failed || reading.dead) rest.clear();
    failed_ = reading.failed || reading.dead;
    return true;
}

}  // namespace kiln
