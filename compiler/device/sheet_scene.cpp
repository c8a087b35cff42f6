// One mesh and one set of charts serve every texture: the left half of uv space is the sphere, the right half the plane, so
// that a single draw shows two materials. Shadow maps and lightmaps are computed from the scene's geometry, texel by texel:
// they are then exact, and need no pass of their own.

#include "compiler/device/sheet_scene.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <optional>

#include "compiler/device/sheet_math.h"
#include "compiler/validate/blocks.h"
#include "compiler/validate/inputs.h"

namespace kiln {

namespace {

constexpr double pi = 3.14159265358979;
constexpr Vec3 sphere_centre{0, 1, 0};
constexpr double plane_half = 6.0;
constexpr Vec3 eye{0.0, 2.3, 5.4}, target{0.0, 0.8, 0.0};
constexpr Vec3 lamp{-2.6, 4.2, 2.6};
constexpr uint32_t shadow_size = 1024, map_size = 256, chart_size = 128;
constexpr double shadow_near = 0.5, shadow_far = 20.0, spot_half_angle = 0.42, sun_half_side = 4.5;
constexpr double sun_lux = 2.6, lamp_candela = 68.0;

Vec3 light_direction() { return unit(sphere_centre - lamp); }

Mat4 light_matrix(bool directional) {
    const Vec3 up{0, 1, 0};
    if (directional)
        return orthographic(sun_half_side, shadow_near, shadow_far) *
               look_at(sphere_centre - light_direction() * 8.0, sphere_centre, up);
    return perspective(spot_half_angle * 1.15, shadow_near, shadow_far) * look_at(lamp, sphere_centre, up);
}

Mat4 view_matrix() { return look_at(eye, target, {0, 1, 0}); }
Mat4 projection_matrix() { return perspective(0.34, 0.5, 30.0); }

// ---- mesh: sphere, then plane ----

struct Vertex {
    Vec3 position, normal;
    double u = 0, v = 0;
};

const std::vector<Vertex>& mesh() {
    static const std::vector<Vertex> made = [] {
        std::vector<Vertex> out;
        constexpr int columns = 64, rows = 32;
        const auto on_sphere = [](int i, int j) {
            const double a = 2 * pi * i / columns, b = pi * j / rows;
            const Vec3 n{std::sin(b) * std::sin(a), std::cos(b), std::sin(b) * std::cos(a)};
            return Vertex{sphere_centre + n, n, 0.5 * (0.02 + 0.96 * i / columns), 0.02 + 0.96 * j / rows};
        };
        const auto on_plane = [](int i, int j) {
            const double s = i / 16.0, t = j / 16.0;
            return Vertex{{(2 * s - 1) * plane_half, 0, (2 * t - 1) * plane_half},
                          {0, 1, 0},
                          0.5 + 0.5 * (0.02 + 0.96 * s),
                          0.02 + 0.96 * t};
        };
        const auto quad = [&](const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
            out.insert(out.end(), {a, b, c, a, c, d});  // counter-clockwise from outside
        };
        for (int j = 0; j < rows; ++j)
            for (int i = 0; i < columns; ++i)
                quad(on_sphere(i, j), on_sphere(i, j + 1), on_sphere(i + 1, j + 1), on_sphere(i + 1, j));
        for (int j = 0; j < 16; ++j)
            for (int i = 0; i < 16; ++i) quad(on_plane(i, j), on_plane(i, j + 1), on_plane(i + 1, j + 1), on_plane(i + 1, j));
        return out;
    }();
    return made;
}

// The point of the scene that a texel of the charts shows.
struct Point {
    bool sphere = false;
    Vec3 position, normal;
    double s = 0, t = 0;  // within the chart
};

Point point_at(double u, double v) {
    Point p;
    p.sphere = u < 0.5;
    p.s = std::clamp(((p.sphere ? u : u - 0.5) * 2.0 - 0.02) / 0.96, 0.0, 1.0);
    p.t = std::clamp((v - 0.02) / 0.96, 0.0, 1.0);
    if (p.sphere) {
        const double a = 2 * pi * p.s, b = pi * p.t;
        p.normal = {std::sin(b) * std::sin(a), std::cos(b), std::sin(b) * std::cos(a)};
        p.position = sphere_centre + p.normal;
    } else {
        p.normal = {0, 1, 0};
        p.position = {(2 * p.s - 1) * plane_half, 0, (2 * p.t - 1) * plane_half};
    }
    return p;
}

// ---- textures ----

using Texel = std::array<double, 4>;

// With a box-filtered mip chain: a checker seen at a low angle needs one.
std::shared_ptr<const ImageData> charts(uint32_t size, bool mips, const std::function<Texel(const Point&)>& shade) {
    auto image = std::make_shared<ImageData>();
    image->width = image->height = size;
    std::vector<float> level(size_t{size} * size * 4);
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x) {
            const Texel t = shade(point_at((x + 0.5) / size, (y + 0.5) / size));
            for (size_t c = 0; c < 4; ++c) level[(size_t{y} * size + x) * 4 + c] = static_cast<float>(t[c]);
        }
    for (image->mips = 0; size != 0; size /= 2) {
        const auto* bytes = reinterpret_cast<const uint8_t*>(level.data());
        image->texels.insert(image->texels.end(), bytes, bytes + level.size() * sizeof(float));
        ++image->mips;
        if (!mips || size == 1) break;
        const uint32_t half = size / 2;
        std::vector<float> next(size_t{half} * half * 4);
        for (size_t y = 0; y < half; ++y)
            for (size_t x = 0; x < half; ++x)
                for (size_t c = 0; c < 4; ++c) {
                    const auto at = [&](size_t dx, size_t dy) { return level[((2 * y + dy) * size + 2 * x + dx) * 4 + c]; };
                    next[(y * half + x) * 4 + c] = 0.25f * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1));
                }
        level = std::move(next);
    }
    return image;
}

bool on_cap(const Point& p) { return p.sphere && p.position.y > 1.62; }  // of metal
bool on_band(const Point& p) { return p.sphere && std::fabs(p.position.y - 1.0) < 0.13; }
bool on_checker(const Point& p) {
    return !p.sphere && ((static_cast<int>(std::floor(p.position.x)) + static_cast<int>(std::floor(p.position.z))) & 1) != 0;
}

constexpr Texel gold{1.0, 0.71, 0.29, 1};
Texel grey(double v) { return {v, v, v, 1}; }
Texel base_texel(const Point& p) {
    if (on_cap(p)) return gold;
    if (on_band(p)) return {0.78, 0.72, 0.60, 1};
    if (p.sphere) return {0.55, 0.09, 0.07, 1};
    return on_checker(p) ? Texel{0.30, 0.32, 0.35, 1} : Texel{0.60, 0.60, 0.58, 1};
}
// Where no map says what is metal, metal is what has no diffuse colour.
Texel diffuse_texel(const Point& p) { return on_cap(p) ? grey(0.0) : base_texel(p); }
Texel specular_texel(const Point& p) {
    if (on_cap(p)) return gold;
    return p.sphere ? grey(0.045) : grey(0.03);
}
double roughness_at(const Point& p) {
    if (on_cap(p)) return 0.45;
    return on_band(p) ? 0.6 : p.sphere ? 0.28 : 0.75;
}

// Light from a blue sky and a warm lamp behind the camera, as zeroth and first moments of radiance; the sphere takes its part
// of the sky from the plane (r^2 / d^2 of the hemisphere), the plane its part from the sphere's lower half.
struct Moments {
    std::array<double, 3> m0{};
    std::array<Vec3, 3> m1{};
};

Moments moments_at(const Point& p) {
    double open = 1.0;
    if (!p.sphere) {
        const Vec3 to = sphere_centre - p.position;
        const double d2 = dot(to, to);
        open -= std::clamp(unit(to).y / d2, 0.0, 1.0);
    } else {
        open = 0.55 + 0.45 * std::clamp(p.position.y / 2.0, 0.0, 1.0);
    }
    constexpr std::array<double, 3> sky{0.17, 0.24, 0.36}, warm{0.9, 0.62, 0.38}, ground{0.09, 0.085, 0.08};
    const Vec3 from = unit({2.2, 1.2, 2.0});
    Moments m;
    for (size_t c = 0; c < 3; ++c) {
        m.m0[c] = 2 * pi * (sky[c] * open + ground[c]) + warm[c] * open;
        m.m1[c] = Vec3{0, pi * (sky[c] * open - ground[c]), 0} + from * (warm[c] * open);
    }
    return m;
}

Texel flat_texel(const Point& p) {
    const Moments m = moments_at(p);
    Texel t{0, 0, 0, 1};
    for (size_t c = 0; c < 3; ++c) t[c] = std::max(0.0, m.m0[c] / 4 + dot(m.m1[c], p.normal) / 2);
    return t;
}
Texel l0_texel(const Point& p) {
    const Moments m = moments_at(p);
    return {m.m0[0], m.m0[1], m.m0[2], 1};
}
Texel l1_texel(const Point& p, double Vec3::*axis) {
    const Moments m = moments_at(p);
    Texel t{0, 0, 0, 1};
    for (size_t c = 0; c < 3; ++c) t[c] = 0.5 + 0.5 * m.m1[c].*axis / m.m0[c];
    return t;
}

// ---- shadow maps ----

// Distance along the ray to what it meets first; nullopt: nothing.
std::optional<double> first_hit(Vec3 from, Vec3 along) {
    std::optional<double> best;
    const Vec3 to = from - sphere_centre;
    const double b = dot(to, along), c = dot(to, to) - 1.0, d = b * b - c;
    if (d > 0 && -b - std::sqrt(d) > 0) best = -b - std::sqrt(d);
    if (along.y < 0) {
        const double t = -from.y / along.y;
        const Vec3 p = from + along * t;
        if (std::fabs(p.x) <= plane_half && std::fabs(p.z) <= plane_half && (!best || t < *best)) best = t;
    }
    return best;
}

float perspective_depth(double z) {
    const double scale = shadow_far / (shadow_far - shadow_near);
    return static_cast<float>(std::clamp(scale - scale * shadow_near / z, 0.0, 1.0));
}

std::shared_ptr<const ImageData> depth_image(uint32_t layers, const std::function<float(uint32_t, double, double)>& depth) {
    auto image = std::make_shared<ImageData>();
    image->depth = true;
    image->width = image->height = shadow_size;
    image->layers = layers;
    if (layers == 6) image->dim = ImageDim::cube;
    std::vector<float> texels;
    texels.reserve(size_t{shadow_size} * shadow_size * layers);
    for (uint32_t l = 0; l < layers; ++l)
        for (uint32_t y = 0; y < shadow_size; ++y)
            for (uint32_t x = 0; x < shadow_size; ++x)
                texels.push_back(depth(l, 2 * (x + 0.5) / shadow_size - 1, 2 * (y + 0.5) / shadow_size - 1));
    const auto* bytes = reinterpret_cast<const uint8_t*>(texels.data());
    image->texels.assign(bytes, bytes + texels.size() * sizeof(float));
    return image;
}

std::shared_ptr<const ImageData> shadow_map(bool directional) {
    const Vec3 forward = light_direction(), right = unit(cross(Vec3{0, 1, 0}, forward * -1.0)),
               top = cross(forward * -1.0, right);
    return depth_image(1, [=](uint32_t, double x, double y) {
        if (directional) {
            const Vec3 from = sphere_centre - forward * 8.0 + right * (x * sun_half_side) - top * (y * sun_half_side);
            const std::optional<double> t = first_hit(from, forward);
            return t ? static_cast<float>(std::clamp((*t - shadow_near) / (shadow_far - shadow_near), 0.0, 1.0)) : 1.0f;
        }
        const double reach = std::tan(spot_half_angle * 1.15);
        const Vec3 along = unit(forward + right * (x * reach) - top * (y * reach));
        const std::optional<double> t = first_hit(lamp, along);
        return t ? perspective_depth(*t * dot(along, forward)) : 1.0f;
    });
}

std::shared_ptr<const ImageData> shadow_cube() {
    return depth_image(6, [](uint32_t face, double x, double y) {
        const Vec3 along[6] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y}, {x, -1, -y}, {x, -y, 1}, {-x, -y, -1}};
        const Vec3 d = unit(along[face]);
        const std::optional<double> t = first_hit(lamp, d);
        return t ? perspective_depth(*t * std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)})) : 1.0f;
    });
}

// ---- names ----

// The last part of a name in lower case without underscores: "light.View_Projection" is "viewprojection".
std::string plain(const std::string& name) {
    std::string out;
    for (const char c : name.substr(name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1))
        if (c != '_') out.push_back(c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c);
    return out;
}

bool has(const std::string& name, std::initializer_list<const char*> words) {
    return std::any_of(words.begin(), words.end(), [&](const char* w) { return name.find(w) != std::string::npos; });
}

using Values = std::vector<double>;
Values values_of(Vec3 v, double w = 1) { return {v.x, v.y, v.z, w}; }
Values values_of(const Mat4& m) { return Values(m.begin(), m.end()); }

std::optional<Values> matrix_named(const std::string& n, const SheetScene& scene) {
    const bool before = has(n, {"prev", "last", "old"});
    const Mat4 model = before ? rotation_y(-0.05) : identity();
    const Mat4 view = before ? look_at(eye + Vec3{0.06, 0, 0}, target, {0, 1, 0}) : view_matrix();
    if (has(n, {"shadow", "light"}) && !has(n, {"lightmap"})) return values_of(light_matrix(scene.directional));
    if (has(n, {"mvp", "modelviewproj", "worldviewproj"})) return values_of(projection_matrix() * view * model);
    if (has(n, {"viewproj", "worldtoclip", "vp"})) return values_of(projection_matrix() * view);
    if (has(n, {"inverse", "inv"})) return std::nullopt;
    if (has(n, {"proj"})) return values_of(projection_matrix());
    if (has(n, {"modelview", "worldview"})) return values_of(view * model);
    if (has(n, {"view", "camera"})) return values_of(view);
    if (has(n, {"model", "world", "object", "transform"})) return values_of(model);
    if (has(n, {"normal"})) return values_of(identity());
    return std::nullopt;
}

std::optional<Values> vector_named(const std::string& n, const SheetScene& scene) {
    if (has(n, {"lightmaprect", "lightmapscale"})) return Values{1, 1, 0, 0};
    if (has(n, {"jitter"})) return Values{0, 0, 0, 0};
    if (has(n, {"camera", "eye", "viewpos", "viewer"})) return values_of(eye);
    if (has(n, {"ambient"})) return Values{0.42, 0.5, 0.62, 1};
    if (has(n, {"light", "sun", "lamp"})) {
        if (has(n, {"dir"})) return values_of(light_direction(), 0);
        if (has(n, {"pos"})) return values_of(lamp);
        if (has(n, {"col", "intens", "radiance", "irradiance"})) {
            const double power = scene.directional ? sun_lux : lamp_candela;
            return Values{power, power * 0.96, power * 0.88, 1};
        }
    }
    if (has(n, {"emissive", "emission"})) return Values{0, 0, 0, 0};
    if (has(n, {"factor", "tint", "basecolor", "albedo", "diffuse", "specular"})) return Values{1, 1, 1, 1};
    return std::nullopt;
}

std::optional<Values> scalar_named(const std::string& n, const SheetScene& scene) {
    if (n == "lightrange") return Values{25};
    if (has(n, {"cosinner"})) return Values{std::cos(spot_half_angle * 0.7)};
    if (has(n, {"cosouter"})) return Values{std::cos(spot_half_angle)};
    if (n == "shadownear") return Values{shadow_near};
    if (n == "shadowfar") return Values{shadow_far};
    if (has(n, {"shadowtexel"}))
        return Values{(scene.directional ? 2 * sun_half_side : 2.0) / shadow_size};  // a cube's face: the widest

    if (has(n, {"bias"})) return Values{2e-4};
    if (n == "lightmaprange") return Values{1};
    if (has(n, {"shininess", "exponent"})) return Values{60};
    if (has(n, {"dielectric"})) return Values{0.5};
    if (has(n, {"factor"})) return Values{1};
    return std::nullopt;
}

std::optional<Values> member_named(const Member& m, const SheetScene& scene) {
    const std::string n = plain(m.name);
    if (m.type.base != BaseType::float32) return std::nullopt;
    if (m.type.columns == 4 && m.type.rows == 4) return matrix_named(n, scene);
    if (m.type.columns == 3 && m.type.rows == 3 && has(n, {"normal", "model", "world"})) return Values{1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (m.type.columns != 1) return std::nullopt;
    return m.type.rows == 1 ? scalar_named(n, scene) : vector_named(n, scene);
}

std::shared_ptr<const ImageData> image_named(const Resource& r, const SheetScene& scene) {
    static std::map<std::string, std::shared_ptr<const ImageData>> kept;
    const auto once = [&](const std::string& key, const std::function<std::shared_ptr<const ImageData>()>& make) {
        std::shared_ptr<const ImageData>& image = kept[key];
        if (image == nullptr) image = make();
        return image;
    };
    const std::string n = plain(r.name);
    if (r.arrayed || r.multisampled || r.sampled != BaseType::float32) return nullptr;
    if (r.depth && r.dim == ImageDim::cube) return once("cube", shadow_cube);
    if (r.depth && r.dim == ImageDim::d2)
        return once(scene.directional ? "sun" : "lamp", [&] { return shadow_map(scene.directional); });
    if (r.dim != ImageDim::d2) return nullptr;
    const auto chart = [&](Texel (*shade)(const Point&), bool lightmap = false) {
        return once(n, [&] { return charts(lightmap ? chart_size : map_size, !lightmap, shade); });
    };
    if (has(n, {"lightmap"})) {
        if (has(n, {"l1y"})) return chart([](const Point& p) { return l1_texel(p, &Vec3::y); }, true);
        if (has(n, {"l1z"})) return chart([](const Point& p) { return l1_texel(p, &Vec3::z); }, true);
        if (has(n, {"l1x"})) return chart([](const Point& p) { return l1_texel(p, &Vec3::x); }, true);
        if (has(n, {"l0"})) return chart(l0_texel, true);
        return chart(flat_texel, true);
    }
    if (has(n, {"base", "albedo", "diffuse", "color", "colour"}))
        return scene.metal_map ? chart(base_texel) : once(n + " diffuse", [&] { return charts(map_size, true, diffuse_texel); });
    if (has(n, {"rough"})) return chart([](const Point& p) { return grey(roughness_at(p)); });
    if (has(n, {"gloss", "smooth"})) return chart([](const Point& p) { return grey(1 - roughness_at(p)); });
    if (has(n, {"metal"})) return chart([](const Point& p) { return grey(on_cap(p) ? 1.0 : 0.0); });
    if (has(n, {"spec"})) return chart(specular_texel);
    if (has(n, {"normal", "bump"})) return chart([](const Point&) { return Texel{0.5, 0.5, 1.0, 1}; });
    if (has(n, {"occlusion", "ao"})) return chart([](const Point&) { return grey(1.0); });
    return nullptr;
}

Values attribute_at(const std::string& n, const Vertex& v) {
    if (has(n, {"normal"})) return values_of(v.normal, 0);
    if (has(n, {"tangent"})) return {1, 0, 0, 1};
    if (has(n, {"uv", "texcoord", "texturecoord"})) return {v.u, v.v, 0, 0};
    if (has(n, {"color", "colour"})) return {1, 1, 1, 1};
    if (has(n, {"weight"})) return {1, 0, 0, 0};
    if (has(n, {"joint", "bone", "index"})) return {0, 0, 0, 0};
    if (has(n, {"pos", "vertex"})) return values_of(v.position);
    return {0.5, 0.5, 0.5, 0.5};
}

void fill_attributes(Inputs& out, const Reflection& vertex) {
    out.vertices = static_cast<uint32_t>(mesh().size());
    for (Attribute& a : out.attributes) {
        std::string name;
        for (const Varying& v : vertex.inputs)
            if (v.location == a.location) name = plain(v.name);
        a.data.clear();
        for (const Vertex& v : mesh()) {
            const Values values = attribute_at(name, v);
            for (uint32_t c = 0; c < a.components; ++c) {
                uint32_t word = static_cast<uint32_t>(values[c]);
                const float f = static_cast<float>(values[c]);
                if (a.base == BaseType::float32) std::memcpy(&word, &f, 4);
                for (unsigned i = 0; i < (a.base == BaseType::float64 ? 8u : 4u); ++i)
                    a.data.push_back(i < 4 ? static_cast<uint8_t>(word >> (8 * i)) : uint8_t{0});
            }
        }
    }
}

void fill_members(Bytes& block, const Resource& r, const SheetScene& scene) {
    for (const Member& m : r.members) {
        const std::optional<Values> values = member_named(m, scene);
        if (!values || values->size() < size_t{m.type.rows} * m.type.columns) continue;
        for (const size_t at : element_offsets(m)) store_value(block, at, m, values->data());
    }
}

}  // namespace

Inputs scene_inputs(const std::vector<StageCode>& stages, const SheetScene& wanted) {
    Inputs out = make_inputs(stages, InputOptions());
    SheetScene scene = wanted;
    for (const StageCode& s : stages)
        for (const Resource& r : s.reflection.resources) scene.metal_map |= has(plain(r.name), {"metal"});
    for (const StageCode& s : stages) {
        if (s.stage == Stage::vertex && !s.partner && !s.reflection.inputs.empty()) fill_attributes(out, s.reflection);
        for (const Resource& r : s.reflection.resources) {
            if (r.kind == ResourceKind::push_constants) {
                fill_members(out.push_constants, r, scene);
                continue;
            }
            for (Binding& b : out.bindings) {
                if (b.set != r.set || b.binding != r.binding || b.kind != r.kind) continue;
                if (r.kind == ResourceKind::uniform_block || r.kind == ResourceKind::storage_block)
                    for (Bytes& block : b.buffers) fill_members(block, r, scene);
                if (const auto image = b.images.empty() ? nullptr : image_named(r, scene))
                    std::fill(b.images.begin(), b.images.end(), image);
            }
        }
    }
    return out;
}

}  // namespace kiln
