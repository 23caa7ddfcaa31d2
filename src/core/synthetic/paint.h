#pragma once
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"
#include "synthetic/look.h"

namespace radiafit {

/// The paint on a mesh: cells with hard edges (nearest of sites strewn over the surface), each plain, striped,
/// chequered or dotted in two colours of its region's palette.
class Paint {
public:
    Paint(const Mesh& mesh, const std::string& shape, uint64_t seed);

    struct Coat {
        Vec3f color;
        const Gloss* gloss;
    };
    /// What covers point x of a triangle.
    Coat at(uint32_t triangle, const Vec3f& x) const;

private:
    struct Cell {
        Vec3f site;
        uint32_t region;
        uint32_t pattern;
        Vec3f colors[2];
        Vec3f across, along;  ///< directions of the pattern in units of its period
    };
    Vec3f pattern_color(const Cell& cell, const Vec3f& x) const;

    float period_;
    std::vector<Region> regions_;
    std::vector<Cell> cells_;
    std::vector<uint32_t> candidate_offsets_;  ///< [F + 1] into candidates_
    std::vector<uint32_t> candidates_;         ///< cells that may be nearest somewhere in the triangle
};

/// Mean edge length of an equilateral triangle with the mesh's mean area.
float mean_edge(const Mesh& mesh);

}  // namespace radiafit
