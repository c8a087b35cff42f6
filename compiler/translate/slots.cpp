// Slots come from the union of all variants of a shader and are handed out in the order of set and binding, so that one
// resource has one number in every variant. Each target counts in its own spaces; each space is dense, because the limits
// are low (4 storage blocks in ESSL 310, 16 Metal samplers).
//
// Three things need care. Metal before 3.1 has no atomics on textures: SPIRV-Cross lets them work on the buffer behind the
// image, which is a second argument, so such images get a buffer number as well. HLSL's u registers share a space with render
// targets in shader model 5.0, so they start after the fragment outputs. And an array sized at run time comes last in its spaces,
// since nothing can follow it.

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "compiler/translate/translate.h"

namespace kiln {
namespace {

struct Entry {
    std::string name;
    uint64_t count = 1;
    bool unsized = false;
    bool atomic = false;  // an image that atomics may reach
    Stage stage = Stage::vertex;
    const std::vector<Member>* members = nullptr;  // as the first stage has them
    bool by_stage = false;
};

using Key = std::tuple<bool, uint32_t, uint32_t, ResourceKind>;  // push constants last

Key key_of(const Resource& r) {
    const bool push = r.kind == ResourceKind::push_constants;
    return {push, push ? ~0U : r.set, push ? ~0U : r.binding, r.kind};
}

struct Counters {
    uint32_t uniform = 0, storage = 0, texture = 0, sampler = 0, image = 0, uav = 0, metal_buffer = 0, metal_texture = 0;
};

uint32_t take(uint32_t& counter, uint32_t count) {
    const uint32_t first = counter;
    counter += count;
    return first;
}

void number(Slot& s, uint32_t count, Counters& c) {
    switch (s.kind) {
        case ResourceKind::uniform_block:
        case ResourceKind::push_constants:
            s.buffer = take(c.uniform, count);
            s.metal_buffer = take(c.metal_buffer, count);
            break;
        case ResourceKind::storage_block:
            s.buffer = take(c.storage, count);
            s.uav = take(c.uav, count);
            s.metal_buffer = take(c.metal_buffer, count);
            break;
        case ResourceKind::combined_image:
            s.texture = take(c.texture, count);
            s.sampler = take(c.sampler, count);
            s.metal_texture = take(c.metal_texture, count);
            break;
        case ResourceKind::separate_image:
        case ResourceKind::uniform_texels:
        case ResourceKind::input_attachment:
            s.texture = take(c.texture, count);
            s.metal_texture = take(c.metal_texture, count);
            break;
        case ResourceKind::separate_sampler:
            s.sampler = take(c.sampler, count);
            break;
        case ResourceKind::storage_image:
        case ResourceKind::storage_texels:
            s.image = take(c.image, count);
            s.uav = take(c.uav, count);
            s.metal_texture = take(c.metal_texture, count);
            break;
        case ResourceKind::acceleration_structure:
            s.texture = take(c.texture, count);
            s.metal_buffer = take(c.metal_buffer, count);
            break;
    }
}

std::map<Key, Entry> unite(const std::vector<const Reflection*>& modules) {
    std::map<Key, Entry> all;
    for (const Reflection* m : modules)
        for (const Resource& r : m->resources) {
            Entry& e = all[key_of(r)];
            if (e.name.empty()) e.name = r.name;
            uint64_t count = 1;
            for (const uint32_t length : r.array) {
                e.unsized |= length == 0;
                count = std::min<uint64_t>(count * std::max(length, 1U), 0xffff);
            }
            e.count = std::max(e.count, count);
            constexpr uint32_t r32i = 24, r32ui = 33;
            e.atomic |= r.format == r32i || r.format == r32ui;
            if (!e.members) e.members = &r.members, e.stage = m->stage;
            e.by_stage |= e.stage != m->stage && *e.members != r.members;
        }
    return all;
}

// What every fragment module that reads a location says about it.
std::vector<Interpolation> agreed_interpolation(const std::vector<const Reflection*>& modules) {
    std::map<uint32_t, std::optional<Interpolation>> read;  // nullopt: they disagree
    for (const Reflection* m : modules) {
        if (m->stage != Stage::fragment) continue;
        for (const Varying& v : m->inputs) {
            const Interpolation how{v.location, v.flat, v.no_perspective, v.centroid, v.sample};
            const auto [at, fresh] = read.emplace(v.location, how);
            if (!fresh && at->second != how) at->second.reset();
        }
    }
    std::vector<Interpolation> out;
    for (const auto& [location, how] : read)
        if (how) out.push_back(*how);
    return out;
}

// Reflection names members "Block.member".
bool hands_over_blocks(const std::vector<const Reflection*>& modules) {
    const auto is_member = [](const Varying& v) { return v.name.find('.') != std::string::npos; };
    for (const Reflection* m : modules) {
        const auto& list = m->stage == Stage::fragment ? m->inputs : m->outputs;
        if ((m->stage == Stage::fragment || m->stage == Stage::vertex) && std::any_of(list.begin(), list.end(), is_member))
            return true;
    }
    return false;
}

}  // namespace

SlotLayout assign_slots(const std::vector<const Reflection*>& modules) {
    const std::map<Key, Entry> all = unite(modules);
    Counters counters;
    for (const Reflection* m : modules) {
        if (m->stage != Stage::fragment) continue;
        for (const Varying& v : m->outputs) {
            uint32_t taken = 1;
            for (const uint32_t length : v.type.array) taken *= std::max(length, 1U);
            counters.uav = std::max(counters.uav, v.location + taken);
        }
    }

    SlotLayout out;
    for (const Reflection* m : modules)
        for (const Stage stage : {Stage::tess_evaluation, Stage::geometry, Stage::mesh})
            if (m->stage == stage) out.rasterised = std::max(out.rasterised, stage);
    out.interpolation = agreed_interpolation(modules);
    out.flat_blocks = out.rasterised == Stage::vertex && hands_over_blocks(modules);
    std::set<std::string> names;
    for (const auto& [key, entry] : all) {
        Slot s;
        s.by_stage = entry.by_stage;
        std::tie(std::ignore, s.set, s.binding, s.kind) = key;
        s.name = entry.name;
        if (!names.insert(s.name).second) {
            s.name += "_s" + std::to_string(s.set) + "b" + std::to_string(s.binding);
            names.insert(s.name);
        }
        out.slots.push_back(std::move(s));
    }
    for (const bool unsized : {false, true}) {
        auto slot = out.slots.begin();
        for (const auto& [key, entry] : all) {
            const auto count = static_cast<uint32_t>(entry.count);
            if (entry.unsized == unsized) {
                number(*slot, count, counters);
                if (entry.atomic) slot->metal_buffer = take(counters.metal_buffer, count);
            }
            ++slot;
        }
    }
    const uint32_t units = counters.texture;
    for (Slot& s : out.slots)  // after every texture: read-only blocks' t registers are no GL units
        if (s.kind == ResourceKind::storage_block)
            s.texture = take(counters.texture, static_cast<uint32_t>(all.at({false, s.set, s.binding, s.kind}).count));
    uint32_t samplers = 0;
    for (Slot& s : out.slots)
        if (s.kind == ResourceKind::separate_sampler) s.unit_offset = units * samplers++;
    for (Slot& s : out.slots)
        if (s.kind == ResourceKind::separate_image) s.unit_offset = units * samplers;
    return out;
}

}  // namespace kiln
