#pragma once
// A compute shader of uber/ with its axes set, ready to run on the device.

#include "compiler/base/files.h"
#include "compiler/device/compute.h"
#include "tests/device/glsl.h"

namespace kiln::test {

// The file with its includes in place (each guards itself) and `defines`, lines of text, after #version.
inline std::string text_of(const std::string& path, const std::string& defines = {}) {
    DiskFiles files;
    const Result<std::optional<std::string>> read = files.read(std::string(KILN_SOURCE_DIR) + "/" + path);
    EXPECT_TRUE(read.ok() && *read) << path;
    std::string out;
    if (!read.ok() || !*read) return out;
    for (size_t at = 0; at < (*read)->size();) {
        const size_t end = std::min((*read)->find('\n', at), (*read)->size());
        const std::string line = (*read)->substr(at, end - at);
        at = end + 1;
        if (line.rfind("#include", 0) == 0) {
            const size_t open = line.find('"') + 1;
            out += text_of(join_path(folder_of(path), line.substr(open, line.rfind('"') - open)));
        } else {
            out += line + "\n";
        }
        if (line.rfind("#version", 0) == 0) out += defines;
    }
    return out;
}

inline ComputeResult run_text(const std::string& text, const ComputeData& data) {
    const Result<StageCode> stage = compute_stage(text, Optimise::performance);
    EXPECT_TRUE(stage.ok()) << (stage.ok() ? "" : stage.error().message);
    if (!stage.ok()) return {};
    Result<ComputeResult> out = run_compute(device(), *stage, data);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? std::move(*out) : ComputeResult();
}

}  // namespace kiln::test
