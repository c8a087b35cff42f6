#include "fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "compiler/split/lex.h"
#include "oracle.h"

using namespace kiln;

std::unique_ptr<SplitTest> run_split(const TestShader& shader) {
    auto out = std::make_unique<SplitTest>();
    Manifest& m = out->manifest;
    m.name = "test";
    m.path = "m/test.yaml";
    m.folder = "m";
    m.include = shader.include;
    Shader s;
    s.name = "test";
    for (const TestAxis& a : shader.axes) {
        Axis axis;
        axis.name = a.macro;
        for (char& c : axis.name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        axis.macro = a.macro;
        axis.kind = a.kind;
        for (const int32_t n : a.numbers)
            axis.values.push_back({a.kind == AxisKind::integer ? std::to_string(n) : n != 0 ? "true" : "false", n});
        s.axes.push_back(static_cast<uint32_t>(m.axes.size()));
        m.axes.push_back(axis);
    }
    s.defines = shader.defines;
    s.options.undefined_macros = shader.undefined_is_zero ? UndefinedMacros::zero : UndefinedMacros::error;
    StageFile stage;
    stage.stage = shader.stage;
    stage.file = "main";
    stage.place = {"m/test.yaml", 1, 1};
    s.stages.push_back(stage);
    if (!shader.forbid.empty()) {
        Rule rule;
        rule.text = shader.forbid;
        auto parsed = parse_expr(shader.forbid, m.axes);
        if (const auto* error = std::get_if<ExprError>(&parsed)) ADD_FAILURE() << error->message;
        rule.expr = std::get<Expr>(parsed);
        s.rules.push_back(rule);
    }
    m.shaders.push_back(s);
    for (const auto& [name, text] : shader.files) out->files.files["m/" + name] = text;
    Diags diags;
    out->space = build_space(m, m.shaders.front(), diags);
    EXPECT_FALSE(diags.has_errors());
    SplitOptions options;
    options.max_states = shader.max_states;
    options.lines = shader.lines;
    out->split = split_stage(m, m.shaders.front(), stage, *out->space, out->space->legal, out->files, options);
    return out;
}

std::vector<std::string> tokens_of(const std::string& text) {
    static Spellings spellings;
    std::vector<std::string> out;
    for (size_t begin = 0; begin < text.size();) {
        size_t end = text.find('\n', begin);
        if (end == std::string::npos) end = text.size();
        const std::string line = text.substr(begin, end - begin);
        begin = end + 1;
        const size_t first = line.find_first_not_of(" \t");
        if (first != std::string::npos && line.compare(first, 5, "#line") == 0) continue;
        if (line.find("GL_GOOGLE_include_directive") != std::string::npos && line[first] == '#') continue;
        for (const Token& t : lex_text(line, 0, spellings)) {
            std::string token(spellings.text(t.text));
            // Names of included files read alike from either search path.
            if (token.size() > 1 && token.front() == '"' && token.compare(1, 2, "m/") == 0) token.erase(1, 2);
            out.push_back(token);
        }
    }
    return out;
}

std::string messages(const Split& split) {
    std::string out;
    for (const Diag& d : split.diags.list())
        if (d.severity == Severity::error)
            out += d.place.file + ":" + std::to_string(d.place.line) + ":" + std::to_string(d.place.column) + ": " + d.message +
                   (d.notes.empty() ? "" : " [" + d.notes.front() + "]") + "\n";
    return out;
}

namespace {

// The same stage with nothing but one variant needed.
Split split_alone(SplitTest& test, const Digits& digits) {
    const Shader& shader = test.manifest.shaders.front();
    return split_stage(test.manifest, shader, shader.stages.front(), *test.space, test.space->diagram->point(digits), test.files,
                       {});
}

}  // namespace

bool expect_like_oracle(const TestShader& shader, const std::string& note) {
    const auto test = run_split(shader);
    const Space& space = *test->space;
    std::map<std::vector<std::string>, std::set<size_t>> streams;  // oracle stream -> our classes
    std::map<size_t, std::set<std::vector<std::string>>> of_class;
    std::string all;
    for (const auto& [name, text] : shader.files) all += "--- " + name + "\n" + text;
    const std::string ours = messages(test->split);
    bool agreed = true, errors = false;
    space.diagram->enumerate(space.legal, [&](const Digits& digits) {
        std::string preamble;
        for (const auto& [name, body] : shader.defines) preamble += "#define " + name + " " + body + "\n";
        for (size_t a = 0; a < digits.size(); ++a) {
            const AxisValue& value = space.axes[a].values[digits[a]];
            if (space.axes[a].kind == AxisKind::defined && value.number == 0) continue;
            preamble += "#define " + space.axes[a].macro + " " + std::to_string(value.number) + "\n";
        }
        const oracle::Answer answer = oracle::preprocess(shader.stage, shader.files, "main", preamble);
        errors = errors || !answer.ok;
        const std::string where =
            note + space.describe_variant(digits) + "\n" + ours + all + "--- oracle\n" + answer.log + answer.text;
        if (!answer.ok) {
            EXPECT_FALSE(ours.empty()) << where;
        }
        if (!ours.empty()) {
            // Some variant has an error: this one by itself must have one just where the oracle has.
            const std::string alone = messages(split_alone(*test, digits));
            EXPECT_EQ(alone.empty(), answer.ok) << where << "--- alone\n" << alone;
            agreed = agreed && alone.empty() == answer.ok;
        }
        if (!agreed || !answer.ok) return agreed;
        size_t index = 0;
        while (index < test->split.classes.size() && !space.diagram->contains(test->split.classes[index].variants, digits))
            ++index;
        if (index == test->split.classes.size()) {
            ADD_FAILURE() << "no class: " << where;
            return agreed = false;
        }
        const auto want = tokens_of(answer.text), got = tokens_of(test->split.classes[index].text);
        EXPECT_EQ(got, want) << where;
        agreed = got == want;
        streams[want].insert(index);
        of_class[index].insert(want);
        return agreed;
    });
    EXPECT_EQ(!ours.empty(), errors) << note << ours << all;
    if (!agreed || errors) return false;
    EXPECT_EQ(streams.size(), test->split.classes.size()) << note << all;
    for (const auto& [stream, classes] : streams) EXPECT_EQ(classes.size(), 1u) << note << all;
    for (const auto& [index, distinct] : of_class) EXPECT_EQ(distinct.size(), 1u) << note << all;
    for (const Class& c : test->split.classes)
        EXPECT_EQ(c.places.size(), static_cast<size_t>(std::count(c.text.begin(), c.text.end(), '\n'))) << note;
    return true;
}
