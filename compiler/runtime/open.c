/* Opening looks at a fixed number of bytes: the header and its entries, whose checksum covers both. That is enough to know
 * where every section lies; what is in them is checked where it is used. */
#include "compiler/runtime/internal.h"

typedef char kiln_assert_header[sizeof(kf_header) == 32 ? 1 : -1];
typedef char kiln_assert_entry[sizeof(kf_entry) == 40 ? 1 : -1];
typedef char kiln_assert_sections[kf_section_last < sizeof((kiln_table*)0)->section / sizeof(kiln_section) ? 1 : -1];

static const uint8_t strides[kf_section_last + 1] = KF_STRIDES;

/* Sections of plain numbers and bytes, whose records never grow. */
static int is_plain(uint32_t kind) {
    return kind == kf_strings || kind == kf_numbers || kind == kf_wides || kind == kf_nodes || kind == kf_packed ||
           kind == kf_spirv;
}

kiln_status kiln_open(kiln_table* table, const void* bytes, size_t size) {
    const uint16_t one = 1;
    uint8_t first;
    kf_header header;
    memset(table, 0, sizeof *table);
    memcpy(&first, &one, 1);
    if (first != 1) return KILN_BIG_ENDIAN;
    if (bytes == NULL || size < 8 || memcmp(bytes, KF_MAGIC, 8) != 0) return KILN_NOT_A_TABLE;
    if ((uintptr_t)bytes % 8 != 0) return KILN_MISALIGNED;
    if (size < sizeof header) return KILN_TRUNCATED;
    memcpy(&header, bytes, sizeof header);
    if (header.version > KF_VERSION) return KILN_NEWER;
    if (header.version != KF_VERSION) return KILN_DAMAGED;
    if (header.file_bytes > size) return KILN_TRUNCATED;
    if (header.file_bytes != size || header.sections < kf_section_last || header.sections > KF_MAX_SECTIONS) return KILN_DAMAGED;
    uint64_t at = sizeof header + (uint64_t)header.sections * sizeof(kf_entry);
    if (at > size) return KILN_TRUNCATED;
    table->bytes = (const uint8_t*)bytes;
    table->size = size;
    if (kf_checksum(table->bytes, at / 8, KF_HEADER_SKIP) != header.checksum) return KILN_DAMAGED;
    for (uint32_t i = 0; i < header.sections; ++i) {
        kf_entry e;
        memcpy(&e, table->bytes + sizeof header + i * sizeof e, sizeof e);
        if (e.offset != at || e.bytes % 8 != 0 || e.bytes > size - at) return KILN_DAMAGED;
        if (e.used > e.bytes || e.bytes - e.used >= 8) return KILN_DAMAGED;
        at += e.bytes;
        if (i >= kf_section_last) {
            if (e.kind <= kf_section_last) return KILN_DAMAGED;
            continue;
        }
        if (e.kind != i + 1 || e.stride < strides[e.kind] || e.used % e.stride != 0) return KILN_DAMAGED;
        if (is_plain(e.kind) && e.stride != strides[e.kind]) return KILN_DAMAGED;
        table->section[e.kind].data = table->bytes + e.offset;
        table->section[e.kind].count = e.used / e.stride;
        table->section[e.kind].stride = e.stride;
    }
    return at == size && table->section[kf_info].count == 1 ? KILN_OK : KILN_DAMAGED;
}

int kiln_text_fits(const kiln_table* table, kf_text text) {
    const kiln_section* s = &table->section[kf_strings];
    return text.at < s->count && text.size < s->count - text.at && s->data[(uint64_t)text.at + text.size] == 0;
}

kiln_text kiln_text_at(const kiln_table* table, kf_text text) {
    kiln_text out = {"", 0};
    if (kiln_text_fits(table, text)) {
        out.data = (const char*)table->section[kf_strings].data + text.at;
        out.size = text.size;
    }
    return out;
}

int kiln_same(kiln_text text, const char* name) {
    const size_t size = strlen(name);
    return size == text.size && memcmp(text.data, name, size) == 0;
}

const char* kiln_status_text(kiln_status status) {
    switch (status) {
        case KILN_OK:
            return "fine";
        case KILN_FORBIDDEN:
            return "forbidden by the rules";
        case KILN_NOT_NEEDED:
            return "not needed by any scene that the table was built for";
        case KILN_BAD_KEY:
            return "the key has a digit or a bit that no axis has";
        case KILN_ABSENT:
            return "not in this table";
        case KILN_REFUSED:
            return "the target cannot say this module";
        case KILN_SHORT_BUFFER:
            return "the buffer is too small";
        case KILN_NOT_A_TABLE:
            return "this is not a kiln table";
        case KILN_NEWER:
            return "this table was written by a newer version of kiln";
        case KILN_TRUNCATED:
            return "the table is cut short";
        case KILN_DAMAGED:
            return "the table is damaged";
        case KILN_MISALIGNED:
            return "the table does not start at a multiple of 8 bytes in memory";
        case KILN_BIG_ENDIAN:
            return "kiln tables can be read on little-endian machines only";
    }
    return "unknown status";
}

kiln_status kiln_get_info(const kiln_table* table, kiln_info* info) {
    kf_info_record r;
    memset(info, 0, sizeof *info);
    info->name = info->tools = kiln_text_at(table, (kf_text){KILN_NONE, 0});
    if (!KILN_LOAD(table, kf_info, 0, &r)) return KILN_DAMAGED;
    if (!kiln_fits(table, kf_numbers, r.targets.first, r.targets.count)) return KILN_DAMAGED;
    if (!kiln_fits(table, kf_texts, r.scenes.first, r.scenes.count)) return KILN_DAMAGED;
    info->name = kiln_text_at(table, r.name);
    info->tools = kiln_text_at(table, r.tools);
    info->vulkan = r.vulkan;
    info->spirv = r.spirv;
    info->target_count = r.targets.count;
    info->scene_count = r.scenes.count;
    info->shader_count = (uint32_t)table->section[kf_shaders].count;
    info->module_count = (uint32_t)table->section[kf_modules].count;
    info->artifact_count = (uint32_t)table->section[kf_artifacts].count;
    info->block_count = (uint32_t)table->section[kf_blocks].count;
    info->spirv_bytes = table->section[kf_spirv].count * 4;
    info->packed_bytes = table->section[kf_packed].count;
    for (uint32_t i = 0; i < info->block_count; ++i) {
        kf_block_record b;
        if (KILN_LOAD(table, kf_blocks, i, &b)) info->text_bytes += b.unpacked;
    }
    return KILN_OK;
}

uint32_t kiln_get_target(const kiln_table* table, uint32_t index) {
    kf_info_record r;
    const uint8_t* at;
    if (!KILN_LOAD(table, kf_info, 0, &r) || index >= r.targets.count) return KILN_NONE;
    at = kiln_at(table, kf_numbers, (uint64_t)r.targets.first + index, 4);
    return at == NULL ? KILN_NONE : kiln_u32(at);
}

kiln_text kiln_get_scene(const kiln_table* table, uint32_t index) {
    kf_info_record r;
    kf_text text = {KILN_NONE, 0};
    if (KILN_LOAD(table, kf_info, 0, &r) && index < r.scenes.count)
        if (!KILN_LOAD(table, kf_texts, (uint64_t)r.scenes.first + index, &text)) text.at = KILN_NONE;
    return kiln_text_at(table, text);
}
