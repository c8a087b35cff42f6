#pragma once

namespace kiln {

// The number, and a digest of all sources below compiler/ (tools/cmake/version.cmake).
extern const char* const kiln_version;

}  // namespace kiln
