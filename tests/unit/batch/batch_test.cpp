#include "compiler/batch/batch.h"

#include <gtest/gtest.h>

#include "compiler/modules/module_record.h"
#include "compiler/toolchain/toolchain.h"
#include "compiler/translate/translate_record.h"

namespace kiln {
namespace {

const char* const good = "#version 450\nlayout(location=0) out vec4 o;\nvoid main() { o = vec4(0.25); }\n";
const char* const bad = "#version 450\nvoid main() { nothing; }\n";

struct Asked {
    std::unique_ptr<Toolchain> tools = make_toolchain();
    std::vector<std::string> texts;
    std::vector<ModuleQuestion> modules;
    std::vector<Digest> actions;

    explicit Asked(std::vector<std::string> of) : texts(std::move(of)) {
        for (const std::string& text : texts) {
            const Options options;
            const Digest action = module_action(tools->identity(), options, Stage::fragment, text);
            modules.push_back({Stage::fragment, options, text, action});
            actions.push_back(action);
        }
    }
    Bytes batch() const { return write_batch(tools->identity(), modules, {}); }
};

TEST(Batch, AnswersAreTheRecordsThatABuildWouldMake) {
    const Asked asked({good, bad});
    const Result<Bytes> answers = answer_batch(asked.batch(), *asked.tools, Jobs(1));
    ASSERT_TRUE(answers.ok()) << answers.error().message;
    MemoryStore store;
    const Result<size_t> taken = take_answers(*answers, asked.actions, store);
    ASSERT_TRUE(taken.ok()) << taken.error().message;
    EXPECT_EQ(*taken, 1u) << "the class with an error has no answer";
    const auto bytes = store.get(Keyspace::action, asked.actions[0]);
    ASSERT_TRUE(bytes.ok() && bytes->has_value());
    const auto record = read_module_record(asked.actions[0], **bytes);
    ASSERT_TRUE(record);
    for (const Digest& blob : {record->pruned, record->module}) {
        const auto there = store.get(Keyspace::blob, blob);
        ASSERT_TRUE(there.ok() && there->has_value());
        EXPECT_EQ(sha256(**there), blob);
    }
    EXPECT_EQ(record->reflection.outputs.size(), 1u);
    EXPECT_FALSE(store.get(Keyspace::action, asked.actions[1])->has_value());
}

TEST(Batch, TranslatesIntoEachTargetOrSaysWhyNot) {
    const Asked asked({good});
    const Compiled compiled = asked.tools->compile(Stage::fragment, good, {});
    const SlotLayout slots;
    const Digest module = sha256(as_bytes(WordView(compiled.words)));
    ArtifactQuestion question{compiled.words, &slots, {Target::glsl450, Target::msl21}, {}};
    for (const Target t : question.targets)
        question.actions.push_back(artifact_action(asked.tools->identity(), t, slots, module));
    const Result<Bytes> answers = answer_batch(write_batch(asked.tools->identity(), {}, {&question, 1}), *asked.tools, Jobs(2));
    ASSERT_TRUE(answers.ok()) << answers.error().message;
    MemoryStore store;
    const Result<size_t> taken = take_answers(*answers, question.actions, store);
    ASSERT_TRUE(taken.ok());
    EXPECT_EQ(*taken, 2u);
    const std::vector<Translated> here = asked.tools->translate(compiled.words, question.targets, slots);
    for (size_t t = 0; t < 2; ++t) {
        const auto record = read_artifact_record(question.actions[t], **store.get(Keyspace::action, question.actions[t]));
        ASSERT_TRUE(record);
        EXPECT_EQ(as_text(**store.get(Keyspace::blob, record->text)), here[t].text);
    }
}

TEST(Batch, EqualQuestionsGiveEqualBytes) {
    const Asked one({good, bad}), two({good, bad});
    EXPECT_EQ(one.batch(), two.batch());
    EXPECT_EQ(*answer_batch(one.batch(), *one.tools, Jobs(1)), *answer_batch(two.batch(), *two.tools, Jobs(2)));
}

TEST(Batch, AnswersThatWereNotAskedForAreLeft) {
    const Asked asked({good});
    const Result<Bytes> answers = answer_batch(asked.batch(), *asked.tools, Jobs(1));
    ASSERT_TRUE(answers.ok());
    MemoryStore store;
    const Digest other = sha256(as_bytes("another question"));
    EXPECT_EQ(*take_answers(*answers, {&other, 1}, store), 0u);
    EXPECT_EQ(store.size(), 0u);
}

TEST(Batch, NothingIsTakenFromWhatIsCutOrChanged) {
    const Asked asked({good});
    const Bytes batch = asked.batch();
    const Result<Bytes> answers = answer_batch(batch, *asked.tools, Jobs(1));
    ASSERT_TRUE(answers.ok());
    MemoryStore store;
    for (size_t length = 0; length < answers->size(); ++length)
        EXPECT_FALSE(take_answers(ByteView(*answers).first(length), asked.actions, store).ok()) << length;
    for (size_t at = 0; at < answers->size(); ++at) {
        Bytes changed = *answers;
        changed[at] ^= 0x10;
        EXPECT_FALSE(take_answers(changed, asked.actions, store).ok()) << at;
    }
    EXPECT_EQ(store.size(), 0u);
    for (size_t length = 0; length < batch.size(); ++length)
        EXPECT_FALSE(answer_batch(ByteView(batch).first(length), *asked.tools, Jobs(1)).ok()) << length;
}

TEST(Batch, AWorkerWithOtherToolsRefuses) {
    const Asked asked({good});
    const Result<Bytes> answers = answer_batch(write_batch("another compiler", asked.modules, {}), *asked.tools, Jobs(1));
    ASSERT_FALSE(answers.ok());
    EXPECT_NE(answers.error().message.find("another kiln"), std::string::npos);
}

}  // namespace
}  // namespace kiln
