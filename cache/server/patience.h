#pragma once
// How long a body or an answer may take in all, over either protocol.

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace kiln {

// `patience`, and the bytes at `slowest` a second; never so long that a clock cannot hold it.
inline std::chrono::milliseconds whole_time(std::chrono::milliseconds patience, uint64_t bytes, uint64_t slowest) {
    constexpr std::chrono::seconds most = std::chrono::hours(24 * 365);
    const uint64_t seconds = std::min<uint64_t>(bytes / std::max<uint64_t>(slowest, 1), most.count());
    return std::min<std::chrono::milliseconds>(patience, most) + std::chrono::seconds(seconds);
}

}  // namespace kiln
