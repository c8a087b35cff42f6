// A worklist over definitions: instructions inside a reached function are reached as a whole, everything else through the ids
// of what is reached. Names and decorations hang on their target and are looked at last.

#include "compiler/toolchain/spirv_reach.h"

namespace kiln {
namespace {

enum Opcode : uint16_t {
    op_source_extension = 4,
    op_name = 5,
    op_member_name = 6,
    op_extension = 10,
    op_memory_model = 14,
    op_entry_point = 15,
    op_execution_mode = 16,
    op_capability = 17,
    op_type_forward_pointer = 39,
    op_constant_true = 41,
    op_constant_false = 42,
    op_constant = 43,
    op_function = 54,
    op_function_end = 56,
    op_variable = 59,
    op_decorate = 71,
    op_member_decorate = 72,
    op_decoration_group = 73,
    op_branch_conditional = 250,
    op_switch = 251,
    op_execution_mode_id = 331,
    op_decorate_id = 332,
    op_decorate_string = 5632,
    op_member_decorate_string = 5633,
};

constexpr uint32_t storage_output = 3;
constexpr uint32_t nowhere = ~0u;

bool hangs_on_target(uint16_t op) {
    switch (op) {
        case op_name:
        case op_member_name:
        case op_type_forward_pointer:
        case op_decorate:
        case op_member_decorate:
        case op_decorate_id:
        case op_decorate_string:
        case op_member_decorate_string:
            return true;
        default:
            return false;
    }
}

bool is_root(uint16_t op) {
    switch (op) {
        case op_source_extension:  // tells which layout rules the source asked for
        case op_extension:
        case op_memory_model:
        case op_entry_point:
        case op_execution_mode:
        case op_execution_mode_id:
        case op_capability:
            return true;
        default:
            return false;
    }
}

std::vector<uint32_t> definitions(WordView words, const ParsedModule& parsed) {
    std::vector<uint32_t> defined_by(words[3], nowhere);
    for (uint32_t i = 0; i < parsed.instructions.size(); ++i)
        if (const uint32_t id = parsed.instructions[i].result; id != 0 && id < defined_by.size()) defined_by[id] = i;
    return defined_by;
}

class Reach {
public:
    Reach(WordView words, const ParsedModule& parsed)
        : words_(words), parsed_(parsed), defined_by_(definitions(words, parsed)), live_(parsed.instructions.size()) {}

    void run() {
        for (uint32_t i = 0; i < live_.size(); ++i) {
            const ParsedInstruction& in = parsed_.instructions[i];
            if (!is_root(in.op)) continue;
            live_[i] = true;
            if (in.op == op_entry_point)
                enter(in);
            else
                reach_ids(in);
        }
        close();
        // A decoration by ids may reach more, which others then hang on.
        for (bool more = true; more;) {
            more = false;
            for (uint32_t i = 0; i < live_.size(); ++i) {
                const ParsedInstruction& in = parsed_.instructions[i];
                if (live_[i] || !hangs_on_target(in.op) || !alive(words_[in.at + 1])) continue;
                live_[i] = more = true;
                reach_ids(in);
            }
            close();
        }
    }

    Words write() const {
        Words out(words_.begin(), words_.begin() + 5);
        out.reserve(words_.size());
        std::vector<uint32_t> number(words_[3]);
        uint32_t next = 1;
        const auto renumber = [&](uint32_t id) {
            if (id >= number.size()) return id;
            if (number[id] == 0) number[id] = next++;
            return number[id];
        };
        for (uint32_t i = 0; i < live_.size(); ++i) {
            if (!live_[i]) continue;
            const ParsedInstruction& in = parsed_.instructions[i];
            const size_t start = out.size();
            uint32_t copied = in.at;
            for (uint32_t k = 0; k < in.ids; ++k) {
                const uint32_t place = parsed_.id_words[in.first_id + k];
                out.insert(out.end(), words_.begin() + copied, words_.begin() + place);
                copied = place + 1;
                if (in.op == op_entry_point && k != 0 && !alive(words_[place])) continue;  // an input that is never read
                out.push_back(renumber(words_[place]));
            }
            out.insert(out.end(), words_.begin() + copied, words_.begin() + in.at + in.length);
            out[start] = static_cast<uint32_t>(out.size() - start) << 16 | in.op;
        }
        out[3] = next;
        return out;
    }

private:
    bool alive(uint32_t id) const { return id < defined_by_.size() && defined_by_[id] != nowhere && live_[defined_by_[id]]; }

    void reach(uint32_t id) {
        if (id >= defined_by_.size() || defined_by_[id] == nowhere || live_[defined_by_[id]]) return;
        live_[defined_by_[id]] = true;
        work_.push_back(defined_by_[id]);
    }

    void reach_ids(const ParsedInstruction& in) {
        for (uint32_t k = 0; k < in.ids; ++k) reach(words_[parsed_.id_words[in.first_id + k]]);
    }

    // Vulkan allows an output that nobody reads, but no input that nobody writes: outputs stay.
    void enter(const ParsedInstruction& in) {
        for (uint32_t k = 0; k < in.ids; ++k) {
            const uint32_t id = words_[parsed_.id_words[in.first_id + k]];
            if (k != 0 && id < defined_by_.size() && defined_by_[id] != nowhere) {
                const ParsedInstruction& variable = parsed_.instructions[defined_by_[id]];
                if (variable.op != op_variable || words_[variable.at + 3] != storage_output) continue;
            }
            reach(id);
        }
    }

    void close() {
        while (!work_.empty()) {
            const uint32_t i = work_.back();
            work_.pop_back();
            reach_ids(parsed_.instructions[i]);
            if (parsed_.instructions[i].op != op_function) continue;
            for (uint32_t k = i; k < live_.size(); ++k) {
                live_[k] = true;
                reach_ids(parsed_.instructions[k]);
                if (parsed_.instructions[k].op == op_function_end) break;
            }
        }
    }

    WordView words_;
    const ParsedModule& parsed_;
    std::vector<uint32_t> defined_by_;
    std::vector<bool> live_;
    std::vector<uint32_t> work_;
};

}  // namespace

bool has_constant_branch(WordView words, const ParsedModule& parsed) {
    const std::vector<uint32_t> defined_by = definitions(words, parsed);
    for (const ParsedInstruction& in : parsed.instructions) {
        if (in.op == op_decoration_group) return true;
        if (in.op != op_branch_conditional && in.op != op_switch) continue;
        const uint32_t id = words[in.at + 1];
        if (id >= defined_by.size() || defined_by[id] == nowhere) return true;
        const uint16_t op = parsed.instructions[defined_by[id]].op;
        if (op == op_constant_true || op == op_constant_false || op == op_constant) return true;
    }
    return false;
}

Words keep_reached(WordView words, const ParsedModule& parsed) {
    Reach reach(words, parsed);
    reach.run();
    return reach.write();
}

}  // namespace kiln
