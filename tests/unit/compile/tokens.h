#pragma once
// GLSL text as the preprocessor hands it over: one token a line, directives as written. Good enough for the tests' own texts.

#include <cctype>
#include <sstream>
#include <string>

namespace kiln {

inline std::string tokens(const std::string& text) {
    std::istringstream in(text);
    std::string line, out;
    while (std::getline(in, line)) {
        if (line.starts_with("#")) {
            out += line + "\n";
            continue;
        }
        const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; };
        for (size_t i = 0; i < line.size();) {
            if (std::isspace(static_cast<unsigned char>(line[i])) != 0) {
                ++i;
                continue;
            }
            size_t end = i + 1;
            if (word(line[i])) {
                while (end < line.size() && word(line[end])) ++end;
            }
            out += line.substr(i, end - i) + "\n";
            i = end;
        }
    }
    return out;
}

}  // namespace kiln
