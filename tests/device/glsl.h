#pragma once
// GLSL to what a device draws, with the real compiler and the real reflection.

#include <gtest/gtest.h>

#include "compiler/toolchain/cross.h"
#include "compiler/toolchain/glsl.h"
#include "compiler/validate/check.h"
#include "compiler/validate/inputs.h"

namespace kiln::test {

inline StageCode stage_of(Words words) {
    StageCode out;
    out.words = std::move(words);
    Result<Reflection> r = reflect_words(out.words);
    EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().message);
    if (r.ok()) out.reflection = std::move(*r);
    out.stage = out.reflection.stage;
    return out;
}

inline StageCode compile(Stage stage, const std::string& text) {
    const Compiled c = glsl_compile(stage, text, Options());
    EXPECT_FALSE(c.words.empty()) << (c.messages.empty() ? "" : c.messages.front().text) << "\n" << text;
    return stage_of(c.words);
}

inline StageCode fragment(const std::string& body) { return compile(Stage::fragment, "#version 450\n" + body); }
inline StageCode vertex(const std::string& body) { return compile(Stage::vertex, "#version 450\n" + body); }
inline StageCode compute(const std::string& body) { return compile(Stage::compute, "#version 450\n" + body); }

// A vertex stage that passes its position on and feeds nothing.
inline StageCode plain_vertex() {
    return vertex("layout(location = 0) in vec3 position;\nvoid main() { gl_Position = vec4(position.xy, 0.5, 1.0); }\n");
}

inline CheckJob job_of(const std::vector<StageCode>& stages, const std::vector<StageCode>& unoptimised = {}) {
    CheckJob job;
    for (const StageCode& s : stages) job.optimised.push_back(std::make_shared<StageCode>(s));
    for (const StageCode& s : unoptimised) job.unoptimised.push_back(std::make_shared<StageCode>(s));
    return job;
}

inline PipelineRequest request_of(const std::vector<StageCode>& stages, uint64_t seed = 1) {
    PipelineRequest r;
    r.stages = stages;
    for (const Mood mood : {Mood::ordinary, Mood::mixed}) {
        InputOptions o;
        o.seed = seed;
        o.mood = mood;
        r.inputs.push_back(make_inputs(stages, o));
    }
    return r;
}

// The one device of the test program. No lavapipe or no validation layer fails whoever asks.
Device& device();

}  // namespace kiln::test
