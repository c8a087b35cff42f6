#include "compiler/split/macros.h"

#include <algorithm>

namespace kiln {

namespace {

// A body that is one operand: a literal, a name that cannot turn into a call, or a whole pair of parentheses. Its value may
// stand for its text in any expression.
bool is_closed(const MacroDef& def) {
    if (def.function_like || def.body.empty()) return false;
    for (const Token& t : def.body)
        if (t.kind == Tok::paste || t.kind == Tok::hash || t.text == spelling::defined_) return false;
    const bool negated = def.body.size() == 2 && def.body.front().text == spelling::minus;
    if (def.body.size() == 1 || negated) return def.body.back().kind == Tok::integer;
    if (def.body.front().text != spelling::paren_open || def.body.back().text != spelling::paren_close) return false;
    size_t depth = 0;
    for (size_t i = 0; i < def.body.size(); ++i) {
        if (def.body[i].text == spelling::paren_open) ++depth;
        if (def.body[i].text == spelling::paren_close && --depth == 0 && i + 1 != def.body.size()) return false;
    }
    return true;
}

}  // namespace

uint32_t Macros::intern(MacroDef def) {
    std::vector<uint32_t> key{def.function_like ? 1u : 0u, static_cast<uint32_t>(def.axis + 1),
                              static_cast<uint32_t>(def.parameters.size())};
    key.insert(key.end(), def.parameters.begin(), def.parameters.end());
    for (size_t i = 0; i < def.body.size(); ++i) {
        const Token& t = def.body[i];
        key.push_back(t.text);
        key.push_back(static_cast<uint32_t>(t.kind) << 1 | (i != 0 && (t.flags & Token::spaced) != 0 ? 1u : 0u));
    }
    const auto [at, fresh] = ids_.emplace(std::move(key), static_cast<uint32_t>(defs_.size()));
    if (fresh) {
        def.closed = is_closed(def);
        defs_.push_back(std::move(def));
    }
    return at->second;
}

std::span<const Macros::Meaning> Macros::meanings(uint32_t name) const {
    if (!known(name)) return {};
    return macros_[slots_[name] - 1].meanings;
}

Macros::Macro& Macros::slot(uint32_t name) {
    if (name >= slots_.size()) slots_.resize(std::max<size_t>(name + 1, slots_.size() * 2), 0);
    if (slots_[name] == 0) {
        Macro macro;
        macro.name = name;
        macro.meanings.push_back({start_, 0});
        macros_.push_back(std::move(macro));
        slots_[name] = static_cast<uint32_t>(macros_.size());
    }
    return macros_[slots_[name] - 1];
}

Macros::Lookup Macros::lookup(uint32_t name, Set set) {
    if (!known(name)) return {};
    Macro& macro = macros_[slots_[name] - 1];
    if (macro.meanings.size() == 1) return {macro.meanings.front().def, true};
    if (macro.cached && macro.last_set == set) return macro.last;
    Lookup answer{0, false};
    for (const Meaning& m : macro.meanings) {
        if (diagram_.disjoint(m.set, set)) continue;
        answer = {m.def, diagram_.subset(set, m.set)};
        break;
    }
    macro.cached = true;
    macro.last_set = set;
    macro.last = answer;
    return answer;
}

Set Macros::defined_in(uint32_t name, Set set) {
    if (!known(name)) return Diagram::none();
    Set without = Diagram::none();
    for (const Meaning& m : meanings(name))
        if (m.def == 0) without = m.set;
    return without == Diagram::none() ? set : diagram_.minus(set, without);
}

std::vector<Macros::Meaning> Macros::split(uint32_t name, Set set) {
    if (!known(name)) return {{set, 0}};
    std::vector<Meaning> out;
    for (const Meaning& m : meanings(name)) {
        const Set part = diagram_.both(m.set, set);
        if (part != Diagram::none()) out.push_back({part, m.def});
    }
    return out;
}

void Macros::assign(uint32_t name, uint32_t def, Set set) {
    if (set == Diagram::none() || (def == 0 && !known(name))) return;
    ++generation_;
    Macro& macro = slot(name);
    macro.cached = false;
    Set merged = set;
    std::vector<Meaning> kept;
    for (const Meaning& m : macro.meanings) {
        if (m.def == def) {
            merged = diagram_.either(merged, m.set);
        } else if (const Set rest = diagram_.minus(m.set, set); rest != Diagram::none()) {
            kept.push_back({rest, m.def});
        }
    }
    kept.push_back({merged, def});
    macro.meanings = std::move(kept);
}

std::vector<uint32_t> Macros::names() const {
    std::vector<uint32_t> out;
    for (const Macro& m : macros_) out.push_back(m.name);
    return out;
}

}  // namespace kiln
