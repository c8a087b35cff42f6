#pragma once
// Calls everything that the runtime reader offers on an open table, verified or not: nothing may read outside it, write
// outside its buffers or go on for ever. Shared with the fuzzer.

#include <algorithm>
#include <string>
#include <vector>

#include "compiler/runtime/kiln.h"

namespace kiln::test {

inline size_t touch(kiln_text text) { return std::string(text.data).size() + text.size; }

inline void exercise_reflection(const kiln_table& table, uint32_t module) {
    size_t sum = 0;
    kiln_module m;
    if (kiln_get_module(&table, module, &m) == KILN_OK)
        for (uint32_t i = 0; i < m.word_count; ++i) sum += m.words[i];
    kiln_reflection r;
    if (kiln_get_reflection(&table, module, &r) != KILN_OK) return;
    sum += touch(r.entry);
    const auto type = [&](const kiln_type& t) {
        for (uint32_t i = 0; i < std::min(t.array_count, 64u); ++i) sum += t.array[i];
    };
    for (uint32_t i = 0; i < std::min(r.resource_count, 64u); ++i) {
        kiln_resource res;
        kiln_get_resource(&table, &r, i, &res);
        sum += touch(res.name);
        for (uint32_t a = 0; a < std::min(res.array_count, 64u); ++a) sum += res.array[a];
        for (uint32_t k = 0; k < std::min(res.member_count, 64u); ++k) {
            kiln_member member;
            kiln_get_member(&table, &res, k, &member);
            sum += touch(member.name);
            type(member.type);
            for (uint32_t s = 0; s < std::min(member.type.array_count, 64u); ++s) sum += member.strides[s];
        }
    }
    kiln_varying v;
    for (uint32_t i = 0; i < std::min(r.input_count, 64u); ++i) {
        kiln_get_input(&table, &r, i, &v);
        sum += touch(v.name);
        type(v.type);
    }
    for (uint32_t i = 0; i < std::min(r.output_count, 64u); ++i) {
        kiln_get_output(&table, &r, i, &v);
        sum += touch(v.name);
        type(v.type);
    }
    volatile size_t sink = sum;
    (void)sink;
}

inline void exercise_keys(const kiln_shader& shader) {
    std::vector<uint64_t> key(shader.key_words + 1u);
    std::vector<uint32_t> digits(shader.axis_count + 1u);
    char message[100];
    uint64_t random = 88172645463325252u;
    for (int round = 0; round < 24; ++round) {
        for (uint32_t a = 0; a < std::min(shader.axis_count, 4096u); ++a) {
            kiln_axis axis;
            if (kiln_get_axis(&shader, a, &axis) != KILN_OK) continue;
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            kiln_key_set(&shader, key.data(), a, static_cast<uint32_t>(random % (axis.value_count + 1u)));
            kiln_key_get(&shader, key.data(), a);
        }
        if (round % 8 == 7)
            for (uint64_t& word : key) word = random;
        uint32_t modules[KILN_MAX_STAGES];
        kiln_find(&shader, key.data(), modules);
        for (uint32_t s = 0; s < shader.stage_count; ++s) kiln_find_stage(&shader, key.data(), s, modules);
        for (uint32_t r = 0; r < std::min(shader.rule_count, 64u); ++r) kiln_check_rule(&shader, r, key.data());
        if (shader.axis_count <= 4096 && shader.rule_count <= 4096) kiln_why(&shader, key.data(), message, sizeof message);
        if (shader.axis_count <= 4096) kiln_unpack(&shader, key.data(), digits.data());
    }
}

inline void exercise_shader(const kiln_table& table, const kiln_shader& shader) {
    size_t sum = touch(shader.name) + touch(shader.legal) + touch(shader.needed) + touch(shader.declared);
    for (uint32_t a = 0; a < std::min(shader.axis_count, 256u); ++a) {
        kiln_axis axis;
        kiln_get_axis(&shader, a, &axis);
        sum += touch(axis.name) + touch(axis.macro);
        for (uint32_t v = 0; v < std::min(axis.value_count, 64u); ++v) {
            kiln_value value;
            kiln_get_value(&shader, a, v, &value);
            sum += touch(value.name);
        }
    }
    exercise_keys(shader);
    std::vector<char> buffer;
    for (uint32_t i = 0; i < std::min(shader.module_count, 256u); ++i) {
        const uint32_t module = kiln_shader_module(&shader, i);
        exercise_reflection(table, module);
        for (uint32_t s = 0; s < std::min(shader.slot_count, 128u); ++s)
            sum += static_cast<size_t>(kiln_uses_slot(&shader, module, s));
        for (uint32_t target = 0; target < 12; ++target) {
            kiln_artifact artifact;
            if (kiln_find_artifact(&shader, module, target, &artifact) == KILN_REFUSED) sum += touch(artifact.reason);
            if (artifact.buffer == 0 || artifact.buffer > (1u << 20)) continue;
            buffer.assign(artifact.buffer, 'x');
            if (kiln_decode(&table, artifact.index, buffer.data(), buffer.size()) == KILN_OK)
                sum += std::string(buffer.data()).size();
            kiln_decode(&table, artifact.index, buffer.data(), buffer.size() - 1);
        }
    }
    for (uint32_t s = 0; s < std::min(shader.slot_count, 128u); ++s) {
        kiln_slot slot;
        kiln_get_slot(&shader, s, &slot);
        sum += touch(slot.name);
    }
    for (uint32_t p = 0; p < std::min(shader.pipeline_count, 128u); ++p) {
        kiln_pipeline pipeline;
        if (kiln_get_pipeline(&shader, p, &pipeline) != KILN_OK) continue;
        sum += touch(pipeline.count);
        for (uint32_t s = 0; s < shader.stage_count; ++s) sum += pipeline.modules[s];
        for (uint32_t w = 0; w < shader.key_words; ++w) sum += pipeline.witness[w];
    }
    for (uint32_t r = 0; r < std::min(shader.rule_count, 64u); ++r) {
        kiln_rule rule;
        kiln_get_rule(&shader, r, &rule);
        sum += touch(rule.text) + touch(rule.because);
    }
    uint32_t axes[4];
    for (uint32_t s = 0; s < shader.stage_count; ++s) kiln_stage_axes(&shader, s, axes, 4);
    kiln_find_axis(&shader, "light");
    kiln_find_value(&shader, 0, "point");
    volatile size_t sink = sum;
    (void)sink;
}

inline void exercise_table(const kiln_table& table) {
    kiln_info info;
    kiln_get_info(&table, &info);
    size_t sum = touch(info.name) + touch(info.tools);
    for (uint32_t i = 0; i < std::min(info.scene_count, 16u); ++i) sum += touch(kiln_get_scene(&table, i));
    for (uint32_t i = 0; i < std::min(info.target_count, 16u); ++i) sum += kiln_get_target(&table, i);
    for (uint32_t i = 0; i < 8; ++i) {
        kiln_shader shader;
        if (kiln_get_shader(&table, i, &shader) == KILN_OK) exercise_shader(table, shader);
    }
    kiln_shader none;
    kiln_find_shader(&table, "no such shader", &none);
    for (uint32_t i = 0; i < 64; ++i) exercise_reflection(table, i);
    volatile size_t sink = sum;
    (void)sink;
}

}  // namespace kiln::test
