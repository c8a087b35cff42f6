#include "cache/server/log.h"

#include <cstdio>
#include <ctime>

#include "cache/disk_folder.h"

namespace kiln {

namespace {

constexpr size_t write_at = 16 * 1024;

// The length of the UTF-8 sequence at the start of `text`, 0 when there is none.
size_t utf8_length(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const unsigned lead = byte(0);
    const size_t length = lead >= 0xC2 && lead <= 0xDF   ? 2
                          : lead >= 0xE0 && lead <= 0xEF ? 3
                          : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                         : 0;
    for (size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0) != 0x80) return 0;
    if ((lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xED && byte(1) >= 0xA0)) return 0;
    if ((lead == 0xF0 && byte(1) < 0x90) || (lead == 0xF4 && byte(1) >= 0x90)) return 0;
    return length;
}

}  // namespace

std::string json_escaped(std::string_view text, size_t most) {
    std::string out;
    for (size_t i = 0; i < text.size();) {
        if (i >= most) return out + "...";
        const auto c = static_cast<unsigned char>(text[i]);
        if (c == '"' || c == '\\') {
            out += '\\';
            out += text[i++];
        } else if (c >= 0x20 && c < 0x7f) {
            out += text[i++];
        } else if (const size_t length = c < 0x80 ? 0 : utf8_length(text.substr(i)); length != 0) {
            out += text.substr(i, length);
            i += length;
        } else {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04x", c);
            out += code;
            ++i;
        }
    }
    return out;
}

LogLine::LogLine(std::string_view kind) {
    timespec now{};
    ::clock_gettime(CLOCK_REALTIME, &now);
    tm parts{};
    ::gmtime_r(&now.tv_sec, &parts);
    char time[40];
    const size_t length = std::strftime(time, sizeof time, "%Y-%m-%dT%H:%M:%S", &parts);
    std::snprintf(time + length, sizeof time - length, ".%03dZ", static_cast<int>(now.tv_nsec / 1'000'000));
    line_ = "{\"time\":\"";
    line_ += time;
    line_ += '"';
    text("kind", kind);
}

LogLine& LogLine::text(std::string_view name, std::string_view value) {
    ((line_ += ",\"") += name) += "\":\"";
    (line_ += json_escaped(value)) += '"';
    return *this;
}

LogLine& LogLine::number(std::string_view name, uint64_t value) {
    ((line_ += ",\"") += name) += "\":";
    line_ += std::to_string(value);
    return *this;
}

std::string LogLine::finish() { return std::move(line_) + "}\n"; }

void Log::request(LogLine line) {
    if (level_ != LogLevel::requests) return;
    const std::lock_guard lock(mutex_);
    waiting_ += line.finish();
    if (waiting_.size() >= write_at) write_locked();
}

void Log::event(LogLine line) {
    if (level_ == LogLevel::off) return;
    const std::lock_guard lock(mutex_);
    waiting_ += line.finish();
    write_locked();
}

void Log::flush() {
    const std::lock_guard lock(mutex_);
    write_locked();
}

void Log::write_locked() {
    (void)write_all(fd_, {reinterpret_cast<const uint8_t*>(waiting_.data()), waiting_.size()});  // nowhere to complain to
    waiting_.clear();
}

}  // namespace kiln
