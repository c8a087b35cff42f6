#include "compiler/report/pareto.h"

#include <gtest/gtest.h>

namespace kiln::report {
namespace {

TEST(Pareto, MarksWhatNothingBeatsInBoth) {
    EXPECT_EQ(pareto_front({{1, 9}, {2, 5}, {3, 6}, {4, 1}, {5, 1}}), (std::vector<bool>{true, true, false, true, false}));
}
TEST(Pareto, EqualPointsStandTogether) { EXPECT_EQ(pareto_front({{1, 1}, {1, 1}}), (std::vector<bool>{true, true})); }
TEST(Pareto, AnInvalidPointBeatsNothing) { EXPECT_EQ(pareto_front({{1, 1, false}, {2, 2}}), (std::vector<bool>{false, true})); }
TEST(Pareto, NoPoints) { EXPECT_TRUE(pareto_front({}).empty()); }

// Against the definition: on the front exactly when no point dominates.
TEST(Pareto, AgreesWithTheDefinition) {
    std::vector<Cost> points;
    unsigned state = 7;
    const auto next = [&] { return static_cast<double>((state = state * 1664525u + 1013904223u) >> 28); };
    for (int i = 0; i < 60; ++i) {
        const double time = next();
        points.push_back({time, next()});
    }
    const std::vector<bool> front = pareto_front(points);
    for (size_t i = 0; i < points.size(); ++i) {
        bool beaten = false;
        for (const Cost& p : points)
            beaten = beaten || (p.time <= points[i].time && p.error <= points[i].error &&
                                (p.time < points[i].time || p.error < points[i].error));
        EXPECT_EQ(front[i], !beaten) << i;
    }
}

}  // namespace
}  // namespace kiln::report
