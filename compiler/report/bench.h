#pragma once
// Where the report's shaders run: once with everything checked, or many times against the clock.

#include "compiler/report/kernel.h"

namespace kiln::report {

struct Draw {
    uint32_t width = 0, height = 0, loops = 1, seed = 0;
    uint32_t groups = 1;
    size_t results = 0;                          // floats
    const std::vector<float>* points = nullptr;  // binding 1
};

struct Timed {
    double jit_ms = 0;       // what the first dispatch took beyond a later one of its size: the driver compiles the shader then
    std::vector<double> ms;  // of the dispatches that were measured, in order
};

class Bench {
public:
    virtual ~Bench() = default;
    virtual const DeviceInfo& info() const = 0;
    // The results of one dispatch with the validation layer on.
    virtual Result<std::vector<float>> run(const Kernel& kernel, const std::vector<Resource>& resources, const Draw& draw) = 0;
    // Loops, from draw.loops on, are chosen so that a dispatch takes at least `least_ms`, and come back in draw.loops. The
    // validation layer is off.
    virtual Result<Timed> time(const Kernel& kernel, const std::vector<Resource>& resources, Draw& draw, unsigned repeats,
                               double least_ms) = 0;
    // Compiles and runs text of a bake: results[i] for i < draw.results. Bindings as kernel_text() says.
    virtual Result<std::vector<float>> bake(const std::string& text, const std::vector<Resource>& resources,
                                            const Draw& draw) = 0;
};

}  // namespace kiln::report
