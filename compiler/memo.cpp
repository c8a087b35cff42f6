// The chain of records (memo.h). A record never says anything that the bytes its key was made of do not decide, except how many
// names it adds at a time; so two builds that write the same key write what serves both, and a store may keep the first.
//
//     record = u8 0: more   n * text                                   names, relative to the folder
//            | u8 1: found  32 bytes, name of the result's blob; n * text, which of the names were read
//
// A damaged record reads as absent, so a memo can cost time but never give a wrong result.
#include "compiler/memo.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "compiler/space/set_wire.h"

namespace kiln {

namespace {

constexpr size_t most_steps = 64;
constexpr size_t most_names = 100'000;

// What the walk along a chain has seen: files as they are now, by their names in records.
struct Seen {
    std::map<std::string, SourceRead> files;
    Digest key;
};

struct Record {
    bool found = false;
    Digest result;
    std::vector<std::string> names;
};

Bytes write_record(const Record& record) {
    WireWriter out;
    out.u8(record.found ? 1 : 0);
    if (record.found) out.raw(record.result.bytes);
    out.u64(record.names.size());
    for (const std::string& name : record.names) out.text(name);
    return out.take();
}

std::optional<Record> read_record(ByteView bytes) {
    WireReader in(bytes);
    Record record;
    const uint8_t kind = in.u8();
    record.found = kind == 1;
    if (record.found) {
        const ByteView name = in.raw(record.result.bytes.size());
        std::copy(name.begin(), name.end(), record.result.bytes.begin());
    }
    const size_t count = in.count(8);
    if (count > most_names) in.fail();
    for (size_t i = 0; i < count && in.ok(); ++i) {
        record.names.push_back(in.text());
        if (record.names.back().empty() || record.names.back().find('\0') != std::string::npos) in.fail();
    }
    if (!in.ok() || !in.at_end() || kind > 1 || (kind == 0 && count == 0)) return std::nullopt;
    return record;
}

std::optional<Record> get_record(Store& store, const Digest& key) {
    const auto bytes = store.get(Keyspace::action, key);
    if (!bytes.ok() || !bytes->has_value()) return std::nullopt;
    return read_record(**bytes);
}

// Adds files to what was seen; false when one was seen before or cannot be read.
bool look_at(Seen& seen, const std::vector<SourceRead>& files, const std::string& folder) {
    WireWriter list;
    for (const SourceRead& file : files) {
        const std::string name = relative_path(folder, file.path);
        if (!seen.files.emplace(name, file).second) return false;
        list.text(name);
        list.u8(file.present ? 1 : 0);
        list.raw(file.digest.bytes);
    }
    KeyHasher hasher("kiln.memo.v2");
    hasher.field("so far", seen.key).field("list", list.view());
    seen.key = hasher.finish();
    return true;
}

// A record may come from a server that nobody vouches for, so what it names must be plain files: reading a device or a pipe may
// have no end.
bool special(const std::string& path) {
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    return std::filesystem::is_other(status);
}

std::optional<SourceRead> now(Files& files, const std::string& path) {
    if (special(path)) return std::nullopt;
    const auto text = files.read(path);
    if (!text.ok()) return std::nullopt;
    SourceRead read;
    read.path = path;
    read.present = text->has_value();
    if (read.present) read.digest = sha256(as_bytes(**text));
    return read;
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

}  // namespace

std::optional<Bytes> recall(Store& store, Files& files, const std::string& folder, const Digest& asked,
                            std::vector<SourceRead>& reads) {
    Seen seen;
    seen.key = asked;
    for (size_t step = 0; step < most_steps; ++step) {
        const std::optional<Record> record = get_record(store, seen.key);
        if (!record) return std::nullopt;
        if (record->found) {
            std::vector<SourceRead> used;
            for (const std::string& name : record->names) {
                const auto file = seen.files.find(name);
                if (file == seen.files.end()) return std::nullopt;
                used.push_back(file->second);
            }
            auto result = store.get(Keyspace::blob, record->result);
            if (!result.ok() || !result->has_value()) return std::nullopt;
            reads = std::move(used);
            return std::move(**result);
        }
        std::vector<SourceRead> more;
        for (const std::string& name : record->names) {
            auto file = now(files, join_path(folder, name));
            if (!file) return std::nullopt;
            more.push_back(std::move(*file));
        }
        if (!look_at(seen, more, folder)) return std::nullopt;
    }
    return std::nullopt;
}

Status remember(Store& store, Files& files, const std::string& folder, const Digest& asked, const std::vector<SourceRead>& reads,
                ByteView result) {
    if (!store.keeps()) return {};
    std::map<std::string, SourceRead> left;  // as they were when they were read, whatever they are now
    Record final{true, sha256(result), {}};
    for (const SourceRead& read : reads)
        if (left.emplace(relative_path(folder, read.path), read).second) final.names.push_back(relative_path(folder, read.path));
    Seen seen;
    seen.key = asked;
    for (size_t step = 0; step < most_steps && !left.empty(); ++step) {
        const std::optional<Record> there = get_record(store, seen.key);
        std::vector<SourceRead> more;
        for (const std::string& name : there && !there->found ? there->names : std::vector<std::string>()) {
            const auto own = left.find(name);
            auto file = own != left.end() ? std::optional(own->second) : now(files, join_path(folder, name));
            if (!file) return {};
            more.push_back(std::move(*file));
        }
        if (more.empty()) {
            Record rest;
            for (const std::string& name : final.names)
                if (const auto own = left.find(name); own != left.end()) {
                    rest.names.push_back(name);
                    more.push_back(own->second);
                }
            KILN_TRY(store.put(Keyspace::action, seen.key, write_record(rest)));
        }
        if (!look_at(seen, more, folder)) return {};
        for (const SourceRead& file : more) left.erase(relative_path(folder, file.path));
    }
    if (!left.empty()) return {};
    KILN_TRY(store.put(Keyspace::blob, final.result, result));
    return store.put_record(seen.key, write_record(final), {&final.result, 1});
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
    for (const Class& c : split.classes) {
        if (static_cast<size_t>(std::count(c.text.begin(), c.text.end(), '\n')) != c.places.size()) in.fail();
        for (const TextPlace& p : c.places)
            if (p.file >= split.files.size() || p.line == 0) in.fail();
    }
    for (const uint32_t axis : split.axes_read)
        if (axis >= space.axes.size()) in.fail();
    return in.ok() && in.at_end() && partition(split.classes, *space.diagram, space.needed);
}

}  // namespace kiln
