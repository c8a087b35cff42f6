#pragma once
// The words of rule expressions. Only expr.cpp includes it.

#include <string_view>

#include "compiler/manifest/expr.h"

namespace kiln {

enum class TokenKind : uint8_t { end, name, integer, open, close, open_brace, close_brace, comma, op, bang, bad };

struct ExprToken {
    TokenKind kind = TokenKind::end;
    Op op = Op::literal;  // of TokenKind::op
    std::string_view text;
    uint32_t offset = 0;
    int32_t number = 0;             // of TokenKind::integer
    const char* problem = nullptr;  // of TokenKind::bad
};

// Never fails: what is no word is a token that says what is wrong. After the last it gives `end` for ever.
class ExprLexer {
public:
    explicit ExprLexer(std::string_view text) : text_(text) {}
    ExprToken next();

private:
    ExprToken take(ExprToken token, size_t length);
    ExprToken integer(ExprToken token);
    size_t name_length() const;

    std::string_view text_;
    size_t at_ = 0;
};

}  // namespace kiln
