#pragma once
// What the files that read a manifest share; nobody else includes it. Each function reads one part of the tree into values and
// reports every mistake in it; what is wrong is left out or kept at its default, so that reading goes on.

#include "compiler/manifest/manifest.h"
#include "compiler/manifest/yaml_fields.h"

namespace kiln {

struct ManifestText {
    const Yaml& yaml;
    YamlErrors& errors;
};

std::vector<Axis> read_axes(ManifestText in, Yaml::Node node);

// An option that a map may leave to the level above.
struct OptionsRead {
    Options options;
    bool spirv_given = false;
};
// `base` is what holds where the map says nothing.
OptionsRead read_options(ManifestText in, Yaml::Node node, const OptionsRead& base);

// Why `name` cannot be a macro ("is reserved"), or null.
const char* macro_problem(std::string_view name);

// A name of something that is not used inside expressions: [A-Za-z0-9_][A-Za-z0-9_.-]*.
std::optional<std::string> read_plain_name(ManifestText in, Yaml::Node node, const std::string& what);

// The rules of a list, over `axes`; with `only`, a rule on an axis that this shader does not have is an error.
std::vector<Rule> read_rules(ManifestText in, Yaml::Node node, const std::vector<Axis>& axes, const Shader* only);

}  // namespace kiln
