// Places are byte offsets until somebody asks: a tree of a million values keeps one offset each, and lines are counted from
// the nearest of a few thousand marks.
#include <algorithm>

#include "compiler/yaml.h"

namespace kiln {

namespace {
constexpr size_t mark_distance = 16 * 1024;
constexpr size_t longest_line = 4096;  // a caret further right than this is not shown
constexpr size_t behind_caret = 256;
}  // namespace

Yaml::Yaml(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {
    uint32_t line = 1;
    for (size_t at = 0; at <= text_.size(); at += mark_distance) {
        line_marks_.push_back(line);
        const size_t end = std::min(at + mark_distance, text_.size());
        line += static_cast<uint32_t>(
            std::count(text_.begin() + static_cast<ptrdiff_t>(at), text_.begin() + static_cast<ptrdiff_t>(end), '\n'));
    }
}

std::string_view Yaml::value(Node n) const {
    const Entry& e = nodes_[n];
    if (e.kind != YamlKind::scalar) return {};
    return std::string_view(e.decoded ? decoded_ : text_).substr(e.begin, e.size);
}

std::vector<Yaml::Node> Yaml::items(Node sequence) const {
    std::vector<Node> out;
    if (kind(sequence) != YamlKind::sequence) return out;
    out.reserve(nodes_[sequence].size);
    for (Node n = nodes_[sequence].begin; n != 0; n = nodes_[n].next) out.push_back(n);
    return out;
}

std::vector<Yaml::Pair> Yaml::pairs(Node map) const {
    std::vector<Pair> out;
    if (kind(map) != YamlKind::map) return out;
    out.reserve(nodes_[map].size);
    for (Node n = nodes_[map].begin; n != 0; n = nodes_[nodes_[n].next].next) out.push_back({n, nodes_[n].next});
    return out;
}

Place Yaml::place_at(size_t offset) const {
    offset = std::min(offset, text_.size());
    const size_t mark = offset / mark_distance;
    const auto from = text_.begin() + static_cast<ptrdiff_t>(mark * mark_distance);
    const auto here = text_.begin() + static_cast<ptrdiff_t>(offset);
    const size_t line_begin = offset == 0 ? 0 : text_.rfind('\n', offset - 1) + 1;  // npos + 1 == 0
    return {path_, line_marks_[mark] + static_cast<uint32_t>(std::count(from, here, '\n')),
            static_cast<uint32_t>(offset - line_begin + 1)};
}

Place Yaml::place_in(Node n, size_t value_offset) const {
    const Entry& e = nodes_[n];
    if (e.kind != YamlKind::scalar) return place(n);
    if (!e.decoded && e.begin == e.offset) return place_at(e.offset + std::min<size_t>(value_offset, e.size));
    const std::vector<uint32_t> offsets = scalar_offsets(text_, e.offset, e.style, value(n));
    return offsets.empty() ? place(n) : place_at(offsets[std::min(value_offset, offsets.size() - 1)]);
}

std::string Yaml::source_line(const Place& place) const {
    if (place.line == 0 || place.column > longest_line) return {};
    const auto mark = std::upper_bound(line_marks_.begin(), line_marks_.end(), place.line - 1);
    // The last mark whose line is before the wanted one; the wanted line begins after it, unless it is the first.
    size_t at = mark == line_marks_.begin() ? 0 : static_cast<size_t>(mark - line_marks_.begin() - 1) * mark_distance;
    uint32_t line = mark == line_marks_.begin() ? 1 : *(mark - 1);
    while (line < place.line) {
        at = text_.find('\n', at);
        if (at == std::string::npos) return {};
        ++at;
        ++line;
    }
    std::string_view rest = std::string_view(text_).substr(at);
    rest = rest.substr(0, std::min(rest.find('\n'), place.column + behind_caret));
    if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    return std::string(rest);
}

void YamlErrors::at(const Place& place, std::string message, std::vector<std::string> notes) {
    if (++count_ > limit + 1) return;
    if (count_ == limit + 1) {
        diags_.error(place, "more mistakes follow; these are not shown", yaml_.source_line(place));
        return;
    }
    diags_.error(place, std::move(message), yaml_.source_line(place)).notes = std::move(notes);
}

std::string to_string(const Place& place) {
    return place.file + ":" + std::to_string(place.line) + ":" + std::to_string(place.column);
}

}  // namespace kiln
