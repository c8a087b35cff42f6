// job     := "kiln.job.1" | stages optimised | stages unoptimised | u64 seed | u32 size
// stages  := n * (u8 stage | u8 partner | bytes words | reflection)
// verdict := "kiln.verdict.1" | u8 outcome | text why | u8 compared | u64 values, differing, nonfinite, covered | u64
// microseconds info    := "kiln.info.1" | text name, driver, layers, settings

#include "compiler/validate/check_wire.h"

#include <cstring>

#include "compiler/base/wire.h"
#include "compiler/reflect/reflect_wire.h"
#include "compiler/validate/inputs.h"

namespace kiln {

namespace {

constexpr size_t least_stage_bytes = 2 + 8;

void write_stages(WireWriter& out, const std::vector<StagePtr>& stages) {
    out.u64(stages.size());
    for (const StagePtr& s : stages) {
        out.u8(static_cast<uint8_t>(s->stage));
        out.u8(s->partner ? 1 : 0);
        out.bytes(as_bytes(WordView(s->words)));
        write_reflection(out, s->reflection);
    }
}

bool read_stages(WireReader& in, std::vector<StagePtr>& out) {
    for (size_t n = in.count(least_stage_bytes); n != 0 && in.ok(); --n) {
        auto stage = std::make_shared<StageCode>();
        const uint8_t number = in.u8();
        if (number >= stage_count) in.fail();
        stage->stage = static_cast<Stage>(number);
        stage->partner = in.u8() != 0;
        const ByteView words = in.bytes();
        if (words.size() % 4 != 0) in.fail();
        stage->words.resize(words.size() / 4);
        if (!words.empty()) std::memcpy(stage->words.data(), words.data(), words.size());
        if (!read_reflection(in, stage->reflection)) return false;
        out.push_back(std::move(stage));
    }
    return in.ok();
}

}  // namespace

Bytes encode(const CheckJob& job) {
    WireWriter out;
    out.text("kiln.job.1");
    write_stages(out, job.optimised);
    write_stages(out, job.unoptimised);
    out.u64(job.seed);
    out.u32(job.size);
    return out.take();
}

std::optional<CheckJob> decode_job(ByteView bytes) {
    WireReader in(bytes);
    CheckJob job;
    if (in.text() != "kiln.job.1" || !read_stages(in, job.optimised) || !read_stages(in, job.unoptimised)) return std::nullopt;
    job.seed = in.u64();
    job.size = in.u32();
    if (!in.ok() || !in.at_end() || job.size == 0 || job.size > 4096) return std::nullopt;
    return job;
}

Bytes encode(const Verdict& v) {
    WireWriter out;
    out.text("kiln.verdict.1");
    out.u8(static_cast<uint8_t>(v.outcome));
    out.text(v.why);
    out.u8(v.compared ? 1 : 0);
    for (const uint64_t n : {v.values, v.differing, v.nonfinite, v.covered, static_cast<uint64_t>(v.ms * 1000)}) out.u64(n);
    return out.take();
}

std::optional<Verdict> decode_verdict(ByteView bytes) {
    WireReader in(bytes);
    Verdict v;
    if (in.text() != "kiln.verdict.1") return std::nullopt;
    const uint8_t outcome = in.u8();
    if (outcome > static_cast<uint8_t>(Outcome::unsupported)) return std::nullopt;
    v.outcome = static_cast<Outcome>(outcome);
    v.why = in.text();
    v.compared = in.u8() != 0;
    for (uint64_t* n : {&v.values, &v.differing, &v.nonfinite, &v.covered}) *n = in.u64();
    v.ms = static_cast<double>(in.u64()) / 1000;
    if (!in.ok() || !in.at_end()) return std::nullopt;
    return v;
}

Bytes encode(const DeviceInfo& info) {
    WireWriter out;
    out.text("kiln.info.1");
    for (const std::string* s : {&info.name, &info.driver, &info.layers, &info.settings}) out.text(*s);
    return out.take();
}

std::optional<DeviceInfo> decode_info(ByteView bytes) {
    WireReader in(bytes);
    DeviceInfo info;
    if (in.text() != "kiln.info.1") return std::nullopt;
    for (std::string* s : {&info.name, &info.driver, &info.layers, &info.settings}) *s = in.text();
    if (!in.ok() || !in.at_end()) return std::nullopt;
    return info;
}

Digest verdict_key(const DeviceInfo& info, const CheckJob& job) {
    KeyHasher h("kiln.verdict.v1");
    h.field("device", encode(info)).field("policy", uint64_t{check_version}).field("inputs", uint64_t{inputs_version});
    return h.field("job", encode(job)).finish();
}

}  // namespace kiln
