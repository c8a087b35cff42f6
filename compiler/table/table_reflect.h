#pragma once
// Reflection as fixed records of the table, usable in place by the runtime reader.

#include "compiler/reflect/reflect.h"
#include "compiler/table/table_sections.h"

namespace kiln {

uint32_t write_reflection(TableSections& out, const Reflection& reflection);  // its record's index

}  // namespace kiln
