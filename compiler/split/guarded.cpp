#include "compiler/split/guarded.h"

#include <algorithm>
#include <map>
#include <optional>

namespace kiln {

Guarded Guarded::constant(int32_t value) {
    Guarded g;
    g.value_ = value;
    return g;
}

Guarded Guarded::of_axis(uint32_t axis, std::vector<int32_t> by_digit) {
    Guarded g;
    g.kind_ = Kind::axis;
    g.axis_ = axis;
    g.by_digit_ = std::move(by_digit);
    return g;
}

Guarded Guarded::of_parts(Diagram& diagram, std::vector<Part> parts) {
    std::map<int32_t, Set> joined;
    for (const Part& p : parts) {
        if (p.set == Diagram::none()) continue;
        const auto [at, fresh] = joined.emplace(p.value, p.set);
        if (!fresh) at->second = diagram.either(at->second, p.set);
    }
    Guarded g;
    if (joined.size() <= 1) return joined.empty() ? g : constant(joined.begin()->first);
    g.kind_ = Kind::parts;
    for (const auto& [value, set] : joined) g.parts_.push_back({set, value});
    return g;
}

std::vector<Guarded::Part> Guarded::parts(Diagram& diagram, Set set) const {
    std::vector<Part> out;
    if (set == Diagram::none()) return out;
    if (kind_ == Kind::constant) {
        out.push_back({set, value_});
    } else if (kind_ == Kind::parts) {
        for (const Part& p : parts_)
            if (const Set both = diagram.both(p.set, set); both != Diagram::none()) out.push_back({both, p.value});
    } else {
        std::map<int32_t, std::vector<bool>> digits;
        for (size_t d = 0; d < by_digit_.size(); ++d) {
            std::vector<bool>& flags = digits[by_digit_[d]];
            flags.resize(by_digit_.size());
            flags[d] = true;
        }
        for (const auto& [value, flags] : digits)
            if (const Set both = diagram.both(diagram.where(axis_, flags), set); both != Diagram::none())
                out.push_back({both, value});
    }
    return out;
}

Set Guarded::nonzero(Diagram& diagram, Set set) const {
    if (kind_ == Kind::constant) return value_ != 0 ? set : Diagram::none();
    if (kind_ == Kind::axis) {
        std::vector<bool> flags(by_digit_.size());
        for (size_t d = 0; d < by_digit_.size(); ++d) flags[d] = by_digit_[d] != 0;
        return diagram.both(set, diagram.where(axis_, flags));
    }
    Set zero = Diagram::none();
    for (const Part& p : parts_)
        if (p.value == 0) zero = p.set;
    return diagram.minus(set, zero);
}

Guarded Guarded::apply(Diagram& diagram, Set set, const Guarded& a, const Unary& op) {
    if (a.kind_ == Kind::constant) return constant(op(a.value_));
    if (a.kind_ == Kind::axis) {
        Guarded g = a;
        for (int32_t& v : g.by_digit_) v = op(v);
        return g;
    }
    std::vector<Part> parts = a.parts(diagram, set);
    for (Part& p : parts) p.value = op(p.value);
    return of_parts(diagram, std::move(parts));
}

std::optional<Guarded> Guarded::apply(Diagram& diagram, Set set, const Guarded& a, const Guarded& b, const Binary& op,
                                      size_t limit) {
    if (b.kind_ == Kind::constant) return apply(diagram, set, a, [&](int32_t v) { return op(v, b.value_); });
    if (a.kind_ == Kind::constant) return apply(diagram, set, b, [&](int32_t v) { return op(a.value_, v); });
    if (a.kind_ == Kind::axis && b.kind_ == Kind::axis && a.axis_ == b.axis_) {
        Guarded g = a;
        for (size_t d = 0; d < g.by_digit_.size(); ++d) g.by_digit_[d] = op(a.by_digit_[d], b.by_digit_[d]);
        return g;
    }
    const std::vector<Part> left = a.parts(diagram, set), right = b.parts(diagram, set);
    if (left.size() * right.size() > limit) return std::nullopt;
    std::map<int32_t, Set> joined;
    for (const Part& l : left)
        for (const Part& r : right) {
            const Set both = diagram.both(l.set, r.set);
            if (both == Diagram::none()) continue;
            const auto [at, fresh] = joined.emplace(op(l.value, r.value), both);
            if (!fresh) at->second = diagram.either(at->second, both);
        }
    std::vector<Part> parts;
    for (const auto& [value, s] : joined) parts.push_back({s, value});
    return of_parts(diagram, std::move(parts));
}

}  // namespace kiln
