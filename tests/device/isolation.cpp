// Real workers with the real driver: what crashes or hangs takes only itself along.

#include "compiler/validate/workers.h"
#include "tests/device/glsl.h"

namespace kiln::test {
namespace {

WorkerOptions workers(unsigned count, double timeout) {
    WorkerOptions o;
    o.command = {KILN_DEVICE_WORKER};
    o.count = count;
    o.timeout_seconds = timeout;
    return o;
}

StageCode good(int number) {
    return fragment("layout(location = 0) out vec4 c;\nvoid main() { c = vec4(" + std::to_string(number) + ".0); }\n");
}

// A local array far larger than a stack: the driver's own code faults.
StageCode crash() {
    return fragment(R"(
layout(set = 0, binding = 0) uniform B { int i; } b;
layout(location = 0) out vec4 c;
void main() {
    float list[262144];
    list[int(gl_FragCoord.y) * b.i] = 1.0;
    c = vec4(list[int(gl_FragCoord.x) + b.i], list[b.i * 7], 0.0, 1.0);
}
)");
}

// llvmpipe ends every loop after 65,535 rounds, so each round must be long: some hours a draw in all.
StageCode hang() {
    std::string round;
    for (int i = 0; i < 48; ++i) round += "x = sin(x * 1.7 + float(b.n++)) + pow(abs(x), 1.3);\n";
    return fragment(R"(
layout(set = 0, binding = 0) buffer B { uint go; uint n; float x; } b;
layout(location = 0) out vec4 c;
void main() {
    float x = gl_FragCoord.x;
    while (b.go != 77u) {
)" + round + R"(
    }
    c = vec4(x);
}
)");
}

// Runs `bad` among good ones; everything but it must pass.
Verdict run_among_good(const StageCode& bad, double timeout) {
    Result<std::unique_ptr<WorkerPool>> pool = WorkerPool::start(workers(2, timeout));
    EXPECT_TRUE(pool.ok()) << (pool.ok() ? "" : pool.error().message);
    if (!pool.ok()) return {};
    EXPECT_NE((*pool)->info().name.find("llvmpipe"), std::string::npos);
    std::vector<CheckJob> jobs;
    for (int i = 0; i < 8; ++i) jobs.push_back(job_of({plain_vertex(), i == 3 ? bad : good(i)}));
    std::vector<Verdict> verdicts(jobs.size());
    std::vector<int> calls(jobs.size(), 0);
    const Status ran = (*pool)->run(
        jobs.size(), [&](size_t i) { return jobs[i]; },
        [&](size_t i, const Verdict& v, bool cacheable) {
            verdicts[i] = v;
            ++calls[i];
            EXPECT_EQ(cacheable, i != 3) << v.why;
        });
    EXPECT_TRUE(ran.ok()) << (ran.ok() ? "" : ran.error().message);
    for (size_t i = 0; i < jobs.size(); ++i) {
        EXPECT_EQ(calls[i], 1) << i;
        EXPECT_EQ(verdicts[i].outcome, i == 3 ? Outcome::failed : Outcome::passed) << i << ": " << verdicts[i].why;
    }
    return verdicts[3];
}

TEST(Isolation, ACrashNamesItselfAndTheRestGoesOn) {
    const Verdict v = run_among_good(crash(), 120);
    EXPECT_NE(v.why.find("crashed"), std::string::npos) << v.why;
    EXPECT_NE(v.why.find("signal 11"), std::string::npos) << v.why;
}

TEST(Isolation, AHangNamesItselfAndTheRestGoesOn) {
    const Verdict v = run_among_good(hang(), 12);
    EXPECT_NE(v.why.find("hung"), std::string::npos) << v.why;
}

TEST(Isolation, AMissingProgramIsAnEnvironmentError) {
    WorkerOptions o = workers(1, 5);
    o.command = {"/nonexistent/worker"};
    const Result<std::unique_ptr<WorkerPool>> pool = WorkerPool::start(o);
    ASSERT_FALSE(pool.ok());
    EXPECT_EQ(pool.error().fault, Fault::environment);
}

}  // namespace
}  // namespace kiln::test
