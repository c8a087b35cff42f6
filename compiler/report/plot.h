#pragma once
// A log-log plot of error against time as SVG, and the placing of its labels.

#include <string>
#include <vector>

namespace kiln::report {

struct Mark {
    std::string label;
    std::string id;       // data-row of the element
    std::string tooltip;  // plain text
    double time = 0, error = 0;
    bool front = false;
};

struct Box {
    double x = 0, y = 0, w = 0, h = 0;
    bool overlaps(const Box& o) const { return x < o.x + o.w && o.x < x + w && y < o.y + o.h && o.y < y + h; }
};

// Width and height that a label takes in a wide font, in the plot's units. Labels of the front are bold.
Box label_size(const std::string& label, bool bold = false);

// A place for each label near its point, inside `area`, over no point and no other label. A label without a place gets w = 0.
std::vector<Box> place_labels(const std::vector<std::string>& labels, const std::vector<std::pair<double, double>>& points,
                              const Box& area, const std::vector<bool>& bold = {});

// Errors of 0 stand on a line of their own below the smallest other one. Colours come from the page's CSS classes.
std::string plot_svg(const std::string& title, const std::string& error_name, const std::vector<Mark>& marks);

std::string escaped(const std::string& text);

}  // namespace kiln::report
