#pragma once
// Macro expansion for one set of variants at a time. Where a name means different things within the set, expansion stops and
// says what to split by; the caller splits and starts that invocation anew for each part.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "compiler/split/findings.h"
#include "compiler/split/macros.h"

namespace kiln {

// What the variants of a set disagree about.
struct Disagreement {
    enum Kind : uint8_t { nothing, macro, axis, line } kind = nothing;
    uint32_t id = 0;  // macro: spelling; axis: index
};

// Where the text being read believes to be, which #line changes; it may differ between variants.
struct LogicalPlace {
    Set set;
    int64_t shift = 0;  // logical line = physical line + shift
    uint32_t file = 0;  // spelling of what __FILE__ becomes
};

// What every part of the preprocessor shares.
struct Preprocessing {
    Space& space;
    Diagram& diagram;
    Spellings& spellings;
    Macros& macros;
    Findings& findings;
    int version = 110;
    bool es = false;
    std::vector<LogicalPlace> places;            // of the file being read; the sets partition the variants
    std::map<uint32_t, uint32_t> axis_of_macro;  // spelling -> axis
    std::vector<bool> axes_read;
    uint64_t work = 0;  // tokens scanned
    size_t depth = 0;   // calls and parentheses open now, over everything nested

    static constexpr uint64_t max_work = 16'000'000;
    static constexpr size_t max_depth = 400;  // nested macro calls, parentheses in #if

    // The digit that an axis has all over `set`, or nothing when it has several.
    std::optional<uint32_t> digit_of(uint32_t axis, Set set);
    // The parts of `set` that agree.
    std::vector<Set> split(const Disagreement& by, Set set);
};

class Expander {
public:
    enum class Ends : uint8_t { at_directive, at_end, at_newline };
    enum class Result : uint8_t { not_expanded, failed, started, undefined };
    // Called in an #if for a name with several meanings, or an axis: may turn the token into a symbol.
    using MakeSymbol = std::function<bool(Token&)>;

    Expander(Preprocessing& pp, Set set, const Token* begin, const Token* end, Ends ends, MakeSymbol make_symbol = {});
    Expander(const Expander&) = delete;
    Expander& operator=(const Expander&) = delete;
    ~Expander();

    Token scan();
    Token paste(Token token);  // joins the token with what follows it over ##
    Result expand(Token& token, bool undefined_is_zero);
    // True once everything pushed by expansions was read.
    bool drained();
    const Token* position() const { return at_; }
    const Disagreement& disagreement() const { return disagreement_; }
    bool stopped() const { return disagreement_.kind != Disagreement::nothing || dead_; }
    // A mistake after which nothing more can be read.
    bool dead() const { return dead_; }
    void die(const Token& at, const std::string& message);
    Set set() const { return set_; }

private:
    enum class Source : uint8_t { macro, tokens, marker, single };
    struct Input {
        Source source = Source::single;
        const Token* at = nullptr;
        const Token* end = nullptr;
        uint32_t name = 0;
        uint32_t def = 0;
        bool before_paste = false, after_paste = false, last_pastes = false;
        Token token;  // single: the token; macro: where it was called
        std::vector<std::vector<Token>> arguments, expanded;
        std::vector<bool> has_expanded;
    };
    bool scan_macro(Token& out);
    void pop();
    bool about_to_paste() const;
    bool continues_paste(Tok kind) const;
    bool end_of_body() const {
        return inputs_.empty() || (inputs_.back().source == Source::macro && inputs_.back().at == inputs_.back().end);
    }
    bool collect(Input& in, Token& token, const Token& name);
    bool expand_argument(const std::vector<Token>& argument, std::vector<Token>& out);
    void push_single(const Token& token);
    void disagree(Disagreement::Kind kind, uint32_t id);
    void error(const Token& at, const std::string& message) {
        if (!stopped()) pp_.findings.error(at, message, set_);
    }

    Preprocessing& pp_;
    Set set_;
    const Token* at_;
    const Token* end_;
    const Token* last_ = nullptr;  // the source token read last
    Ends ends_;
    MakeSymbol make_symbol_;
    std::vector<Input> inputs_;
    Disagreement disagreement_;
    bool dead_ = false;
};

}  // namespace kiln
