#include "cache/server/config.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <limits>
#include <set>

namespace kiln {

namespace {

Result<uint64_t> parse_number(std::string_view text, uint64_t least, uint64_t most) {
    uint64_t value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc() || end != text.data() + text.size() || value < least || value > most)
        return input_error("wants a number from " + std::to_string(least) + " to " + std::to_string(most));
    return value;
}

template <class T>
Status number(std::string_view text, T& out, uint64_t least, uint64_t most = std::numeric_limits<int32_t>::max()) {
    const auto value = parse_number(text, least, most);
    KILN_TRY(value);
    out = static_cast<T>(*value);
    return {};
}

Status size(std::string_view text, uint64_t& out, uint64_t least) {
    const auto value = parse_size(text);
    KILN_TRY(value);
    if (*value < least) return input_error("wants at least " + std::to_string(least) + " bytes");
    out = *value;
    return {};
}

Status seconds(std::string_view text, std::chrono::milliseconds& out) {
    const bool fine = text.size() > 2 && text.substr(text.size() - 2) == "ms";
    const auto value = parse_number(fine ? text.substr(0, text.size() - 2) : text, fine ? 1 : 0, fine ? 86'400'000 : 86'400);
    if (!value.ok()) return input_error("wants seconds up to 86400, or milliseconds as \"500ms\"");
    out = std::chrono::milliseconds(*value * (fine ? 1 : 1000));
    return {};
}

Status yes_or_no(std::string_view text, bool& out) {
    if (text != "true" && text != "false") return input_error("wants true or false");
    out = text == "true";
    return {};
}

template <class T>
Status choice(std::string_view text, T& out, std::initializer_list<std::pair<const char*, T>> choices) {
    std::string all;
    for (const auto& [name, value] : choices) {
        if (text == name) {
            out = value;
            return {};
        }
        all += (all.empty() ? "" : ", ") + std::string(name);
    }
    return input_error("wants one of " + all);
}

Status text(std::string_view value, std::string& out) {
    if (value.empty()) return input_error("wants a value");
    out = value;
    return {};
}

using Take = std::function<Status(std::string_view, Config&)>;

const std::vector<std::pair<std::string_view, Take>>& table() {
    static const std::vector<std::pair<std::string_view, Take>> rows{
        {"listen",
         [](auto v, Config& c) -> Status {
             const auto address = parse_address(v);
             KILN_TRY(address);
             std::tie(c.http.address, c.http.port) = *address;
             return {};
         }},
        {"grpc",
         [](auto v, Config& c) -> Status {
             if (v == "off") {
                 c.grpc_port = -1;
                 return {};
             }
             const auto address = parse_address(v);
             KILN_TRY(address);
             c.grpc_address = address->first;
             c.grpc_port = address->second;
             return {};
         }},
        {"folder", [](auto v, Config& c) { return text(v, c.folder); }},
        {"limit", [](auto v, Config& c) { return size(v, c.disk.limit, 1 << 20); }},
        {"sync",
         [](auto v, Config& c) {
             return choice(v, c.disk.sync, {{"none", Sync::none}, {"file", Sync::file}, {"folder", Sync::folder}});
         }},
        {"verify_again", [](auto v, Config& c) { return number(v, c.verify_again_after, 0); }},
        {"tokens", [](auto v, Config& c) { return text(v, c.tokens); }},
        {"anonymous",
         [](auto v, Config& c) -> Status {
             c.anonymous_set = true;
             c.anonymous = {};
             if (v == "none") return {};
             const auto roles = parse_roles(v);
             KILN_TRY(roles);
             if (roles->has(Role::admin)) return input_error("nobody without a token administers");
             c.anonymous = *roles;
             return {};
         }},
        {"tls.certificate", [](auto v, Config& c) { return text(v, c.http.certificate); }},
        {"tls.key", [](auto v, Config& c) { return text(v, c.http.key); }},
        {"plain_text", [](auto v, Config& c) { return yes_or_no(v, c.plain_text); }},
        {"limits.blob", [](auto v, Config& c) { return size(v, c.limits.blob, 1024); }},
        {"limits.action", [](auto v, Config& c) { return size(v, c.limits.action, 1024); }},
        {"limits.opaque_action", [](auto v, Config& c) { return size(v, c.limits.opaque_action, 1024); }},
        {"limits.in_flight", [](auto v, Config& c) { return size(v, c.limits.in_flight, 64 * 1024); }},
        {"limits.connections", [](auto v, Config& c) { return number(v, c.http.connections, 1, 1'000'000); }},
        {"limits.header", [](auto v, Config& c) { return number(v, c.http.header_bytes, 1024, 1 << 20); }},
        {"timeouts.head", [](auto v, Config& c) { return seconds(v, c.http.head_timeout); }},
        {"timeouts.body", [](auto v, Config& c) { return seconds(v, c.http.body_timeout); }},
        {"timeouts.write", [](auto v, Config& c) { return seconds(v, c.http.write_timeout); }},
        {"timeouts.idle", [](auto v, Config& c) { return seconds(v, c.http.idle_timeout); }},
        {"timeouts.patience", [](auto v, Config& c) { return seconds(v, c.http.patience); }},
        {"limits.slowest", [](auto v, Config& c) { return size(v, c.http.slowest, 1); }},
        {"timeouts.drain", [](auto v, Config& c) { return seconds(v, c.drain); }},
        {"threads.io", [](auto v, Config& c) { return number(v, c.http.io_threads, 1, 64); }},
        {"threads.work", [](auto v, Config& c) { return number(v, c.http.work_threads, 0, 256); }},
        {"chaos",
         [](auto v, Config& c) -> Status {
             const auto chaos = Chaos::parse(v);
             if (!chaos.ok()) return input_error("wants seed=N,loss=P,error=P,flip=P,delay=MS with chances P from 0 to 1");
             c.chaos = *chaos;
             c.chaos_text = v;
             return {};
         }},
        {"log",
         [](auto v, Config& c) {
             return choice(v, c.log, {{"off", LogLevel::off}, {"events", LogLevel::events}, {"requests", LogLevel::requests}});
         }},
    };
    return rows;
}

// "instances.3.opaque": the rule that the number names, made when it is the next one. `told`: those whose `replace` was said,
// before or after their `opaque`.
Status apply_instance(std::string_view name, std::string_view value, std::vector<InstanceRule>& rules, bool first,
                      std::set<uint64_t>& told) {
    const size_t dot = name.find('.');
    if (dot == std::string_view::npos) return input_error("instances are a list of maps with a name");
    const auto index = parse_number(name.substr(0, dot), 0, 9999);
    KILN_TRY(index);
    if (first) rules.clear();
    if (*index > rules.size()) return input_error("instances are numbered from 0");
    if (*index == rules.size()) rules.emplace_back();
    InstanceRule& rule = rules[*index];
    const std::string_view key = name.substr(dot + 1);
    if (key == "name") {
        rule.names = value;
        return {};
    }
    if (key == "parent") {
        rule.parent = std::string(value);
        return {};
    }
    if (key == "opaque") {
        KILN_TRY(yes_or_no(value, rule.opaque));
        if (!told.contains(*index))
            rule.replace = rule.opaque;  // what writes opaque values (ccache's manifests) writes them anew
        return {};
    }
    if (key == "replace") {
        told.insert(*index);
        return yes_or_no(value, rule.replace);
    }
    return input_error("is no key of an instance: name, parent, opaque, replace");
}

}  // namespace

Result<uint64_t> parse_size(std::string_view text) {
    uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, failed] = std::from_chars(text.data(), end, value);
    const std::string_view unit(rest, static_cast<size_t>(end - rest));
    const std::pair<std::string_view, uint64_t> units[] = {
        {"", 1},      {"KiB", 1 << 10},  {"MiB", 1 << 20},      {"GiB", 1 << 30},         {"TiB", uint64_t{1} << 40},
        {"kB", 1000}, {"MB", 1'000'000}, {"GB", 1'000'000'000}, {"TB", 1'000'000'000'000}};
    for (const auto& [name, factor] : units)
        if (failed == std::errc() && unit == name && value <= std::numeric_limits<int64_t>::max() / factor) return value * factor;
    return input_error("wants a size such as 512MiB or 50GiB");
}

Result<std::pair<std::string, uint16_t>> parse_address(std::string_view text) {
    const auto wrong = [] { return input_error("wants a numeric address and a port such as 127.0.0.1:8080 or [::1]:8080"); };
    const size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) return wrong();
    std::string_view host = text.substr(0, colon);
    const auto port = parse_number(text.substr(colon + 1), 0, 65535);
    if (!port.ok()) return wrong();
    const bool six = host.size() > 2 && host.front() == '[' && host.back() == ']';
    if (six) host = host.substr(1, host.size() - 2);
    const std::string address(host);
    unsigned char bytes[16];
    if (address.find('\0') != std::string::npos || ::inet_pton(six ? AF_INET6 : AF_INET, address.c_str(), bytes) != 1)
        return wrong();
    return std::pair(address, static_cast<uint16_t>(*port));
}

bool is_loopback(std::string_view address) { return address == "::1" || address.substr(0, 4) == "127."; }

Status apply(const std::vector<Setting>& settings, Config& config) {
    bool first_instance = true;
    std::set<uint64_t> told_replace;
    for (const Setting& setting : settings) {
        const auto wrong = [&](const std::string& what) {
            const std::string where =
                setting.line == 0 ? "--" + setting.name : "line " + std::to_string(setting.line) + ": " + setting.name;
            return Error{setting.line == 0 ? Fault::usage : Fault::input, where + ": " + what};
        };
        constexpr std::string_view list = "instances.";
        if (setting.name.substr(0, list.size()) == list) {
            const Status done = apply_instance(std::string_view(setting.name).substr(list.size()), setting.value,
                                               config.instances, first_instance, told_replace);
            if (!done.ok()) return wrong(done.error().message);
            first_instance = false;
            continue;
        }
        const auto row = std::find_if(table().begin(), table().end(), [&](const auto& r) { return r.first == setting.name; });
        if (row == table().end()) return wrong("there is no such setting");
        const Status done = row->second(setting.value, config);
        if (!done.ok()) return wrong(done.error().message);
    }
    return {};
}

Status check(const Config& config) {
    if (config.folder.empty()) return Error{Fault::usage, "no folder for the cache was given (folder: or --folder)"};
    if (config.http.certificate.empty() != config.http.key.empty())
        return Error{Fault::usage, "a certificate and a key go together (tls.certificate, tls.key)"};
    if (config.anonymous_set && config.tokens.empty())
        return Error{Fault::usage, "'anonymous' says what callers without a token may do; there are no tokens"};
    const bool http_open = !is_loopback(config.http.address);
    const bool open = http_open || (config.grpc_port >= 0 && !is_loopback(config.grpc_address));
    if (open && config.tokens.empty())
        return Error{Fault::usage, "listening beyond loopback takes tokens: whoever reaches the server could write to it"};
    if (open && config.http.certificate.empty() && !config.plain_text)
        return Error{Fault::usage,
                     "listening beyond loopback takes TLS: tokens would pass in the clear (plain_text: true, if something in "
                     "front does it)"};
    const auto instances = Instances::make(config.instances);
    if (!instances.ok()) return instances.error();
    return {};
}

}  // namespace kiln
