/* Axes and values by name, keys from digits and back, and misses said in words. */
#include "compiler/runtime/internal.h"

kiln_status kiln_get_axis(const kiln_shader* s, uint32_t axis, kiln_axis* out) {
    kf_axis_record r;
    memset(out, 0, sizeof *out);
    out->name = out->macro = kiln_text_at(s->table, (kf_text){KILN_NONE, 0});
    if (axis >= s->axis_count) return KILN_ABSENT;
    if (!KILN_LOAD(s->table, kf_axes, (uint64_t)s->private_.axes + axis, &r)) return KILN_DAMAGED;
    if (!kiln_fits(s->table, kf_values, r.values.first, r.values.count)) return KILN_DAMAGED;
    if ((r.field & 0xffffu) >= s->key_words) return KILN_DAMAGED;
    out->name = kiln_text_at(s->table, r.name);
    out->macro = kiln_text_at(s->table, r.macro);
    out->kind = r.kind;
    out->value_count = r.values.count;
    out->word = r.field & 0xffffu;
    out->shift = r.field >> 16 & 63u;
    out->bits = r.field >> 22 & 31u;
    out->private_[0] = r.values.first;
    out->private_[1] = r.field;
    return KILN_OK;
}

static kiln_status value_at(const kiln_shader* s, const kiln_axis* axis, uint32_t digit, kiln_value* out) {
    kf_value_record r;
    out->name = kiln_text_at(s->table, (kf_text){KILN_NONE, 0});
    out->number = 0;
    if (digit >= axis->value_count) return KILN_ABSENT;
    if (!KILN_LOAD(s->table, kf_values, (uint64_t)axis->private_[0] + digit, &r)) return KILN_DAMAGED;
    out->name = kiln_text_at(s->table, r.name);
    out->number = r.number;
    return KILN_OK;
}

kiln_status kiln_get_value(const kiln_shader* s, uint32_t axis, uint32_t digit, kiln_value* out) {
    kiln_axis a;
    const kiln_status status = kiln_get_axis(s, axis, &a);
    const kiln_status found = value_at(s, &a, digit, out);
    return status != KILN_OK ? status : found;
}

uint32_t kiln_find_axis(const kiln_shader* s, const char* name) {
    for (uint32_t i = 0; i < s->axis_count; ++i) {
        kiln_axis a;
        if (kiln_get_axis(s, i, &a) == KILN_OK && kiln_same(a.name, name)) return i;
    }
    return KILN_NONE;
}

uint32_t kiln_find_value(const kiln_shader* s, uint32_t axis, const char* value) {
    kiln_axis a;
    if (kiln_get_axis(s, axis, &a) != KILN_OK) return KILN_NONE;
    for (uint32_t i = 0; i < a.value_count; ++i) {
        kiln_value v;
        if (value_at(s, &a, i, &v) == KILN_OK && kiln_same(v.name, value)) return i;
    }
    return KILN_NONE;
}

kiln_status kiln_key_set(const kiln_shader* s, uint64_t* key, uint32_t axis, uint32_t digit) {
    kiln_axis a;
    const kiln_status status = kiln_get_axis(s, axis, &a);
    uint64_t mask;
    if (status != KILN_OK) return status;
    mask = ((uint64_t)1 << a.bits) - 1;
    if (digit >= a.value_count || digit > mask) return KILN_BAD_KEY;
    key[a.word] = (key[a.word] & ~(mask << a.shift)) | (uint64_t)digit << a.shift;
    return KILN_OK;
}

uint32_t kiln_key_get(const kiln_shader* s, const uint64_t* key, uint32_t axis) {
    kiln_axis a;
    if (kiln_get_axis(s, axis, &a) != KILN_OK) return KILN_NONE;
    return kiln_digit(key, s->key_words, a.private_[1]);
}

kiln_status kiln_pack(const kiln_shader* s, const uint32_t* digits, uint64_t* key) {
    memset(key, 0, (size_t)8 * s->key_words);
    for (uint32_t i = 0; i < s->axis_count; ++i) {
        const kiln_status status = kiln_key_set(s, key, i, digits[i]);
        if (status != KILN_OK) return status;
    }
    return KILN_OK;
}

kiln_status kiln_unpack(const kiln_shader* s, const uint64_t* key, uint32_t* digits) {
    kiln_status status = KILN_OK;
    for (uint32_t i = 0; i < s->axis_count; ++i) {
        kiln_axis a;
        if (kiln_get_axis(s, i, &a) != KILN_OK) return KILN_DAMAGED;
        digits[i] = kiln_digit(key, s->key_words, a.private_[1]);
        if (digits[i] >= a.value_count) status = KILN_BAD_KEY;
    }
    return status;
}

kiln_status kiln_get_rule(const kiln_shader* s, uint32_t rule, kiln_rule* out) {
    kf_rule_record r;
    out->text = out->because = kiln_text_at(s->table, (kf_text){KILN_NONE, 0});
    out->forbid = 0;
    if (rule >= s->rule_count) return KILN_ABSENT;
    if (!KILN_LOAD(s->table, kf_rules, (uint64_t)s->private_.rules + rule, &r)) return KILN_DAMAGED;
    out->text = kiln_text_at(s->table, r.text);
    out->because = kiln_text_at(s->table, r.because);
    out->forbid = r.forbid;
    return KILN_OK;
}

kiln_status kiln_check_rule(const kiln_shader* s, uint32_t rule, const uint64_t* key) {
    kf_rule_record r;
    kiln_diagram d;
    if (rule >= s->rule_count) return KILN_ABSENT;
    if (!KILN_LOAD(s->table, kf_rules, (uint64_t)s->private_.rules + rule, &r) || !kiln_diagram_at(s->table, r.diagram, &d))
        return KILN_DAMAGED;
    switch (kiln_walk(&d, key, s->key_words)) {
        case 0:
            return KILN_OK;
        case 1:
            return KILN_FORBIDDEN;
        default:
            return KILN_DAMAGED;
    }
}

/* A bounded line of text that knows how long it would have been. */
typedef struct line {
    char* to;
    size_t capacity, size;
} line;

static void add(line* l, const char* text, size_t size) {
    if (l->size < l->capacity) {
        const size_t room = l->capacity - l->size;
        memcpy(l->to + l->size, text, size < room ? size : room);
    }
    l->size += size;
}

static void say(line* l, const char* text) { add(l, text, strlen(text)); }

static void say_number(line* l, uint32_t v) {
    char digits[10];
    size_t at = sizeof digits;
    do {
        digits[--at] = (char)('0' + v % 10);
        v /= 10;
    } while (v != 0);
    add(l, digits + at, sizeof digits - at);
}

static void say_variant(line* l, const kiln_shader* s, const uint64_t* key) {
    add(l, s->name.data, s->name.size);
    for (uint32_t i = 0; i < s->axis_count; ++i) {
        kiln_axis a;
        kiln_value v;
        if (kiln_get_axis(s, i, &a) != KILN_OK) return;
        say(l, " ");
        add(l, a.name.data, a.name.size);
        say(l, "=");
        if (value_at(s, &a, kiln_digit(key, s->key_words, a.private_[1]), &v) == KILN_OK)
            add(l, v.name.data, v.name.size);
        else
            say(l, "?");
    }
}

static void say_bad_key(line* l, const kiln_shader* s, const uint64_t* key) {
    for (uint32_t i = 0; i < s->axis_count; ++i) {
        kiln_axis a;
        uint32_t digit;
        if (kiln_get_axis(s, i, &a) != KILN_OK) break;
        digit = kiln_digit(key, s->key_words, a.private_[1]);
        if (digit < a.value_count) continue;
        say(l, ": axis ");
        add(l, a.name.data, a.name.size);
        say(l, " has no value number ");
        say_number(l, digit);
        say(l, ", only 0 to ");
        say_number(l, a.value_count ? a.value_count - 1 : 0);
        return;
    }
    say(l, ": the key has a bit that no axis owns");
}

static void say_rule(line* l, const kiln_shader* s, const uint64_t* key) {
    for (uint32_t i = 0; i < s->rule_count; ++i) {
        kiln_rule r;
        if (kiln_check_rule(s, i, key) != KILN_FORBIDDEN || kiln_get_rule(s, i, &r) != KILN_OK) continue;
        say(l, r.forbid ? ": forbid: " : ": require: ");
        add(l, r.text.data, r.text.size);
        if (r.because.size) {
            say(l, " (");
            add(l, r.because.data, r.because.size);
            say(l, ")");
        }
        return;
    }
}

static void say_scenes(line* l, const kiln_shader* s) {
    kiln_info info;
    if (kiln_get_info(s->table, &info) != KILN_OK || info.scene_count == 0) {
        say(l, " is not needed");
        return;
    }
    say(l, " is not needed by ");
    for (uint32_t i = 0; i < info.scene_count; ++i) {
        const kiln_text scene = kiln_get_scene(s->table, i);
        if (i) say(l, ", ");
        add(l, scene.data, scene.size);
    }
}

size_t kiln_why(const kiln_shader* s, const uint64_t* key, char* buffer, size_t capacity) {
    line l;
    const kiln_status status = kiln_check(s, key);
    l.to = buffer;
    l.capacity = capacity ? capacity - 1 : 0;
    l.size = 0;
    say_variant(&l, s, key);
    switch (status) {
        case KILN_OK:
            say(&l, " is in the table");
            break;
        case KILN_FORBIDDEN:
            say(&l, " is forbidden");
            say_rule(&l, s, key);
            break;
        case KILN_NOT_NEEDED:
            say_scenes(&l, s);
            break;
        case KILN_BAD_KEY:
            say_bad_key(&l, s, key);
            break;
        default:
            say(&l, ": ");
            say(&l, kiln_status_text(status));
    }
    if (capacity) buffer[l.size < l.capacity ? l.size : l.capacity] = 0;
    return l.size;
}
