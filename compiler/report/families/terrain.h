#pragma once
// A kilometre of ground with round hills, whose shadows are known exactly: hills are spheres sunk into the plane y = 0, so
// that along the light everything is a disk. Seen from (0, 2, 0) towards -z.

#include "compiler/report/family.h"
#include "uber/reference/cascades.h"

namespace kiln::report {

struct Hill {
    Vec3d centre;
    double radius = 0;
};

class Terrain {
public:
    Terrain();
    const std::vector<Hill>& hills() const { return hills_; }
    const Vec3d& light() const { return light_; }  // the way it travels
    // Whether light arrives at a place of the surface, within the rounding of single precision.
    bool lit(const Vec3d& at) const;
    // Depth, in metres along the light from the origin's plane, of what the ray at (u, v) of the light's axes meets first.
    // `row`: of hills_near(v).
    double first_hit(double u, double v, const std::vector<size_t>& row) const;
    // Hills that a ray at v may meet.
    std::vector<size_t> hills_near(double v) const;

    // A place on the ground where the shadow ends, on a line along x, and what is true beside it: which of 64 samples of the
    // line are lit, and which count, the others being under a hill. Sample k is edge_offset(k) metres from the edge.
    struct Edge {
        Vec3d at;
        uint64_t lit = 0, counted = 0;
    };
    static double edge_offset(int k);
    // `columns` edges a row, by powers from `first` to `last` metres.
    std::vector<Edge> edges(uint32_t rows, uint32_t columns, double first, double last) const;

private:
    bool under_a_hill(const Vec3d& ground) const;
    Vec3d light_;
    reference::LightAxes axes_;
    std::vector<Hill> hills_;
    std::vector<Vec3d> along_;  // centres by right, down, forward
};

// The picture: p.position, p.depth and p.normal of a perspective view, and the sky beyond 2 km. Needs `hills` below.
extern const char* const terrain_view;
// Points of Terrain::edges, from a buffer of 12 floats each. Needs `edges` below, and `const int columns, rows`.
extern const char* const terrain_edges;

Resource hills_buffer(const Terrain& terrain);
Resource edges_buffer(const std::vector<Terrain::Edge>& edges);

}  // namespace kiln::report
