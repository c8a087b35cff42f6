#include "compiler/validate/workers.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "compiler/base/jobs.h"

namespace kiln {
namespace {

WorkerOptions options(unsigned count, double timeout = 60) {
    WorkerOptions o;
    o.command = {"/proc/self/exe", "worker"};
    o.count = count;
    o.timeout_seconds = timeout;
    return o;
}

CheckJob job(uint32_t word) {
    auto stage = std::make_shared<StageCode>();
    stage->stage = Stage::compute;
    stage->words = {word};
    CheckJob j;
    j.optimised = {stage};
    return j;
}

std::vector<Verdict> run(const std::vector<uint32_t>& words, const WorkerOptions& o, std::vector<bool>* cacheable = nullptr) {
    Result<std::unique_ptr<WorkerPool>> pool = WorkerPool::start(o);
    EXPECT_TRUE(pool.ok()) << (pool.ok() ? "" : pool.error().message);
    std::vector<Verdict> out(words.size());
    if (!pool.ok()) return out;
    EXPECT_EQ((*pool)->info().name, "fake");
    std::vector<int> calls(words.size(), 0);
    const Status ran = (*pool)->run(
        words.size(), [&](size_t i) { return job(words[i]); },
        [&](size_t i, const Verdict& v, bool keep) {
            out[i] = v;
            ++calls[i];
            if (cacheable != nullptr) (*cacheable)[i] = keep;
        });
    EXPECT_TRUE(ran.ok()) << (ran.ok() ? "" : ran.error().message);
    EXPECT_EQ(calls, std::vector<int>(words.size(), 1));
    return out;
}

TEST(Workers, RunEverythingOnce) {
    for (const unsigned count : {1u, 2u, 5u})
        for (const Verdict& v : run(std::vector<uint32_t>(20, 0), options(count))) EXPECT_EQ(v.outcome, Outcome::passed) << v.why;
}

TEST(Workers, CrashesAreNamedAndNotKept) {
    std::vector<bool> cacheable(5, false);
    const std::vector<Verdict> v = run({0, 1, 0, 1, 0}, options(2), &cacheable);
    for (size_t i = 0; i < v.size(); ++i) {
        EXPECT_EQ(v[i].outcome, i % 2 == 0 ? Outcome::passed : Outcome::failed);
        EXPECT_EQ(cacheable[i], i % 2 == 0);
    }
    EXPECT_NE(v[1].why.find("signal 6"), std::string::npos) << v[1].why;
}

TEST(Workers, HangsAreKilled) {
    const std::vector<Verdict> v = run({0, 2, 0, 0}, options(2, 3));
    EXPECT_NE(v[1].why.find("hung"), std::string::npos) << v[1].why;
    EXPECT_EQ(v[3].outcome, Outcome::passed);
}

TEST(Workers, ASecondTryInAFreshProcessClearsTheInnocent) {
    for (const Verdict& v : run({0, 3, 0, 3, 3, 0}, options(1))) EXPECT_EQ(v.outcome, Outcome::passed) << v.why;
}

TEST(Workers, AreReplacedAfterSoManyRuns) {
    WorkerOptions o = options(1);
    o.recycle_after = 1;
    for (const Verdict& v : run({3, 3, 3}, o)) EXPECT_EQ(v.outcome, Outcome::passed) << v.why;
}

TEST(Workers, ADriverThatDoesNotOpenIsTheEnvironment) {
    setenv("KILN_TEST_NO_DRIVER", "1", 1);
    const Result<std::unique_ptr<WorkerPool>> pool = WorkerPool::start(options(2));
    unsetenv("KILN_TEST_NO_DRIVER");
    ASSERT_FALSE(pool.ok());
    EXPECT_EQ(pool.error().message, "no driver today");
    EXPECT_EQ(pool.error().fault, Fault::environment);
}

TEST(Workers, AnInterruptStopsThem) {
    Result<std::unique_ptr<WorkerPool>> pool = WorkerPool::start(options(2));
    ASSERT_TRUE(pool.ok());
    const Status ran = (*pool)->run(
        50, [](size_t i) { return job(i == 7 ? 2 : 0); }, [](size_t i, const Verdict&, bool) { interrupted = i >= 5; });
    interrupted = false;
    EXPECT_FALSE(ran.ok());
}

}  // namespace
}  // namespace kiln
