// Random small spaces: whatever the axes, rules, scenes and classes are, the reader gives what brute force gives. And spaces
// too large to list, which must stay small on disk.
#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "compiler/runtime/kiln.h"
#include "compiler/runtime/table_format.h"
#include "compiler/table/proof.h"
#include "compiler/table/table_read.h"
#include "sample.h"

namespace kiln::test {
namespace {

constexpr uint32_t seed = 20261123;

struct RandomShader {
    SampleShader shader;
    bool legal = false;
};

SampleShader random_shader(std::mt19937& random) {
    const auto below = [&](uint32_t n) { return static_cast<uint32_t>(random() % n); };
    SampleShader out;
    out.name = "s";
    const uint32_t axes = 1 + below(6);
    for (uint32_t a = 0; a < axes; ++a) {
        std::vector<std::string> values;
        for (uint32_t v = 0; v < 1 + below(5); ++v) values.push_back("v" + std::to_string(v));
        out.axes.push_back(named("x" + std::to_string(a), values));
    }
    const auto literal = [&] {
        const uint32_t a = below(axes);
        return out.axes[a].name + (below(2) == 0 ? " == " : " != ") +
               out.axes[a].values[below(static_cast<uint32_t>(out.axes[a].values.size()))].name;
    };
    for (uint32_t r = below(4); r > 0; --r) out.forbid.push_back(literal() + " && " + literal());
    if (below(3) == 0) out.needed = literal() + " || " + literal();
    for (uint32_t s = 0; s < 1 + below(3); ++s) {
        SampleStage stage;
        stage.stage = static_cast<Stage>(s * 2);
        for (uint32_t a = 0; a < axes; ++a)
            if (below(2) == 0) stage.reads.push_back(a);
        const uint32_t texts = 1 + below(9), salt = below(1000);
        stage.text = [reads = stage.reads, texts, salt](const Digits& d) {
            uint32_t h = salt;
            for (const uint32_t a : reads) h = (h ^ d[a]) * 2654435761u >> 3;
            return "t" + std::to_string(h % texts);
        };
        out.stages.push_back(stage);
    }
    return out;
}

// Checks every combination of digits; returns how many were needed.
size_t expect_agrees(Sample& sample, const Bytes& bytes, const std::string& note) {
    size_t needed = 0;
    kiln_table table;
    EXPECT_EQ(kiln_open(&table, bytes.data(), bytes.size()), KILN_OK);
    const char* what = nullptr;
    EXPECT_EQ(kiln_verify(&table, &what), KILN_OK) << what << note;
    kiln_shader shader;
    EXPECT_EQ(kiln_get_shader(&table, 0, &shader), KILN_OK);
    Space& space = sample.space(0);
    std::vector<uint64_t> key(shader.key_words);
    // Every pattern of the key's bits, and one bit more: a bad key is told from a good one.
    uint32_t bits = 0;
    for (uint32_t a = 0; a < shader.axis_count; ++a) {
        kiln_axis axis;
        EXPECT_EQ(kiln_get_axis(&shader, a, &axis), KILN_OK);
        bits += axis.bits;
    }
    std::vector<uint32_t> digits(shader.axis_count);
    for (uint64_t raw = 0; raw<uint64_t{2} << bits; raw += bits> 12 ? 7 : 1) {
        const bool good = kiln_unpack(&shader, &raw, digits.data()) == KILN_OK && raw >> bits == 0;
        EXPECT_EQ(kiln_check(&shader, &raw) != KILN_BAD_KEY, good) << raw << note;
    }
    every(space.diagram->radices(), [&](const Digits& d) {
        EXPECT_EQ(kiln_pack(&shader, d.data(), key.data()), KILN_OK);
        uint32_t modules[KILN_MAX_STAGES];
        const kiln_status status = kiln_find(&shader, key.data(), modules);
        const bool legal = space.diagram->contains(space.legal, d), wanted = space.diagram->contains(space.needed, d);
        EXPECT_EQ(status, wanted ? KILN_OK : legal ? KILN_NOT_NEEDED : KILN_FORBIDDEN) << note;
        bool broken = false;
        for (uint32_t r = 0; r < shader.rule_count; ++r) broken |= kiln_check_rule(&shader, r, key.data()) == KILN_FORBIDDEN;
        EXPECT_EQ(broken, !legal) << note;
        if (!wanted) return;
        ++needed;
        for (size_t s = 0; s < sample.stages().size(); ++s) EXPECT_EQ(modules[s], sample.module_of(s, d)) << note;
    });
    return needed;
}

TEST(Random, ReaderAgreesWithBruteForce) {
    std::mt19937 random(seed);
    size_t needed = 0;
    for (int round = 0; round < 400; ++round) {
        Sample sample({random_shader(random)});
        const auto files = write_table(sample.input());
        ASSERT_TRUE(files.ok()) << files.error().message;
        needed += expect_agrees(sample, files->table, " seed " + std::to_string(seed) + " round " + std::to_string(round));
        const auto again = write_table(sample.input());
        EXPECT_EQ(files->table, again->table);
        EXPECT_EQ(files->proof, again->proof);
        // A stage's diagram asks none but the axes that the stage reads.
        kiln_table table;
        kiln_shader shader;
        kiln_open(&table, files->table.data(), files->table.size());
        kiln_get_shader(&table, 0, &shader);
        for (uint32_t s = 0; s < shader.stage_count; ++s) {
            uint32_t axes[8];
            const uint32_t count = kiln_stage_axes(&shader, s, axes, 8);
            const auto& reads = sample.stages()[s].split->axes_read;
            for (uint32_t i = 0; i < count; ++i) EXPECT_TRUE(std::find(reads.begin(), reads.end(), axes[i]) != reads.end());
        }
        auto proof = read_proof(files->proof, files->table);
        ASSERT_TRUE(proof.ok()) << proof.error().message;
        auto view = TableView::open(files->table);
        ASSERT_TRUE(view.ok()) << view.error().message;
        for (const ProofMismatch& m : check_proof(**view, *proof)) ADD_FAILURE() << m.variant << ": " << m.why;
    }
    EXPECT_GT(needed, 10000u);
}

// 44 axes of 2 to 4 values, more than 10^12 legal variants, 20 texts.
Sample huge_sample() {
    SampleShader shader;
    shader.name = "huge";
    for (int i = 0; i < 44; ++i) {
        std::vector<std::string> values = {"a", "b"};
        if (i % 3 == 0) values.push_back("c");
        if (i % 6 == 0) values.push_back("d");
        shader.axes.push_back(named("x" + std::to_string(i), values));
    }
    for (int i = 0; i < 40; i += 4)
        shader.forbid.push_back("x" + std::to_string(i) + " == b && x" + std::to_string(i + 3) + " == a");
    SampleStage fragment{Stage::fragment, {}, {}, {}}, vertex{Stage::vertex, {1, 43}, {}, {}};
    const std::vector<std::string> first = {"x0 == a", "x0 == b", "x0 == c", "x0 == d"}, second = {"x5 == a", "x5 == b"},
                                   third = {"x43 == a && x20 == a", "!(x43 == a && x20 == a)"};
    for (const auto& a : first)
        for (const auto& b : second)
            for (const auto& c : third) fragment.conditions.push_back(a + " && " + b + " && (" + c + ")");
    fragment.reads = {0, 5, 20, 43};
    vertex.conditions = {"x1 == a && x43 == a", "x1 == a && x43 == b", "x1 == b && x43 == a", "x1 == b && x43 == b"};
    shader.stages = {vertex, fragment};
    return Sample({shader});
}

TEST(Huge, TwentyTextsOverTenToTheTwelveVariantsAreSmall) {
    Sample sample = huge_sample();
    EXPECT_GT(sample.space(0).diagram->count(sample.space(0).legal), Count(1'000'000'000'000u));
    EXPECT_EQ(sample.modules().list.size(), 20u);
    const auto start = std::chrono::steady_clock::now();
    const auto files = write_table(sample.input());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(files.ok());
    EXPECT_LT(files->table.size(), size_t{1} << 20);
    RecordProperty("bytes", std::to_string(files->table.size()));
    RecordProperty("seconds", std::to_string(took.count()));

    auto view = TableView::open(files->table);
    ASSERT_TRUE(view.ok()) << view.error().message;
    auto proof = read_proof(files->proof, files->table);
    ASSERT_TRUE(proof.ok());
    EXPECT_TRUE(check_proof(**view, *proof).empty());

    kiln_table table;
    kiln_shader shader;
    ASSERT_EQ(kiln_open(&table, files->table.data(), files->table.size()), KILN_OK);
    ASSERT_EQ(kiln_get_shader(&table, 0, &shader), KILN_OK);
    std::mt19937 random(seed);
    Space& space = sample.space(0);
    size_t legal = 0;
    for (int i = 0; i < 20000; ++i) {
        Digits d;
        for (const Axis& axis : space.axes) d.push_back(static_cast<uint32_t>(random() % axis.values.size()));
        std::vector<uint64_t> key(shader.key_words);
        ASSERT_EQ(kiln_pack(&shader, d.data(), key.data()), KILN_OK);
        uint32_t modules[KILN_MAX_STAGES];
        const kiln_status status = kiln_find(&shader, key.data(), modules);
        ASSERT_EQ(status, space.diagram->contains(space.needed, d) ? KILN_OK : KILN_FORBIDDEN);
        if (status != KILN_OK) continue;
        ++legal;
        for (size_t s = 0; s < 2; ++s) ASSERT_EQ(modules[s], sample.module_of(s, d));
    }
    EXPECT_GT(legal, 100u);
}

TEST(Huge, ManyValuesAskedOneQuestionStaySmall) {
    // Three axes of 4,096 values, asked only whether they are 7.
    SampleShader shader;
    shader.name = "ids";
    std::vector<std::string> values;
    for (int i = 0; i < 4096; ++i) values.push_back("v" + std::to_string(i));
    for (int i = 0; i < 3; ++i) shader.axes.push_back(named("id" + std::to_string(i), values));
    SampleStage stage{Stage::fragment, {0, 1, 2}, {}, {}};
    for (int i = 0; i < 8; ++i) {
        std::string text;
        for (int a = 0; a < 3; ++a)
            text += std::string(a == 0 ? "" : " && ") + "id" + std::to_string(a) + ((i >> a & 1) != 0 ? " == v7" : " != v7");
        stage.conditions.push_back(text);
    }
    shader.stages = {stage};
    Sample sample({shader});
    const auto files = write_table(sample.input());
    ASSERT_TRUE(files.ok());
    kiln_table table;
    ASSERT_EQ(kiln_open(&table, files->table.data(), files->table.size()), KILN_OK);
    EXPECT_LT(table.section[kf_nodes].count, 100u);
    kiln_shader shader_handle;
    ASSERT_EQ(kiln_get_shader(&table, 0, &shader_handle), KILN_OK);
    for (const uint32_t a : {0u, 6u, 7u, 8u, 4095u})
        for (const uint32_t b : {0u, 7u, 4095u}) {
            const Digits d{a, b, 7};
            uint64_t key[1];
            uint32_t module = 0;
            ASSERT_EQ(kiln_pack(&shader_handle, d.data(), key), KILN_OK);
            ASSERT_EQ(kiln_find(&shader_handle, key, &module), KILN_OK);
            EXPECT_EQ(module, sample.module_of(0, d));
        }
}

TEST(Writer, ClassesThatOverlapAreRefused) {
    SampleShader shader;
    shader.name = "s";
    shader.axes = {boolean("a"), boolean("b")};
    shader.stages = {{Stage::fragment, {0, 1}, {}, {"a", "!a || b"}}};
    Sample sample({shader});
    const auto files = write_table(sample.input());
    ASSERT_FALSE(files.ok());
    EXPECT_EQ(files.error().message, "two classes of the fragment stage of s claim the same variant");
}

TEST(Writer, AShaderOfWhichNothingIsNeededSaysSo) {
    Sample sample = small_sample(), other({{"unused", {boolean("a")}, {}, {{Stage::fragment, {}, {}, {"a == a"}}}, "a && !a"}});
    TableInput input = sample.input();
    input.left_out = {&other.space(0)};
    const auto files = write_table(input);
    ASSERT_TRUE(files.ok());
    kiln_table table;
    kiln_shader s;
    ASSERT_EQ(kiln_open(&table, files->table.data(), files->table.size()), KILN_OK);
    EXPECT_EQ(kiln_verify(&table, nullptr), KILN_OK);
    ASSERT_EQ(kiln_find_shader(&table, "unused", &s), KILN_OK);
    uint64_t key[1] = {};
    EXPECT_EQ(s.stage_count, 0u);
    EXPECT_EQ(kiln_check(&s, key), KILN_NOT_NEEDED);
    auto view = TableView::open(files->table);
    auto proof = read_proof(files->proof, files->table);
    ASSERT_TRUE(view.ok() && proof.ok());
    EXPECT_TRUE(check_proof(**view, *proof).empty());
    EXPECT_NE(write_key_header(input).find("namespace unused"), std::string::npos);
}

TEST(Writer, AxesWithoutValuesToChooseAndKeysOfSeveralWords) {
    SampleShader shader;
    shader.name = "wide";
    for (int i = 0; i < 70; ++i) shader.axes.push_back(boolean("b" + std::to_string(i)));
    shader.axes.push_back(named("single", {"only"}));
    shader.axes.push_back(named("three", {"p", "q", "r"}));
    shader.stages = {{Stage::compute, {69, 71}, {}, {"b69 && three == r", "!(b69 && three == r)"}}};
    Sample sample({shader});
    const auto files = write_table(sample.input());
    ASSERT_TRUE(files.ok());
    kiln_table table;
    kiln_shader s;
    ASSERT_EQ(kiln_open(&table, files->table.data(), files->table.size()), KILN_OK);
    ASSERT_EQ(kiln_get_shader(&table, 0, &s), KILN_OK);
    EXPECT_EQ(s.key_words, 2u);
    uint64_t key[2] = {};
    uint32_t one = 0, other = 0;
    ASSERT_EQ(kiln_find(&s, key, &one), KILN_OK);
    ASSERT_EQ(kiln_key_set(&s, key, 69, 1), KILN_OK);
    ASSERT_EQ(kiln_key_set(&s, key, 71, 2), KILN_OK);
    ASSERT_EQ(kiln_find(&s, key, &other), KILN_OK);
    EXPECT_NE(one, other);
    EXPECT_EQ(kiln_key_set(&s, key, 71, 3), KILN_BAD_KEY);
    EXPECT_EQ(kiln_key_set(&s, key, 70, 1), KILN_BAD_KEY);
    EXPECT_EQ(kiln_key_set(&s, key, 72, 0), KILN_ABSENT);
    key[1] |= uint64_t{3} << 6;  // the field of `three` holds 3, which no value is
    EXPECT_EQ(kiln_check(&s, key), KILN_BAD_KEY);
    key[1] = uint64_t{1} << 20;
    EXPECT_EQ(kiln_check(&s, key), KILN_BAD_KEY);
}

}  // namespace
}  // namespace kiln::test
