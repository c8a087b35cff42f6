// Varyings are compared component by component, because that is how both Vulkan and hardware count: a vec4 written may be read
// as two vec2 with components 0 and 2. GL's rule by name follows from it after renaming.

#include "compiler/interfaces/mismatch.h"

#include <algorithm>
#include <map>
#include <set>

namespace kiln {
namespace {

bool is_wide(BaseType base) { return base == BaseType::float64 || base == BaseType::int64 || base == BaseType::uint64; }

using Cell = std::tuple<uint32_t, uint32_t, uint32_t>;  // location, component, index

// The components that a varying takes, at most `limit` of them.
std::vector<Cell> cells_of(const Varying& v) {
    constexpr size_t limit = 4096;
    uint64_t elements = v.type.columns;
    for (const uint32_t length : v.type.array) elements = std::min<uint64_t>(elements * std::max(length, 1U), limit);
    const uint32_t words = v.type.rows * (is_wide(v.type.base) ? 2U : 1U);
    std::vector<Cell> out;
    uint32_t location = v.location;
    for (uint64_t e = 0; e < elements; ++e) {
        for (uint32_t w = 0; w < words && out.size() < limit; ++w)
            out.emplace_back(location + (v.component + w) / 4, (v.component + w) % 4, v.index);
        location += (v.component + words + 3) / 4;
    }
    return out;
}

std::string at(const Varying& v) {
    std::string out = "'" + v.name + "' (location " + std::to_string(v.location);
    if (v.component != 0) out += ", component " + std::to_string(v.component);
    return out + ")";
}

const char* base_name(BaseType base) {
    switch (base) {
        case BaseType::float32:
            return "float";
        case BaseType::float16:
            return "float16_t";
        case BaseType::float64:
            return "double";
        case BaseType::int32:
            return "int";
        case BaseType::uint32:
            return "uint";
        case BaseType::int16:
            return "int16_t";
        case BaseType::uint16:
            return "uint16_t";
        case BaseType::int64:
            return "int64_t";
        case BaseType::uint64:
            return "uint64_t";
        case BaseType::boolean:
            return "bool";
        case BaseType::int8:
            return "int8_t";
        case BaseType::uint8:
            return "uint8_t";
        case BaseType::structure:
            return "struct";
    }
    return "";
}

const char* vector_prefix(BaseType base) {
    switch (base) {
        case BaseType::float32:
            return "";
        case BaseType::float16:
            return "f16";
        case BaseType::float64:
            return "d";
        case BaseType::int32:
            return "i";
        case BaseType::uint32:
            return "u";
        case BaseType::int16:
            return "i16";
        case BaseType::uint16:
            return "u16";
        case BaseType::int64:
            return "i64";
        case BaseType::uint64:
            return "u64";
        case BaseType::boolean:
            return "b";
        case BaseType::int8:
            return "i8";
        case BaseType::uint8:
            return "u8";
        case BaseType::structure:
            return "";
    }
    return "";
}

bool is_block(ResourceKind kind) {
    return kind == ResourceKind::uniform_block || kind == ResourceKind::storage_block || kind == ResourceKind::push_constants;
}

}  // namespace

std::string type_name(const ValueType& type) {
    std::string out;
    if (type.columns > 1) {
        out = std::string(vector_prefix(type.base)) + "mat" + std::to_string(type.columns);
        if (type.rows != type.columns) out += "x" + std::to_string(type.rows);
    } else if (type.rows > 1) {
        out = std::string(vector_prefix(type.base)) + "vec" + std::to_string(type.rows);
    } else {
        out = base_name(type.base);
    }
    for (const uint32_t length : type.array) out += length == 0 ? "[]" : "[" + std::to_string(length) + "]";
    return out;
}

std::vector<Mismatch> match_varyings(const Reflection& writer, const Reflection& reader) {
    std::map<Cell, const Varying*> written;
    for (const Varying& v : writer.outputs)
        for (const Cell& cell : cells_of(v)) written.emplace(cell, &v);
    const std::string writes = std::string("the ") + name_of(writer.stage) + " stage writes ";
    std::vector<Mismatch> out;
    for (const Varying& in : reader.inputs) {
        const std::string reads = std::string(name_of(reader.stage)) + " input " + at(in);
        const std::vector<Cell> cells = cells_of(in);
        size_t found = 0;
        const Varying* other = nullptr;
        const Varying* partner = nullptr;
        for (const Cell& cell : cells) {
            const auto hit = written.find(cell);
            if (hit == written.end()) continue;
            ++found;
            if (!partner) partner = hit->second;
            if (hit->second->type.base != in.type.base || hit->second->patch != in.patch) other = hit->second;
        }
        if (found == 0) {
            out.push_back({Severity::error, reads + " is not written by the " + name_of(writer.stage) + " stage"});
        } else if (other && other->patch != in.patch) {
            out.push_back({Severity::error, reads + (in.patch ? " is" : " is not") + " per patch, but " + writes + at(*other) +
                                                (other->patch ? " per patch" : " per vertex")});
        } else if (other) {
            out.push_back({Severity::error, reads + " is " + type_name(in.type) + ", but " + writes + at(*other) + " as " +
                                                type_name(other->type)});
        } else if (found < cells.size()) {
            out.push_back({Severity::error, reads + " is " + type_name(in.type) + ", but " + writes + at(*partner) + " as " +
                                                type_name(partner->type) + ", which is less"});
        } else if (partner->location == in.location && partner->component == in.component && partner->type.rows > in.type.rows &&
                   partner->type.columns == in.type.columns) {
            out.push_back({Severity::warning, reads + " is " + type_name(in.type) + ", but " + writes + at(*partner) + " as " +
                                                  type_name(partner->type) +
                                                  ": that takes VK_KHR_maintenance4, and GL and ESSL texts do not link"});
        }
    }
    return out;
}

std::vector<Mismatch> overlapping_varyings(const Reflection& stage) {
    std::set<Mismatch> out;
    const auto check = [&](const std::vector<Varying>& list, const char* what) {
        std::map<Cell, const Varying*> taken;
        for (const Varying& v : list)
            for (const Cell& cell : cells_of(v)) {
                const auto [there, fresh] = taken.emplace(cell, &v);
                if (!fresh && there->second != &v)
                    out.insert({Severity::error, std::string(name_of(stage.stage)) + " " + what + " " + at(*there->second) +
                                                     " and " + at(v) + " overlap"});
            }
    };
    check(stage.inputs, "inputs");
    check(stage.outputs, "outputs");
    return {out.begin(), out.end()};
}

std::string resource_words(const Resource& r) {
    switch (r.kind) {
        case ResourceKind::uniform_block:
            return "uniform block '" + r.name + "'";
        case ResourceKind::storage_block:
            return "storage block '" + r.name + "'";
        case ResourceKind::push_constants:
            return "push-constant block '" + r.name + "'";
        case ResourceKind::separate_sampler:
            return "sampler '" + r.name + "'";
        case ResourceKind::acceleration_structure:
            return "acceleration structure '" + r.name + "'";
        default:
            return image_words(r) + " '" + r.name + "'";
    }
}

std::string resource_place(const Resource& r) {
    if (r.kind == ResourceKind::push_constants) return "push constants";
    return "set " + std::to_string(r.set) + ", binding " + std::to_string(r.binding);
}

std::string image_words(const Resource& r) {
    std::string out;
    switch (r.sampled) {
        case BaseType::int32:
            out = "i";
            break;
        case BaseType::uint32:
            out = "u";
            break;
        case BaseType::int64:
            out = "i64";
            break;
        case BaseType::uint64:
            out = "u64";
            break;
        default:
            break;
    }
    switch (r.kind) {
        case ResourceKind::combined_image:
            out += "sampler";
            break;
        case ResourceKind::separate_image:
            out += "texture";
            break;
        case ResourceKind::storage_image:
            out += "image";
            break;
        case ResourceKind::uniform_texels:
            return out + "samplerBuffer";
        case ResourceKind::storage_texels:
            return out + "imageBuffer";
        case ResourceKind::input_attachment:
            return out + (r.multisampled ? "subpassInputMS" : "subpassInput");
        default:
            return {};
    }
    switch (r.dim) {
        case ImageDim::d1:
            out += "1D";
            break;
        case ImageDim::d2:
            out += "2D";
            break;
        case ImageDim::d3:
            out += "3D";
            break;
        case ImageDim::cube:
            out += "Cube";
            break;
        case ImageDim::rect:
            out += "2DRect";
            break;
        default:
            break;
    }
    if (r.multisampled) out += "MS";
    if (r.arrayed) out += "Array";
    if (r.kind == ResourceKind::combined_image && r.depth) out += "Shadow";
    return out;
}

std::string member_difference(const Resource& a, const Resource& b) {
    for (const Member& m : a.members)
        for (const Member& n : b.members) {
            if (m.name != n.name) continue;
            if (m.offset != n.offset)
                return "member '" + m.name + "' moves from " + std::to_string(m.offset) + " to " + std::to_string(n.offset);
            if (m.type != n.type) return "member '" + m.name + "' changes from " + type_name(m.type) + " to " + type_name(n.type);
            if (m.strides != n.strides || m.matrix_stride != n.matrix_stride || m.row_major != n.row_major)
                return "member '" + m.name + "' changes its stride or order";
        }
    return {};
}

std::vector<Mismatch> match_resources(const Reflection& a, const Reflection& b) {
    std::vector<Mismatch> out;
    const std::string in_a = std::string(" in the ") + name_of(a.stage) + " stage",
                      in_b = std::string(" in the ") + name_of(b.stage) + " stage";
    for (const Resource& x : a.resources)
        for (const Resource& y : b.resources) {
            const bool push = x.kind == ResourceKind::push_constants;
            if (push != (y.kind == ResourceKind::push_constants)) continue;
            if (!push && (x.set != y.set || x.binding != y.binding)) continue;
            const std::string clash =
                "resource clash at " + resource_place(x) + ": " + resource_words(x) + in_a + ", " + resource_words(y) + in_b;
            if (push) {
                for (const Member& m : x.members)
                    for (const Member& n : y.members) {
                        const bool overlap =
                            m.offset < n.offset + std::max(n.size, 1U) && n.offset < m.offset + std::max(m.size, 1U);
                        if (!overlap || (m.name == n.name && m.offset == n.offset && m.type == n.type)) continue;
                        out.push_back({Severity::error, "push constants disagree: '" + m.name + "' (" + type_name(m.type) +
                                                            " at " + std::to_string(m.offset) + ")" + in_a + ", '" + n.name +
                                                            "' (" + type_name(n.type) + " at " + std::to_string(n.offset) + ")" +
                                                            in_b});
                    }
                continue;
            }
            if (x.kind != y.kind) {
                out.push_back({Severity::error, clash});
            } else if (is_block(x.kind)) {
                const std::string difference = member_difference(x, y);
                if (!difference.empty())
                    out.push_back({Severity::error, clash + "; " + difference});
                else if (x.name != y.name)
                    out.push_back({x.members == y.members ? Severity::warning : Severity::error, clash});
            } else if (x.dim != y.dim || x.arrayed != y.arrayed || x.multisampled != y.multisampled || x.sampled != y.sampled ||
                       x.format != y.format) {
                out.push_back({Severity::error, clash});
            } else if (x.name != y.name) {
                out.push_back({Severity::warning, clash});
            }
        }
    return out;
}

}  // namespace kiln
