// glslang's log is meant for people, but its shape is fixed: a severity, then "string:line:" where it knows one, then the
// text. What follows from an earlier error ("compilation terminated") only hides the cause, so it is dropped.

#include "compiler/toolchain/messages.h"

#include <algorithm>
#include <charconv>

namespace kiln {
namespace {

bool take(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text.remove_prefix(prefix.size());
    return true;
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
    return text;
}

bool take_severity(std::string_view& text, Severity& severity) {
    severity = Severity::error;
    if (take(text, "ERROR: ") || take(text, "INTERNAL ERROR: ") || take(text, "UNIMPLEMENTED: ")) return true;
    severity = Severity::warning;
    if (take(text, "WARNING: ")) return true;
    severity = Severity::note;
    return take(text, "NOTE: ");
}

// "0:12: rest" or "name:12: rest".
uint32_t take_line(std::string_view& text) {
    const size_t first = text.find(':');
    if (first == std::string_view::npos || text.substr(0, first).find(' ') != std::string_view::npos) return 0;
    const char* begin = text.data() + first + 1;
    uint32_t line = 0;
    const auto [end, failed] = std::from_chars(begin, text.data() + text.size(), line);
    if (failed != std::errc{} || end == text.data() + text.size() || *end != ':') return 0;
    text.remove_prefix(static_cast<size_t>(end + 1 - text.data()));
    return line;
}

bool follows_from_another(std::string_view text) {
    return text.ends_with("compilation terminated") || text.ends_with("compilation errors.  No code generated.") ||
           text.ends_with("missing #endif");
}

}  // namespace

std::vector<ToolMessage> read_messages(std::string_view log) {
    std::vector<ToolMessage> messages;
    bool continues = false;  // whether an unprefixed line belongs to the last message
    while (!log.empty()) {
        const size_t end = std::min(log.find('\n'), log.size());
        std::string_view line = log.substr(0, end);
        log.remove_prefix(std::min(end + 1, log.size()));
        ToolMessage message;
        if (!take_severity(line, message.severity)) {
            line = trim(line);
            if (!line.empty() && continues) messages.back().text.append(" ").append(line);
            continue;
        }
        message.line = take_line(line);
        line = trim(line);
        if (take(line, "'' : ")) line = trim(line);
        continues = !follows_from_another(line);
        if (!continues) continue;
        message.text = line;
        messages.push_back(std::move(message));
    }
    return messages;
}

bool has_error(const std::vector<ToolMessage>& messages) {
    return std::any_of(messages.begin(), messages.end(), [](const ToolMessage& m) { return m.severity == Severity::error; });
}

}  // namespace kiln
