// Pruning comes before optimising because it is cheap and already merges nearly everything that will merge: variants differ
// mostly in functions that one of them never calls. Names go first, so that they cannot keep two equal modules apart.
//
// The list for `performance` is that of spirv-opt -O without the repetitions that change nothing on a pruned module, and without
// what every driver's compiler does again at no cost to the text: propagation through loops, unrolling, common expressions across
// blocks. On the 150 classes of uber/surface both leave 144 modules, of 1,795 and 1,814 words on average; this list takes
// 60 % of the time.

#include "compiler/toolchain/spirv.h"

#include <exception>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>

#include "compiler/toolchain/spirv_names.h"
#include "compiler/toolchain/spirv_operands.h"
#include "compiler/toolchain/spirv_reach.h"

namespace kiln {
namespace {

spv_target_env environment_of(const Options& options) {
    switch (options.vulkan) {
        case 0x100:
            return SPV_ENV_VULKAN_1_0;
        case 0x102:
            return SPV_ENV_VULKAN_1_2;
        case 0x103:
            return SPV_ENV_VULKAN_1_3;
        default:
            return options.spirv >= 0x104 ? SPV_ENV_VULKAN_1_1_SPIRV_1_4 : SPV_ENV_VULKAN_1_1;
    }
}

Severity severity_of(spv_message_level_t level) {
    switch (level) {
        case SPV_MSG_FATAL:
        case SPV_MSG_INTERNAL_ERROR:
        case SPV_MSG_ERROR:
            return Severity::error;
        case SPV_MSG_WARNING:
            return Severity::warning;
        default:
            return Severity::note;
    }
}

template <class Register>
Result<Words> run(const char* what, WordView words, const Options& options, const Register& register_passes) {
    try {
        spvtools::Optimizer optimizer(environment_of(options));
        std::string said;
        optimizer.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* text) {
            if (severity_of(level) == Severity::error && said.empty()) said = text;
        });
        register_passes(optimizer);
        spvtools::OptimizerOptions how;
        how.set_run_validator(false);
        Words out;
        if (optimizer.Run(words.data(), words.size(), &out, how)) return out;
        return environment_error(std::string("SPIRV-Tools failed to ") + what + " a module: " + said);
    } catch (const std::exception& problem) {
        return environment_error(std::string("SPIRV-Tools failed to ") + what + " a module: " + problem.what());
    }
}

void register_inlining(spvtools::Optimizer& o) {
    using namespace spvtools;
    o.RegisterPass(CreateWrapOpKillPass()).RegisterPass(CreateMergeReturnPass()).RegisterPass(CreateInlineExhaustivePass());
}

void register_lean(spvtools::Optimizer& o) {
    using namespace spvtools;
    o.RegisterPass(CreatePrivateToLocalPass())
        .RegisterPass(CreateScalarReplacementPass())
        .RegisterPass(CreateLocalSingleStoreElimPass())
        .RegisterPass(CreateLocalAccessChainConvertPass())
        .RegisterPass(CreateAggressiveDCEPass())
        .RegisterPass(CreateSSARewritePass())
        .RegisterPass(CreateSimplificationPass())
        .RegisterPass(CreateDeadBranchElimPass())
        .RegisterPass(CreateDeadInsertElimPass())
        .RegisterPass(CreateCopyPropagateArraysPass())
        .RegisterPass(CreateBlockMergePass())
        .RegisterPass(CreateLocalRedundancyEliminationPass())
        .RegisterPass(CreateAggressiveDCEPass())
        .RegisterPass(CreateCompactIdsPass());
}

// SPIRV-Tools folds instructions on cooperative matrices as if they were vectors, and crashes.
bool has_cooperative_matrices(WordView words) {
    constexpr uint32_t op_capability = 17, op_ext_inst_import = 11, nv = 5357, khr = 6022;
    for (size_t at = 5; at + 1 < words.size() && words[at] >> 16 != 0 && (words[at] & 0xFFFF) != op_ext_inst_import;
         at += words[at] >> 16)
        if ((words[at] & 0xFFFF) == op_capability && (words[at + 1] == nv || words[at + 1] == khr)) return true;
    return false;
}

bool is_id(spv_operand_type_t type) {
    switch (type) {
        case SPV_OPERAND_TYPE_ID:
        case SPV_OPERAND_TYPE_TYPE_ID:
        case SPV_OPERAND_TYPE_RESULT_ID:
        case SPV_OPERAND_TYPE_MEMORY_SEMANTICS_ID:
        case SPV_OPERAND_TYPE_SCOPE_ID:
            return true;
        default:
            return false;
    }
}

struct Parsing {
    const uint32_t* first;
    ParsedModule* out;
};

spv_result_t note_instruction(void* user, const spv_parsed_instruction_t* in) {
    const Parsing& parsing = *static_cast<const Parsing*>(user);
    ParsedModule& out = *parsing.out;
    const uint32_t at = static_cast<uint32_t>(in->words - parsing.first);
    const uint32_t first_id = static_cast<uint32_t>(out.id_words.size());
    for (uint16_t i = 0; i < in->num_operands; ++i)
        if (is_id(in->operands[i].type)) out.id_words.push_back(at + in->operands[i].offset);
    out.instructions.push_back(
        {at, in->opcode, in->num_words, in->result_id, first_id, static_cast<uint32_t>(out.id_words.size()) - first_id});
    return SPV_SUCCESS;
}

bool parse(WordView words, const Options& options, ParsedModule& out) {
    return read_operands(words, out) || spirv_parse(words, options, out);
}

std::vector<ToolMessage> validate(WordView words, const Options& options, bool friendly_names) {
    std::vector<ToolMessage> messages;
    try {
        spvtools::SpirvTools tools(environment_of(options));
        tools.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* text) {
            std::string line(text);
            for (char& c : line) c = c == '\n' ? ' ' : c;
            messages.push_back({severity_of(level), 0, std::move(line)});
        });
        spvtools::ValidatorOptions how;
        how.SetScalarBlockLayout(wants_scalar_layout(words));
        how.SetFriendlyNames(friendly_names);
        if (!tools.Validate(words.data(), words.size(), how) && messages.empty()) {
            messages.push_back({Severity::error, 0, "spirv-val refused the module without a reason"});
        }
    } catch (const std::exception& problem) {
        messages.push_back({Severity::error, 0, std::string("spirv-val failed: ") + problem.what()});
    }
    return messages;
}

}  // namespace

std::string spirv_version() { return spvSoftwareVersionDetailsString(); }

bool spirv_parse(WordView words, const Options& options, ParsedModule& out) {
    out.instructions.clear();
    out.id_words.clear();
    const spvtools::Context context(environment_of(options));
    Parsing parsing{words.data(), &out};
    return spvBinaryParse(context.CContext(), &parsing, words.data(), words.size(), nullptr, note_instruction, nullptr) ==
           SPV_SUCCESS;
}

Result<Words> spirv_prune(WordView words, const Options& options) {
    const auto passes = [](spvtools::Optimizer& o) {
        using namespace spvtools;
        // The second of these removes dead functions and constants as well.
        o.RegisterPass(CreateDeadBranchElimPass())
            .RegisterPass(CreateAggressiveDCEPass())
            .RegisterPass(CreateBlockMergePass())
            .RegisterPass(CreateCompactIdsPass());
    };
    if (options.debug) return run("prune", words, options, passes);
    Result<Words> bare = keep_interface_names(words);
    if (!bare.ok()) return bare;
    ParsedModule parsed;
    if (!parse(*bare, options, parsed)) return environment_error("SPIRV-Tools could not parse a module");
    if (has_constant_branch(*bare, parsed)) {
        bare = run("prune", *bare, options, passes);
        if (!bare.ok()) return bare;
        if (!parse(*bare, options, parsed)) return environment_error("SPIRV-Tools could not parse a module");
    }
    return keep_reached(*bare, parsed);
}

Result<Words> spirv_optimise(WordView words, const Options& options) {
    if (has_cooperative_matrices(words)) return Words(words.begin(), words.end());
    switch (options.optimise) {
        case Optimise::none:
            return Words(words.begin(), words.end());
        case Optimise::performance: {
            // Functions that were inlined everywhere are dropped here: SPIRV-Tools would take them apart word by word.
            Result<Words> flat = run("inline", words, options, register_inlining);
            ParsedModule parsed;
            if (flat.ok() && !options.debug && parse(*flat, options, parsed)) flat = keep_reached(*flat, parsed);
            return flat.ok() ? run("optimise", *flat, options, register_lean) : flat;
        }
        case Optimise::size:
            return run("optimise", words, options, [](spvtools::Optimizer& o) {
                o.RegisterSizePasses();
                o.RegisterPass(spvtools::CreateCompactIdsPass());
            });
    }
    return Words(words.begin(), words.end());
}

std::vector<ToolMessage> spirv_validate(WordView words, const Options& options) {
    // Names for messages cost a third of a validation, so only a module that has messages is asked again with them.
    std::vector<ToolMessage> messages = validate(words, options, false);
    return messages.empty() ? messages : validate(words, options, true);
}

Result<std::string> spirv_disassemble(WordView words) {
    try {
        spvtools::SpirvTools tools(SPV_ENV_UNIVERSAL_1_6);
        std::string text;
        if (tools.Disassemble(words.data(), words.size(), &text)) return text;
    } catch (const std::exception&) {
    }
    return environment_error("the words are no SPIR-V module");
}

}  // namespace kiln
