#pragma once
// Judges one pipeline: runs it on a Device, runs its unoptimised form with the same inputs, compares. Knows no Vulkan, no
// table, no process: what it needs travels in a CheckJob, so that a worker process can do it.
//
// A pipeline fails on
//   - a validation message of severity error, or a call that the driver refuses;
//   - a float that is not finite, where the inputs are ordinary (device/inputs.h);
//   - outputs that differ between the optimised and the unoptimised form: more than 0.1 % of the values of one attachment,
//     buffer or image by more than 1e-4 * max(1, |a|, |b|), integers at all; or other finiteness.
// The second set of inputs, with either sign, is compared only. That nothing was drawn is not a failure but a figure: the
// verdict's `covered` is 0, after every vertex input that could be the position has had its turn.

#include <memory>
#include <string>
#include <vector>

#include "compiler/validate/device.h"

namespace kiln {

using StagePtr = std::shared_ptr<const StageCode>;

struct CheckJob {
    std::vector<StagePtr> optimised;    // with the published reflection
    std::vector<StagePtr> unoptimised;  // with what its own words say; empty: nothing to compare with
    uint64_t seed = 1;
    uint32_t size = 64;
};

enum class Outcome : uint8_t {  // in the verdict cache: append only
    passed = 0,
    failed = 1,
    unsupported = 2,  // the device lacks something that the module declares
};

struct Verdict {
    Outcome outcome = Outcome::passed;
    std::string why;         // of anything but passed
    bool compared = false;   // with an unoptimised form
    uint64_t values = 0;     // compared
    uint64_t differing = 0;  // of them
    uint64_t nonfinite = 0;  // floats, ordinary inputs, optimised form
    uint64_t covered = 0;    // pixels drawn (workgroups for compute), ordinary inputs
    double ms = 0;
};

inline constexpr uint32_t check_version = 1;  // part of verdict keys: raise with any change of the policy

// An Error only when the device itself is lost.
Result<Verdict> check_pipeline(Device& device, const CheckJob& job);

// Between two read-backs of one thing, word by word.
struct Difference {
    uint64_t values = 0, differing = 0, finiteness = 0;
    double worst = 0;
    uint64_t worst_index = 0;
};
Difference compare(const ReadBack& a, const ReadBack& b);

uint64_t count_nonfinite(const RunOutput& run);

}  // namespace kiln
