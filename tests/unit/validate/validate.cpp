// The whole policy over a real table, with a fake device.

#include "compiler/validate/validate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "compiler/pass.h"
#include "compiler/validate/validate_tasks.h"
#include "tests/unit/validate/fake_device.h"

namespace kiln {
namespace {

constexpr const char* manifest = R"(kiln: 1
name: tiny
targets: [spirv]
axes:
  tone: {macro: TONE, values: [plain, warm, cold]}
  fog: {macro: FOG, values: bool}
rules:
  - {forbid: tone == cold && fog, because: no such weather}
shaders:
  - name: tiny
    stages: {vertex: tiny.vert, fragment: tiny.frag}
)";
constexpr const char* vertex_text = R"(#version 450
layout(location = 0) in vec3 position;
void main() { gl_Position = vec4(position, 1.0); }
)";
constexpr const char* fragment_text = R"(#version 450
layout(set = 0, binding = 2) uniform sampler2D albedo;
layout(location = 0) out vec4 c;
void main() {
    c = texture(albedo, vec2(0.5));
#if TONE == 1
    c.r *= 1.25;
#elif TONE == 2
    c.b *= 1.25;
#endif
#if FOG
    c = c * 0.5 + 0.25;
#endif
}
)";

const TableFiles& table() {
    static const TableFiles made = [] {
        MemoryFiles files({{"tiny.yaml", manifest}, {"tiny.vert", vertex_text}, {"tiny.frag", fragment_text}});
        MemoryStore store;
        const std::unique_ptr<Toolchain> tools = make_toolchain();
        const Jobs jobs(1);
        PassContext context{files, store, *tools, jobs, {}};
        BuildOptions options;
        options.manifest = "tiny.yaml";
        Build build = run_pass(options, context);
        for (const Diag& d : build.diags.list()) ADD_FAILURE() << render(d, false);
        return build.files;
    }();
    return made;
}

struct Bench {
    MemoryStore store;
    std::unique_ptr<Toolchain> tools = make_toolchain();
    int requests = 0;
    test::FakeDevice::Answer answer = [](const PipelineRequest& r) { return test::picture(r); };
    Result<ValidateReport> operator()(const ValidateOptions& options = {}, bool with_proof = true) {
        const std::unique_ptr<WorkerPool> pool = local_pool(std::make_unique<test::FakeDevice>([this](const PipelineRequest& r) {
            ++requests;
            return answer(r);
        }));
        return validate(table().table, with_proof ? ByteView(table().proof) : ByteView(), options, *pool, store, *tools, {});
    }
};

TEST(Validate, RunsEveryPipelineOnceAndRemembers) {
    Bench run;
    const Result<ValidateReport> first = run();
    ASSERT_TRUE(first.ok()) << first.error().message;
    EXPECT_EQ(first->variants, Count(5));
    EXPECT_EQ(first->pipelines, 5u);
    EXPECT_EQ(first->run, 5u);
    EXPECT_EQ(first->passed, 5u);
    EXPECT_EQ(first->not_compared, 0u);
    EXPECT_TRUE(first->ok());
    const int before = run.requests;
    const Result<ValidateReport> second = run();
    ASSERT_TRUE(second.ok());
    EXPECT_EQ(second->run, 0u);
    EXPECT_EQ(second->cached, 5u);
    EXPECT_EQ(second->passed, 5u);
    EXPECT_EQ(run.requests, before);
}

TEST(Validate, WithoutProofNothingCountsAsCompared) {
    Bench run;
    const Result<ValidateReport> r = run({}, false);
    ASSERT_TRUE(r.ok()) << r.error().message;
    EXPECT_EQ(r->not_compared, 5u);
    EXPECT_EQ(r->values, 0u);
}

TEST(Validate, AFailureNamesItsVariantsExactly) {
    Bench run;
    std::set<Words> seen;
    run.answer = [&](const PipelineRequest& r) {
        // Warm pipelines scale the red channel by 1.25: that constant is in their words and in no other's.
        const Words& words = r.stages.back().words;
        const bool red = std::find(words.begin(), words.end(), 0x3fa00000u) != words.end();
        return test::picture(r, red ? 0x7fc00000u : 0x3f000000u);
    };
    const Result<ValidateReport> r = run();
    ASSERT_TRUE(r.ok()) << r.error().message;
    ASSERT_EQ(r->failed.size(), 3u) << "warm, warm in fog, cold";
    EXPECT_EQ(r->nonfinite, 3u);
    EXPECT_EQ(r->passed, 2u);
    EXPECT_FALSE(r->ok());
    for (const Finding& f : r->failed) {
        EXPECT_EQ(f.shader, "tiny");
        EXPECT_NE(f.where.find("in 1 of 5 variants of tiny: exactly when "), std::string::npos) << f.where;
        EXPECT_NE(f.why.find("not finite"), std::string::npos) << f.why;
    }
}

TEST(Validate, UndrawnAndUnsupportedAreFiguresAndNotPasses) {
    Bench run;
    run.answer = [](const PipelineRequest& r) { return test::picture(r, 0x3f000000u, 0); };
    const Result<ValidateReport> undrawn = run();
    ASSERT_TRUE(undrawn.ok());
    EXPECT_EQ(undrawn->undrawn.size(), 5u);
    EXPECT_TRUE(undrawn->ok());
    Bench other;
    other.answer = [](const PipelineRequest&) {
        PipelineOutput out;
        out.unsupported = "no such thing here";
        return out;
    };
    const Result<ValidateReport> unsupported = other();
    ASSERT_TRUE(unsupported.ok());
    EXPECT_EQ(unsupported->unsupported.size(), 5u);
    EXPECT_EQ(unsupported->passed, 0u);
}

TEST(Validate, BadRequestsAndBadFilesAreErrors) {
    Bench run;
    ValidateOptions options;
    options.shader = "tinny";
    const Result<ValidateReport> filter = run(options);
    ASSERT_FALSE(filter.ok());
    EXPECT_NE(filter.error().message.find("did you mean 'tiny'"), std::string::npos) << filter.error().message;

    const std::unique_ptr<WorkerPool> pool = local_pool(std::make_unique<test::FakeDevice>(run.answer));
    Bytes damaged = table().table;
    damaged[damaged.size() / 2] ^= 1;
    EXPECT_FALSE(validate(damaged, {}, {}, *pool, run.store, *run.tools, {}).ok());
    Bytes proof = table().proof;
    proof[proof.size() / 2] ^= 1;
    EXPECT_FALSE(validate(table().table, proof, {}, *pool, run.store, *run.tools, {}).ok());
}

TEST(Sample, CoversEveryModuleThenFillsUp) {
    uint64_t state = 12345;
    const auto random = [&](uint32_t n) {
        return static_cast<uint32_t>((state = state * 6364136223846793005ull + 1442695040888963407ull) >> 40) % n;
    };
    for (int round = 0; round < 200; ++round) {
        std::vector<std::vector<uint32_t>> pipelines(1 + random(60));
        std::set<uint32_t> modules;
        for (auto& p : pipelines) {
            p = {random(8), 100 + random(40)};
            modules.insert(p.begin(), p.end());
        }
        const uint64_t wanted = random(80);
        const std::vector<size_t> chosen = choose_sample(pipelines, wanted, 7);
        EXPECT_EQ(chosen, choose_sample(pipelines, wanted, 7));
        std::set<uint32_t> covered;
        for (const size_t i : chosen) covered.insert(pipelines.at(i).begin(), pipelines.at(i).end());
        EXPECT_EQ(covered, modules);
        EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
        EXPECT_GE(chosen.size(), std::min<uint64_t>(wanted, pipelines.size()));
        EXPECT_LE(choose_sample(pipelines, 0, 7).size(), modules.size());
    }
}

}  // namespace
}  // namespace kiln
