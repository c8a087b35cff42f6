#pragma once
// A small shader with its axes, split and checked against the oracle on every variant.

#include <map>
#include <string>
#include <vector>

#include "compiler/split/split.h"

struct TestAxis {
    std::string macro;
    kiln::AxisKind kind = kiln::AxisKind::boolean;
    std::vector<int32_t> numbers{0, 1};
};

inline TestAxis flag(std::string macro) { return {std::move(macro), kiln::AxisKind::boolean, {0, 1}}; }
inline TestAxis defined(std::string macro) { return {std::move(macro), kiln::AxisKind::defined, {0, 1}}; }
inline TestAxis numbered(std::string macro, std::vector<int32_t> numbers) {
    return {std::move(macro), kiln::AxisKind::integer, std::move(numbers)};
}

struct TestShader {
    std::map<std::string, std::string> files;  // "main" is the stage's file
    std::vector<TestAxis> axes;
    kiln::Stage stage = kiln::Stage::fragment;
    std::vector<std::string> include;
    std::vector<std::pair<std::string, std::string>> defines;
    std::string forbid;  // a rule, or empty
    bool undefined_is_zero = false;
    uint64_t max_states = 100'000;
    bool lines = false;
};

// A stage of one file.
inline TestShader one_file(std::string text, std::vector<TestAxis> axes) {
    TestShader shader;
    shader.files["main"] = std::move(text);
    shader.axes = std::move(axes);
    return shader;
}

struct SplitTest {
    kiln::Manifest manifest;
    std::unique_ptr<kiln::Space> space;
    kiln::MemoryFiles files;
    kiln::Split split;
};

std::unique_ptr<SplitTest> run_split(const TestShader& shader);
// The tokens of a preprocessed text, without #line lines and the include extension.
std::vector<std::string> tokens_of(const std::string& text);
// Splits, asks the oracle for every legal variant, and expects equal streams, equal classes and errors for the same
// variants. True when no variant had an error.
bool expect_like_oracle(const TestShader& shader, const std::string& note = {});
// The messages of all errors, one a line, with the first note.
std::string messages(const kiln::Split& split);
