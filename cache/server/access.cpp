// Tokens are compared as SHA-256 digests: equal lengths, and what timing might tell about a digest tells nothing about a token.
#include "cache/server/access.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "cache/disk_folder.h"
#include "cache/server/instances.h"

namespace kiln {

namespace {

constexpr size_t largest_token_file = size_t{1} << 20;

// The next word of a line; empty at its end.
std::string_view word(std::string_view& line) {
    const size_t start = line.find_first_not_of(" \t\r");
    if (start == std::string_view::npos) return line = {};
    const size_t end = std::min(line.find_first_of(" \t\r", start), line.size());
    const std::string_view found = line.substr(start, end - start);
    line.remove_prefix(end);
    return found;
}

bool printable(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

bool instances_valid(std::string_view pattern) {
    if (pattern == "*") return true;
    if (pattern.size() > 2 && pattern.substr(pattern.size() - 2) == "/*") pattern.remove_suffix(2);
    return valid_instance_name(pattern);
}

Result<int64_t> parse_day(std::string_view text) {
    const auto number = [&](size_t at, size_t digits) {
        int value = 0;
        for (size_t i = at; i < at + digits; ++i)
            value = text[i] >= '0' && text[i] <= '9' ? value * 10 + (text[i] - '0') : -100000;
        return value;
    };
    if (text.size() == 10 && text[4] == '-' && text[7] == '-') {
        using namespace std::chrono;
        const year_month_day day{year{number(0, 4)}, month{static_cast<unsigned>(number(5, 2))},
                                 std::chrono::day{static_cast<unsigned>(number(8, 2))}};
        if (day.ok() && number(0, 4) >= 1970) return int64_t{sys_days(day).time_since_epoch().count()} * 86'400;
    }
    return input_error("'until=' wants a day as YYYY-MM-DD");
}

Result<Grant> parse_grant(std::string_view text) {
    const size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) return input_error("a grant is INSTANCES:ROLE,ROLE");
    const auto roles = parse_roles(text.substr(colon + 1));
    KILN_TRY(roles);
    if (!instances_valid(text.substr(0, colon))) return input_error("a grant's instances are '*', a name or 'prefix/*'");
    return Grant{std::string(text.substr(0, colon)), *roles};
}

bool equal_in_constant_time(const Digest& a, const Digest& b) {
    uint8_t different = 0;
    for (size_t i = 0; i < a.bytes.size(); ++i) different |= static_cast<uint8_t>(a.bytes[i] ^ b.bytes[i]);
    return different == 0;
}

}  // namespace

Result<Roles> parse_roles(std::string_view text) {
    Roles roles;
    while (true) {
        const size_t comma = std::min(text.find(','), text.size());
        const std::string_view name = text.substr(0, comma);
        if (name == "read")
            roles.add(Role::read);
        else if (name == "cas-write")
            roles.add(Role::cas_write);
        else if (name == "ac-write")
            roles.add(Role::ac_write);
        else if (name == "admin")
            roles.add(Role::admin);
        else  // not repeated: a grant with its colon forgotten may hold anything
            return input_error("roles are read, cas-write, ac-write and admin");
        if (comma == text.size()) return roles;
        text.remove_prefix(comma + 1);
    }
}

bool covers(std::string_view pattern, std::string_view instance) {
    if (pattern == "*") return true;
    if (pattern.size() > 2 && pattern.substr(pattern.size() - 2) == "/*") {
        const std::string_view prefix = pattern.substr(0, pattern.size() - 1);  // with its slash
        return instance.size() > prefix.size() && instance.substr(0, prefix.size()) == prefix;
    }
    return pattern == instance;
}

Roles Caller::roles(std::string_view instance) const {
    Roles all;
    for (const Grant& grant : grants_)
        if (covers(grant.instances, instance)) all.add(grant.roles);
    return all;
}

bool Caller::may_anywhere(Role role) const {
    return std::any_of(grants_.begin(), grants_.end(), [&](const Grant& grant) { return grant.roles.has(role); });
}

Access::Access(Roles anonymous) : anonymous_("anonymous", {{"*", anonymous}}, false) {}

Access Access::open() {
    Access access;
    access.anonymous_ = Caller::trusted();
    access.rejected_ = Caller::trusted();
    return access;
}

Result<Access> Access::parse(std::string_view text, Roles anonymous) {
    Access access(anonymous);
    size_t number = 0;
    while (!text.empty()) {
        const size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        ++number;
        const auto wrong = [&](const std::string& what) { return input_error("line " + std::to_string(number) + ": " + what); };
        const std::string_view name = word(line);
        if (name.empty() || name[0] == '#') continue;
        const std::string_view token = word(line);
        if (!printable(name) || name.size() > 64) return wrong("a name is up to 64 printable characters");
        Entry entry;
        constexpr std::string_view hashed = "sha256:";
        if (token.substr(0, hashed.size()) == hashed) {
            const auto digest = Digest::from_hex(token.substr(hashed.size()));
            if (!digest) return wrong("'sha256:' wants 64 lower-case hex digits");
            entry.secret = *digest;
        } else if (!printable(token) || token.size() < 16 || token.size() > 512) {
            return wrong("a token is 16 to 512 printable characters");
        } else {
            entry.secret = sha256(as_bytes(token));
        }
        std::vector<Grant> grants;
        for (std::string_view next = word(line); !next.empty(); next = word(line)) {
            if (next.substr(0, 6) == "until=") {
                const auto day = parse_day(next.substr(6));
                if (!day.ok()) return wrong(day.error().message);
                entry.until = *day;
                continue;
            }
            auto grant = parse_grant(next);
            if (!grant.ok()) return wrong(grant.error().message);
            grants.push_back(std::move(*grant));
        }
        for (const Entry& other : access.entries_) {
            if (other.caller.name() == name) return wrong("the name stands on an earlier line, too");
            if (other.secret == entry.secret) return wrong("the token stands on an earlier line, too");
        }
        entry.caller = Caller(std::string(name), std::move(grants), true);
        access.entries_.push_back(std::move(entry));
    }
    return access;
}

Result<Access> Access::load(const std::string& path, Roles anonymous) {
    const auto wrong = [&](const std::string& what) { return input_error("token file " + path + ": " + what); };
    const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat info {};
    if (fd.get() < 0 || ::fstat(fd.get(), &info) != 0) return wrong(std::strerror(errno));
    if (!S_ISREG(info.st_mode)) return wrong("is no regular file");
    if ((info.st_mode & 077) != 0) return wrong("others than its owner have access to it; chmod 600");
    if (static_cast<uint64_t>(info.st_size) > largest_token_file) return wrong("is larger than 1 MiB");
    Bytes bytes(static_cast<size_t>(info.st_size));
    if (!read_all(fd.get(), bytes)) return wrong(std::strerror(errno));
    auto access = parse(as_text(bytes), anonymous);
    std::fill(bytes.begin(), bytes.end(), uint8_t{0});
    if (!access.ok()) return wrong(access.error().message);
    return access;
}

const Caller& Access::caller(std::string_view token, int64_t now) const {
    if (token.empty()) return anonymous_;
    const Digest shown = sha256(as_bytes(token));
    const Entry* found = nullptr;
    for (const Entry& entry : entries_) found = equal_in_constant_time(entry.secret, shown) ? &entry : found;
    if (found == nullptr || (found->until != 0 && now >= found->until)) return rejected_;
    return found->caller;
}

}  // namespace kiln
