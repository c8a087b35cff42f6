#include "compiler/validate/partner.h"

#include <algorithm>

#include "compiler/validate/inputs.h"

namespace kiln {

namespace {

bool is_floating(BaseType t) { return t == BaseType::float32 || t == BaseType::float16 || t == BaseType::float64; }
bool is_signed(BaseType t) { return t == BaseType::int32 || t == BaseType::int16 || t == BaseType::int8; }

// The GLSL type without array dimensions.
std::string type_name(const ValueType& t) {
    const bool f = is_floating(t.base), d = t.base == BaseType::float64, i = is_signed(t.base);
    if (t.columns > 1)
        return std::string(d ? "dmat" : "mat") + std::to_string(unsigned{t.columns}) + "x" + std::to_string(unsigned{t.rows});
    if (t.rows == 1) return d ? "double" : f ? "float" : i ? "int" : "uint";
    return std::string(d ? "dvec" : f ? "vec" : i ? "ivec" : "uvec") + std::to_string(unsigned{t.rows});
}

std::string dimensions(const ValueType& t) {
    std::string out;
    for (const uint32_t dim : t.array) out += "[" + std::to_string(std::max(1u, dim)) + "]";
    return out;
}

uint32_t elements(const ValueType& t) {
    uint32_t n = 1;
    for (const uint32_t dim : t.array) n = std::min(64u, n * std::max(1u, dim));
    return n;
}

// "[1][2]" for the i-th element.
std::string subscript(const ValueType& t, uint32_t i) {
    std::string out;
    for (size_t d = t.array.size(); d-- > 0;) {
        const uint32_t dim = std::max(1u, t.array[d]);
        out = "[" + std::to_string(i % dim) + "]" + out;
        i /= dim;
    }
    return out;
}

std::string declaration(const Varying& v, const char* direction, size_t number, bool flat) {
    std::string out = "layout(location = " + std::to_string(v.location);
    if (v.component != 0) out += ", component = " + std::to_string(v.component);
    out += ") ";
    if (flat)
        out += "flat ";
    else if (v.no_perspective)
        out += "noperspective ";
    return out + direction + " " + type_name(v.type) + " v" + std::to_string(number) + dimensions(v.type) + ";\n";
}

// 16-bit varyings need a feature that few devices have, and there are no 64-bit attachments.
bool can_be_shown(const Varying& v) { return v.type.base != BaseType::float16 && v.type.base != BaseType::float64; }

}  // namespace

std::string vertex_partner(const std::vector<Varying>& inputs) {
    std::string out = "#version 450\n", body;
    uint32_t seed = 1;
    for (size_t i = 0; i < inputs.size(); ++i) {
        const Varying& v = inputs[i];
        out += declaration(v, "out", i, !is_floating(v.type.base) || v.type.base == BaseType::float64);
        const std::string type = type_name(v.type);
        for (uint32_t e = 0; e < elements(v.type); ++e) {
            body += "    v" + std::to_string(i) + subscript(v.type, e) + " = " + type + "(";
            const unsigned n = unsigned{v.type.rows} * v.type.columns;
            for (unsigned c = 0; c < n; ++c, ++seed) {
                if (c != 0) body += ", ";
                body += is_floating(v.type.base) ? "wave(p, " + std::to_string(seed) + ".0)"
                                                 : "(gl_VertexIndex / 6 + " + std::to_string(seed) + ") & 3";
            }
            body += ");\n";
        }
    }
    out +=
        "float wave(vec2 p, float n) {\n"
        "    float s = sin(6.28 * fract(n * 0.61803) + (0.5 + fract(n * 0.41421)) * p.x + (0.5 + fract(n * 0.73205)) * p.y);\n"
        "    return gl_InstanceIndex == 0 ? 0.55 + 0.45 * s : s;\n"
        "}\n"
        "void main() {\n"
        "    const int xs[12] = int[12](0, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 1);\n"
        "    const int ys[12] = int[12](0, 0, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1);\n";
    const std::string side = std::to_string(grid_cells);
    out +=
        "    int cell = gl_VertexIndex / 6;\n"
        "    int x = cell % " +
        side + ", y = cell / " + side +
        ", k = gl_VertexIndex % 6 + 6 * ((x + y) & 1);\n"
        "    vec2 p = vec2(x + xs[k], y + ys[k]) * (2.0 / " +
        side +
        ".0) - 1.0;\n"
        "    gl_Position = vec4(p, 0.5 + 0.2 * p.x, 1.0);\n";
    return out + body + "}\n";
}

std::vector<Varying> fragment_partner_outputs(const std::vector<Varying>& outputs, uint32_t attachments) {
    std::vector<Varying> out;
    for (const Varying& v : outputs) {
        if (!can_be_shown(v)) continue;
        for (uint32_t i = 0; i < elements(v.type) * v.type.columns && out.size() < attachments; ++i) {
            Varying shown;
            shown.name = "o" + std::to_string(out.size());
            shown.location = static_cast<uint32_t>(out.size());
            shown.type.base = v.type.base;
            shown.type.rows = v.type.rows;
            out.push_back(std::move(shown));
        }
    }
    return out;
}

std::string fragment_partner(const std::vector<Varying>& outputs, uint32_t attachments) {
    const std::vector<Varying> written = fragment_partner_outputs(outputs, attachments);
    std::string inputs, targets, body;
    size_t next = 0;
    for (size_t i = 0; i < outputs.size() && next < written.size(); ++i) {
        const Varying& v = outputs[i];
        if (!can_be_shown(v)) continue;
        inputs += declaration(v, "in", i, !is_floating(v.type.base));
        for (uint32_t e = 0; e < elements(v.type); ++e)
            for (unsigned c = 0; c < v.type.columns && next < written.size(); ++c, ++next) {
                const Varying& o = written[next];
                targets +=
                    "layout(location = " + std::to_string(o.location) + ") out " + type_name(o.type) + " " + o.name + ";\n";
                body += "    " + o.name + " = v" + std::to_string(i) + subscript(v.type, e);
                if (v.type.columns > 1) body += "[" + std::to_string(c) + "]";
                body += ";\n";
            }
    }
    return "#version 450\n" + inputs + targets + "void main() {\n" + body + "}\n";
}

}  // namespace kiln
