#pragma once
#include <string>

namespace kiln {

// `kiln help environment`: every variable of kiln's own that it reads, a line each.
std::string help_of_environment();

}  // namespace kiln
