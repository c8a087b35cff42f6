// The macros before the first line, by asking glslang for every name that it might know.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "compiler/split/predefined.h"
#include "fixture.h"
#include "oracle.h"

using namespace kiln;

namespace {

std::set<std::string> all_names() {
    std::set<std::string> out{"GL_SPIRV", "GL_ES", "VULKAN", "GL_FRAGMENT_SHADER", "GL_compatibility_profile", "GL_es_profile"};
    for (const Stage stage : all_stages())
        for (const bool es : {false, true})
            for (const Predefined& p : predefined_macros(stage, 460, es, true)) out.insert(std::string(p.name));
    return out;
}

TEST(Predefined, LikeGlslang) {
    const std::set<std::string> names = all_names();
    EXPECT_GT(names.size(), 150u);
    struct Case {
        const char* line;
        int version;
        bool es, compatibility;
    };
    const Case cases[] = {{"140", 140, false, false},      {"150", 150, false, false},
                          {"330 core", 330, false, false}, {"450", 450, false, false},
                          {"460", 460, false, false},      {"310 es", 310, true, false},
                          {"320 es", 320, true, false},    {"450 compatibility", 450, false, true}};
    size_t asked = 0;
    for (const Case& c : cases)
        for (const Stage stage : all_stages()) {
            // glslang prints all its built-ins where a version has not the stage.
            if (c.version == 140 && stage != Stage::vertex && stage != Stage::fragment) continue;
            std::string text = std::string("#version ") + c.line + "\n";
            for (const std::string& name : names) text += "#ifdef " + name + "\nhas(x" + name + "x = " + name + ");\n#endif\n";
            const oracle::Answer answer = oracle::preprocess(stage, {{"main", text}}, "main", "");
            if (!answer.ok) continue;  // a stage that the version does not have
            ++asked;
            std::set<std::string> want, got;
            for (size_t at = answer.text.find("has("); at != std::string::npos; at = answer.text.find("has(", at + 1)) {
                std::string line = answer.text.substr(at, answer.text.find(';', at) - at);
                line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
                want.insert(line);
            }
            for (const Predefined& p : predefined_macros(stage, c.version, c.es, c.compatibility))
                got.insert("has(x" + std::string(p.name) + "x=" + std::to_string(p.value) + ")");
            EXPECT_EQ(got, want) << c.line << " " << name_of(stage) << "\n" << answer.log;
        }
    EXPECT_GT(asked, 50u);
}

}  // namespace
