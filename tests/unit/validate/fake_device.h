#pragma once
// A device without a driver: what it answers is a function of the request.

#include <functional>

#include "compiler/validate/device.h"

namespace kiln::test {

class FakeDevice final : public Device {
public:
    using Answer = std::function<PipelineOutput(const PipelineRequest&)>;
    explicit FakeDevice(Answer answer) : answer_(std::move(answer)) { info_ = {"fake", "fake 1", "none", ""}; }
    const DeviceInfo& info() const override { return info_; }
    Result<PipelineOutput> run(const PipelineRequest& request) override { return answer_(request); }

private:
    DeviceInfo info_;
    Answer answer_;
};

// One attachment of 16 words for each set of inputs, all `value`.
inline PipelineOutput picture(const PipelineRequest& request, uint32_t value = 0x3f000000, uint64_t covered = 4096) {
    PipelineOutput out;
    for (size_t i = 0; i < request.inputs.size(); ++i) {
        RunOutput run;
        run.covered = covered;
        run.values.push_back({"output 0", {BaseType::float32}, std::vector<uint32_t>(16, value), 4});
        out.runs.push_back(std::move(run));
    }
    return out;
}

}  // namespace kiln::test
