#include "compiler/split/class_text.h"

namespace kiln {

namespace {

constexpr std::string_view named_lines = "#extension GL_GOOGLE_cpp_style_line_directive : require";

}  // namespace

ClassText write_class_text(const std::vector<Token>& tokens, const Spellings& spellings, const Sources& sources,
                           const std::string& version, const TextPlace& version_place, bool layout, bool next_line) {
    ClassText out;
    const auto line = [&](std::string_view text, const TextPlace& place) {
        out.text += text;
        out.text += '\n';
        out.places.push_back(place);
    };
    out.places.reserve(tokens.size() + 1);
    if (!version.empty()) line(version, version_place);
    if (!layout) {
        for (const Token& t : tokens) line(spellings.text(t.text), {t.file, t.line, t.column});
        return out;
    }
    line(named_lines, version_place);
    uint32_t file = ~0u, next = 0;  // what the next line of text counts as
    for (size_t i = 0; i < tokens.size();) {
        const Token& first = tokens[i];
        const TextPlace place{first.file, first.line, first.column};
        if (first.file != file || first.line != next) {
            line("#line " + std::to_string(first.line - (next_line ? 0 : 1)) + " \"" + sources.file(first.file).name + "\"",
                 place);
            file = first.file;
        }
        std::string text;
        for (const bool whole = first.kind == Tok::line;
             i < tokens.size() && tokens[i].file == file && tokens[i].line == first.line; ++i) {
            if (!text.empty() && (whole || tokens[i].kind == Tok::line)) break;
            if (!text.empty()) text += ' ';
            text += spellings.text(tokens[i].text);
        }
        line(text, place);
        next = first.line + 1;
    }
    return out;
}

}  // namespace kiln
