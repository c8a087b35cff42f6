#include "compiler/batch/batch.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <set>

#include "compiler/base/wire.h"
#include "compiler/modules/module_record.h"
#include "compiler/toolchain/messages.h"
#include "compiler/translate/translate_record.h"

namespace kiln {
namespace {

constexpr const char* batch_mark = "kiln.batch.v1";
constexpr const char* answers_mark = "kiln.answers.v1";

enum class Kind : uint8_t { module, artifact };

void write_digest(WireWriter& out, const Digest& digest) { out.raw(digest.bytes); }

Digest read_digest(WireReader& in) {
    Digest out;
    const ByteView bytes = in.raw(out.bytes.size());
    std::copy(bytes.begin(), bytes.end(), out.bytes.begin());
    return out;
}

Bytes seal(WireWriter out) {
    const Fast sum = xxh3(out.view());
    out.u64(sum.low);
    out.u64(sum.high);
    return out.take();
}

// The bytes between mark and checksum.
std::optional<WireReader> open(ByteView bytes, std::string_view mark) {
    constexpr size_t sum_bytes = 16;
    if (bytes.size() < sum_bytes) return std::nullopt;
    const ByteView body = bytes.first(bytes.size() - sum_bytes);
    WireReader sum(bytes.subspan(body.size()));
    const uint64_t low = sum.u64(), high = sum.u64();
    if (xxh3(body) != Fast{low, high}) return std::nullopt;
    WireReader in(body);
    if (in.text() != mark) return std::nullopt;
    return in;
}

void write_options(WireWriter& out, const Options& options) {
    out.u8(static_cast<uint8_t>(options.undefined_macros));
    out.u8(static_cast<uint8_t>(options.optimise));
    out.u32(options.vulkan);
    out.u32(options.spirv);
    out.u8(options.debug ? 1 : 0);
}

Options read_options(WireReader& in) {
    Options out;
    const uint8_t undefined = in.u8();
    if (undefined > static_cast<uint8_t>(UndefinedMacros::zero)) in.fail();
    out.undefined_macros = static_cast<UndefinedMacros>(undefined);
    const uint8_t optimise = in.u8();
    if (optimise > static_cast<uint8_t>(Optimise::size)) in.fail();
    out.optimise = static_cast<Optimise>(optimise);
    out.vulkan = in.u32();
    out.spirv = in.u32();
    out.debug = in.u8() != 0;
    return out;
}

void write_layout(WireWriter& out, const SlotLayout& layout) {
    out.u64(layout.slots.size());
    for (const Slot& s : layout.slots) {
        out.u8(static_cast<uint8_t>(s.kind));
        out.text(s.name);
        for (const uint32_t n :
             {s.set, s.binding, s.buffer, s.texture, s.sampler, s.image, s.uav, s.metal_buffer, s.metal_texture, s.unit_offset})
            out.u32(n);
        out.u8(s.by_stage ? 1 : 0);
    }
    out.u64(layout.interpolation.size());
    for (const Interpolation& i : layout.interpolation) {
        out.u32(i.location);
        for (const bool b : {i.flat, i.no_perspective, i.centroid, i.sample}) out.u8(b ? 1 : 0);
    }
    out.u8(layout.flat_blocks ? 1 : 0);
    out.u8(static_cast<uint8_t>(layout.rasterised));
}

Stage read_stage(WireReader& in) {
    const uint8_t stage = in.u8();
    if (stage > static_cast<uint8_t>(Stage::callable)) in.fail();
    return static_cast<Stage>(stage);
}

SlotLayout read_layout(WireReader& in) {
    SlotLayout out;
    for (size_t n = in.count(40); n > 0 && in.ok(); --n) {
        Slot s;
        const uint8_t kind = in.u8();
        if (kind > static_cast<uint8_t>(ResourceKind::push_constants)) in.fail();
        s.kind = static_cast<ResourceKind>(kind);
        s.name = in.text();
        for (uint32_t* field : {&s.set, &s.binding, &s.buffer, &s.texture, &s.sampler, &s.image, &s.uav, &s.metal_buffer,
                                &s.metal_texture, &s.unit_offset})
            *field = in.u32();
        s.by_stage = in.u8() != 0;
        out.slots.push_back(std::move(s));
    }
    for (size_t n = in.count(8); n > 0 && in.ok(); --n) {
        Interpolation i;
        i.location = in.u32();
        for (bool* field : {&i.flat, &i.no_perspective, &i.centroid, &i.sample}) *field = in.u8() != 0;
        out.interpolation.push_back(i);
    }
    out.flat_blocks = in.u8() != 0;
    out.rasterised = read_stage(in);
    return out;
}

Words words_of(ByteView bytes) {
    Words out(bytes.size() / sizeof(uint32_t));
    if (!out.empty()) std::memcpy(out.data(), bytes.data(), out.size() * sizeof(uint32_t));
    return out;
}

// Collects the answers of one batch.
class Answers {
public:
    Digest blob(ByteView bytes) {
        const Digest name = sha256(bytes);
        const std::lock_guard lock(mutex_);
        blobs_.try_emplace(name, bytes.begin(), bytes.end());
        return name;
    }
    void record(Kind kind, const Digest& action, Bytes bytes) {
        const std::lock_guard lock(mutex_);
        records_[action] = {kind, std::move(bytes)};
    }
    Bytes seal() const {
        WireWriter out;
        out.text(answers_mark);
        out.u64(blobs_.size());
        for (const auto& [name, bytes] : blobs_) out.bytes(bytes);
        out.u64(records_.size());
        for (const auto& [action, record] : records_) {
            out.u8(static_cast<uint8_t>(record.first));
            write_digest(out, action);
            out.bytes(record.second);
        }
        return kiln::seal(std::move(out));
    }

private:
    std::mutex mutex_;
    std::map<Digest, Bytes> blobs_;
    std::map<Digest, std::pair<Kind, Bytes>> records_;
};

// As compiler/modules/modules.cpp does it for one class.
void answer_module(const ModuleQuestion& question, Toolchain& tools, Answers& answers) {
    ModuleRecord record;
    Compiled compiled = tools.compile(question.stage, question.text, question.options);
    if (has_error(compiled.messages)) return;
    record.messages = std::move(compiled.messages);
    record.raw = sha256(as_bytes(WordView(compiled.words)));
    const Result<Words> pruned = tools.prune(compiled.words, question.options);
    if (!pruned.ok()) return;
    const Result<Words> final = tools.optimise(*pruned, question.options);
    if (!final.ok() || has_error(tools.validate(*final, question.options))) return;
    Result<Reflection> reflection = tools.reflect(*final);
    if (!reflection.ok()) return;
    record.reflection = std::move(*reflection);
    record.pruned = answers.blob(as_bytes(WordView(*pruned)));
    record.module = answers.blob(as_bytes(WordView(*final)));
    answers.record(Kind::module, question.action, write_module_record(question.action, record));
}

void answer_artifact(const ArtifactQuestion& question, Toolchain& tools, Answers& answers) {
    const std::vector<Translated> texts = tools.translate(question.words, question.targets, *question.slots);
    for (size_t t = 0; t < texts.size() && t < question.actions.size(); ++t) {
        ArtifactRecord record;
        record.refusal = texts[t].refusal;
        if (record.refusal.empty()) {
            if (texts[t].text.empty()) continue;
            record.text = answers.blob(as_bytes(texts[t].text));
        }
        answers.record(Kind::artifact, question.actions[t], write_artifact_record(question.actions[t], record));
    }
}

}  // namespace

Bytes write_batch(const std::string& identity, std::span<const ModuleQuestion> modules,
                  std::span<const ArtifactQuestion> artifacts) {
    WireWriter out;
    out.text(batch_mark);
    out.text(identity);
    out.u64(modules.size());
    for (const ModuleQuestion& q : modules) {
        out.u8(static_cast<uint8_t>(q.stage));
        write_options(out, q.options);
        write_digest(out, q.action);
        out.text(q.text);
    }
    out.u64(artifacts.size());
    for (const ArtifactQuestion& q : artifacts) {
        out.bytes(as_bytes(q.words));
        write_layout(out, *q.slots);
        out.u64(q.targets.size());
        for (size_t t = 0; t < q.targets.size(); ++t) {
            out.u8(static_cast<uint8_t>(q.targets[t]));
            write_digest(out, q.actions[t]);
        }
    }
    return seal(std::move(out));
}

Result<Bytes> answer_batch(ByteView batch, Toolchain& tools, const Jobs& jobs) {
    std::optional<WireReader> in = open(batch, batch_mark);
    if (!in) return input_error("this is no batch of work, or it is damaged");
    if (in->text() != tools.identity())
        return environment_error(
            "the batch was made by another kiln than this worker's; install both together, or unset KILN_WORKER");
    std::vector<ModuleQuestion> modules;
    std::vector<std::string> texts;
    for (size_t n = in->count(60); n > 0 && in->ok(); --n) {
        ModuleQuestion q;
        q.stage = read_stage(*in);
        q.options = read_options(*in);
        q.action = read_digest(*in);
        q.text = as_text(in->bytes());
        modules.push_back(q);
    }
    std::vector<ArtifactQuestion> artifacts;
    const size_t count = in->count(40);
    std::vector<Words> words(count);
    std::vector<SlotLayout> layouts(count);
    for (size_t i = 0; i < count && in->ok(); ++i) {
        words[i] = words_of(in->bytes());
        layouts[i] = read_layout(*in);
        ArtifactQuestion q{words[i], &layouts[i], {}, {}};
        for (size_t n = in->count(33); n > 0 && in->ok(); --n) {
            const uint8_t target = in->u8();
            if (target >= target_count) in->fail();
            q.targets.push_back(static_cast<Target>(target));
            q.actions.push_back(read_digest(*in));
        }
        artifacts.push_back(std::move(q));
    }
    if (!in->ok() || !in->at_end()) return input_error("the batch of work is malformed");
    Answers answers;
    const bool complete = jobs.each(modules.size() + artifacts.size(), [&](size_t i) {
        if (i < modules.size())
            answer_module(modules[i], tools, answers);
        else
            answer_artifact(artifacts[i - modules.size()], tools, answers);
    });
    if (!complete) return environment_error("interrupted");
    return answers.seal();
}

Result<size_t> take_answers(ByteView bytes, std::span<const Digest> asked, Store& store) {
    std::optional<WireReader> in = open(bytes, answers_mark);
    if (!in) return input_error("what came back are no answers, or they are damaged");
    std::map<Digest, ByteView> blobs;
    for (size_t n = in->count(8); n > 0 && in->ok(); --n) {
        const ByteView blob = in->bytes();
        blobs.emplace(sha256(blob), blob);
    }
    const std::set<Digest> wanted(asked.begin(), asked.end());
    struct Taken {
        Digest action;
        Bytes record;
        std::vector<Digest> needs;
    };
    std::vector<Taken> taken;
    for (size_t n = in->count(41); n > 0 && in->ok(); --n) {
        const uint8_t kind = in->u8();
        Taken one{read_digest(*in), {}, {}};
        const ByteView record = in->bytes();
        one.record.assign(record.begin(), record.end());
        if (kind == static_cast<uint8_t>(Kind::module)) {
            const auto read = read_module_record(one.action, record);
            if (!read) continue;
            one.needs = {read->pruned, read->module};
        } else {
            const auto read = read_artifact_record(one.action, record);
            if (!read) continue;
            if (read->refusal.empty()) one.needs = {read->text};
        }
        const bool whole = std::all_of(one.needs.begin(), one.needs.end(), [&](const Digest& d) { return blobs.count(d) != 0; });
        if (whole && wanted.count(one.action) != 0) taken.push_back(std::move(one));
    }
    if (!in->ok() || !in->at_end()) return input_error("the answers are malformed");
    std::set<Digest> put;
    for (const Taken& one : taken) {
        for (const Digest& need : one.needs)
            if (put.insert(need).second) KILN_TRY(store.put(Keyspace::blob, need, blobs[need]));
        KILN_TRY(store.put_record(one.action, one.record, one.needs));
    }
    return taken.size();
}

}  // namespace kiln
