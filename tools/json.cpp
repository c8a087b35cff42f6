#include "tools/json.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace kiln {

void Json::separate() {
    if (after_key_) {
        after_key_ = false;
        return;
    }
    if (!first_) out_ += ',';
    if (!closing_.empty()) out_ += '\n' + std::string(2 * closing_.size(), ' ');
    first_ = false;
}

Json& Json::open(char bracket) {
    separate();
    out_ += bracket;
    closing_.push_back(bracket == '{' ? '}' : ']');
    first_ = true;
    return *this;
}

Json& Json::end() {
    const char bracket = closing_.back();
    closing_.pop_back();
    if (!first_) out_ += '\n' + std::string(2 * closing_.size(), ' ');
    out_ += bracket;
    first_ = false;
    return *this;
}

Json& Json::key(std::string_view name) {
    text(name);
    out_ += ": ";
    after_key_ = true;
    return *this;
}

Json& Json::text(std::string_view value) {
    separate();
    out_ += '"';
    for (size_t i = 0; i < value.size(); ++i) {
        const unsigned char c = static_cast<unsigned char>(value[i]);
        if (c == '"' || c == '\\') {
            out_ += '\\';
            out_ += static_cast<char>(c);
        } else if (c == '\n') {
            out_ += "\\n";
        } else if (c < 0x20 || c == 0x7f) {
            char escape[8];
            std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
            out_ += escape;
        } else if (c < 0x80) {
            out_ += static_cast<char>(c);
        } else {
            const size_t length = c >= 0xF0 && c <= 0xF4 ? 4 : c >= 0xE0 && c < 0xF0 ? 3 : c >= 0xC2 && c < 0xE0 ? 2 : 0;
            bool whole = length != 0 && i + length <= value.size();
            for (size_t k = 1; whole && k < length; ++k) whole = (static_cast<unsigned char>(value[i + k]) & 0xC0) == 0x80;
            if (whole) {
                out_ += value.substr(i, length);
                i += length - 1;
            } else {
                out_ += "\xEF\xBF\xBD";
            }
        }
    }
    out_ += '"';
    return *this;
}

Json& Json::number(uint64_t value) {
    separate();
    out_ += std::to_string(value);
    return *this;
}

Json& Json::number(double value) {
    separate();
    char buffer[40];
    // JSON has no infinity: a count past every double is written as the largest that parses.
    const double most = 1.79769e308;
    std::snprintf(buffer, sizeof buffer, "%.6g", std::isnan(value) ? 0.0 : std::clamp(value, -most, most));
    out_ += buffer;
    return *this;
}

Json& Json::boolean(bool value) {
    separate();
    out_ += value ? "true" : "false";
    return *this;
}

std::string Json::take() {
    out_ += '\n';
    return std::move(out_);
}

}  // namespace kiln
