#pragma once
// Structured logs: one JSON object a line. Values are escaped here, so that nothing a client sends can end a line or forge a
// field; no secret is ever given to it.

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace kiln {

// Text as the inside of a JSON string; what is not printable ASCII or UTF-8 becomes an escape. Cut at `most` bytes.
std::string json_escaped(std::string_view text, size_t most = 256);

class LogLine {
public:
    explicit LogLine(std::string_view kind);  // with the time, in UTC
    LogLine& text(std::string_view name, std::string_view value);
    LogLine& number(std::string_view name, uint64_t value);
    std::string finish();

private:
    std::string line_;
};

enum class LogLevel { off, events, requests };

// Thread-safe. Requests are gathered and written when there are many or on flush(); events at once.
class Log {
public:
    Log(int fd, LogLevel level) : fd_(fd), level_(level) {}
    ~Log() { flush(); }
    bool wants_requests() const { return level_ == LogLevel::requests; }
    void request(LogLine line);
    void event(LogLine line);
    void flush();

private:
    void write_locked();
    const int fd_;
    const LogLevel level_;
    std::mutex mutex_;
    std::string waiting_;
};

}  // namespace kiln
