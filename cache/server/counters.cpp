// One mutex for all: an update is a few additions, some tens of nanoseconds beside a request's tens of microseconds.
#include "cache/server/counters.h"

#include <algorithm>

namespace kiln {

const char* name_of(Refusal refusal) {
    switch (refusal) {
        case Refusal::bad_request:
            return "bad_request";
        case Refusal::unauthenticated:
            return "unauthenticated";
        case Refusal::forbidden:
            return "forbidden";
        case Refusal::unknown_instance:
            return "unknown_instance";
        case Refusal::too_large:
            return "too_large";
        case Refusal::busy:
            return "busy";
        case Refusal::full:
            return "full";
        case Refusal::failed:
            return "failed";
    }
    return "failed";
}

Counts& Counts::operator+=(const Counts& other) {
    blob_hits += other.blob_hits;
    blob_misses += other.blob_misses;
    blob_bytes_out += other.blob_bytes_out;
    blobs_written += other.blobs_written;
    blobs_already_there += other.blobs_already_there;
    blob_bytes_in += other.blob_bytes_in;
    action_hits += other.action_hits;
    action_misses += other.action_misses;
    actions_incomplete += other.actions_incomplete;
    actions_written += other.actions_written;
    actions_already_there += other.actions_already_there;
    actions_replaced += other.actions_replaced;
    conflicts += other.conflicts;
    mismatches += other.mismatches;
    for (size_t i = 0; i < refused.size(); ++i) refused[i] += other.refused[i];
    return *this;
}

void Counters::add(const std::string& instance, const Counts& counts) {
    const std::lock_guard lock(mutex_);
    total_ += counts;
    auto found = instances_.find(instance);
    if (found == instances_.end())
        found = instances_.try_emplace(instances_.size() < most_instances ? instance : "(others)").first;
    found->second += counts;
}

void Counters::event(Event event) {
    const std::lock_guard lock(mutex_);
    if (events_.size() < most_events) {
        events_.push_back(std::move(event));
        return;
    }
    events_[next_] = std::move(event);
    next_ = (next_ + 1) % most_events;
}

Counts Counters::total() const {
    const std::lock_guard lock(mutex_);
    return total_;
}

std::vector<std::pair<std::string, Counts>> Counters::by_instance() const {
    const std::lock_guard lock(mutex_);
    return {instances_.begin(), instances_.end()};
}

std::vector<Event> Counters::recent() const {
    const std::lock_guard lock(mutex_);
    std::vector<Event> latest(events_);
    std::rotate(latest.begin(), latest.begin() + static_cast<std::ptrdiff_t>(next_), latest.end());
    std::reverse(latest.begin(), latest.end());
    return latest;
}

}  // namespace kiln
