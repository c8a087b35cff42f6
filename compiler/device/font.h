#pragma once
// A built-in 5x7 bitmap font for labels: printable ASCII, lower case with descenders.

#include <cstdint>
#include <string_view>

namespace kiln {

inline constexpr uint32_t glyph_advance = 6, glyph_height = 9;

// Calls plot(x, y) for every set pixel of the text, from the top left.
template <class Plot>
void draw_text(std::string_view text, Plot plot);

// Column `x` (0 to 4) of a character; bit 0 is the top row.
uint8_t glyph_column(char c, unsigned x);

template <class Plot>
void draw_text(std::string_view text, Plot plot) {
    for (size_t i = 0; i < text.size(); ++i)
        for (unsigned x = 0; x < 5; ++x)
            for (unsigned y = 0; y < 8; ++y)
                if ((glyph_column(text[i], x) >> y & 1) != 0) plot(static_cast<uint32_t>(i) * glyph_advance + x, y);
}

}  // namespace kiln
