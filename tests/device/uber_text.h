#pragma once
#include <string>

namespace kiln::test {

// A file below uber/ with its includes in place (each guards itself) and `defines`, lines of text, after #version. A file that
// cannot be read fails the test.
std::string uber_text(const std::string& path, const std::string& defines = {});

}  // namespace kiln::test
