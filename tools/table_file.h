#pragma once
// A table named on the command line, opened and verified; errors name the file.

#include "compiler/base/files.h"
#include "compiler/table/table_read.h"

namespace kiln {

bool is_table(Files& files, const std::string& path);  // by its first bytes
Result<std::unique_ptr<TableView>> open_table(Files& files, const std::string& path);

}  // namespace kiln
