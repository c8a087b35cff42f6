// Places are byte offsets until somebody asks: a tree of a million values keeps one offset each, and lines are counted from
// the nearest of many marks.
#include <algorithm>

#include "compiler/manifest/yaml.h"

namespace kiln {

namespace {
constexpr size_t mark_distance = 512;
constexpr size_t longest_line = 4096;  // a caret further right than this is not shown
constexpr size_t behind_caret = 256;
}  // namespace

Yaml::Yaml(std::string path, std::string text) : path_(std::move(path)), text_(std::move(text)) {
    Mark mark{1, 0};
    marks_.reserve(text_.size() / mark_distance + 1);
    for (size_t at = 0; at <= text_.size(); ++at) {
        if (at % mark_distance == 0) marks_.push_back(mark);
        if (at < text_.size() && text_[at] == '\n') ++mark.line, mark.line_begin = static_cast<uint32_t>(at + 1);
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

YamlSpot Yaml::spot_at(size_t offset) const {
    offset = std::min(offset, text_.size());
    Mark mark = marks_[offset / mark_distance];
    for (size_t at = offset - offset % mark_distance; at < offset; ++at)
        if (text_[at] == '\n') ++mark.line, mark.line_begin = static_cast<uint32_t>(at + 1);
    return {mark.line, static_cast<uint32_t>(offset - mark.line_begin + 1)};
}

Place Yaml::place_at(size_t offset) const {
    const YamlSpot spot = spot_at(offset);
    return {path_, spot.line, spot.column};
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
    // The last mark at or before the end of the line before the wanted one.
    const auto mark =
        std::lower_bound(marks_.begin(), marks_.end(), place.line, [](const Mark& m, uint32_t l) { return m.line < l; });
    Mark from = mark == marks_.begin() ? Mark{1, 0} : *(mark - 1);
    size_t at = from.line_begin;
    for (; from.line < place.line; ++from.line) {
        at = text_.find('\n', at);
        if (at == std::string::npos) return {};
        ++at;
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
