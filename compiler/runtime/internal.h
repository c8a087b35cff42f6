#ifndef KILN_RUNTIME_INTERNAL_H
#define KILN_RUNTIME_INTERNAL_H
/* Bounds-checked access to the sections of an open table, shared by the reader's sources. */
#include <string.h>

#include "compiler/runtime/inspect.h"
#include "compiler/runtime/kiln.h"
#include "compiler/runtime/table_format.h"

static inline uint32_t kiln_u32(const uint8_t* at) {
    uint32_t v;
    memcpy(&v, at, sizeof v);
    return v;
}

static inline uint64_t kiln_u64(const uint8_t* at) {
    uint64_t v;
    memcpy(&v, at, sizeof v);
    return v;
}

/* Record `index` of section `kind`, of which `bytes` are known here; NULL when there is none. */
static inline const uint8_t* kiln_at(const kiln_table* t, uint32_t kind, uint64_t index, size_t bytes) {
    const kiln_section* s = &t->section[kind];
    return index < s->count && bytes <= s->stride ? s->data + index * s->stride : NULL;
}

/* Copies a record into *out; 0 when there is none. */
#define KILN_LOAD(t, kind, index, out) kiln_load((t), (kind), (index), (out), sizeof *(out))
static inline int kiln_load(const kiln_table* t, uint32_t kind, uint64_t index, void* out, size_t bytes) {
    const uint8_t* at = kiln_at(t, kind, index, bytes);
    if (at == NULL) return 0;
    memcpy(out, at, bytes);
    return 1;
}

/* True when `count` records from `first` on are in section `kind`. */
static inline int kiln_fits(const kiln_table* t, uint32_t kind, uint64_t first, uint64_t count) {
    const uint64_t have = t->section[kind].count;
    return first <= have && count <= have - first;
}

/* The first of `count` plain numbers in place, never NULL; NULL when they do not fit. */
static inline const uint8_t* kiln_run(const kiln_table* t, uint32_t kind, uint64_t first, uint64_t count) {
    return kiln_fits(t, kind, first, count) ? t->section[kind].data + first * t->section[kind].stride : NULL;
}

int kiln_text_fits(const kiln_table* table, kf_text text);
kiln_text kiln_text_at(const kiln_table* table, kf_text text);
int kiln_same(kiln_text text, const char* name);

/* A digit of a key; 0 where the field lies outside the key. */
static inline uint32_t kiln_digit(const uint64_t* key, uint32_t words, uint32_t field) {
    const uint32_t word = field & 0xffffu;
    if (word >= words) return 0;
    return (uint32_t)(key[word] >> (field >> 16 & 63u)) & ((1u << (field >> 22 & 31u)) - 1u);
}

/* Follows a diagram to its leaf value; KF_NO_LEAF when the diagram is damaged or says nothing about this key. */
uint32_t kiln_walk(const kiln_diagram* diagram, const uint64_t* key, uint32_t key_words);
int kiln_diagram_at(const kiln_table* table, uint32_t index, kiln_diagram* out);
/* True when every node of the diagram is well formed. */
int kiln_diagram_sound(const kiln_diagram* diagram, uint32_t key_words);

/* Decodes one LZ4 block up to `wanted` bytes of its output. `out` may be NULL: then only the structure is checked. Returns
 * the bytes that came out, or -1 when the block is malformed or would give more than `limit`. */
int64_t kiln_lz4(const uint8_t* in, uint32_t size, uint8_t* out, uint32_t wanted, uint32_t limit);

#endif
