// The dumps as text for people.

#include "compiler/table/table_dump.h"

namespace kiln {

namespace {

const char* name_of(ResourceKind kind) {
    switch (kind) {
        case ResourceKind::uniform_block:
            return "uniform block";
        case ResourceKind::storage_block:
            return "storage block";
        case ResourceKind::combined_image:
            return "combined image";
        case ResourceKind::separate_image:
            return "image";
        case ResourceKind::separate_sampler:
            return "sampler";
        case ResourceKind::storage_image:
            return "storage image";
        case ResourceKind::uniform_texels:
            return "texel buffer";
        case ResourceKind::storage_texels:
            return "storage texel buffer";
        case ResourceKind::input_attachment:
            return "input attachment";
        case ResourceKind::acceleration_structure:
            return "acceleration structure";
        case ResourceKind::push_constants:
            return "push constants";
    }
    return "resource";
}

std::string say(const ValueType& type) {
    static const char* const names[] = {"float", "half",  "double", "int",  "uint",  "short", "ushort",
                                        "long",  "ulong", "bool",   "byte", "ubyte", "struct"};
    const auto base = static_cast<size_t>(type.base);
    std::string out = base < std::size(names) ? names[base] : "?";
    if (type.columns > 1)
        out += std::to_string(type.columns) + "x" + std::to_string(type.rows);
    else if (type.rows > 1)
        out += std::to_string(type.rows);
    for (const uint32_t n : type.array) out += "[" + (n == 0 ? std::string() : std::to_string(n)) + "]";
    return out;
}

std::string say(const Slot& slot) {
    std::string out = std::string(name_of(slot.kind)) + " " + slot.name;
    if (slot.kind != ResourceKind::push_constants)
        out += ": set " + std::to_string(slot.set) + " binding " + std::to_string(slot.binding);
    const std::pair<const char*, uint32_t> numbers[] = {{"buffer", slot.buffer},
                                                        {"texture", slot.texture},
                                                        {"sampler", slot.sampler},
                                                        {"image", slot.image},
                                                        {"uav", slot.uav},
                                                        {"metal buffer", slot.metal_buffer},
                                                        {"metal texture", slot.metal_texture}};
    for (const auto& [what, number] : numbers)
        if (number != 0) out += std::string(", ") + what + " " + std::to_string(number);
    return out;
}

std::string say(const Varying& v) {
    std::string out = v.name + ": " + say(v.type) + " at " + std::to_string(v.location);
    if (v.component != 0) out += "." + std::to_string(v.component);
    for (const auto& [set, what] :
         {std::pair(v.flat, " flat"), std::pair(v.no_perspective, " noperspective"), std::pair(v.centroid, " centroid"),
          std::pair(v.sample, " sample"), std::pair(v.patch, " patch")})
        if (set) out += what;
    return out;
}

// At most this many values of an axis are listed.
constexpr size_t values_shown = 16;

}  // namespace

std::string render(const TableDump& dump) {
    std::string out = dump.name + ": " + Count(dump.bytes).grouped() + " bytes, " + std::to_string(dump.modules) + " modules (" +
                      Count(dump.spirv_bytes).grouped() + " bytes of SPIR-V)";
    if (dump.text_bytes != 0)
        out += ", texts " + Count(dump.text_bytes).grouped() + " bytes in " + Count(dump.packed_bytes).grouped();
    out += "\n";
    for (const auto& [target, n] : dump.artifacts) {
        out += std::string("  ") + kiln::name_of(target) + ": " + std::to_string(n);
        if (const auto hole = dump.holes.find(target); hole != dump.holes.end())
            out += ", " + std::to_string(hole->second) + " that it cannot say";
        out += "\n";
    }
    for (const std::string& s : dump.scenes) out += "  scene " + s + "\n";
    for (const DumpShader& s : dump.shaders) {
        out += s.name + ": " + s.declared.grouped() + " declared, " + s.legal.grouped() + " legal, " + s.needed.grouped() +
               " needed, " + std::to_string(s.pipelines) + " pipelines\n";
        for (const DumpAxis& a : s.axes) {
            out += "  axis " + a.name + " (" + a.macro + "):";
            for (size_t v = 0; v < a.values.size() && v < values_shown; ++v)
                out += " " + a.values[v].name + " " + a.values[v].needed.grouped() + (v + 1 < a.values.size() ? "," : "");
            if (a.values.size() > values_shown) out += " and " + std::to_string(a.values.size() - values_shown) + " more";
            out += "\n";
        }
        for (const DumpStage& stage : s.stages) {
            out += std::string("  ") + kiln::name_of(stage.stage) + ": " + std::to_string(stage.modules) + " modules, " +
                   Count(stage.spirv_bytes).grouped() + " bytes";
            for (size_t i = 0; i < stage.axes.size(); ++i) out += (i == 0 ? ", decided by " : ", ") + stage.axes[i];
            out += "\n";
        }
        for (const std::string& rule : s.rules) out += "  " + rule + "\n";
        for (const Slot& slot : s.slots.slots) out += "  " + say(slot) + "\n";
    }
    out += "tools: " + dump.tools + "\n";
    return out;
}

std::string render(const VariantDump& dump) {
    std::string out = dump.shader + ": " + dump.selected.grouped() + (dump.selected == Count(1) ? " variant, " : " variants, ") +
                      dump.legal.grouped() + " legal, " + dump.needed.grouped() + " needed\n";
    for (const auto& [stage, modules] : dump.stages)
        for (const DumpModule& m : modules) {
            out += std::string(kiln::name_of(stage)) + ": module " + std::to_string(m.module) + ", " + m.digest.substr(0, 16) +
                   ", " + Count(m.bytes).grouped() + " bytes, " + m.shared + "\n";
            const auto& group = m.reflection.workgroup;
            if (group[0] != 0)
                out += "  workgroup " + std::to_string(group[0]) + " x " + std::to_string(group[1]) + " x " +
                       std::to_string(group[2]) + "\n";
            for (const Slot& slot : m.uses) out += "  " + say(slot) + "\n";
            for (const Resource& r : m.reflection.resources)
                for (const Member& member : r.members)
                    out += "    " + r.name + "." + member.name + ": " + say(member.type) + " at " +
                           std::to_string(member.offset) + "\n";
            for (const Varying& v : m.reflection.inputs) out += "  in " + say(v) + "\n";
            for (const Varying& v : m.reflection.outputs) out += "  out " + say(v) + "\n";
            for (const TableText& t : m.texts)
                out += std::string("  ") + kiln::name_of(t.target) + ": " +
                       (t.artifact ? Count(t.size).grouped() + " bytes" : "none: " + t.refusal) + "\n";
        }
    return out;
}

}  // namespace kiln
