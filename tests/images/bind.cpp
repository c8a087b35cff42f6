// The scene for the device: blocks, textures and vertices bound by their names.

#include <gtest/gtest.h>

#include <cstring>

#include "compiler/validate/blocks.h"
#include "compiler/validate/inputs.h"
#include "tests/images/scene.h"

namespace kiln::test {

using namespace reference;

namespace {

Bytes bytes_of_floats(const std::vector<float>& values) {
    Bytes out(values.size() * sizeof(float));
    std::memcpy(out.data(), values.data(), out.size());
    return out;
}

std::vector<double> numbers(const V3& v) { return {v.x, v.y, v.z}; }
std::vector<double> numbers(const V4& v) { return {v.x, v.y, v.z, v.w}; }
std::vector<double> numbers(const M4& m) {
    std::vector<double> out;
    for (const V4& c : m.columns)
        for (const double x : {c.x, c.y, c.z, c.w}) out.push_back(x);
    return out;
}

void fill(Bytes& block, const Resource& r, const NamedInputs& inputs) {
    for (const Member& m : r.members) {
        const auto found = inputs.members.find(m.name);
        if (found == inputs.members.end()) {
            ADD_FAILURE() << "nothing for member " << m.name << " of " << r.name;
            continue;
        }
        const size_t each = size_t{m.type.rows} * m.type.columns;
        size_t next = 0;
        for (const size_t at : element_offsets(m)) {
            if (next + each > found->second.size()) {
                ADD_FAILURE() << "too few numbers for " << m.name;
                break;
            }
            store_value(block, at, m, found->second.data() + next);
            next += each;
        }
    }
}

}  // namespace

NamedTexture texture_of(const Texture2D& from) {
    auto image = std::make_shared<ImageData>();
    image->width = static_cast<uint32_t>(from.width());
    image->height = static_cast<uint32_t>(from.height());
    image->texels = bytes_of_floats(from.texels());
    return {image, SamplerState{from.linear() ? Filter::linear : Filter::nearest, MipFilter::none,
                                from.wrap() == TextureWrap::clamp ? Wrap::clamp : Wrap::repeat, Comparison::off}};
}

NamedTexture texture_of(const DepthMap& from) {
    auto image = std::make_shared<ImageData>();
    image->depth = true;
    image->width = static_cast<uint32_t>(from.width());
    image->height = static_cast<uint32_t>(from.height());
    image->texels = bytes_of_floats(from.texels());
    return {image, SamplerState{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal}};
}

NamedTexture texture_of(const DepthCube& from) {
    auto image = std::make_shared<ImageData>();
    image->depth = true;
    image->dim = ImageDim::cube;
    image->layers = 6;
    for (const DepthMap& face : from.faces()) {
        image->width = static_cast<uint32_t>(face.width());
        image->height = static_cast<uint32_t>(face.height());
        const Bytes texels = bytes_of_floats(face.texels());
        image->texels.insert(image->texels.end(), texels.begin(), texels.end());
    }
    return {image, SamplerState{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal}};
}

void put(NamedInputs& out, const Mesh& mesh) {
    const auto f = [](double x) { return static_cast<float>(x); };
    for (const Vertex& v : mesh.vertices) {
        out.attributes["position"].push_back({f(v.position.x), f(v.position.y), f(v.position.z)});
        out.attributes["normal"].push_back({f(v.normal.x), f(v.normal.y), f(v.normal.z)});
        out.attributes["uv"].push_back({f(v.uv.x), f(v.uv.y)});
        out.attributes["lightmap_uv"].push_back({f(v.lightmap_uv.x), f(v.lightmap_uv.y)});
    }
}

void put(NamedInputs& out, const SurfaceBlocks& b) {
    auto& m = out.members;
    m["view_projection"] = numbers(b.view_projection);
    m["previous_view_projection"] = numbers(b.previous_view_projection);
    m["jitter"] = numbers(b.jitter);
    m["camera_position"] = numbers(b.camera_position);
    m["ambient_irradiance"] = numbers(b.ambient_irradiance);
    m["light_position"] = numbers(b.light_position);
    m["light_range"] = {b.light_range};
    m["light_direction"] = numbers(b.light_direction);
    m["light_cos_inner"] = {b.light_cos_inner};
    m["light_intensity"] = numbers(b.light_intensity);
    m["light_cos_outer"] = {b.light_cos_outer};
    m["shadow_view_projection"] = numbers(b.shadow_view_projection);
    m["shadow_near"] = {b.shadow_near};
    m["shadow_far"] = {b.shadow_far};
    m["shadow_texel"] = {b.shadow_texel};
    m["shadow_depth_bias"] = {b.shadow_depth_bias};
    m["base_factor"] = numbers(b.base_factor);
    m["specular_factor"] = numbers(b.specular_factor);
    m["emissive"] = numbers(b.emissive);
    m["dielectric_specular"] = {b.dielectric_specular};
    m["shininess"] = {b.shininess};
    m["roughness_factor"] = {b.roughness_factor};
    m["metallic_factor"] = {b.metallic_factor};
    m["glossiness_factor"] = {b.glossiness_factor};
    m["model"] = numbers(b.model);
    m["previous_model"] = numbers(b.previous_model);
    m["lightmap_rect"] = numbers(b.lightmap_rect);
    m["lightmap_range"] = {b.lightmap_range};
}

void put(NamedInputs& out, const Maps& maps) {
    out.textures["base_map"] = texture_of(maps.base_map);
    out.textures["specular_map"] = texture_of(maps.specular_map);
    out.textures["gloss_map"] = texture_of(maps.gloss_map);
    out.textures["roughness_map"] = texture_of(maps.roughness_map);
    out.textures["metallic_map"] = texture_of(maps.metallic_map);
    out.textures["lightmap_flat"] = texture_of(maps.lightmap_flat);
    out.textures["lightmap_l0"] = texture_of(maps.lightmap_l0);
    out.textures["lightmap_l1_y"] = texture_of(maps.lightmap_l1_y);
    out.textures["lightmap_l1_z"] = texture_of(maps.lightmap_l1_z);
    out.textures["lightmap_l1_x"] = texture_of(maps.lightmap_l1_x);
    out.textures["shadow_map"] = texture_of(*maps.shadow_map);
    out.textures["shadow_cube"] = texture_of(maps.shadow_cube);
}

NamedInputs inputs_of(const Scene& from) {
    NamedInputs out;
    put(out, from.mesh);
    put(out, from.blocks);
    put(out, from.maps);
    return out;
}

Inputs bound(const std::vector<StageCode>& stages, const NamedInputs& inputs) {
    Inputs in = make_inputs(stages, InputOptions());
    for (const StageCode& s : stages) {
        for (const Resource& r : s.reflection.resources) {
            if (r.kind == ResourceKind::push_constants) fill(in.push_constants, r, inputs);
            for (Binding& b : in.bindings) {
                if (r.kind == ResourceKind::push_constants || b.set != r.set || b.binding != r.binding) continue;
                if (r.kind == ResourceKind::uniform_block) {
                    for (Bytes& block : b.buffers) fill(block, r, inputs);
                    continue;
                }
                const auto found = inputs.textures.find(r.name);
                if (found == inputs.textures.end()) {
                    ADD_FAILURE() << "nothing for texture " << r.name;
                    continue;
                }
                b.images = {found->second.image};
                b.sampler = found->second.sampler;
            }
        }
        if (s.stage != Stage::vertex) continue;
        for (Attribute& a : in.attributes)
            for (const Varying& v : s.reflection.inputs) {
                if (v.location != a.location) continue;
                const auto found = inputs.attributes.find(v.name);
                if (found == inputs.attributes.end()) {
                    ADD_FAILURE() << "nothing for vertex input " << v.name;
                    continue;
                }
                in.vertices = static_cast<uint32_t>(found->second.size());
                a.components = static_cast<uint32_t>(found->second.front().size());
                a.data.clear();
                for (const std::vector<float>& vertex : found->second) {
                    const Bytes bytes = bytes_of_floats(vertex);
                    a.data.insert(a.data.end(), bytes.begin(), bytes.end());
                }
            }
    }
    return in;
}

}  // namespace kiln::test
