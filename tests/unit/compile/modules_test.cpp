#include "compiler/modules/modules.h"

#include <gtest/gtest.h>

#include "tests/unit/compile/fake_toolchain.h"
#include "tests/unit/compile/world.h"

namespace kiln {
namespace {

void expect_same(const Modules& a, const Modules& b) {
    EXPECT_EQ(a.of_class, b.of_class);
    EXPECT_EQ(a.raw, b.raw);
    EXPECT_EQ(a.pruned, b.pruned);
    EXPECT_EQ(a.diags.list(), b.diags.list());
    ASSERT_EQ(a.list.size(), b.list.size());
    for (size_t i = 0; i < a.list.size(); ++i) {
        EXPECT_EQ(a.list[i].stage, b.list[i].stage);
        EXPECT_EQ(a.list[i].words, b.list[i].words);
        EXPECT_EQ(a.list[i].unoptimised, b.list[i].unoptimised);
        EXPECT_EQ(a.list[i].digest, b.list[i].digest);
        EXPECT_EQ(a.list[i].reflection, b.list[i].reflection);
    }
}

// Classes 0 and 1 merge when pruned, 2 with them when optimised; 3 stays apart.
const std::vector<std::string> four = {"a\ndead x\nin 1\n", "a\nin 1\n", "a\nslow\nin 1\n", "b\n"};

TEST(Modules, MergesAtEveryStep) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    MemoryStore store;
    const Modules m = build_modules(world.stages, store, tools, Jobs(1), {});
    EXPECT_TRUE(m.diags.empty());
    EXPECT_EQ(4u, m.raw);
    EXPECT_EQ(3u, m.pruned);
    ASSERT_EQ(2u, m.list.size());
    EXPECT_EQ((std::vector<std::vector<uint32_t>>{{0, 0, 0, 1}}), m.of_class);
    EXPECT_EQ(4u, m.compiled);
    EXPECT_EQ(3u, m.optimised);
    EXPECT_EQ(0u, m.cache_hits);
    EXPECT_EQ("a\nin 1\n", FakeToolchain::decode(m.list[0].words));
    EXPECT_EQ("a\nin 1\n", FakeToolchain::decode(m.list[0].unoptimised));
    ASSERT_EQ(1u, m.list[0].reflection.inputs.size());
    EXPECT_EQ(Stage::fragment, m.list[0].stage);
    EXPECT_EQ(2u, tools.reflects);
}

TEST(Modules, StagesNeverShareAModuleButShadersDo) {
    World a("a", 1), b("b", 1);
    a.add(Stage::vertex, {"same\n"});
    a.add(Stage::fragment, {"same\n"});
    b.add(Stage::fragment, {"same\n"});
    std::vector<StageClasses> stages = a.stages;
    stages.insert(stages.end(), b.stages.begin(), b.stages.end());
    FakeToolchain tools;
    MemoryStore store;
    const Modules m = build_modules(stages, store, tools, Jobs(1), {});
    EXPECT_EQ((std::vector<std::vector<uint32_t>>{{0}, {1}, {1}}), m.of_class);
    EXPECT_EQ(2u, tools.compiles);
}

TEST(Modules, ShadersWithOtherOptionsDoNotShareAnOptimisedModule) {
    World a("a", 1), b("b", 1);
    b.shader.options.optimise = Optimise::none;
    a.add(Stage::fragment, {"x\nslow\n"});
    b.add(Stage::fragment, {"x\nslow\n"});
    const std::vector<StageClasses> stages = {a.stages[0], b.stages[0]};
    FakeToolchain tools;
    MemoryStore store;
    const Modules m = build_modules(stages, store, tools, Jobs(1), {});
    EXPECT_EQ(1u, m.pruned);
    ASSERT_EQ(2u, m.list.size());
    EXPECT_EQ("x\nslow\n", FakeToolchain::decode(m.list[1].words));
}

TEST(Modules, ASecondBuildCompilesNothing) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    MemoryStore store;
    const Modules cold = build_modules(world.stages, store, tools, Jobs(1), {});
    FakeToolchain unused;
    const Modules warm = build_modules(world.stages, store, unused, Jobs(1), {});
    expect_same(cold, warm);
    EXPECT_EQ(4u, warm.cache_hits);
    EXPECT_EQ(0u, warm.compiled + warm.optimised);
    EXPECT_EQ(0u, unused.compiles + unused.prunes + unused.optimises + unused.validates + unused.reflects);
}

TEST(Modules, AnyMixtureOfHitsAndMissesGivesTheSame) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    MemoryStore empty;
    const Modules cold = build_modules(world.stages, empty, tools, Jobs(1), {});
    for (unsigned mask = 0; mask < 16; ++mask) {
        MemoryStore store;
        std::vector<std::string> some;
        for (unsigned i = 0; i < 4; ++i) {
            if ((mask >> i & 1) != 0) some.push_back(four[i]);
        }
        if (!some.empty()) {
            World part("part", 4);
            part.add(Stage::fragment, some);
            build_modules(part.stages, store, tools, Jobs(1), {});
        }
        const Modules mixed = build_modules(world.stages, store, tools, Jobs(2), {});
        expect_same(cold, mixed);
        EXPECT_EQ(some.size(), mixed.cache_hits);
        EXPECT_EQ(4 - some.size(), mixed.compiled);
    }
}

TEST(Modules, OtherToolsMissEverything) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    MemoryStore store;
    build_modules(world.stages, store, tools, Jobs(1), {});
    tools.version = "fake 2";
    EXPECT_EQ(0u, build_modules(world.stages, store, tools, Jobs(1), {}).cache_hits);
}

TEST(Modules, DamagedStoresAreMisses) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    MemoryStore store;
    const Modules cold = build_modules(world.stages, store, tools, Jobs(1), {});
    for (int damage = 0; damage < 3; ++damage) {
        DamagedStore damaged(store);
        damaged.flip = damage == 0 ? Keyspace::blob : Keyspace::action;
        damaged.drop_blobs = damage == 2;
        const Modules again = build_modules(world.stages, damaged, tools, Jobs(1), {});
        expect_same(cold, again);
        EXPECT_EQ(0u, again.cache_hits);
        EXPECT_EQ(4u, again.compiled);
    }
}

TEST(Modules, ABrokenStoreIsAWarning) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    for (const bool gets : {true, false}) {
        TestStore store;
        store.broken_gets = gets;
        store.broken_puts = !gets;
        const Modules m = build_modules(world.stages, store, tools, Jobs(2), {});
        EXPECT_EQ(2u, m.list.size());
        EXPECT_GT(m.store_failures, 0u);
        EXPECT_FALSE(m.diags.has_errors());
        ASSERT_EQ(1u, m.diags.list().size());
        EXPECT_NE(std::string::npos, m.diags.list()[0].message.find(gets ? "no disk" : "disk full"));
    }
}

TEST(Modules, RecordsComeAfterTheBlobsTheyName) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    TestStore store;
    build_modules(world.stages, store, tools, Jobs(2), {});
    bool record_seen = false;
    for (const auto& [space, key] : store.keys) {
        record_seen = record_seen || space == Keyspace::action;
        EXPECT_FALSE(space == Keyspace::blob && record_seen);
    }
    EXPECT_TRUE(record_seen);
}

TEST(Modules, ThreadsLeaveNoTrace) {
    World world("s", 300);
    std::vector<std::string> texts;
    for (int i = 0; i < 300; ++i) {
        texts.push_back("m " + std::to_string(i % 70) + "\ndead " + std::to_string(i) + "\nslow " + std::to_string(i % 140) +
                        "\nwarn w" + std::to_string(i % 3) + "\n");
    }
    world.add(Stage::fragment, texts);
    FakeToolchain tools;
    MemoryStore first;
    const Modules one = build_modules(world.stages, first, tools, Jobs(1), {});
    EXPECT_GT(one.list.size(), 69u);
    for (const unsigned threads : {2u, 8u}) {
        MemoryStore store;
        expect_same(one, build_modules(world.stages, store, tools, Jobs(threads), {}));
        expect_same(one, build_modules(world.stages, store, tools, Jobs(threads), {}));
    }
}

TEST(Modules, ErrorsAreCollapsedAfterEverythingWasCompiled) {
    World world("s", 4);
    world.add(Stage::fragment, {"ok\nfail bad\n", "x\n", "y\nfail bad\n", "z\nfail other\n"});
    FakeToolchain tools;
    MemoryStore store;
    const SourceLines lines = [](const std::string& file, uint32_t line) { return file + " line " + std::to_string(line); };
    const Modules m = build_modules(world.stages, store, tools, Jobs(2), {}, lines);
    EXPECT_TRUE(m.list.empty());
    EXPECT_EQ(4u, tools.compiles);
    EXPECT_EQ(0u, tools.optimises);
    ASSERT_EQ(2u, m.diags.list().size());
    const Diag& bad = m.diags.list()[0];
    EXPECT_EQ((Place{"fragment.glsl", 20, 2}), bad.place);
    EXPECT_EQ("bad", bad.message);
    EXPECT_EQ("fragment.glsl line 20", bad.source_line);
    ASSERT_EQ(1u, bad.notes.size());
    EXPECT_TRUE(bad.notes[0].starts_with("in 2 of 4 variants of s: exactly when ")) << bad.notes[0];
    EXPECT_EQ("other", m.diags.list()[1].message);
    EXPECT_EQ(0u, store.size());
}

TEST(Modules, WarningsAreShownAgainOnAHit) {
    World world("s", 2);
    world.add(Stage::fragment, {"warn careful\n", "fine\n"});
    FakeToolchain tools;
    MemoryStore store;
    const Modules cold = build_modules(world.stages, store, tools, Jobs(1), {});
    ASSERT_EQ(1u, cold.diags.list().size());
    EXPECT_EQ(Severity::warning, cold.diags.list()[0].severity);
    const Modules warm = build_modules(world.stages, store, tools, Jobs(1), {});
    EXPECT_EQ(2u, warm.cache_hits);
    EXPECT_EQ(cold.diags.list(), warm.diags.list());
}

TEST(Modules, AnInvalidModuleIsAnErrorWithItsCondition) {
    World world("s", 3);
    world.add(Stage::fragment, {"a\n", "invalid thing\n", "b\n"});
    FakeToolchain tools;
    MemoryStore store;
    const Modules m = build_modules(world.stages, store, tools, Jobs(1), {});
    EXPECT_TRUE(m.list.empty());
    ASSERT_EQ(1u, m.diags.list().size());
    EXPECT_NE(std::string::npos, m.diags.list()[0].message.find("invalid thing"));
    EXPECT_TRUE(m.diags.list()[0].message.starts_with("no valid SPIR-V")) << "the shader's mistake and not ours";
    EXPECT_TRUE(m.diags.list()[0].notes[0].starts_with("in 1 of 3 variants of s")) << m.diags.list()[0].notes[0];
}

TEST(Modules, AnInterruptGivesNothing) {
    World world("s", 4);
    world.add(Stage::fragment, four);
    FakeToolchain tools;
    MemoryStore store;
    interrupted = true;
    const Modules m = build_modules(world.stages, store, tools, Jobs(2), {});
    interrupted = false;
    EXPECT_TRUE(m.list.empty());
    EXPECT_TRUE(m.of_class.empty());
}

TEST(Modules, NoStagesNoModules) {
    FakeToolchain tools;
    MemoryStore store;
    EXPECT_TRUE(build_modules({}, store, tools, Jobs(2), {}).list.empty());
}

}  // namespace
}  // namespace kiln
