#pragma once
// What a build remembers of its inputs: a chain of records. What was asked names a list of files; that and what these files hold
// now names more files, and so on until the result is named (ARCHITECTURE.md, Cache). As in ccache's direct mode, but that
// nothing is ever replaced: two branches share a store, and a server may refuse to change a record that it has.

#include <optional>
#include <vector>

#include "compiler/base/files.h"
#include "compiler/base/store.h"
#include "compiler/base/wire.h"
#include "compiler/split/split.h"

namespace kiln {

// Records name files relative to `folder` (the manifest's), so that two checkouts that share a store never answer for each
// other's files; paths given and returned are as opened.

// The result remembered for `asked` and the files as they are now. `reads` receives those that it depends on.
std::optional<Bytes> recall(Store& store, Files& files, const std::string& folder, const Digest& asked,
                            std::vector<SourceRead>& reads);

// Remembers `result` under `asked` and the files it depended on. Store failures are returned, not reported.
Status remember(Store& store, Files& files, const std::string& folder, const Digest& asked, const std::vector<SourceRead>& reads,
                ByteView result);

void write_diags(WireWriter& out, const Diags& diags, const std::string& folder);
bool read_diags(WireReader& in, Diags& diags, const std::string& folder);

// One stage's classes as bytes. `space` gives and checks the diagram; what is read partitions its needed variants, and every line
// of a class has a place in one of the files.
void write_split(WireWriter& out, const Split& split, const Space& space, const std::string& folder);
bool read_split(WireReader& in, Split& split, Space& space, const std::string& folder);

}  // namespace kiln
