#ifndef KILN_INSPECT_H
#define KILN_INSPECT_H
/* What our own tools read beyond kiln.h, to rebuild a table's diagrams whole. Not for games. */
#include "compiler/runtime/kiln.h"

#ifdef __cplusplus
extern "C" {
#endif

int kiln_shader_rule_diagram(const kiln_shader* shader, uint32_t rule, kiln_diagram* out); /* 0 when there is none */
/* The axes in the order in which diagrams test them; NULL when the table is damaged. */
const uint32_t* kiln_shader_order(const kiln_shader* shader, uint32_t* count);

#ifdef __cplusplus
}
#endif
#endif
