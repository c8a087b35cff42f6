// The reader against what was written, on every combination of axes, legal or not.
#include <gtest/gtest.h>

#include "compiler/runtime/kiln.h"
#include "compiler/table/proof.h"
#include "sample.h"

namespace kiln::test {
namespace {

std::string text_of(kiln_text t) { return {t.data, t.size}; }

void expect_agrees(Sample& sample, const Bytes& bytes) {
    kiln_table table;
    ASSERT_EQ(kiln_open(&table, bytes.data(), bytes.size()), KILN_OK);
    const char* what = nullptr;
    ASSERT_EQ(kiln_verify(&table, &what), KILN_OK) << what;
    const auto shaders = stages_by_shader(sample.stages());
    for (uint32_t s = 0; s < shaders.size(); ++s) {
        Space& space = sample.space(s);
        kiln_shader shader;
        ASSERT_EQ(kiln_find_shader(&table, space.shader.c_str(), &shader), KILN_OK);
        ASSERT_EQ(shader.stage_count, shaders[s].size());
        EXPECT_EQ(text_of(shader.legal), space.diagram->count(space.legal).decimal());
        EXPECT_EQ(text_of(shader.needed), space.diagram->count(space.needed).decimal());
        std::vector<uint64_t> key(shader.key_words);
        every(space.diagram->radices(), [&](const Digits& d) {
            ASSERT_EQ(kiln_pack(&shader, d.data(), key.data()), KILN_OK);
            Digits back(d.size());
            EXPECT_EQ(kiln_unpack(&shader, key.data(), back.data()), KILN_OK);
            EXPECT_EQ(back, d);
            uint32_t modules[KILN_MAX_STAGES];
            const kiln_status status = kiln_find(&shader, key.data(), modules);
            if (!space.diagram->contains(space.legal, d)) {
                EXPECT_EQ(status, KILN_FORBIDDEN);
            } else if (!space.diagram->contains(space.needed, d)) {
                EXPECT_EQ(status, KILN_NOT_NEEDED);
            } else {
                ASSERT_EQ(status, KILN_OK) << space.describe_variant(d);
                for (size_t i = 0; i < shaders[s].size(); ++i) {
                    EXPECT_EQ(modules[i], sample.module_of(shaders[s][i], d)) << space.describe_variant(d);
                    uint32_t one = KILN_NONE;
                    EXPECT_EQ(kiln_find_stage(&shader, key.data(), static_cast<uint32_t>(i), &one), KILN_OK);
                    EXPECT_EQ(one, modules[i]);
                }
            }
        });
    }
}

TEST(Lookup, SmallTableAnswersEveryKey) {
    Sample sample = small_sample();
    const auto files = write_table(sample.input());
    ASSERT_TRUE(files.ok());
    expect_agrees(sample, files->table);
}

}  // namespace
}  // namespace kiln::test
