/* What a module asks of its surroundings. */
#include "compiler/runtime/internal.h"

/* Points at numbers in place; an empty list where they do not fit. */
static int numbers(const kiln_table* t, kf_range range, const uint32_t** data, uint32_t* count) {
    const uint8_t* at = kiln_run(t, kf_numbers, range.first, range.count);
    *data = (const uint32_t*)(const void*)(at == NULL ? t->section[kf_numbers].data : at);
    *count = at == NULL ? 0 : range.count;
    return at != NULL;
}

static int type_at(const kiln_table* t, const kf_type_record* r, kiln_type* out) {
    out->base = r->base;
    out->rows = r->rows;
    out->columns = r->columns;
    return numbers(t, r->array, &out->array, &out->array_count);
}

kiln_status kiln_get_reflection(const kiln_table* table, uint32_t module, kiln_reflection* out) {
    kf_module_record m;
    kf_reflection_record r;
    memset(out, 0, sizeof *out);
    out->entry = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    if (module >= table->section[kf_modules].count) return KILN_ABSENT;
    if (!KILN_LOAD(table, kf_modules, module, &m) || !KILN_LOAD(table, kf_reflections, m.reflection, &r)) return KILN_DAMAGED;
    if (!kiln_fits(table, kf_resources, r.resources.first, r.resources.count) ||
        !kiln_fits(table, kf_varyings, r.inputs.first, r.inputs.count) ||
        !kiln_fits(table, kf_varyings, r.outputs.first, r.outputs.count))
        return KILN_DAMAGED;
    out->stage = r.stage;
    out->entry = kiln_text_at(table, r.entry);
    out->resource_count = r.resources.count;
    out->input_count = r.inputs.count;
    out->output_count = r.outputs.count;
    memcpy(out->workgroup, r.workgroup, sizeof out->workgroup);
    out->writes_depth = (r.flags & kf_writes_depth) != 0;
    out->discards = (r.flags & kf_discards) != 0;
    out->private_[0] = r.resources.first;
    out->private_[1] = r.inputs.first;
    out->private_[2] = r.outputs.first;
    return KILN_OK;
}

kiln_status kiln_get_resource(const kiln_table* table, const kiln_reflection* of, uint32_t index, kiln_resource* out) {
    kf_resource_record r;
    memset(out, 0, sizeof *out);
    out->name = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    if (index >= of->resource_count) return KILN_ABSENT;
    if (!KILN_LOAD(table, kf_resources, (uint64_t)of->private_[0] + index, &r)) return KILN_DAMAGED;
    if (!kiln_fits(table, kf_members, r.members.first, r.members.count)) return KILN_DAMAGED;
    out->name = kiln_text_at(table, r.name);
    out->kind = r.kind;
    out->set = r.set;
    out->binding = r.binding;
    out->bytes = r.bytes;
    out->member_count = r.members.count;
    out->dim = r.dim;
    out->arrayed = (r.flags & kf_arrayed) != 0;
    out->multisampled = (r.flags & kf_multisampled) != 0;
    out->depth = (r.flags & kf_depth) != 0;
    out->readonly = (r.flags & kf_readonly) != 0;
    out->writeonly = (r.flags & kf_writeonly) != 0;
    out->sampled = r.sampled;
    out->format = r.format;
    out->private_ = r.members.first;
    return numbers(table, r.array, &out->array, &out->array_count) ? KILN_OK : KILN_DAMAGED;
}

kiln_status kiln_get_member(const kiln_table* table, const kiln_resource* of, uint32_t index, kiln_member* out) {
    kf_member_record r;
    uint32_t strides;
    memset(out, 0, sizeof *out);
    out->name = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    if (index >= of->member_count) return KILN_ABSENT;
    if (!KILN_LOAD(table, kf_members, (uint64_t)of->private_ + index, &r)) return KILN_DAMAGED;
    out->name = kiln_text_at(table, r.name);
    out->offset = r.offset;
    out->size = r.size;
    out->array_stride = r.array_stride;
    out->matrix_stride = r.matrix_stride;
    out->row_major = (r.flags & kf_row_major) != 0;
    if (!type_at(table, &r.type, &out->type)) return KILN_DAMAGED;
    if (!numbers(table, r.strides, &out->strides, &strides) || strides < out->type.array_count) {
        out->type.array_count = 0;
        return KILN_DAMAGED;
    }
    return KILN_OK;
}

static kiln_status varying_at(const kiln_table* table, uint64_t index, kiln_varying* out) {
    kf_varying_record r;
    memset(out, 0, sizeof *out);
    out->name = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    if (!KILN_LOAD(table, kf_varyings, index, &r)) return KILN_DAMAGED;
    out->name = kiln_text_at(table, r.name);
    out->location = r.location;
    out->component = r.component;
    out->index = r.index;
    out->flat = (r.flags & kf_flat) != 0;
    out->no_perspective = (r.flags & kf_no_perspective) != 0;
    out->centroid = (r.flags & kf_centroid) != 0;
    out->sample = (r.flags & kf_sample) != 0;
    out->patch = (r.flags & kf_patch) != 0;
    return type_at(table, &r.type, &out->type) ? KILN_OK : KILN_DAMAGED;
}

kiln_status kiln_get_input(const kiln_table* table, const kiln_reflection* of, uint32_t index, kiln_varying* out) {
    const kiln_status status = varying_at(table, (uint64_t)of->private_[1] + index, out);
    return index < of->input_count ? status : KILN_ABSENT;
}

kiln_status kiln_get_output(const kiln_table* table, const kiln_reflection* of, uint32_t index, kiln_varying* out) {
    const kiln_status status = varying_at(table, (uint64_t)of->private_[2] + index, out);
    return index < of->output_count ? status : KILN_ABSENT;
}
