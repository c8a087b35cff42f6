// What a build takes from a store that a server may have filled, from arbitrary bytes: the chain of records, diagnostics, the
// classes of a stage, and a module's record behind a right checksum. The first byte says which.
#include "compiler/memo.h"

#include <algorithm>
#include <cstdlib>

#include "compiler/modules/module_record.h"

namespace {

using namespace kiln;

// Answers every question with the same bytes.
class Parrot final : public Store {
public:
    explicit Parrot(ByteView bytes) : bytes_(bytes.begin(), bytes.end()) {}
    Result<std::optional<Bytes>> get(Keyspace, const Digest&) override {
        if (++asked_ > 1000) std::abort();  // a chain without end
        return std::optional<Bytes>(bytes_);
    }
    Status put(Keyspace, const Digest&, ByteView) override { return {}; }

private:
    Bytes bytes_;
    size_t asked_ = 0;
};

std::unique_ptr<Space> small_space() {
    Manifest manifest;
    for (const char* name : {"a", "b"}) {
        Axis axis;
        axis.name = axis.macro = name;
        axis.kind = AxisKind::boolean;
        axis.values = {{"false", 0}, {"true", 1}};
        manifest.axes.push_back(axis);
    }
    Shader shader;
    shader.name = "s";
    shader.axes = {0, 1};
    manifest.shaders.push_back(shader);
    Diags diags;
    return build_space(manifest, manifest.shaders.front(), diags);
}

void read_classes(WireReader in) {
    const auto space = small_space();
    Split split;
    if (!read_split(in, split, *space, "f")) return;
    for (const Class& c : split.classes)
        for (const TextPlace& place : c.places)
            if (place.file >= split.files.size()) std::abort();
    if (!partition(split.classes, *space->diagram, space->needed)) std::abort();
    WireWriter again;
    write_split(again, split, *space, "f");
    WireReader second(again.view());
    Split same;
    if (!read_split(second, same, *space, "f") || same.classes.size() != split.classes.size()) std::abort();
}

void read_module(ByteView bytes) {
    const Digest key{};
    WireWriter out;
    out.text("kiln.module.v1");
    out.raw(key.bytes);
    out.raw(bytes);
    const Fast sum = xxh3(out.view());
    out.u64(sum.low);
    out.u64(sum.high);
    if (const auto record = read_module_record(key, out.view())) static_cast<void>(write_module_record(key, *record));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size == 0) return 0;
    const ByteView bytes(data + 1, size - 1);
    switch (data[0] % 4) {
        case 0: {
            Parrot store(bytes);
            MemoryFiles files;
            files.files["f/x"] = "x";
            std::vector<SourceRead> reads;
            static_cast<void>(recall(store, files, "f", Digest{}, reads));
            break;
        }
        case 1: {
            Diags diags;
            WireReader in(bytes);
            static_cast<void>(read_diags(in, diags, "f"));
            break;
        }
        case 2:
            read_classes(WireReader(bytes));
            break;
        default:
            read_module(bytes);
    }
    return 0;
}
