#pragma once
// The set in which a rule expression holds, and how a rule falls apart into conditions that must all hold.

#include <vector>

#include "compiler/manifest/expr.h"
#include "compiler/space/diagram.h"
#include "compiler/space/order.h"

namespace kiln {

// A part of an expression that must be true (or false, with `holds` unset).
struct Conjunct {
    uint32_t node = 0;  // into Expr::nodes
    bool holds = true;
};

// The expression holds (or, with `holds` unset, fails) exactly when all of these do. In the order written.
std::vector<Conjunct> conjuncts(const Expr& expr, bool holds);

// The distinct axes below a node, ascending.
std::vector<uint32_t> axes_below(const Expr& expr, uint32_t node);

// The part below a node as a circuit: appends its gates. Chains of one operator are one gate.
void collect_gates(const Expr& expr, uint32_t node, size_t axes, std::vector<Gate>& gates);

// The set in which the part holds. `axes` are those of the diagram, and those the expression was parsed against.
Set set_of(Diagram& diagram, const std::vector<Axis>& axes, const Expr& expr, uint32_t node);
Set set_of(Diagram& diagram, const std::vector<Axis>& axes, const Expr& expr, Conjunct part);

}  // namespace kiln
