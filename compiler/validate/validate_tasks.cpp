#include "compiler/validate/validate_tasks.h"

#include <algorithm>
#include <set>

#include "compiler/validate/partner.h"
#include "compiler/validate/values.h"

namespace kiln {

namespace {

constexpr uint32_t partner_attachments = 8;  // what every Vulkan device of the desktop has

const StageCode* find_stage(const std::vector<StagePtr>& stages, Stage stage) {
    for (const StagePtr& s : stages)
        if (s != nullptr && s->stage == stage) return s.get();
    return nullptr;
}

// Same kind and name, or for what has no name the same numbers; among several of one name, the one at the same numbers.
bool move_to_slot(const SlotLayout& layout, Resource& r) {
    const Slot* found = nullptr;
    for (const Slot& s : layout.slots) {
        if (s.kind != r.kind || s.name != r.name) continue;
        const bool same = s.set == r.set && s.binding == r.binding;
        if (found == nullptr || same) found = &s;
        if (same) break;
    }
    if (found == nullptr) return false;
    if (r.kind != ResourceKind::push_constants) r.set = found->set, r.binding = found->binding;
    return true;
}

}  // namespace

TaskMaker::TaskMaker(TableView& table, const Proof* proof, Toolchain& tools) : table_(table), tools_(tools) {
    if (proof != nullptr)
        for (const ProofModule& m : proof->modules) unoptimised_words_[m.digest] = &m.unoptimised;
}

Result<StagePtr> TaskMaker::published(const TableShader& shader, uint32_t module) {
    StagePtr& known = published_[{&shader, module}];
    if (known != nullptr) return known;
    const TableModule code = table_.module(module);
    StageCode stage;
    stage.stage = code.stage;
    stage.words.assign(code.words.begin(), code.words.end());
    stage.reflection = table_.reflection(module);
    for (Resource& r : stage.reflection.resources)
        if (!move_to_slot(shader.slots, r))
            return input_error("resource '" + r.name + "' of a " + name_of(code.stage) + " module of " + shader.space.shader +
                               " has no published slot");
    known = std::make_shared<const StageCode>(std::move(stage));
    return known;
}

// Null when the proof has no unoptimised form.
Result<StagePtr> TaskMaker::unoptimised(uint32_t module) {
    if (const auto known = unoptimised_.find(module); known != unoptimised_.end()) return known->second;
    StagePtr out;
    const auto words = unoptimised_words_.find(table_.module(module).digest);
    if (words != unoptimised_words_.end() && !words->second->empty()) {
        StageCode stage;
        stage.words = *words->second;
        Result<Reflection> reflection = tools_.reflect(stage.words);
        KILN_TRY(reflection);
        stage.reflection = std::move(*reflection);
        stage.stage = stage.reflection.stage;
        out = std::make_shared<const StageCode>(std::move(stage));
    }
    unoptimised_[module] = out;
    return out;
}

Result<StagePtr> TaskMaker::compiled(Stage stage, const std::string& text, const std::vector<Varying>& outputs) {
    StagePtr& known = partners_[text];
    if (known != nullptr) return known;
    const Compiled made = tools_.compile(stage, text, Options());
    if (made.words.empty())
        return environment_error(std::string("a generated ") + name_of(stage) + " stage does not compile: " +
                                 (made.messages.empty() ? "no message" : made.messages.front().text));
    StageCode code;
    code.stage = stage;
    code.words = made.words;
    code.partner = true;
    code.reflection.stage = stage;
    code.reflection.outputs = outputs;
    known = std::make_shared<const StageCode>(std::move(code));
    return known;
}

Result<StagePtr> TaskMaker::partner(const std::vector<StagePtr>& stages, const std::vector<StagePtr>& others) {
    if (stages.empty() || stages.front()->stage == Stage::compute || stages.front()->stage >= Stage::raygen) return StagePtr();
    const StageCode* fragment = find_stage(stages, Stage::fragment);
    if (fragment == nullptr) {
        const std::vector<Varying>& outputs = stages.back()->reflection.outputs;
        return compiled(Stage::fragment, fragment_partner(outputs, partner_attachments),
                        fragment_partner_outputs(outputs, partner_attachments));
    }
    if (stages.size() != 1) return StagePtr();
    // Both forms get one partner, so it feeds what either of them declares.
    std::vector<Varying> inputs = fragment->reflection.inputs;
    if (const StageCode* other = find_stage(others, Stage::fragment))
        for (const Varying& v : other->reflection.inputs)
            if (std::none_of(inputs.begin(), inputs.end(),
                             [&](const Varying& i) { return i.location == v.location && i.component == v.component; }))
                inputs.push_back(v);
    return compiled(Stage::vertex, vertex_partner(inputs), inputs);
}

Result<Task> TaskMaker::make(TableShader& shader, const TablePipeline& pipeline) {
    Task task;
    task.shader = &shader;
    task.pipeline = &pipeline;
    bool compared = true;
    for (const uint32_t module : pipeline.modules) {
        Result<StagePtr> stage = published(shader, module);
        KILN_TRY(stage);
        task.job.optimised.push_back(*stage);
        Result<StagePtr> other = unoptimised(module);
        KILN_TRY(other);
        compared &= *other != nullptr;
        task.job.unoptimised.push_back(*other);
    }
    if (!compared) task.job.unoptimised.clear();
    Result<StagePtr> added = partner(task.job.optimised, task.job.unoptimised);
    KILN_TRY(added);
    if (*added != nullptr)
        for (std::vector<StagePtr>* form : {&task.job.optimised, &task.job.unoptimised})
            if (!form->empty()) form->insert((*added)->stage == Stage::vertex ? form->begin() : form->end(), *added);
    return task;
}

std::vector<size_t> choose_sample(const std::vector<std::vector<uint32_t>>& pipelines, uint64_t wanted, uint64_t seed) {
    // The greedy cover, exactly: what a pipeline would add only ever shrinks, so a pass for each gain in falling order will do.
    size_t most = 0;
    for (const auto& p : pipelines) most = std::max(most, p.size());
    std::set<uint32_t> covered;
    std::vector<bool> taken(pipelines.size(), false);
    uint64_t count = 0;
    for (size_t gain = most; gain != 0; --gain)
        for (size_t i = 0; i < pipelines.size(); ++i) {
            if (taken[i]) continue;
            size_t fresh = 0;
            for (const uint32_t m : std::set<uint32_t>(pipelines[i].begin(), pipelines[i].end())) fresh += covered.count(m) == 0;
            if (fresh < gain) continue;
            taken[i] = true;
            ++count;
            covered.insert(pipelines[i].begin(), pipelines[i].end());
        }
    std::vector<std::pair<uint64_t, size_t>> rest;
    for (size_t i = 0; i < pipelines.size(); ++i)
        if (!taken[i]) rest.push_back({mix64(seed ^ mix64(i)), i});
    std::sort(rest.begin(), rest.end());
    for (size_t i = 0; i < rest.size() && count < wanted; ++i, ++count) taken[rest[i].second] = true;
    std::vector<size_t> out;
    for (size_t i = 0; i < taken.size(); ++i)
        if (taken[i]) out.push_back(i);
    return out;
}

}  // namespace kiln
