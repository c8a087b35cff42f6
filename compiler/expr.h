#pragma once
// Rule expressions (grammar: DESIGN section 6) as a flat tree: children come before their parent, the root is last, so
// that neither walking nor destroying a long expression recurses.

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/axis.h"

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
    std::string message;  // with the nearest right name where a name is unknown
};

// Resolves names against `axes`: beside a comparison's axis, an identifier is first a value name of that axis, then an axis.
// A bare axis means "number is not zero". At most 64 KiB of text and 1,000 levels of nesting.
std::variant<Expr, ExprError> parse_expr(std::string_view text, const std::vector<Axis>& axes);

// True when the expression holds for these macro numbers (one per axis). The slow oracle for the diagram.
bool evaluate(const Expr& expr, const std::vector<int32_t>& numbers);

}  // namespace kiln
