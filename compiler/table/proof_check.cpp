// The proof's classes of a stage and the table's map of that stage are merged as maps: a contradiction anywhere is a variant
// that resolves to something else, and none means that all of them agree. Only then is there anything to look for.

#include <map>
#include <set>

#include "compiler/space/describe.h"
#include "compiler/table/proof.h"

namespace kiln {

namespace {

class Checker {
public:
    Checker(TableView& table, Proof& proof) : table_(table), proof_(proof) {}

    std::vector<ProofMismatch> run() {
        modules();
        size_t built = 0;  // a shader without stages is in the table only to say that nothing of it is needed
        for (const TableShader& s : table_.shaders()) built += s.stages.empty() ? 0 : 1;
        if (built != proof_.shaders.size()) say("", "", "the table and its proof have other shaders");
        for (ProofShader& s : proof_.shaders) {
            TableShader* shader = table_.shader(s.name);
            if (shader == nullptr || shader->space.diagram->radices() != s.diagram->radices() ||
                shader->stages.size() != s.stages.size()) {
                say(s.name, "", "the shader's axes or stages are not those of the proof");
                continue;
            }
            for (size_t i = 0; i < s.stages.size(); ++i) stage(*shader, s, i);
        }
        return std::move(out_);
    }

private:
    void say(std::string shader, std::string variant, std::string why) {
        out_.push_back({std::move(shader), std::move(variant), std::move(why)});
    }

    void modules() {
        if (table_.info().module_count != proof_.modules.size()) return say("", "", "the table has other modules than its proof");
        for (uint32_t i = 0; i < proof_.modules.size(); ++i) {
            const TableModule m = table_.module(i);
            if (m.digest != proof_.modules[i].digest || sha256(as_bytes(m.words)) != proof_.modules[i].digest)
                say("", "", "module " + std::to_string(i) + " has other words than the proof records");
        }
    }

    void stage(TableShader& shader, ProofShader& proof, size_t index) {
        const TableStage& stage = shader.stages[index];
        if (stage.stage != proof.stages[index].stage)
            return say(shader.space.shader, "", "the shader's stages are not those of the proof");
        Diagram& diagram = *shader.space.diagram;
        std::vector<Set> sets;
        std::vector<LeafMaps::Ref> parts;
        Set all = Diagram::none();
        for (const ProofClass& c : proof.stages[index].classes) {
            sets.push_back(diagram.import(*proof.diagram, c.variants));
            parts.push_back(shader.maps->from_set(sets.back(), c.module));
            all = diagram.either(all, sets.back());
        }
        if (all != shader.space.needed) {
            const Set odd = diagram.either(diagram.minus(all, shader.space.needed), diagram.minus(shader.space.needed, all));
            differ(shader, odd, stage, "is needed by one of table and proof only");
        }
        const auto recorded = shader.maps->merge_all(std::move(parts));
        if (!recorded) return say(shader.space.shader, "", "two classes of the proof claim the same variant");
        if (!shader.maps->merge(*recorded, stage.map))
            for (size_t c = 0; c < sets.size(); ++c) {
                const uint32_t module = proof.stages[index].classes[c].module;
                const Set astray = diagram.minus(diagram.both(sets[c], shader.space.needed), shader.variants_of(index, module));
                if (astray != Diagram::none())
                    differ(shader, astray, stage,
                           "does not resolve to module " + std::to_string(module) + ", which the proof records");
            }
        for (size_t c = 0; c < sets.size(); ++c) texts(shader, proof.stages[index].classes[c], sets[c], stage);
    }

    void differ(TableShader& shader, Set set, const TableStage& stage, const std::string& why) {
        const auto witness = shader.space.diagram->witness(set);
        const Set care = shader.space.diagram->either(shader.space.needed, set);
        say(shader.space.shader, witness ? shader.space.describe_variant(*witness) : "",
            std::string(name_of(stage.stage)) + " " + why + ", " + describe_condition(shader.space, set, care));
    }

    void texts(TableShader& shader, const ProofClass& c, Set set, const TableStage& stage) {
        if (!seen_.insert({shader.raw.index, c.module}).second) return;
        const std::vector<TableText> texts = table_.texts(shader, c.module);
        size_t next = 0;
        for (size_t t = 0; t < table_.targets().size(); ++t) {
            if (table_.targets()[t] == Target::spirv) continue;
            const TableText& text = texts[next++];
            std::optional<Digest> found;
            if (text.artifact) found = digest_of(*text.artifact);
            if (t >= c.artifacts.size() || found != c.artifacts[t])
                differ(shader, set, stage, std::string("has another ") + name_of(text.target) + " text than the proof records");
        }
    }

    Digest digest_of(uint32_t artifact) {
        const auto known = digests_.find(artifact);
        if (known != digests_.end()) return known->second;
        return digests_[artifact] = sha256(as_bytes(table_.text(artifact)));
    }

    TableView& table_;
    Proof& proof_;
    std::vector<ProofMismatch> out_;
    std::set<std::pair<uint32_t, uint32_t>> seen_;
    std::map<uint32_t, Digest> digests_;
};

}  // namespace

std::vector<ProofMismatch> check_proof(TableView& table, Proof& proof) { return Checker(table, proof).run(); }

}  // namespace kiln
