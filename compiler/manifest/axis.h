#pragma once
// One dimension of permutation: a macro and its values.

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/base/diag.h"

namespace kiln {

enum class AxisKind : uint8_t {  // on disk: append only
    named = 0,                   // names with numbers
    integer = 1,                 // integers, name and number at once
    boolean = 2,                 // false 0, true 1
    defined = 3,                 // false: macro not defined (0 in arithmetic), true: defined as 1
};

struct AxisValue {
    std::string name;  // of an integer: its decimal form, however it was written
    int32_t number = 0;
    uint32_t line = 0, column = 0;  // where it is written, in the file of Axis::place; 0 for the two values of bool and defined
    friend bool operator==(const AxisValue& a, const AxisValue& b) { return a.name == b.name && a.number == b.number; }
};

// A *digit* is an index into `values`; a *number* is what the macro expands to.
struct Axis {
    std::string name;
    std::string macro;
    AxisKind kind = AxisKind::named;
    std::vector<AxisValue> values;
    Place place;              // of the axis's name
    std::string source_line;  // the line that `place` points into
};

using Digits = std::vector<uint32_t>;  // one digit per axis of a space, in the order of the shader's axes

}  // namespace kiln
