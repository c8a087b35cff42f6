#pragma once
// Jobs and verdicts as bytes, for the pipe to a worker and for the verdict cache. Readers refuse what does not fit.

#include <optional>

#include "compiler/base/digest.h"
#include "compiler/validate/check.h"

namespace kiln {

Bytes encode(const CheckJob& job);
std::optional<CheckJob> decode_job(ByteView bytes);
Bytes encode(const Verdict& verdict);
std::optional<Verdict> decode_verdict(ByteView bytes);
Bytes encode(const DeviceInfo& info);
std::optional<DeviceInfo> decode_info(ByteView bytes);

// Names a verdict in the store (ARCHITECTURE.md, Cache): device, driver and layers, policy, every stage's words in both forms,
// their interfaces and the inputs' seed.
Digest verdict_key(const DeviceInfo& info, const CheckJob& job);

}  // namespace kiln
