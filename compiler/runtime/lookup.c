/* Keys and lookups. A lookup is a few masked compares (is this a key at all), a walk of the shader's status diagram, and a
 * walk a stage. A node is one load of its head, one digit from the key, one load of the next reference; a diagram that is one
 * array was recognised when the shader was fetched and is one load. Nothing here trusts the table: a node must end inside its
 * diagram, and references only go forward, so a walk ends. */
#include "compiler/runtime/internal.h"

uint32_t kiln_walk(const kiln_diagram* d, const uint64_t* key, uint32_t key_words) {
    uint32_t ref = d->root;
    while (!(ref & KF_LEAF)) {
        const uint64_t left = d->words > ref ? d->words - ref : 0;
        const uint8_t* node = d->nodes + (size_t)4 * ref;
        uint32_t n, next;
        if (left < 2) return KF_NO_LEAF;
        n = kiln_u32(node) & 0x0fffffffu;
        if (kiln_u32(node) >> 28 == kf_runs) {
            const uint32_t digit = kiln_digit(key, key_words, kiln_u32(node + 4));
            uint32_t low = 0, high = n;
            if (2 + (uint64_t)2 * n > left) return KF_NO_LEAF;
            while (low < high) {
                const uint32_t middle = low + (high - low) / 2;
                if (kiln_u32(node + 8 + (size_t)4 * middle) < digit)
                    low = middle + 1;
                else
                    high = middle;
            }
            if (low == n) return KF_NO_LEAF;
            next = kiln_u32(node + 8 + (size_t)4 * n + (size_t)4 * low);
        } else {
            const uint32_t size = kiln_u32(node + 4);
            const uint64_t head = 2 + (uint64_t)2 * n;
            uint64_t index = 0;
            if (n > KF_MAX_FIELDS || head > left) return KF_NO_LEAF;
            for (uint32_t i = 0; i < n; ++i) {
                const uint8_t* f = node + 8 + (size_t)8 * i;
                index += (uint64_t)kiln_digit(key, key_words, kiln_u32(f)) * kiln_u32(f + 4);
            }
            if (index >= size) return KF_NO_LEAF;
            if (kiln_u32(node) >> 28 == kf_dense16) {
                uint16_t value;
                if (head + ((uint64_t)size + 1) / 2 > left) return KF_NO_LEAF;
                memcpy(&value, node + 4 * head + 2 * index, 2);
                return value < d->leaves ? value : KF_NO_LEAF;
            }
            if (head + size > left || kiln_u32(node) >> 28 != kf_dense32) return KF_NO_LEAF;
            next = kiln_u32(node + 4 * (head + index));
        }
        if (next <= ref) return KF_NO_LEAF;
        ref = next;
    }
    ref &= ~KF_LEAF;
    return ref < d->leaves ? ref : KF_NO_LEAF;
}

static inline uint32_t leaf_of(const kiln_diagram* d, const uint64_t* key, uint32_t key_words) {
    uint16_t value;
    uint32_t index;
    if (d->cells == NULL) return kiln_walk(d, key, key_words);
    index = kiln_digit(key, key_words, d->field);
    if (index >= d->size) return KF_NO_LEAF;
    memcpy(&value, d->cells + (size_t)2 * index, 2);
    return value < d->leaves ? value : KF_NO_LEAF;
}

static int field_sound(uint32_t field, uint32_t key_words) {
    return field >> 27 == 0 && (field & 0xffffu) < (key_words ? key_words : 1u) &&
           (field >> 16 & 63u) + (field >> 22 & 31u) <= 64;
}

/* A reference from the node at `from`: a leaf, or a later node with room for its head. */
static int ref_sound(const kiln_diagram* d, uint32_t from, uint32_t ref) {
    if (ref & KF_LEAF) return ref == KF_NO_LEAF || (ref & ~KF_LEAF) < d->leaves;
    return ref > from && d->words >= 2 && ref <= d->words - 2;
}

int kiln_diagram_sound(const kiln_diagram* d, uint32_t key_words) {
    uint32_t at = 0;
    if (d->root & KF_LEAF) return d->words == 0 && ref_sound(d, 0, d->root);
    if (d->root != 0) return 0;
    while (at < d->words) {
        const uint64_t left = d->words - at;
        const uint8_t* node = d->nodes + (size_t)4 * at;
        uint64_t n, words, refs;
        if (left < 2) return 0;
        n = kiln_u32(node) & 0x0fffffffu;
        if (kiln_u32(node) >> 28 == kf_runs) {
            words = 2 + 2 * n;
            refs = 2 + n;
            if (words > left || n == 0 || !field_sound(kiln_u32(node + 4), key_words)) return 0;
            for (uint64_t i = 1; i < n; ++i)
                if (kiln_u32(node + 8 + 4 * i) <= kiln_u32(node + 4 + 4 * i)) return 0;
        } else {
            const uint64_t size = kiln_u32(node + 4);
            const int narrow = kiln_u32(node) >> 28 == kf_dense16;
            if (!narrow && kiln_u32(node) >> 28 != kf_dense32) return 0;
            refs = 2 + 2 * n;
            words = refs + (narrow ? (size + 1) / 2 : size);
            if (n > KF_MAX_FIELDS || words > left) return 0;
            for (uint64_t i = 0; i < n; ++i)
                if (!field_sound(kiln_u32(node + 8 + 8 * i), key_words)) return 0;
            if (narrow) {
                for (uint64_t i = 0; i < size; ++i) {
                    uint16_t value;
                    memcpy(&value, node + 4 * refs + 2 * i, 2);
                    if (value >= d->leaves) return 0;
                }
                refs = words;
            }
        }
        for (uint64_t i = refs; i < words; ++i)
            if (!ref_sound(d, at, kiln_u32(node + 4 * i))) return 0;
        at += (uint32_t)words;
    }
    return 1;
}

int kiln_diagram_at(const kiln_table* table, uint32_t index, kiln_diagram* out) {
    kf_diagram_record r;
    if (!KILN_LOAD(table, kf_diagrams, index, &r)) return 0;
    out->nodes = kiln_run(table, kf_nodes, r.at, r.words);
    out->words = r.words;
    out->root = r.root;
    out->leaves = r.leaves;
    out->cells = NULL;
    out->field = out->size = 0;
    if (out->nodes == NULL) return 0;
    if (r.root == 0 && r.words >= 4 && kiln_u32(out->nodes) == ((uint32_t)kf_dense16 << 28 | 1u) &&
        kiln_u32(out->nodes + 12) == 1 && ((uint64_t)kiln_u32(out->nodes + 4) + 1) / 2 <= r.words - 4) {
        out->cells = out->nodes + 16;
        out->field = kiln_u32(out->nodes + 8);
        out->size = kiln_u32(out->nodes + 4);
    }
    return 1;
}

kiln_status kiln_get_shader(const kiln_table* table, uint32_t index, kiln_shader* shader) {
    kf_shader_record r;
    kf_info_record info;
    memset(shader, 0, sizeof *shader);
    shader->table = table;
    shader->name = shader->declared = shader->legal = shader->needed = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    if (index >= table->section[kf_shaders].count) return KILN_ABSENT;
    if (!KILN_LOAD(table, kf_shaders, index, &r) || !KILN_LOAD(table, kf_info, 0, &info)) return KILN_DAMAGED;
    if (!kiln_fits(table, kf_axes, r.axes.first, r.axes.count) || !kiln_fits(table, kf_stages, r.stages.first, r.stages.count) ||
        !kiln_fits(table, kf_rules, r.rules.first, r.rules.count) || !kiln_fits(table, kf_slots, r.slots.first, r.slots.count) ||
        !kiln_fits(table, kf_pipelines, r.pipelines.first, r.pipelines.count) ||
        !kiln_fits(table, kf_checks, r.checks.first, r.checks.count) || r.stages.count > KILN_MAX_STAGES ||
        r.checks.count > 0x10000u)
        return KILN_DAMAGED;
    shader->private_.used_words = (uint32_t)(((uint64_t)r.slots.count + 63) / 64);
    shader->private_.modules = kiln_run(table, kf_numbers, r.modules.first, r.modules.count);
    shader->private_.artifacts = kiln_run(table, kf_numbers, r.artifacts, (uint64_t)info.targets.count * r.modules.count);
    shader->private_.used = kiln_run(table, kf_wides, r.used, (uint64_t)r.modules.count * shader->private_.used_words);
    shader->private_.checks = kiln_run(table, kf_checks, r.checks.first, r.checks.count);
    shader->private_.check_stride = table->section[kf_checks].stride;
    if (shader->private_.modules == NULL || shader->private_.artifacts == NULL || shader->private_.used == NULL ||
        shader->private_.checks == NULL || !kiln_diagram_at(table, r.status, &shader->private_.status))
        return KILN_DAMAGED;
    for (uint32_t i = 0; i < r.stages.count; ++i) {
        kf_stage_record stage;
        if (!KILN_LOAD(table, kf_stages, (uint64_t)r.stages.first + i, &stage)) return KILN_DAMAGED;
        if (!kiln_diagram_at(table, stage.diagram, &shader->private_.stage[i])) return KILN_DAMAGED;
        if (shader->private_.stage[i].leaves > r.modules.count) return KILN_DAMAGED;
        shader->stage[i] = stage.stage;
    }
    shader->name = kiln_text_at(table, r.name);
    shader->declared = kiln_text_at(table, r.declared);
    shader->legal = kiln_text_at(table, r.legal);
    shader->needed = kiln_text_at(table, r.needed);
    shader->index = index;
    shader->axis_count = r.axes.count;
    shader->stage_count = r.stages.count;
    shader->slot_count = r.slots.count;
    shader->module_count = r.modules.count;
    shader->pipeline_count = r.pipelines.count;
    shader->rule_count = r.rules.count;
    shader->key_words = r.checks.count;
    shader->private_.axes = r.axes.first;
    shader->private_.stages = r.stages.first;
    shader->private_.slots = r.slots.first;
    shader->private_.pipelines = r.pipelines.first;
    shader->private_.rules = r.rules.first;
    shader->private_.target_count = info.targets.count;
    return KILN_OK;
}

kiln_status kiln_find_shader(const kiln_table* table, const char* name, kiln_shader* shader) {
    for (uint32_t i = 0; i < table->section[kf_shaders].count; ++i) {
        kf_shader_record r;
        if (KILN_LOAD(table, kf_shaders, i, &r) && kiln_same(kiln_text_at(table, r.name), name))
            return kiln_get_shader(table, i, shader);
    }
    memset(shader, 0, sizeof *shader);
    shader->table = table;
    shader->name = shader->declared = shader->legal = shader->needed = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    return KILN_ABSENT;
}

/* A digit that its axis lacks carries out of its field when the missing values are added, and no valid one does: so no carry
 * means that all digits are valid, and the lowest bad digit shows whatever the others are. */
static int key_valid(const kiln_shader* s, const uint64_t* key) {
    for (uint32_t i = 0; i < s->key_words; ++i) {
        const uint8_t* check = s->private_.checks + (size_t)i * s->private_.check_stride;
        const uint64_t addend = kiln_u64(check + 8), sum = key[i] + addend;
        if ((key[i] & ~kiln_u64(check)) | ((sum ^ key[i] ^ addend) & kiln_u64(check + 16)) | (sum < key[i])) return 0;
    }
    return 1;
}

kiln_status kiln_check(const kiln_shader* s, const uint64_t* key) {
    if (!key_valid(s, key)) return KILN_BAD_KEY;
    switch (leaf_of(&s->private_.status, key, s->key_words)) {
        case kf_leaf_forbidden:
            return KILN_FORBIDDEN;
        case kf_leaf_not_needed:
            return KILN_NOT_NEEDED;
        case kf_leaf_needed:
            return KILN_OK;
        default:
            return KILN_DAMAGED;
    }
}

kiln_status kiln_find(const kiln_shader* s, const uint64_t* key, uint32_t* modules) {
    const kiln_status status = kiln_check(s, key);
    if (status != KILN_OK) return status;
    for (uint32_t i = 0; i < s->stage_count; ++i) {
        const uint32_t leaf = leaf_of(&s->private_.stage[i], key, s->key_words);
        if (leaf >= s->module_count) return KILN_DAMAGED;
        modules[i] = kiln_u32(s->private_.modules + (size_t)4 * leaf);
    }
    return KILN_OK;
}

kiln_status kiln_find_stage(const kiln_shader* s, const uint64_t* key, uint32_t stage_index, uint32_t* module) {
    kiln_status status;
    uint32_t leaf;
    if (stage_index >= s->stage_count) return KILN_ABSENT;
    status = kiln_check(s, key);
    if (status != KILN_OK) return status;
    leaf = leaf_of(&s->private_.stage[stage_index], key, s->key_words);
    if (leaf >= s->module_count) return KILN_DAMAGED;
    *module = kiln_u32(s->private_.modules + (size_t)4 * leaf);
    return KILN_OK;
}

int kiln_shader_rule_diagram(const kiln_shader* s, uint32_t rule, kiln_diagram* out) {
    kf_rule_record r;
    return rule < s->rule_count && KILN_LOAD(s->table, kf_rules, (uint64_t)s->private_.rules + rule, &r) &&
           kiln_diagram_at(s->table, r.diagram, out);
}

const uint32_t* kiln_shader_order(const kiln_shader* s, uint32_t* count) {
    kf_shader_record r;
    if (!KILN_LOAD(s->table, kf_shaders, s->index, &r)) return NULL;
    *count = r.order.count;
    return (const uint32_t*)(const void*)kiln_run(s->table, kf_numbers, r.order.first, r.order.count);
}
