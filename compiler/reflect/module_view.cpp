// One forward walk. Decorations and names come before what they decorate, so records are made on first mention; ids that
// only live inside functions get one only when something at module scope names them.

#include "compiler/reflect/module_view.h"

#include <algorithm>

#include "compiler/reflect/spirv_enums.h"

namespace kiln::ir {

const Decorations& View::member_marks(uint32_t type_id, uint32_t member) const {
    static const Decorations empty;
    const auto& all = global(type_id).member_marks;
    return member < all.size() ? all[member] : empty;
}

const std::string& View::member_name(uint32_t type_id, uint32_t member) const {
    static const std::string empty;
    const auto& all = global(type_id).member_names;
    return member < all.size() ? all[member] : empty;
}

namespace {

constexpr uint32_t max_members = 16383;  // of a structure, the universal limit

void apply(Decorations& marks, uint32_t decoration, uint32_t value) {
    switch (decoration) {
        case dec_relaxed:
            marks.relaxed = true;
            break;
        case dec_spec_id:
            marks.spec_id = value;
            break;
        case dec_block:
            marks.block = true;
            break;
        case dec_buffer_block:
            marks.buffer_block = true;
            break;
        case dec_row_major:
            marks.row_major = true;
            break;
        case dec_array_stride:
            marks.array_stride = value;
            break;
        case dec_matrix_stride:
            marks.matrix_stride = value;
            break;
        case dec_builtin:
            marks.builtin = value;
            break;
        case dec_no_perspective:
            marks.no_perspective = true;
            break;
        case dec_flat:
            marks.flat = true;
            break;
        case dec_patch:
            marks.patch = true;
            break;
        case dec_per_vertex:
            marks.per_vertex = true;
            break;
        case dec_centroid:
            marks.centroid = true;
            break;
        case dec_sample:
            marks.sample = true;
            break;
        case dec_non_writable:
            marks.non_writable = true;
            break;
        case dec_non_readable:
            marks.non_readable = true;
            break;
        case dec_location:
            marks.location = value;
            break;
        case dec_component:
            marks.component = value;
            break;
        case dec_index:
            marks.index = value;
            break;
        case dec_binding:
            marks.binding = value;
            break;
        case dec_descriptor_set:
            marks.set = value;
            break;
        case dec_offset:
            marks.offset = value;
            break;
        case dec_input_attachment_index:
            marks.input_attachment = value;
            break;
        default:
            break;
    }
}

}  // namespace

class Reader {
public:
    explicit Reader(WordView words) { view_.words = words; }

    Result<View> run() {
        const WordView w = view_.words;
        if (w.size() < 5 || w[0] != magic) return input_error("not a SPIR-V module");
        view_.version = w[1];
        view_.bound = w[3];
        if (view_.bound == 0 || view_.bound > max_bound) return input_error("SPIR-V id bound out of range");
        view_.slots_.assign(view_.bound, 0);
        for (size_t at = 5; at < w.size();) {
            const uint32_t length = w[at] >> 16;
            if (length == 0 || length > w.size() - at) return input_error("SPIR-V instruction runs past the end");
            take({static_cast<uint16_t>(w[at] & 0xffff), static_cast<uint32_t>(at)}, w.subspan(at, length));
            if (!problem_.empty()) return input_error("SPIR-V: " + problem_);
            at += length;
        }
        if (entries_ != 1) return input_error("SPIR-V: one entry point expected, " + std::to_string(entries_) + " found");
        return std::move(view_);
    }

private:
    Global& at(uint32_t id) {
        if (id == 0 || id >= view_.bound) {
            problem_ = "id out of bounds";
            return scratch_ = {};
        }
        uint32_t& slot = view_.slots_[id];
        if (slot == 0) {
            slot = static_cast<uint32_t>(view_.globals_.size());
            view_.globals_.emplace_back();
        }
        return view_.globals_[slot];
    }

    std::string text(WordView w, size_t from, size_t* after = nullptr) {
        std::string out;
        for (size_t i = from; i < w.size(); ++i)
            for (unsigned shift = 0; shift < 32; shift += 8) {
                const char c = static_cast<char>(w[i] >> shift & 0xff);
                if (c == 0) {
                    if (after) *after = i + 1;
                    return out;
                }
                out += c;
            }
        problem_ = "a string without an end";
        return {};
    }

    void take(Instruction i, WordView w) {
        if (in_body_ || i.op == op_function) {
            in_body_ = true;
            view_.body.push_back(i);
            return;
        }
        const auto has = [&](size_t n) {
            if (w.size() >= n) return true;
            problem_ = "an instruction is too short";
            return false;
        };
        switch (i.op) {
            case op_capability:
                if (has(2)) view_.capabilities.push_back(w[1]);
                return;
            case op_extension:
                view_.extensions.push_back(text(w, 1));
                return;
            case op_ext_inst_import:
                if (has(3)) {
                    const std::string set = text(w, 2);
                    if (set == "GLSL.std.450") view_.glsl_set = w[1];
                    if (set == "NonSemantic.DebugPrintf") view_.imports_debug_printf = true;
                }
                return;
            case op_entry_point: {
                if (!has(4)) return;
                ++entries_;
                view_.model = w[1];
                view_.entry_id = w[2];
                size_t after = w.size();
                view_.entry = text(w, 3, &after);
                view_.interface.assign(w.begin() + static_cast<ptrdiff_t>(after), w.end());
                return;
            }
            case op_execution_mode:
                if (!has(3)) return;
                if (w[2] == mode_depth_replacing) view_.depth_replacing = true;
                if (w[2] == mode_early_fragment_tests) view_.early_tests = true;
                if (w[2] == mode_invocations && has(4)) view_.invocations = w[3];
                if (w[2] == mode_local_size && has(6)) view_.workgroup = {w[3], w[4], w[5]};
                return;
            case op_name:
                if (has(3)) at(w[1]).name = text(w, 2);
                return;
            case op_member_name:
                if (has(4) && member(w[2])) {
                    auto& names = at(w[1]).member_names;
                    if (names.size() <= w[2]) names.resize(w[2] + 1);
                    names[w[2]] = text(w, 3);
                }
                return;
            case op_decorate:
                if (has(3)) apply(at(w[1]).marks, w[2], w.size() > 3 ? w[3] : 0);
                return;
            case op_member_decorate:
                if (has(4) && member(w[2])) {
                    auto& marks = at(w[1]).member_marks;
                    if (marks.size() <= w[2]) marks.resize(w[2] + 1);
                    apply(marks[w[2]], w[3], w.size() > 4 ? w[4] : 0);
                }
                return;
            default:
                break;
        }
        if (i.op >= op_type_void && i.op <= op_type_pointer) return take_type(i.op, w);
        if (i.op == op_type_acceleration_structure) return take_type(i.op, w);
        if (i.op >= op_constant_true && i.op <= op_spec_constant_op) return take_constant(i.op, w);
        if (i.op == op_variable && has(4)) {
            const Type& pointer = view_.type(w[1]);
            if (pointer.kind != Kind::pointer) {
                problem_ = "a variable whose type is no pointer";
                return;
            }
            view_.variables.push_back({w[2], w[1], pointer.element, w[3]});
            at(w[2]);
        }
    }

    bool member(uint32_t index) {
        if (index < max_members) return true;
        problem_ = "too many members";
        return false;
    }

    void take_type(uint16_t op, WordView w) {
        if (w.size() < 2) {
            problem_ = "an instruction is too short";
            return;
        }
        Type t;
        const auto need = [&](size_t n) {
            if (w.size() < n) problem_ = "an instruction is too short";
            return w.size() >= n;
        };
        // What a type is made of must be known already, so types form no cycle (but through pointers, which nobody follows
        // when measuring), and their nesting is bounded.
        unsigned depth = 1;
        const auto known = [&](uint32_t id) {
            const Kind kind = view_.type(id).kind;
            if (kind == Kind::other) {  // a pointer declared ahead, or nothing we model
                expected_pointers_.push_back(id);
                return;
            }
            depth = std::max(depth, 1 + depth_of(id));
        };
        switch (op) {
            case op_type_void:
                t.kind = Kind::void_;
                break;
            case op_type_bool:
                t.kind = Kind::boolean;
                break;
            case op_type_int:
                if (!need(4)) return;
                t.kind = Kind::integer, t.width = w[2], t.is_signed = w[3] != 0;
                break;
            case op_type_float:
                if (!need(3)) return;
                t.kind = Kind::floating, t.width = w[2];
                break;
            case op_type_vector:
            case op_type_matrix:
                if (!need(4)) return;
                t.kind = op == op_type_vector ? Kind::vector : Kind::matrix, t.element = w[2], t.count = w[3];
                if (t.count < 2 || t.count > 4 || view_.type(t.element).kind == Kind::other)
                    problem_ = "a vector or matrix of an odd shape";
                known(t.element);
                break;
            case op_type_image:
                if (!need(9)) return;
                t.kind = Kind::image, t.element = w[2], t.dim = w[3], t.depth = w[4], t.arrayed = w[5] != 0;
                t.multisampled = w[6] != 0, t.sampled = w[7], t.format = w[8];
                break;
            case op_type_sampler:
                t.kind = Kind::sampler;
                break;
            case op_type_sampled_image:
                if (!need(3)) return;
                t.kind = Kind::sampled_image, t.element = w[2];
                break;
            case op_type_array: {
                if (!need(4)) return;
                const Constant& length = view_.global(w[3]).constant;
                t.kind = Kind::array, t.element = w[2], t.count = length.known ? length.words[0] : 1;
                t.spec_sized = length.spec;
                if (!length.known && !length.spec) problem_ = "an array whose length is no constant";
                if (t.count == 0) problem_ = "an array of nothing";
                known(t.element);
                break;
            }
            case op_type_runtime_array:
                if (!need(3)) return;
                t.kind = Kind::runtime_array, t.element = w[2];
                known(t.element);
                break;
            case op_type_struct:
                t.kind = Kind::structure, t.members.assign(w.begin() + 2, w.end());
                if (t.members.size() > max_members) problem_ = "too many members";
                for (const uint32_t m : t.members) known(m);
                break;
            case op_type_pointer:
                if (!need(4)) return;
                t.kind = Kind::pointer, t.count = w[2], t.element = w[3];
                break;
            case op_type_acceleration_structure:
                t.kind = Kind::acceleration_structure;
                break;
            default:
                break;
        }
        if (t.kind != Kind::pointer)
            for (const uint32_t id : expected_pointers_)
                if (id == w[1]) problem_ = "a type used before it is defined";
        if (depth > max_depth) problem_ = "types nested too deep";
        if (view_.type(w[1]).kind != Kind::other) problem_ = "a type defined twice";
        set_depth(w[1], depth);
        at(w[1]).type = std::move(t);
    }

    void take_constant(uint16_t op, WordView w) {
        if (w.size() < 3) {
            problem_ = "an instruction is too short";
            return;
        }
        Constant c;
        c.type = w[1];
        c.spec = op >= op_spec_constant_true;
        c.words.assign(w.begin() + 3, w.end());
        if (op == op_spec_constant_op) c.words.clear();
        if ((op == op_constant || op == op_spec_constant) && !c.words.empty())
            c.known = view_.type(c.type).kind == Kind::integer && view_.type(c.type).width <= 32;
        Global& g = at(w[2]);
        g.constant = std::move(c);
        if (g.marks.builtin == builtin_workgroup_size && g.constant.words.size() == 3)
            for (size_t d = 0; d < 3; ++d) {
                const Constant& part = view_.global(view_.global(w[2]).constant.words[d]).constant;
                if (part.known) view_.workgroup[d] = part.words[0];
            }
    }

    unsigned depth_of(uint32_t id) const { return id < depths_.size() ? depths_[id] : 0; }
    void set_depth(uint32_t id, unsigned depth) {
        if (id >= view_.bound) return;
        if (depths_.size() <= id) depths_.resize(id + 1, 0);
        depths_[id] = static_cast<uint8_t>(std::min(depth, 255U));
    }

    View view_;
    Global scratch_;
    std::string problem_;
    std::vector<uint8_t> depths_;  // of types, by id
    std::vector<uint32_t> expected_pointers_;
    unsigned entries_ = 0;
    bool in_body_ = false;
};

Result<View> read_view(WordView words) { return Reader(words).run(); }

}  // namespace kiln::ir
