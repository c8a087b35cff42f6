#pragma once
// Who may do what. A token stands for a Caller, which has roles in the instances that its grants name.
//
//     token file := line*         line := "#"… | name SP token (SP grant)* (SP "until=" YYYY-MM-DD)?
//     grant      := instances ":" role ("," role)*
//     instances  := "*" | instance-name | prefix "/*"
//     role       := "read" | "cas-write" | "ac-write" | "admin"
//     token      := 16 to 512 printable characters without spaces | "sha256:" 64 lower-case hex digits of such a token
//
// `admin` implies the other roles and may replace action records. A token stops being valid when its `until` day begins (UTC).
// The file must belong to nobody but its owner (no permission bits for group or others).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/base/result.h"

namespace kiln {

enum class Role : uint8_t { read = 1, cas_write = 2, ac_write = 4, admin = 8 };

class Roles {
public:
    constexpr Roles() = default;
    constexpr Roles(std::initializer_list<Role> roles) {
        for (const Role r : roles) add(r);
    }
    constexpr void add(Role role) { bits_ |= role == Role::admin ? uint8_t{15} : static_cast<uint8_t>(role); }
    constexpr void add(Roles other) { bits_ |= other.bits_; }
    constexpr bool has(Role role) const { return (bits_ & static_cast<uint8_t>(role)) != 0; }
    constexpr bool empty() const { return bits_ == 0; }
    friend bool operator==(Roles, Roles) = default;

private:
    uint8_t bits_ = 0;
};

// "read,ac-write"; an Error names the word that is no role.
Result<Roles> parse_roles(std::string_view text);

struct Grant {
    std::string instances;  // "*", a name, or "prefix/*"
    Roles roles;
};

// True when `pattern` ("*", a name, "prefix/*") covers the instance. "prefix/*" covers every name below it, not `prefix`.
bool covers(std::string_view pattern, std::string_view instance);

class Caller {
public:
    Caller() = default;  // may nothing
    Caller(std::string name, std::vector<Grant> grants, bool known)
        : name_(std::move(name)), grants_(std::move(grants)), known_(known) {}
    // A caller that may do everything but administer, everywhere: a server on loopback without tokens.
    static Caller trusted() { return {"anonymous", {{"*", {Role::read, Role::cas_write, Role::ac_write}}}, true}; }

    Roles roles(std::string_view instance) const;
    bool may(Role role, std::string_view instance) const { return roles(instance).has(role); }
    bool may_anywhere(Role role) const;
    const std::string& name() const { return name_; }  // never the token
    // False: no valid token was shown, and one might give more.
    bool known() const { return known_; }

private:
    std::string name_ = "nobody";
    std::vector<Grant> grants_;
    bool known_ = false;
};

// The tokens of a server. Immutable; a reload makes another one.
class Access {
public:
    // `anonymous`: what a caller without a token may do, in every instance.
    explicit Access(Roles anonymous = {});
    // A server without tokens: whoever reaches it is trusted (config.h allows that on loopback only).
    static Access open();

    static Result<Access> parse(std::string_view text, Roles anonymous);
    // Refuses a file that group or others may read or write, and what is not a regular file.
    static Result<Access> load(const std::string& path, Roles anonymous);

    // The caller with this token, or anonymous. Compares against every token in the same time whichever it is. `now`: seconds
    // since 1970.
    const Caller& caller(std::string_view token, int64_t now) const;
    const Caller& anonymous() const { return anonymous_; }
    size_t tokens() const { return entries_.size(); }

private:
    struct Entry {
        Digest secret;      // SHA-256 of the token
        int64_t until = 0;  // seconds since 1970; 0: for ever
        Caller caller;
    };
    Caller anonymous_, rejected_;
    std::vector<Entry> entries_;
};

}  // namespace kiln
