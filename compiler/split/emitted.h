#pragma once
// The text that a stage emits, for all variants at once: a sequence of token runs, some of them under a condition. At the
// end of each conditional group the alternatives that came out equal are joined again; at the end of the stage the sequence
// is refined into the distinct token streams and the set of variants that has each.

#include <cstdint>
#include <vector>

#include "compiler/space/space.h"
#include "compiler/split/lex.h"

namespace kiln {

class Emitted {
public:
    // `layout`: file and line belong to a token's identity.
    Emitted(Diagram& diagram, bool layout) : diagram_(diagram), layout_(layout) {}

    // A rope of token runs; 0 is the empty one. Equal texts may be different ropes.
    using Rope = uint32_t;
    struct Group {
        Set set;
        Rope rope = 0;
    };
    // A sequence under construction.
    struct Sequence {
        struct Entry {
            bool choice = false;
            uint32_t begin = 0, end = 0;  // tokens of a run, or groups of a choice
        };
        std::vector<Entry> entries;
        bool empty() const { return entries.empty(); }
    };

    void put(Sequence& to, const Token& token);
    void put(Sequence& to, const std::vector<Token>& run);
    // Appends what the alternatives emitted; their sets partition the set that `to` is under. Equal ones are joined.
    void choose(Sequence& to, std::vector<std::pair<Set, Sequence>> alternatives);
    // The distinct texts of a sequence under `set`, which must not be empty. Stops early, with more than `limit` groups,
    // once there are more.
    std::vector<Group> refine(const Sequence& sequence, Set set, size_t limit);

    void flatten(Rope rope, std::vector<Token>& out) const;
    uint64_t length(Rope rope) const { return nodes_[rope].length; }
    size_t tokens() const { return tokens_.size(); }
    void limit_groups(size_t limit) { limit_ = limit; }
    bool over_limit() const { return over_limit_; }
    // Some groups of the refinement that went over the limit, to name what splits.
    const std::vector<Group>& excess() const { return excess_; }

private:
    struct Node {
        uint32_t left = 0, right = 0;  // leaf: a run of tokens_; else two ropes
        bool leaf = false;
        uint64_t hash = 0, power = 1;  // polynomial modulo 2^61 - 1, and its base to the length
        uint64_t length = 0;
    };
    Rope leaf(uint32_t begin, uint32_t end);
    Rope concat(Rope a, Rope b);
    bool same_token(const Token& a, const Token& b) const;
    bool equal(Rope a, Rope b) const;
    void join_equal(std::vector<Group>& groups);

    Diagram& diagram_;
    bool layout_;
    size_t limit_ = ~size_t{0};
    bool over_limit_ = false;
    std::vector<Group> excess_;
    std::vector<Token> tokens_;
    std::vector<Node> nodes_{Node{}};
    std::vector<Group> groups_;  // of all choices
};

}  // namespace kiln
