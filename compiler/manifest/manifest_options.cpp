#include "compiler/manifest/manifest_parts.h"

namespace kiln {

namespace {

struct Version {
    const char* name;
    uint32_t number;  // major << 8 | minor
};
constexpr Version vulkan_versions[] = {{"1.0", 0x100}, {"1.1", 0x101}, {"1.2", 0x102}, {"1.3", 0x103}};
constexpr Version spirv_versions[] = {{"1.0", 0x100}, {"1.1", 0x101}, {"1.2", 0x102}, {"1.3", 0x103},
                                      {"1.4", 0x104}, {"1.5", 0x105}, {"1.6", 0x106}};

// The newest SPIR-V that every driver of a Vulkan version takes, and the newest that one may take by an extension.
uint32_t spirv_of(uint32_t vulkan) { return vulkan == 0x100 ? 0x100 : vulkan == 0x101 ? 0x103 : vulkan == 0x102 ? 0x105 : 0x106; }
uint32_t newest_spirv_of(uint32_t vulkan) { return vulkan == 0x101 ? 0x104 : spirv_of(vulkan); }

template <size_t N>
std::optional<uint32_t> read_version(ManifestText in, Yaml::Node node, const char* what, const Version (&versions)[N]) {
    std::vector<std::string> names;
    for (const Version& v : versions) names.push_back(v.name);
    const auto choice = read_choice(in.yaml, in.errors, node, what, names);
    return choice ? std::optional(versions[*choice].number) : std::nullopt;
}

std::string dotted(uint32_t version) { return std::to_string(version >> 8) + "." + std::to_string(version & 0xFF); }

}  // namespace

OptionsRead read_options(ManifestText in, Yaml::Node node, const OptionsRead& base) {
    OptionsRead read = base;
    Fields fields(in.yaml, in.errors, node, "options", {"undefined_macros", "optimise", "vulkan", "spirv", "debug"});
    Options& out = read.options;
    if (const auto* f = fields.find("undefined_macros"))
        if (const auto choice = read_choice(in.yaml, in.errors, f->value, "undefined_macros", {"error", "zero"}))
            out.undefined_macros = *choice == 0 ? UndefinedMacros::error : UndefinedMacros::zero;
    if (const auto* f = fields.find("optimise"))
        if (const auto choice = read_choice(in.yaml, in.errors, f->value, "optimise", {"none", "performance", "size"}))
            out.optimise = *choice == 0 ? Optimise::none : *choice == 1 ? Optimise::performance : Optimise::size;
    if (const auto* f = fields.find("debug"))
        if (const auto value = read_bool(in.yaml, in.errors, f->value, "debug")) out.debug = *value;
    const Yaml::Pair* const vulkan = fields.find("vulkan");
    const Yaml::Pair* const spirv = fields.find("spirv");
    if (vulkan != nullptr)
        if (const auto version = read_version(in, vulkan->value, "vulkan", vulkan_versions)) out.vulkan = *version;
    if (spirv != nullptr)
        if (const auto version = read_version(in, spirv->value, "spirv", spirv_versions)) {
            out.spirv = *version;
            read.spirv_given = true;
        }
    if (!read.spirv_given) out.spirv = spirv_of(out.vulkan);
    if (out.spirv > newest_spirv_of(out.vulkan) && (vulkan != nullptr || spirv != nullptr))
        in.errors.at((spirv != nullptr ? spirv : vulkan)->value, "Vulkan " + dotted(out.vulkan) + " takes SPIR-V up to " +
                                                                     dotted(newest_spirv_of(out.vulkan)) + ", not " +
                                                                     dotted(out.spirv));
    return read;
}

}  // namespace kiln
