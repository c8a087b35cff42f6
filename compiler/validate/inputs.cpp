#include "compiler/validate/inputs.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "compiler/validate/blocks.h"
#include "compiler/validate/textures.h"
#include "compiler/validate/values.h"

namespace kiln {

namespace {

constexpr uint32_t array_limit = 1024;        // descriptors at one binding
constexpr uint32_t run_time_descriptors = 4;  // of an array without a size
constexpr uint32_t texel_buffer_elements = 256;
constexpr uint32_t dispatched_side = 64;  // invocations along x, and along y where the workgroup has a y

uint32_t descriptors_of(const Resource& r) {
    uint64_t n = 1;
    for (const uint32_t dim : r.array) n = std::min<uint64_t>(n * (dim == 0 ? run_time_descriptors : dim), array_limit);
    return static_cast<uint32_t>(n);
}

Bytes texel_buffer(const Resource& r, uint64_t seed, bool either_sign) {
    Bytes out(texel_buffer_elements * 16);
    for (uint32_t i = 0; i < texel_buffer_elements * 4; ++i) {
        const float v = ordinary(seed, i, either_sign);
        uint32_t word = static_cast<uint32_t>(mix64(seed ^ i) & 3);
        if (r.sampled != BaseType::int32 && r.sampled != BaseType::uint32) std::memcpy(&word, &v, 4);
        std::memcpy(out.data() + size_t{i} * 4, &word, 4);
    }
    return out;
}

Binding make_binding(const Resource& r, const InputOptions& options) {
    Binding b = bare_binding(r);
    const bool either_sign = options.mood == Mood::mixed;
    for (uint32_t i = 0; i < b.descriptors; ++i) {
        const uint64_t seed = mix64(seed_of(options.seed, r.name) ^ i);
        switch (r.kind) {
            case ResourceKind::uniform_block:
            case ResourceKind::storage_block:
                b.buffers.push_back(fill_block(r, mix64(options.seed ^ i), either_sign));
                break;
            case ResourceKind::uniform_texels:
            case ResourceKind::storage_texels:
                b.buffers.push_back(texel_buffer(r, seed, either_sign));
                break;
            case ResourceKind::combined_image:
            case ResourceKind::separate_image:
            case ResourceKind::storage_image:
            case ResourceKind::input_attachment:
                b.images.push_back(make_image(r, seed, either_sign));
                break;
            default:
                break;
        }
    }
    return b;
}

bool can_be_position(const Varying& v) {
    return v.type.base == BaseType::float32 && v.type.rows >= 2 && v.type.columns == 1 && v.type.array.empty() &&
           v.component == 0;
}

void put(Bytes& out, BaseType base, double v) {
    const auto append = [&](auto number) {
        const size_t at = out.size();
        out.resize(at + sizeof number);
        std::memcpy(out.data() + at, &number, sizeof number);
    };
    switch (base) {
        case BaseType::float64:
            return append(v);
        case BaseType::float32:
        case BaseType::float16:
            return append(static_cast<float>(v));
        default:
            return append(static_cast<int32_t>(v));
    }
}

// Component `c` of a varying's location `l` at a vertex.
double vertex_value(const Varying& v, uint32_t l, uint32_t c, uint32_t vertex, bool position, const InputOptions& options) {
    const auto [x, y] = grid_position(vertex);
    const uint64_t seed = mix64(seed_of(options.seed, v.name) ^ (uint64_t{l} * 4 + c));
    if (v.type.base != BaseType::float32 && v.type.base != BaseType::float64 && v.type.base != BaseType::float16)
        return static_cast<double>(mix64(seed ^ vertex / 6) & 3);
    if (position) {
        if (c == 0) return 0.95 * static_cast<double>(x);
        if (c == 1) return 0.95 * static_cast<double>(y);
        return c == 2 ? 0.2 * std::sin(3.0 * static_cast<double>(x) + 2.0 * static_cast<double>(y)) : 1.0;
    }
    if (v.type.columns > 1) {  // an instance's matrix: near the identity
        const double noise = 0.1 * static_cast<double>(unit(seed, 5));
        return l % v.type.columns == c ? 0.9 : noise;
    }
    const double wave =
        std::sin(6.28 * static_cast<double>(unit(seed, 1)) + (0.5 + static_cast<double>(unit(seed, 2))) * static_cast<double>(x) +
                 (0.5 + static_cast<double>(unit(seed, 3))) * static_cast<double>(y));
    return options.mood == Mood::mixed ? wave : 0.55 + 0.45 * wave;
}

void add_attributes(Inputs& out, const Reflection& vertex, const InputOptions& options) {
    std::string position = options.position;
    if (position.empty())
        for (const Varying& v : vertex.inputs)
            if (can_be_position(v)) {
                position = v.name;
                break;
            }
    struct Component {
        const Varying* varying = nullptr;
        uint32_t location = 0, component = 0;
    };
    std::map<uint32_t, std::vector<Component>> by_location;  // several inputs may share one, by `component`
    for (const Varying& v : vertex.inputs) {
        uint64_t elements = v.type.columns;
        for (const uint32_t dim : v.type.array) elements = std::min<uint64_t>(elements * std::max(1u, dim), 64);
        for (uint32_t l = 0; l < elements; ++l) {
            std::vector<Component>& at = by_location[v.location + l];
            const uint32_t end = v.component + v.type.rows;
            if (at.size() < end) at.resize(std::min(end, 4u));
            for (uint32_t c = v.component; c < at.size() && c < end; ++c) at[c] = {&v, l, c - v.component};
        }
    }
    for (const auto& [location, components] : by_location) {
        Attribute a;
        a.location = location;
        a.components = static_cast<uint32_t>(components.size());
        for (const Component& c : components)
            if (c.varying != nullptr) a.base = c.varying->type.base;
        for (uint32_t vertex_index = 0; vertex_index < out.vertices; ++vertex_index)
            for (const Component& c : components)
                put(a.data, a.base,
                    c.varying == nullptr
                        ? 0.0
                        : vertex_value(*c.varying, c.location, c.component, vertex_index, c.varying->name == position, options));
        out.attributes.push_back(std::move(a));
    }
}

}  // namespace

std::array<float, 2> grid_position(uint32_t vertex) {
    constexpr uint32_t corner_x[2][6] = {{0, 1, 0, 0, 1, 1}, {0, 0, 1, 1, 0, 1}};  // second row: the other winding
    constexpr uint32_t corner_y[2][6] = {{0, 0, 1, 1, 0, 1}, {0, 1, 0, 0, 1, 1}};
    const uint32_t cell = vertex / 6 % (grid_cells * grid_cells), corner = vertex % 6;
    const uint32_t x = cell % grid_cells, y = cell / grid_cells, winding = (x + y) & 1;
    const auto place = [](uint32_t i) { return 2.0f * static_cast<float>(i) / static_cast<float>(grid_cells) - 1.0f; };
    return {place(x + corner_x[winding][corner]), place(y + corner_y[winding][corner])};
}

std::vector<std::string> position_candidates(const std::vector<StageCode>& stages) {
    std::vector<std::string> out;
    for (const StageCode& s : stages)
        if (s.stage == Stage::vertex && !s.partner)
            for (const Varying& v : s.reflection.inputs)
                if (can_be_position(v)) out.push_back(v.name);
    return out;
}

Binding bare_binding(const Resource& r) {
    Binding b;
    b.kind = r.kind;
    b.set = r.set;
    b.binding = r.binding;
    b.name = r.name;
    b.descriptors = descriptors_of(r);
    b.compare = r.depth;
    b.format = r.format;
    b.base = r.sampled == BaseType::int32 || r.sampled == BaseType::uint32 ? r.sampled : BaseType::float32;
    const bool storage =
        r.kind == ResourceKind::storage_block || r.kind == ResourceKind::storage_image || r.kind == ResourceKind::storage_texels;
    b.written = storage && !r.readonly;
    if (r.kind == ResourceKind::storage_block) b.types = word_types(r);
    return b;
}

Inputs make_inputs(const std::vector<StageCode>& stages, const InputOptions& options) {
    Inputs out;
    out.first_instance = static_cast<uint32_t>(options.mood);
    std::map<std::pair<uint32_t, uint32_t>, const Resource*> resources;
    const Resource* push = nullptr;
    for (const StageCode& s : stages) {
        for (const Resource& r : s.reflection.resources) {
            if (r.kind == ResourceKind::push_constants) {
                if (push == nullptr || block_bytes(*push) < block_bytes(r)) push = &r;
                continue;
            }
            const Resource*& known = resources[{r.set, r.binding}];
            // Stages may see different parts of a block: the larger wins; a writer wins over a reader.
            if (known == nullptr || block_bytes(*known) < block_bytes(r) || (known->readonly && !r.readonly) ||
                (!known->depth && r.depth))
                known = &r;
        }
        if (s.stage == Stage::compute || s.stage == Stage::mesh || s.stage == Stage::task)
            for (unsigned i = 0; i < 3; ++i) {
                const uint32_t local = std::max(1u, s.reflection.workgroup[i]);
                const uint32_t wanted = i == 0 || local > 1 ? (i == 2 ? 4u : dispatched_side) : 1u;
                out.groups[i] = (wanted - 1) / local + 1;
            }
    }
    for (const auto& [slot, resource] : resources) out.bindings.push_back(make_binding(*resource, options));
    if (push != nullptr) out.push_constants = fill_block(*push, options.seed, options.mood == Mood::mixed);
    for (const StageCode& s : stages) {
        if (s.stage != Stage::vertex) continue;
        const bool bare = !s.partner && s.reflection.inputs.empty();
        out.vertices = options.vertices != 0 ? options.vertices : bare ? 3u : grid_vertices;
        add_attributes(out, s.reflection, options);
    }
    return out;
}

}  // namespace kiln
