#include "compiler/report/pareto.h"

namespace kiln::report {

std::vector<bool> pareto_front(const std::vector<Cost>& points) {
    std::vector<bool> out(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        out[i] = points[i].valid;
        for (size_t j = 0; j < points.size() && out[i]; ++j) {
            const Cost &a = points[j], &b = points[i];
            if (j != i && a.valid && a.time <= b.time && a.error <= b.error && (a.time < b.time || a.error < b.error))
                out[i] = false;
        }
    }
    return out;
}

}  // namespace kiln::report
