#include "compiler/base/diag.h"

#include <algorithm>
#include <tuple>

namespace kiln {

Diag& Diags::add(Severity severity, Place place, std::string message, std::string source_line) {
    if (severity == Severity::error) ++errors_;
    list_.push_back({severity, std::move(place), std::move(message), std::move(source_line), {}});
    return list_.back();
}

void Diags::append(const Diags& other) {
    list_.insert(list_.end(), other.list_.begin(), other.list_.end());
    errors_ += other.errors_;
}

void Diags::sort() {
    auto key = [](const Diag& d) {
        return std::tuple<const std::string&, uint32_t, uint32_t, int, const std::string&>(
            d.place.file, d.place.line, d.place.column, -static_cast<int>(d.severity), d.message);
    };
    std::stable_sort(list_.begin(), list_.end(), [&](const Diag& a, const Diag& b) { return key(a) < key(b); });
    // One mistake in a file that several shaders read is said once, with the variants of each.
    size_t kept = 0;
    for (size_t i = 0; i < list_.size(); ++i) {
        if (kept != 0 && key(list_[kept - 1]) == key(list_[i]) && list_[kept - 1].source_line == list_[i].source_line) {
            std::vector<std::string>& notes = list_[kept - 1].notes;
            for (std::string& note : list_[i].notes)
                if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(std::move(note));
        } else {
            if (kept != i) list_[kept] = std::move(list_[i]);
            ++kept;
        }
    }
    list_.resize(kept);
    errors_ = static_cast<size_t>(
        std::count_if(list_.begin(), list_.end(), [](const Diag& d) { return d.severity == Severity::error; }));
}

namespace {

constexpr size_t max_shown = 160;

// Length of the well-formed UTF-8 sequence at text[i], or 0.
size_t utf8_length(std::string_view text, size_t i) {
    const auto byte = [&](size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned char first = byte(i);
    if (first < 0x80) return 1;
    const size_t length = first >= 0xC2 && first <= 0xDF   ? 2
                          : (first & 0xF0) == 0xE0         ? 3
                          : first >= 0xF0 && first <= 0xF4 ? 4
                                                           : 0;
    if (length == 0 || i + length > text.size()) return 0;
    for (size_t k = 1; k < length; ++k)
        if ((byte(i + k) & 0xC0) != 0x80) return 0;
    return length;
}

// The source line made safe for a terminal, and where the byte `column` lands in it.
struct Shown {
    std::string text;
    size_t caret = 0;
};

Shown show(std::string_view source, size_t column) {
    const size_t target = column == 0 ? 0 : column - 1;
    size_t begin = 0;
    if (source.size() > max_shown && target > max_shown / 2) begin = std::min(target - max_shown / 2, source.size());
    while (begin > 0 && begin < source.size() && (static_cast<unsigned char>(source[begin]) & 0xC0) == 0x80) ++begin;
    Shown shown;
    if (begin > 0) shown.text = "...";
    size_t width = shown.text.size();
    shown.caret = width;
    for (size_t i = begin; i < source.size() && i < begin + max_shown;) {
        if (i <= target) shown.caret = width;
        const size_t length = utf8_length(source, i);
        const char c = source[i];
        if (c == '\t')
            shown.text += ' ';
        else if (length == 0 || (length == 1 && (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)))
            shown.text += '?';
        else
            shown.text += source.substr(i, length);
        i += std::max<size_t>(length, 1);
        ++width;
    }
    if (target >= source.size()) shown.caret = width;
    return shown;
}

}  // namespace

std::string render(const Diag& diag, bool colour) {
    const char* const word = diag.severity == Severity::error ? "error" : diag.severity == Severity::warning ? "warning" : "note";
    const char* const on = !colour                              ? ""
                           : diag.severity == Severity::error   ? "\x1b[1;31m"
                           : diag.severity == Severity::warning ? "\x1b[1;35m"
                                                                : "\x1b[1;36m";
    const char* const off = colour ? "\x1b[0m" : "";
    std::string out = diag.place.file.empty() ? "kiln" : diag.place.file;
    if (diag.place.line != 0) {
        out += ':' + std::to_string(diag.place.line);
        if (diag.place.column != 0) out += ':' + std::to_string(diag.place.column);
    }
    out += std::string(": ") + on + word + ":" + off + " " + diag.message + "\n";
    if (!diag.source_line.empty()) {
        const Shown shown = show(diag.source_line, diag.place.column);
        out += "    " + shown.text + "\n";
        if (diag.place.column != 0) out += std::string(4 + shown.caret, ' ') + on + "^" + off + "\n";
    }
    for (const std::string& note : diag.notes) out += "  " + note + "\n";
    return out;
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
    // Optimal string alignment distance (a swap of neighbours counts as one), bounded by a third of the word's length.
    const size_t limit = std::max<size_t>(1, word.size() / 3 + (word.size() > 3 ? 1 : 0));
    std::string best;
    size_t best_distance = limit + 1;
    for (const std::string& candidate : candidates) {
        if (candidate.size() > 256 || word.size() > 256) continue;
        const size_t m = word.size(), n = candidate.size();
        if ((m > n ? m - n : n - m) >= best_distance) continue;
        std::vector<std::vector<size_t>> d(m + 1, std::vector<size_t>(n + 1));
        for (size_t i = 0; i <= m; ++i) d[i][0] = i;
        for (size_t j = 0; j <= n; ++j) d[0][j] = j;
        for (size_t i = 1; i <= m; ++i)
            for (size_t j = 1; j <= n; ++j) {
                d[i][j] =
                    std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (word[i - 1] == candidate[j - 1] ? 0u : 1u)});
                if (i > 1 && j > 1 && word[i - 1] == candidate[j - 2] && word[i - 2] == candidate[j - 1])
                    d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
            }
        if (d[m][n] < best_distance) best_distance = d[m][n], best = candidate;
    }
    return best;
}

std::string_view line_of(std::string_view text, uint32_t line) {
    size_t begin = 0;
    for (uint32_t k = 1; k < line; ++k) {
        const size_t end = text.find('\n', begin);
        if (end == std::string_view::npos) return {};
        begin = end + 1;
    }
    std::string_view rest = text.substr(begin);
    rest = rest.substr(0, rest.find('\n'));
    if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    return rest;
}

}  // namespace kiln
