#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"

/// Borders and pieces of an open mesh.
namespace radiafit::tools {

/// Edges that one triangle alone has, from vertex to vertex in its order.
std::vector<std::array<uint32_t, 2>> border_edges(const Mesh& mesh);

/// Sum of the lengths of border_edges().
double border_length(const Mesh& mesh);

/// For each of so many vertices the least vertex that edges connect it with, itself included.
std::vector<uint32_t> connected(size_t vertices, std::span<const std::array<uint32_t, 2>> edges);
/// For each vertex the least vertex of the piece that it belongs to: what triangles connect.
std::vector<uint32_t> pieces_of(const Mesh& mesh);

/// The triangles of which `keep` says so, with their vertices.
Mesh part_of_triangles(const Mesh& mesh, std::span<const uint8_t> keep);

/// The pieces of at least so large a share of the largest one's area; 1: it alone.
Mesh large_pieces(const Mesh& mesh, double least_share);

/// The part where a function is above 0. values: [mesh.vertex_count()], linear in between: triangles that it crosses
/// are cut, so that the new border follows it.
Mesh clipped(const Mesh& mesh, std::span<const double> values);

/// Takes off triangles that hang by one edge (not where they are more than 1 % of the area), and smooths what is
/// sawtooth of the border: each of its vertices moves towards the middle between its two neighbours there, within the
/// surface, so many times. Vertices amid the mesh stay, and so do those of the border where a triangle would turn over
/// or vanish.
Mesh with_smooth_border(const Mesh& mesh, int rounds = 10);

}  // namespace radiafit::tools
