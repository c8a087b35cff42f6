#pragma once
// From sources to modules the slow obvious way: every variant is compiled by itself. Real tools, no manifest.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "compiler/modules/modules.h"
#include "compiler/toolchain/cross.h"
#include "compiler/toolchain/glsl.h"
#include "compiler/toolchain/spirv.h"

namespace kiln {

// Optimised SPIR-V of a text that must compile. The text has no #version line.
inline Words spirv_of(Stage stage, const std::string& text, const Options& options = {}) {
    const Compiled compiled = glsl_compile(stage, "#version 450\n" + text, options);
    for (const ToolMessage& m : compiled.messages) ADD_FAILURE() << m.line << ": " << m.text << "\n" << text;
    if (compiled.words.empty()) return {};
    const Result<Words> pruned = spirv_prune(compiled.words, options);
    if (!pruned.ok()) return {};
    const Result<Words> optimised = spirv_optimise(*pruned, options);
    if (!optimised.ok()) return {};
    for (const ToolMessage& m : spirv_validate(*optimised, options)) ADD_FAILURE() << m.text << "\n" << text;
    return *optimised;
}

inline Reflection reflection_of(Stage stage, const std::string& text) {
    const Result<Reflection> r = reflect_words(spirv_of(stage, text));
    EXPECT_TRUE(r.ok()) << text;
    return r.ok() ? *r : Reflection();
}

// A shader over integer axes 0..n-1, each a macro of its own name.
class MiniBuild {
public:
    struct MiniAxis {
        std::string name;
        uint32_t values = 2;
    };
    MiniBuild(std::string name, const std::vector<MiniAxis>& axes) {
        shader.name = space.shader = std::move(name);
        std::vector<uint32_t> radices, order;
        for (const MiniAxis& a : axes) {
            Axis axis;
            axis.name = axis.macro = a.name;
            axis.kind = AxisKind::integer;
            for (uint32_t v = 0; v < a.values; ++v) axis.values.push_back({std::to_string(v), static_cast<int32_t>(v)});
            space.axes.push_back(axis);
            order.push_back(static_cast<uint32_t>(radices.size()));
            radices.push_back(a.values);
        }
        space.diagram = std::make_unique<Diagram>(radices, order);
        space.legal = space.needed = Diagram::all();
    }
    MiniBuild(const MiniBuild&) = delete;
    MiniBuild& operator=(const MiniBuild&) = delete;

    // Rules first, then stages in their order.
    void forbid(const Set& set) { space.legal = space.needed = space.diagram->minus(space.needed, set); }

    void add(Stage stage, const std::string& source) {
        auto split = std::make_unique<Split>();
        split->files = {std::string("test.") + name_of(stage)};
        std::vector<uint32_t> of_class;
        space.diagram->enumerate(space.needed, [&](const Digits& digits) {
            std::string text;
            for (size_t a = 0; a < digits.size(); ++a)
                text += "#define " + space.axes[a].name + " " + std::to_string(digits[a]) + "\n";
            Class c;
            c.variants = space.diagram->point(digits);
            split->classes.push_back(std::move(c));
            of_class.push_back(module_of(stage, spirv_of(stage, text + source)));
            return true;
        });
        modules.of_class.push_back(std::move(of_class));
        splits.push_back(std::move(split));
        stages.push_back({&shader, &space, stage, splits.back().get()});
    }

    Shader shader;
    Space space;
    std::vector<std::unique_ptr<Split>> splits;
    std::vector<StageClasses> stages;
    Modules modules;

private:
    uint32_t module_of(Stage stage, Words words) {
        for (uint32_t i = 0; i < modules.list.size(); ++i)
            if (modules.list[i].words == words) return i;
        Module m;
        m.stage = stage;
        m.digest = sha256(as_bytes(WordView(words)));
        const Result<Reflection> r = reflect_words(words);
        EXPECT_TRUE(r.ok());
        if (r.ok()) m.reflection = *r;
        m.words = std::move(words);
        modules.list.push_back(std::move(m));
        return static_cast<uint32_t>(modules.list.size() - 1);
    }
};

// Every diagnostic as text, for searching.
inline std::string all_text(const Diags& diags) {
    std::string out;
    for (const Diag& d : diags.list()) out += render(d, false);
    return out;
}

}  // namespace kiln
