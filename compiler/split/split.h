#pragma once
// The splitting preprocessor (ARCHITECTURE.md, Classes): preprocesses one stage once with every axis macro open, and returns the
// classes: the distinct token streams and exactly which variants have each.
//
// The rules are those of glslang 12 for Vulkan GLSL, with these departures. Refused here: an identifier that nothing defines
// in an evaluated operand of a live #if (unless the options say zero); conditionals that do not balance within one file; an
// identifier joined by ## to an operator; bytes outside ASCII outside comments. Accepted here: #include without an extension
// line; #pragma once; a directive that the file ends in without a newline; a byte order mark. Left to the compiler: whether
// an extension, a version or a literal's suffix is supported.

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/base/digest.h"
#include "compiler/space/space.h"

namespace kiln {

struct TextPlace {
    uint32_t file = 0;    // index into Split::files
    uint32_t line = 0;    // from 1
    uint32_t column = 0;  // from 1, bytes
};

// The variants of one stage that preprocess to the same tokens.
struct Class {
    Set variants;                   // within the set that was split; the classes partition it
    std::string text;               // one token a line; live #version, #extension and #pragma lines as written
    std::vector<TextPlace> places;  // one per line of `text`
};

struct SourceRead {
    std::string path;      // as opened
    bool present = false;  // false: probed along the search path and absent
    Digest digest;         // of the bytes, when present
};

struct Split {
    std::vector<Class> classes;       // ordered by smallest member variant
    std::vector<std::string> files;   // names relative to the manifest's folder
    std::vector<SourceRead> reads;    // in the order first asked, no repeats
    std::vector<uint32_t> axes_read;  // axes that some test or expansion looked at, ascending
    Diags diags;                      // with the condition of ARCHITECTURE.md, Errors as a note; source lines filled in
    uint64_t states = 0;              // preprocessor states made; bounded by `max_states`
    uint64_t lexed = 0;               // files lexed
};

struct SplitOptions {
    uint64_t max_states = 100'000;
    bool lines = false;  // -g: keep file and line of every token in the class text (#line), so layout splits classes
};

// True when the classes are disjoint, none is empty, and together they are `whole`.
bool partition(const std::vector<Class>& classes, Diagram& diagram, Set whole);

// No classes and no error when `interrupted` is set meanwhile. `start` is the set to split (needed variants). `stage.file` is
// found as an include of the manifest would be.
Split split_stage(const Manifest& manifest, const Shader& shader, const StageFile& stage, Space& space, Set start, Files& files,
                  const SplitOptions& options);

}  // namespace kiln
