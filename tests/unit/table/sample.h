#pragma once
// Hand-made inputs for the table: a shader's axes and rules as text, and for each stage a function from a variant to a text,
// from which classes, modules and artifacts follow by brute force.

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compiler/table/table.h"

namespace kiln::test {

using TextOf = std::function<std::string(const Digits&)>;

struct SampleStage {
    Stage stage = Stage::vertex;
    std::vector<uint32_t> reads;  // axes
    TextOf text;                  // of the variant; must depend on `reads` only
    // Classes by expression instead, for spaces too large to list: they must partition the needed set.
    std::vector<std::string> conditions = {};
};

struct SampleShader {
    std::string name;
    std::vector<Axis> axes;
    std::vector<std::string> forbid;
    std::vector<SampleStage> stages;
    std::string needed = {};  // an expression; empty: everything legal
};

Axis named(std::string name, std::vector<std::string> values);
Axis boolean(std::string name);

class Sample {
public:
    explicit Sample(std::vector<SampleShader> shaders, std::vector<Target> targets = {Target::spirv, Target::glsl450});
    TableInput input() const;
    Space& space(size_t shader) { return *spaces_[shader]; }
    const Modules& modules() const { return modules_; }
    const Artifacts& artifacts() const { return artifacts_; }
    const std::vector<StageClasses>& stages() const { return stages_; }
    // The module of a needed variant, by asking every class.
    uint32_t module_of(size_t stage, const Digits& digits) const;

    Manifest manifest;
    std::string tool_versions = "sample 1";
    std::vector<std::string> scenes;
    Modules modules_;
    Artifacts artifacts_;
    Interfaces interfaces_;

private:
    void add(const SampleShader& shader, size_t index);
    uint32_t module(Stage stage, const std::string& text);
    std::vector<std::unique_ptr<Space>> spaces_;
    std::vector<std::unique_ptr<Split>> splits_;
    std::vector<StageClasses> stages_;
    std::map<std::pair<Stage, std::string>, uint32_t> known_;
};

// A small table with two shaders, forbidden and unneeded variants, reflection, slots, a hole and texts in several blocks.
Sample small_sample();

// Calls visit with every combination of digits, legal or not.
void every(const std::vector<uint32_t>& radices, const std::function<void(const Digits&)>& visit);

}  // namespace kiln::test
