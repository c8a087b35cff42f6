#include "tests/images/closed_form.h"

#include <cmath>

#include "tests/device/glsl.h"

namespace kiln::test {

using namespace reference;

namespace {

void add_square(Mesh& mesh, double x0, double x1, double z0, double z1, double y) {
    for (const auto& [x, z] : {std::pair{x0, z0}, {x0, z1}, {x1, z1}, {x0, z0}, {x1, z1}, {x1, z0}})
        mesh.vertices.push_back({{x, y, z}, {0, 1, 0}, {0.5, 0.5}, {0.5, 0.5}, {1, 0, 0, 1}});
    mesh.body.insert(mesh.body.end(), {plane, plane});
}

}  // namespace

Triangles set_floor(Scene& s, const std::vector<Occluder>& occluders, const V3& eye) {
    s.mesh = {};
    add_square(s.mesh, -8, 8, -8, 8, 0);
    Mesh seen = s.mesh;
    for (const Occluder& o : occluders)
        add_square(seen, o.shape.x0, o.shape.x1, o.shape.y0, o.shape.y1, lamp_height - o.distance);
    SurfaceBlocks& b = s.blocks;
    b.model = b.previous_model = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
    b.camera_position = f32(eye);
    b.view_projection = f32(perspective(0.4, 0.1, 20) * look_at(b.camera_position, {0, 0, 0}, {0, 1, 0}));
    b.ambient_irradiance = b.emissive = {0, 0, 0};
    b.light_direction = {0, -1, 0};
    Triangles world;
    for (size_t i = 0; i < seen.vertices.size(); i += 3)
        world.push_back({seen.vertices[i].position, seen.vertices[i + 1].position, seen.vertices[i + 2].position});
    return world;
}

std::vector<Seen> visibility(const Scene& s, Values values, const Edits& edits) {
    const Variant with = variant_of("renderer.yaml", "surface", values, edits);
    values["shadow"] = "none";
    values["cascades"] = "1";
    const Variant without = variant_of("renderer.yaml", "surface", values);
    const RunOutput dark = draw(with.stages, {inputs_of(s, axes_of(with.values))}).front(),
                    bright = draw(without.stages, {inputs_of(s)}).front();
    const ReadBack *d = output(dark, "output 0"), *b = output(bright, "output 0");
    std::vector<Seen> out;
    EXPECT_TRUE(d != nullptr && b != nullptr);
    if (d == nullptr || b == nullptr) return out;
    const Points points = drawn_points(with.stages.front(), inputs_of(s), visible_points(s));
    for (size_t i = 0; i < points.at.size(); ++i) {
        const Points::Point& p = points.at[i];
        if (p.body < 0 || p.silhouette) continue;
        const Vec3<Bounded>& at = p.in.world_position;
        const auto green = [&](const ReadBack& r) { return static_cast<double>(as_float(r.words[4 * i + 1])); };
        out.push_back({{at.x.value, at.y.value, at.z.value}, green(*d) / green(*b), i});
    }
    EXPECT_GT(out.size(), 5000u);
    return out;
}

Values with(Values v, const std::string& axis, const std::string& value) {
    v[axis] = value;
    return v;
}

double taps_along_an_edge(double x, double w, int n, double side) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += std::clamp(0.5 + (x + ((i + 0.5) / n - 0.5) * w) / side, 0.0, 1.0);
    return sum / n;
}

double taps_allowed(double w, int n, double side) {
    return std::min(n, static_cast<int>(std::ceil(side * n / std::max(w, 1e-9))) + 1) * texel_step / n + 1e-4;
}

}  // namespace kiln::test
