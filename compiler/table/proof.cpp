// Conditions are written as sets of the space's own diagram, so that checking is set algebra: two maps agree on every needed
// variant exactly when merging them meets no contradiction. Nothing is sampled and nothing is enumerated.

#include "compiler/table/proof.h"

#include <algorithm>

#include "compiler/base/wire.h"
#include "compiler/space/set_wire.h"

namespace kiln {

namespace {

constexpr std::string_view magic = "KILNPRF\n";
constexpr uint32_t version = 1;
constexpr size_t digest_size = 32;

void put(WireWriter& out, const Digest& digest) { out.raw(digest.bytes); }

Digest take_digest(WireReader& in) {
    Digest out;
    const ByteView bytes = in.raw(digest_size);
    if (bytes.size() == digest_size) std::copy(bytes.begin(), bytes.end(), out.bytes.begin());
    return out;
}

void write_classes(WireWriter& out, const TableInput& input, size_t stage, uint32_t shader, const std::vector<Digest>& texts) {
    const auto& classes = input.stages[stage].split->classes;
    const auto& of = input.artifacts->of;
    out.u8(static_cast<uint8_t>(input.stages[stage].stage));
    std::vector<Set> sets;
    for (const Class& c : classes) sets.push_back(c.variants);
    write_sets(out, *input.stages[stage].space->diagram, sets);
    out.u64(classes.size());
    for (size_t c = 0; c < classes.size(); ++c) {
        const uint32_t module = input.modules->of_class[stage][c];
        out.u32(module);
        out.u64(input.targets.size());
        for (size_t t = 0; t < input.targets.size(); ++t) {
            uint32_t artifact = no_artifact;
            if (input.targets[t] != Target::spirv && shader < of.size() && t < of[shader].size() && module < of[shader][t].size())
                artifact = of[shader][t][module];
            out.u8(artifact == no_artifact ? 0 : 1);
            if (artifact != no_artifact) put(out, texts[artifact]);
        }
    }
}

bool read_module(WireReader& in, ProofModule& module) {
    module.digest = take_digest(in);
    const ByteView words = in.bytes();
    if (words.size() % 4 != 0) return false;
    module.unoptimised.resize(words.size() / 4);
    if (!words.empty()) std::memcpy(module.unoptimised.data(), words.data(), words.size());
    return in.ok();
}

bool read_stage(WireReader& in, ProofStage& stage, Diagram& diagram, size_t modules) {
    const uint8_t number = in.u8();
    if (number >= stage_count) return false;
    stage.stage = static_cast<Stage>(number);
    std::vector<Set> sets;
    if (!read_sets(in, diagram, sets)) return false;
    const size_t classes = in.count(12);
    if (!in.ok() || classes != sets.size()) return false;
    for (size_t c = 0; c < classes; ++c) {
        ProofClass out;
        out.variants = sets[c];
        out.module = in.u32();
        if (out.module >= modules) return false;
        const size_t artifacts = in.count(1);
        for (size_t a = 0; a < artifacts; ++a) {
            const uint8_t there = in.u8();
            if (there > 1) return false;
            out.artifacts.push_back(there == 1 ? std::optional(take_digest(in)) : std::nullopt);
        }
        stage.classes.push_back(std::move(out));
    }
    return in.ok();
}

bool read_shader(WireReader& in, ProofShader& shader, size_t modules) {
    shader.name = in.text();
    const size_t axes = in.count(8);
    if (axes > 65534) return false;
    std::vector<uint32_t> radices, order;
    for (size_t i = 0; i < axes; ++i) radices.push_back(in.u32());
    for (size_t i = 0; i < axes; ++i) order.push_back(in.u32());
    std::vector<bool> seen(axes);
    for (const uint32_t axis : order) {
        if (axis >= axes || seen[axis]) return false;
        seen[axis] = true;
    }
    for (const uint32_t radix : radices)
        if (radix == 0 || radix > 65535) return false;
    if (!in.ok()) return false;
    shader.diagram = std::make_unique<Diagram>(std::move(radices), std::move(order));
    const size_t stages = in.count(1);
    for (size_t i = 0; i < stages; ++i) {
        shader.stages.emplace_back();
        if (!read_stage(in, shader.stages.back(), *shader.diagram, modules)) return false;
    }
    return in.ok() && !shader.diagram->exhausted();
}

}  // namespace

Bytes write_proof(const TableInput& input, ByteView table) {
    WireWriter out;
    out.raw(as_bytes(magic));
    out.u32(version);
    put(out, sha256(table));
    out.u64(input.modules->list.size());
    for (const Module& m : input.modules->list) {
        put(out, m.digest);
        out.bytes(as_bytes(WordView(m.unoptimised)));
    }
    std::vector<Digest> texts;
    for (const Artifacts::Text& t : input.artifacts->list) texts.push_back(sha256(as_bytes(t.text)));
    const auto shaders = stages_by_shader(input.stages);
    out.u64(shaders.size());
    for (uint32_t i = 0; i < shaders.size(); ++i) {
        const Space& space = *input.stages[shaders[i][0]].space;
        out.text(space.shader);
        out.u64(space.diagram->radices().size());
        for (const uint32_t radix : space.diagram->radices()) out.u32(radix);
        for (const uint32_t axis : space.diagram->order()) out.u32(axis);
        out.u64(shaders[i].size());
        for (const size_t stage : shaders[i]) write_classes(out, input, stage, i, texts);
    }
    put(out, sha256(out.view()));
    return out.take();
}

Result<Proof> read_proof(ByteView bytes, ByteView table) {
    if (bytes.size() < magic.size() + 4 || as_text(bytes.first(magic.size())) != magic)
        return input_error("this is not the proof of a kiln table");
    WireReader in(bytes.subspan(magic.size()));
    const uint32_t found = in.u32();
    if (found > version) return input_error("this proof was written by a newer version of kiln");
    if (found != version || bytes.size() < magic.size() + 4 + 2 * digest_size)
        return input_error("the proof is cut short or damaged");
    const ByteView checked = bytes.first(bytes.size() - digest_size);
    const Digest sum = sha256(checked);
    if (!std::equal(sum.bytes.begin(), sum.bytes.end(), bytes.end() - digest_size))
        return input_error("the proof is cut short or damaged");
    Proof proof;
    proof.table = take_digest(in);
    if (proof.table != sha256(table)) return input_error("this proof belongs to another table");
    const size_t modules = in.count(digest_size + 8);
    bool sound = true;
    for (size_t i = 0; i < modules && sound; ++i) {
        proof.modules.emplace_back();
        sound = read_module(in, proof.modules.back());
    }
    const size_t shaders = sound ? in.count(16) : 0;
    for (size_t i = 0; i < shaders && sound; ++i) {
        proof.shaders.emplace_back();
        sound = read_shader(in, proof.shaders.back(), proof.modules.size());
    }
    if (!sound || !in.ok() || in.left() != digest_size) return input_error("the proof is malformed");
    return proof;
}

}  // namespace kiln
