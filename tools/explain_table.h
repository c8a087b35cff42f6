#pragma once
// kiln explain on a table.

#include "tools/args.h"
#include "tools/session.h"

namespace kiln {

bool is_table(Files& files, const std::string& path);
int explain_table(const Args& args, Session& session);

}  // namespace kiln
