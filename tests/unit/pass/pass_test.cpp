// The whole pass over files in memory and a toolchain without tools: what is counted, remembered and reported.
#include "compiler/pass.h"

#include <gtest/gtest.h>

#include "tests/unit/compile/fake_toolchain.h"

namespace kiln {
namespace {

const char* const manifest_text = R"(kiln: 1
name: small
include: [lib]
targets: [spirv, glsl450]
axes:
  tint: {macro: TINT, values: [none, red, blue]}
  bright: {macro: BRIGHT, values: bool}
  idle: {macro: IDLE, values: bool}
rules:
  - forbid: tint == none && bright
shaders:
  - name: paint
    stages: {vertex: paint.vert, fragment: paint.frag}
)";

class PassTest : public ::testing::Test {
protected:
    PassTest() {
        files.files = {{"p/m.yaml", manifest_text},
                       {"p/paint.vert", "v\n"},
                       {"p/paint.frag", "#include \"tint.glsl\"\n#if BRIGHT\nbright\n#endif\ndead\nend\n"},
                       {"p/lib/tint.glsl", "#if TINT == 1\nred\n#elif TINT == 2\nblue\n#endif\n"}};
        options.manifest = "p/m.yaml";
    }
    Build run() {
        const Jobs jobs(1);
        PassContext context{files, store, tools, jobs, {}};
        return run_pass(options, context);
    }
    MemoryFiles files;
    MemoryStore store;
    FakeToolchain tools;
    BuildOptions options;
};

TEST_F(PassTest, CountsEveryLevel) {
    const Build build = run();
    ASSERT_TRUE(build.ok()) << (build.diags.empty() ? "" : render(build.diags.list()[0], false));
    EXPECT_EQ(build.counts.declared.decimal(), "12");
    EXPECT_EQ(build.counts.legal.decimal(), "10");
    EXPECT_EQ(build.counts.needed.decimal(), "10");
    EXPECT_EQ(build.counts.classes, 6u);  // 1 vertex, 5 fragment
    EXPECT_EQ(build.counts.modules, 6u);
    EXPECT_EQ(build.counts.pipelines, 5u);
    EXPECT_EQ(build.counts.artifacts.at(Target::glsl450), 6u);
    EXPECT_EQ(build.work.compiled, 6u);
    EXPECT_FALSE(build.files.table.empty());
    EXPECT_EQ(build.depends, (std::vector<std::string>{"p/lib/tint.glsl", "p/m.yaml", "p/paint.frag", "p/paint.vert"}));
}

TEST_F(PassTest, WarnsOfAnAxisThatNoStageReads) {
    const Build build = run();
    ASSERT_EQ(build.diags.list().size(), 1u);
    EXPECT_EQ(build.diags.list()[0].severity, Severity::warning);
    EXPECT_NE(build.diags.list()[0].message.find("IDLE"), std::string::npos);
    EXPECT_EQ(build.diags.list()[0].place.line, 8u);
}

TEST_F(PassTest, ASecondBuildDoesNoWorkAndShowsTheSameWarnings) {
    const Build first = run();
    const Build second = run();
    EXPECT_EQ(second.work.compiled + second.work.preprocessed + second.work.optimised + second.work.translated, 0u);
    EXPECT_EQ(second.work.cache_hits, 1u);
    EXPECT_EQ(second.files.table, first.files.table);
    EXPECT_EQ(second.files.proof, first.files.proof);
    EXPECT_EQ(second.counts.classes, first.counts.classes);
    EXPECT_EQ(second.diags.list(), first.diags.list());
    EXPECT_EQ(second.depends, first.depends);
}

TEST_F(PassTest, ACommentCostsOnePreprocessingAndNoCompile) {
    const Build first = run();
    files.files["p/lib/tint.glsl"] = "// new\n" + files.files["p/lib/tint.glsl"];
    const Build second = run();
    EXPECT_EQ(second.work.compiled, 0u);
    EXPECT_EQ(second.work.preprocessed, 2u);  // paint.frag and tint.glsl; the vertex stage is remembered
    EXPECT_EQ(second.files.table, first.files.table);
}

TEST_F(PassTest, AnEditCompilesTheClassesItReaches) {
    run();
    files.files["p/lib/tint.glsl"] = "#if TINT == 1\nred2\n#elif TINT == 2\nblue\n#endif\n";
    EXPECT_EQ(run().work.compiled, 2u);
}

TEST_F(PassTest, AFileThatAppearsEarlierOnTheSearchPathIsSeen) {
    const Build first = run();
    files.files["p/tint.glsl"] = "other\n";
    const Build second = run();
    EXPECT_EQ(second.counts.classes, 3u);
    EXPECT_NE(second.files.table, first.files.table);
    files.files.erase("p/tint.glsl");
    EXPECT_EQ(run().files.table, first.files.table);
}

TEST_F(PassTest, AnotherToolVersionSharesNothing) {
    run();
    tools.version = "fake 2";
    EXPECT_EQ(run().work.compiled, 6u);
}

TEST_F(PassTest, AMissingIncludeIsReportedWithItsPlaceAndNothingIsRemembered) {
    files.files.erase("p/lib/tint.glsl");
    for (int i = 0; i < 2; ++i) {
        const Build build = run();
        ASSERT_TRUE(build.diags.has_errors());
        bool found = false;
        for (const Diag& d : build.diags.list()) found = found || (d.place.file == "p/paint.frag" && d.place.line == 1);
        EXPECT_TRUE(found);
        EXPECT_TRUE(build.files.table.empty());
    }
}

TEST_F(PassTest, AnInterruptEndsThePassWithoutATable) {
    interrupted = true;
    const Build build = run();
    interrupted = false;
    EXPECT_FALSE(build.ok());
    EXPECT_TRUE(build.files.table.empty());
}

// A store that fails every call.
class BrokenStore final : public Store {
public:
    Result<std::optional<Bytes>> get(Keyspace, const Digest&) override { return environment_error("broken"); }
    Status put(Keyspace, const Digest&, ByteView) override { return environment_error("broken"); }
};

TEST_F(PassTest, ABrokenStoreCostsAWarningAndNothingElse) {
    const Build good = run();
    BrokenStore broken;
    const Jobs jobs(1);
    PassContext context{files, broken, tools, jobs, {}};
    const Build build = run_pass(options, context);
    ASSERT_TRUE(build.ok());
    EXPECT_EQ(build.files.table, good.files.table);
    EXPECT_GT(build.work.store_failures, 0u);
}

TEST_F(PassTest, ThreadsDoNotShow) {
    const Build one = run();
    MemoryStore fresh;
    const Jobs jobs(4);
    PassContext context{files, fresh, tools, jobs, {}};
    EXPECT_EQ(run_pass(options, context).files.table, one.files.table);
}

}  // namespace
}  // namespace kiln
