// What follows from measurements: times, pooling, budgets, CSV, the page. The bench is a fake with known values and times.
#include "compiler/report/report.h"

#include <gtest/gtest.h>

namespace kiln::report {
namespace {

TEST(Times, LeastMedianAndNinetiethPercentileOverTheBaseline) {
    Timed t;
    t.jit_ms = 50.0;
    for (int i = 10; i > 0; --i) t.ms.push_back(static_cast<double>(i));  // 10 … 1
    const Timing out = times_of(t, 0.5, 1e6);
    EXPECT_DOUBLE_EQ(out.min, 1.0 - 0.5);
    EXPECT_DOUBLE_EQ(out.median, 6.0 - 0.5);
    EXPECT_DOUBLE_EQ(out.p90, 10.0 - 0.5);
    EXPECT_DOUBLE_EQ(out.jit_ms, 50.0);
    EXPECT_EQ(out.repeats, 10u);
}

FamilyReport measured(const std::vector<std::pair<double, double>>& time_and_relmse) {
    FamilyReport f;
    f.family.number = 99;
    f.family.name = "made_up";
    f.family.title = "Made up";
    for (size_t i = 0; i < time_and_relmse.size(); ++i) {
        Member member;
        member.name = "m" + std::to_string(i);
        f.family.members.push_back(member);
        Measured m;
        m.timing.min = time_and_relmse[i].first;
        m.all.relmse = time_and_relmse[i].second;
        f.together.push_back(m);
    }
    return f;
}

TEST(BudgetOption, IsAMetricAndANumber) {
    const auto b = parse_budget("relmse=1e-3");
    ASSERT_TRUE(b.ok());
    EXPECT_EQ(b->metric, Metric::relmse);
    EXPECT_DOUBLE_EQ(b->limit, 1e-3);
    for (const char* bad : {"", "relmse", "relmse=", "relmse=x", "relmse=1x", "relmse=-1", "relmse=inf", "relMSE=1", "=1"}) {
        const auto refused = parse_budget(bad);
        ASSERT_FALSE(refused.ok()) << bad;
        EXPECT_EQ(refused.error().fault, Fault::usage) << bad;
    }
}

TEST(BudgetAnswer, IsTheCheapestThatKeepsIt) {
    FamilyReport f = measured({{1.0, 1e-1}, {3.0, 1e-4}, {2.0, 1e-3}, {0.5, 0.0}});
    f.together[3].all.nonfinite = 1;
    EXPECT_EQ(cheapest(f, {{Metric::relmse, 1e-3}}), 2u);
    EXPECT_EQ(cheapest(f, {{Metric::relmse, 1e-4}}), 1u);
    EXPECT_EQ(cheapest(f, {{Metric::relmse, 1e-3}, {Metric::time, 1.5}}), std::nullopt);
    Report report;
    report.families = {f};
    EXPECT_NE(budget_text(report, {{Metric::relmse, 1e-3}}).find("99 made_up: m2, 2 ns/pixel"), std::string::npos);
    EXPECT_NE(budget_text(report, {{Metric::relmse, 1e-9}}).find("99 made_up: none"), std::string::npos);
}

// Gives every point u.x = pixel / count, and a picture with the kernel's number of operations in it; every dispatch takes as
// long as it has operations.
class FakeBench final : public Bench {
public:
    const DeviceInfo& info() const override { return info_; }
    Result<std::vector<float>> run(const Kernel& kernel, const std::vector<Resource>&, const Draw& draw) override {
        std::vector<float> out(draw.results);
        const bool points = draw.points == nullptr;
        for (size_t i = 0; i < out.size(); ++i)
            out[i] = points ? static_cast<float>(i) / static_cast<float>(out.size()) : static_cast<float>(kernel.operations);
        return out;
    }
    Result<Timed> time(const Kernel& kernel, const std::vector<Resource>&, Draw& draw, unsigned repeats,
                       double least_ms) override {
        draw.loops = 1000;
        EXPECT_GE(least_ms, 2.0);
        EXPECT_GE(repeats, 30u);
        Timed out;
        out.ms.assign(repeats, static_cast<double>(kernel.operations));
        out.jit_ms = 100.0;
        return out;
    }
    Result<std::vector<float>> bake(const std::string&, const std::vector<Resource>&, const Draw&) override {
        return environment_error("nothing to bake");
    }

private:
    DeviceInfo info_{"fake <device>", "none", "", ""};
};

Report fake_report(const std::vector<std::string>& families) {
    DiskFiles files;
    Library library(files, std::string(KILN_SOURCE_DIR) + "/uber/lib");
    const std::unique_ptr<Toolchain> tools = make_toolchain();
    FakeBench bench;
    ReportOptions options;
    options.families = families;
    options.quick = true;
    auto report = run_report(options, library, *tools, bench, {});
    EXPECT_TRUE(report.ok()) << report.error().message;
    return report.ok() ? std::move(*report) : Report();
}

TEST(Report, MeasuresEveryMemberInEveryScene) {
    const Report report = fake_report({"fresnel"});
    ASSERT_EQ(report.families.size(), 1u);
    const FamilyReport& f = report.families[0];
    ASSERT_EQ(f.scenes.size(), f.family.scenes.size());
    for (size_t s = 0; s < f.scenes.size(); ++s) {
        ASSERT_EQ(f.scenes[s].size(), f.family.members.size());
        for (const Measured& m : f.scenes[s]) {
            EXPECT_GT(m.operations, 0u);
            EXPECT_GT(m.timing.min, 0.0);
            EXPECT_GT(m.all.rmse, 0.0);
            EXPECT_FALSE(m.picture.empty());
            EXPECT_EQ(m.timing.scene, f.family.scenes[0].name);
        }
    }
    EXPECT_EQ(f.judged.size(), f.family.expectations.size());
    // Pooled over scenes: the mean of relMSE, the largest maxAbs.
    double relmse = 0.0, max_abs = 0.0;
    for (const auto& scene : f.scenes) {
        relmse += scene[0].all.relmse / static_cast<double>(f.scenes.size());
        max_abs = std::max(max_abs, scene[0].all.max_abs);
    }
    EXPECT_DOUBLE_EQ(f.together[0].all.relmse, relmse);
    EXPECT_EQ(f.together[0].all.max_abs, max_abs);
}

TEST(Report, FamiliesGoByNumberOrNameAndAMisspeltOneIsRefused) {
    ReportOptions options;
    options.families = {"4", "visibility"};
    const auto two = chosen_families(options);
    ASSERT_TRUE(two.ok());
    EXPECT_EQ(two->size(), 2u);
    options.families = {"frensel"};
    const auto none = chosen_families(options);
    ASSERT_FALSE(none.ok());
    EXPECT_EQ(none.error().fault, Fault::usage);
    EXPECT_NE(none.error().message.find("4 fresnel"), std::string::npos);
}

TEST(Report, CsvHasARowAMemberAndScene) {
    const Report report = fake_report({"4"});
    const std::string csv = as_csv(report);
    const FamilyReport& f = report.families[0];
    EXPECT_EQ(static_cast<size_t>(std::count(csv.begin(), csv.end(), '\n')), 1 + f.family.members.size() * (f.scenes.size() + 1));
    const size_t columns = static_cast<size_t>(std::count(csv.begin(), csv.begin() + static_cast<long>(csv.find('\n')), ','));
    for (size_t at = 0; at < csv.size();) {
        const size_t end = csv.find('\n', at);
        EXPECT_EQ(static_cast<size_t>(std::count(csv.begin() + static_cast<long>(at), csv.begin() + static_cast<long>(end), ',')),
                  columns);
        at = end + 1;
    }
}

TEST(Report, ThePageStandsAlone) {
    const std::string page = as_html(fake_report({"4"}), {{Metric::relmse, 1e-3}});
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_EQ(page.find("src=\"/"), std::string::npos);
    EXPECT_NE(page.find("data:image/png;base64,iVBORw0KGgo"), std::string::npos);
    EXPECT_NE(page.find("fake &lt;device&gt;"), std::string::npos);
    EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
    EXPECT_NE(page.find("cheapest within relmse &lt;= 0.001"), std::string::npos);
    for (const char* tag : {"section", "table", "svg", "figure", "div"}) {
        size_t open = 0, closed = 0;
        for (size_t at = 0; (at = page.find(std::string("<") + tag, at)) != std::string::npos; ++at) ++open;
        for (size_t at = 0; (at = page.find(std::string("</") + tag + ">", at)) != std::string::npos; ++at) ++closed;
        EXPECT_EQ(open, closed) << tag;
    }
}

}  // namespace
}  // namespace kiln::report
