// The expansion follows glslang 12's input stack step by step (a macro's replacement list, its arguments, single tokens put
// back), because where that departs from the standard, shaders have come to rely on it: an argument next to ## is used as
// written, an empty one does not act as a place marker, a macro is closed to itself only while its body is being read, and a
// call may not reach across a directive.
#include "compiler/split/expand.h"

#include <algorithm>
#include <array>

namespace kiln {

std::optional<uint32_t> Preprocessing::digit_of(uint32_t axis, Set set) {
    const auto witness = diagram.witness(set);
    if (!witness) return std::nullopt;
    const uint32_t digit = (*witness)[axis];
    if (!diagram.subset(set, diagram.where(axis, digit))) return std::nullopt;
    return digit;
}

std::vector<Set> Preprocessing::split(const Disagreement& by, Set set) {
    std::vector<Set> parts;
    switch (by.kind) {
        case Disagreement::nothing:
            parts.push_back(set);
            break;
        case Disagreement::macro:
            if (const auto read = axis_of_macro.find(by.id); read != axis_of_macro.end()) axes_read[read->second] = true;
            for (const Macros::Meaning& m : macros.split(by.id, set)) parts.push_back(m.set);
            break;
        case Disagreement::axis:
            for (uint32_t digit = 0; digit < space.axes[by.id].values.size(); ++digit) {
                const Set part = diagram.both(set, diagram.where(by.id, digit));
                if (part != Diagram::none()) parts.push_back(part);
            }
            break;
        case Disagreement::line:
            for (const LogicalPlace& place : places) {
                const Set part = diagram.both(set, place.set);
                if (part != Diagram::none()) parts.push_back(part);
            }
            break;
    }
    return parts;
}

Expander::Expander(Preprocessing& pp, Set set, const Token* begin, const Token* end, Ends ends, MakeSymbol make_symbol)
    : pp_(pp), set_(set), at_(begin), end_(end), ends_(ends), make_symbol_(std::move(make_symbol)) {}

Expander::~Expander() {
    while (!inputs_.empty()) pop();
}

void Expander::pop() {
    if (inputs_.back().source == Source::macro) pp_.macros.set_busy(inputs_.back().name, false);
    inputs_.pop_back();
}

void Expander::disagree(Disagreement::Kind kind, uint32_t id) {
    if (!stopped()) disagreement_ = {kind, id};
}

void Expander::die(const Token& at, const std::string& message) {
    error(at, message);
    dead_ = true;
}

bool Expander::drained() {
    while (!inputs_.empty() && inputs_.back().at == inputs_.back().end && inputs_.back().source != Source::marker) pop();
    return inputs_.empty();
}

Token Expander::scan() {
    Token token;
    while (!stopped()) {
        if (++pp_.work > Preprocessing::max_work) {
            if (last_ != nullptr) token = *last_;
            die(token, "macros expand to more than can be read");
            break;
        }
        if (inputs_.empty()) {
            if (at_ != end_) {
                last_ = at_;
                return *at_++;
            }
            if (last_ != nullptr) token = *last_;
            token.text = 0;
            token.kind = ends_ == Ends::at_directive ? Tok::hash : Tok::end;
            return token;
        }
        Input& in = inputs_.back();
        if (in.source == Source::marker) {
            pop();
            token.kind = Tok::marker;
            return token;
        }
        if (in.at == in.end) {
            pop();
            continue;
        }
        switch (in.source) {
            case Source::macro:
                if (scan_macro(token)) return token;
                break;
            case Source::tokens:
                return *in.at++;
            case Source::single:
                token = in.token;
                in.at = in.end;
                return token;
            case Source::marker:
                break;
        }
    }
    token.kind = Tok::end;
    return token;
}

// False when the token was a parameter whose argument now lies on the stack.
bool Expander::scan_macro(Token& out) {
    Input& in = inputs_.back();
    out = *in.at++;
    out.line = in.token.line;
    out.column = in.token.column;
    out.file = in.token.file;
    out.flags |= Token::from_body;
    bool pasting = false;
    if (in.after_paste) {
        pasting = true;
        in.after_paste = false;
    }
    if (in.before_paste) {
        in.before_paste = false;
        in.after_paste = true;
    }
    if (in.at != in.end && in.at->kind == Tok::paste) {
        in.before_paste = true;
        pasting = true;
    }
    if (out.kind != Tok::identifier) return true;
    const std::vector<uint32_t>& parameters = pp_.macros.def(in.def).parameters;
    for (size_t i = parameters.size(); i-- > 0;) {
        if (parameters[i] != out.text) continue;
        const std::vector<Token>& argument = in.has_expanded[i] && !pasting ? in.expanded[i] : in.arguments[i];
        Input tokens;
        tokens.source = Source::tokens;
        tokens.at = argument.data();
        tokens.end = argument.data() + argument.size();
        tokens.last_pastes = in.before_paste;
        inputs_.push_back(std::move(tokens));
        return false;
    }
    return true;
}

bool Expander::about_to_paste() const {
    if (inputs_.empty()) return false;
    const Input& in = inputs_.back();
    if (in.source == Source::macro) return in.before_paste;
    if (in.source == Source::tokens) return (in.at != in.end && in.at->kind == Tok::paste) || (in.last_pastes && in.at == in.end);
    return false;
}

bool Expander::continues_paste(Tok kind) const {
    if (kind != Tok::identifier || inputs_.empty()) return false;
    const Input& in = inputs_.back();
    if ((in.source != Source::macro && in.source != Source::tokens) || in.at == in.end) return false;
    if ((in.at->flags & Token::spaced) != 0) return false;
    return in.at->kind == Tok::integer || in.at->kind == Tok::number || in.at->kind == Tok::string ||
           in.at->kind == Tok::identifier;
}

namespace {

// The operators that ## may begin with, and those it may make.
bool may_begin_pasted_operator(std::string_view text) {
    static constexpr std::string_view firsts[] = {"=", "!", "-", "~", "+",  "*",  "/",  "%",  "<",
                                                  ">", "|", "^", "&", ">>", "<<", "&&", "||", "^^"};
    return std::find(std::begin(firsts), std::end(firsts), text) != std::end(firsts);
}

bool is_operator(std::string_view text) {
    static constexpr std::string_view all[] = {"+=", "-=", "*=", "/=", "%=", ">>", "<<", ">>=", "<<=", "&=", "|=", "^=",
                                               "&&", "||", "^^", "==", "!=", ">=", "<=", "--",  "++",  "::", "##"};
    return std::find(std::begin(all), std::end(all), text) != std::end(all);
}

}  // namespace

Token Expander::paste(Token token) {
    if (token.kind == Tok::paste) {
        error(token, "'##' : unexpected location");
        return scan();
    }
    while (!stopped() && about_to_paste()) {
        scan();  // the ##
        if (end_of_body()) {
            error(token, "'##' : unexpected location; end of replacement list");
            break;
        }
        do {
            const Token next = scan();
            if (stopped()) return next;
            if (next.kind == Tok::marker || next.kind == Tok::end) {
                error(token, "'##' : unexpected location; end of argument");
                return token;
            }
            if (token.kind == Tok::symbol || next.kind == Tok::symbol) {
                error(token, "'##' : not supported for these tokens");
                return token;
            }
            const std::string_view first = pp_.spellings.text(token.text);
            const std::string joined = std::string(first) + std::string(pp_.spellings.text(next.text));
            if (token.kind == Tok::identifier) {
                if (next.kind == Tok::op || next.kind == Tok::string) {
                    error(token, "'##' : not supported for these tokens");
                    return token;
                }
            } else if (token.kind != Tok::op || !may_begin_pasted_operator(first)) {
                error(token, "'##' : not supported for these tokens");
                return token;
            } else if (next.kind != Tok::op || !is_operator(joined)) {
                error(token, "'##' : combined token is invalid");
                continue;
            }
            if (joined.size() > 1024) {
                error(token, "'##' : combined tokens are too long");
                return token;
            }
            token.text = pp_.spellings.intern(joined);
        } while (!stopped() && continues_paste(token.kind));
    }
    return token;
}

void Expander::push_single(const Token& token) {
    static const Token place{};
    Input in;
    in.source = Source::single;
    in.token = token;
    in.at = &place;
    in.end = &place + 1;
    inputs_.push_back(std::move(in));
}

Expander::Result Expander::expand(Token& token, bool undefined_is_zero) {
    token.flags &= static_cast<uint8_t>(~Token::spaced);
    const uint32_t name = token.text;
    if (name == spelling::line_macro || name == spelling::file_macro || name == spelling::version_macro) {
        Token out = token;
        out.kind = Tok::integer;
        out.flags = 0;
        if (name == spelling::version_macro) {
            out.text = pp_.spellings.intern(int64_t{pp_.version});
        } else {
            const LogicalPlace* here = nullptr;
            for (const LogicalPlace& place : pp_.places)
                if (pp_.diagram.subset(set_, place.set)) here = &place;
            if (here == nullptr) {
                disagree(Disagreement::line, 0);
                return Result::failed;
            }
            const bool fixed = (token.flags & Token::line_fixed) != 0 || last_ == nullptr;
            const uint32_t physical = fixed ? token.line : last_->line;
            out.text =
                name == spelling::file_macro ? here->file : pp_.spellings.intern(static_cast<int64_t>(physical) + here->shift);
            if (pp_.spellings.text(out.text).front() == '"') out.kind = Tok::string;
        }
        push_single(out);
        return Result::started;
    }
    if (!pp_.macros.known(name)) return undefined_is_zero ? Result::undefined : Result::not_expanded;
    if (pp_.macros.busy(name)) return Result::not_expanded;
    Macros::Lookup meaning = pp_.macros.lookup(name, set_);
    if (!meaning.unique) {
        if (make_symbol_ && make_symbol_(token)) {
            push_single(token);
            return Result::started;
        }
        disagree(Disagreement::macro, name);
        return Result::failed;
    }
    if (meaning.def == 0) return undefined_is_zero ? Result::undefined : Result::not_expanded;
    if (const int32_t axis = pp_.macros.def(meaning.def).axis; axis >= 0) {
        const auto index = static_cast<uint32_t>(axis);
        if (make_symbol_ && make_symbol_(token)) {
            push_single(token);
            return Result::started;
        }
        pp_.axes_read[index] = true;
        const auto digit = pp_.digit_of(index, set_);
        if (!digit) {
            disagree(Disagreement::axis, index);
            return Result::failed;
        }
        MacroDef number;
        number.body = lex_text(std::to_string(pp_.space.axes[index].values[*digit].number), 0, pp_.spellings);
        meaning.def = pp_.macros.intern(std::move(number));
    }
    Input in;
    in.source = Source::macro;
    in.name = name;
    in.def = meaning.def;
    in.token = token;
    if (pp_.macros.def(meaning.def).function_like) {
        Token open = scan();
        if (open.text != spelling::paren_open || open.kind != Tok::op) {
            if (stopped()) return Result::failed;
            push_single(open);
            return Result::not_expanded;
        }
        if (!collect(in, token, in.token)) return Result::failed;
    }
    const std::vector<Token>& body = pp_.macros.def(meaning.def).body;
    in.at = body.data();
    in.end = body.data() + body.size();
    inputs_.push_back(std::move(in));
    pp_.macros.set_busy(name, true);
    return Result::started;
}

// Reads the arguments of a call after its '('.
bool Expander::collect(Input& in, Token& token, const Token& name) {
    const Token called = name;
    const std::string what = "'" + std::string(pp_.spellings.text(called.text)) + "' : ";
    const size_t wanted = pp_.macros.def(in.def).parameters.size();
    in.arguments.resize(wanted);
    size_t index = 0;
    bool any = false;
    do {
        size_t depth = 0;
        for (;;) {
            token = scan();
            if (stopped()) return false;
            if (token.kind == Tok::end || token.kind == Tok::marker) {
                error(called, what + (ends_ == Ends::at_newline ? "end of line in macro call" : "end of input in macro call"));
                return false;
            }
            if (token.kind == Tok::hash) {
                error(called, what + "a directive inside the arguments of a macro call");
                return false;
            }
            const bool close = token.kind == Tok::op && token.text == spelling::paren_close;
            if (wanted == 0 && !close) break;
            if (depth == 0 && (close || (token.kind == Tok::op && token.text == spelling::comma))) break;
            if (token.kind == Tok::op && token.text == spelling::paren_open) ++depth;
            if (close && depth > 0) --depth;
            token.flags &= static_cast<uint8_t>(~Token::from_body);
            if (token.text == spelling::line_macro && last_ != nullptr) {
                token.line = last_->line;
                token.flags |= Token::line_fixed;
            }
            in.arguments[index].push_back(token);
            any = true;
        }
        if (token.text == spelling::paren_close) {
            if (wanted == 1 && !any) break;
            ++index;
            break;
        }
        ++index;
    } while (index < wanted);

    if (index < wanted) {
        error(called, what + "too few arguments in macro call");
    } else if (!(token.kind == Tok::op && token.text == spelling::paren_close)) {
        size_t depth = 0;
        const auto is = [&](uint32_t text) { return token.kind == Tok::op && token.text == text; };
        while (token.kind != Tok::end && token.kind != Tok::hash && (depth > 0 || !is(spelling::paren_close))) {
            if (is(spelling::paren_close) && depth > 0) --depth;
            token = scan();
            if (stopped()) return false;
            if (is(spelling::paren_open)) ++depth;
        }
        error(called, what + "too many arguments in macro call");
        if (token.kind != Tok::op) return false;
    }
    in.expanded.resize(wanted);
    in.has_expanded.assign(wanted, false);
    for (size_t i = 0; i < wanted; ++i) {
        in.has_expanded[i] = expand_argument(in.arguments[i], in.expanded[i]);
        if (stopped()) return false;
    }
    return true;
}

// Expands an argument by itself, before it is put into the body.
bool Expander::expand_argument(const std::vector<Token>& argument, std::vector<Token>& out) {
    // Most arguments name no macro.
    if (std::none_of(argument.begin(), argument.end(), [&](const Token& t) {
            return t.kind == Tok::paste ||
                   (t.kind == Tok::identifier && (pp_.macros.known(t.text) || t.text == spelling::line_macro ||
                                                  t.text == spelling::file_macro || t.text == spelling::version_macro));
        })) {
        out = argument;
        return true;
    }
    if (pp_.depth >= Preprocessing::max_depth) {
        die(argument.front(), "macro calls nested more than " + std::to_string(Preprocessing::max_depth) + " deep");
        return false;
    }
    ++pp_.depth;
    Input marker;
    marker.source = Source::marker;
    inputs_.push_back(std::move(marker));
    Input tokens;
    tokens.source = Source::tokens;
    tokens.at = argument.data();
    tokens.end = argument.data() + argument.size();
    inputs_.push_back(std::move(tokens));
    Token token;
    for (;;) {
        token = scan();
        if (token.kind == Tok::marker || token.kind == Tok::end || stopped()) break;
        token = paste(token);
        if (token.kind == Tok::identifier) {
            const Result result = expand(token, false);
            if (result == Result::failed) {
                while (!stopped() && (token = scan()).kind != Tok::marker && token.kind != Tok::end) {
                }
                break;
            }
            if (result != Result::not_expanded) continue;
        }
        if (token.kind == Tok::marker || token.kind == Tok::end) break;
        token.flags &= static_cast<uint8_t>(~Token::from_body);
        out.push_back(token);
    }
    --pp_.depth;
    return token.kind == Tok::marker;
}

}  // namespace kiln
