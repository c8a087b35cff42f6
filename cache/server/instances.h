#pragma once
// An instance is a name with an action keyspace of its own. Blobs are named by their content and shared by all instances:
// whoever knows a blob's SHA-256 and may read any instance gets it, which tells nobody anything that the digest did not.
//
// A pull request's instance reads its parent and never writes it: writes go to the instance that was named and no other.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/base/result.h"

namespace kiln {

// Up to 8 segments of [A-Za-z0-9._-], joined by '/', 128 characters in all; "" is the main instance. No segment is "." or
// "..", or a word that a protocol puts behind an instance name (ac, cas, blobs, uploads, …).
bool valid_instance_name(std::string_view name);

struct InstanceRule {
    std::string names;                  // a name, or "prefix/*": every name below it is an instance
    bool opaque = false;                // action values are anything (ccache), not ActionResults
    bool replace = false;               // the last action write wins instead of the first
    std::optional<std::string> parent;  // reads what is missing here from there
};

struct Instance {
    std::string name;
    bool opaque = false, replace = false;
    std::vector<std::string> parents;  // nearest first
};

// The name under which an instance's action lies in the store's one action keyspace.
Digest action_name(std::string_view instance, const Digest& key);

class Instances {
public:
    // The main instance alone.
    Instances() : rules_{InstanceRule{}} {}
    // Refuses names that are not valid, two rules of one name, a parent that no rule names, is a pattern or leads in a circle.
    // Where no rule names it, the main instance "" is added.
    static Result<Instances> make(std::vector<InstanceRule> rules);
    std::optional<Instance> find(std::string_view name) const;
    const std::vector<InstanceRule>& rules() const { return rules_; }

private:
    const InstanceRule* rule_of(std::string_view name) const;
    std::vector<InstanceRule> rules_;
};

}  // namespace kiln
