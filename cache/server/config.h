#pragma once
// What kiln-cached is told: a file in YAML, then flags that override it. Unknown keys, wrong types and values that do not fit
// are errors at their line. The same names serve both ways: `limits: {blob: 1GiB}` is --limits.blob=1GiB.

#include <string>
#include <string_view>
#include <vector>

#include "cache/server/http_server.h"
#include "cache/server/service.h"

namespace kiln {

struct Config {
    std::string folder;  // of the store; must be given
    DiskOptions disk;
    HttpOptions http;
    std::string grpc_address = "127.0.0.1";
    int grpc_port = -1;  // -1: no gRPC front; 0: the kernel chooses
    std::string tokens;  // file; empty: none
    Roles anonymous;
    bool anonymous_set = false;
    bool plain_text = false;  // serve without TLS beyond loopback: something in front of the server does it
    std::vector<InstanceRule> instances;
    ServiceLimits limits;
    int64_t verify_again_after = 600;  // seconds
    std::chrono::milliseconds drain{20'000};
    std::optional<Chaos> chaos;  // for tests: hurt whoever calls
    std::string chaos_text;      // as it was given
    LogLevel log = LogLevel::requests;
};

// One setting as it stands in a file or on the command line.
struct Setting {
    std::string name;  // "limits.blob"; of a list, "instances.0.name"
    std::string value;
    int line = 0;  // 0: the command line
};

// The scalars of a YAML document, in order. Only maps, sequences and scalars pass: no anchors, aliases, tags, further documents
// or repeated keys.
Result<std::vector<Setting>> settings_of(std::string_view yaml);

// Applies settings over what `config` holds.
Status apply(const std::vector<Setting>& settings, Config& config);
// What one setting alone cannot tell: that the folder is there, and that a server which strangers can reach has tokens and TLS.
Status check(const Config& config);

// "64KiB", "10GiB", "4096": bytes. Decimal units (kB, MB, GB) as well.
Result<uint64_t> parse_size(std::string_view text);
// "127.0.0.1:8080", "[::1]:0": a numeric address and a port.
Result<std::pair<std::string, uint16_t>> parse_address(std::string_view text);
bool is_loopback(std::string_view address);

}  // namespace kiln
