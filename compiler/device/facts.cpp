#include "compiler/device/facts.h"

namespace kiln {

namespace {
// Numbers of the SPIR-V specification, revision 1.6.
constexpr uint32_t op_execution_mode = 16, op_decorate = 71;
constexpr uint32_t mode_input_points = 19, mode_input_lines = 20, mode_input_lines_adjacency = 21, mode_triangles = 22,
                   mode_triangles_adjacency = 23, mode_output_vertices = 26;
constexpr uint32_t decoration_binding = 33, decoration_set = 34, decoration_input_attachment_index = 43;
}  // namespace

ModuleFacts facts_of(WordView words) {
    ModuleFacts out;
    std::map<uint32_t, uint32_t> set, binding, index;
    for (size_t at = 5; at < words.size();) {
        const uint32_t op = words[at] & 0xffff;
        const size_t length = words[at] >> 16;
        if (length == 0 || length > words.size() - at) break;
        if (op == op_execution_mode && length >= 3) {
            switch (words[at + 2]) {
                case mode_input_points:
                    out.input_vertices = 1;
                    break;
                case mode_input_lines:
                    out.input_vertices = 2;
                    break;
                case mode_triangles:
                    out.input_vertices = 3;
                    break;
                case mode_input_lines_adjacency:
                    out.input_vertices = 4;
                    break;
                case mode_triangles_adjacency:
                    out.input_vertices = 6;
                    break;
                case mode_output_vertices:
                    if (length >= 4) out.output_vertices = words[at + 3];
                    break;
                default:
                    break;
            }
        }
        if (op == op_decorate && length >= 4) {
            if (words[at + 2] == decoration_binding) binding[words[at + 1]] = words[at + 3];
            if (words[at + 2] == decoration_set) set[words[at + 1]] = words[at + 3];
            if (words[at + 2] == decoration_input_attachment_index) index[words[at + 1]] = words[at + 3];
        }
        at += length;
    }
    for (const auto& [id, number] : index) out.input_attachment_index[{set[id], binding[id]}] = number;
    return out;
}

}  // namespace kiln
