// A rule expression becomes a set; the set must hold exactly the combinations that evaluate() accepts, and its description,
// parsed back, must mean the same set.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "compiler/space/describe.h"

namespace {

using namespace kiln;

Axis axis(const char* name, AxisKind kind, std::vector<AxisValue> values) {
    Axis a;
    a.name = a.macro = name;
    a.kind = kind;
    a.values = std::move(values);
    return a;
}

void require(bool holds) {
    if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size > 300) return 0;
    static const Manifest manifest = [] {
        Manifest m;
        m.axes = {axis("a", AxisKind::named, {{"x", 0}, {"y", 5}, {"z", -2}}),
                  axis("b", AxisKind::integer, {{"1", 1}, {"2", 2}, {"4", 4}}),
                  axis("c", AxisKind::boolean, {{"false", 0}, {"true", 1}}),
                  axis("d", AxisKind::defined, {{"false", 0}, {"true", 1}}),
                  axis("e", AxisKind::integer, {{"0", 0}, {"1", 1}, {"2", 2}, {"3", 3}})};
        m.shaders.resize(1);
        m.shaders[0].name = "s";
        m.shaders[0].axes = {0, 1, 2, 3, 4};
        return m;
    }();
    const auto parsed = parse_expr({reinterpret_cast<const char*>(data), size}, manifest.axes);
    if (std::holds_alternative<ExprError>(parsed)) return 0;
    const Expr& expr = std::get<Expr>(parsed);
    Shader shader = manifest.shaders[0];
    Rule rule;
    rule.forbid = size % 2 == 0;
    rule.expr = expr;
    shader.rules.push_back(rule);
    Diags diags;
    const auto space = build_space(manifest, shader, diags);
    require(space != nullptr && diags.empty());
    Diagram& d = *space->diagram;
    const Set set = compile_expr(*space, expr);
    const std::string words = describe_set(*space, set, Diagram::all());
    const bool said = !words.empty() && words != "always" && words != "never";
    Expr again;
    if (said) again = std::get<Expr>(parse_expr(words, manifest.axes));
    uint64_t legal = 0;
    d.enumerate(Diagram::all(), [&](const Digits& digits) {
        std::vector<int32_t> numbers;
        for (size_t i = 0; i < digits.size(); ++i) numbers.push_back(manifest.axes[i].values[digits[i]].number);
        const bool holds = evaluate(expr, numbers);
        require(d.contains(set, digits) == holds);
        require(d.contains(space->legal, digits) == (holds != rule.forbid));
        if (said) require(evaluate(again, numbers) == holds);
        if (holds != rule.forbid) require(d.rank(space->legal, digits) == Count(legal++));
        return true;
    });
    require(d.count(space->legal) == Count(legal));
    return 0;
}
