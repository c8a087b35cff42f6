#pragma once
// The proof of a table (.kiln.proof), for validation and not shipped: one unoptimised representative per module, and per stage
// the conditions of its classes with the module and artifacts that the build resolved each to.
//
//   proof   := "KILNPRF\n" u32 version=1 table:digest body check:digest     check: SHA-256 of everything before it
//   body    := count module{count} count shader{count}
//   module  := digest(optimised words) bytes(unoptimised words)
//   shader  := text(name) count u32(radix){count} u32(axis){same} count stage{count}
//   stage   := u8(stage) sets count class{count}                            sets: set_wire.h, one a class
//   class   := u32(module) count artifact{count}                            one a target of the table
//   artifact:= u8(0: none) | u8(1) digest(text)

#include "compiler/base/digest.h"
#include "compiler/base/result.h"
#include "compiler/table/table.h"
#include "compiler/table/table_read.h"

namespace kiln {

struct ProofClass {
    Set variants;  // in the shader's diagram
    uint32_t module = 0;
    std::vector<std::optional<Digest>> artifacts;  // of the text, one a target of the table
};

struct ProofStage {
    Stage stage = Stage::vertex;
    std::vector<ProofClass> classes;
};

struct ProofShader {
    std::string name;
    std::unique_ptr<Diagram> diagram;
    std::vector<ProofStage> stages;
};

struct ProofModule {
    Digest digest;      // of the optimised words
    Words unoptimised;  // may be empty: not kept
};

struct Proof {
    Digest table;  // of the table's bytes
    std::vector<ProofModule> modules;
    std::vector<ProofShader> shaders;
};

Bytes write_proof(const TableInput& input, ByteView table);

// Refuses what is damaged, newer, or does not belong to `table`.
Result<Proof> read_proof(ByteView bytes, ByteView table);

// A variant or module that the runtime reader resolves to something else than the build recorded.
struct ProofMismatch {
    std::string shader;
    std::string variant;  // axis=value ...
    std::string why;
};

// Compares exactly, by sets: for every stage, the set of needed variants that the table resolves to each module against the
// union of the proof's classes of that module; every module's words and every artifact's text against their digests.
std::vector<ProofMismatch> check_proof(TableView& table, Proof& proof);

}  // namespace kiln
