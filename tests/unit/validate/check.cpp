#include "compiler/validate/check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "compiler/validate/check_wire.h"
#include "tests/unit/validate/fake_device.h"

namespace kiln {
namespace {

ReadBack floats(std::vector<float> values) {
    ReadBack r{"output 0", {BaseType::float32}, {}, 4};
    for (const float v : values) {
        uint32_t w;
        std::memcpy(&w, &v, 4);
        r.words.push_back(w);
    }
    return r;
}

TEST(Compare, ToleranceIsRelativeAboveOne) {
    EXPECT_EQ(compare(floats({0.5f}), floats({0.50009f})).differing, 0u);
    EXPECT_EQ(compare(floats({0.5f}), floats({0.5002f})).differing, 1u);
    EXPECT_EQ(compare(floats({1000.0f}), floats({1000.09f})).differing, 0u);
    EXPECT_EQ(compare(floats({1000.0f}), floats({1000.2f})).differing, 1u);
    EXPECT_EQ(compare(floats({0.0f}), floats({-0.0f})).differing, 0u);
}

TEST(Compare, FinitenessIntegersAndSizes) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    EXPECT_EQ(compare(floats({nan}), floats({1.0f})).finiteness, 1u);
    EXPECT_EQ(compare(floats({nan}), floats({inf})).finiteness, 0u);
    EXPECT_EQ(compare(floats({1, 2, 3}), floats({1, 2})).differing, 1u);
    ReadBack a{"buffer b", {BaseType::uint32, BaseType::float32}, {1, 0x3f800000}, 1}, b = a;
    b.words[0] = 2;
    EXPECT_EQ(compare(a, b).differing, 1u);
    b.words = {1, 0x3f800001};
    EXPECT_EQ(compare(a, b).differing, 0u);
}

CheckJob two_forms() {
    CheckJob job;
    for (const uint32_t word : {10u, 20u}) {
        auto stage = std::make_shared<StageCode>();
        stage->stage = Stage::compute;
        stage->words = {word};
        (word == 10 ? job.optimised : job.unoptimised).push_back(stage);
    }
    return job;
}

Verdict judge(const test::FakeDevice::Answer& optimised, const test::FakeDevice::Answer& unoptimised) {
    test::FakeDevice device([&](const PipelineRequest& r) { return r.stages[0].words[0] == 10 ? optimised(r) : unoptimised(r); });
    const Result<Verdict> v = check_pipeline(device, two_forms());
    EXPECT_TRUE(v.ok());
    return v.ok() ? *v : Verdict();
}

test::FakeDevice::Answer all(uint32_t value) {
    return [=](const PipelineRequest& r) { return test::picture(r, value); };
}

TEST(Check, EqualFormsPass) {
    const Verdict v = judge(all(0x3f000000), all(0x3f000000));
    EXPECT_EQ(v.outcome, Outcome::passed) << v.why;
    EXPECT_TRUE(v.compared);
    EXPECT_EQ(v.values, 32u);
}

TEST(Check, DifferencesFail) { EXPECT_EQ(judge(all(0x3f000000), all(0x3f010000)).outcome, Outcome::failed); }

TEST(Check, ADifferenceInTheSecondSetFails) {
    const Verdict v = judge(all(0x3f000000), [](const PipelineRequest& r) {
        PipelineOutput out = test::picture(r);
        out.runs[1].values[0].words[3] = 0;
        return out;
    });
    EXPECT_EQ(v.outcome, Outcome::failed);
    EXPECT_NE(v.why.find("either sign"), std::string::npos) << v.why;
}

TEST(Check, NotFiniteFailsInTheFirstSetOnly) {
    const auto nan_in = [](size_t run) {
        return [run](const PipelineRequest& r) {
            PipelineOutput out = test::picture(r);
            out.runs[run].values[0].words[5] = 0x7fc00000;
            return out;
        };
    };
    const Verdict first = judge(nan_in(0), nan_in(0));
    EXPECT_EQ(first.outcome, Outcome::failed);
    EXPECT_EQ(first.nonfinite, 1u);
    EXPECT_EQ(judge(nan_in(1), nan_in(1)).outcome, Outcome::passed);
    EXPECT_EQ(judge(all(0x3f000000), nan_in(0)).outcome, Outcome::failed);
}

TEST(Check, MessagesAndMissingFeatures) {
    const auto says = [](const PipelineRequest&) {
        PipelineOutput out;
        out.errors = {"VUID-1", "VUID-2"};
        return out;
    };
    EXPECT_EQ(judge(says, all(0)).why, "VUID-1 (and 1 more)");
    EXPECT_EQ(judge(all(0), says).why, "the unoptimised form: VUID-1 (and 1 more)");
    const auto lacks = [](const PipelineRequest&) {
        PipelineOutput out;
        out.unsupported = "no mesh shaders";
        return out;
    };
    EXPECT_EQ(judge(lacks, all(0)).outcome, Outcome::unsupported);
}

TEST(Check, AnOutputThatTheOptimisedFormLostFails) {
    const Verdict v = judge(all(0x3f000000), [](const PipelineRequest& r) {
        PipelineOutput out = test::picture(r);
        for (RunOutput& run : out.runs) run.values.push_back({"output 1", {BaseType::float32}, {0}, 4});
        return out;
    });
    EXPECT_EQ(v.outcome, Outcome::failed);
}

CheckJob rich_job() {
    CheckJob job = two_forms();
    auto stage = std::make_shared<StageCode>(*job.optimised[0]);
    stage->partner = true;
    Resource r;
    r.name = "block";
    r.members.push_back({});
    r.members[0].name = "m";
    r.members[0].type.array = {2, 3};
    r.members[0].strides = {48, 16};
    stage->reflection.resources.push_back(r);
    stage->reflection.outputs.push_back({});
    job.optimised[0] = stage;
    job.seed = 77;
    return job;
}

TEST(Wire, RoundTripsAndRefusesEveryTruncation) {
    const CheckJob job = rich_job();
    const Bytes bytes = encode(job);
    const std::optional<CheckJob> back = decode_job(bytes);
    ASSERT_TRUE(back.has_value());
    EXPECT_EQ(encode(*back), bytes);
    EXPECT_EQ(back->optimised[0]->reflection, job.optimised[0]->reflection);
    for (size_t n = 0; n < bytes.size(); ++n) {
        const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
        EXPECT_FALSE(decode_job(cut).has_value()) << n;
    }
    Verdict v;
    v.outcome = Outcome::failed;
    v.why = "because";
    v.values = 1ull << 40;
    const Bytes verdict = encode(v);
    EXPECT_EQ(decode_verdict(verdict)->why, "because");
    EXPECT_EQ(decode_verdict(verdict)->values, v.values);
    for (size_t n = 0; n < verdict.size(); ++n) EXPECT_FALSE(decode_verdict(ByteView(verdict).first(n)).has_value()) << n;
}

TEST(Wire, KeysFollowEverythingThatDecides) {
    const DeviceInfo info{"d", "v", "l", "s"};
    const CheckJob job = rich_job();
    const Digest key = verdict_key(info, job);
    EXPECT_EQ(key, verdict_key(info, rich_job()));
    DeviceInfo other = info;
    other.settings = "t";
    EXPECT_NE(key, verdict_key(other, job));
    CheckJob seeded = job;
    seeded.seed = 78;
    EXPECT_NE(key, verdict_key(info, seeded));
    CheckJob uncompared = job;
    uncompared.unoptimised.clear();
    EXPECT_NE(key, verdict_key(info, uncompared));
    CheckJob moved = job;
    auto stage = std::make_shared<StageCode>(*job.optimised[0]);
    stage->reflection.resources[0].binding = 9;
    moved.optimised[0] = stage;
    EXPECT_NE(key, verdict_key(info, moved));
}

}  // namespace
}  // namespace kiln
