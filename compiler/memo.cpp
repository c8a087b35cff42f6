// The list of files sits in an action record under K1; the result, which can be large, is a blob that the action record under
// K2 names. A damaged record reads as absent, so a memo can cost time but never give a wrong result.
#include "compiler/memo.h"

#include "compiler/space/set_wire.h"

namespace kiln {

namespace {

Digest second_key(const Digest& asked, ByteView list) {
    KeyHasher hasher("kiln.memo.v1");
    hasher.field("asked", asked).field("list", list);
    return hasher.finish();
}

bool still_holds(Files& files, const SourceRead& read) {
    const auto text = files.read(read.path);
    if (!text.ok()) return false;
    if (!text->has_value()) return !read.present;
    return read.present && sha256(as_bytes(**text)) == read.digest;
}

void write_place(WireWriter& out, const Place& place, const std::string& folder) {
    out.text(relative_path(folder, place.file));
    out.u32(place.line);
    out.u32(place.column);
}

Place read_place(WireReader& in, const std::string& folder) {
    Place place;
    place.file = in.text();
    if (!place.file.empty()) place.file = join_path(folder, place.file);
    place.line = in.u32();
    place.column = in.u32();
    return place;
}

void write_reads(WireWriter& out, const std::vector<SourceRead>& reads, const std::string& folder) {
    out.u64(reads.size());
    for (const SourceRead& read : reads) {
        out.text(relative_path(folder, read.path));
        out.u8(read.present ? 1 : 0);
        out.raw(read.digest.bytes);
    }
}

bool read_reads(WireReader& in, std::vector<SourceRead>& reads, const std::string& folder) {
    const size_t count = in.count(8 + 1 + 32);
    for (size_t i = 0; i < count && in.ok(); ++i) {
        SourceRead read;
        read.path = join_path(folder, in.text());
        const uint8_t present = in.u8();
        if (present > 1) in.fail();
        read.present = present == 1;
        const ByteView digest = in.raw(32);
        std::copy(digest.begin(), digest.end(), read.digest.bytes.begin());
        reads.push_back(std::move(read));
    }
    return in.ok();
}

}  // namespace

std::optional<Bytes> recall(Store& store, Files& files, const std::string& folder, const Digest& asked,
                            std::vector<SourceRead>& reads) {
    const auto list = store.get(Keyspace::action, asked);
    if (!list.ok() || !list->has_value()) return std::nullopt;
    WireReader in(**list);
    std::vector<SourceRead> found;
    if (!read_reads(in, found, folder) || !in.at_end()) return std::nullopt;
    for (const SourceRead& read : found)
        if (!still_holds(files, read)) return std::nullopt;
    const auto record = store.get(Keyspace::action, second_key(asked, **list));
    if (!record.ok() || !record->has_value() || (*record)->size() != sizeof(Digest::bytes)) return std::nullopt;
    Digest name;
    std::copy((*record)->begin(), (*record)->end(), name.bytes.begin());
    auto result = store.get(Keyspace::blob, name);
    if (!result.ok() || !result->has_value()) return std::nullopt;
    reads = std::move(found);
    return std::move(**result);
}

Status remember(Store& store, const std::string& folder, const Digest& asked, const std::vector<SourceRead>& reads,
                ByteView result) {
    if (!store.keeps()) return {};
    WireWriter list;
    write_reads(list, reads, folder);
    const Digest name = sha256(result);
    KILN_TRY(store.put(Keyspace::blob, name, result));
    KILN_TRY(store.put(Keyspace::action, second_key(asked, list.view()), name.bytes));
    return store.put(Keyspace::action, asked, list.view());
}

void write_diags(WireWriter& out, const Diags& diags, const std::string& folder) {
    out.u64(diags.list().size());
    for (const Diag& d : diags.list()) {
        out.u8(static_cast<uint8_t>(d.severity));
        write_place(out, d.place, folder);
        out.text(d.message);
        out.text(d.source_line);
        out.u64(d.notes.size());
        for (const std::string& note : d.notes) out.text(note);
    }
}

bool read_diags(WireReader& in, Diags& diags, const std::string& folder) {
    const size_t count = in.count(1);
    for (size_t i = 0; i < count && in.ok(); ++i) {
        const uint8_t severity = in.u8();
        if (severity > static_cast<uint8_t>(Severity::error)) in.fail();
        const Place place = read_place(in, folder);
        const std::string message = in.text();
        const std::string source_line = in.text();
        std::vector<std::string> notes(in.count(8));
        for (std::string& note : notes) note = in.text();
        if (in.ok()) diags.add(static_cast<Severity>(severity), place, message, source_line).notes = std::move(notes);
    }
    return in.ok();
}

void write_split(WireWriter& out, const Split& split, const Space& space, const std::string& folder) {
    std::vector<Set> sets;
    for (const Class& c : split.classes) sets.push_back(c.variants);
    write_sets(out, *space.diagram, sets);
    for (const Class& c : split.classes) {
        out.text(c.text);
        out.u64(c.places.size());
        for (const TextPlace& p : c.places) {
            out.u32(p.file);
            out.u32(p.line);
            out.u32(p.column);
        }
    }
    out.u64(split.files.size());
    for (const std::string& file : split.files) out.text(file);
    out.u64(split.axes_read.size());
    for (const uint32_t axis : split.axes_read) out.u32(axis);
    write_diags(out, split.diags, folder);
    out.u64(split.states);
}

bool read_split(WireReader& in, Split& split, Space& space, const std::string& folder) {
    std::vector<Set> sets;
    if (!read_sets(in, *space.diagram, sets)) return false;
    for (const Set s : sets) {
        Class c;
        c.variants = s;
        c.text = in.text();
        c.places.resize(in.count(12));
        for (TextPlace& p : c.places) {
            p.file = in.u32();
            p.line = in.u32();
            p.column = in.u32();
        }
        split.classes.push_back(std::move(c));
    }
    split.files.resize(in.count(8));
    for (std::string& file : split.files) file = in.text();
    split.axes_read.resize(in.count(4));
    for (uint32_t& axis : split.axes_read) axis = in.u32();
    if (!read_diags(in, split.diags, folder)) return false;
    split.states = in.u64();
    for (const Class& c : split.classes)
        for (const TextPlace& p : c.places)
            if (p.file >= split.files.size()) in.fail();
    for (const uint32_t axis : split.axes_read)
        if (axis >= space.axes.size()) in.fail();
    return in.ok() && in.at_end();
}

}  // namespace kiln
