#include "compiler/space/scene.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace kiln {
namespace {

constexpr const char* manifest_text = R"(kiln: 1
axes:
  light:     {macro: L, values: [none, point, spot]}
  material:  {macro: M, values: [phong, pbr_mr, pbr_sg]}
  cascades:  {macro: C, values: [1, 2, 4]}
  two_sided: {macro: T, values: bool}
rules:
  - forbid: light == none && cascades != 1
    because: no shadows without a light
  - require: "material == pbr_sg -> !two_sided"
shaders:
  - {name: surface, stages: {fragment: f}}
  - {name: sky, stages: {fragment: g}, axes: [light]}
)";

struct World {
    MemoryFiles files;
    Diags diags;
    std::optional<Manifest> manifest;
    std::vector<std::unique_ptr<Space>> spaces;
    std::vector<Scene> scenes;

    explicit World(const char* text = manifest_text) {
        files.files["m.yaml"] = text;
        manifest = load_manifest(files, "m.yaml", diags);
        EXPECT_TRUE(manifest);
        if (!manifest) return;
        for (const Shader& s : manifest->shaders) spaces.push_back(build_space(*manifest, s, diags));
    }
    void load(const std::string& text) {
        const std::string path = "scene" + std::to_string(scenes.size()) + ".yaml";
        files.files[path] = text;
        if (auto scene = load_scene(files, path, diags)) scenes.push_back(std::move(*scene));
    }
    void apply() { apply_scenes(scenes, spaces, diags); }
    std::string needed(size_t space) { return spaces[space]->diagram->count(spaces[space]->needed).decimal(); }
    std::string problems() {
        diags.sort();
        std::string out;
        for (const Diag& d : diags.list()) {
            out += std::to_string(d.place.line) + ":" + std::to_string(d.place.column) + ": " +
                   (d.severity == Severity::warning ? "warning: " : "") + d.message + "\n";
            for (const std::string& note : d.notes) out += "  " + note + "\n";
        }
        return out;
    }
};

TEST(Scene, WithoutScenesEverythingLegalIsNeeded) {
    World w;
    w.apply();
    EXPECT_EQ(w.problems(), "");
    for (const auto& space : w.spaces) EXPECT_EQ(space->needed, space->legal);
}

TEST(Scene, UnionOfObjects) {
    World w;
    w.load(R"(kiln_scene: 1
name: corridor
all: {light: {in: [none, point]}, cascades: 0x1}
objects:
  - {shader: surface, material: pbr_mr, two_sided: false}
  - {shader: surface, material: {in: [phong, pbr_mr]}, light: point}
  - {shader: sky}
)");
    w.apply();
    EXPECT_EQ(w.problems(), "");
    ASSERT_EQ(w.scenes.size(), 1u);
    EXPECT_EQ(w.scenes[0].name, "corridor");
    // (none, point) x pbr_mr x false, and point x (phong, pbr_mr) x (false, true), one shared.
    EXPECT_EQ(w.needed(0), "5");
    EXPECT_EQ(w.needed(1), "2");
    EXPECT_EQ(w.spaces[0]->diagram->count(w.scenes[0].objects[1].drawn).decimal(), "4");
}

TEST(Scene, SeveralFilesAndWhatNobodyNames) {
    World w;
    w.load("kiln_scene: 1\nobjects: [{shader: surface, material: phong, light: none}]\n");
    w.load("kiln_scene: 1\nobjects: [{shader: surface, material: phong, light: spot, two_sided: true}]\n");
    w.apply();
    EXPECT_EQ(w.problems(), "0:0: warning: no object names shader 'sky': all of its variants are left out\n");
    EXPECT_EQ(w.needed(0), "5");
    EXPECT_EQ(w.needed(1), "0");
    EXPECT_EQ(w.scenes[0].name, "scene0");
}

TEST(Scene, FactsOfAllAreSkippedWhereTheAxisIsMissing) {
    World w;
    w.load("kiln_scene: 1\nall: {material: phong}\nobjects: [{shader: sky}, {shader: surface, light: none}]\n");
    w.apply();
    EXPECT_EQ(w.problems(), "");
    EXPECT_EQ(w.needed(1), "3");
}

TEST(Scene, MistakesInTheFile) {
    const std::pair<const char*, const char*> table[] = {
        {"kiln_scene: 2\nobjects: []\n",
         "1:13: this program reads scenes of version 1 ('kiln_scene: 1'), this is the text '2'\n"},
        {"kiln: 1\nobjects: []\n", "1:1: this is a manifest, not a scene\n"},
        {"objects: []\n", "1:1: a scene needs 'kiln_scene'\n"},
        {"kiln_scene: 1\n", "1:1: a scene needs 'objects'\n"},
        {"kiln_scene: 1\nobjects: {}\n", "2:10: objects must be a list, this is a map\n"},
        {"kiln_scene: 1\nobjects: [surface]\n",
         "2:11: an object must be a map of a shader and facts, this is the text 'surface'\n"},
        {"kiln_scene: 1\nobjects: [{light: none}]\n", "2:11: an object needs a 'shader'\n"},
        {"kiln_scene: 1\nobjects: [{shader: }]\n", "2:19: the shader of an object must be text, this is empty\n"},
        {"kiln_scene: 1\nall: [a]\nobjects: []\n", "2:6: all must be a map of facts, this is a list\n"},
        {"kiln_scene: 1\nall: {light: [none]}\nobjects: []\n", "2:14: several values are written {in: [...]}\n"},
        {"kiln_scene: 1\nall: {light: {on: [none]}}\nobjects: []\n",
         "2:14: a fact needs 'in'\n2:15: unknown key 'on' in a fact (did you mean 'in'?)\n"},
        {"kiln_scene: 1\nall: {light: {in: none}}\nobjects: []\n", "2:19: in must be a list, this is the text 'none'\n"},
        {"kiln_scene: 1\nall: {light: {in: []}}\nobjects: []\n", "2:19: an empty list: nothing could be drawn\n"},
        {"kiln_scene: 1\nall: {light: ~}\nobjects: []\n", "2:14: the value of 'light' must be text, this is empty\n"},
        {"kiln_scene: 1\nall: {light: none, light: spot}\nobjects: []\n",
         "2:20: duplicate key 'light'\n  first at scene0.yaml:2:7\n"},
        {"kiln_scene: 1\nall: {light: !none}\nobjects: []\n",
         "2:14: '!' begins a YAML tag, which kiln does not use\n  quote it: text that begins with '!', '&', '*', '{' or '[' "
         "means "
         "something else to YAML\n"},
    };
    for (const auto& [text, expected] : table) {
        World w;
        w.load(text);
        EXPECT_TRUE(w.scenes.empty()) << text;
        EXPECT_EQ(w.problems(), expected) << text;
    }
    World w;
    EXPECT_FALSE(load_scene(w.files, "absent.yaml", w.diags));
    EXPECT_EQ(w.problems(), "0:0: no such file\n");
}

TEST(Scene, MistakesAgainstTheManifest) {
    const std::pair<const char*, const char*> table[] = {
        {"objects: [{shader: surfaces}, {shader: sky}]", "2:20: unknown shader 'surfaces' (did you mean 'surface'?)\n"},
        {"objects: [{shader: surface, ligth: none}, {shader: sky}]",
         "2:29: shader 'surface' has no axis 'ligth' (did you mean 'light'?)\n"},
        {"objects: [{shader: surface}, {shader: sky, material: phong}]",
         "2:44: shader 'sky' has no axis 'material' (known: light)\n"},
        {"objects: [{shader: surface, light: pont}, {shader: sky}]",
         "2:36: 'pont' is not a value of axis 'light' (did you mean 'point'?)\n"},
        {"objects: [{shader: surface, cascades: {in: [1, 3]}}, {shader: sky}]",
         "2:48: '3' is not a value of axis 'cascades' (known: 1, 2, 4)\n"},
        {"objects: [{shader: surface, two_sided: yes}, {shader: sky}]",
         "2:40: 'yes' is not a value of axis 'two_sided' (known: false, true)\n"},
        {"all: {lihgt: none}\nobjects: [{shader: surface}, {shader: sky}]",
         "2:7: no shader has an axis 'lihgt' (did you mean 'light'?)\n"},
        {"all: {light: nnoe}\nobjects: [{shader: surface}, {shader: sky}]",
         "2:14: 'nnoe' is not a value of axis 'light' (did you mean 'none'?)\n"},
        {"objects: [{shader: surface, light: none, cascades: 2}, {shader: sky}]",
         "2:20: this object can draw nothing with shader 'surface'\n"
         "  excluded by forbid: light == none && cascades != 1 (no shadows without a light) at m.yaml:8:13\n"},
        {"all: {light: none}\nobjects: [{shader: surface, light: {in: [point, spot]}}, {shader: sky}]",
         "3:20: this object can draw nothing with shader 'surface'\n"
         "  the facts 'light == none' at scene0.yaml:2:7 and 'light in {point, spot}' at scene0.yaml:3:29 exclude one another\n"},
    };
    for (const auto& [text, expected] : table) {
        World w;
        w.load("kiln_scene: 1\n" + std::string(text) + "\n");
        ASSERT_EQ(w.scenes.size(), 1u) << text;
        w.apply();
        EXPECT_EQ(w.problems(), expected) << text;
    }
}

// Of several rules, those that together leave nothing, and no other.
TEST(Scene, BlamesRulesThatCannotBeSpared) {
    World w(R"(kiln: 1
axes:
  a: {macro: A, values: bool}
  b: {macro: B, values: bool}
  c: {macro: C, values: bool}
rules:
  - forbid: b && c
  - require: a -> b
  - forbid: c && !a
  - require: b -> a
  - require: a -> !c
shaders:
  - {name: s, stages: {fragment: f}}
)");
    w.load("kiln_scene: 1\nobjects: [{shader: s, c: true}, {shader: s, a: true, c: true}, {shader: s, b: true, c: true}]\n");
    w.apply();
    EXPECT_EQ(w.problems(),
              "2:20: this object can draw nothing with shader 's'\n"
              "  excluded by forbid: c && !a at m.yaml:9:13\n"
              "  excluded by require: a -> b at m.yaml:8:14\n"
              "  excluded by forbid: b && c at m.yaml:7:13\n"
              "2:42: this object can draw nothing with shader 's'\n"
              "  excluded by require: a -> b at m.yaml:8:14\n"
              "  excluded by forbid: b && c at m.yaml:7:13\n"
              "2:73: this object can draw nothing with shader 's'\n"
              "  excluded by forbid: b && c at m.yaml:7:13\n");
}

TEST(Scene, SaysWhyAVariantIsNotNeeded) {
    World w;
    w.load(R"(kiln_scene: 1
name: hall
all: {light: {in: [none, point]}}
objects:
  - {shader: surface, material: phong, cascades: 1}
)");
    w.apply();
    Space& surface = *w.spaces[0];
    Diagram& d = *surface.diagram;
    const auto why = [&](Space& space, Set wanted) {
        const SceneReason reason = explain_scene(w.scenes[0], space, wanted);
        return std::to_string(reason.place.line) + ":" + std::to_string(reason.place.column) + ": " + reason.text;
    };
    EXPECT_EQ(why(surface, d.both(surface.legal, d.where(0, 2))), "3:7: not needed by hall: all: light in {none, point}");
    EXPECT_EQ(why(surface, d.both(surface.legal, d.where(1, 1))), "5:23: not needed by hall: its object has material == phong");
    EXPECT_EQ(why(*w.spaces[1], Diagram::all()), "0:0: not needed by hall: no object draws with sky");
    const Set two = d.either(d.both(d.where(1, 0), d.where(2, 1)), d.both(d.where(1, 1), d.where(2, 0)));
    EXPECT_EQ(why(surface, d.both(d.both(surface.legal, two), d.where(0, 1))),
              "0:0: not needed by hall: none of its 1 object draws this with surface");
}

// needed must equal the union that is computed by listing, for scenes at random.
TEST(Scene, AgreesWithListing) {
    std::mt19937 random(7);  // the seed
    for (int round = 0; round < 300; ++round) {
        World w;
        Space& space = *w.spaces[0];
        const auto fact = [&](const Axis& axis, std::vector<std::set<std::string>>& allowed, size_t index) {
            std::set<std::string> values;
            std::string text;
            for (const AxisValue& v : axis.values)
                if (random() % 3 != 0) values.insert(v.name);
            if (values.empty()) values.insert(axis.values[0].name);
            for (const std::string& v : values) text += (text.empty() ? "" : ", ") + v;
            std::set<std::string> both;
            for (const std::string& v : allowed[index])
                if (values.count(v) != 0) both.insert(v);
            allowed[index] = both;
            return axis.name + ": " + (values.size() == 1 ? text : "{in: [" + text + "]}");
        };
        std::vector<std::set<std::string>> open;
        for (const Axis& a : space.axes) {
            open.emplace_back();
            for (const AxisValue& v : a.values) open.back().insert(v.name);
        }
        std::string all, objects;
        for (size_t a = 0; a < space.axes.size(); ++a)
            if (random() % 4 == 0) all += (all.empty() ? "" : ", ") + fact(space.axes[a], open, a);
        std::vector<std::vector<std::set<std::string>>> drawn;
        for (unsigned o = 0; o <= random() % 4; ++o) {
            drawn.push_back(open);
            objects += "  - {shader: surface";
            for (size_t a = 0; a < space.axes.size(); ++a)
                if (random() % 2 == 0) objects += ", " + fact(space.axes[a], drawn.back(), a);
            objects += "}\n";
        }
        w.load("kiln_scene: 1\nall: {" + all + "}\nobjects:\n" + objects);
        ASSERT_EQ(w.scenes.size(), 1u) << all << objects;
        w.apply();
        space.diagram->enumerate(Diagram::all(), [&](const Digits& digits) {
            bool expected = false;
            for (const auto& object : drawn) {
                bool inside = space.diagram->contains(space.legal, digits);
                for (size_t a = 0; a < digits.size(); ++a)
                    inside = inside && object[a].count(space.axes[a].values[digits[a]].name) != 0;
                expected = expected || inside;
            }
            EXPECT_EQ(space.diagram->contains(space.needed, digits), expected) << all << "\n" << objects;
            return true;
        });
        bool nothing = false;
        for (const SceneObject& o : w.scenes[0].objects) nothing = nothing || o.drawn == Diagram::none();
        EXPECT_EQ(w.diags.has_errors(), nothing);
    }
}

}  // namespace
}  // namespace kiln
