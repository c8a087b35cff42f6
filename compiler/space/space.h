#pragma once
// One shader's variants: what is declared, what the rules leave, what the scenes need. Digits index the *shader's* axes.

#include <memory>
#include <string>
#include <vector>

#include "compiler/manifest/manifest.h"
#include "compiler/space/diagram.h"

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

// Compiles the rules. A rule that grows the diagram past its limit is an error in `diags` that names the rules that grow it,
// and the result is null. Warnings are lint()'s business.
std::unique_ptr<Space> build_space(const Manifest& manifest, const Shader& shader, Diags& diags,
                                   size_t node_limit = Diagram::default_node_limit);

// The set in which an expression over the space's axes holds.
Set compile_expr(Space& space, const Expr& expr);

// Warnings with places: a value that no shader can ever have, a rule that excludes nothing or is implied by all the others
// (in every shader that has it); an error when the rules leave nothing, naming a smallest set of rules that clash. Null
// spaces are passed over. Work is bounded: where more than 16 rules hang together by their axes and their number times the
// nodes of the legal set passes 50 million, or where the search itself passes 2 million nodes, implied rules of that shader
// are not looked for and a note says so.
void lint(const Manifest& manifest, std::vector<std::unique_ptr<Space>>& spaces, Diags& diags);

}  // namespace kiln
