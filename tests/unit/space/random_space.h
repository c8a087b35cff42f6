#pragma once
// Random small spaces with the slow answers beside them: every combination, asked rule by rule with evaluate().

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "compiler/manifest/expr.h"
#include "compiler/manifest/manifest.h"
#include "compiler/space/space.h"

namespace kiln::test {

using Random = std::mt19937;

inline uint32_t below(Random& random, uint32_t n) { return static_cast<uint32_t>(random() % n); }

inline Axis make_axis(const std::string& name, AxisKind kind, const std::vector<int32_t>& numbers) {
    Axis axis;
    axis.name = name;
    axis.macro = name;
    axis.kind = kind;
    axis.place = {"m.yaml", 1, 1};
    for (size_t i = 0; i < numbers.size(); ++i) {
        std::string value = std::to_string(numbers[i]);
        if (kind == AxisKind::named) value = name + "_" + std::string(1, static_cast<char>('a' + i % 26)) + std::to_string(i);
        if (kind == AxisKind::boolean || kind == AxisKind::defined) value = i == 0 ? "false" : "true";
        axis.values.push_back({value, numbers[i]});
    }
    return axis;
}

inline Axis boolean_axis(const std::string& name) { return make_axis(name, AxisKind::boolean, {0, 1}); }

inline Axis random_axis(Random& random, const std::string& name, uint32_t most) {
    const uint32_t kind = below(random, 4);
    if (kind >= 2) return make_axis(name, kind == 2 ? AxisKind::boolean : AxisKind::defined, {0, 1});
    std::vector<int32_t> numbers;
    const uint32_t values = 1 + below(random, most);
    const bool by_hand = below(random, 3) == 0;
    for (uint32_t i = 0; i < values; ++i) numbers.push_back(static_cast<int32_t>(i));
    if (by_hand) {
        for (int32_t& n : numbers) n = n * 3 - 2;
        std::shuffle(numbers.begin(), numbers.end(), random);
    }
    return make_axis(name, kind == 0 ? AxisKind::named : AxisKind::integer, numbers);
}

inline std::string random_expr(Random& random, const std::vector<Axis>& axes, int depth) {
    const Axis& axis = axes[below(random, static_cast<uint32_t>(axes.size()))];
    const char* const compare[] = {"==", "!=", "<", "<=", ">", ">="};
    const auto value = [&](const Axis& of) {
        const AxisValue& v = of.values[below(random, static_cast<uint32_t>(of.values.size()))];
        return below(random, 4) == 0 ? std::to_string(v.number) : v.name;
    };
    if (depth == 0 || below(random, 5) == 0) {
        switch (below(random, 5)) {
            case 0:
                return axis.name;
            case 1:
                return "!" + axis.name;
            case 2:
                return axis.name + " in {" + value(axis) + ", " + value(axis) + "}";
            case 3:
                return axis.name + " " + compare[below(random, 6)] + " " +
                       axes[below(random, static_cast<uint32_t>(axes.size()))].name;
            default:
                return axis.name + " " + compare[below(random, 6)] + " " + value(axis);
        }
    }
    const std::string a = "(" + random_expr(random, axes, depth - 1) + ")", b = "(" + random_expr(random, axes, depth - 1) + ")";
    switch (below(random, 8)) {
        case 0:
            return "!" + a;
        case 1:
            return a + " -> " + b;
        case 2:
            return a + " " + compare[below(random, 6)] + " " + b;
        case 3:
        case 4:
            return a + " || " + b;
        default:
            return a + " && " + b;
    }
}

inline Expr must_parse(const std::string& text, const std::vector<Axis>& axes) {
    auto parsed = parse_expr(text, axes);
    if (const ExprError* e = std::get_if<ExprError>(&parsed)) {
        ADD_FAILURE() << text << ": " << e->message;
        return {};
    }
    return std::get<Expr>(std::move(parsed));
}

// A manifest of one shader over these axes.
struct Case {
    Manifest manifest;
    explicit Case(std::vector<Axis> axes) {
        manifest.axes = std::move(axes);
        manifest.shaders.resize(1);
        manifest.shaders[0].name = "s";
        for (uint32_t i = 0; i < manifest.axes.size(); ++i) manifest.shaders[0].axes.push_back(i);
    }
    void rule(bool forbid, const std::string& text) {
        Rule r;
        r.forbid = forbid;
        r.expr = must_parse(text, manifest.axes);
        r.text = text;
        r.place = {"m.yaml", 10 + static_cast<uint32_t>(manifest.shaders[0].rules.size()), 5};
        manifest.shaders[0].rules.push_back(std::move(r));
    }
    std::unique_ptr<Space> build(size_t limit = Diagram::default_node_limit) {
        return build_space(manifest, manifest.shaders[0], diags, limit);
    }
    Diags diags;
};

inline Case random_case(Random& random, uint32_t most_axes = 6, uint32_t most_values = 5) {
    std::vector<Axis> axes;
    const uint32_t count = 1 + below(random, most_axes);
    for (uint32_t i = 0; i < count; ++i) axes.push_back(random_axis(random, "x" + std::to_string(i), most_values));
    Case c(std::move(axes));
    const uint32_t rules = below(random, 6);
    for (uint32_t i = 0; i < rules; ++i)
        c.rule(below(random, 2) == 0, random_expr(random, c.manifest.axes, 1 + static_cast<int>(below(random, 3))));
    return c;
}

// Every combination in ascending order.
inline std::vector<Digits> combinations(const std::vector<Axis>& axes) {
    std::vector<Digits> all{{}};
    for (const Axis& axis : axes) {
        std::vector<Digits> longer;
        for (const Digits& d : all)
            for (uint32_t v = 0; v < axis.values.size(); ++v) {
                longer.push_back(d);
                longer.back().push_back(v);
            }
        all = std::move(longer);
    }
    return all;
}

inline bool holds(const Expr& expr, const std::vector<Axis>& axes, const Digits& digits) {
    std::vector<int32_t> numbers;
    for (size_t i = 0; i < axes.size(); ++i) numbers.push_back(axes[i].values[digits[i]].number);
    return evaluate(expr, numbers);
}

inline std::vector<Digits> legal_combinations(const Case& c) {
    std::vector<Digits> legal;
    for (const Digits& d : combinations(c.manifest.axes)) {
        bool ok = true;
        for (const Rule& r : c.manifest.shaders[0].rules) ok = ok && holds(r.expr, c.manifest.axes, d) != r.forbid;
        if (ok) legal.push_back(d);
    }
    return legal;
}

}  // namespace kiln::test
