#pragma once
// A manifest as a value. Grammar: ARCHITECTURE.md, Manifests and scenes, manifests/manifest.schema.json. Every mistake is
// collected with its place.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compiler/base/diag.h"
#include "compiler/base/files.h"
#include "compiler/manifest/axis.h"
#include "compiler/manifest/expr.h"
#include "compiler/manifest/stage.h"

namespace kiln {

enum class Optimise : uint8_t { none = 0, performance = 1, size = 2 };  // in cache keys: append only
enum class UndefinedMacros : uint8_t { error = 0, zero = 1 };           // in cache keys: append only

struct Options {
    UndefinedMacros undefined_macros = UndefinedMacros::error;
    Optimise optimise = Optimise::performance;
    uint32_t vulkan = 0x101;  // major << 8 | minor
    uint32_t spirv = 0x103;
    bool debug = false;
    friend bool operator==(const Options&, const Options&) = default;
};

struct Rule {
    bool forbid = true;   // forbid: the expression must be false; require: it must be true
    Expr expr;            // over the manifest's axes
    std::string text;     // as written
    std::string because;  // may be empty
    Place place;          // of the expression
    std::string source_line;
};

struct StageFile {
    Stage stage = Stage::vertex;
    std::string file;  // as written
    Place place;
    std::string source_line;
};

struct Shader {
    std::string name;
    Place place;  // of the name
    std::string source_line;
    std::vector<StageFile> stages;  // ascending by Stage
    std::vector<uint32_t> axes;     // indices into Manifest::axes, in the manifest's order
    std::vector<Rule> rules;        // those of the shader, and those of the manifest that it has all axes of
    std::vector<std::pair<std::string, std::string>> defines;  // fixed macros in the order written; the body as text
    Options options;
};

struct Manifest {
    std::string name;                  // the file's name without its ending when the file gives none
    std::string path;                  // as given
    std::string folder;                // of the manifest; names in outputs are relative to it
    std::vector<std::string> include;  // as written
    std::vector<Target> targets;       // in the order written, no repeats; empty list in the file: spirv alone
    Options options;
    std::vector<Axis> axes;
    std::vector<Shader> shaders;
};

// Limits, beside those of YAML text (yaml.h) and of expressions (expr.h).
inline constexpr size_t axis_limit = 4096;
inline constexpr size_t axis_value_limit = 65536;       // values of one axis
inline constexpr size_t value_limit = size_t{1} << 21;  // values of all axes
inline constexpr size_t name_limit = 255;               // bytes of a name or a macro

// Reads and checks a manifest. Errors go to `diags`; nullopt when there were any.
std::optional<Manifest> load_manifest(Files& files, const std::string& path, Diags& diags);

}  // namespace kiln
