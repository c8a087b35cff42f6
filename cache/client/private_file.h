#pragma once
// Small files that hold secrets, or say whom to trust.

#include <string>

#include "compiler/base/result.h"

namespace kiln {

// At most `most` bytes. Refuses what is no regular file, and one that others than its owner may read. Errors never hold its text.
Result<std::string> read_private_file(const std::string& path, const std::string& what, size_t most);

// A token as it may stand in a header: visible ASCII, one line; what is around it is stripped.
Result<std::string> token_of(const std::string& text, const std::string& where);

// A PEM file of certificates; an Error where it holds none. `what` is named in the Error.
Result<std::string> read_authorities(const std::string& path, const std::string& what);

}  // namespace kiln
