#pragma once
// Evaluates the expression of an #if, #elif or #line for a set of variants at once.

#include <map>
#include <optional>
#include <vector>

#include "compiler/split/expand.h"
#include "compiler/split/guarded.h"

namespace kiln {

class Evaluator {
public:
    // `undefined_is_zero`: an identifier that nothing defines counts as 0 instead of being an error.
    Evaluator(Preprocessing& pp, bool undefined_is_zero, size_t limit)
        : pp_(pp), undefined_is_zero_(undefined_is_zero), limit_(limit) {}

    // The whole line as one expression over `set`, which must not be empty. The sets where the line itself reads
    // differently are evaluated one by one and put together; `pieces` counts them.
    struct Outcome {
        Set holds = Diagram::none();
        Set failed = Diagram::none();
        uint64_t pieces = 0;
        bool too_many = false;  // more combinations of values than `limit`
    };
    Outcome condition(const Token& at, const Token* begin, const Token* end, Set set);
    // One expression at the front of a line whose names all mean one thing over `set`; false when they do not (see
    // `disagreement`).
    bool leading(const Token& at, const Token* begin, const Token* end, Set set, Guarded& value, std::vector<Token>& rest,
                 Disagreement& disagreement);
    bool failed() const { return failed_; }  // the last `leading` had no value
    // Asking whether a name is defined, for #ifdef.
    void note_definition_read(uint32_t name, Set set);

private:
    struct Undefined {
        Token at;
        Set set;
    };
    struct Symbol {
        uint32_t name = 0;
        bool several = false;  // the name has several meanings
        Guarded value;
        std::vector<Undefined> undefined;
    };
    // Evaluation of one line, or of one macro body standing for an operand.
    class Run;
    struct Reading {
        Guarded value;
        bool failed = false;
        Disagreement disagreement;
        bool dead = false;
        std::vector<Undefined> undefined;
        std::vector<Token> rest;
    };
    Reading read(const Token& at, const Token* begin, const Token* end, Set set, Set live, bool whole);
    bool symbol_for(Token& token, Set set);
    bool can_stand_for_text(uint32_t name, size_t& budget) const;
    void report(const std::vector<Undefined>& undefined);

    Preprocessing& pp_;
    bool undefined_is_zero_;
    size_t limit_;
    bool too_many_ = false, failed_ = false;
    std::vector<Symbol> symbols_;
    std::map<std::pair<uint32_t, Set>, uint32_t> memo_;  // (macro, set) -> symbol
    uint64_t memo_generation_ = ~uint64_t{0};
    Disagreement inner_;  // what stopped the evaluation of a symbol
};

}  // namespace kiln
