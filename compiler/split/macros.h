#pragma once
// Guarded macro definitions: what a name means depends on the variant, so each macro is a list of (set of variants, meaning)
// whose sets partition the variants being preprocessed. Equal definitions are the same number, so branches that define a
// macro alike leave one meaning behind.

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "compiler/space/space.h"
#include "compiler/split/lex.h"

namespace kiln {

struct MacroDef {
    bool function_like = false;
    bool closed = false;               // object-like, and its body is one operand whatever stands around it
    int32_t axis = -1;                 // the body is this axis's number
    std::vector<uint32_t> parameters;  // spellings
    std::vector<Token> body;           // '##' joined into one token
};

class Macros {
public:
    Macros(Diagram& diagram, Set start) : diagram_(diagram), start_(start), defs_(1) {}

    struct Meaning {
        Set set;
        uint32_t def = 0;  // 0: not defined
    };

    // A definition's number; equal ones share it. White space inside a body counts, as in the standard.
    uint32_t intern(MacroDef def);
    const MacroDef& def(uint32_t id) const { return defs_[id]; }

    // Whether a name was ever defined; the quick way past ordinary identifiers.
    bool known(uint32_t name) const { return name < slots_.size() && slots_[name] != 0; }
    // The meanings of a name; empty when it was never defined.
    std::span<const Meaning> meanings(uint32_t name) const;
    // The one meaning that a name has all over `set`; nothing when it has several. `set` must not be empty.
    struct Lookup {
        uint32_t def = 0;
        bool unique = true;
    };
    Lookup lookup(uint32_t name, Set set);
    Set defined_in(uint32_t name, Set set);
    // Splits `set` by the meaning of `name`.
    std::vector<Meaning> split(uint32_t name, Set set);
    void assign(uint32_t name, uint32_t def, Set set);

    bool busy(uint32_t name) const { return known(name) && macros_[slots_[name] - 1].busy; }
    void set_busy(uint32_t name, bool on) { macros_[slots_[name] - 1].busy = on; }
    // Changes whenever a definition does.
    uint64_t generation() const { return generation_; }
    std::vector<uint32_t> names() const;

private:
    struct Macro {
        uint32_t name = 0;
        bool busy = false;
        std::vector<Meaning> meanings;
        Set last_set;  // the last lookup's answer
        Lookup last;
        bool cached = false;
    };
    Macro& slot(uint32_t name);

    Diagram& diagram_;
    Set start_;
    std::vector<MacroDef> defs_;
    std::map<std::vector<uint32_t>, uint32_t> ids_;
    std::vector<uint32_t> slots_;  // by spelling; 1 + index into macros_
    std::vector<Macro> macros_;
    uint64_t generation_ = 0;
};

}  // namespace kiln
