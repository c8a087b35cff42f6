// Labels have their places, and the drawing is well-formed.
#include "compiler/report/plot.h"

#include <gtest/gtest.h>

#include <limits>

namespace kiln::report {
namespace {

TEST(Plot, LabelsOverlapNeitherEachOtherNorPoints) {
    std::vector<std::string> labels;
    std::vector<std::pair<double, double>> points;
    for (int i = 0; i < 14; ++i) {
        labels.push_back("member_" + std::to_string(i));
        points.emplace_back(200.0 + 9.0 * i, 200.0 + 12.0 * (i % 3));
    }
    const Box area{60, 30, 400, 340};
    const std::vector<Box> boxes = place_labels(labels, points, area);
    size_t placed = 0;
    for (size_t i = 0; i < boxes.size(); ++i) {
        if (boxes[i].w == 0.0) continue;
        ++placed;
        EXPECT_GE(boxes[i].x, area.x);
        EXPECT_LE(boxes[i].x + boxes[i].w, area.x + area.w);
        for (size_t j = 0; j < i; ++j) EXPECT_FALSE(boxes[j].w > 0.0 && boxes[i].overlaps(boxes[j])) << i << " " << j;
        for (const auto& [x, y] : points) EXPECT_FALSE(boxes[i].overlaps({x - 3, y - 3, 6, 6})) << i;
    }
    EXPECT_EQ(placed, labels.size());
}

TEST(Plot, ALabelWithoutAPlaceIsLeftOut) {
    const std::vector<Box> boxes = place_labels({"much_too_long_a_name"}, {{5, 5}}, {0, 0, 10, 10});
    EXPECT_EQ(boxes[0].w, 0.0);
}

TEST(Plot, DrawsZeroAndLeavesOutWhatHasNoPlace) {
    const std::string svg = plot_svg("<t>", "relMSE",
                                     {{"a", "f1-0-0", "a & b", 1.0, 0.0, true},
                                      {"b", "f1-0-1", "b", 2.0, 1e-3, false},
                                      {"c", "f1-0-2", "c", 2.0, std::numeric_limits<double>::infinity(), false}});
    EXPECT_NE(svg.find("&lt;t&gt;"), std::string::npos);
    EXPECT_NE(svg.find("a &amp; b"), std::string::npos);
    EXPECT_NE(svg.find("data-row=\"f1-0-1\""), std::string::npos);
    EXPECT_EQ(svg.find("data-row=\"f1-0-2\""), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("<t>"), std::string::npos);
}

TEST(Plot, NoPointsAtAll) { EXPECT_NE(plot_svg("t", "e", {}).find("</svg>"), std::string::npos); }

}  // namespace
}  // namespace kiln::report
