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

NamedTexture texture_of(const Texture2D& from) {
    auto image = std::make_shared<ImageData>();
    image->width = static_cast<uint32_t>(from.width());
    image->height = static_cast<uint32_t>(from.height());
    image->texels = bytes_of_floats(from.texels());
    return {image, SamplerState{from.linear() ? Filter::linear : Filter::nearest, MipFilter::none,
                                from.wrap() == TextureWrap::clamp ? Wrap::clamp : Wrap::repeat, Comparison::off}};
}

NamedTexture texture_of(const MomentMips& from) {
    auto image = std::make_shared<ImageData>();
    const Texture2D& first = from.levels().front();
    image->width = static_cast<uint32_t>(first.width());
    image->height = static_cast<uint32_t>(first.height());
    image->mips = static_cast<uint32_t>(from.levels().size());
    for (const Texture2D& level : from.levels()) {
        const Bytes texels = bytes_of_floats(level.texels());
        image->texels.insert(image->texels.end(), texels.begin(), texels.end());
    }
    return {image, SamplerState{first.linear() ? Filter::linear : Filter::nearest,
                                first.linear() ? MipFilter::linear : MipFilter::nearest, Wrap::clamp, Comparison::off}};
}

NamedTexture texture_of(const CubeArray& from, bool arrayed) {
    auto image = std::make_shared<ImageData>();
    image->dim = ImageDim::cube;
    image->arrayed = arrayed;
    image->width = image->height = static_cast<uint32_t>(from.side());
    image->layers = static_cast<uint32_t>(6 * from.layers());
    image->mips = static_cast<uint32_t>(from.levels());
    image->texels = bytes_of_floats(from.texels());
    return {image, SamplerState{from.linear() ? Filter::linear : Filter::nearest,
                                from.linear() ? MipFilter::linear : MipFilter::nearest, Wrap::clamp, Comparison::off}};
}

// Layers of one map, of an array or of a cube.
NamedTexture texture_of(const std::vector<DepthMap>& from, bool arrayed, bool cube) {
    auto image = std::make_shared<ImageData>();
    image->depth = true;
    image->arrayed = arrayed;
    image->layers = static_cast<uint32_t>(from.size());
    if (cube) image->dim = ImageDim::cube;
    for (const DepthMap& layer : from) {
        image->width = static_cast<uint32_t>(layer.width());
        image->height = static_cast<uint32_t>(layer.height());
        const Bytes texels = bytes_of_floats(layer.texels());
        image->texels.insert(image->texels.end(), texels.begin(), texels.end());
    }
    return {image, SamplerState{Filter::linear, MipFilter::none, Wrap::clamp, Comparison::less_or_equal}};
}

// As numbers, without a comparison or a filter.
NamedTexture depth_values_of(const DepthMap& from) {
    std::vector<float> texels;
    for (const float depth : from.texels()) texels.insert(texels.end(), {depth, 0, 0, 1});
    return texture_of(
        Texture2D(static_cast<long>(from.width()), static_cast<long>(from.height()), texels, false, TextureWrap::clamp));
}

}  // namespace

void put(NamedInputs& out, const Mesh& mesh) {
    const auto f = [](double x) { return static_cast<float>(x); };
    for (const Vertex& v : mesh.vertices) {
        out.attributes["position"].push_back({f(v.position.x), f(v.position.y), f(v.position.z)});
        out.attributes["normal"].push_back({f(v.normal.x), f(v.normal.y), f(v.normal.z)});
        out.attributes["uv"].push_back({f(v.uv.x), f(v.uv.y)});
        out.attributes["lightmap_uv"].push_back({f(v.lightmap_uv.x), f(v.lightmap_uv.y)});
        out.attributes["tangent"].push_back({f(v.tangent.x), f(v.tangent.y), f(v.tangent.z), f(v.tangent.w)});
    }
}

void put(NamedInputs& out, const SurfaceBlocks& b) {
    auto& m = out.members;
    const auto all = [&](const std::string& name, const auto& values) {
        std::vector<double>& to = m[name];
        to.clear();
        for (const auto& v : values) {
            const std::vector<double> one = numbers(v);
            to.insert(to.end(), one.begin(), one.end());
        }
    };
    const auto padded = [&](const std::string& name, const auto& values) {  // vec4s of which xyz count
        std::vector<double>& to = m[name];
        to.clear();
        for (const V3& v : values) to.insert(to.end(), {v.x, v.y, v.z, 0});
    };
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
    m["shadow_plane_of_world"] = numbers(b.shadow_plane_of_world);
    m["shadow_texel_uv"] = {b.shadow_texel_uv};
    m["shadow_filter"] = {b.shadow_filter};
    m["shadow_quantum"] = {b.shadow_quantum};
    m["light_size"] = {b.light_size};
    m["shadow_extent"] = {b.shadow_extent};
    m["moments_far"] = {b.moments_far};
    m["moments_reference"] = {b.moments_reference};
    m["moments_least"] = {b.moments_least};
    m["moments_bleeding"] = {b.moments_bleeding};
    m["moments_levels"] = {b.moments_levels};
    all("cascade_view_projection", b.cascade_view_projection);
    all("cascade_plane_of_world", b.cascade_plane_of_world);
    m["cascade_ends"] = numbers(b.cascade_ends);
    m["cascade_texel"] = numbers(b.cascade_texel);
    m["cascade_bias"] = numbers(b.cascade_bias);
    m["cascade_filter"] = numbers(b.cascade_filter);
    m["cascade_start"] = {b.cascade_start};
    m["cascade_band"] = {b.cascade_band};
    m["cascade_texel_uv"] = {b.cascade_texel_uv};
    m["cascade_quantum"] = {b.cascade_quantum};
    m["base_factor"] = numbers(b.base_factor);
    m["specular_factor"] = numbers(b.specular_factor);
    m["emissive"] = numbers(b.emissive);
    m["dielectric_specular"] = {b.dielectric_specular};
    m["shininess"] = {b.shininess};
    m["roughness_factor"] = {b.roughness_factor};
    m["metallic_factor"] = {b.metallic_factor};
    m["glossiness_factor"] = {b.glossiness_factor};
    m["disney_subsurface_share"] = {b.disney_subsurface_share};
    m["disney_specular_level"] = {b.disney_specular_level};
    m["disney_specular_tint"] = {b.disney_specular_tint};
    m["disney_sheen"] = {b.disney_sheen};
    m["disney_sheen_tint"] = {b.disney_sheen_tint};
    m["disney_coat"] = {b.disney_coat};
    m["disney_coat_gloss"] = {b.disney_coat_gloss};
    m["model"] = numbers(b.model);
    m["previous_model"] = numbers(b.previous_model);
    m["lightmap_rect"] = numbers(b.lightmap_rect);
    m["lightmap_range"] = {b.lightmap_range};
    m["probe_first"] = numbers(b.probe_first);
    m["probe_inverse_spacing"] = numbers(b.probe_inverse_spacing);
    m["probe_count"] = {1.0 * b.probe_count[0], 1.0 * b.probe_count[1], 1.0 * b.probe_count[2]};
    padded("probe_sh", b.probe_sh);
    padded("sky_sh", b.sky_sh);
    m["environment_levels"] = {b.environment_levels};
    m["split_sum_size"] = {b.split_sum_size};
    all("reflection_box_min", b.reflection_box_min);
    all("reflection_box_max", b.reflection_box_max);
    all("reflection_centre", b.reflection_centre);
    m["reflection_layer"] = {1.0 * b.reflection_layer[0], 1.0 * b.reflection_layer[1]};
}

void put(NamedInputs& out, const Maps& maps, const SurfaceAxes& axes) {
    auto& t = out.textures;
    t["base_map"] = texture_of(maps.base_map);
    t["specular_map"] = texture_of(maps.specular_map);
    t["gloss_map"] = texture_of(maps.gloss_map);
    t["roughness_map"] = texture_of(maps.roughness_map);
    t["metallic_map"] = texture_of(maps.metallic_map);
    t["normal_map"] = texture_of(maps.normal_map);
    t["lightmap_flat"] = texture_of(maps.lightmap_flat);
    t["lightmap_l0"] = texture_of(maps.lightmap_l0);
    t["lightmap_l1_y"] = texture_of(maps.lightmap_l1_y);
    t["lightmap_l1_z"] = texture_of(maps.lightmap_l1_z);
    t["lightmap_l1_x"] = texture_of(maps.lightmap_l1_x);
    t["environment_maps"] = texture_of(maps.environment_maps, true);
    t["split_sum_table"] = texture_of(maps.split_sum_table);
    t["shadow_map"] = texture_of({*maps.shadow_map}, false, false);
    t["shadow_cube"] = texture_of(maps.shadow_cube.faces(), false, true);
    t["cascade_maps"] = texture_of(maps.cascade_maps, true, false);
    t["shadow_moments_cube"] = texture_of(maps.moments_cube_map, false);
    t["shadow_values"] = axes.shadow == SurfaceShadow::vsm    ? texture_of(maps.moment_mips)
                         : axes.shadow == SurfaceShadow::vssm ? texture_of(maps.moment_sums)
                                                              : depth_values_of(*maps.shadow_map);
}

NamedInputs inputs_of(const Scene& from, const SurfaceAxes& axes) {
    NamedInputs out;
    put(out, from.mesh);
    put(out, from.blocks);
    put(out, from.maps, axes);
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
