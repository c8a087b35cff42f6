// Any bytes as a manifest and as a scene: a value or errors with places inside the file, never a crash.
#include <algorithm>
#include <cstdlib>

#include "compiler/manifest/manifest.h"
#include "compiler/space/scene.h"

namespace {

void check(bool good) {
    if (!good) std::abort();
}

void check_places(const kiln::Diags& diags, std::string_view text) {
    for (const kiln::Diag& d : diags.list()) {
        check(!d.message.empty() && d.message.find('\n') == std::string::npos);
        if (d.place.line == 0) continue;
        check(d.place.column != 0 && d.place.line <= 1 + static_cast<size_t>(std::count(text.begin(), text.end(), '\n')));
        if (!d.source_line.empty()) check(d.place.column <= d.source_line.size() + 1);
        kiln::render(d, false);
    }
}

void check_rules(const kiln::Manifest& manifest) {
    for (const kiln::Shader& shader : manifest.shaders) {
        std::vector<int32_t> numbers(manifest.axes.size());
        for (const uint32_t a : shader.axes) numbers[a] = manifest.axes[a].values.back().number;
        for (const kiln::Rule& rule : shader.rules) kiln::evaluate(rule.expr, numbers);
        check(!shader.stages.empty() && !shader.name.empty());
    }
    for (const kiln::Axis& axis : manifest.axes) check(!axis.values.empty() && !axis.macro.empty() && !axis.name.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    kiln::MemoryFiles files;
    files.files["f.yaml"] = text;
    kiln::Diags diags;
    const auto manifest = kiln::load_manifest(files, "f.yaml", diags);
    check(manifest.has_value() != diags.has_errors());
    check_places(diags, text);
    if (manifest) check_rules(*manifest);
    kiln::Diags of_scene;
    const auto scene = kiln::load_scene(files, "f.yaml", of_scene);
    check(scene.has_value() != of_scene.has_errors());
    check_places(of_scene, text);
    return 0;
}
