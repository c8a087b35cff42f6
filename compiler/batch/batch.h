#pragma once
// What travels to a worker and back.
//
//     batch   := "kiln.batch.v1" | text identity | n * module | n * artifact | XXH3-128 of all before
//     module  := u8 stage | options | action[32] | text
//     answers := "kiln.answers.v1" | n * blob | n * (u8 kind | action[32] | record) | XXH3-128 of all before
//
// A record is what the store would hold (module_record.h, translate_record.h); its blobs travel once. A question without an
// answer is one that failed: the build asks it again at home, where the message has a place.

#include "compiler/base/jobs.h"
#include "compiler/base/store.h"
#include "compiler/modules/elsewhere.h"

namespace kiln {

// `identity`: the toolchain's.
Bytes write_batch(const std::string& identity, std::span<const ModuleQuestion> modules,
                  std::span<const ArtifactQuestion> artifacts);

// What a worker does. An Error for what is no batch, or one of another kiln: its answers would differ.
Result<Bytes> answer_batch(ByteView batch, Toolchain& tools, const Jobs& jobs);

// Puts into the store what answers a question that was asked: every blob is hashed, every record read. Returns how many were
// answered; an Error for what are no answers, with nothing put.
Result<size_t> take_answers(ByteView answers, std::span<const Digest> asked, Store& store);

}  // namespace kiln
