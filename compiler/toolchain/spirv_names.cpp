// SPIRV-Tools' own strip removes every name, and a reader of the table finds blocks, members and samplers by theirs. So this
// is a filter over the instruction stream: one pass collects what the interface variables' types reach, one copies. Of the
// source information only GL_EXT_scalar_block_layout survives, since a validator must know of it.

#include "compiler/toolchain/spirv_names.h"

#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace kiln {
namespace {

enum Opcode : uint32_t {
    op_source_continued = 2,
    op_source = 3,
    op_source_extension = 4,
    op_name = 5,
    op_member_name = 6,
    op_string = 7,
    op_line = 8,
    op_ext_inst = 12,
    op_type_array = 28,
    op_type_runtime_array = 29,
    op_type_struct = 30,
    op_type_pointer = 32,
    op_spec_constant_true = 48,
    op_spec_constant_false = 49,
    op_spec_constant = 50,
    op_variable = 59,
    op_no_line = 317,
    op_module_processed = 330,
};

constexpr size_t header_words = 5;
constexpr uint32_t magic = 0x07230203;

struct Instruction {
    uint32_t op = 0;
    WordView words;  // the first one included
};

// Calls visit(instruction) for each; false when a length is zero or runs past the end.
template <class Visit>
bool each_instruction(WordView module, const Visit& visit) {
    if (module.size() < header_words || module[0] != magic) return false;
    for (size_t at = header_words; at < module.size();) {
        const size_t length = module[at] >> 16;
        if (length == 0 || length > module.size() - at) return false;
        visit(Instruction{module[at] & 0xffff, module.subspan(at, length)});
        at += length;
    }
    return true;
}

bool is_interface(uint32_t storage_class) {
    switch (storage_class) {
        case 0:     // UniformConstant
        case 1:     // Input
        case 2:     // Uniform
        case 3:     // Output
        case 9:     // PushConstant
        case 10:    // AtomicCounter
        case 12:    // StorageBuffer
        case 5328:  // CallableData
        case 5329:  // IncomingCallableData
        case 5338:  // RayPayload
        case 5339:  // HitAttribute
        case 5342:  // IncomingRayPayload
        case 5343:  // ShaderRecordBuffer
        case 5402:  // TaskPayloadWorkgroup
            return true;
        default:
            return false;
    }
}

struct Interface {
    std::unordered_map<uint32_t, std::vector<uint32_t>> parts;  // type -> the types it is made of
    std::unordered_set<uint32_t> named;                         // ids whose names stay
    std::unordered_set<uint32_t> strings;                       // operands of extended instructions
    std::vector<uint32_t> reached;                              // types still to walk

    void look_at(const Instruction& i) {
        const WordView w = i.words;
        switch (i.op) {
            case op_type_array:
            case op_type_runtime_array:
                if (w.size() >= 3) parts[w[1]] = {w[2]};
                break;
            case op_type_struct:
                if (w.size() >= 2) parts[w[1]].assign(w.begin() + 2, w.end());
                break;
            case op_type_pointer:
                if (w.size() >= 4) parts[w[1]] = {w[3]};
                break;
            case op_spec_constant_true:
            case op_spec_constant_false:
            case op_spec_constant:
                if (w.size() >= 3) named.insert(w[2]);
                break;
            case op_variable:
                if (w.size() >= 4 && is_interface(w[3])) {
                    named.insert(w[2]);
                    reached.push_back(w[1]);
                }
                break;
            case op_ext_inst:
                for (size_t k = 5; k < w.size(); ++k) strings.insert(w[k]);
                break;
            default:
                break;
        }
    }

    void close() {
        while (!reached.empty()) {
            const uint32_t type = reached.back();
            reached.pop_back();
            if (!named.insert(type).second) continue;
            const auto made_of = parts.find(type);
            if (made_of != parts.end()) reached.insert(reached.end(), made_of->second.begin(), made_of->second.end());
        }
    }
};

bool says_scalar_layout(WordView instruction) {
    const ByteView bytes = as_bytes(instruction.subspan(1));
    return as_text(bytes).substr(0, as_text(bytes).find('\0')) == "GL_EXT_scalar_block_layout";
}

bool stays(const Instruction& i, const Interface& interface) {
    switch (i.op) {
        case op_source:
        case op_source_continued:
        case op_line:
        case op_no_line:
        case op_module_processed:
            return false;
        case op_source_extension:
            return says_scalar_layout(i.words);
        case op_name:
        case op_member_name:
            return i.words.size() >= 2 && interface.named.count(i.words[1]) != 0;
        case op_string:
            return i.words.size() >= 2 && interface.strings.count(i.words[1]) != 0;
        default:
            return true;
    }
}

}  // namespace

Result<Words> keep_interface_names(WordView words) {
    Interface interface;
    if (!each_instruction(words, [&](const Instruction& i) { interface.look_at(i); })) {
        return environment_error("the SPIR-V words do not divide into instructions");
    }
    interface.close();
    Words out(words.begin(), words.begin() + header_words);
    out.reserve(words.size());
    each_instruction(words, [&](const Instruction& i) {
        if (stays(i, interface)) out.insert(out.end(), i.words.begin(), i.words.end());
    });
    return out;
}

bool wants_scalar_layout(WordView words) {
    bool wanted = false;
    each_instruction(words, [&](const Instruction& i) { wanted |= i.op == op_source_extension && says_scalar_layout(i.words); });
    return wanted;
}

}  // namespace kiln
