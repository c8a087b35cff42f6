#pragma once
// A source file as preprocessing tokens, lexed once. Lines are grouped into items: a directive, or a run of text lines
// between directives. Conditional directives know their next sibling, so skipping a group is one step.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/split/spellings.h"

namespace kiln {

enum class Tok : uint8_t {
    end,     // of the input; what follows is told by whoever asks
    marker,  // end of a macro argument being expanded
    hash,    // '#' where no directive can be, or the start of the next directive
    identifier,
    integer,  // decimal, octal or hexadecimal without suffix: the only kind that an #if may use
    number,   // any other literal number
    string,   // with its quotes; in #include also <name>
    op,       // operators and single characters
    paste,    // '##' in a macro body
    line,     // a whole #version, #extension or #pragma line
    symbol,   // a guarded value standing for an operand of #if
};

struct Token {
    uint32_t text = 0;  // spelling; for `symbol` an index into the evaluator's values
    uint32_t line = 0;
    uint32_t column = 0;
    uint16_t file = 0;
    Tok kind = Tok::end;
    uint8_t flags = 0;
    static constexpr uint8_t spaced = 1;      // white space or a comment stands before it
    static constexpr uint8_t line_fixed = 4;  // __LINE__ in a macro argument: `line` is its value's line
    static constexpr uint8_t from_body = 2;   // came straight out of a macro's replacement list
};

enum class Directive : uint8_t {
    text,  // not a directive: a run of text
    define,
    undef,
    if_,
    ifdef,
    ifndef,
    elif,
    else_,
    endif,
    include,
    line,
    pragma,
    error,
    version,
    extension,
    unknown,
    empty,
};

struct Item {
    Directive kind = Directive::text;
    uint32_t begin = 0, end = 0;          // tokens after the directive's name
    uint32_t line = 0, column = 0;        // of the '#', or of the first token
    uint32_t next = 0;                    // conditionals: index of the next sibling (#elif, #else, #endif)
    uint32_t depth = 0;                   // conditionals open around it in this file
    uint32_t raw_begin = 0, raw_end = 0;  // bytes of `clean` after the directive's name, trimmed
    uint32_t name = 0;                    // spelling of the directive's name
};

// A mistake that the lexer sees whoever reads the file, in skipped groups too.
struct LexProblem {
    uint32_t line = 0, column = 0;
    std::string message;
    uint32_t depth = 0;
    bool outside_conditionals = false;  // glslang only minds it where no conditional is open
};

struct LexedFile {
    std::string clean;  // newlines are '\n', line continuations removed
    std::vector<Token> tokens;
    std::vector<Item> items;
    std::vector<LexProblem> problems;
    bool continued = false;  // has a line continuation outside comments
    uint32_t continued_line = 0;
    uint32_t max_depth = 0;  // of conditionals
};

// `file` goes into every token. Never fails: what cannot be lexed is in `problems`.
LexedFile lex_file(std::string_view content, uint16_t file, Spellings& spellings);

// Lexes a macro body or another short text without directives.
std::vector<Token> lex_text(std::string_view content, uint16_t file, Spellings& spellings);

}  // namespace kiln
