#pragma once
#include <string>

namespace kiln {

// `kiln help environment`: every variable that kiln reads, a line each.
std::string help_of_environment();

}  // namespace kiln
