#pragma once
// A reflection as bytes, for action records and the table.

#include "compiler/base/wire.h"
#include "compiler/reflect/reflect.h"

namespace kiln {

void write_reflection(WireWriter& out, const Reflection& reflection);
// False, with the reader failed, when a value is out of range or the bytes end early.
bool read_reflection(WireReader& in, Reflection& reflection);

}  // namespace kiln
