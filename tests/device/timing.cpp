// Timed runs. No test asserts how long anything takes: only that there are as many samples as asked for, that time runs
// forwards and within the time that the call took, and that what was timed did its work.

#include <chrono>
#include <cstdlib>
#include <numeric>

#include "compiler/device/vulkan_device.h"
#include "compiler/validate/partner.h"
#include "tests/device/fetch.h"
#include "tests/unit/validate/fake_device.h"

namespace kiln::test {
namespace {

TimedOutput time_clean(const PipelineRequest& request, const TimeOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    Result<TimedOutput> out = device().time(request, options);
    const auto end = std::chrono::steady_clock::now();
    EXPECT_TRUE(out.ok()) << (out.ok() ? "" : out.error().message);
    if (!out.ok()) return {};
    EXPECT_TRUE(out->errors.empty()) << out->errors.front();
    EXPECT_EQ(out->unsupported, "");
    EXPECT_EQ(out->samples_ns.size(), options.repeats);
    for (const uint64_t ns : out->samples_ns) EXPECT_GT(ns, 0u);
    const double sum = std::accumulate(out->samples_ns.begin(), out->samples_ns.end(), 0.0);
    const std::chrono::duration<double, std::nano> call = end - start;
    EXPECT_LE(sum, call.count()) << "samples lie one after the other";
    EXPECT_GT(out->create_ms, 0.0);
    EXPECT_GT(out->first_ms, 0.0);
    return std::move(*out);
}

PipelineRequest counting() {
    const Result<StageCode> stage = compute_stage(R"(#version 450
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) buffer Out { uint submissions; float v[]; };
void main() {
    uint i = gl_GlobalInvocationID.x;
    float x = float(i);
    for (int n = 0; n < 200; ++n) x = fract(x * 1.37 + 0.1);
    v[i] = x;
    if (i == 0u) submissions += 1u;
}
)");
    EXPECT_TRUE(stage.ok());
    ComputeData data;
    data.buffers = {{"Out", Bytes(4 + 4 * 4096)}};
    data.groups[0] = group_count(*stage, 4096);
    return *compute_request(*stage, {data});
}

// Enlarged twice before it is measured: one pipeline does the work of all three sizes.
TEST(Timing, EnlargesBeforeItMeasures) {
    const Result<StageCode> stage = compute_stage(R"(#version 450
layout(local_size_x = 1) in;
layout(push_constant) uniform P { uint more; };
layout(set = 0, binding = 0) buffer Out { uint groups; uint sum; };
void main() {
    groups = gl_NumWorkGroups.x;
    if (gl_GlobalInvocationID.x == 0u) sum += more;
}
)");
    ASSERT_TRUE(stage.ok());
    ComputeData data;
    data.buffers = {{"Out", Bytes(8)}};
    data.push_constants = Bytes{1, 0, 0, 0};
    data.groups = {1, 1, 1};
    TimeOptions options{2, 3, {}};
    int asked = 0;
    options.enlarge = [&](uint64_t least_ns, Bytes& push_constants, std::array<uint32_t, 3>& groups) {
        EXPECT_GT(least_ns, 0u);
        if (++asked > 2) return false;
        push_constants[0] = static_cast<uint8_t>(asked == 1 ? 10 : 100);
        groups[0] = asked == 1 ? 2 : 5;
        return true;
    };
    const TimedOutput out = time_clean(*compute_request(*stage, {data}), options);
    EXPECT_EQ(asked, 3);
    // Two warm-ups and a trial of two; a trial of two; a trial of two and three samples.
    EXPECT_EQ(values_of<uint32_t>(result_of(out.last).buffer("Out")), (std::vector<uint32_t>{5, 4 * 1 + 2 * 10 + 5 * 100}));
}

TEST(Timing, Compute) {
    const PipelineRequest request = counting();
    const TimedOutput out = time_clean(request, {2, 7, {}});
    const Result<PipelineOutput> once = device().run(request);
    ASSERT_TRUE(once.ok());
    const auto timed = values_of<uint32_t>(result_of(out.last).buffer("Out"));
    auto plain = values_of<uint32_t>(result_of(once->runs.at(0)).buffer("Out"));
    ASSERT_EQ(timed.size(), 4097u);
    EXPECT_EQ(timed[0], 9u) << "buffers carry on from submission to submission";
    EXPECT_EQ(plain[0], 1u);
    plain[0] = timed[0];
    EXPECT_EQ(timed, plain);
    EXPECT_EQ(out.last.covered, 64u);
}

TEST(Timing, AtLeastOneWarmUpAndNoRepeatsAtAll) {
    const TimedOutput out = time_clean(counting(), {0, 0});
    EXPECT_EQ(values_of<uint32_t>(result_of(out.last).buffer("Out")).at(0), 1u);
}

TEST(Timing, DrawsLeaveWhatARunLeaves) {
    PipelineRequest request = request_of({plain_vertex(), fragment(R"(
layout(binding = 0) uniform sampler2D t;
layout(location = 0) out vec4 c;
layout(location = 2) out uvec2 n;
void main() { c = texture(t, gl_FragCoord.xy / 40.0); n = uvec2(gl_FragCoord.xy); }
)")});
    request.size = 96;
    request.height = 40;
    for (const bool depth_test : {false, true}) {
        request.depth_test = depth_test;
        const TimedOutput out = time_clean(request, {1, 5});
        const Result<PipelineOutput> once = device().run(request);
        ASSERT_TRUE(once.ok());
        ASSERT_EQ(once->runs.size(), 2u);
        EXPECT_GT(out.last.covered, 1000u);
        EXPECT_EQ(out.last.covered, once->runs[0].covered);
        ASSERT_EQ(out.last.values.size(), 3u);
        for (size_t v = 0; v < 3; ++v) {
            EXPECT_EQ(out.last.values[v].what, once->runs[0].values[v].what);
            EXPECT_EQ(out.last.values[v].words, once->runs[0].values[v].words);
        }
    }
}

TEST(Timing, SizesNeedNotBeSquare) {
    const StageCode shade = fragment("layout(location = 0) out uvec2 at;\nvoid main() { at = uvec2(gl_FragCoord.xy); }\n");
    StageCode made = compile(Stage::vertex, vertex_partner(shade.reflection.inputs));
    made.partner = true;
    PipelineRequest request = request_of({made, shade});
    request.size = 20;
    request.height = 7;
    const Result<PipelineOutput> out = device().run(request);
    ASSERT_TRUE(out.ok());
    ASSERT_EQ(out->runs.size(), 2u);
    EXPECT_EQ(out->runs[0].covered, 140u);
    const ReadBack& at = out->runs[0].values.at(0);
    ASSERT_EQ(at.words.size(), 140u * 4);
    EXPECT_EQ(at.words[(6 * 20 + 19) * 4], 19u);
    EXPECT_EQ(at.words[(6 * 20 + 19) * 4 + 1], 6u);
}

TEST(Timing, ErrorsAreToldAndADeviceWithoutAClockSaysSo) {
    PipelineRequest broken = counting();
    broken.stages[0].words.back() ^= 0x55u;
    const Result<TimedOutput> out = device().time(broken, {});
    ASSERT_TRUE(out.ok());
    EXPECT_FALSE(out->errors.empty());
    EXPECT_TRUE(out->samples_ns.empty());

    FakeDevice fake([](const PipelineRequest& r) { return picture(r); });
    const Result<TimedOutput> none = fake.time(counting(), {});
    ASSERT_FALSE(none.ok());
    EXPECT_NE(none.error().message.find("keeps no time"), std::string::npos);
}

// Runs the statement in a process of its own, since a process keeps LLVM's settings of the first device it opened.
#define EXPECT_IN_NEW_PROCESS(statement)                                             \
    do {                                                                             \
        GTEST_FLAG_SET(death_test_style, "threadsafe");                              \
        EXPECT_EXIT(std::exit((statement) ? 0 : 1), testing::ExitedWithCode(0), ""); \
    } while (false)

bool times_with_optimised_code() {
    unsetenv("GALLIVM_PERF");
    DriverChoice choice;
    choice.optimise = true;
    choice.shader_cache = false;
    choice.layer = false;
    const auto opened = open_vulkan_device(choice);
    if (!opened.ok()) return false;
    const DeviceInfo& info = (*opened)->info();
    if (info.layers != "none" || info.settings.find("nopt") != std::string::npos ||
        info.settings.find("no_aos_sampling") == std::string::npos ||
        info.settings.find("MESA_SHADER_CACHE_DISABLE=1") == std::string::npos)
        return false;
    const auto out = (*opened)->time(counting(), {1, 3});
    return out.ok() && out->errors.empty() && out->samples_ns.size() == 3;
}

bool refuses_unoptimised_code() {
    setenv("GALLIVM_PERF", "nopt", 1);
    DriverChoice choice;
    choice.optimise = true;
    const auto opened = open_vulkan_device(choice);
    return !opened.ok() && opened.error().message.find("GALLIVM_PERF") != std::string::npos;
}

TEST(TimingDriver, ADeviceForMeasuring) { EXPECT_IN_NEW_PROCESS(times_with_optimised_code()); }

TEST(TimingDriver, UnoptimisedCodeIsNotMeasured) { EXPECT_IN_NEW_PROCESS(refuses_unoptimised_code()); }

TEST(TimingDriver, TheLayerIsOnUnlessToldOtherwise) {
    EXPECT_NE(device().info().layers.find("VK_LAYER_KHRONOS_validation"), std::string::npos);
    EXPECT_NE(device().info().settings.find("nopt"), std::string::npos);
}

}  // namespace
}  // namespace kiln::test
