#include <algorithm>
#include <cstdio>
#include <ctime>

#include "cache/server/facts.h"

namespace kiln {

namespace {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
        }
    }
    return out;
}

std::string size_text(uint64_t bytes) {
    constexpr const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double value = static_cast<double>(bytes);
    size_t unit = 0;
    for (; value >= 1024 && unit + 1 < std::size(units); ++unit) value /= 1024;
    char text[32];
    std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", value, units[unit]);
    return text;
}

std::string count_text(uint64_t value) {
    std::string text = std::to_string(value);
    for (auto at = static_cast<ptrdiff_t>(text.size()) - 3; at > 0; at -= 3) text.insert(static_cast<size_t>(at), "\u202f");
    return text;
}

std::string rate_text(uint64_t hits, uint64_t misses) {
    if (hits + misses == 0) return "\u2013";
    char text[32];
    std::snprintf(text, sizeof text, "%.1f\u202f%%", 100.0 * static_cast<double>(hits) / static_cast<double>(hits + misses));
    return text;
}

std::string time_text(int64_t time) {
    const auto t = static_cast<time_t>(time);
    tm parts{};
    ::gmtime_r(&t, &parts);
    char text[40];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &parts)};
}

std::string duration_text(int64_t seconds) {
    char text[48];
    if (seconds >= 86'400)
        std::snprintf(text, sizeof text, "%lld d %lld h", static_cast<long long>(seconds / 86'400),
                      static_cast<long long>(seconds % 86'400 / 3600));
    else if (seconds >= 3600)
        std::snprintf(text, sizeof text, "%lld h %lld min", static_cast<long long>(seconds / 3600),
                      static_cast<long long>(seconds % 3600 / 60));
    else
        std::snprintf(text, sizeof text, "%lld min %lld s", static_cast<long long>(seconds / 60),
                      static_cast<long long>(seconds % 60));
    return text;
}

constexpr const char* style =
    ":root{color-scheme:light dark;--ground:#fbfaf8;--ink:#22201c;--quiet:#6b665d;--line:#ded9d0;--fill:#b4532a;--track:#ebe6dd}"
    "@media(prefers-color-scheme:dark){:root{--ground:#191816;--ink:#e9e5dd;--quiet:#a09a8e;--line:#38352f;--fill:#e08a5c;--"
    "track:#2a2824}}"
    "*{box-sizing:border-box}body{margin:0 auto;padding:1.5rem 1rem "
    "3rem;max-width:60rem;background:var(--ground);color:var(--ink);"
    "font:16px/1.5 system-ui,sans-serif}h1{font-size:1.4rem;margin:0}h2{font-size:1.05rem;margin:2rem 0 .5rem}p{margin:.2rem 0}"
    ".quiet{color:var(--quiet)}.numbers{display:grid;grid-template-columns:repeat(auto-fit,minmax(10rem,1fr));gap:1rem;margin:1."
    "2rem 0}"
    ".numbers b{display:block;font-size:1.6rem;line-height:1.2;font-variant-numeric:tabular-nums}.scroll{overflow-x:auto}"
    "table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}th,td{text-align:right;padding:.3rem .6rem;"
    "border-bottom:1px solid var(--line);white-space:nowrap}th{font-weight:600;color:var(--quiet)}th:first-child,td:first-child{"
    "text-align:left;padding-left:0}td.wide{white-space:normal;text-align:left;overflow-wrap:anywhere}.bar{height:.6rem;border-"
    "radius:"
    ".3rem;background:var(--track);overflow:hidden}.bar i{display:block;height:100%;background:var(--fill)}";

class Page {
public:
    Page& operator<<(std::string_view text) {
        html_ += text;
        return *this;
    }
    void number(std::string_view value, std::string_view what) {
        *this << "<div><b>" << value << "</b><span class=quiet>" << what << "</span></div>";
    }
    std::string take() { return std::move(html_); }

private:
    std::string html_;
};

void disk(Page& page, const ServerFacts& facts) {
    page << "<h2>Disk</h2>";
    if (facts.disk_seen == 0) {
        page << "<p class=quiet>The folder has not been looked through yet.</p>";
        return;
    }
    const uint64_t used = facts.disk.entries().charged;
    const double part = facts.limit == 0 ? 0 : std::min(1.0, static_cast<double>(used) / static_cast<double>(facts.limit));
    char width[32];
    std::snprintf(width, sizeof width, "%.1f", 100 * part);
    page << "<div class=bar role=meter aria-label='disk used' aria-valuemin=0 aria-valuemax=100 aria-valuenow=" << width
         << "><i style='width:" << width << "%'></i></div><p>" << size_text(used)
         << (facts.limit == 0 ? std::string(", no limit") : " of " + size_text(facts.limit)) << ": "
         << count_text(facts.disk.blob.entries) << " blobs, " << count_text(facts.disk.action.entries)
         << " actions. <span class=quiet>" << count_text(facts.store.evicted) << " evicted since the start, "
         << count_text(facts.disk.quarantine.entries) << " in quarantine; looked through "
         << duration_text(facts.now - facts.disk_seen) << " ago.</span></p>";
}

void instances(Page& page, const ServerFacts& facts) {
    auto rows = facts.instances;
    const auto traffic = [](const Counts& c) {
        return c.action_hits + c.action_misses + c.blob_hits + c.blob_misses + c.blobs_written + c.actions_written;
    };
    std::stable_sort(rows.begin(), rows.end(),
                     [&](const auto& a, const auto& b) { return traffic(a.second) > traffic(b.second); });
    page << "<h2>Instances</h2>";
    if (rows.empty()) {
        page << "<p class=quiet>Nobody has asked for anything yet.</p>";
        return;
    }
    page << "<div class=scroll><table><thead><tr><th>Instance<th>Action hits<th>Blob hits<th>Actions stored<th>Blobs "
            "stored<th>Received<th>Sent<th>Conflicts</thead><tbody>";
    const size_t shown = std::min<size_t>(rows.size(), 12);
    for (size_t i = 0; i < shown; ++i) {
        const Counts& c = rows[i].second;
        page << "<tr><td>" << (rows[i].first.empty() ? std::string("(no name)") : escaped(rows[i].first)) << "<td>"
             << rate_text(c.action_hits, c.action_misses) << "<td>" << rate_text(c.blob_hits, c.blob_misses) << "<td>"
             << count_text(c.actions_written + c.actions_replaced) << "<td>" << count_text(c.blobs_written) << "<td>"
             << size_text(c.blob_bytes_in) << "<td>" << size_text(c.blob_bytes_out) << "<td>" << count_text(c.conflicts);
    }
    page << "</tbody></table></div>";
    if (shown < rows.size()) page << "<p class=quiet>And " << count_text(rows.size() - shown) << " with less traffic.</p>";
}

void events(Page& page, const ServerFacts& facts) {
    page << "<h2>Recent events</h2>";
    if (facts.events.empty()) {
        page << "<p class=quiet>No conflict and no failure of the disk since the start.</p>";
        return;
    }
    page << "<div class=scroll><table><thead><tr><th>When<th>What<th>Instance<th>Caller<th>Message</thead><tbody>";
    for (size_t i = 0; i < std::min<size_t>(facts.events.size(), 20); ++i) {
        const Event& e = facts.events[i];
        page << "<tr><td>" << time_text(e.time) << "<td>" << escaped(e.kind) << "<td>"
             << (e.instance.empty() ? "(no name)" : escaped(e.instance)) << "<td>" << escaped(e.caller) << "<td class=wide>"
             << escaped(e.message);
    }
    page << "</tbody></table></div>";
}

}  // namespace

std::string status_page(const ServerFacts& facts) {
    const Counts& c = facts.counts;
    Page page;
    page << "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width,initial-scale=1'>"
            "<title>kiln-cached</title><style>"
         << style << "</style><body><h1>kiln-cached " << escaped(facts.version) << "</h1><p class=quiet>Up "
         << duration_text(facts.now - facts.started) << ", since " << time_text(facts.started) << ".</p><div class=numbers>";
    page.number(rate_text(c.action_hits, c.action_misses),
                "of " + count_text(c.action_hits + c.action_misses) + " action lookups hit");
    page.number(rate_text(c.blob_hits, c.blob_misses), "of " + count_text(c.blob_hits + c.blob_misses) + " blob reads hit");
    page.number(size_text(c.blob_bytes_in), "received");
    page.number(size_text(c.blob_bytes_out), "sent");
    page.number(count_text(facts.http.open), "connections open");
    page.number(size_text(facts.in_flight), "of bodies in flight");
    page << "</div>";
    disk(page, facts);
    instances(page, facts);
    page << "<h2>Refused</h2><div class=scroll><table><thead><tr>";
    for (size_t i = 0; i < c.refused.size(); ++i) {
        std::string name = name_of(static_cast<Refusal>(i));
        std::replace(name.begin(), name.end(), '_', ' ');
        page << "<th>" << name;
    }
    page << "<th>digest mismatches<th>damaged on disk</thead><tbody><tr>";
    for (const uint64_t refused : c.refused) page << "<td>" << count_text(refused);
    page << "<td>" << count_text(c.mismatches) << "<td>" << count_text(facts.store.corrupt) << "</tbody></table></div>";
    events(page, facts);
    page << "</body></html>\n";
    return page.take();
}

}  // namespace kiln
