#pragma once
// One file a verb; main.cpp lists the rows.

#include "tools/args.h"

namespace kiln {

extern const Verb verb_count, verb_build, verb_validate, verb_validate_worker, verb_explain, verb_preprocess, verb_dump,
    verb_diff, verb_cache, verb_sheet, verb_report;

}  // namespace kiln
