#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/linear.h"
#include "base/text_file.h"

namespace radiafit::tools {

/// What a mesh file lists, before it is placed and welded: every index is within the positions, and every position is
/// within the range of 32-bit floats.
struct RawMesh {
    std::vector<Vec3d> positions;
    std::vector<std::array<uint32_t, 3>> triangles;
    size_t no_polygons = 0;       ///< points, lines and faces of fewer than three corners, left out
    size_t unused_vertices = 0;   ///< of no face, left out
    size_t unsound_polygons = 0;  ///< cross themselves or have no area: triangles around their first corner
    std::vector<std::string> remarks;

    /// Becomes triangles in cut_polygons(), until then around its first corner.
    void add_polygon(std::span<const uint32_t> corners);
    /// Each corner from the third on makes a triangle with the two before it, turned alternately. Triangles that have a
    /// corner twice only lead from one part of the strip to another.
    void add_strip(std::span<const uint32_t> corners);
    /// Once all positions are known: cuts the polygons that triangles around their first corner do not fill.
    void cut_polygons();

private:
    struct Polygon {
        size_t first_triangle;
        size_t corners;
    };
    std::vector<Polygon> polygons_;  ///< of four corners or more
};

/// A coordinate; as a 32-bit float it is the one nearest to the text. Throws UserError at the file's line: no number,
/// or beyond the range of 32-bit floats.
double to_coordinate(const TextFile& text, std::string_view word, const char* what);

}  // namespace radiafit::tools
