#pragma once
// One term of a condition: some values of one axis, in the rules' grammar.

#include <optional>
#include <string>
#include <vector>

#include "compiler/manifest/axis.h"

namespace kiln {

struct Term {
    std::vector<bool> digits;  // that it allows
    std::string text;          // empty: it allows all
    unsigned cost = 0;         // terms it counts as; two for a range with both ends
};

// The shortest term that allows every digit of `must` and none outside `may` (which contains `must`); none when it would
// need a list of more than six values.
std::optional<Term> shortest_term(const Axis& axis, const std::vector<bool>& must, const std::vector<bool>& may);

}  // namespace kiln
