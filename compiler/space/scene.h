#pragma once
// What scenes can draw, as restrictions of the spaces (ARCHITECTURE.md, Manifests and scenes). A scene can only be too large,
// never too small. A YAML file is one source of scenes; whatever else says what is drawn becomes a Scene value as well.

#include <memory>
#include <string>
#include <vector>

#include "compiler/space/space.h"

namespace kiln {

// A place in the scene's own file.
struct SceneSpot {
    uint32_t line = 0, column = 0;
};

struct SceneValue {
    std::string name;  // as written
    SceneSpot spot;
};

// The axis has one of these values.
struct SceneFact {
    std::string axis;
    std::vector<SceneValue> values;  // at least one
    SceneSpot spot;                  // of the axis's name
};

struct SceneObject {
    std::string shader;
    std::vector<SceneFact> facts;
    SceneSpot spot;  // of the shader's name
    Set drawn;       // its legal variants in the shader's space; filled by apply_scenes
};

struct Scene {
    std::string name;  // the file's name without its ending when the file gives none
    std::string path;
    std::string text;  // the file, for showing lines of it
    std::vector<SceneFact> all;
    std::vector<SceneObject> objects;

    Place place(SceneSpot spot) const { return {path, spot.line, spot.column}; }
};

// Errors go to `diags`; nullopt when there were any.
std::optional<Scene> load_scene(Files& files, const std::string& path, Diags& diags);

// Sets `needed` of every space to the union over all scenes' objects; without scenes, to `legal`. Shaders that no object
// names become empty with a warning. An object that can draw nothing is an error naming the rule or fact, and so is a fact on
// an axis or a value that nobody has.
void apply_scenes(std::vector<Scene>& scenes, std::vector<std::unique_ptr<Space>>& spaces, Diags& diags);

// Why a scene does not need any of `wanted` (legal variants of `space`), after apply_scenes:
//   "not needed by corridor: all: pass in {forward, depth}"      with the place of the fact
//   "not needed by corridor: no object draws with sky"
//   "not needed by corridor: none of its 4 objects draws this with surface"
struct SceneReason {
    Place place;
    std::string text;
};
SceneReason explain_scene(const Scene& scene, Space& space, Set wanted);

}  // namespace kiln
