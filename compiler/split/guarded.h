#pragma once
// An integer that depends on the variant: a constant, a function of one axis's digit, or a list of (set, value). What an #if
// computes with, so that no condition ever enumerates variants.

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "compiler/space/space.h"

namespace kiln {

class Guarded {
public:
    struct Part {
        Set set;
        int32_t value = 0;
    };
    Guarded() = default;
    static Guarded constant(int32_t value);
    static Guarded of_axis(uint32_t axis, std::vector<int32_t> by_digit);
    // The parts must be apart; equal values are joined.
    static Guarded of_parts(Diagram& diagram, std::vector<Part> parts);

    bool is_constant() const { return kind_ == Kind::constant; }
    // As parts of `set`, one per value that occurs in it, ascending by value.
    std::vector<Part> parts(Diagram& diagram, Set set) const;
    // Where in `set` the value is not zero.
    Set nonzero(Diagram& diagram, Set set) const;

    using Unary = std::function<int32_t(int32_t)>;
    using Binary = std::function<int32_t(int32_t, int32_t)>;
    static Guarded apply(Diagram& diagram, Set set, const Guarded& a, const Unary& op);
    // Nothing when more than `limit` pairs of values would have to be looked at.
    static std::optional<Guarded> apply(Diagram& diagram, Set set, const Guarded& a, const Guarded& b, const Binary& op,
                                        size_t limit);

private:
    enum class Kind : uint8_t { constant, axis, parts } kind_ = Kind::constant;
    int32_t value_ = 0;
    uint32_t axis_ = 0;
    std::vector<int32_t> by_digit_;
    std::vector<Part> parts_;
};

}  // namespace kiln
