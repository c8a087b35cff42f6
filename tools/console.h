#pragma once
// The one place that prints. Diagnostics and progress go to standard error, results to standard output.

#include <string>

#include "compiler/base/diag.h"
#include "compiler/base/result.h"
#include "compiler/modules/modules.h"

namespace kiln {

// True when standard error is a terminal that wants colour (NO_COLOR and TERM=dumb switch it off).
bool colour_wanted();

// Prints the diagnostics, at most `most` errors and as many warnings, then how many more there were.
void print_diags(const Diags& diags, size_t most = 50);
// "kiln: error: ..." and the fault's exit code.
int print_error(const Error& error);
void print_note(const std::string& text);

// Writes to standard output; an Error when that fails (a closed pipe, a full disk).
Status print_out(const std::string& text);
// print_out, and the exit code: `code`, or 3 when the output could not be written.
int finish(const std::string& text, int code = 0);

// What is done and the time left: on a terminal a line that rewrites itself; elsewhere a whole line every 30 s, or every
// $KILN_PROGRESS s ("off": none). Call clear_progress before printing anything else.
Progress console_progress();
void clear_progress();

}  // namespace kiln
