// Why one pass is enough. A file is walked once, linearly, however many variants read it: `here_` is the set of variants for
// which the current line is live. A condition splits it by outcome and #endif puts it together again, so nothing else forks:
// macro tables are not copied (their entries are guarded, macros.h), texts are not copied (they are emitted under their set,
// emitted.h), and the lines after #endif are read once for everybody. What varies is carried in sets, and sets are nodes of
// the diagram. A text run is expanded for the whole set; only an invocation whose macros differ within the set is started
// anew for each part, and the parts meet again behind it. So the states made are: one per branch of a condition that really
// splits, one per part of such an invocation. Which texts are distinct is found out at the end (Emitted::refine).
#include "compiler/split/preprocess.h"

#include <algorithm>
#include <iterator>

#include "compiler/base/jobs.h"

namespace kiln {

Preprocessor::Preprocessor(Preprocessing& pp, Sources& sources, Emitted& emitted, const Options& options, uint64_t max_states)
    : pp_(pp),
      sources_(sources),
      emitted_(emitted),
      evaluator_(pp, options.undefined_macros == UndefinedMacros::zero,
                 static_cast<size_t>(std::min<uint64_t>(max_states, 1u << 24))),
      max_states_(max_states),
      sequences_(1) {}

void Preprocessor::predefine(std::string_view name, std::string_view body, Set set) {
    MacroDef def;
    def.body = lex_text(body, 0, pp_.spellings);
    const uint32_t id = pp_.macros.intern(std::move(def));
    pp_.macros.assign(pp_.spellings.intern(name), id, set);
}

void Preprocessor::predefine_axis(uint32_t index, Set start) {
    const Axis& axis = pp_.space.axes[index];
    const uint32_t name = pp_.spellings.intern(axis.macro);
    pp_.axis_of_macro.emplace(name, index);
    if (axis.kind == AxisKind::defined) {
        std::vector<bool> on(axis.values.size());
        for (size_t d = 0; d < on.size(); ++d) on[d] = axis.values[d].number != 0;
        predefine(axis.macro, "1", pp_.diagram.both(start, pp_.diagram.where(index, on)));
        return;
    }
    MacroDef def;
    def.axis = static_cast<int32_t>(index);
    pp_.macros.assign(name, pp_.macros.intern(std::move(def)), start);
}

void Preprocessor::count_states(uint64_t more, Set split_off) {
    states_ += more;
    if (split_sets_.size() < 100'000) split_sets_.push_back(split_off);
    if (states_ <= max_states_) return;
    over_limit_ = true;
    kill(here_);
}

void Preprocessor::run(uint16_t root, Set start) {
    here_ = start;
    const LexedFile& file = sources_.file(root).lexed;
    for (const Item& item : file.items) {
        if (item.kind != Directive::version) continue;
        version_ = &item;
        break;
    }
    stack_.push_back(root);
    pp_.places = {{start, 0, spelling::zero}};
    read_file(root, 0);
}

void Preprocessor::read_file(uint16_t index, size_t depth) {
    const LexedFile& file = sources_.file(index).lexed;
    const size_t outer_frames = frames_.size();
    for (const LexProblem& p : file.problems) {
        if (p.outside_conditionals && outer_frames + p.depth != 0) continue;
        Token at;
        at.file = index;
        at.line = p.line;
        at.column = p.column;
        pp_.findings.error(at, p.message, here_);
    }
    if (file.continued && pp_.version < (pp_.es ? 300 : 420)) {
        Token at;
        at.file = index;
        at.line = file.continued_line;
        at.column = 1;
        pp_.findings.error(at, "line continuation needs #version 420 or GL_ARB_shading_language_420pack",
                           pp_.diagram.minus(here_, pack420_));
    }
    static constexpr size_t max_nesting = 65;  // glslang's, over all files
    if (outer_frames + file.max_depth > max_nesting) {
        const auto deep = std::find_if(file.items.begin(), file.items.end(),
                                       [&](const Item& item) { return outer_frames + item.depth >= max_nesting; });
        Token at;
        at.file = index;
        at.line = deep->line;
        at.column = deep->column;
        pp_.findings.error(at, "conditionals nested more than " + std::to_string(max_nesting) + " deep", here_);
        kill(here_);
        return;
    }
    for (size_t i = 0; i < file.items.size();) {
        if (interrupted.load(std::memory_order_relaxed)) {
            over_limit_ = true;  // nothing more is read, in any file
            here_ = Diagram::none();
            return;
        }
        const Item& item = file.items[i];
        Token at;
        at.file = index;
        at.line = item.line;
        at.column = item.column;
        const Token* const begin = file.tokens.data() + item.begin;
        const Token* const end = file.tokens.data() + item.end;
        switch (item.kind) {
            case Directive::if_:
            case Directive::ifdef:
            case Directive::ifndef:
            case Directive::elif:
            case Directive::else_:
            case Directive::endif:
                i = conditional(file, index, i);
                continue;
            default:
                break;
        }
        ++i;
        if (here_ == Diagram::none()) continue;
        switch (item.kind) {
            case Directive::text:
                text_run(file, item, index == stack_.front() && stack_.size() == 1 && i == file.items.size());
                break;
            case Directive::define:
                define(at, begin, end);
                break;
            case Directive::undef:
                undefine(at, begin, end);
                break;
            case Directive::include:
                include(at, begin, end, index, depth);
                break;
            case Directive::line:
                set_line(at, begin, end);
                break;
            case Directive::pragma:
                pragma(at, begin, end, index);
                break;
            case Directive::error:
                error_directive(at, std::string_view(file.clean).substr(item.raw_begin, item.raw_end - item.raw_begin));
                break;
            case Directive::extension:
                extension(at, begin, end);
                break;
            case Directive::version:
                if (&item != version_) pp_.findings.error(at, "#version must come first, and once", here_);
                break;
            case Directive::unknown:
                pp_.findings.error(
                    at, item.name == 0 ? "invalid directive" : "invalid directive #" + std::string(pp_.spellings.text(item.name)),
                    here_);
                break;
            default:
                break;
        }
    }
}

Set Preprocessor::condition(const Item& item, const LexedFile& file, uint16_t index, Set set) {
    Token at;
    at.file = index;
    at.line = item.line;
    at.column = item.column;
    const Token* const begin = file.tokens.data() + item.begin;
    const Token* const end = file.tokens.data() + item.end;
    if (item.kind == Directive::ifdef || item.kind == Directive::ifndef) {
        const char* const name = item.kind == Directive::ifdef ? "#ifdef" : "#ifndef";
        if (begin == end || begin->kind != Tok::identifier) {
            pp_.findings.error(at, std::string(name) + " must be followed by a macro name", set);
            return Diagram::none();
        }
        if (begin + 1 != end) pp_.findings.error(begin[1], std::string("unexpected tokens following ") + name, set);
        const Set defined = pp_.macros.defined_in(begin->text, set);
        evaluator_.note_definition_read(begin->text, set);
        return item.kind == Directive::ifdef ? defined : pp_.diagram.minus(set, defined);
    }
    const Evaluator::Outcome outcome = evaluator_.condition(at, begin, end, set);
    if (outcome.pieces != 0) count_states(outcome.pieces, outcome.holds);
    if (outcome.too_many) {
        split_sets_.push_back(outcome.holds);
        over_limit_ = true;
        kill(set);
    }
    // Variants without an answer are through with this file's conditionals; their mistake is reported.
    if (outcome.failed != Diagram::none()) dead_ = pp_.diagram.either(dead_, outcome.failed);
    return outcome.holds;
}

void Preprocessor::open_branch(Frame& frame, Set set) {
    frame.branch = set;
    frame.transparent = set == frame.outer;
    here_ = set;
    if (!frame.transparent && set != Diagram::none()) sequences_.emplace_back();
}

void Preprocessor::close_branch(Frame& frame) {
    if (frame.branch == Diagram::none()) return;
    if (!frame.transparent) {
        frame.done.emplace_back(frame.branch, std::move(sequences_.back()));
        sequences_.pop_back();
        frame.covered = pp_.diagram.either(frame.covered, frame.branch);
    }
    frame.branch = Diagram::none();
}

// Handles item `i`, a conditional directive, and returns the item to go on with.
size_t Preprocessor::conditional(const LexedFile& file, uint16_t index, size_t i) {
    const Item& item = file.items[i];
    const auto take = [&](Frame& frame, Set holds) {
        holds = pp_.diagram.minus(holds, dead_);
        const Set rest = pp_.diagram.minus(pp_.diagram.minus(frame.rest, holds), dead_);
        if (holds != Diagram::none() && rest != Diagram::none()) count_states(2, holds);
        frame.rest = rest;
        open_branch(frame, over_limit_ ? Diagram::none() : holds);
        return frame.branch == Diagram::none() ? size_t{item.next} : i + 1;
    };
    switch (item.kind) {
        case Directive::if_:
        case Directive::ifdef:
        case Directive::ifndef: {
            Frame frame;
            frame.outer = frame.rest = here_;
            frame.branch = Diagram::none();
            if (here_ == Diagram::none()) {
                frames_.push_back(std::move(frame));
                return item.next;
            }
            const Set holds = condition(item, file, index, here_);
            frames_.push_back(std::move(frame));
            return take(frames_.back(), holds);
        }
        case Directive::elif: {
            Frame& frame = frames_.back();
            close_branch(frame);
            here_ = Diagram::none();
            if (frame.rest == Diagram::none()) return item.next;
            const Set rest = frame.rest;
            const Set holds = condition(item, file, index, rest);
            return take(frames_.back(), holds);
        }
        case Directive::else_: {
            Frame& frame = frames_.back();
            close_branch(frame);
            const Set rest = pp_.diagram.minus(frame.rest, dead_);
            frame.rest = Diagram::none();
            here_ = Diagram::none();
            open_branch(frame, rest);
            return rest == Diagram::none() ? size_t{item.next} : i + 1;
        }
        default: {
            Frame& frame = frames_.back();
            close_branch(frame);
            if (!frame.done.empty()) {
                const Set rest = pp_.diagram.minus(frame.outer, frame.covered);
                if (rest != Diagram::none()) frame.done.emplace_back(rest, Emitted::Sequence());
                emitted_.choose(out(), std::move(frame.done));
                if (emitted_.over_limit()) over_limit_ = true;
            }
            here_ = over_limit_ ? Diagram::none() : pp_.diagram.minus(frame.outer, dead_);
            frames_.pop_back();
            return i + 1;
        }
    }
}

void Preprocessor::text_run(const LexedFile& file, const Item& item, bool root_end) {
    const Token* at = file.tokens.data() + item.begin;
    const Token* const end = file.tokens.data() + item.end;
    const Expander::Ends ends = root_end ? Expander::Ends::at_end : Expander::Ends::at_directive;
    while (at != end && here_ != Diagram::none()) {
        if (at->kind == Tok::hash) {
            pp_.findings.error(*at, "'#' : a directive cannot be preceded by another token", here_);
            kill(here_);
            return;
        }
        const bool special =
            at->text == spelling::line_macro || at->text == spelling::file_macro || at->text == spelling::version_macro;
        if (at->kind == Tok::identifier && (special || pp_.macros.known(at->text)))
            at = invocation(at, end, ends);
        else
            emitted_.put(out(), *at++);
    }
}

// Reads one token of text, with all that comes of it when it is a macro. False: stopped by a disagreement, nothing done.
// Where the variants cannot go on, `at` becomes null.
bool Preprocessor::step(Set set, const Token*& at, const Token* end, Expander::Ends ends, std::vector<Token>& out,
                        Disagreement& why) {
    Expander expander(pp_, set, at, end, ends);
    const size_t before = out.size();
    do {
        Token token = expander.paste(expander.scan());
        if (expander.stopped()) break;
        if (token.kind == Tok::end) break;
        if (token.kind == Tok::hash) {
            expander.die(token, "'#' : a directive cannot be preceded by another token");
            break;
        }
        if (token.kind == Tok::identifier) {
            const Expander::Result result = expander.expand(token, false);
            if (result == Expander::Result::failed) {
                if (!expander.stopped()) {
                    at = nullptr;  // reported
                    return true;
                }
                break;
            }
            if (result == Expander::Result::started) continue;
        }
        token.flags = 0;
        out.push_back(token);
    } while (!expander.drained());
    if (expander.disagreement().kind != Disagreement::nothing) {
        out.resize(before);
        why = expander.disagreement();
        return false;
    }
    at = expander.dead() ? nullptr : expander.position();
    return true;
}

const Token* Preprocessor::invocation(const Token* at, const Token* end, Expander::Ends ends) {
    struct Part {
        Set set;
        const Token* at;
        std::vector<Token> out;
    };
    std::vector<Part> todo{{here_, at, {}}}, parts;
    while (!todo.empty() && !over_limit_) {
        Part part = std::move(todo.back());
        todo.pop_back();
        Disagreement why;
        if (step(part.set, part.at, end, ends, part.out, why)) {
            parts.push_back(std::move(part));
        } else {
            const std::vector<Set> sets = pp_.split(why, part.set);
            for (size_t i = sets.size(); i-- > 0;) todo.push_back({sets[i], part.at, part.out});
            count_states(sets.size(), sets.front());
        }
        if (!todo.empty()) continue;
        // Parts that a call took further than others wait for them.
        const Token* furthest = nullptr;
        for (const Part& p : parts)
            if (p.at != nullptr && (furthest == nullptr || p.at > furthest)) furthest = p.at;
        const auto behind =
            std::stable_partition(parts.begin(), parts.end(), [&](const Part& p) { return p.at == nullptr || p.at == furthest; });
        std::move(behind, parts.end(), std::back_inserter(todo));
        parts.erase(behind, parts.end());
    }
    if (over_limit_) return end;
    if (parts.size() == 1 && parts.front().at != nullptr) {
        emitted_.put(out(), parts.front().out);
        return parts.front().at;
    }
    const Token* next = end;
    std::vector<std::pair<Set, Emitted::Sequence>> alternatives;
    for (const Part& p : parts) {
        if (p.at == nullptr)
            kill(p.set);
        else
            next = p.at;
        Emitted::Sequence sequence;
        emitted_.put(sequence, p.out);
        alternatives.emplace_back(p.set, std::move(sequence));
    }
    emitted_.choose(out(), std::move(alternatives));
    if (emitted_.over_limit()) over_limit_ = true;
    return next;
}

}  // namespace kiln
