#ifndef KILN_H
#define KILN_H
/*
 * Reads a variant table (.kiln): key -> modules -> artifacts, with reflection. C99, standard library only.
 *
 * The reader allocates nothing, throws nothing, keeps no state of its own and writes only where it is told to: any number of
 * threads may read one table. The caller keeps the bytes (a read-only mapping, 8-byte aligned) alive and unchanged for as
 * long as anything that came from them is in use; texts, words and arrays point into them. Hosts are little-endian.
 *
 * kiln_open looks at the header and the section table only. Everything later is bounds-checked where it is used, so a table
 * that was opened and never verified can give wrong answers but cannot make the reader leave its bytes or loop for ever.
 * kiln_verify reads every byte.
 *
 * Text is never NULL, ends in a zero byte that `size` does not count, and is empty where the table is damaged.
 */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define KILN_NONE 0xffffffffu
#define KILN_MAX_STAGES 14

typedef enum kiln_status {
    KILN_OK = 0,
    KILN_FORBIDDEN = 1,    /* the rules forbid this variant */
    KILN_NOT_NEEDED = 2,   /* legal, and left out: no scene that the table was built for draws it */
    KILN_BAD_KEY = 3,      /* a digit that its axis does not have, or a bit that no axis owns */
    KILN_ABSENT = 4,       /* no such shader, stage, module, target ... in this table */
    KILN_REFUSED = 5,      /* the target cannot say this module; the reason comes with it */
    KILN_SHORT_BUFFER = 6, /* the caller's buffer is too small; nothing was written */
    KILN_NOT_A_TABLE = 7,
    KILN_NEWER = 8, /* written by a later, incompatible kiln */
    KILN_TRUNCATED = 9,
    KILN_DAMAGED = 10,
    KILN_MISALIGNED = 11, /* the bytes do not start at a multiple of 8 */
    KILN_BIG_ENDIAN = 12  /* this host is */
} kiln_status;

const char* kiln_status_text(kiln_status status); /* a sentence without a full stop */

typedef struct kiln_text {
    const char* data;
    uint32_t size;
} kiln_text;

/* ---- the table ---- */

typedef struct kiln_section {
    const uint8_t* data;
    uint64_t count;
    uint32_t stride;
} kiln_section;

typedef struct kiln_table { /* private; fill it with kiln_open */
    const uint8_t* bytes;
    uint64_t size;
    kiln_section section[25];
} kiln_table;

kiln_status kiln_open(kiln_table* table, const void* bytes, size_t size);
/* Checksums of everything, zero padding, and that every reference inside fits. `what`, if not NULL, gets a sentence. */
kiln_status kiln_verify(const kiln_table* table, const char** what);

typedef struct kiln_info {
    kiln_text name, tools;  /* the manifest's; every tool and its version */
    uint32_t vulkan, spirv; /* versions asked for, major << 8 | minor */
    uint32_t shader_count, module_count, artifact_count, target_count, scene_count, block_count;
    uint64_t spirv_bytes, text_bytes, packed_bytes; /* text before and after packing */
} kiln_info;

kiln_status kiln_get_info(const kiln_table* table, kiln_info* info);
uint32_t kiln_get_target(const kiln_table* table, uint32_t index); /* kiln_target, or KILN_NONE */
kiln_text kiln_get_scene(const kiln_table* table, uint32_t index);

/* ---- shaders and keys ---- */

typedef struct kiln_diagram { /* private */
    const uint8_t* nodes;
    uint32_t words, root, leaves;
    const uint8_t* cells; /* not NULL: all of it is one array of 16-bit leaves, indexed by one field */
    uint32_t field, size;
} kiln_diagram;

typedef struct kiln_shader { /* a handle: fetch it once, look up with it often. The table must stay where it is. */
    const kiln_table* table;
    kiln_text name;
    kiln_text declared, legal, needed; /* how many variants, decimal: they may pass 64 bits */
    uint32_t index;
    uint32_t axis_count, stage_count, slot_count, module_count, pipeline_count, rule_count;
    uint32_t key_words;              /* 64-bit words in a key */
    uint32_t stage[KILN_MAX_STAGES]; /* kiln_stage, ascending */
    struct {
        uint32_t axes, stages, slots, pipelines, rules, target_count;
        const uint8_t *checks, *modules, *artifacts, *used;
        uint32_t check_stride, used_words;
        kiln_diagram status, stage[KILN_MAX_STAGES];
    } private_;
} kiln_shader;

kiln_status kiln_get_shader(const kiln_table* table, uint32_t index, kiln_shader* shader);
kiln_status kiln_find_shader(const kiln_table* table, const char* name, kiln_shader* shader);

typedef enum kiln_axis_kind { KILN_NAMED = 0, KILN_INTEGER = 1, KILN_BOOLEAN = 2, KILN_DEFINED = 3 } kiln_axis_kind;

typedef struct kiln_axis {
    kiln_text name, macro;
    uint32_t kind; /* kiln_axis_kind */
    uint32_t value_count;
    uint32_t word, shift, bits; /* where its digit is in a key */
    uint32_t private_[2];
} kiln_axis;

typedef struct kiln_value {
    kiln_text name;
    int32_t number; /* what the macro expands to */
} kiln_value;

kiln_status kiln_get_axis(const kiln_shader* shader, uint32_t axis, kiln_axis* out);
kiln_status kiln_get_value(const kiln_shader* shader, uint32_t axis, uint32_t digit, kiln_value* out);
uint32_t kiln_find_axis(const kiln_shader* shader, const char* name);                  /* or KILN_NONE */
uint32_t kiln_find_value(const kiln_shader* shader, uint32_t axis, const char* value); /* a digit, or KILN_NONE */

/* A key is `key_words` words; all zero is every axis at its first value. A digit counts values from 0. */
kiln_status kiln_key_set(const kiln_shader* shader, uint64_t* key, uint32_t axis, uint32_t digit);
uint32_t kiln_key_get(const kiln_shader* shader, const uint64_t* key, uint32_t axis);
kiln_status kiln_pack(const kiln_shader* shader, const uint32_t* digits, uint64_t* key); /* one digit an axis */
kiln_status kiln_unpack(const kiln_shader* shader, const uint64_t* key, uint32_t* digits);

/* ---- looking up ---- */

/* KILN_OK (needed), KILN_FORBIDDEN, KILN_NOT_NEEDED, KILN_BAD_KEY or KILN_DAMAGED. */
kiln_status kiln_check(const kiln_shader* shader, const uint64_t* key);
/* As kiln_check; on KILN_OK `modules` has one module a stage of the shader, in the order of shader->stage. */
kiln_status kiln_find(const kiln_shader* shader, const uint64_t* key, uint32_t* modules);
kiln_status kiln_find_stage(const kiln_shader* shader, const uint64_t* key, uint32_t stage_index, uint32_t* module);

/* Says in words what kiln_check says, with axis=value names and the rule that forbids. Writes at most `capacity` bytes, the
 * last of them zero, and returns the length of the whole message, as snprintf does. */
size_t kiln_why(const kiln_shader* shader, const uint64_t* key, char* buffer, size_t capacity);

typedef struct kiln_rule {
    kiln_text text, because;
    uint32_t forbid; /* 1: must be false; 0: must be true */
} kiln_rule;

kiln_status kiln_get_rule(const kiln_shader* shader, uint32_t rule, kiln_rule* out);
/* KILN_OK when the variant keeps the rule, KILN_FORBIDDEN when it breaks it. */
kiln_status kiln_check_rule(const kiln_shader* shader, uint32_t rule, const uint64_t* key);

/* The axes that decide a stage's module: writes up to `capacity` axis indices, ascending, returns how many there are. */
uint32_t kiln_stage_axes(const kiln_shader* shader, uint32_t stage_index, uint32_t* axes, uint32_t capacity);

typedef struct kiln_pipeline { /* a distinct tuple of modules that some needed variant uses */
    kiln_text count;           /* needed variants that use it, decimal */
    const uint32_t* modules;   /* one a stage */
    const uint64_t* witness;   /* key of its smallest variant */
} kiln_pipeline;

kiln_status kiln_get_pipeline(const kiln_shader* shader, uint32_t index, kiln_pipeline* out);

/* ---- modules and artifacts ---- */

typedef struct kiln_module {
    uint32_t stage;        /* kiln_stage */
    const uint32_t* words; /* SPIR-V, in place */
    uint32_t word_count;
    const uint8_t* digest; /* SHA-256 of the words, 32 bytes */
} kiln_module;

kiln_status kiln_get_module(const kiln_table* table, uint32_t module, kiln_module* out);
uint32_t kiln_shader_module(const kiln_shader* shader, uint32_t index); /* the shader's modules, ascending; or KILN_NONE */

typedef struct kiln_artifact {
    uint32_t index;   /* artifacts of one table are distinct */
    uint32_t target;  /* kiln_target */
    uint32_t size;    /* bytes of text */
    uint32_t buffer;  /* bytes that kiln_decode needs: the text and what is packed before it, at most 64 KiB more */
    kiln_text reason; /* with KILN_REFUSED: why the target cannot say it */
} kiln_artifact;

/* KILN_OK, KILN_REFUSED (stated hole), or KILN_ABSENT: not a module of this shader, or not a target of this table. */
kiln_status kiln_find_artifact(const kiln_shader* shader, uint32_t module, uint32_t target, kiln_artifact* out);
/* Puts the text at the start of `buffer`, with a zero byte after it. */
kiln_status kiln_decode(const kiln_table* table, uint32_t artifact, void* buffer, size_t capacity);
kiln_status kiln_get_artifact(const kiln_table* table, uint32_t index, kiln_artifact* out);

/* ---- layout and reflection ---- */

typedef struct kiln_slot { /* one resource of the shader's union; the same in every variant */
    kiln_text name;
    uint32_t kind;                        /* kiln_resource_kind */
    uint32_t set, binding;                /* Vulkan; KILN_NONE for push constants */
    uint32_t buffer;                      /* GL buffer binding, HLSL b */
    uint32_t texture;                     /* GL texture unit, HLSL t */
    uint32_t sampler;                     /* HLSL s, Metal [[sampler]] */
    uint32_t image;                       /* GL image unit */
    uint32_t uav;                         /* HLSL u */
    uint32_t metal_buffer, metal_texture; /* Metal [[buffer]], [[texture]] */
    uint32_t unit_offset; /* GL: separate image + sampler take the unit image.texture + sampler.unit_offset; an image that is
                           * only fetched takes image.texture + image.unit_offset */
} kiln_slot;

kiln_status kiln_get_slot(const kiln_shader* shader, uint32_t slot, kiln_slot* out);
int kiln_uses_slot(const kiln_shader* shader, uint32_t module, uint32_t slot); /* 1 or 0 */

typedef struct kiln_reflection {
    uint32_t stage;
    kiln_text entry;
    uint32_t resource_count, input_count, output_count;
    uint32_t workgroup[3]; /* 0 where the stage has none */
    int writes_depth, discards;
    uint32_t private_[3];
} kiln_reflection;

typedef struct kiln_type {
    uint32_t base; /* kiln_base_type */
    uint32_t rows, columns;
    const uint32_t* array; /* outermost first, 0: sized at run time */
    uint32_t array_count;
} kiln_type;

typedef struct kiln_resource {
    kiln_text name;
    uint32_t kind; /* kiln_resource_kind */
    uint32_t set, binding;
    uint32_t bytes; /* of a block, without its run-time array */
    const uint32_t* array;
    uint32_t array_count;
    uint32_t member_count;
    uint32_t dim; /* kiln_dim */
    int arrayed, multisampled, depth, readonly, writeonly;
    uint32_t sampled; /* kiln_base_type */
    uint32_t format;  /* SPIR-V ImageFormat of a storage image */
    uint32_t private_;
} kiln_resource;

typedef struct kiln_member {
    kiln_text name; /* nested: "lights[].position" */
    kiln_type type;
    uint32_t offset, size;   /* bytes; size 0: sized at run time */
    uint32_t array_stride;   /* of the innermost array, 0 when none */
    const uint32_t* strides; /* one a dimension of type.array, outermost first */
    uint32_t matrix_stride;
    int row_major;
} kiln_member;

typedef struct kiln_varying {
    kiln_text name;
    uint32_t location, component, index;
    kiln_type type;
    int flat, no_perspective, centroid, sample, patch;
} kiln_varying;

kiln_status kiln_get_reflection(const kiln_table* table, uint32_t module, kiln_reflection* out);
kiln_status kiln_get_resource(const kiln_table* table, const kiln_reflection* of, uint32_t index, kiln_resource* out);
kiln_status kiln_get_member(const kiln_table* table, const kiln_resource* of, uint32_t index, kiln_member* out);
kiln_status kiln_get_input(const kiln_table* table, const kiln_reflection* of, uint32_t index, kiln_varying* out);
kiln_status kiln_get_output(const kiln_table* table, const kiln_reflection* of, uint32_t index, kiln_varying* out);

/* ---- numbers that are on disk: append only ---- */

typedef enum kiln_stage {
    KILN_VERTEX = 0,
    KILN_TESS_CONTROL = 1,
    KILN_TESS_EVALUATION = 2,
    KILN_GEOMETRY = 3,
    KILN_FRAGMENT = 4,
    KILN_COMPUTE = 5,
    KILN_TASK = 6,
    KILN_MESH = 7,
    KILN_RAYGEN = 8,
    KILN_INTERSECTION = 9,
    KILN_ANY_HIT = 10,
    KILN_CLOSEST_HIT = 11,
    KILN_MISS = 12,
    KILN_CALLABLE = 13
} kiln_stage;

typedef enum kiln_target {
    KILN_SPIRV = 0,
    KILN_GLSL330 = 1,
    KILN_GLSL450 = 2,
    KILN_ESSL300 = 3,
    KILN_ESSL310 = 4,
    KILN_HLSL50 = 5,
    KILN_HLSL60 = 6,
    KILN_MSL21 = 7,
    KILN_MSL22 = 8,
    KILN_MSL23 = 9,
    KILN_MSL24 = 10,
    KILN_MSL30 = 11
} kiln_target;

typedef enum kiln_resource_kind {
    KILN_UNIFORM_BLOCK = 0,
    KILN_STORAGE_BLOCK = 1,
    KILN_COMBINED_IMAGE = 2,
    KILN_SEPARATE_IMAGE = 3,
    KILN_SEPARATE_SAMPLER = 4,
    KILN_STORAGE_IMAGE = 5,
    KILN_UNIFORM_TEXELS = 6,
    KILN_STORAGE_TEXELS = 7,
    KILN_INPUT_ATTACHMENT = 8,
    KILN_ACCELERATION_STRUCTURE = 9,
    KILN_PUSH_CONSTANTS = 10
} kiln_resource_kind;

typedef enum kiln_base_type {
    KILN_FLOAT32 = 0,
    KILN_FLOAT16 = 1,
    KILN_FLOAT64 = 2,
    KILN_INT32 = 3,
    KILN_UINT32 = 4,
    KILN_INT16 = 5,
    KILN_UINT16 = 6,
    KILN_INT64 = 7,
    KILN_UINT64 = 8,
    KILN_BOOL = 9,
    KILN_INT8 = 10,
    KILN_UINT8 = 11,
    KILN_STRUCTURE = 12
} kiln_base_type;

typedef enum kiln_dim {
    KILN_DIM_NONE = 0,
    KILN_DIM_1D = 1,
    KILN_DIM_2D = 2,
    KILN_DIM_3D = 3,
    KILN_DIM_CUBE = 4,
    KILN_DIM_RECT = 5,
    KILN_DIM_BUFFER = 6,
    KILN_DIM_SUBPASS = 7
} kiln_dim;

#ifdef __cplusplus
}
#endif
#endif
