// Real workers with the real driver: what crashes or hangs takes only itself along.

#include "compiler/workers.h"
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

StageCode hang() {
    return fragment(R"(
layout(set = 0, binding = 0) buffer B { uint go; uint n; } b;
layout(location = 0) out vec4 c;
void main() {
    while (b.go != 77u) b.n++;
    c = vec4(1.0);
}
)");
}

TEST(Isolation, CrashAndHangNameThemselvesAndTheRestGoesOn) {
    Result<std::unique_ptr<WorkerPool>> pool = WorkerPool::start(workers(2, 15));
    ASSERT_TRUE(pool.ok()) << pool.error().message;
    EXPECT_NE((*pool)->info().name.find("llvmpipe"), std::string::npos);
    std::vector<CheckJob> jobs;
    for (int i = 0; i < 12; ++i) jobs.push_back(job_of({plain_vertex(), i == 3 ? crash() : i == 7 ? hang() : good(i)}));
    std::vector<Verdict> verdicts(jobs.size());
    std::vector<int> calls(jobs.size(), 0);
    const Status ran = (*pool)->run(
        jobs.size(), [&](size_t i) { return jobs[i]; },
        [&](size_t i, const Verdict& v, bool cacheable) {
            verdicts[i] = v;
            ++calls[i];
            EXPECT_EQ(cacheable, i != 3 && i != 7) << v.why;
        });
    ASSERT_TRUE(ran.ok()) << ran.error().message;
    for (size_t i = 0; i < jobs.size(); ++i) {
        EXPECT_EQ(calls[i], 1) << i;
        EXPECT_EQ(verdicts[i].outcome, i == 3 || i == 7 ? Outcome::failed : Outcome::passed) << i << ": " << verdicts[i].why;
    }
    EXPECT_NE(verdicts[3].why.find("crashed"), std::string::npos) << verdicts[3].why;
    EXPECT_NE(verdicts[7].why.find("hung"), std::string::npos) << verdicts[7].why;
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
