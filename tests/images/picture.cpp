#include "tests/images/picture.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "compiler/base/files.h"
#include "compiler/device/png.h"

namespace kiln::test {

using namespace reference;

float as_float(uint32_t word) { return std::bit_cast<float>(word); }

namespace {

Vec2<Bounded> exact(const V2& v) { return {Bounded(v.x, 0), Bounded(v.y, 0)}; }
Vec3<Bounded> exact(const V3& v) { return {Bounded(v.x, 0), Bounded(v.y, 0), Bounded(v.z, 0)}; }
Vec4<Bounded> exact(const V4& v) { return {Bounded(v.x, 0), Bounded(v.y, 0), Bounded(v.z, 0), Bounded(v.w, 0)}; }
V4 values_of(const Vec4<Bounded>& v) { return {v.x.value, v.y.value, v.z.value, v.w.value}; }

template <class V>
V between(const Fragment& f, const V& a, const V& b, const V& c);
template <>
Vec2<Bounded> between(const Fragment& f, const Vec2<Bounded>& a, const Vec2<Bounded>& b, const Vec2<Bounded>& c) {
    return {interpolated(f, a.x, b.x, c.x), interpolated(f, a.y, b.y, c.y)};
}
template <>
Vec3<Bounded> between(const Fragment& f, const Vec3<Bounded>& a, const Vec3<Bounded>& b, const Vec3<Bounded>& c) {
    return {interpolated(f, a.x, b.x, c.x), interpolated(f, a.y, b.y, c.y), interpolated(f, a.z, b.z, c.z)};
}
template <>
Vec4<Bounded> between(const Fragment& f, const Vec4<Bounded>& a, const Vec4<Bounded>& b, const Vec4<Bounded>& c) {
    return {interpolated(f, a.x, b.x, c.x), interpolated(f, a.y, b.y, c.y), interpolated(f, a.z, b.z, c.z),
            interpolated(f, a.w, b.w, c.w)};
}

// Window depth is z / w of what is interpolated; a device interpolates it in the window, which is the same in real numbers.
Bounded depth_of(const Fragment& f, const Vec4<Bounded>& a, const Vec4<Bounded>& b, const Vec4<Bounded>& c) {
    const auto at = [&](const std::array<double, 3>& w) {
        return (w[0] * a.z.value + w[1] * b.z.value + w[2] * c.z.value) /
               (w[0] * a.w.value + w[1] * b.w.value + w[2] * c.w.value);
    };
    const double here = at(f.weight), moved = std::fabs(at(f.right) - here) + std::fabs(at(f.down) - here);
    double vertices = 0;
    for (const Vec4<Bounded>* p : {&a, &b, &c}) vertices = std::max(vertices, (p->z / p->w).error);
    return {here, 1.01 * moved + vertices + 8 * bounds::ulp};
}

}  // namespace

Points visible_points(const Scene& from, uint32_t size, bool holes) {
    std::vector<SurfaceVaryings<Bounded>> vertices;
    for (const Vertex& v : from.mesh.vertices)
        vertices.push_back(surface_vertex(from.blocks, SurfaceVertex<Bounded>{exact(v.position), exact(v.normal), exact(v.uv),
                                                                              exact(v.lightmap_uv), exact(v.tangent)}));
    std::vector<RasterTriangle> triangles;
    for (size_t i = 0; i < vertices.size(); i += 3)
        triangles.push_back({{values_of(vertices[i].clip_position), values_of(vertices[i + 1].clip_position),
                              values_of(vertices[i + 2].clip_position)}});
    const int side = static_cast<int>(size);
    const auto opacity = [&](size_t t, const std::array<double, 3>& w) {
        V2 uv{};
        for (size_t k = 0; k < 3; ++k) uv = uv + from.mesh.vertices[3 * t + k].uv * w[k];
        return holes ? from.maps.base_map.channel(uv, 3) - from.blocks.base_factor.w : 1;
    };
    const std::vector<Fragment> fragments = rasterise(triangles, side, side, opacity);
    Points out;
    out.size = size;
    for (const Fragment& f : fragments) {
        Points::Point p;
        // Alpha changes by less than this over a pixel; a place is off by 1/256 of one, a sampler's weights by 1/256.
        p.silhouette = f.margin < 2 * 0.2 / 256;
        if (f.triangle >= 0) {
            const size_t t = static_cast<size_t>(f.triangle);
            const SurfaceVaryings<Bounded>&a = vertices[3 * t], &b = vertices[3 * t + 1], &c = vertices[3 * t + 2];
            p.body = from.mesh.body[t] + (f.front ? 0 : 8);
            p.front = f.front;
            p.depth = depth_of(f, a.clip_position, b.clip_position, c.clip_position);
            p.in = {between(f, a.world_position, b.world_position, c.world_position),
                    between(f, a.world_normal, b.world_normal, c.world_normal),
                    between(f, a.material_uv, b.material_uv, c.material_uv),
                    between(f, a.atlas_uv, b.atlas_uv, c.atlas_uv),
                    between(f, a.world_tangent, b.world_tangent, c.world_tangent),
                    between(f, a.clip_position, b.clip_position, c.clip_position),
                    between(f, a.previous_clip_position, b.previous_clip_position, c.previous_clip_position)};
        }
        out.at.push_back(p);
    }
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            Points::Point& p = out.at[static_cast<size_t>(y * side + x)];
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const int nx = std::clamp(x + dx, 0, side - 1), ny = std::clamp(y + dy, 0, side - 1);
                    p.silhouette |= out.at[static_cast<size_t>(ny * side + nx)].body != p.body;
                }
        }
    return out;
}

namespace {

// Allowed errors within a tenth of the largest component, or 1e-3.
bool says_something(const std::vector<Bounded>& values) {
    double largest = 0, worst = 0;
    for (const Bounded& v : values) {
        largest = std::max(largest, std::fabs(v.value));
        worst = std::max(worst, reassociation_margin * v.error);
    }
    return worst <= 0.1 * largest + 1e-3;
}

}  // namespace

Judged judge(const Points& points, const Expect& expect, const ReadBack& got) {
    Judged out;
    double squares = 0, reference_squares = 0;
    for (size_t i = 0; i < points.at.size(); ++i) {
        const Points::Point& p = points.at[i];
        if (p.body < 0 && !p.silhouette) {
            // Cleared: depth 1, colour 0.
            if (as_float(got.words[i * got.components]) != (got.components == 1 ? 1.0f : 0.0f)) {
                ++out.wrong;
                out.example = "drawn where nothing is";
            }
            continue;
        }
        if (p.body < 0) continue;
        ++out.covered;
        decision_was_close = false;
        const std::vector<Bounded> values = expect(p);
        const bool close = decision_was_close, loose = !says_something(values);
        if (p.silhouette || close || loose) {
            ++(p.silhouette ? out.silhouettes : close ? out.close : out.loose);
            continue;
        }
        ++out.compared;
        bool wrong = false;
        for (size_t c = 0; c < values.size(); ++c) {
            const double device = static_cast<double>(as_float(got.words[i * got.components + c]));
            const double error = std::fabs(device - values[c].value), allowed = reassociation_margin * values[c].error;
            const double share = error == 0 ? 0 : error / allowed;  // NaN where the device has one
            squares += error * error;
            reference_squares += values[c].value * values[c].value;
            if (!(error <= allowed)) wrong = true;
            if (share <= out.worst) continue;
            out.worst = share;
            if (!(error <= allowed)) {
                std::ostringstream text;
                text << "pixel " << i % points.size << ", " << i / points.size << " component " << c << " body " << p.body
                     << ": device " << device << ", reference " << values[c].value << ", allowed " << allowed;
                out.example = text.str();
            }
        }
        for (size_t c = 0; c < values.size(); ++c) {
            const double device = static_cast<double>(as_float(got.words[i * got.components + c]));
            out.most = std::max(out.most, std::fabs(device - values[c].value));
        }
        out.wrong += wrong ? 1 : 0;
    }
    out.relative = reference_squares > 0 ? std::sqrt(squares / reference_squares) : std::sqrt(squares);
    return out;
}

const ReadBack* output(const RunOutput& run, const std::string& what) {
    for (const ReadBack& r : run.values)
        if (r.what == what || r.what.rfind(what + " ", 0) == 0) return &r;
    return nullptr;
}

void show(const std::string& name, const Points& points, const Expect& expect, const ReadBack& got) {
    const char* folder = std::getenv("KILN_IMAGES");
    if (folder == nullptr) return;
    const uint32_t side = points.size, width = 3 * side;
    Bytes rgb(size_t{width} * side * 3);
    const auto shade = [](double v) {
        const double x = std::clamp(v / (1 + v) * 1.5, 0.0, 1.0);
        return static_cast<uint8_t>(std::lround(255 * std::pow(x, 1 / 2.2)));
    };
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const size_t i = size_t{y} * side + x;
            const Points::Point& p = points.at[i];
            const auto pixel = [&](uint32_t panel) { return rgb.data() + (size_t{y} * width + panel * side + x) * 3; };
            for (size_t c = 0; c < 3; ++c)
                pixel(0)[c] = shade(std::fabs(static_cast<double>(as_float(got.words[i * got.components + c % got.components]))));
            if (p.body < 0) continue;
            decision_was_close = false;
            const std::vector<Bounded> values = expect(p);
            double worst = 0;
            for (size_t c = 0; c < values.size(); ++c) {
                const double device = static_cast<double>(as_float(got.words[i * got.components + c]));
                const double error = std::fabs(device - values[c].value);
                worst = std::max(worst, error == 0 ? 0 : error / (reassociation_margin * values[c].error));
                if (c < 3) pixel(1)[c] = shade(std::fabs(values[c].value));
            }
            if (p.silhouette || decision_was_close || !says_something(values)) {
                pixel(2)[2] = 128;  // blue: masked
                continue;
            }
            const uint8_t grey = static_cast<uint8_t>(std::lround(255 * std::min(worst, 1.0)));
            for (size_t c = 0; c < 3; ++c) pixel(2)[c] = worst > 1 && c > 0 ? uint8_t{0} : grey;
        }
    const Result<Bytes> png = encode_png(rgb, width, side);
    if (png.ok()) (void)DiskFiles().write(std::string(folder) + "/" + name + ".png", *png);
}

}  // namespace kiln::test
