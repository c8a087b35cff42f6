#pragma once
// A compute shader of uber/ with its axes set, ready to run on the device.

#include "compiler/device/compute.h"
#include "tests/device/glsl.h"
#include "tests/device/uber_text.h"

namespace kiln::test {

inline ComputeResult run_text(const std::string& text, const ComputeData& data) {
    const Result<StageCode> stage = compute_stage(text, Optimise::performance);
    EXPECT_TRUE(stage.ok()) << (stage.ok() ? "" : stage.error().message);
    if (!stage.ok()) return {};
    Result<ComputeResult> out = run_compute(device(), *stage, data);
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    return out.ok() ? std::move(*out) : ComputeResult();
}

}  // namespace kiln::test
