#pragma once
// Which of some (time, error) pairs nothing beats in both.

#include <cstddef>
#include <vector>

namespace kiln::report {

struct Cost {
    double time = 0, error = 0;
    bool valid = true;  // false: never on the front, and beats nothing
};

// One flag a point: true when no other point is at least as good in both and better in one. Equal points are on it together.
std::vector<bool> pareto_front(const std::vector<Cost>& points);

}  // namespace kiln::report
