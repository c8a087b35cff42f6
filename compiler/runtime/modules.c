/* Modules, artifacts, slots and pipelines. */
#include "compiler/runtime/internal.h"

static kiln_text no_text(void) {
    const kiln_text empty = {"", 0};
    return empty;
}

kiln_status kiln_get_module(const kiln_table* table, uint32_t module, kiln_module* out) {
    kf_module_record r;
    const uint8_t* at = kiln_at(table, kf_modules, module, sizeof r);
    const uint8_t* words;
    memset(out, 0, sizeof *out);
    if (at == NULL) return KILN_ABSENT;
    memcpy(&r, at, sizeof r);
    words = kiln_run(table, kf_spirv, r.at, r.words);
    if (words == NULL) return KILN_DAMAGED;
    out->stage = r.stage;
    out->words = (const uint32_t*)(const void*)words;
    out->word_count = r.words;
    out->digest = at + offsetof(kf_module_record, digest);
    return KILN_OK;
}

uint32_t kiln_shader_module(const kiln_shader* s, uint32_t index) {
    return index < s->module_count ? kiln_u32(s->private_.modules + (size_t)4 * index) : KILN_NONE;
}

/* Place of a module in the shader's list, or KILN_NONE. */
static uint32_t place_of(const kiln_shader* s, uint32_t module) {
    uint32_t low = 0, high = s->module_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (kiln_shader_module(s, middle) < module)
            low = middle + 1;
        else
            high = middle;
    }
    return low < s->module_count && kiln_shader_module(s, low) == module ? low : KILN_NONE;
}

kiln_status kiln_get_artifact(const kiln_table* table, uint32_t index, kiln_artifact* out) {
    kf_artifact_record r;
    kf_block_record b;
    memset(out, 0, sizeof *out);
    out->reason = no_text();
    if (index >= table->section[kf_artifacts].count) return KILN_ABSENT;
    if (!KILN_LOAD(table, kf_artifacts, index, &r) || !KILN_LOAD(table, kf_blocks, r.block, &b)) return KILN_DAMAGED;
    if (r.at > b.unpacked || r.size > b.unpacked - r.at || (uint64_t)r.at + r.size >= 0xffffffffu) return KILN_DAMAGED;
    out->index = index;
    out->target = r.target;
    out->size = r.size;
    out->buffer = (b.codec == kf_codec_raw ? 0 : r.at) + r.size + 1;
    return KILN_OK;
}

kiln_status kiln_find_artifact(const kiln_shader* s, uint32_t module, uint32_t target, kiln_artifact* out) {
    const uint32_t place = place_of(s, module);
    memset(out, 0, sizeof *out);
    out->reason = no_text();
    if (place == KILN_NONE) return KILN_ABSENT;
    for (uint32_t i = 0; i < s->private_.target_count; ++i) {
        uint32_t entry;
        if (kiln_get_target(s->table, i) != target) continue;
        entry = kiln_u32(s->private_.artifacts + 4 * ((size_t)i * s->module_count + place));
        if (entry == KF_NO_ARTIFACT) return KILN_ABSENT;
        if (entry & KF_HOLE) {
            kf_text reason;
            if (!KILN_LOAD(s->table, kf_texts, entry & ~KF_HOLE, &reason)) return KILN_DAMAGED;
            out->target = target;
            out->reason = kiln_text_at(s->table, reason);
            return KILN_REFUSED;
        }
        return kiln_get_artifact(s->table, entry, out) == KILN_OK ? KILN_OK : KILN_DAMAGED;
    }
    return KILN_ABSENT;
}

kiln_status kiln_decode(const kiln_table* table, uint32_t artifact, void* buffer, size_t capacity) {
    kf_artifact_record r;
    kf_block_record b;
    kiln_artifact a;
    const uint8_t* packed;
    uint8_t* out = (uint8_t*)buffer;
    const kiln_status status = kiln_get_artifact(table, artifact, &a);
    if (status != KILN_OK) return status;
    if (capacity < a.buffer) return KILN_SHORT_BUFFER;
    if (!KILN_LOAD(table, kf_artifacts, artifact, &r) || !KILN_LOAD(table, kf_blocks, r.block, &b)) return KILN_DAMAGED;
    packed = kiln_run(table, kf_packed, b.at, b.packed);
    if (packed == NULL) return KILN_DAMAGED;
    if (b.codec == kf_codec_raw) {
        if (b.packed != b.unpacked) return KILN_DAMAGED;
        memcpy(out, packed + r.at, r.size);
    } else if (b.codec == kf_codec_lz4) {
        if (kiln_lz4(packed, b.packed, out, r.at + r.size, b.unpacked) < (int64_t)r.at + r.size) return KILN_DAMAGED;
        memmove(out, out + r.at, r.size);
    } else {
        return KILN_DAMAGED;
    }
    out[r.size] = 0;
    return KILN_OK;
}

kiln_status kiln_get_slot(const kiln_shader* s, uint32_t slot, kiln_slot* out) {
    kf_slot_record r;
    memset(out, 0, sizeof *out);
    out->name = no_text();
    if (slot >= s->slot_count) return KILN_ABSENT;
    if (!KILN_LOAD(s->table, kf_slots, (uint64_t)s->private_.slots + slot, &r)) return KILN_DAMAGED;
    out->name = kiln_text_at(s->table, r.name);
    out->kind = r.kind;
    out->set = r.set;
    out->binding = r.binding;
    out->buffer = r.buffer;
    out->texture = r.texture;
    out->sampler = r.sampler;
    out->image = r.image;
    out->uav = r.uav;
    out->metal_buffer = r.metal_buffer;
    out->metal_texture = r.metal_texture;
    out->unit_offset = r.unit_offset;
    return KILN_OK;
}

int kiln_uses_slot(const kiln_shader* s, uint32_t module, uint32_t slot) {
    const uint32_t place = place_of(s, module);
    if (place == KILN_NONE || slot >= s->slot_count) return 0;
    return (int)(kiln_u64(s->private_.used + 8 * ((size_t)place * s->private_.used_words + slot / 64)) >> slot % 64 & 1);
}

kiln_status kiln_get_pipeline(const kiln_shader* s, uint32_t index, kiln_pipeline* out) {
    kf_pipeline_record r;
    const uint8_t *modules, *witness;
    memset(out, 0, sizeof *out);
    out->count = no_text();
    if (index >= s->pipeline_count) return KILN_ABSENT;
    if (!KILN_LOAD(s->table, kf_pipelines, (uint64_t)s->private_.pipelines + index, &r)) return KILN_DAMAGED;
    modules = kiln_run(s->table, kf_numbers, r.modules, s->stage_count);
    witness = kiln_run(s->table, kf_wides, r.witness, s->key_words);
    if (modules == NULL || witness == NULL) return KILN_DAMAGED;
    out->count = kiln_text_at(s->table, r.count);
    out->modules = (const uint32_t*)(const void*)modules;
    out->witness = (const uint64_t*)(const void*)witness;
    return KILN_OK;
}

uint32_t kiln_stage_axes(const kiln_shader* s, uint32_t stage_index, uint32_t* axes, uint32_t capacity) {
    kf_stage_record r;
    const uint8_t* list;
    if (stage_index >= s->stage_count || !KILN_LOAD(s->table, kf_stages, (uint64_t)s->private_.stages + stage_index, &r))
        return 0;
    list = kiln_run(s->table, kf_numbers, r.axes.first, r.axes.count);
    if (list == NULL) return 0;
    for (uint32_t i = 0; i < r.axes.count && i < capacity; ++i) axes[i] = kiln_u32(list + (size_t)4 * i);
    return r.axes.count;
}
