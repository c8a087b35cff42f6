// Actions of different instances are told apart by hashing the instance into the name, so that the store needs no folder per
// namespace and a client's choice of name never becomes a path.
#include "cache/server/instances.h"

#include <algorithm>
#include <array>

#include "cache/server/access.h"

namespace kiln {

namespace {

constexpr std::array<std::string_view, 16> reserved{
    "ac",      "cas",        "dav",          "blobs",         "uploads",          "actions",     "status", "metrics",
    "healthz", "operations", "capabilities", "actionResults", "compressed-blobs", "favicon.ico", ".",      ".."};
constexpr size_t deepest_parent = 8;

bool valid_segment(std::string_view segment) {
    if (segment.empty() || std::find(reserved.begin(), reserved.end(), segment) != reserved.end()) return false;
    return segment.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") ==
           std::string_view::npos;
}

bool is_pattern(std::string_view names) { return names.size() > 2 && names.substr(names.size() - 2) == "/*"; }

std::string quoted(const std::string& name) { return "instance '" + name + "'"; }

}  // namespace

bool valid_instance_name(std::string_view name) {
    if (name.empty()) return true;
    if (name.size() > 128 || std::count(name.begin(), name.end(), '/') > 7) return false;
    while (true) {
        const size_t slash = std::min(name.find('/'), name.size());
        if (!valid_segment(name.substr(0, slash))) return false;
        if (slash == name.size()) return true;
        name.remove_prefix(slash + 1);
    }
}

Digest action_name(std::string_view instance, const Digest& key) {
    return KeyHasher("kiln.cached.action.v1").field("instance", instance).field("key", key).finish();
}

Result<Instances> Instances::make(std::vector<InstanceRule> rules) {
    Instances made;
    made.rules_ = std::move(rules);
    const auto& all = made.rules_;
    for (size_t i = 0; i < all.size(); ++i) {
        std::string_view name = all[i].names;
        if (is_pattern(name)) name.remove_suffix(2);
        if (!valid_instance_name(name)) return input_error(quoted(all[i].names) + ": the name is not valid");
        for (size_t j = 0; j < i; ++j)
            if (all[j].names == all[i].names) return input_error(quoted(all[i].names) + " is there twice");
    }
    if (made.rule_of("") == nullptr) made.rules_.insert(made.rules_.begin(), InstanceRule{});
    for (const InstanceRule& rule : all) {
        const InstanceRule* above = &rule;
        for (size_t depth = 0; above->parent; ++depth) {
            if (depth == deepest_parent) return input_error(quoted(rule.names) + ": its parents lead in a circle");
            const InstanceRule* next = is_pattern(*above->parent) ? nullptr : made.rule_of(*above->parent);
            if (next == nullptr)
                return input_error(quoted(above->names) + ": its parent '" + *above->parent + "' is no instance");
            if (next->opaque != rule.opaque)
                return input_error(quoted(rule.names) + ": one of it and its parent is opaque, the other not");
            above = next;
        }
    }
    return made;
}

const InstanceRule* Instances::rule_of(std::string_view name) const {
    const InstanceRule* best = nullptr;
    for (const InstanceRule& rule : rules_) {
        if (rule.names == name) return &rule;
        if (is_pattern(rule.names) && covers(rule.names, name) && (best == nullptr || best->names.size() < rule.names.size()))
            best = &rule;
    }
    return best;
}

std::optional<Instance> Instances::find(std::string_view name) const {
    if (!valid_instance_name(name)) return std::nullopt;
    const InstanceRule* rule = rule_of(name);
    if (rule == nullptr) return std::nullopt;
    Instance found{std::string(name), rule->opaque, rule->replace, {}};
    for (const InstanceRule* above = rule; above->parent; above = rule_of(*above->parent))
        found.parents.push_back(*above->parent);
    return found;
}

}  // namespace kiln
