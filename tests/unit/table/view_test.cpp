// Our own view of a table, and the proof against it.
#include <gtest/gtest.h>

#include "compiler/table/proof.h"
#include "compiler/table/table_read.h"
#include "sample.h"

namespace kiln::test {
namespace {

TableFiles files_of(Sample& sample) {
    auto files = write_table(sample.input());
    EXPECT_TRUE(files.ok());
    return std::move(*files);
}

TEST(View, SetsModulesTextsAndReflectionComeBack) {
    Sample sample = small_sample();
    const TableFiles files = files_of(sample);
    auto opened = TableView::open(files.table);
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    TableView& view = **opened;
    EXPECT_EQ(view.name(), "sample");
    EXPECT_EQ(view.tools(), "sample 1");
    EXPECT_EQ(view.scenes(), (std::vector<std::string>{"corridor", "yard"}));
    ASSERT_EQ(view.shaders().size(), 2u);
    const auto stages = stages_by_shader(sample.stages());
    for (size_t s = 0; s < 2; ++s) {
        TableShader& shader = view.shaders()[s];
        Space& space = sample.space(s);
        EXPECT_EQ(shader.space.diagram->import(*space.diagram, space.legal), shader.space.legal);
        EXPECT_EQ(shader.space.diagram->import(*space.diagram, space.needed), shader.space.needed);
        EXPECT_EQ(shader.slots, sample.artifacts().slots[s]);
        ASSERT_EQ(shader.rules.size(), space.rules.size());
        for (size_t r = 0; r < shader.rules.size(); ++r)
            EXPECT_EQ(shader.space.diagram->import(*space.diagram, compile_expr(space, space.rules[r].expr)),
                      shader.rules[r].broken);
        for (size_t i = 0; i < stages[s].size(); ++i) {
            const size_t stage = stages[s][i];
            const auto& classes = sample.stages()[stage].split->classes;
            for (size_t c = 0; c < classes.size(); ++c) {
                const uint32_t m = sample.modules().of_class[stage][c];
                EXPECT_TRUE(shader.space.diagram->subset(shader.space.diagram->import(*space.diagram, classes[c].variants),
                                                         shader.variants_of(i, m)));
                EXPECT_EQ(view.reflection(m), sample.modules().list[m].reflection);
                EXPECT_EQ(Words(view.module(m).words.begin(), view.module(m).words.end()), sample.modules().list[m].words);
                const auto texts = view.texts(shader, m);
                ASSERT_EQ(texts.size(), 2u);
                for (size_t t = 0; t < 2; ++t) {
                    const uint32_t artifact = sample.artifacts().of[s][t + 1][m];
                    if (artifact == no_artifact) {
                        EXPECT_EQ(texts[t].refusal, "ESSL 3.10 has no doubles");
                        EXPECT_FALSE(texts[t].artifact.has_value());
                    } else {
                        EXPECT_EQ(texts[t].artifact, artifact);
                        EXPECT_EQ(view.text(artifact), sample.artifacts().list[artifact].text);
                    }
                }
            }
        }
    }
    EXPECT_EQ(view.shader("surface")->pipelines.size() + view.shader("blur")->pipelines.size(),
              sample.interfaces_.pipelines.size());
    EXPECT_EQ(view.shader("nothing"), nullptr);
}

TEST(Proof, OfItsTableAgrees) {
    Sample sample = small_sample();
    const TableFiles files = files_of(sample);
    auto proof = read_proof(files.proof, files.table);
    ASSERT_TRUE(proof.ok()) << proof.error().message;
    ASSERT_EQ(proof->modules.size(), sample.modules().list.size());
    EXPECT_EQ(proof->modules[0].unoptimised, sample.modules().list[0].unoptimised);
    auto view = TableView::open(files.table);
    ASSERT_TRUE(view.ok());
    for (const ProofMismatch& m : check_proof(**view, *proof)) ADD_FAILURE() << m.shader << " " << m.variant << ": " << m.why;
}

TEST(Proof, OfAnotherTableIsRefused) {
    Sample sample = small_sample(), other = small_sample();
    other.tool_versions = "sample 2";
    const TableFiles a = files_of(sample), b = files_of(other);
    const auto proof = read_proof(b.proof, a.table);
    ASSERT_FALSE(proof.ok());
    EXPECT_EQ(proof.error().message, "this proof belongs to another table");
}

TEST(Proof, FindsAVariantThatResolvesElsewhere) {
    Sample sample = small_sample();
    const TableFiles files = files_of(sample);
    auto view = TableView::open(files.table);
    ASSERT_TRUE(view.ok());
    const auto broken = [&](auto&& change) {
        auto proof = read_proof(files.proof, files.table);
        change(*proof);
        return check_proof(**view, *proof);
    };
    auto wrong =
        broken([](Proof& p) { std::swap(p.shaders[0].stages[1].classes[0].module, p.shaders[0].stages[1].classes[1].module); });
    ASSERT_FALSE(wrong.empty());
    EXPECT_EQ(wrong[0].shader, "surface");
    EXPECT_NE(wrong[0].why.find("fragment does not resolve to module"), std::string::npos) << wrong[0].why;
    EXPECT_NE(wrong[0].why.find("variants of surface"), std::string::npos) << wrong[0].why;
    EXPECT_NE(wrong[0].variant.find("light="), std::string::npos);
    wrong = broken([](Proof& p) { p.shaders[0].stages[0].classes.pop_back(); });
    ASSERT_FALSE(wrong.empty());
    EXPECT_NE(wrong[0].why.find("is needed by one of table and proof only"), std::string::npos) << wrong[0].why;
    wrong = broken([](Proof& p) { p.modules[1].digest.bytes[3] ^= 1; });
    ASSERT_EQ(wrong.size(), 1u);
    EXPECT_EQ(wrong[0].why, "module 1 has other words than the proof records");
    wrong = broken([](Proof& p) { p.shaders[1].stages[0].classes[2].artifacts[1]->bytes[0] ^= 1; });
    ASSERT_EQ(wrong.size(), 1u);
    EXPECT_NE(wrong[0].why.find("compute has another glsl450 text"), std::string::npos) << wrong[0].why;
    wrong = broken([](Proof& p) { p.shaders[1].name = "glare"; });
    ASSERT_EQ(wrong.size(), 1u);
}

TEST(Proof, EveryTruncationAndBitFlipIsRefused) {
    Sample sample = small_sample();
    const TableFiles files = files_of(sample);
    for (size_t n = 0; n < files.proof.size(); ++n) {
        const Bytes cut(files.proof.begin(), files.proof.begin() + static_cast<std::ptrdiff_t>(n));
        EXPECT_FALSE(read_proof(cut, files.table).ok()) << n;
    }
    for (size_t bit = 0; bit < files.proof.size() * 8; bit += 7) {
        Bytes flipped = files.proof;
        flipped[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
        EXPECT_FALSE(read_proof(flipped, files.table).ok()) << bit;
    }
}

}  // namespace
}  // namespace kiln::test
