#include "compiler/space/term.h"

#include <algorithm>

namespace kiln {

namespace {

constexpr size_t longest_list = 6;

std::vector<uint32_t> listed(const std::vector<bool>& digits, bool wanted) {
    std::vector<uint32_t> found;
    for (uint32_t d = 0; d < digits.size(); ++d)
        if (digits[d] == wanted) found.push_back(d);
    return found;
}

std::vector<bool> only(size_t size, const std::vector<uint32_t>& list, bool value) {
    std::vector<bool> digits(size, !value);
    for (const uint32_t d : list) digits[d] = value;
    return digits;
}

bool within(const std::vector<bool>& digits, const std::vector<bool>& may) {
    for (size_t d = 0; d < digits.size(); ++d)
        if (digits[d] && !may[d]) return false;
    return true;
}

std::string list_text(const Axis& axis, const std::vector<uint32_t>& digits) {
    std::string text = axis.name + " in {";
    for (size_t i = 0; i < digits.size(); ++i) text += (i == 0 ? "" : ", ") + axis.values[digits[i]].name;
    return text + "}";
}

// `axis <= n`, `axis >= n`, or both, over an integer axis.
std::optional<Term> range(const Axis& axis, const std::vector<uint32_t>& must, const std::vector<bool>& may, bool two_ended) {
    int32_t low = axis.values[must[0]].number, high = low;
    for (const uint32_t d : must) {
        low = std::min(low, axis.values[d].number);
        high = std::max(high, axis.values[d].number);
    }
    const auto attempt = [&](bool from, bool to) -> std::optional<Term> {
        Term term;
        for (const AxisValue& v : axis.values) term.digits.push_back((!from || v.number >= low) && (!to || v.number <= high));
        if (!within(term.digits, may)) return std::nullopt;
        if (from) term.text = axis.name + " >= " + std::to_string(low);
        if (from && to) term.text += " && ";
        if (to) term.text += axis.name + " <= " + std::to_string(high);
        term.cost = from && to ? 2 : 1;
        return term;
    };
    if (two_ended) return attempt(true, true);
    if (auto term = attempt(false, true)) return term;
    return attempt(true, false);
}

}  // namespace

std::optional<Term> shortest_term(const Axis& axis, const std::vector<bool>& must, const std::vector<bool>& may) {
    const size_t size = axis.values.size();
    const std::vector<uint32_t> needed = listed(must, true), refused = listed(may, false);
    if (refused.empty()) return Term{std::vector<bool>(size, true), "", 0};
    if (needed.empty()) return std::nullopt;
    if (axis.kind == AxisKind::boolean || axis.kind == AxisKind::defined) {
        const bool yes = axis.values[needed[0]].number != 0;
        return Term{only(size, needed, true), yes ? axis.name : "!" + axis.name, 1};
    }
    if (needed.size() == 1) return Term{only(size, needed, true), axis.name + " == " + axis.values[needed[0]].name, 1};
    const bool integer = axis.kind == AxisKind::integer;
    if (refused.size() == 1 && (!integer || axis.values[refused[0]].number == 0))
        return Term{only(size, refused, false), axis.name + " != " + axis.values[refused[0]].name, 1};
    if (integer)
        if (auto term = range(axis, needed, may, false)) return term;
    if (refused.size() == 1) return Term{only(size, refused, false), axis.name + " != " + axis.values[refused[0]].name, 1};
    const bool by_refusal = refused.size() < needed.size();
    if (by_refusal && refused.size() <= longest_list)
        return Term{only(size, refused, false), "!(" + list_text(axis, refused) + ")", 1};
    if (needed.size() <= longest_list) return Term{only(size, needed, true), list_text(axis, needed), 1};
    if (integer) return range(axis, needed, may, true);
    return std::nullopt;
}

}  // namespace kiln
