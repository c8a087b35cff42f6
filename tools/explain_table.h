#pragma once
// kiln explain on a table.

#include "tools/args.h"
#include "tools/session.h"

namespace kiln {

int explain_table(const Args& args, Session& session);

}  // namespace kiln
