// kiln diff: two tables compared by names; exact counts, nothing enumerated.
#include "compiler/table/table_diff.h"
#include "tools/console.h"
#include "tools/json.h"
#include "tools/session.h"
#include "tools/table_file.h"
#include "tools/verbs.h"

namespace kiln {

namespace {

std::string as_json(const TableDiff& diff) {
    Json json;
    json.object().key("same").boolean(diff.same());
    const auto pair = [&](const char* name, uint64_t before, uint64_t after) {
        json.key(name).object().number("before", before).number("after", after).end();
    };
    pair("bytes", diff.bytes_before, diff.bytes_after);
    pair("modules", diff.modules_before, diff.modules_after);
    pair("spirv_bytes", diff.spirv_before, diff.spirv_after);
    pair("packed_bytes", diff.packed_before, diff.packed_after);
    json.key("targets_lost").array();
    for (const Target t : diff.targets_lost) json.text(name_of(t));
    json.end().key("targets_added").array();
    for (const Target t : diff.targets_added) json.text(name_of(t));
    json.end().key("shaders").array();
    for (const DiffShader& s : diff.shaders) {
        json.object().text("name", s.name).key("only_before").boolean(s.only_before).key("only_after").boolean(s.only_after);
        json.text("before", s.before.decimal()).text("after", s.after.decimal());
        json.text("added", s.added.decimal()).text("lost", s.lost.decimal()).text("changed", s.changed.decimal());
        json.text("added_when", s.added_when).text("lost_when", s.lost_when).text("changed_when", s.changed_when);
        json.key("axes_lost").array();
        for (const std::string& axis : s.axes_lost) json.text(axis);
        json.end().key("axes_added").array();
        for (const std::string& axis : s.axes_added) json.text(axis);
        json.end().key("axes").array();
        for (const DiffAxis& axis : s.axes) {
            json.object().text("name", axis.name).key("values").array();
            for (const DiffValue& v : axis.values) {
                json.object().text("name", v.name).text("before", v.before.decimal()).text("after", v.after.decimal());
                json.number("modules_before", uint64_t{v.modules_before}).number("modules_after", uint64_t{v.modules_after});
                json.number("bytes_before", v.bytes_before).number("bytes_after", v.bytes_after).end();
            }
            json.end().end();
        }
        json.end().end();
    }
    json.end().end();
    return json.take();
}

int run_diff(const Args& args) {
    DiskFiles files;
    auto before = open_table(files, args.words()[0]);
    if (!before.ok()) return print_error(before.error());
    auto after = open_table(files, args.words()[1]);
    if (!after.ok()) return print_error(after.error());
    const TableDiff diff = diff_tables(**before, **after);
    return finish(args.has("--json") ? as_json(diff) : render(diff));
}

}  // namespace

const Verb verb_diff{"diff",
                     "A.kiln B.kiln [--json]",
                     "show what B has that A has not: variants added, lost, changed; size and count by axis",
                     2,
                     2,
                     {option_json},
                     "kiln diff old/surface.kiln surface.kiln",
                     run_diff};

}  // namespace kiln
