#include "compiler/order.h"

#include <algorithm>
#include <numeric>

namespace kiln {

namespace {

uint64_t total_span(const std::vector<std::vector<uint32_t>>& together, const std::vector<uint32_t>& place) {
    uint64_t span = 0;
    for (const std::vector<uint32_t>& group : together) {
        uint32_t low = ~0u, high = 0;
        for (const uint32_t axis : group) {
            low = std::min(low, place[axis]);
            high = std::max(high, place[axis]);
        }
        span += high - low;
    }
    return span;
}

}  // namespace

std::vector<uint32_t> force_order(size_t axes, const std::vector<std::vector<uint32_t>>& together) {
    std::vector<uint32_t> order(axes), place(axes);
    std::iota(order.begin(), order.end(), 0u);
    std::iota(place.begin(), place.end(), 0u);
    std::vector<uint32_t> best = order;
    uint64_t best_span = total_span(together, place);
    size_t pins = 0, idle = 0;
    for (const auto& group : together) pins += group.size();
    const size_t rounds = std::min<size_t>(200, 10 + 4'000'000 / (pins + axes + 1));
    // Centres of gravity in integers scaled by 2^16: a floating sum would tie the order to the compiler.
    for (size_t round = 0; round < rounds && idle < 12; ++round) {
        std::vector<uint64_t> sum(axes, 0), groups(axes, 0);
        for (const std::vector<uint32_t>& group : together) {
            if (group.empty()) continue;
            uint64_t centre = 0;
            for (const uint32_t axis : group) centre += uint64_t{place[axis]} << 16;
            centre /= group.size();
            for (const uint32_t axis : group) {
                sum[axis] += centre;
                ++groups[axis];
            }
        }
        for (size_t axis = 0; axis < axes; ++axis)
            sum[axis] = groups[axis] == 0 ? uint64_t{place[axis]} << 16 : sum[axis] / groups[axis];
        std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return sum[a] < sum[b]; });
        for (uint32_t level = 0; level < axes; ++level) place[order[level]] = level;
        const uint64_t span = total_span(together, place);
        ++idle;
        if (span >= best_span) continue;
        best_span = span;
        best = order;
        idle = 0;
    }
    return best;
}

}  // namespace kiln
