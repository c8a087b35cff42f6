#pragma once
// A picture in linear RGB, in double precision.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kiln::report {

struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<double> rgb;  // 3 numbers a pixel, rows from the top

    Picture() = default;
    Picture(uint32_t w, uint32_t h) : width(w), height(h), rgb(size_t{3} * w * h) {}
    size_t pixels() const { return size_t{width} * height; }
};

}  // namespace kiln::report
