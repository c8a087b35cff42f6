// Any bytes as a rule expression: a tree that can be evaluated, children before parents, or an error inside the text.
#include <cstdlib>

#include "compiler/manifest/expr.h"

namespace {

void check(bool good) {
    if (!good) std::abort();
}

std::vector<kiln::Axis> make_axes() {
    std::vector<kiln::Axis> axes(4);
    const char* const names[] = {"light", "cascades", "a", "in_between"};
    for (size_t i = 0; i < axes.size(); ++i) {
        axes[i].name = names[i];
        axes[i].macro = names[i];
        axes[i].values = {{"none", 0}, {"point", 2}, {"in", -3}, {"a", 2147483647}};
    }
    return axes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const std::vector<kiln::Axis> axes = make_axes();
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto parsed = kiln::parse_expr(text, axes);
    if (const auto* error = std::get_if<kiln::ExprError>(&parsed)) {
        check(error->offset <= text.size() && !error->message.empty());
        return 0;
    }
    const kiln::Expr& expr = std::get<kiln::Expr>(parsed);
    check(!expr.nodes.empty());
    for (size_t i = 0; i < expr.nodes.size(); ++i) {
        check(expr.nodes[i].offset < text.size() && expr.nodes[i].axis < axes.size());
        for (const uint32_t child : expr.nodes[i].args) check(child < i);
    }
    kiln::evaluate(expr, {0, 1, 2, -3});
    return 0;
}
