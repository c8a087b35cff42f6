#pragma once
// What does not change about the report's page.

namespace kiln::report {

extern const char* const page_style;
extern const char* const page_foot;
extern const char* const page_script;

}  // namespace kiln::report
