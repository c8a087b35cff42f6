// The only file that includes prometheus-cpp: its serializer alone, since the counters live elsewhere and one snapshot of them
// is consistent, which a registry of separate gauges would not be.
#include <prometheus/metric_family.h>
#include <prometheus/text_serializer.h>

#include "cache/server/facts.h"

namespace kiln {

namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;

class Families {
public:
    using Labels = std::vector<std::pair<std::string, std::string>>;

    void begin(const char* name, const char* help, MetricType type) {
        all_.emplace_back();
        all_.back().name = std::string("kiln_cached_") + name;
        all_.back().help = help;
        all_.back().type = type;
    }
    void add(uint64_t value, const Labels& labels = {}) {
        ClientMetric metric;
        for (const auto& [name, text] : labels) metric.label.push_back({name, text});
        (all_.back().type == MetricType::Counter ? metric.counter.value : metric.gauge.value) = static_cast<double>(value);
        all_.back().metric.push_back(std::move(metric));
    }
    void one(const char* name, const char* help, MetricType type, uint64_t value) {
        begin(name, help, type);
        add(value);
    }
    std::string text() const { return prometheus::TextSerializer().Serialize(all_); }

private:
    std::vector<MetricFamily> all_;
};

}  // namespace

std::string metrics_page(const ServerFacts& facts) {
    Families f;
    const auto counter = MetricType::Counter;
    const auto gauge = MetricType::Gauge;
    f.begin("requests_total", "Cache operations by instance, kind and result.", counter);
    for (const auto& [instance, c] : facts.instances) {
        const auto row = [&, &name = instance](const char* kind, const char* result, uint64_t value) {
            f.add(value, {{"instance", name}, {"kind", kind}, {"result", result}});
        };
        row("blob_get", "hit", c.blob_hits);
        row("blob_get", "miss", c.blob_misses);
        row("action_get", "hit", c.action_hits);
        row("action_get", "miss", c.action_misses);
        row("blob_put", "written", c.blobs_written);
        row("blob_put", "already_there", c.blobs_already_there);
        row("action_put", "written", c.actions_written);
        row("action_put", "already_there", c.actions_already_there);
        row("action_put", "replaced", c.actions_replaced);
        row("action_put", "conflict", c.conflicts);
    }
    f.begin("refused_total", "Requests refused, by reason.", counter);
    for (size_t i = 0; i < facts.counts.refused.size(); ++i)
        f.add(facts.counts.refused[i], {{"reason", name_of(static_cast<Refusal>(i))}});
    f.one("actions_incomplete_total", "Actions that were there but named a blob that is gone; also counted as misses.", counter,
          facts.counts.actions_incomplete);
    f.one("digest_mismatches_total", "Bodies that did not match their digest.", counter, facts.counts.mismatches);
    f.one("blob_bytes_received_total", "Bytes of blobs received.", counter, facts.counts.blob_bytes_in);
    f.one("blob_bytes_sent_total", "Bytes of blobs read for clients.", counter, facts.counts.blob_bytes_out);
    f.one("corrupt_total", "Entries found damaged on disk and set aside.", counter, facts.store.corrupt);
    f.one("evicted_total", "Entries evicted to stay under the limit.", counter, facts.store.evicted);
    f.one("store_failures_total", "Calls that the disk failed.", counter, facts.store.failures);
    f.one("verifications_total", "Blobs hashed before they were sent.", counter, facts.hashed);
    f.begin("disk_bytes", "Bytes of the store's files, by keyspace.", gauge);
    f.add(facts.disk.action.bytes, {{"keyspace", "action"}});
    f.add(facts.disk.blob.bytes, {{"keyspace", "blob"}});
    f.add(facts.disk.quarantine.bytes, {{"keyspace", "quarantine"}});
    f.begin("disk_entries", "Files of the store, by keyspace.", gauge);
    f.add(facts.disk.action.entries, {{"keyspace", "action"}});
    f.add(facts.disk.blob.entries, {{"keyspace", "blob"}});
    f.add(facts.disk.quarantine.entries, {{"keyspace", "quarantine"}});
    f.one("disk_limit_bytes", "The bound of the store.", gauge, facts.limit);
    f.one("bodies_in_flight_bytes", "Memory held for request bodies.", gauge, facts.in_flight);
    f.one("responses_in_flight_bytes", "Memory held for responses over 32 KiB.", gauge, facts.answering);
    f.one("http_connections", "Open HTTP connections.", gauge, facts.http.open);
    f.one("http_connections_total", "HTTP connections accepted.", counter, facts.http.accepted);
    f.one("http_connections_refused_total", "HTTP connections over the cap.", counter, facts.http.over_cap);
    f.one("http_requests_total", "HTTP requests.", counter, facts.http.requests);
    f.one("http_malformed_total", "Requests that were not HTTP as it is taken here.", counter, facts.http.malformed);
    f.one("http_timeouts_total", "Connections ended by a deadline in the middle of a request.", counter, facts.http.timeouts);
    f.one("tls_handshakes_failed_total", "TLS handshakes that failed.", counter, facts.http.handshakes_failed);
    f.one("accept_waits_total", "Times that accepting waited for file descriptors.", counter, facts.http.out_of_files);
    if (facts.chaos) {
        f.begin("chaos_total", "What --chaos did, by kind.", counter);
        f.add(facts.chaos->lost, {{"kind", "lost"}});
        f.add(facts.chaos->failed, {{"kind", "failed"}});
        f.add(facts.chaos->flipped, {{"kind", "flipped"}});
        f.add(facts.chaos->delayed, {{"kind", "delayed"}});
    }
    f.one("start_time_seconds", "When the server started, in seconds since 1970.", gauge, static_cast<uint64_t>(facts.started));
    return f.text();
}

}  // namespace kiln
