#pragma once
// The seam to other machines: a step of the pass tells all of its questions before it looks into the store, and whoever
// stands behind this puts answers there, as many as it can. What it leaves out is answered here, so it can be slow or wrong only
// as a store can.

#include <span>
#include <string_view>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/toolchain/toolchain.h"

namespace kiln {

struct ModuleQuestion {
    Stage stage = Stage::vertex;
    Options options;
    std::string_view text;  // of the class
    Digest action;
};

struct ArtifactQuestion {
    WordView words;
    const SlotLayout* slots = nullptr;
    std::vector<Target> targets;
    std::vector<Digest> actions;  // one a target
};

class Elsewhere {
public:
    virtual ~Elsewhere() = default;
    virtual void modules(std::span<const ModuleQuestion> questions) = 0;
    virtual void artifacts(std::span<const ArtifactQuestion> questions) = 0;
};

}  // namespace kiln
