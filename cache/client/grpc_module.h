#pragma once
// The module that holds everything that includes gRPC (grpc_remote.h says why), loaded once.

#include "compiler/base/result.h"

namespace kiln {

// An Error where there is no module beside this program, or one of another version.
Result<void*> grpc_module_symbol_named(const char* symbol);

}  // namespace kiln
