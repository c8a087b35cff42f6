#pragma once
// What has happened since the server started, for /status, /metrics and tests.

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "cache/server/answer.h"

namespace kiln {

struct Counts {
    uint64_t blob_hits = 0, blob_misses = 0, blob_bytes_out = 0;
    uint64_t blobs_written = 0, blobs_already_there = 0, blob_bytes_in = 0;
    uint64_t action_hits = 0, action_misses = 0;
    uint64_t actions_incomplete = 0;  // of the misses: there, but a blob it names is gone
    uint64_t actions_written = 0, actions_already_there = 0;
    uint64_t actions_replaced = 0;
    uint64_t conflicts = 0;             // writes of other bytes under a name whose first value is whole; the first was kept
    uint64_t mismatches = 0;            // bodies that did not match their digest
    std::array<uint64_t, 8> refused{};  // by Refusal
    Counts& operator+=(const Counts& other);
};

struct Event {
    int64_t time = 0;  // seconds since 1970
    std::string kind, instance, caller, message;
};

// Thread-safe. Instances beyond `most_instances` are counted together, as "(others)", so that a client's choice of names
// cannot fill memory.
class Counters {
public:
    static constexpr size_t most_instances = 512;
    static constexpr size_t most_events = 64;

    void add(const std::string& instance, const Counts& counts);
    void event(Event event);
    Counts total() const;
    std::vector<std::pair<std::string, Counts>> by_instance() const;
    std::vector<Event> recent() const;  // latest first

private:
    mutable std::mutex mutex_;
    Counts total_;
    std::map<std::string, Counts> instances_;
    std::vector<Event> events_;  // a ring
    size_t next_ = 0;
};

}  // namespace kiln
