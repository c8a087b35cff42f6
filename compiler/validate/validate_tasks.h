#pragma once
// From a table to what a device is asked to run: one task a distinct pipeline, with partners for the stages that it lacks.

#include <map>

#include "compiler/table/proof.h"
#include "compiler/table/table_read.h"
#include "compiler/toolchain/toolchain.h"
#include "compiler/validate/check.h"

namespace kiln {

struct Task {
    TableShader* shader = nullptr;
    const TablePipeline* pipeline = nullptr;
    CheckJob job;
};

// Shares the stages that pipelines have in common.
class TaskMaker {
public:
    // `proof` may be null: no unoptimised forms then.
    TaskMaker(TableView& table, const Proof* proof, Toolchain& tools);

    // An input Error when a module or its unoptimised form cannot be read, or a resource has no slot.
    Result<Task> make(TableShader& shader, const TablePipeline& pipeline);

    // One module as its shader publishes it: every resource at the number of its *slot*, since that is what an engine binds by.
    Result<StagePtr> published(const TableShader& shader, uint32_t module);

    // A stage that the pipeline lacks, for both of its forms; null when it lacks none.
    Result<StagePtr> partner(const std::vector<StagePtr>& stages, const std::vector<StagePtr>& unoptimised);

private:
    Result<StagePtr> unoptimised(uint32_t module);
    Result<StagePtr> compiled(Stage stage, const std::string& text, const std::vector<Varying>& outputs);

    TableView& table_;
    Toolchain& tools_;
    std::map<Digest, const Words*> unoptimised_words_;
    std::map<std::pair<const TableShader*, uint32_t>, StagePtr> published_;
    std::map<uint32_t, StagePtr> unoptimised_;
    std::map<std::string, StagePtr> partners_;
};

// Which pipelines to draw so that every module is drawn once, then others by `seed` until there are `wanted`; ascending.
// `pipelines[i]` holds the modules of pipeline i.
std::vector<size_t> choose_sample(const std::vector<std::vector<uint32_t>>& pipelines, uint64_t wanted, uint64_t seed);

}  // namespace kiln
