#pragma once
// Diagnostics are values: every stage collects its own, the command line prints them in one place.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace kiln {

// A byte in a file. Lines and columns count from 1, columns in bytes; 0 means "not known".
struct Place {
    std::string file;
    uint32_t line = 0;
    uint32_t column = 0;
    friend bool operator==(const Place&, const Place&) = default;
};

enum class Severity : uint8_t { note = 0, warning = 1, error = 2 };  // stored in action records: append only

struct Diag {
    Severity severity = Severity::error;
    Place place;
    std::string message;             // one line, no "error:" prefix
    std::string source_line;         // the line that `place` points into, for the caret; may be empty
    std::vector<std::string> notes;  // further lines, shown indented: conditions, hints
    friend bool operator==(const Diag&, const Diag&) = default;
};

class Diags {
public:
    Diag& add(Severity severity, Place place, std::string message, std::string source_line = {});
    Diag& error(Place place, std::string message, std::string source_line = {}) {
        return add(Severity::error, std::move(place), std::move(message), std::move(source_line));
    }
    Diag& warning(Place place, std::string message, std::string source_line = {}) {
        return add(Severity::warning, std::move(place), std::move(message), std::move(source_line));
    }
    void append(const Diags& other);
    bool has_errors() const { return errors_ != 0; }
    size_t errors() const { return errors_; }
    bool empty() const { return list_.empty(); }
    const std::vector<Diag>& list() const { return list_; }
    // Orders by file, line, column, severity, message. Equal ones become one, with the notes of all, each once.
    void sort();

private:
    std::vector<Diag> list_;
    size_t errors_ = 0;
};

// "file:3:7: error: message\n    source\n      ^\n  note\n". Tabs in the source line keep the caret aligned; bytes that
// are not printable UTF-8 are shown as '?', and lines over 160 bytes are cut around the caret.
std::string render(const Diag& diag, bool colour);

// The candidate closest to `word` by edit distance, or empty when none is near enough to be meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

// Line `line` (from 1) of `text`, without its end.
std::string_view line_of(std::string_view text, uint32_t line);

}  // namespace kiln
