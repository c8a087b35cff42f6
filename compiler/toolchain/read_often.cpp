// Follows what SPIRV-Cross's writer counts in its first round, in which it names nothing: a read is an operand, two where the
// reader stands in a deeper loop than the result. Loads, chains, extractions and shuffles are always written where they are
// read, so they are not named here.

#include "compiler/toolchain/read_often.h"

#include <algorithm>

#include "compiler/toolchain/spirv_operands.h"

namespace kiln {
namespace {

enum Opcode : uint16_t {
    op_ext_inst = 12,
    op_type_vector = 23,
    op_function = 54,
    op_vector_shuffle = 79,
    op_composite_construct = 80,
    op_image_sample_first = 87,
    op_image_query_last = 107,
    op_phi = 245,
    op_loop_merge = 246,
    op_label = 248,
    op_branch = 249,
};

constexpr uint32_t nowhere = ~0u;

bool may_be_named(uint16_t op) {
    return op == op_ext_inst || op == op_composite_construct || (op >= op_image_sample_first && op <= op_image_query_last) ||
           (op >= 109 && op <= 124) ||  // conversions
           (op >= 126 && op <= 205) ||  // arithmetic, comparison, bits
           (op >= 207 && op <= 215);    // derivatives
}

bool depends_on_control(uint16_t op) { return op == 87 || op == 89 || op == 91 || op == 93 || (op >= 207 && op <= 215); }

bool is_comparison(uint16_t op) { return op >= 170 && op <= 191; }

class Reads {
public:
    explicit Reads(WordView words) : words_(words) {}

    ReadOften often() {
        if (!read_operands(words_, parsed_)) return {};
        place();
        reads_.resize(words_[3]);
        by_component_.resize(words_[3]);
        for (uint32_t i = 0; i < parsed_.instructions.size(); ++i)
            if (block_of_[i] != nowhere) read(i);
        // Against the order of the text, so that every reader in the same block is known when its operands are asked.
        std::vector<bool> leaves(words_[3]);
        ReadOften out;
        for (uint32_t i = static_cast<uint32_t>(parsed_.instructions.size()); i-- > 0;) {
            const ParsedInstruction& in = parsed_.instructions[i];
            if (block_of_[i] == nowhere) continue;
            const bool own = in.result != 0 && leaves[in.result];
            each_operand(in, [&](uint32_t id) {
                if (in.op == op_phi || own || block_of_[defined_by_[id]] != block_of_[i]) leaves[id] = true;
            });
            if (in.result == 0 || !may_be_named(in.op)) continue;
            if (reads_[in.result] > 1 || (own && depends_on_control(in.op)))
                out.ids.push_back(in.result);
            else if (by_component_[in.result])
                out.by_component.push_back(in.result);
        }
        return out;
    }

private:
    // Blocks in the order of the text; a block lies in a loop when it stands between its header and its merge.
    void place() {
        const size_t count = parsed_.instructions.size();
        defined_by_.assign(words_[3] + size_t{1}, nowhere);
        block_of_.assign(count, nowhere);
        std::vector<uint32_t> block_named(words_[3], nowhere);
        std::vector<std::pair<uint32_t, uint32_t>> loops;  // block of the header, label of the merge
        uint32_t blocks = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const ParsedInstruction& in = parsed_.instructions[i];
            if (in.op == op_type_vector) vectors_.push_back(in.result);
            if (in.op == op_label) block_named[in.result] = blocks++;
            if (in.op == op_loop_merge) loops.emplace_back(blocks - 1, words_[in.at + 1]);
            if (blocks != 0 && in.op != op_label && in.op != op_function) block_of_[i] = blocks - 1;
            if (block_of_[i] != nowhere && in.result < words_[3]) defined_by_[in.result] = i;
        }
        defined_by_[0] = nowhere;
        depth_.resize(blocks + 1);
        for (const auto& [header, merge] : loops)
            for (uint32_t b = header; merge < words_[3] && b < std::min(block_named[merge], blocks); ++b) ++depth_[b];
    }

    template <class Visit>
    void each_operand(const ParsedInstruction& in, const Visit& visit) const {
        if (in.op >= op_loop_merge && in.op <= op_branch) return;
        for (uint32_t k = 0; k < in.ids; ++k) {
            const uint32_t word = parsed_.id_words[in.first_id + k], id = words_[word];
            if (id == in.result || (in.result != 0 && k < 2) || id >= words_[3] || defined_by_[id] == nowhere) continue;
            visit(id);
        }
    }

    void read(uint32_t i) {
        const ParsedInstruction& in = parsed_.instructions[i];
        const bool vectors =
            is_comparison(in.op) && std::find(vectors_.begin(), vectors_.end(), words_[in.at + 1]) != vectors_.end();
        // One text for both operands of a swizzle, and for all of a splat.
        const bool once = in.op == op_vector_shuffle || (in.op == op_composite_construct && is_splat(in));
        uint32_t last = 0;
        each_operand(in, [&](uint32_t id) {
            if (once && id == last) return;
            last = id;
            const bool deeper = depth_[block_of_[i]] > depth_[block_of_[defined_by_[id]]];
            reads_[id] += deeper ? 2 : 1;
            if (vectors) by_component_[id] = true;
        });
    }

    bool is_splat(const ParsedInstruction& in) const {
        for (uint32_t word = in.at + 4; word < in.at + in.length; ++word)
            if (words_[word] != words_[in.at + 3]) return false;
        return true;
    }

    const WordView words_;
    ParsedModule parsed_;
    std::vector<uint32_t> defined_by_;  // result -> instruction, inside functions
    std::vector<uint32_t> block_of_;    // instruction -> block
    std::vector<uint32_t> depth_;       // block -> loops around it
    std::vector<uint32_t> vectors_;     // types
    std::vector<uint32_t> reads_;       // result -> so often
    std::vector<bool> by_component_;    // result -> in a comparison of vectors
};

}  // namespace

ReadOften find_read_often(WordView words) { return Reads(words).often(); }

}  // namespace kiln
