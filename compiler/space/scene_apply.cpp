// Scenes as sets: a fact is a set of digits of one axis, an object the intersection of its facts with the scene's and with
// what is legal, a scene the union of its objects.
#include <algorithm>
#include <map>

#include "compiler/manifest/expr.h"
#include "compiler/manifest/yaml_fields.h"
#include "compiler/space/scene.h"

namespace kiln {

namespace {

// Diagnostics of one scene's file, with its lines; after YamlErrors::limit of them it says once that there are more.
class SceneErrors {
public:
    SceneErrors(const Scene& scene, Diags& diags) : scene_(scene), diags_(diags) {}
    void at(SceneSpot spot, std::string message, std::vector<std::string> notes = {}) {
        if (++count_ > YamlErrors::limit + 1) return;
        if (count_ == YamlErrors::limit + 1) message = "more mistakes follow; these are not shown", notes.clear();
        const std::string_view line = line_of(scene_.text, spot.line);
        std::string shown(spot.column > 4096 ? "" : line.substr(0, size_t{spot.column} + 256));
        diags_.error(scene_.place(spot), std::move(message), std::move(shown)).notes = std::move(notes);
    }
    bool full() const { return count_ > YamlErrors::limit; }

private:
    const Scene& scene_;
    Diags& diags_;
    size_t count_ = 0;
};

std::vector<std::string> axis_names(const Space& space) {
    std::vector<std::string> names;
    for (const Axis& a : space.axes) names.push_back(a.name);
    return names;
}

std::optional<uint32_t> axis_named(const Space& space, const std::string& name) {
    for (uint32_t i = 0; i < space.axes.size(); ++i)
        if (space.axes[i].name == name) return i;
    return std::nullopt;
}

std::optional<uint32_t> digit_of(const Axis& axis, const std::string& text) {
    const ParsedInteger integer = parse_integer(text);
    const bool by_number = axis.kind == AxisKind::integer && integer.problem == nullptr;
    for (uint32_t i = 0; i < axis.values.size(); ++i)
        if (by_number ? axis.values[i].number == integer.number : axis.values[i].name == text) return i;
    return std::nullopt;
}

// "light in {none, point}", "material == pbr_mr"
std::string text_of(const SceneFact& fact) {
    if (fact.values.size() == 1) return fact.axis + " == " + fact.values.front().name;
    std::string out = fact.axis + " in {";
    for (size_t i = 0; i < fact.values.size() && i < 8; ++i) out += (i == 0 ? "" : ", ") + fact.values[i].name;
    return out + (fact.values.size() > 8 ? ", ...}" : "}");
}

// The variants of a fact whose names were checked.
Set set_of(Space& space, uint32_t axis, const SceneFact& fact) {
    std::vector<bool> digits(space.axes[axis].values.size());
    for (const SceneValue& value : fact.values)
        if (const auto digit = digit_of(space.axes[axis], value.name)) digits[*digit] = true;
    return space.diagram->where(axis, digits);
}

bool check_values(const Axis& axis, const SceneFact& fact, SceneErrors& errors) {
    bool good = true;
    for (const SceneValue& value : fact.values) {
        if (digit_of(axis, value.name)) continue;
        std::vector<std::string> names;
        for (const AxisValue& v : axis.values) names.push_back(v.name);
        errors.at(value.spot,
                  quoted(value.name) + " is not a value of axis " + quoted(axis.name) + did_you_mean(value.name, names));
        good = false;
    }
    return good;
}

// The scene's facts of every object; each must fit some shader.
bool check_all(const Scene& scene, const std::vector<std::unique_ptr<Space>>& spaces, SceneErrors& errors) {
    bool good = true;
    for (const SceneFact& fact : scene.all) {
        const Axis* axis = nullptr;
        std::vector<std::string> names;
        for (const auto& space : spaces) {
            if (const auto found = axis_named(*space, fact.axis)) axis = &space->axes[*found];
            for (std::string& name : axis_names(*space)) names.push_back(std::move(name));
        }
        if (axis == nullptr) errors.at(fact.spot, "no shader has an axis " + quoted(fact.axis) + did_you_mean(fact.axis, names));
        good = axis != nullptr && check_values(*axis, fact, errors) && good;
    }
    return good;
}

Set allowed_by(Space& space, const Rule& rule) {
    const Set holds = compile_expr(space, rule.expr);
    return rule.forbid ? space.diagram->complement(holds) : holds;
}

std::string text_of(const Rule& rule) {
    return (rule.forbid ? "forbid: " : "require: ") + rule.text + (rule.because.empty() ? "" : " (" + rule.because + ")");
}

// A shader's space with what its rules allow, compiled when the first object needs blaming.
struct Blamed {
    Space& space;
    std::vector<Set> allowed = {};
    const std::vector<Set>& rules() {
        if (allowed.empty())
            for (const Rule& rule : space.rules) allowed.push_back(allowed_by(space, rule));
        return allowed;
    }
};

// Names what leaves an object nothing: facts that exclude one another, or else a set of rules of which none can be spared.
// Each round finds the rule at which nothing is left, after those found before; later rules are not needed.
std::vector<std::string> blame(const Scene& scene, Blamed& blamed, const std::vector<std::pair<const SceneFact*, Set>>& facts) {
    Space& space = blamed.space;
    Diagram& diagram = *space.diagram;
    for (size_t i = 0; i < facts.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            if (diagram.disjoint(facts[i].second, facts[j].second))
                return {"the facts '" + text_of(*facts[j].first) + "' at " + to_string(scene.place(facts[j].first->spot)) +
                        " and '" + text_of(*facts[i].first) + "' at " + to_string(scene.place(facts[i].first->spot)) +
                        " exclude one another"};
    Set wanted = Diagram::all();
    for (const auto& [fact, set] : facts) wanted = diagram.both(wanted, set);
    std::vector<std::string> notes;
    for (size_t end = space.rules.size(); wanted != Diagram::none() && end != 0;) {
        size_t last = 0;
        for (Set left = wanted; last < end; ++last) {
            left = diagram.both(left, blamed.rules()[last]);
            if (left == Diagram::none()) break;
        }
        if (last == end) break;
        wanted = diagram.both(wanted, blamed.rules()[last]);
        notes.push_back("excluded by " + text_of(space.rules[last]) + " at " + to_string(space.rules[last].place));
        end = last;
    }
    return notes;
}

void apply_object(const Scene& scene, SceneObject& object, Blamed& blamed, SceneErrors& errors) {
    Space& space = blamed.space;
    std::vector<std::pair<const SceneFact*, Set>> facts;
    bool good = true;
    for (const SceneFact& fact : scene.all)
        if (const auto axis = axis_named(space, fact.axis)) facts.emplace_back(&fact, set_of(space, *axis, fact));
    for (const SceneFact& fact : object.facts) {
        const auto axis = axis_named(space, fact.axis);
        if (!axis)
            errors.at(fact.spot, "shader " + quoted(space.shader) + " has no axis " + quoted(fact.axis) +
                                     did_you_mean(fact.axis, axis_names(space)));
        good = axis && check_values(space.axes[*axis], fact, errors) && good;
        if (good) facts.emplace_back(&fact, set_of(space, *axis, fact));
    }
    if (!good) return;
    object.drawn = space.legal;
    for (const auto& [fact, set] : facts) object.drawn = space.diagram->both(object.drawn, set);
    if (object.drawn == Diagram::none() && space.legal != Diagram::none() && !errors.full())
        errors.at(object.spot, "this object can draw nothing with shader " + quoted(space.shader), blame(scene, blamed, facts));
}

// Pairwise, so that no operand grows long before its time.
Set union_of(Diagram& diagram, std::vector<Set> sets) {
    std::sort(sets.begin(), sets.end());
    sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
    if (sets.empty()) return Diagram::none();
    for (size_t width = 1; width < sets.size(); width *= 2)
        for (size_t i = 0; i + width < sets.size(); i += 2 * width) sets[i] = diagram.either(sets[i], sets[i + width]);
    return sets.front();
}

}  // namespace

void apply_scenes(std::vector<Scene>& scenes, std::vector<std::unique_ptr<Space>>& spaces, Diags& diags) {
    if (scenes.empty()) {
        for (auto& space : spaces) space->needed = space->legal;
        return;
    }
    std::map<std::string, size_t> shaders;
    std::vector<Blamed> blamed;
    std::vector<std::string> names;
    for (size_t i = 0; i < spaces.size(); ++i) {
        shaders.emplace(spaces[i]->shader, i);
        names.push_back(spaces[i]->shader);
        blamed.push_back({*spaces[i]});
    }
    const size_t errors_before = diags.errors();
    std::vector<std::vector<Set>> drawn(spaces.size());
    std::vector<bool> named(spaces.size());
    for (Scene& scene : scenes) {
        SceneErrors errors(scene, diags);
        const bool all_good = check_all(scene, spaces, errors);
        for (SceneObject& object : scene.objects) {
            const auto found = shaders.find(object.shader);
            if (found == shaders.end()) {
                errors.at(object.spot, "unknown shader " + quoted(object.shader) + did_you_mean(object.shader, names));
                continue;
            }
            named[found->second] = true;
            if (!all_good) continue;
            apply_object(scene, object, blamed[found->second], errors);
            drawn[found->second].push_back(object.drawn);
        }
    }
    for (size_t i = 0; i < spaces.size(); ++i) {
        spaces[i]->needed = union_of(*spaces[i]->diagram, std::move(drawn[i]));
        if (spaces[i]->diagram->exhausted())
            diags.error({scenes.front().path, 0, 0}, "the objects of the scenes are too unlike: the set that shader " +
                                                         quoted(spaces[i]->shader) + " needs grows past the diagram's limit");
        if (!named[i] && diags.errors() == errors_before)
            diags.warning({scenes.front().path, 0, 0},
                          "no object names shader " + quoted(spaces[i]->shader) + ": all of its variants are left out");
    }
}

SceneReason explain_scene(const Scene& scene, Space& space, Set wanted) {
    const std::string begin = "not needed by " + scene.name + ": ";
    size_t objects = 0;
    const SceneObject* only = nullptr;
    for (const SceneObject& object : scene.objects)
        if (object.shader == space.shader) ++objects, only = &object;
    if (objects == 0) return {{scene.path, 0, 0}, begin + "no object draws with " + space.shader};
    const auto excludes = [&](const SceneFact& fact) {
        const auto axis = axis_named(space, fact.axis);
        return axis && space.diagram->disjoint(set_of(space, *axis, fact), wanted);
    };
    for (const SceneFact& fact : scene.all)
        if (excludes(fact)) return {scene.place(fact.spot), begin + "all: " + text_of(fact)};
    if (objects == 1)
        for (const SceneFact& fact : only->facts)
            if (excludes(fact)) return {scene.place(fact.spot), begin + "its object has " + text_of(fact)};
    return {{scene.path, 0, 0},
            begin + "none of its " + std::to_string(objects) + " object" + (objects == 1 ? "" : "s") + " draws this with " +
                space.shader};
}

}  // namespace kiln
