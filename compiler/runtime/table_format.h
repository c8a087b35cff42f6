#ifndef KILN_TABLE_FORMAT_H
#define KILN_TABLE_FORMAT_H
/*
 * The bytes of a variant table (.kiln), version 1. Shared by the writer (compiler/table/table.cpp) and the reader beside this
 * file. Little-endian. Every offset is from the start of its section, every section starts at a multiple of 8 bytes.
 *
 *   table   := header entry{sections} section{sections}
 *   header  := magic[8] u32 version u32 sections u64 file_bytes u64 checksum        32 bytes
 *   entry   := u32 kind u32 stride u64 offset u64 bytes u64 used u64 checksum       40 bytes
 *   section := byte{used} zero{bytes - used}                                        bytes is a multiple of 8
 *
 * The sections follow the entries without a gap, in the entries' order, and end where the file ends, so that the header's
 * checksum (over header and entries, its own field taken as zero) and the entries' checksums cover every byte. A section is
 * an array of `used / stride` records; kinds 1..kf_section_last appear once each, ascending. A later version 1 writer may
 * append fields to a record (a larger stride) and kinds after the last: a reader ignores what it does not know. Anything that
 * an old reader would misread raises `version`, and the old reader refuses the file.
 *
 *   text    := u32 at u32 size          bytes in `strings`; a zero byte follows, which `size` does not count
 *   range   := u32 first u32 count      records of the section that the field's comment names
 *   field   := word:16 shift:6 bits:5 zero:5    (low bits first) where an axis has its digit in a key of 64-bit words; a field
 *              never straddles two words, and 0 bits means that the digit is always 0
 *
 *   diagram := node words, reached from `root`. The fields of a dense node may each take in several axes that lie side by
 *              side in the key; entries that no valid key reaches hold any ref of the node
 *   ref     := leaf 0x80000000 | value, or the word offset of a node within the diagram, always greater than the offset of
 *              the node that refers to it (so every walk ends)
 *   node    := dense32 | dense16 | runs                            digit d_i is read from the key by field_i
 *   dense32 := u32 (0 << 28 | fields) u32 size (u32 field u32 stride){fields} ref{size}              next = ref[sum d_i*stride_i]
 *   dense16 := u32 (1 << 28 | fields) u32 size (u32 field u32 stride){fields} u16 value{size} pad    next = leaf value[...]
 *              with at most 32 fields
 *   runs    := u32 (2 << 28 | edges) u32 field u32 last{edges} ref{edges}          next = ref of the first edge with d <= last
 *
 *   block   := raw bytes, or one LZ4 block (literals and matches, offsets of 1 to 65535 bytes)
 *
 * The checksum of n 64-bit words is h = n, then for each word w: h = (h ^ w) * 0x9E3779B97F4A7C15, h ^= h >> 32. Each step
 * is a bijection of h and of w, so a change within any one word always changes the result.
 */
#include <stdint.h>
#include <string.h>

#define KF_MAGIC "KILN\r\n\x1a\n"
#define KF_VERSION 1u
#define KF_MAX_SECTIONS 64u
#define KF_LEAF 0x80000000u
#define KF_NO_LEAF 0xffffffffu     /* root of a stage diagram that no needed variant reaches */
#define KF_NO_ARTIFACT 0xffffffffu /* artifact map: this shader does not use the module */
#define KF_HOLE 0x80000000u        /* artifact map: | index into `texts`, why the target cannot say it */
#define KF_MAX_FIELDS 32u          /* of a dense node */
#define KF_BLOCK_BYTES 65536u      /* unpacked size of a block that holds more than one text, at most */

enum { /* on disk: append only */
       kf_info = 1,
       kf_strings = 2,
       kf_texts = 3,
       kf_numbers = 4, /* u32 */
       kf_wides = 5,   /* u64 */
       kf_shaders = 6,
       kf_axes = 7,
       kf_values = 8,
       kf_stages = 9,
       kf_rules = 10,
       kf_diagrams = 11,
       kf_nodes = 12, /* u32 */
       kf_checks = 13,
       kf_slots = 14,
       kf_pipelines = 15,
       kf_modules = 16,
       kf_reflections = 17,
       kf_resources = 18,
       kf_members = 19,
       kf_varyings = 20,
       kf_artifacts = 21,
       kf_blocks = 22,
       kf_packed = 23, /* bytes */
       kf_spirv = 24,  /* u32 */
       kf_section_last = 24
};

enum { kf_dense32 = 0, kf_dense16 = 1, kf_runs = 2 };                       /* on disk: append only */
enum { kf_codec_raw = 0, kf_codec_lz4 = 1 };                                /* on disk: append only */
enum { kf_leaf_forbidden = 0, kf_leaf_not_needed = 1, kf_leaf_needed = 2 }; /* on disk: append only */
enum { kf_writes_depth = 1, kf_discards = 2 };                              /* reflection flags; on disk: append only */
enum { kf_arrayed = 1, kf_multisampled = 2, kf_depth = 4, kf_readonly = 8, kf_writeonly = 16 }; /* resource flags; append only */
enum { kf_row_major = 1 }; /* member flags; on disk: append only */
enum { kf_flat = 1, kf_no_perspective = 2, kf_centroid = 4, kf_sample = 8, kf_patch = 16 }; /* varying flags; append only */

typedef struct kf_header {
    uint8_t magic[8];
    uint32_t version, sections;
    uint64_t file_bytes, checksum;
} kf_header;

typedef struct kf_entry {
    uint32_t kind, stride;
    uint64_t offset, bytes, used, checksum;
} kf_entry;

typedef struct kf_text {
    uint32_t at, size;
} kf_text;

typedef struct kf_range {
    uint32_t first, count;
} kf_range;

typedef struct kf_info_record { /* one */
    kf_text name, tools;
    uint32_t vulkan, spirv; /* major << 8 | minor */
    kf_range targets;       /* numbers: kiln_target, in the manifest's order */
    kf_range scenes;        /* texts: what the needed set came from; none: everything legal */
} kf_info_record;

typedef struct kf_shader_record {
    kf_text name;
    kf_text declared, legal, needed; /* decimal */
    kf_range axes, stages, rules, slots, pipelines;
    kf_range modules; /* numbers: modules that this shader uses, ascending */
    kf_range order;   /* numbers: the axes in the order in which diagrams test them */
    kf_range checks;  /* one a word of a key, at least one */
    uint32_t status;  /* diagram: kf_leaf_* */
    uint32_t zero;
    uint32_t artifacts; /* numbers, first of [target][module of the list above]: artifact, KF_NO_ARTIFACT or KF_HOLE */
    uint32_t used;      /* wides, first of [module of the list above][slots / 64 rounded up]: the slots that it uses */
} kf_shader_record;

typedef struct kf_axis_record {
    kf_text name, macro;
    kf_range values;
    uint32_t kind, field;
} kf_axis_record;

typedef struct kf_value_record {
    kf_text name;
    int32_t number;
    uint32_t zero;
} kf_value_record;

typedef struct kf_stage_record {
    uint32_t stage, diagram; /* diagram's leaves: index into the shader's module list */
    kf_range axes;           /* numbers: the axes that the diagram tests, ascending */
} kf_stage_record;

typedef struct kf_rule_record {
    kf_text text, because;
    uint32_t forbid, diagram; /* leaf 1: broken, 0: kept */
} kf_rule_record;

typedef struct kf_diagram_record {
    uint32_t at, words;    /* in nodes */
    uint32_t root, leaves; /* every leaf is below `leaves` */
} kf_diagram_record;

typedef struct kf_check_record { /* is a word w of a key made of digits that exist */
    uint64_t mask;               /* the bits that some axis owns: w & ~mask is 0 */
    uint64_t addend; /* in each field what its radix lacks to the next power of two: w + addend carries out of no field */
    uint64_t carry;  /* the bits above the fields with such an addend, where carries would show; bit 64 by overflow */
} kf_check_record;

typedef struct kf_slot_record {
    kf_text name;
    uint32_t kind, set, binding, buffer, texture, sampler, image, uav, metal_buffer, metal_texture, unit_offset, zero;
} kf_slot_record;

typedef struct kf_pipeline_record {
    kf_text count;    /* decimal */
    uint32_t modules; /* numbers, one a stage of the shader */
    uint32_t witness; /* wides, one key */
} kf_pipeline_record;

typedef struct kf_module_record {
    uint32_t stage, reflection;
    uint32_t at, words; /* in spirv */
    uint8_t digest[32]; /* SHA-256 of the words */
} kf_module_record;

typedef struct kf_reflection_record {
    kf_text entry;
    uint32_t stage, flags;
    uint32_t workgroup[3], zero;
    kf_range resources, inputs, outputs; /* inputs, outputs: varyings */
} kf_reflection_record;

typedef struct kf_type_record {
    uint32_t base, rows, columns, zero;
    kf_range array; /* numbers, outermost first, 0: sized at run time */
} kf_type_record;

typedef struct kf_resource_record {
    kf_text name;
    uint32_t kind, set, binding, bytes;
    kf_range array; /* numbers */
    kf_range members;
    uint32_t dim, flags, sampled, format;
} kf_resource_record;

typedef struct kf_member_record {
    kf_text name;
    kf_type_record type;
    kf_range strides; /* numbers, one a dimension of type.array */
    uint32_t offset, size, array_stride, matrix_stride, flags, zero;
} kf_member_record;

typedef struct kf_varying_record {
    kf_text name;
    kf_type_record type;
    uint32_t location, component, index, flags;
} kf_varying_record;

typedef struct kf_artifact_record {
    uint32_t target, block;
    uint32_t at, size; /* in the unpacked block */
} kf_artifact_record;

typedef struct kf_block_record {
    uint64_t at; /* in packed */
    uint32_t packed, unpacked;
    uint32_t codec, zero;
} kf_block_record;

/* Word `skip` counts as zero: the header's own checksum. Pass ~0 to skip none. */
static inline uint64_t kf_checksum(const uint8_t* data, uint64_t words, uint64_t skip) {
    uint64_t h = words;
    for (uint64_t i = 0; i < words; ++i) {
        uint64_t w = 0;
        if (i != skip) memcpy(&w, data + 8 * i, sizeof w);
        h = (h ^ w) * 0x9E3779B97F4A7C15u;
        h ^= h >> 32;
    }
    return h;
}

#define KF_NO_SKIP 0xffffffffffffffffu
#define KF_HEADER_SKIP (sizeof(kf_header) / 8 - 1) /* the last word of the header */

/* Bytes of one record, by section: what this version writes, and the least that a reader accepts. */
#define KF_STRIDES                                                                                                         \
    {                                                                                                                      \
        0, sizeof(kf_info_record), 1, sizeof(kf_text), 4, 8, sizeof(kf_shader_record), sizeof(kf_axis_record),             \
            sizeof(kf_value_record), sizeof(kf_stage_record), sizeof(kf_rule_record), sizeof(kf_diagram_record), 4,        \
            sizeof(kf_check_record), sizeof(kf_slot_record), sizeof(kf_pipeline_record), sizeof(kf_module_record),         \
            sizeof(kf_reflection_record), sizeof(kf_resource_record), sizeof(kf_member_record), sizeof(kf_varying_record), \
            sizeof(kf_artifact_record), sizeof(kf_block_record), 1, 4                                                      \
    }

#endif
