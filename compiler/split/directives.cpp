// The directives that are not conditionals. What glslang 12 refuses is refused here, under the set of variants that gets there.
#include <algorithm>
#include <limits>

#include "compiler/split/preprocess.h"

namespace kiln {

std::string Preprocessor::spelled(const Token* begin, const Token* end) const {
    std::string out;
    const Token* before = nullptr;
    for (; begin != end; before = begin++) {
        const bool wordy = begin->kind != Tok::op && before != nullptr && before->kind != Tok::op;
        if (wordy) out += ' ';
        out += pp_.spellings.text(begin->text);
    }
    return out;
}

void Preprocessor::put_line(const Token& at, const std::string& text) {
    Token token = at;
    token.kind = Tok::line;
    token.text = pp_.spellings.intern(text);
    emitted_.put(out(), token);
}

// True when the name must not be (un)defined.
bool Preprocessor::reserved(const Token& name, const char* directive) {
    const std::string_view text = pp_.spellings.text(name.text);
    const std::string what = std::string(directive) + " " + std::string(text) + ": ";
    if (text.substr(0, 3) == "GL_") {
        pp_.findings.error(name, what + "names beginning with \"GL_\" can't be (un)defined", here_);
        return true;
    }
    if (name.text == spelling::defined_) {
        pp_.findings.error(name, what + "\"defined\" can't be (un)defined", here_);
        return true;
    }
    if (text.find("__") != std::string_view::npos) {
        const bool predefined =
            name.text == spelling::line_macro || name.text == spelling::file_macro || name.text == spelling::version_macro;
        if (pp_.es && predefined) {
            pp_.findings.error(name, what + "predefined names can't be (un)defined", here_);
            return true;
        }
        if (pp_.es && pp_.version < 300) {
            pp_.findings.error(
                name, what + "names containing consecutive underscores are reserved, and an error if version < 300", here_);
            return true;
        }
        pp_.findings.warning(name, what + "names containing consecutive underscores are reserved", here_);
    }
    return false;
}

void Preprocessor::define(const Token& at, const Token* begin, const Token* end) {
    if (begin == end || begin->kind != Tok::identifier) {
        pp_.findings.error(begin == end ? at : *begin, "#define must be followed by a macro name", here_);
        return;
    }
    const Token name = *begin++;
    if (reserved(name, "#define")) return;
    MacroDef def;
    const auto is = [&](uint32_t text) { return begin != end && begin->kind == Tok::op && begin->text == text; };
    if (is(spelling::paren_open) && (begin->flags & Token::spaced) == 0) {
        def.function_like = true;
        ++begin;
        while (!(def.parameters.empty() && is(spelling::paren_close))) {
            if (begin == end || begin->kind != Tok::identifier) {
                pp_.findings.error(begin == end ? name : *begin, "#define: bad parameter", here_);
                return;
            }
            if (std::find(def.parameters.begin(), def.parameters.end(), begin->text) != def.parameters.end())
                pp_.findings.error(*begin, "#define: duplicate macro parameter", here_);
            else
                def.parameters.push_back(begin->text);
            ++begin;
            if (!is(spelling::comma)) break;
            ++begin;
        }
        if (!is(spelling::paren_close)) {
            pp_.findings.error(begin == end ? name : *begin, "#define: missing ')'", here_);
            return;
        }
        ++begin;
    } else if (begin != end && (begin->flags & Token::spaced) == 0) {
        // glslang warns and forgets the definition.
        pp_.findings.warning(name, "#define: no space after the macro name: the definition is ignored", here_);
        return;
    }
    for (; begin != end; ++begin) {
        Token token = *begin;
        if (token.kind == Tok::hash && begin + 1 != end && begin[1].kind == Tok::hash && (begin[1].flags & Token::spaced) == 0) {
            token.kind = Tok::paste;
            token.text = spelling::paste;
            ++begin;
        }
        def.body.push_back(token);
    }
    const uint32_t id = pp_.macros.intern(std::move(def));
    for (const Macros::Meaning& m : pp_.macros.split(name.text, here_)) {
        if (m.def == 0 || m.def == id) continue;
        Set clash = m.set;
        const MacroDef& old = pp_.macros.def(m.def);
        std::vector<std::string> notes;
        if (old.axis >= 0) {
            const auto axis = static_cast<uint32_t>(old.axis);
            std::vector<bool> same(pp_.space.axes[axis].values.size());
            for (size_t d = 0; d < same.size(); ++d) {
                MacroDef number;
                number.body = lex_text(std::to_string(pp_.space.axes[axis].values[d].number), 0, pp_.spellings);
                same[d] = pp_.macros.intern(std::move(number)) == id;
            }
            clash = pp_.diagram.minus(clash, pp_.diagram.where(axis, same));
        }
        if (pp_.axis_of_macro.count(name.text) != 0)
            notes.push_back("it is the macro of axis " + pp_.space.axes[pp_.axis_of_macro[name.text]].name +
                            "; put a default into #ifndef " + std::string(pp_.spellings.text(name.text)));
        pp_.findings.error(name, "macro '" + std::string(pp_.spellings.text(name.text)) + "' redefined with another meaning",
                           clash, notes);
    }
    pp_.macros.assign(name.text, id, here_);
}

void Preprocessor::undefine(const Token& at, const Token* begin, const Token* end) {
    if (begin == end || begin->kind != Tok::identifier) {
        pp_.findings.error(begin == end ? at : *begin, "#undef must be followed by a macro name", here_);
        return;
    }
    if (reserved(*begin, "#undef")) return;
    if (begin + 1 != end) pp_.findings.error(begin[1], "#undef can only be followed by a single macro name", here_);
    pp_.macros.assign(begin->text, 0, here_);
}

// "a -> b -> a": the first file that is being read twice, and how it came back to itself.
std::string Preprocessor::chain(uint16_t next) const {
    std::vector<uint16_t> stack = stack_;
    stack.push_back(next);
    std::string out;
    for (auto first = stack.begin(); first != stack.end(); ++first) {
        const auto again = std::find(first + 1, stack.end(), *first);
        if (again == stack.end()) continue;
        for (auto at = first; at != again; ++at) out += sources_.file(*at).name + " -> ";
        return out + sources_.file(*again).name;
    }
    return out;
}

void Preprocessor::include(const Token& at, const Token* begin, const Token* end, uint16_t index, size_t depth) {
    if (begin == end || begin->kind != Tok::string) {
        pp_.findings.error(begin == end ? at : *begin, "#include must be followed by \"name\" or <name>", here_);
        return;
    }
    if (begin + 1 != end) {
        pp_.findings.error(begin[1], "unexpected tokens following #include", here_);
        return;
    }
    std::string_view name = pp_.spellings.text(begin->text);
    const bool angle = name.front() == '<';
    name = name.substr(1, name.size() - (name.size() > 1 ? 2 : 1));
    const Found found = sources_.find(name, angle ? std::nullopt : std::optional<uint16_t>(index));
    if (!found.file) {
        pp_.findings.error(*begin, "#include: " + found.problem, here_);
        kill(here_);
        return;
    }
    static constexpr size_t max_include_depth = 128;
    if (depth + 1 >= max_include_depth) {
        const bool cycle = std::find(stack_.begin(), stack_.end(), *found.file) != stack_.end();
        pp_.findings.error(*begin,
                           cycle ? "include cycle: " + chain(*found.file)
                                 : "includes nested more than " + std::to_string(max_include_depth) + " deep",
                           here_);
        kill(here_);
        return;
    }
    if (read_once_.size() < sources_.count()) read_once_.resize(sources_.count(), Diagram::none());
    const Set outer = here_;
    const Set skipping = pp_.diagram.both(outer, read_once_[*found.file]);
    here_ = pp_.diagram.minus(outer, skipping);
    if (here_ == Diagram::none()) {
        here_ = outer;
        return;
    }
    // Two includes in each of thirty files are a billion files read, all well within the depth.
    const LexedFile& included = sources_.file(*found.file).lexed;
    included_ += included.tokens.size() + included.items.size() + 50;  // tokens, and as much for a file as for 50 of them
    if (included_ > Preprocessing::max_work) {
        pp_.findings.error(*begin,
                           "with '" + std::string(name) + "' once more the includes read more than " +
                               std::to_string(Preprocessing::max_work) + " tokens",
                           here_);
        kill(here_);
        here_ = pp_.diagram.minus(outer, dead_);
        return;
    }
    const bool apart = here_ != outer;
    if (apart) sequences_.emplace_back();
    const Set reading = here_;
    std::vector<LogicalPlace> places = {{pp_.places.front().set, 0, 0}};
    // Variants agree about the place at the head of a file, but for how __FILE__ is said.
    Set all = Diagram::none();
    for (const LogicalPlace& p : pp_.places) all = pp_.diagram.either(all, p.set);
    const uint32_t number = pp_.spellings.intern(static_cast<int64_t>(*found.file));
    const uint32_t quoted = pp_.spellings.intern("\"" + sources_.file(*found.file).name + "\"");
    places.clear();
    if (const Set unnamed = pp_.diagram.minus(all, named_lines_); unnamed != Diagram::none())
        places.push_back({unnamed, 0, number});
    if (const Set named = pp_.diagram.both(all, named_lines_); named != Diagram::none()) places.push_back({named, 0, quoted});
    std::swap(places, pp_.places);
    stack_.push_back(*found.file);
    read_file(*found.file, depth + 1);
    stack_.pop_back();
    std::swap(places, pp_.places);
    if (apart) {
        Emitted::Sequence inner = std::move(sequences_.back());
        sequences_.pop_back();
        std::vector<std::pair<Set, Emitted::Sequence>> alternatives;
        alternatives.emplace_back(reading, std::move(inner));
        alternatives.emplace_back(skipping, Emitted::Sequence());
        emitted_.choose(out(), std::move(alternatives));
        if (emitted_.over_limit()) over_limit_ = true;
    }
    here_ = over_limit_ ? Diagram::none() : pp_.diagram.minus(outer, dead_);
}

void Preprocessor::set_line(const Token& at, const Token* begin, const Token* end) {
    std::vector<Set> todo{here_};
    while (!todo.empty()) {
        const Set set = todo.back();
        todo.pop_back();
        Guarded line, file;
        std::vector<Token> rest;
        Disagreement why;
        const auto again = [&] {
            const std::vector<Set> parts = pp_.split(why, set);
            todo.insert(todo.end(), parts.begin(), parts.end());
            count_states(parts.size(), parts.front());
        };
        if (!evaluator_.leading(at, begin, end, set, line, rest, why)) {
            if (!over_limit_) again();
            continue;
        }
        if (evaluator_.failed()) continue;
        std::optional<uint32_t> name;
        bool numbered = false;
        if (!rest.empty() && rest.front().kind == Tok::string) {
            name = rest.front().text;
            rest.erase(rest.begin());
        } else if (!rest.empty()) {
            std::vector<Token> tail;
            if (!evaluator_.leading(at, rest.data(), rest.data() + rest.size(), set, file, tail, why)) {
                if (!over_limit_) again();
                continue;
            }
            if (evaluator_.failed()) continue;
            rest = std::move(tail);
            numbered = true;
        }
        if (!rest.empty()) pp_.findings.error(rest.front(), "unexpected tokens following #line", set);
        // The line after the directive has the number given, or the one after it before version 330.
        const int64_t first = int64_t{at.line} + 1 - (pp_.version < (pp_.es ? 300 : 330) ? 1 : 0);
        for (const Guarded::Part& p : line.parts(pp_.diagram, set))
            for (const Guarded::Part& f : file.parts(pp_.diagram, p.set)) {
                std::vector<LogicalPlace> next;
                for (const LogicalPlace& place : pp_.places) {
                    const Set changed = pp_.diagram.both(place.set, f.set);
                    const Set kept = pp_.diagram.minus(place.set, f.set);
                    if (kept != Diagram::none()) next.push_back({kept, place.shift, place.file});
                    if (changed == Diagram::none()) continue;
                    const uint32_t id = name ? *name : numbered ? pp_.spellings.intern(int64_t{f.value}) : place.file;
                    next.push_back({changed, p.value - first, id});
                }
                pp_.places = std::move(next);
            }
    }
}

void Preprocessor::error_directive(const Token& at, std::string_view message) {
    pp_.findings.error(at, "#error " + std::string(message), here_, {}, true);
    kill(here_);
}

void Preprocessor::extension(const Token& at, const Token* begin, const Token* end) {
    if (begin == end || begin->kind != Tok::identifier) {
        pp_.findings.error(at, "#extension must be followed by an extension's name", here_);
        return;
    }
    if (end - begin < 3 || begin[1].kind != Tok::op || begin[1].text != spelling::colon || begin[2].kind != Tok::identifier) {
        pp_.findings.error(*begin, "#extension: ': behavior' missing after the extension's name", here_);
        return;
    }
    if (end - begin > 3) {
        pp_.findings.error(begin[3], "unexpected tokens following #extension", here_);
        return;
    }
    const std::string name(pp_.spellings.text(begin->text)), behaviour(pp_.spellings.text(begin[2].text));
    const auto mark = [&](Set& set) {
        set = behaviour == "disable" ? pp_.diagram.minus(set, here_) : pp_.diagram.either(set, here_);
    };
    if (name == "GL_GOOGLE_include_directive" || name == "GL_GOOGLE_cpp_style_line_directive") mark(named_lines_);
    if (name == "GL_ARB_shading_language_420pack") mark(pack420_);
    if (name == "GL_ARB_shading_language_include") return;  // #include needs no extension here, and glslang has not this one
    put_line(at, "#extension " + name + " : " + behaviour);
}

void Preprocessor::pragma(const Token& at, const Token* begin, const Token* end, uint16_t index) {
    if (end - begin == 1 && begin->text == spelling::once_) {
        if (read_once_.size() < sources_.count()) read_once_.resize(sources_.count(), Diagram::none());
        read_once_[index] = pp_.diagram.either(read_once_[index], here_);
        return;
    }
    put_line(at, begin == end ? "#pragma" : "#pragma " + spelled(begin, end));
}

}  // namespace kiln
