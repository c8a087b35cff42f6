#pragma once
// The slow way: glslang's own preprocessor, one variant at a time.

#include <map>
#include <string>
#include <vector>

#include "compiler/manifest/stage.h"

namespace oracle {

struct Answer {
    bool ok = false;
    std::string text;  // as glslang prints it
    std::string log;
};

// `preamble` holds the variant's #define lines. Files are found by name, an includer's folder first, then the top.
Answer preprocess(kiln::Stage stage, const std::map<std::string, std::string>& files, const std::string& root,
                  const std::string& preamble);

}  // namespace oracle
