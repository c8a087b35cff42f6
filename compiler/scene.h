#pragma once
// What scenes can draw, as restrictions of the spaces (DESIGN section 6). A scene can only be too large, never too small.

#include <memory>
#include <string>
#include <vector>

#include "compiler/space.h"

namespace kiln {

struct SceneFact {
    std::string axis;
    std::vector<std::string> values;  // names, as written
    Place place;
    std::string source_line;
};

struct SceneObject {
    std::string shader;
    std::vector<SceneFact> facts;
    Place place;
    std::string source_line;
};

struct Scene {
    std::string name;
    std::string path;
    std::vector<SceneFact> all;
    std::vector<SceneObject> objects;
};

std::optional<Scene> load_scene(Files& files, const std::string& path, Diags& diags);

// Sets `needed` of every space to the union over all scenes' objects; without scenes, to `legal`. Shaders that no object
// names become empty with a warning. An object that can draw nothing is an error naming the rule or fact.
void apply_scenes(const std::vector<Scene>& scenes, std::vector<std::unique_ptr<Space>>& spaces, Diags& diags);

}  // namespace kiln
