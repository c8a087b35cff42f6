#pragma once
// Rule expressions (grammar: ARCHITECTURE.md, Manifests and scenes) as a flat tree: children come before their parent, the root
// is last, so that neither walking nor destroying a long expression recurses.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/manifest/axis.h"

namespace kiln {

enum class Op : uint8_t {
    literal,
    axis,
    negate,
    conjunction,
    disjunction,
    implies,
    equal,
    unequal,
    less,
    less_equal,
    greater,
    greater_equal,
    in
};

struct ExprNode {
    Op op = Op::literal;
    int32_t number = 0;          // literal
    uint32_t axis = 0;           // axis: index into the axes the expression was parsed against
    std::vector<uint32_t> args;  // indices of children; `in`: first is the operand, the rest are literals
    uint32_t offset = 0;         // byte offset in the expression's text
};

struct Expr {
    std::vector<ExprNode> nodes;
    std::vector<uint32_t> axes;  // the distinct axes read, ascending
};

// Where a parse failed: byte offset into the text.
struct ExprError {
    uint32_t offset = 0;
    std::string message;           // with the nearest right name where a name is unknown
    std::optional<uint32_t> axis;  // of a name that is not one of this axis's values
};

inline constexpr size_t expr_size_limit = 64 * 1024;  // bytes
inline constexpr unsigned expr_level_limit = 1000;    // open parentheses and negations at once

// Resolves names against `axes`: beside a comparison's axis, an identifier is first a value name of that axis, then an axis.
// A bare axis means "number is not zero". The first mistake is the one reported.
std::variant<Expr, ExprError> parse_expr(std::string_view text, const std::vector<Axis>& axes);

// True when the expression holds for these macro numbers (one per axis). The slow oracle for the diagram.
bool evaluate(const Expr& expr, const std::vector<int32_t>& numbers);

struct ParsedInteger {
    int32_t number = 0;
    const char* problem = nullptr;  // why the text is not a 32-bit integer; null when it is
};

// Decimal or 0x, with '-' for negative ones; no '+', no leading zeros.
ParsedInteger parse_integer(std::string_view text);

// " (did you mean 'light'?)"; when no candidate is near and they are few, " (known: light, pass)"; else nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace kiln
