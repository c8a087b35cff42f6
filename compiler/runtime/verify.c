/* Reads every byte: checksums first, which find damage, then that every reference inside fits, which finds a writer's
 * mistake or a forged file. Needs no memory: packed blocks are followed, not unpacked. */
#include "compiler/runtime/internal.h"

/* Returns `what` from the enclosing function unless `condition` holds. */
#define KILN_NEED(condition, what)       \
    do {                                 \
        if (!(condition)) return (what); \
    } while (0)

static const char* check_bytes(const kiln_table* t) {
    kf_header header;
    memcpy(&header, t->bytes, sizeof header);
    for (uint32_t i = 0; i < header.sections; ++i) {
        kf_entry e;
        memcpy(&e, t->bytes + sizeof header + i * sizeof e, sizeof e);
        KILN_NEED(kf_checksum(t->bytes + e.offset, e.bytes / 8, KF_NO_SKIP) == e.checksum,
                  "a section does not match its checksum");
        for (uint64_t at = e.used; at < e.bytes; ++at) KILN_NEED(t->bytes[e.offset + at] == 0, "padding is not zero");
    }
    return NULL;
}

static int numbers_fit(const kiln_table* t, kf_range r) { return kiln_fits(t, kf_numbers, r.first, r.count); }

static const char* check_shader(const kiln_table* t, uint32_t index) {
    kiln_shader s;
    kf_shader_record r;
    KILN_NEED(kiln_get_shader(t, index, &s) == KILN_OK && KILN_LOAD(t, kf_shaders, index, &r), "a shader's lists do not fit");
    KILN_NEED(
        kiln_text_fits(t, r.name) && kiln_text_fits(t, r.declared) && kiln_text_fits(t, r.legal) && kiln_text_fits(t, r.needed),
        "a shader's name does not fit");
    KILN_NEED(s.private_.status.leaves == 3 && kiln_diagram_sound(&s.private_.status, s.key_words),
              "a shader's status diagram is malformed");
    for (uint32_t i = 0; i < s.axis_count; ++i) {
        kf_axis_record a;
        KILN_NEED(KILN_LOAD(t, kf_axes, (uint64_t)r.axes.first + i, &a) && kiln_text_fits(t, a.name) &&
                      kiln_text_fits(t, a.macro) && kiln_fits(t, kf_values, a.values.first, a.values.count),
                  "an axis does not fit");
        KILN_NEED(a.values.count > 0 && (a.field & 0xffffu) < s.key_words && a.field >> 27 == 0 &&
                      (a.field >> 16 & 63u) + (a.field >> 22 & 31u) <= 64 &&
                      a.values.count - 1 <= (1u << (a.field >> 22 & 31u)) - 1,
                  "an axis has no room in the key");
        for (uint32_t v = 0; v < a.values.count; ++v) {
            kf_value_record value;
            KILN_NEED(KILN_LOAD(t, kf_values, (uint64_t)a.values.first + v, &value) && kiln_text_fits(t, value.name),
                      "a value does not fit");
        }
    }
    KILN_NEED(s.key_words > 0, "a shader has no key");
    for (uint32_t i = 0; i < s.stage_count; ++i) {
        kf_stage_record stage;
        KILN_NEED(KILN_LOAD(t, kf_stages, (uint64_t)r.stages.first + i, &stage) && numbers_fit(t, stage.axes) &&
                      kiln_diagram_sound(&s.private_.stage[i], s.key_words),
                  "a stage's diagram is malformed");
    }
    for (uint32_t i = 0; i < s.module_count; ++i) {
        KILN_NEED(kiln_shader_module(&s, i) < t->section[kf_modules].count, "a shader names a module that is not there");
        KILN_NEED(i == 0 || kiln_shader_module(&s, i - 1) < kiln_shader_module(&s, i), "a shader's modules are not ascending");
        for (uint32_t g = 0; g < s.private_.target_count; ++g) {
            const uint32_t e = kiln_u32(s.private_.artifacts + 4 * ((size_t)g * s.module_count + i));
            KILN_NEED(e == KF_NO_ARTIFACT ||
                          (e & KF_HOLE ? (e & ~KF_HOLE) < t->section[kf_texts].count : e < t->section[kf_artifacts].count),
                      "a module names an artifact that is not there");
        }
    }
    for (uint32_t i = 0; i < s.rule_count; ++i) {
        kf_rule_record rule;
        kiln_diagram d;
        KILN_NEED(KILN_LOAD(t, kf_rules, (uint64_t)r.rules.first + i, &rule) && kiln_text_fits(t, rule.text) &&
                      kiln_text_fits(t, rule.because) && kiln_diagram_at(t, rule.diagram, &d) && d.leaves == 2 &&
                      kiln_diagram_sound(&d, s.key_words),
                  "a rule is malformed");
    }
    for (uint32_t i = 0; i < s.slot_count; ++i) {
        kf_slot_record slot;
        KILN_NEED(KILN_LOAD(t, kf_slots, (uint64_t)r.slots.first + i, &slot) && kiln_text_fits(t, slot.name),
                  "a slot does not fit");
    }
    for (uint32_t i = 0; i < s.pipeline_count; ++i) {
        kiln_pipeline p;
        KILN_NEED(kiln_get_pipeline(&s, i, &p) == KILN_OK, "a pipeline does not fit");
        for (uint32_t k = 0; k < s.stage_count; ++k)
            KILN_NEED(p.modules[k] < t->section[kf_modules].count, "a pipeline names a module that is not there");
    }
    return NULL;
}

static const char* check_records(const kiln_table* t) {
    for (uint64_t i = 0; i < t->section[kf_modules].count; ++i) {
        kiln_module m;
        kf_module_record r;
        KILN_NEED(kiln_get_module(t, (uint32_t)i, &m) == KILN_OK && KILN_LOAD(t, kf_modules, i, &r) &&
                      r.reflection < t->section[kf_reflections].count,
                  "a module does not fit");
    }
    for (uint64_t i = 0; i < t->section[kf_reflections].count; ++i) {
        kf_reflection_record r;
        KILN_NEED(KILN_LOAD(t, kf_reflections, i, &r) && kiln_text_fits(t, r.entry) &&
                      kiln_fits(t, kf_resources, r.resources.first, r.resources.count) &&
                      kiln_fits(t, kf_varyings, r.inputs.first, r.inputs.count) &&
                      kiln_fits(t, kf_varyings, r.outputs.first, r.outputs.count),
                  "a reflection does not fit");
    }
    for (uint64_t i = 0; i < t->section[kf_resources].count; ++i) {
        kf_resource_record r;
        KILN_NEED(KILN_LOAD(t, kf_resources, i, &r) && kiln_text_fits(t, r.name) && numbers_fit(t, r.array) &&
                      kiln_fits(t, kf_members, r.members.first, r.members.count),
                  "a resource does not fit");
    }
    for (uint64_t i = 0; i < t->section[kf_members].count; ++i) {
        kf_member_record r;
        KILN_NEED(KILN_LOAD(t, kf_members, i, &r) && kiln_text_fits(t, r.name) && numbers_fit(t, r.type.array) &&
                      numbers_fit(t, r.strides) && r.strides.count == r.type.array.count,
                  "a member does not fit");
    }
    for (uint64_t i = 0; i < t->section[kf_varyings].count; ++i) {
        kf_varying_record r;
        KILN_NEED(KILN_LOAD(t, kf_varyings, i, &r) && kiln_text_fits(t, r.name) && numbers_fit(t, r.type.array),
                  "a varying does not fit");
    }
    for (uint64_t i = 0; i < t->section[kf_texts].count; ++i) {
        kf_text r;
        KILN_NEED(KILN_LOAD(t, kf_texts, i, &r) && kiln_text_fits(t, r), "a text does not fit");
    }
    return NULL;
}

static const char* check_texts(const kiln_table* t) {
    for (uint64_t i = 0; i < t->section[kf_blocks].count; ++i) {
        kf_block_record b;
        const uint8_t* packed;
        KILN_NEED(KILN_LOAD(t, kf_blocks, i, &b), "a block does not fit");
        packed = kiln_run(t, kf_packed, b.at, b.packed);
        KILN_NEED(packed != NULL && (b.codec == kf_codec_raw || b.codec == kf_codec_lz4), "a block does not fit");
        KILN_NEED(b.codec != kf_codec_raw || b.packed == b.unpacked, "a block does not unpack to its size");
        KILN_NEED(b.codec != kf_codec_lz4 || kiln_lz4(packed, b.packed, NULL, b.unpacked, b.unpacked) == (int64_t)b.unpacked,
                  "a block does not unpack to its size");
    }
    for (uint64_t i = 0; i < t->section[kf_artifacts].count; ++i) {
        kiln_artifact a;
        KILN_NEED(kiln_get_artifact(t, (uint32_t)i, &a) == KILN_OK, "an artifact does not fit in its block");
    }
    return NULL;
}

static const char* check_all(const kiln_table* t) {
    kiln_info info;
    kf_info_record r;
    const char* wrong = check_bytes(t);
    if (wrong != NULL) return wrong;
    KILN_NEED(kiln_get_info(t, &info) == KILN_OK && KILN_LOAD(t, kf_info, 0, &r) && kiln_text_fits(t, r.name) &&
                  kiln_text_fits(t, r.tools),
              "the table's own record does not fit");
    for (uint32_t i = 0; i < info.shader_count; ++i)
        if ((wrong = check_shader(t, i)) != NULL) return wrong;
    if ((wrong = check_records(t)) != NULL) return wrong;
    return check_texts(t);
}

kiln_status kiln_verify(const kiln_table* table, const char** what) {
    const char* wrong = check_all(table);
    if (what != NULL) *what = wrong == NULL ? kiln_status_text(KILN_OK) : wrong;
    return wrong == NULL ? KILN_OK : KILN_DAMAGED;
}
