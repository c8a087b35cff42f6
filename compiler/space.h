#pragma once
// One shader's variants: what is declared, what the rules leave, what the scenes need. Digits index the *shader's* axes.

#include <memory>
#include <string>
#include <vector>

#include "compiler/diagram.h"
#include "compiler/manifest.h"

namespace kiln {

class Space {
public:
    std::string shader;
    std::vector<Axis> axes;            // the shader's, in the manifest's order
    std::vector<Rule> rules;           // expressions over `axes`
    std::unique_ptr<Diagram> diagram;  // its order is chosen from the rules: FORCE, then sifting under a budget
    Set legal;
    Set needed;  // subset of legal; equal to it without scenes

    Count declared() const;
    // "light=point pass=forward", axes in order.
    std::string describe_variant(const Digits& digits) const;
};

// Compiles the rules. Errors (a rule that grows the diagram past its limit) go to `diags`. Warnings are lint()'s business.
std::unique_ptr<Space> build_space(const Manifest& manifest, const Shader& shader, Diags& diags);

// The set in which an expression over the space's axes holds.
Set compile_expr(Space& space, const Expr& expr);

// Warnings with places: a value that can never occur, a rule implied by all the others; an error when the rules leave
// nothing, naming a smallest set of rules that clash.
void lint(const Manifest& manifest, std::vector<std::unique_ptr<Space>>& spaces, Diags& diags);

}  // namespace kiln
