#include "compiler/report/families/terrain.h"

#include "compiler/report/resources.h"
#include "uber/reference/random.h"

namespace kiln::report {

namespace {

using reference::Random;

constexpr double edge_reach = 10.0;  // metres to either side
constexpr int edge_samples = 64;

}  // namespace

// Rings of three hills, each 0.14 to 0.32 of its distance wide, so that there are shadows at every distance.
Terrain::Terrain() : light_(normalize(Vec3d{0.8, -0.42, 0.43})), axes_(reference::light_axes(light_)) {
    Random random(104);
    for (double distance = 4.0; distance < 1000.0; distance *= 1.26)
        for (int i = 0; i < 3; ++i) {
            const double radius = std::min(distance * (0.07 + 0.09 * random()), 90.0), sunk = 0.1 + 0.5 * random();
            const double x = distance * (0.42 * (i - 1) + 0.2 * (random() - 0.5)), z = -distance * (1.0 + 0.2 * random());
            hills_.push_back({{x, -sunk * radius, z}, radius});
        }
    for (const Hill& h : hills_)
        along_.push_back({dot(axes_.right, h.centre), dot(axes_.down, h.centre), dot(axes_.forward, h.centre)});
}

bool Terrain::lit(const Vec3d& at) const {
    const double u = dot(axes_.right, at), v = dot(axes_.down, at), w = dot(axes_.forward, at);
    for (size_t i = 0; i < hills_.size(); ++i) {
        const Vec3d& c = along_[i];
        const double r = hills_[i].radius, rest = r * r - (u - c.x) * (u - c.x) - (v - c.y) * (v - c.y);
        if (rest > 0.0 && w - (c.z + std::sqrt(rest)) > 1e-4 * r) return false;
    }
    return true;
}

std::vector<size_t> Terrain::hills_near(double v) const {
    std::vector<size_t> out;
    for (size_t i = 0; i < hills_.size(); ++i)
        if (std::fabs(v - along_[i].y) < hills_[i].radius) out.push_back(i);
    return out;
}

double Terrain::first_hit(double u, double v, const std::vector<size_t>& row) const {
    double w = -(axes_.right.y * u + axes_.down.y * v) / axes_.forward.y;  // the ground
    for (const size_t i : row) {
        const Vec3d& c = along_[i];
        const double r = hills_[i].radius, rest = r * r - (u - c.x) * (u - c.x) - (v - c.y) * (v - c.y);
        if (rest > 0.0) w = std::min(w, c.z - std::sqrt(rest));
    }
    return w;
}

bool Terrain::under_a_hill(const Vec3d& ground) const {
    for (const Hill& h : hills_)
        if (dot(ground - h.centre, ground - h.centre) < h.radius * h.radius) return true;
    return false;
}

double Terrain::edge_offset(int k) {
    const double side = (k + 0.5 - edge_samples / 2) / (edge_samples / 2);
    return edge_reach * side * side * side;
}

std::vector<Terrain::Edge> Terrain::edges(uint32_t rows, uint32_t columns, double first, double last) const {
    std::vector<Edge> out;
    Random random(7);
    for (uint32_t y = 0; y < rows; ++y) {
        std::vector<Edge> row;
        // A row may look for its edges anywhere in its share of the depth.
        for (int attempt = 0; attempt < 400 && row.size() < columns; ++attempt) {
            const double z = -first * std::pow(last / first, (rows - 1 - y + random()) / rows);
            const Vec3d start{0.0, 0.0, z}, along{1.0, 0.0, 0.0};
            const double u = dot(axes_.right, start), v = dot(axes_.down, start), du = axes_.right.x, dv = axes_.down.x;
            for (size_t i = 0; i < hills_.size(); ++i) {
                const double a = du * du + dv * dv, ou = u - along_[i].x, ov = v - along_[i].y, b = du * ou + dv * ov;
                const double square = b * b - a * (ou * ou + ov * ov - hills_[i].radius * hills_[i].radius);
                if (square <= 0.0) continue;
                for (const double root : {(-b - std::sqrt(square)) / a, (-b + std::sqrt(square)) / a}) {
                    const Vec3d at = start + along * root, step = along * (1e-6 * -z);
                    if (std::fabs(root) > -0.55 * z || under_a_hill(at) || lit(at - step) == lit(at + step)) continue;
                    Edge edge{at};
                    for (int k = 0; k < edge_samples; ++k) {
                        const Vec3d sample = at + along * edge_offset(k);
                        if (under_a_hill(sample)) continue;
                        edge.counted |= uint64_t{1} << k;
                        if (lit(sample)) edge.lit |= uint64_t{1} << k;
                    }
                    row.push_back(edge);
                }
            }
        }
        if (row.empty()) row.push_back({Vec3d{0.0, 0.0, -first}});  // counts nowhere
        for (uint32_t x = 0; x < columns; ++x) out.push_back(row[x % row.size()]);
    }
    return out;
}

Resource hills_buffer(const Terrain& terrain) {
    std::vector<float> values;
    for (const Hill& h : terrain.hills())
        for (const double x : {h.centre.x, h.centre.y, h.centre.z, h.radius}) values.push_back(static_cast<float>(x));
    return storage_buffer("readonly buffer Hills { vec4 hills[]; }", values);
}

Resource edges_buffer(const std::vector<Terrain::Edge>& edges) {
    std::vector<float> values;
    for (const Terrain::Edge& e : edges) {
        for (const double x : {e.at.x, e.at.y, e.at.z, 0.0}) values.push_back(static_cast<float>(x));
        for (const uint64_t bits : {e.lit, e.counted})
            for (int part = 0; part < 4; ++part) values.push_back(static_cast<float>(bits >> 16 * part & 0xffff));
    }
    return storage_buffer("readonly buffer Edges { vec4 edges[]; }", values);
}

const char* const terrain_view = R"(
Point point_at(vec2 u) {
    const vec3 eye = vec3(0.0, 2.0, 0.0), ray = vec3(1.2 * u.x - 0.6, 0.2 - 0.6 * u.y, -1.0);
    float t = ray.y < 0.0 ? -eye.y / ray.y : 1e9;
    vec3 n = vec3(0.0, 1.0, 0.0);
    for (int i = 0; i < hills.length(); ++i) {
        const vec3 c = hills[i].xyz - eye;
        const float r = hills[i].w, along = dot(c, ray) / dot(ray, ray);
        const vec3 off = c - ray * along;
        const float rest = (r * r - dot(off, off)) / dot(ray, ray);
        const float near = along - sqrt(max(rest, 0.0));
        if (rest > 0.0 && near > 0.0 && near < t) {
            t = near;
            n = (ray * near - c) / r;
        }
    }
    Point p;
    p.lit = p.counted = vec4(0.0);
    p.depth = min(t, 2000.0);
    p.position = eye + ray * p.depth;
    p.normal = t > 980.0 ? to_light : n;
    if (t > 980.0) p.depth = 2000.0;
    return p;
}
)";

const char* const terrain_edges = R"(
Point point_at(vec2 u) {
    const int i = 3 * (clamp(int(u.y * float(rows)), 0, rows - 1) * columns + clamp(int(u.x * float(columns)), 0, columns - 1));
    Point p;
    p.position = edges[i].xyz;
    p.depth = -edges[i].z;
    p.normal = vec3(0.0, 1.0, 0.0);
    p.lit = edges[i + 1];
    p.counted = edges[i + 2];
    return p;
}
)";

}  // namespace kiln::report
