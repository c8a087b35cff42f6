// Any bytes as the files of a stage over a small space: no crash, and (checked inside split_stage) classes that partition it.
// The text "\x01name\n" begins a further file.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "compiler/split/split.h"

namespace {

kiln::Axis axis(const char* macro, kiln::AxisKind kind, std::vector<int32_t> numbers) {
    kiln::Axis out;
    out.name = out.macro = macro;
    out.kind = kind;
    for (const int32_t n : numbers) out.values.push_back({std::to_string(n), n});
    return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    if (size > 20'000) return 0;
    Manifest manifest;
    manifest.folder = "m";
    manifest.axes = {axis("A", AxisKind::boolean, {0, 1}), axis("B", AxisKind::defined, {0, 1}),
                     axis("LIGHT", AxisKind::integer, {-1, 0, 3})};
    Shader shader;
    shader.name = "s";
    shader.axes = {0, 1, 2};
    shader.defines = {{"FIXED", "(2)"}};
    shader.options.undefined_macros = size % 2 == 0 ? UndefinedMacros::zero : UndefinedMacros::error;
    StageFile stage;
    stage.stage = Stage::fragment;
    stage.file = "main";
    MemoryFiles files;
    std::string text(reinterpret_cast<const char*>(data), size), name = "main";
    for (size_t begin = 0; begin <= text.size();) {
        const size_t next = std::min(text.find('\x01', begin), text.size());
        files.files["m/" + name] = text.substr(begin, next - begin);
        const size_t line = std::min(text.find('\n', next), text.size());
        name = line > next ? text.substr(next + 1, line - next - 1) : std::string("rest");
        begin = line + 1;
    }
    manifest.shaders.push_back(shader);
    Diags diags;
    const auto space = build_space(manifest, manifest.shaders.front(), diags);
    SplitOptions options;
    options.max_states = 2'000;
    options.lines = size % 3 == 0;
    const Split split = split_stage(manifest, manifest.shaders.front(), stage, *space, space->legal, files, options);
    if (split.classes.empty() && !split.diags.has_errors()) std::abort();
    for (const Class& c : split.classes) {
        size_t lines = 0;
        for (const char ch : c.text) lines += ch == '\n' ? 1 : 0;
        if (lines != c.places.size()) std::abort();
        for (const TextPlace& place : c.places)
            if (place.file >= split.files.size() || place.line == 0) std::abort();
    }
    return 0;
}
