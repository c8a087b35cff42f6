#pragma once
// What a server can say about itself at a moment; /status and /metrics are two ways of writing it.

#include "cache/server/http_server.h"
#include "cache/server/service.h"

namespace kiln {

struct ServerFacts {
    std::string version;
    int64_t now = 0, started = 0;  // seconds since 1970
    DiskStore::Stats disk;         // as of the last look, which takes a walk over the folder
    int64_t disk_seen = 0;         // when that was; 0: not yet
    uint64_t limit = 0;            // of the store, bytes
    DiskStore::Counters store;
    Counts counts;
    std::vector<std::pair<std::string, Counts>> instances;
    std::vector<Event> events;  // latest first
    uint64_t in_flight = 0, answering = 0, hashed = 0;
    HttpStats http;
    std::optional<ChaosStore::Counters> chaos;
};

// A page for a person, without scripts. Everything that came from a client is escaped.
std::string status_page(const ServerFacts& facts);
// Prometheus' text format.
std::string metrics_page(const ServerFacts& facts);

}  // namespace kiln
