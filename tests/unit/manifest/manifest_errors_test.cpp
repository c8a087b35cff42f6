// Every way to write a manifest wrongly, with the place and the words of the answer.
#include <gtest/gtest.h>

#include "compiler/manifest/manifest.h"

namespace kiln {
namespace {

// "line:col: message" of every error, in the file's order, one a line.
std::string problems(const std::string& yaml) {
    MemoryFiles files;
    files.files["m.yaml"] = yaml;
    Diags diags;
    const auto manifest = load_manifest(files, "m.yaml", diags);
    EXPECT_EQ(manifest.has_value(), !diags.has_errors());
    diags.sort();
    std::string out;
    for (const Diag& d : diags.list()) {
        EXPECT_EQ(d.place.file, "m.yaml");
        out += std::to_string(d.place.line) + ":" + std::to_string(d.place.column) + ": " + d.message + "\n";
        // The caret stands under a byte of the line, or just behind it.
        if (d.place.line != 0) {
            EXPECT_LE(d.place.column, d.source_line.size() + 1) << out;
        }
    }
    return out;
}

struct Case {
    const char* yaml;
    const char* expected;
};

std::string with(const std::string& key, const std::string& text, const std::string& rest) {
    return "kiln: 1\n" + key + text + rest;
}

// Each case is the values of axis `a`, on line 3 from column 25.
TEST(ManifestErrors, Values) {
    const Case table[] = {
        {"[none, one]", ""},
        {"[yes, no, on, off, y, n, Yes, NULLS]", ""},
        {"[-1, 0, 0x7fffffff, -2147483648]", ""},
        {"{none: 0, one: -1, two: 0x10}", ""},
        {"bool", ""},
        {"'bool'", ""},
        {"defined", ""},
        {"boolean", "3:25: the values of axis 'a' cannot be 'boolean' (did you mean 'bool'?)\n"},
        {"boool", "3:25: the values of axis 'a' cannot be 'boool' (did you mean 'bool'?)\n"},
        {"[]", "3:25: axis 'a' has an empty list of values\n"},
        {"{}", "3:25: axis 'a' has an empty list of values\n"},
        {"", "3:24: axis 'a' has no values: write a list, a map of names to integers, 'bool' or 'defined'\n"},
        {"~", "3:25: axis 'a' has no values: write a list, a map of names to integers, 'bool' or 'defined'\n"},
        {"[true, false]",
         "3:26: 'true' cannot be the name of a value: write 'values: bool' for false and true\n"
         "3:32: 'false' cannot be the name of a value: write 'values: bool' for false and true\n"},
        {"[\"true\"]", "3:26: 'true' cannot be the name of a value: write 'values: bool' for false and true\n"},
        {"[none, null]", "3:32: a value of axis 'a' is empty: 'null', '~' and nothing are no names\n"},
        {"[none, ~]", "3:32: a value of axis 'a' is empty: 'null', '~' and nothing are no names\n"},
        {"[none, '']", "3:32: '' cannot be the name of a value: names are letters, digits and '_', and begin with no digit\n"},
        {"[none, a-b]",
         "3:32: 'a-b' cannot be the name of a value: names are letters, digits and '_', and begin with no digit\n"},
        {"[none, \"1\"]",
         "3:32: '1' cannot be the name of a value: names are letters, digits and '_', and begin with no digit\n"},
        {"[none, \xC3\xA9t\xC3\xA9]",
         "3:32: '\xC3\xA9t\xC3\xA9' cannot be the name of a value: names are letters, digits and '_', and begin with no digit\n"},
        {"[none, one, none]", "3:37: duplicate value 'none' of axis 'a'\n"},
        {"[1, 2, 0x1]", "3:32: duplicate value '1' of axis 'a'\n"},
        {"[none, 1, one, 2]", "3:32: names and integers do not mix in one list; number the names by hand: {none: 0, one: 1}\n"},
        {"[1, none]", "3:29: names and integers do not mix in one list; number the names by hand: {none: 0, one: 1}\n"},
        {"[1, 2147483648]", "3:29: '2147483648': out of range: -2147483648 to 2147483647\n"},
        {"[1, 0xFFFFFFFF]", "3:29: '0xFFFFFFFF': out of range: -2147483648 to 2147483647\n"},
        {"[1, -2147483649]", "3:29: '-2147483649': out of range: -2147483648 to 2147483647\n"},
        {"[1, 1.5]", "3:29: '1.5': not an integer (decimal or 0x)\n"},
        {"[1, 1e3]", "3:29: '1e3': not an integer (decimal or 0x)\n"},
        {"[1, 1_000]", "3:29: '1_000': not an integer (decimal or 0x)\n"},
        {"[1, +2]", "3:29: '+2': not an integer (decimal or 0x)\n"},
        {"[1, 0o17]", "3:29: '0o17': not an integer (decimal or 0x)\n"},
        {"[1, 017]", "3:29: '017': leading zeros mean octal elsewhere: write it without\n"},
        {"[[a], b]", "3:26: a value must be a name or an integer, this is a list\n"},
        {"[a: 1, b]", "3:26: a value must be a name or an integer, this is a map\n"},
        {"{ggx: D_GGX, two: 2}", "3:31: values are integers: a value that is a token, like 'D_GGX', is not supported\n"},
        {"{a: 0, b: 0}", "3:32: 'b' of axis 'a' has the same number as 'a': 0\n"},
        {"{a: 0, b: 0x0}", "3:32: 'b' of axis 'a' has the same number as 'a': 0\n"},
        {"{a: 0, a: 1}", "3:32: duplicate key 'a'\n"},
        {"{a: 0, b: }", "3:34: a value must be an integer, this is empty\n"},
        {"{a: 0, b}", "3:33: a value must be an integer, this is empty\n"},
        {"{a: 0, b: '1'}", "3:35: a value must be an integer, this is the text '1'\n"},
        {"{a: 0, b: true}", "3:35: a value must be an integer, this is the text 'true'\n"},
        {"{a: 0, b: [1]}", "3:35: a value must be an integer, this is a list\n"},
        {"{a: 0, b: 4294967296}", "3:35: '4294967296': out of range: -2147483648 to 2147483647\n"},
        {"{a: 0, true: 1}", "3:32: 'true' cannot be the name of a value: write 'values: bool' for false and true\n"},
        {"{a: 0, 1: 1}", "3:32: '1' cannot be the name of a value: names are letters, digits and '_', and begin with no digit\n"},
        {"{a: 0, null: 1}", "3:32: a key must be a name\n"},
    };
    for (const Case& c : table)
        EXPECT_EQ(problems(with("axes:\n", std::string("  a: {macro: A, values: ") + c.yaml + "}\n",
                                "shaders:\n  - {name: s, stages: {vertex: v}}\n")),
                  c.expected)
            << c.yaml;
}

// Each case is the text of `axes:` from line 3.
TEST(ManifestErrors, Axes) {
    const Case table[] = {
        {"  in: {macro: A, values: bool}\n", "3:3: 'in' cannot be the name of an axis: it is a word of rule expressions\n"},
        {"  a-b: {macro: A, values: bool}\n",
         "3:3: 'a-b' cannot be the name of an axis: names are letters, digits and '_', begin with no digit, and have at most 255 "
         "bytes\n"},
        {"  a: {macro: A, vals: bool}\n",
         "3:6: axis 'a' needs 'values'\n3:17: unknown key 'vals' in axis 'a' (did you mean 'values'?)\n"},
        {"  a: {values: bool}\n", "3:6: axis 'a' needs 'macro'\n"},
        {"  a: bool\n", "3:6: axis 'a' must be a map, this is the text 'bool'\n"},
        {"  a:\n", "3:5: axis 'a' must be a map, this is empty\n"},
        {"  a: {macro: , values: bool}\n", "3:13: the macro of axis 'a' must be text, this is empty\n"},
        {"  a: {macro: [A], values: bool}\n", "3:14: the macro of axis 'a' must be text, this is a list\n"},
        {"  a: {macro: 1A, values: bool}\n",
         "3:14: the macro '1A' is no identifier: letters, digits and '_', beginning with no digit\n"},
        {"  a: {macro: 'A B', values: bool}\n",
         "3:14: the macro 'A B' is no identifier: letters, digits and '_', beginning with no digit\n"},
        {"  a: {macro: GL_A, values: bool}\n",
         "3:14: the macro 'GL_A' is reserved: names that begin with 'GL_' belong to GLSL\n"},
        {"  a: {macro: __LINE__, values: bool}\n",
         "3:14: the macro '__LINE__' is reserved: names with '__' belong to the compiler\n"},
        {"  a: {macro: A__B, values: bool}\n", "3:14: the macro 'A__B' is reserved: names with '__' belong to the compiler\n"},
        {"  a: {macro: defined, values: bool}\n", "3:14: the macro 'defined' is an operator of #if\n"},
        {"  a: {macro: VULKAN, values: bool}\n", "3:14: the macro 'VULKAN' is defined by the compiler\n"},
        {"  a: {macro: A, values: bool}\n  b: {macro: A, values: bool}\n", "4:3: axis 'b' has the macro 'A' of axis 'a'\n"},
        {"  a: {macro: A, values: bool}\n  a: {macro: B, values: bool}\n", "4:3: duplicate key 'a'\n"},
    };
    for (const Case& c : table)
        EXPECT_EQ(problems(with("axes:\n", c.yaml, "shaders:\n  - {name: s, stages: {vertex: v}}\n")), c.expected) << c.yaml;
    EXPECT_EQ(problems("kiln: 1\naxes: [a]\nshaders:\n  - {name: s, stages: {vertex: v}}\n"),
              "2:7: axes must be a map of names to axes, this is a list\n");
}

// Each case is what stands behind `kiln: 1` on line 2, before the shaders.
TEST(ManifestErrors, Top) {
    const Case table[] = {
        {"name: x.y-1\ninclude: []\ntargets: []\noptions: {}\naxes: {}\nrules: []\n", ""},
        {"tragets: [spirv]\n", "2:1: unknown key 'tragets' in a manifest (did you mean 'targets'?)\n"},
        {"name: ''\n", "2:7: the name must be text, this is empty\n"},
        {"name: a b\n",
         "2:7: the name cannot be 'a b': letters, digits, '_', and behind the first also '.' and '-', at most 255 bytes\n"},
        {"include: [\"a\\0b\"]\n", "2:13: a folder of the search path has a control character\n"},
        {"include: [\"a\\nb\"]\n", "2:13: a folder of the search path must be on one line\n"},
        {"rules: [{forbid: \"1\\x1b\"}]\n", "2:20: an expression has a control character\n"},
        {"rules: [{forbid: 1 \xC3\xA9}]\n", "2:20: '\xC3\xA9': this character means nothing in an expression\n"},
        {"name: [a]\n", "2:7: the name must be text, this is a list\n"},
        {"include: uber\n", "2:10: include must be a list, this is the text 'uber'\n"},
        {"include: [~]\n", "2:11: a folder of the search path must be text, this is empty\n"},
        {"targets: [spirv, glsl45, spirv]\n",
         "2:18: a target cannot be 'glsl45' (did you mean 'glsl450'?)\n2:26: duplicate target 'spirv'\n"},
        {"targets: spirv\n", "2:10: targets must be a list, this is the text 'spirv'\n"},
        {"options: [a]\n", "2:10: options must be a map, this is a list\n"},
        {"options: {optimize: none}\n", "2:11: unknown key 'optimize' in options (did you mean 'optimise'?)\n"},
        {"options: {optimise: fast}\n", "2:21: optimise cannot be 'fast' (known: none, performance, size)\n"},
        {"options: {undefined_macros: eror}\n", "2:29: undefined_macros cannot be 'eror' (did you mean 'error'?)\n"},
        {"options: {debug: yes}\n", "2:18: debug must be true or false, this is the text 'yes'\n"},
        {"options: {debug: 'true'}\n", "2:18: debug must be true or false, this is the text 'true'\n"},
        {"options: {vulkan: 1.2, spirv: 1.5}\n", ""},
        {"options: {vulkan: '1.4'}\n", "2:19: vulkan cannot be '1.4' (did you mean '1.0'?)\n"},
        {"options: {vulkan: '1.0', spirv: '1.3'}\n", "2:33: Vulkan 1.0 takes SPIR-V up to 1.0, not 1.3\n"},
        {"options: {vulkan: '1.1', spirv: '1.5'}\n", "2:33: Vulkan 1.1 takes SPIR-V up to 1.4, not 1.5\n"},
        {"options: {spirv: '1.6'}\n", "2:18: Vulkan 1.1 takes SPIR-V up to 1.4, not 1.6\n"},
        {"options: {vulkan: '1.3', spirv: '1.6'}\n", ""},
        {"options: {vulkan: '1.0'}\n", ""},
        {"rules: {forbid: 1}\n", "2:8: rules must be a list, this is a map\n"},
        {"rules: [a]\n", "2:9: a rule must be a map, this is the text 'a'\n"},
        {"rules: [{because: x}]\n", "2:9: a rule needs a 'forbid' or a 'require'\n"},
        {"rules: [{forbid: 0, require: 1}]\n", "2:9: a rule has either a 'forbid' or a 'require', not both\n"},
        {"rules: [{forbid: 0, because: [x]}]\n", "2:30: because must be text, this is a list\n"},
        {"rules: [{forbidd: 0}]\n",
         "2:9: a rule needs a 'forbid' or a 'require'\n2:10: unknown key 'forbidd' in a rule (did you mean 'forbid'?)\n"},
        {"rules: [{forbid: b}]\n", "2:18: unknown axis 'b'\n"},
    };
    for (const Case& c : table)
        EXPECT_EQ(problems(with("", c.yaml, "shaders:\n  - {name: s, stages: {vertex: v}}\n")), c.expected) << c.yaml;
    EXPECT_EQ(problems("kiln: 2\nshaders:\n  - {name: s, stages: {vertex: v}}\n"),
              "1:7: this program reads manifests of version 1 ('kiln: 1'), this is the text '2'\n");
    EXPECT_EQ(problems("kiln: '1'\nshaders:\n  - {name: s, stages: {vertex: v}}\n"),
              "1:7: this program reads manifests of version 1 ('kiln: 1'), this is the text '1'\n");
    EXPECT_EQ(problems("name: x\nkiln_scene: 1\nobjects: []\n"), "2:1: this is a scene, not a manifest\n");
    EXPECT_EQ(problems("name: x\n"), "1:1: a manifest needs 'kiln'\n1:1: a manifest needs 'shaders'\n");
    EXPECT_EQ(problems("- a\n"), "1:1: a manifest must be a map, this is a list\n");
    EXPECT_EQ(problems("just text\n"), "1:1: a manifest must be a map, this is the text 'just text'\n");
    EXPECT_EQ(problems("~\n"), "1:1: a manifest must be a map, this is empty\n");
    EXPECT_EQ(problems("kiln: 1\nshaders: []\n"), "2:10: shaders is empty: a manifest needs one\n");
    EXPECT_EQ(problems("kiln: 1\nshaders: {name: s}\n"), "2:10: shaders must be a list, this is a map\n");
    EXPECT_EQ(problems("kiln: 1\nshaders:\n"), "2:9: shaders must be a list, this is empty\n");
}

// Each case is the list of shaders from line 8; the axes are a, b and c, and two rules are on (a) and on (a, b).
TEST(ManifestErrors, Shaders) {
    const std::string head =
        "kiln: 1\naxes:\n  a: {macro: A, values: bool}\n  b: {macro: B, values: bool}\n  c: {macro: C, values: bool}\n"
        "rules: [forbid: a, forbid: b && a]\nshaders:\n";
    const Case table[] = {
        {"- {name: s, stages: {vertex: v}, axes: [c, b, a]}\n", ""},
        {"- {name: s, stages: {vertex: v}, axes: [a]}\n- {name: t, stages: {vertex: v}, axes: [a, b]}\n", ""},
        {"- {name: s, stages: {vertex: v}, axes: [a]}\n- {name: t, stages: {vertex: v}, axes: [b]}\n",
         "6:28: this rule fits no shader: none has all of its axes\n"},
        {"- s\n", "8:3: a shader must be a map, this is the text 's'\n"},
        {"- {stages: {vertex: v}}\n", "8:3: a shader needs 'name'\n"},
        {"- {name: s}\n", "8:3: a shader needs 'stages'\n"},
        {"- {name: s, stages: {vertex: v}, axis: [a]}\n", "8:34: unknown key 'axis' in a shader (did you mean 'axes'?)\n"},
        {"- {name: 'a/b', stages: {vertex: v}}\n",
         "8:10: a shader's name cannot be 'a/b': letters, digits, '_', and behind the first also '.' and '-', at most 255 "
         "bytes\n"},
        {"- {name: s, stages: {vertex: v}}\n- {name: s, stages: {vertex: v}}\n", "9:10: duplicate shader 's'\n"},
        {"- {name: s, stages: {vertex: v, vertex: w}}\n", "8:33: duplicate key 'vertex'\n"},
        {"- {name: s, stages: {pixel: v}}\n", "8:22: a stage cannot be 'pixel'\n"},
        {"- {name: s, stages: {fragmnt: v}}\n", "8:22: a stage cannot be 'fragmnt' (did you mean 'fragment'?)\n"},
        {"- {name: s, stages: {vertex: }}\n", "8:29: the file of a stage must be text, this is empty\n"},
        {"- {name: s, stages: {vertex: ''}}\n", "8:30: the file of a stage must be text, this is empty\n"},
        {"- {name: s, stages: [vertex]}\n", "8:21: stages must be a map of stages to files, this is a list\n"},
        {"- {name: s, stages: {}}\n", "8:21: stages is empty: a shader needs at least one\n"},
        {"- {name: s, stages: {fragment: f}}\n", ""},
        {"- {name: s, stages: {compute: c}}\n", ""},
        {"- {name: s, stages: {vertex: v, geometry: g, fragment: f}}\n", ""},
        {"- {name: s, stages: {vertex: v, tess_control: c, tess_evaluation: e, fragment: f}}\n", ""},
        {"- {name: s, stages: {task: t, mesh: m, fragment: f}}\n", ""},
        {"- {name: s, stages: {mesh: m}}\n", ""},
        {"- {name: s, stages: {raygen: r, miss: m, closest_hit: c, any_hit: a, intersection: i, callable: d}}\n", ""},
        {"- {name: s, stages: {compute: c, vertex: v}}\n", "8:21: a vertex stage and a compute stage cannot be one shader\n"},
        {"- {name: s, stages: {compute: c, fragment: f}}\n", "8:21: a fragment stage and a compute stage cannot be one shader\n"},
        {"- {name: s, stages: {mesh: m, vertex: v}}\n", "8:21: a vertex stage and a mesh stage cannot be one shader\n"},
        {"- {name: s, stages: {mesh: m, compute: v}}\n", "8:21: a compute stage and a mesh stage cannot be one shader\n"},
        {"- {name: s, stages: {raygen: m, fragment: v}}\n", "8:21: a fragment stage and a raygen stage cannot be one shader\n"},
        {"- {name: s, stages: {raygen: m, mesh: v}}\n", "8:21: a mesh stage and a raygen stage cannot be one shader\n"},
        {"- {name: s, stages: {task: m}}\n", "8:21: a task stage needs a mesh stage\n"},
        {"- {name: s, stages: {vertex: v, tess_control: m}}\n", "8:21: a tess_control stage needs a tess_evaluation stage\n"},
        {"- {name: s, stages: {vertex: v, tess_evaluation: m}}\n", "8:21: a tess_evaluation stage needs a tess_control stage\n"},
        {"- {name: s, stages: {geometry: m}}\n", "8:21: a geometry stage needs a vertex stage\n"},
        {"- {name: s, stages: {vertex: v}, axes: [a, b, d, a]}\n",
         "8:47: unknown axis 'd' (known: a, b, c)\n8:50: duplicate axis 'a'\n"},
        {"- {name: s, stages: {vertex: v}, axes: a}\n",
         "8:40: a shader's axes must be a list, this is the text "
         "'a'\n"},
        {"- {name: s, stages: {vertex: v}, defines: {N: 4, M: 'a b', E: ''}}\n", ""},
        {"- {name: s, stages: {vertex: v}, defines: {A: 4}}\n", "8:44: 'A' is the macro of axis 'a'\n"},
        {"- {name: s, stages: {vertex: v}, axes: [a, b], defines: {C: 4}}\n", ""},
        {"- {name: s, stages: {vertex: v}, defines: {N: }}\n", "8:46: the body of a macro must be text, this is empty\n"},
        {"- {name: s, stages: {vertex: v}, defines: {N: \"a\\nb\"}}\n",
         "8:47: the body of a macro must be one line, without control characters, and may not end in '\\'\n"},
        {"- {name: s, stages: {vertex: v}, defines: {GL_N: 1, N.M: 1}}\n",
         "8:44: the macro 'GL_N' is reserved: names that begin with 'GL_' belong to GLSL\n"
         "8:53: the macro 'N.M' is no identifier: letters, digits and '_', beginning with no digit\n"},
        {"- {name: s, stages: {vertex: v}, defines: [N]}\n", "8:43: defines must be a map of macros to text, this is a list\n"},
        {"- {name: s, stages: {vertex: v}, options: {vulkan: '1.0', spirv: '1.1'}}\n",
         "8:66: Vulkan 1.0 takes SPIR-V up to 1.0, not 1.1\n"},
        {"- {name: s, stages: {vertex: v}, rules: [forbid: a && e]}\n", "8:55: unknown axis 'e' (known: a, b, c)\n"},
        {"- {name: s, stages: {vertex: v}, axes: [a, b], rules: [require: 'a -> !c']}\n",
         "8:72: shader 's' does not have the axis 'c'\n"},
    };
    for (const Case& c : table) EXPECT_EQ(problems(head + c.yaml), c.expected) << c.yaml;
}

TEST(ManifestErrors, AllAtOnce) {
    EXPECT_EQ(problems("kiln: 3\n"
                       "target: []\n"
                       "axes:\n"
                       "  a: {macro: A, values: [x, x]}\n"
                       "  b: {macro: A, values: 7}\n"
                       "rules:\n"
                       "  - forbid: a == y && b\n"
                       "  - forbid: c\n"
                       "shaders:\n"
                       "  - {name: s, stages: {vertex: v}, axes: [d]}\n"),
              "1:7: this program reads manifests of version 1 ('kiln: 1'), this is the text '3'\n"
              "2:1: unknown key 'target' in a manifest (did you mean 'targets'?)\n"
              "4:29: duplicate value 'x' of axis 'a'\n"
              "5:3: axis 'b' has the macro 'A' of axis 'a'\n"
              "5:25: the values of axis 'b' cannot be '7' (known: bool, defined)\n"
              "7:18: 'y' is not a value of axis 'a' (known: x)\n"
              "8:13: unknown axis 'c' (known: a, b)\n"
              "10:43: unknown axis 'd' (known: a, b)\n");
}

TEST(ManifestErrors, NamesTheFirstPlace) {
    MemoryFiles files;
    files.files["m.yaml"] = "kiln: 1\naxes:\n  a: {macro: A, values: bool}\n  b: {macro: A, values: bool}\nshaders: []\n";
    Diags diags;
    EXPECT_FALSE(load_manifest(files, "m.yaml", diags));
    diags.sort();
    EXPECT_EQ(render(diags.list()[0], false),
              "m.yaml:4:3: error: axis 'b' has the macro 'A' of axis 'a'\n      b: {macro: A, values: bool}\n      ^\n"
              "  first at m.yaml:3:3\n");
}

TEST(ManifestErrors, FilesThatCannotBeRead) {
    MemoryFiles none;
    Diags diags;
    EXPECT_FALSE(load_manifest(none, "m.yaml", diags));
    EXPECT_EQ(render(diags.list()[0], false), "m.yaml: error: no such file\n");
    DiskFiles disk;
    Diags folder;
    EXPECT_FALSE(load_manifest(disk, "/", folder));
    EXPECT_EQ(render(folder.list()[0], false), "/: error: is a folder\n");
}

TEST(ManifestErrors, TellsWhenThereAreTooMany) {
    std::string yaml = "kiln: 1\nshaders:\n  - {name: s, stages: {vertex: v}}\n";
    for (int i = 0; i < 1000; ++i) yaml += "key" + std::to_string(i) + ": 1\n";
    MemoryFiles files;
    files.files["m.yaml"] = yaml;
    Diags diags;
    EXPECT_FALSE(load_manifest(files, "m.yaml", diags));
    EXPECT_EQ(diags.errors(), 201u);
    EXPECT_EQ(diags.list().back().message, "more mistakes follow; these are not shown");
}

}  // namespace
}  // namespace kiln
