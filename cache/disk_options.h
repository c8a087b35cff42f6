#pragma once
// How a disk store behaves: its bound, how hard it flushes, and what a test may put in the place of time and of the disk.

#include <chrono>
#include <cstdint>
#include <functional>

namespace kiln {

constexpr uint64_t default_cache_limit = uint64_t{5} << 30;

// What put() has done to the disk when it returns. In every case the entry is visible to all processes, and killing any of
// them does not take it back; the difference is a power cut.
enum class Sync {
    none,    // an entry may be lost or damaged; damage is found when it is read
    file,    // its bytes reached the disk before its name was given: it is whole or absent
    folder,  // its name reached the disk as well: it is there
};

// A moment in which a test may delay, fail (by returning an errno) or end the process.
enum class DiskStep { create, write, sync, lock, account, rename, evict, quarantine };

struct DiskOptions {
    uint64_t limit = default_cache_limit;  // bytes, counted in whole pages an entry; 0 means no bound
    Sync sync = Sync::file;
    bool index = true;  // false: count by scans alone
    std::chrono::milliseconds lock_wait{10'000};
    std::function<int64_t()> now;         // nanoseconds since 1970; empty: the system's clock
    std::function<int(DiskStep)> before;  // empty: nothing
};

// Where eviction stops once it has begun; it begins when an entry would pass the limit.
constexpr uint64_t low_watermark(uint64_t limit) { return limit - limit / 10; }

// What an entry counts for: whole pages, as most file systems give it.
constexpr uint64_t charge_of(uint64_t size) { return (size + 4095) / 4096 * 4096; }

}  // namespace kiln
