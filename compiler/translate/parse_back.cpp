// Texts are few and pairs of texts are not many more, because equal texts were merged before. The work list is made first,
// with the set of variants behind each item, so that the parallel loop touches no diagram.

#include "compiler/translate/parse_back.h"

#include <algorithm>
#include <mutex>
#include <tuple>

#include "compiler/space/describe.h"
#include "compiler/toolchain/edits.h"
#include "compiler/translate/translate_record.h"

namespace kiln {
namespace {

// A text, or a vertex text and the fragment text that it is drawn with. One shader each, since conditions are a shader's.
struct Item {
    uint32_t shader = 0;
    size_t target = 0;
    size_t stage = 0;  // index into the stages, for the place
    uint32_t text = no_artifact, fragment = no_artifact;
    Set set;
    std::vector<ToolMessage> messages;
};

bool is_gl(Target target) {
    if (target == Target::spirv) return false;
    return language_of(target) == Language::glsl || language_of(target) == Language::essl;
}

class ParseBack {
public:
    ParseBack(const ParseBackContext& context, const std::vector<ShaderStages>& shaders, Artifacts& artifacts)
        : c_(context), shaders_(shaders), out_(artifacts) {}

    void run() {
        for (size_t t = 0; t < c_.targets.size(); ++t) {
            if (!is_gl(c_.targets[t])) continue;
            for (size_t s = 0; s < shaders_.size(); ++s) add_texts(static_cast<uint32_t>(s), t);
        }
        const std::vector<Pipeline> pipelines = find_pipelines(shaders_);
        for (size_t t = 0; t < c_.targets.size(); ++t)
            if (is_gl(c_.targets[t]))
                for (const Pipeline& p : pipelines) add_pair(p, t);
        digests_.resize(out_.list.size());
        for (size_t i = 0; i < digests_.size(); ++i)
            if (is_gl(out_.list[i].target)) digests_[i] = sha256(as_bytes(out_.list[i].text));
        ask();
        report();
    }

private:
    Item& item(uint32_t shader, size_t target, size_t stage, uint32_t text, uint32_t fragment) {
        const auto [at, fresh] = index_.emplace(std::tuple{shader, target, text, fragment}, items_.size());
        if (fresh) items_.push_back({shader, target, stage, text, fragment, Diagram::none(), {}});
        return items_[at->second];
    }

    void add_texts(uint32_t shader, size_t target) {
        const ShaderStages& s = shaders_[shader];
        for (size_t i = 0; i < s.stages.size(); ++i)
            for (const auto& [module, variants] : s.modules[i]) {
                const uint32_t text = out_.of[shader][target][module];
                if (text == no_artifact) continue;
                Item& it = item(shader, target, s.stages[i], text, no_artifact);
                it.set = s.space->diagram->either(it.set, variants);
            }
    }

    // Only where the two stages are neighbours.
    void add_pair(const Pipeline& p, size_t target) {
        const ShaderStages& s = shaders_[p.shader];
        uint32_t vertex = no_artifact, fragment = no_artifact;
        size_t stage = 0;
        for (size_t i = 0; i < s.stages.size(); ++i) {
            const uint32_t text = out_.of[p.shader][target][p.modules[i]];
            switch (c_.stages[s.stages[i]].stage) {
                case Stage::vertex:
                    vertex = text;
                    break;
                case Stage::fragment:
                    fragment = text;
                    stage = s.stages[i];
                    break;
                default:
                    return;
            }
        }
        if (vertex == no_artifact || fragment == no_artifact) return;
        Item& it = item(p.shader, target, stage, vertex, fragment);
        it.set = s.space->diagram->either(it.set, p.variants);
    }

    void ask() {
        const std::string identity = c_.tools.identity();
        size_t done = 0;
        std::mutex mutex;
        c_.jobs.each(items_.size(), [&](size_t i) {
            Item& it = items_[i];
            const Target target = c_.targets[it.target];
            const bool pair = it.fragment != no_artifact;
            const Stage stage = c_.stages[it.stage].stage;
            const Digest action = pair ? link_back_action(identity, target, digests_[it.text], digests_[it.fragment])
                                       : parse_back_action(identity, target, stage, digests_[it.text]);
            bool known = false;
            if (const auto got = c_.store.get(Keyspace::action, action); got.ok() && got->has_value())
                if (auto messages = read_messages(action, **got)) {
                    it.messages = std::move(*messages);
                    known = true;
                }
            if (!known) {
                it.messages = pair ? c_.tools.link_back(target, out_.list[it.text].text, out_.list[it.fragment].text)
                                   : c_.tools.parse_back(target, stage, out_.list[it.text].text);
                const Status stored = c_.store.put(Keyspace::action, action, write_messages(action, it.messages));
                const std::lock_guard lock(mutex);
                if (!stored.ok()) ++out_.store_failures;
            }
            if (!c_.progress) return;
            const std::lock_guard lock(mutex);
            c_.progress("parse back", ++done, items_.size());
        });
    }

    // One error per place, target and message; a pair whose parts already failed adds nothing.
    void report() {
        std::map<std::pair<uint32_t, uint32_t>, bool> bad;  // (shader, text)
        for (const Item& it : items_)
            if (it.fragment == no_artifact && !it.messages.empty()) bad[{it.shader, it.text}] = true;
        std::map<std::tuple<uint32_t, size_t, size_t, bool, std::string>, std::pair<Set, std::string>> groups;
        for (const Item& it : items_) {
            const bool pair = it.fragment != no_artifact;
            if (pair && (bad.count({it.shader, it.text}) != 0 || bad.count({it.shader, it.fragment}) != 0)) continue;
            for (const ToolMessage& m : it.messages) {
                auto& group = groups[{it.shader, it.target, it.stage, pair, m.text}];
                group.first = shaders_[it.shader].space->diagram->either(group.first, it.set);
                if (group.second.empty() && m.line != 0)
                    group.second = "line " + std::to_string(m.line) +
                                   " of the text: " + std::string(line_of(out_.list[pair ? it.fragment : it.text].text, m.line));
            }
        }
        for (const auto& [key, group] : groups) {
            const auto& [shader, target, stage, pair, message] = key;
            const StageClasses& classes = c_.stages[stage];
            const std::string name = name_of(c_.targets[target]);
            Diag& diag = out_.diags.error(
                {classes.split->files.empty() ? std::string() : classes.split->files.front(), 0, 0},
                pair ? "the " + name + " texts of the vertex and the fragment stage do not link: " + message
                     : "the " + name + " text of the " + name_of(classes.stage) + " stage does not parse: " + message);
            if (!group.second.empty() && !pair) diag.notes.push_back(group.second);
            diag.notes.push_back(describe_condition(*classes.space, group.first, classes.space->needed));
        }
    }

    const ParseBackContext& c_;
    const std::vector<ShaderStages>& shaders_;
    Artifacts& out_;
    std::vector<Item> items_;
    std::map<std::tuple<uint32_t, size_t, uint32_t, uint32_t>, size_t> index_;
    std::vector<Digest> digests_;  // of the texts in `list`; of no use for other targets
};

}  // namespace

void parse_texts_back(const ParseBackContext& context, const std::vector<ShaderStages>& shaders, Artifacts& artifacts) {
    ParseBack(context, shaders, artifacts).run();
}

}  // namespace kiln
