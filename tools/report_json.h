#pragma once
// report.json: everything of a report but the pictures.

#include "compiler/report/report.h"

namespace kiln {

std::string report_json(const report::Report& report, const std::vector<report::Budget>& budgets);

}  // namespace kiln
