// Verdicts and their words.
#include "compiler/report/expectation.h"

#include <gtest/gtest.h>

namespace kiln::report {
namespace {

std::optional<Known> measured(const std::string& member, const std::string&, Metric metric) {
    if (member == "missing") return std::nullopt;
    if (metric == Metric::time) return Known{member == "a" ? 1.0 : member == "b" ? 1.03 : 2.0};
    if (metric == Metric::rmse) return member == "a" ? Known{1.0, 0.1} : member == "b" ? Known{1.15, 0.1} : Known{1.5, 0.1};
    return Known{member == "a" ? 1e-3 : member == "b" ? 1e-2 : 0.0};
}

Judged of(Expectation e) { return judge(e, measured); }

TEST(Expectation, BelowIsConfirmedOrFalsifiedWithItsNumbers) {
    EXPECT_EQ(of({Metric::relmse, Relation::below, "a", "b"}).words, "relMSE of a below b: confirmed, 0.001 against 0.01");
    EXPECT_EQ(of({Metric::relmse, Relation::below, "b", "a"}).verdict, Verdict::falsified);
    EXPECT_EQ(of({Metric::relmse, Relation::below, "a", "b", 20.0}).verdict, Verdict::falsified);
    EXPECT_EQ(of({Metric::relmse, Relation::below, "a", "b", 5.0, "", "why"}).words,
              "relMSE of a at least 5 times below b (why): confirmed, 0.001 against 0.01");
}
TEST(Expectation, CloseTimesDecideNothing) {
    EXPECT_EQ(of({Metric::time, Relation::below, "a", "b"}).verdict, Verdict::undecided);
    EXPECT_EQ(of({Metric::time, Relation::below, "b", "a"}).verdict, Verdict::undecided);
    EXPECT_EQ(of({Metric::time, Relation::below, "a", "c"}).verdict, Verdict::confirmed);
    EXPECT_EQ(of({Metric::time, Relation::below, "c", "a"}).verdict, Verdict::falsified);
    EXPECT_EQ(of({Metric::time, Relation::near, "a", "b"}).verdict, Verdict::confirmed);
}
TEST(Expectation, WhatNoiseCouldTurnRoundIsUndecided) {
    EXPECT_EQ(of({Metric::rmse, Relation::below, "a", "b"}).words,
              "RMSE of a below b: undecided, 1 against 1.15, closer than the noise of 0.1");
    EXPECT_EQ(of({Metric::rmse, Relation::below, "b", "a"}).verdict, Verdict::undecided);
    EXPECT_EQ(of({Metric::rmse, Relation::below, "a", "c"}).verdict, Verdict::confirmed);
    EXPECT_EQ(of({Metric::rmse, Relation::below, "c", "a"}).verdict, Verdict::falsified);
    EXPECT_EQ(of({Metric::rmse, Relation::below, "a", "c", 1.4}).verdict, Verdict::undecided);
    EXPECT_EQ(of({Metric::rmse, Relation::at_most, "a", "", 1.05}).verdict, Verdict::undecided);
    EXPECT_EQ(of({Metric::rmse, Relation::at_most, "a", "", 1.2}).verdict, Verdict::confirmed);
    EXPECT_EQ(of({Metric::rmse, Relation::at_least, "a", "", 1.2}).verdict, Verdict::falsified);
    EXPECT_EQ(of({Metric::rmse, Relation::near, "a", "b", 1.2}).verdict, Verdict::undecided);
    EXPECT_EQ(of({Metric::rmse, Relation::near, "a", "b", 1.6}).verdict, Verdict::confirmed);
    EXPECT_EQ(of({Metric::rmse, Relation::near, "a", "c", 1.1}).verdict, Verdict::falsified);
}
TEST(Expectation, Bounds) {
    EXPECT_EQ(of({Metric::relmse, Relation::at_most, "a", "", 1e-3}).verdict, Verdict::confirmed);
    EXPECT_EQ(of({Metric::relmse, Relation::at_most, "b", "", 1e-3}).verdict, Verdict::falsified);
    EXPECT_EQ(of({Metric::relmse, Relation::at_least, "b", "", 1e-3, "noon"}).words,
              "relMSE of b at least 0.001 in noon: confirmed, 0.01");
    EXPECT_EQ(of({Metric::relmse, Relation::near, "c", "c"}).verdict, Verdict::confirmed);
}
TEST(Expectation, WhatWasNotMeasuredIsUndecided) {
    EXPECT_EQ(of({Metric::relmse, Relation::below, "a", "missing"}).words, "relMSE of a below missing: undecided, not measured");
}
TEST(Expectation, AChainIsOneAPair) {
    const std::vector<Expectation> chain = ascending(Metric::rmse, {"x", "y", "z"}, "here");
    ASSERT_EQ(chain.size(), 2u);
    EXPECT_EQ(chain[1].a + chain[1].b + chain[1].scene, "yzhere");
}
TEST(Expectation, MetricsHaveTheirNames) {
    for (const Metric m : all_metrics()) EXPECT_EQ(metric_named(name_of(m)), m);
    EXPECT_FALSE(metric_named("relMSE").has_value());
}
TEST(Expectation, Digits) {
    EXPECT_EQ(digits(0.0), "0");
    EXPECT_EQ(digits(1234.4), "1234");
    EXPECT_EQ(digits(0.012345), "0.0123");
    EXPECT_EQ(digits(1.23456e-7), "1.23e-07");
}

}  // namespace
}  // namespace kiln::report
