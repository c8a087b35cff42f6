// SPIRV-Cross throws on most of what a target lacks, and that becomes a refusal by itself. Here is the rest: what it writes
// down silently although no compiler of that language accepts it.

#include "compiler/limits.h"

#include "compiler/edits.h"
#include "compiler/spirv_enums.h"

namespace kiln {

std::string target_limit(const ir::View& view, const Reflected& reflected, Target target) {
    const Language language = language_of(target);
    (void)reflected;
    for (const ir::Instruction& i : view.body) {
        switch (i.op) {
            case ir::op_iadd_carry:
                if (language == Language::hlsl) return "HLSL has no uaddCarry";
                break;
            case ir::op_isub_borrow:
                if (language == Language::hlsl) return "HLSL has no usubBorrow";
                break;
            case ir::op_umul_extended:
                if (language == Language::hlsl) return "HLSL has no umulExtended";
                break;
            case ir::op_smul_extended:
                if (language == Language::hlsl) return "HLSL has no imulExtended";
                break;
            default:
                break;
        }
    }
    return {};
}

}  // namespace kiln
