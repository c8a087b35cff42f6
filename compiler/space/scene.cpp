// Reads a scene's YAML. Names are only text here: which axes and values there are is known once there is a manifest.
#include "compiler/space/scene.h"

#include "compiler/manifest/yaml_fields.h"

namespace kiln {

namespace {

class SceneReader {
public:
    SceneReader(const Yaml& yaml, YamlErrors& errors, Scene& out) : yaml_(yaml), errors_(errors), out_(out) {}

    void read() {
        for (const Yaml::Pair& pair : yaml_.pairs(0))
            if (yaml_.value(pair.key) == "kiln") return errors_.at(pair.key, "this is a manifest, not a scene");
        Fields top(yaml_, errors_, 0, "a scene", {"kiln_scene", "name", "all", "objects"});
        if (!top.is_map()) return;
        if (const auto* f = top.need("kiln_scene"))
            if (!yaml_.is_plain(f->value) || yaml_.value(f->value) != "1")
                errors_.at(f->value,
                           "this program reads scenes of version 1 ('kiln_scene: 1'), this is " + describe(yaml_, f->value));
        if (const auto* f = top.find("name"))
            if (auto name = read_text(yaml_, errors_, f->value, "the name")) out_.name = std::move(*name);
        if (const auto* f = top.find("all")) {
            if (yaml_.kind(f->value) != YamlKind::map)
                errors_.at(f->value, "all must be a map of facts, this is " + describe(yaml_, f->value));
            for (const Yaml::Pair& pair : yaml_.pairs(f->value)) fact(pair, out_.all);
        }
        if (const auto* f = top.need("objects"))
            for (const Yaml::Node item : read_list(yaml_, errors_, f->value, "objects")) object(item);
    }

private:
    SceneSpot spot(Yaml::Node node) const {
        const YamlSpot place = yaml_.spot(node);
        return {place.line, place.column};
    }

    void object(Yaml::Node node) {
        if (yaml_.kind(node) != YamlKind::map)
            return errors_.at(node, "an object must be a map of a shader and facts, this is " + describe(yaml_, node));
        SceneObject out;
        for (const Yaml::Pair& pair : yaml_.pairs(node)) {
            if (yaml_.value(pair.key) != "shader") {
                fact(pair, out.facts);
            } else if (auto name = read_text(yaml_, errors_, pair.value, "the shader of an object")) {
                out.shader = std::move(*name);
                out.spot = spot(pair.value);
            } else {
                out.shader = "?";
            }
        }
        if (out.shader.empty()) errors_.at(node, "an object needs a 'shader'");
        out_.objects.push_back(std::move(out));
    }

    void fact(const Yaml::Pair& pair, std::vector<SceneFact>& to) {
        SceneFact out;
        out.axis = std::string(yaml_.value(pair.key));
        out.spot = spot(pair.key);
        const std::string what = "the value of " + quoted(out.axis);
        if (yaml_.kind(pair.value) == YamlKind::map) {
            Fields fields(yaml_, errors_, pair.value, "a fact", {"in"});
            if (const auto* f = fields.need("in")) {
                const std::vector<Yaml::Node> items = read_list(yaml_, errors_, f->value, "in");
                if (yaml_.kind(f->value) == YamlKind::sequence && items.empty())
                    errors_.at(f->value, "an empty list: nothing could be drawn");
                for (const Yaml::Node item : items) value(item, what, out);
            }
        } else if (yaml_.kind(pair.value) == YamlKind::sequence) {
            errors_.at(pair.value, "several values are written {in: [...]}");
        } else {
            value(pair.value, what, out);
        }
        to.push_back(std::move(out));
    }

    void value(Yaml::Node node, const std::string& what, SceneFact& out) {
        if (auto text = read_text(yaml_, errors_, node, what)) out.values.push_back({std::move(*text), spot(node)});
    }

    const Yaml& yaml_;
    YamlErrors& errors_;
    Scene& out_;
};

}  // namespace

std::optional<Scene> load_scene(Files& files, const std::string& path, Diags& diags) {
    std::optional<std::string> text = read_source(files, path, diags);
    if (!text) return std::nullopt;
    Scene out;
    out.path = path;
    out.name = stem_of(path);
    const std::optional<Yaml> yaml = Yaml::parse(path, std::move(*text), diags);
    if (!yaml) return std::nullopt;
    YamlErrors errors(*yaml, diags);
    SceneReader(*yaml, errors, out).read();
    if (errors.any()) return std::nullopt;
    out.text = yaml->text();
    return out;
}

}  // namespace kiln
