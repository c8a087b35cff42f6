#pragma once
// Runs what a table holds and says what came of it: every distinct pipeline of its needed variants once (check.h says what
// fails), and the table itself against its proof. Verdicts are kept in the store under the keys of ARCHITECTURE.md, Cache.

#include "compiler/base/store.h"
#include "compiler/modules/modules.h"
#include "compiler/space/count.h"
#include "compiler/validate/workers.h"

namespace kiln {

struct ValidateOptions {
    std::string shader;   // empty: all
    uint64_t sample = 0;  // 0: every pipeline; else at least one for every module, and up to so many in all
    uint64_t seed = 1;    // of inputs and of the sample
    uint32_t size = 64;   // side of the attachments in pixels
};

// Something about one pipeline (or one stage's variants) that a person should see.
struct Finding {
    std::string shader;
    std::string variant;  // the smallest: "light=point pass=forward"
    std::string where;    // "in 1,152 of 75,536 variants of surface: exactly when ibl && light == area"
    std::string why;
};

struct ValidateReport {
    DeviceInfo device;
    Count variants;                // that the pipelines considered stand for
    uint64_t pipelines = 0;        // considered: those of the shader asked for, or the sample of them
    uint64_t pipelines_there = 0;  // without the sample
    uint64_t modules = 0, modules_there = 0;
    uint64_t run = 0, cached = 0;  // pipelines whose verdict was made now, was in the store
    uint64_t shared = 0;           // equal in all to another that was run (in another shader, say)
    uint64_t passed = 0, not_compared = 0;
    uint64_t nonfinite = 0;  // pipelines with values that are not finite
    uint64_t values = 0;     // compared
    uint64_t store_failures = 0;
    double device_ms = 0;  // in the driver, by all workers
    std::vector<Finding> failed, unsupported;
    std::vector<Finding> undrawn;  // passed, and drew no pixel
    bool ok() const { return failed.empty(); }
};

// `proof` may be empty: then nothing is compared, and the report counts that. An Error when the table or the proof is
// damaged, when the filter names no shader, when the device fails, or on an interrupt; verdicts made by then are in the store.
Result<ValidateReport> validate(ByteView table, ByteView proof, const ValidateOptions& options, WorkerPool& pool, Store& store,
                                Toolchain& tools, const Progress& progress);

// A pool without processes: for tests, with a fake device.
std::unique_ptr<WorkerPool> local_pool(std::unique_ptr<Device> device);

}  // namespace kiln
