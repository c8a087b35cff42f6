// Nothing is carried per variant while a file is read: a run of text is stored once with the set of variants that reads it.
// Only refine() makes groups of equal texts, and it joins equal ones after every choice, so that it never holds more groups
// than there are distinct texts so far, however the conditions are written. Texts are ropes that share their parts; a hash
// that composes under concatenation finds the candidates, and a comparison of the tokens decides.
#include "compiler/split/emitted.h"

#include <algorithm>
#include <unordered_map>

namespace kiln {

namespace {

constexpr uint64_t modulus = (uint64_t{1} << 61) - 1;
constexpr uint64_t base = 0x1F3D5B79A1C3E597u % modulus;

uint64_t multiply(uint64_t a, uint64_t b) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>(a) * b;
    const uint64_t sum = static_cast<uint64_t>(product & modulus) + static_cast<uint64_t>(product >> 61);
    return sum >= modulus ? sum - modulus : sum;
}

uint64_t add(uint64_t a, uint64_t b) {
    const uint64_t sum = a + b;
    return sum >= modulus ? sum - modulus : sum;
}

}  // namespace

void Emitted::put(Sequence& to, const Token& token) {
    const auto at = static_cast<uint32_t>(tokens_.size());
    tokens_.push_back(token);
    if (!to.entries.empty() && !to.entries.back().choice && to.entries.back().end == at)
        ++to.entries.back().end;
    else
        to.entries.push_back({false, at, at + 1});
}

void Emitted::put(Sequence& to, const std::vector<Token>& run) {
    for (const Token& token : run) put(to, token);
}

Emitted::Rope Emitted::leaf(uint32_t begin, uint32_t end) {
    if (begin == end) return 0;
    Node node;
    node.leaf = true;
    node.left = begin;
    node.right = end;
    node.length = end - begin;
    for (uint32_t i = begin; i < end; ++i) {
        const Token& t = tokens_[i];
        uint64_t value = uint64_t{t.text} + 1;
        if (layout_) value = (value << 29) ^ (uint64_t{t.file} << 20) ^ t.line;
        node.hash = add(multiply(node.hash, base), value % modulus);
        node.power = multiply(node.power, base);
    }
    nodes_.push_back(node);
    return static_cast<Rope>(nodes_.size() - 1);
}

Emitted::Rope Emitted::concat(Rope a, Rope b) {
    if (a == 0) return b;
    if (b == 0) return a;
    Node node;
    node.left = a;
    node.right = b;
    node.hash = add(multiply(nodes_[a].hash, nodes_[b].power), nodes_[b].hash);
    node.power = multiply(nodes_[a].power, nodes_[b].power);
    node.length = nodes_[a].length + nodes_[b].length;
    nodes_.push_back(node);
    return static_cast<Rope>(nodes_.size() - 1);
}

bool Emitted::same_token(const Token& a, const Token& b) const {
    return a.text == b.text && (!layout_ || (a.file == b.file && a.line == b.line));
}

bool Emitted::equal(Rope a, Rope b) const {
    if (a == b) return true;
    if (nodes_[a].hash != nodes_[b].hash || nodes_[a].length != nodes_[b].length) return false;
    // Walk both from the left; where the same part begins at the same place, step over it.
    std::vector<Rope> left{a}, right{b};
    uint32_t x = 0, x_end = 0, y = 0, y_end = 0;
    for (;;) {
        if (x == x_end && y == y_end) {
            if (left.empty() || right.empty()) return left.empty() == right.empty();
            if (left.back() == right.back()) {
                left.pop_back();
                right.pop_back();
                continue;
            }
            // Open the longer one first, so that shared parts come to lie side by side.
            auto& longer = nodes_[left.back()].length >= nodes_[right.back()].length ? left : right;
            if (!nodes_[longer.back()].leaf) {
                const Node& node = nodes_[longer.back()];
                longer.back() = node.right;
                longer.push_back(node.left);
                continue;
            }
        }
        const auto next = [&](std::vector<Rope>& stack, uint32_t& at, uint32_t& end) {
            while (at == end && !stack.empty()) {
                const Node& node = nodes_[stack.back()];
                if (node.leaf) {
                    at = node.left;
                    end = node.right;
                    stack.pop_back();
                } else {
                    stack.back() = node.right;
                    stack.push_back(node.left);
                }
            }
            return at != end;
        };
        const bool has_x = next(left, x, x_end), has_y = next(right, y, y_end);
        if (!has_x || !has_y) return has_x == has_y;
        const uint32_t count = std::min(x_end - x, y_end - y);
        for (uint32_t i = 0; i < count; ++i)
            if (!same_token(tokens_[x + i], tokens_[y + i])) return false;
        x += count;
        y += count;
    }
}

void Emitted::join_equal(std::vector<Group>& groups) {
    if (groups.size() < 2) return;
    std::unordered_map<uint64_t, std::vector<uint32_t>> by_hash;
    by_hash.reserve(groups.size());
    size_t kept = 0;
    for (size_t i = 0; i < groups.size(); ++i) {
        std::vector<uint32_t>& same = by_hash[nodes_[groups[i].rope].hash];
        const auto twin =
            std::find_if(same.begin(), same.end(), [&](uint32_t k) { return equal(groups[k].rope, groups[i].rope); });
        if (twin != same.end()) {
            groups[*twin].set = diagram_.either(groups[*twin].set, groups[i].set);
            continue;
        }
        same.push_back(static_cast<uint32_t>(kept));
        groups[kept++] = groups[i];
    }
    groups.resize(kept);
}

std::vector<Emitted::Group> Emitted::refine(const Sequence& sequence, Set set, size_t limit) {
    std::vector<Group> groups{{set, 0}};
    for (const Sequence::Entry& entry : sequence.entries) {
        if (!entry.choice) {
            const Rope run = leaf(entry.begin, entry.end);
            for (Group& g : groups) g.rope = concat(g.rope, run);
            continue;
        }
        std::vector<Group> next;
        next.reserve(groups.size() + entry.end - entry.begin);
        for (const Group& g : groups) {
            Set rest = g.set;
            for (uint32_t i = entry.begin; i < entry.end && rest != Diagram::none(); ++i) {
                const Group alternative = groups_[i];
                const Set part = diagram_.both(rest, alternative.set);
                if (part == Diagram::none()) continue;
                next.push_back({part, concat(g.rope, alternative.rope)});
                rest = part == rest ? Diagram::none() : diagram_.minus(rest, part);
            }
            // Variants that a mistake stopped emit nothing more.
            if (rest != Diagram::none()) next.push_back({rest, g.rope});
            if (next.size() > limit) break;
        }
        join_equal(next);
        groups = std::move(next);
        if (groups.size() > limit) return groups;
    }
    return groups;
}

void Emitted::choose(Sequence& to, std::vector<std::pair<Set, Sequence>> alternatives) {
    std::vector<Group> all;
    for (const auto& [set, sequence] : alternatives) {
        if (set == Diagram::none()) continue;
        for (Group& g : refine(sequence, set, limit_)) all.push_back(g);
        if (all.size() > limit_) {
            over_limit_ = true;
            excess_ = all;
            return;
        }
    }
    join_equal(all);
    if (all.empty()) return;
    if (all.size() == 1 && all.front().rope == 0) return;
    const auto begin = static_cast<uint32_t>(groups_.size());
    groups_.insert(groups_.end(), all.begin(), all.end());
    to.entries.push_back({true, begin, static_cast<uint32_t>(groups_.size())});
}

void Emitted::flatten(Rope rope, std::vector<Token>& out) const {
    if (rope == 0) return;
    std::vector<Rope> stack{rope};
    while (!stack.empty()) {
        const Node& node = nodes_[stack.back()];
        if (node.leaf) {
            out.insert(out.end(), tokens_.begin() + node.left, tokens_.begin() + node.right);
            stack.pop_back();
        } else {
            stack.back() = node.right;
            stack.push_back(node.left);
        }
    }
}

}  // namespace kiln
