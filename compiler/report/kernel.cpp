#include "compiler/report/kernel.h"

#include <algorithm>
#include <sstream>

namespace kiln::report {

namespace {

size_t components(const std::string& type) { return type == "float" ? 1 : static_cast<size_t>(type.back() - '0'); }

std::string line_at(const std::string& text, uint32_t number) {
    std::istringstream in(text);
    std::string line;
    for (uint32_t i = 0; i < number && std::getline(in, line); ++i) {
    }
    return line;
}

const char* const common = R"(
uint hash(uint x) {
    x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; x *= 0x846ca68bu; x ^= x >> 16;
    return x;
}
float unit(uint x) { return float(x >> 8) * (1.0 / 16777216.0); }
)";

}  // namespace

Result<std::string> Library::expanded(const std::string& text) {
    std::string out;
    std::vector<std::string> given;
    KILN_TRY(append(out, text, given));
    return out;
}

Status Library::append(std::string& out, const std::string& text, std::vector<std::string>& given) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        const size_t begin = line.find("#include \"");
        if (begin == std::string::npos || line.find_first_not_of(" \t") != begin) {
            out += line + "\n";
            continue;
        }
        const size_t name_begin = begin + 10;
        const std::string name = line.substr(name_begin, line.find('"', name_begin) - name_begin);
        if (std::find(given.begin(), given.end(), name) != given.end()) continue;
        given.push_back(name);
        if (known_.find(name) == known_.end()) {
            const auto read = files_.read(join_path(folder_, name));
            if (!read.ok()) return read.error();
            if (!read->has_value()) return input_error("no " + name + " in the GLSL library " + folder_);
            known_[name] = **read;
        }
        KILN_TRY(append(out, known_[name], given));
    }
    return {};
}

size_t floats_of(const std::vector<Field>& fields) {
    size_t n = 0;
    for (const Field& f : fields) n += components(f.type);
    return n;
}

namespace {

std::string head(const std::vector<Resource>& resources, bool points) {
    // The extension only lets a member say float16_t.
    std::string t = "#version 450\n#extension GL_EXT_shader_explicit_arithmetic_types_float16 : enable\nlayout(local_size_x = " +
                    std::to_string(group_size) + ") in;\n";
    t += "layout(push_constant) uniform Draw { uvec4 kiln_draw; };\n";
    t += "layout(std430, set = 0, binding = 0) buffer Results { float kiln_results[]; };\n";
    if (points) t += "layout(std430, set = 0, binding = 1) readonly buffer Given { float kiln_points[]; };\n";
    for (size_t i = 0; i < resources.size(); ++i) {
        const bool block = resources[i].declaration.find('{') != std::string::npos;
        const char* const layout = !block ? "" : resources[i].declaration.starts_with("uniform") ? "std140, " : "std430, ";
        t += std::string("layout(") + layout + "set = 0, binding = " + std::to_string(i + 2) + ") " + resources[i].declaration +
             ";\n";
    }
    return t + common;
}

}  // namespace

std::string bake_text(const std::vector<Resource>& resources, const std::string& functions) {
    return head(resources, false) + functions +
           "\nvoid main() {\n    const uint i = gl_GlobalInvocationID.x;\n    if (i >= kiln_draw.x * kiln_draw.y) return;\n"
           "    const vec4 c = texel(i);\n"
           "    for (uint k = 0u; k < 4u; ++k) kiln_results[4u * i + k] = c[k];\n}\n";
}

std::string kernel_text(Job job, const std::vector<Field>& fields, const std::vector<Resource>& resources,
                        const std::string& scene, const std::string& member) {
    const size_t stride = floats_of(fields);
    std::string t = head(resources, job == Job::picture);
    t += "struct Point {";
    for (const Field& f : fields) t += " " + f.type + " " + f.name + ";";
    t += " };\n";
    t += scene + "\n";
    if (job == Job::picture || job == Job::timing) t += member + "\n";
    if (job == Job::baseline || job == Job::timing) {
        t += "float kiln_total(Point p) { return 0.0";
        for (const Field& f : fields)
            t += components(f.type) == 1 ? " + p." + f.name : " + dot(p." + f.name + ", " + f.type + "(1.0))";
        t += "; }\n";
    }
    t += "void main() {\n    const uint i = gl_GlobalInvocationID.x;\n";
    const std::string guard = "    if (i >= kiln_draw.x * kiln_draw.y) return;\n";
    const std::string where = "    const vec2 u = (vec2(i % kiln_draw.x, i / kiln_draw.x) + 0.5) / vec2(kiln_draw.xy);\n";
    if (job == Job::points) {
        t += guard + where + "    const Point p = point_at(u);\n";
        size_t at = 0;
        for (const Field& f : fields)
            for (size_t c = 0; c < components(f.type); ++c, ++at)
                t += "    kiln_results[i * " + std::to_string(stride) + " + " + std::to_string(at) + "] = p." + f.name +
                     (components(f.type) == 1 ? "" : std::string("[") + std::to_string(c) + "]") + ";\n";
    } else if (job == Job::picture) {
        t += guard + "    Point p;\n";
        size_t at = 0;
        for (const Field& f : fields)
            for (size_t c = 0; c < components(f.type); ++c, ++at)
                t += "    p." + f.name + (components(f.type) == 1 ? "" : std::string("[") + std::to_string(c) + "]") +
                     " = kiln_points[i * " + std::to_string(stride) + " + " + std::to_string(at) + "];\n";
        t += "    const vec3 c = shade(p);\n";
        for (int c = 0; c < 3; ++c) t += "    kiln_results[i * 3 + " + std::to_string(c) + "] = c[" + std::to_string(c) + "];\n";
    } else {
        // Both loops use all of every point, so that neither leaves out what only the other needs.
        // A patch of 16 x n neighbouring pixels, moved about the picture as a whole: lanes stay neighbours, as in a real draw.
        t += "    const vec2 first = (vec2(i % 16u, i / 16u) + 0.5) / vec2(kiln_draw.xy);\n"
             "    float sum = 0.0;\n"
             "    for (uint k = 0u; k < kiln_draw.z; ++k) {\n"
             "        const uint a = k + kiln_draw.w;\n"
             "        const Point p = point_at(fract(first + vec2(unit(a * 3242174889u), unit(a * 2447445414u))));\n"
             "        float total = kiln_total(p);\n";
        if (job == Job::timing) t += "        const vec3 c = shade(p);\n        total += c.x + c.y + c.z;\n";
        t += "        sum += total;\n    }\n    kiln_results[i] = sum;\n";
    }
    return t + "}\n";
}

uint64_t count_operations(WordView words) {
    constexpr uint32_t function = 54, function_end = 56, function_parameter = 55, label = 248, variable = 59, line = 8,
                       no_line = 317, merge_loop = 246, merge_selection = 247;
    uint64_t n = 0;
    bool inside = false;
    for (size_t i = 5; i < words.size();) {
        const uint32_t op = words[i] & 0xffffu, length = words[i] >> 16;
        if (length == 0) break;
        if (op == function) inside = true;
        if (op == function_end) inside = false;
        if (inside && op != function && op != function_parameter && op != label && op != variable && op != line &&
            op != no_line && op != merge_loop && op != merge_selection)
            ++n;
        i += length;
    }
    return n;
}

Result<Kernel> compile_kernel(const std::string& text, Toolchain& tools) {
    Options options;
    options.undefined_macros = UndefinedMacros::zero;
    const Compiled compiled = tools.compile(Stage::compute, text, options);
    if (compiled.words.empty()) {
        std::string why = "a shader of the report does not compile";
        for (const ToolMessage& m : compiled.messages)
            why += "\n  " + std::to_string(m.line) + ": " + m.text + "\n    " + line_at(text, m.line);
        return input_error(why);
    }
    auto pruned = tools.prune(compiled.words, options);
    KILN_TRY(pruned);
    auto words = tools.optimise(*pruned, options);
    KILN_TRY(words);
    auto reflection = tools.reflect(*words);
    KILN_TRY(reflection);
    Kernel out;
    out.bytes = words->size() * 4;
    out.operations = count_operations(*words);
    out.code.stage = Stage::compute;
    out.code.words = std::move(*words);
    out.code.reflection = std::move(*reflection);
    return out;
}

}  // namespace kiln::report
