#pragma once
// What a function of uber/lib costs on the device, by the protocol of kiln report (compiler/report/bench.h): LLVM's optimiser
// on, no validation layer, one thread, warm-up left out, 30 repeats of at least 2 ms, the shortest of them, and an empty loop
// over the same arguments taken off. Nothing is asserted about a time.
//
// `test_functions --costs` prints one line a function in place of testing it:
//
//     KILN_COST <name> <ns an evaluation> <JIT ms> file=<file>
//
// An evaluation is of one invocation, the sum of the result's components included. Arguments are the random samples of the
// function's tests, another set every 8 evaluations; within those 8 they stay equal, but no compiler can know. JIT is what the
// driver takes to compile the whole shader, loop included.

#include "compiler/base/result.h"
#include "tests/functions/function.h"

namespace kiln::test {

struct CostShader {
    std::string functions;           // GLSL from #version on: files, textures, declarations
    std::vector<NamedImage> images;  // at bindings 2, 3, ...
    std::vector<bool> comparing;     // one an image
};

struct Cost {
    double ns = 0, jit_ms = 0;
};

// True once the program was asked for costs.
bool& costs_wanted();
Result<Cost> measure_cost(const FunctionTest& function, const CostShader& shader);

// The two loops, as text.
std::string cost_text(const FunctionTest& function, const CostShader& shader, bool baseline);

}  // namespace kiln::test
