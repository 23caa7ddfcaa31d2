#include "capture/raw_mesh.h"

#include <bit>
#include <cmath>

#include "capture/polygon.h"

namespace radiafit::tools {

void RawMesh::add_polygon(std::span<const uint32_t> corners) {
    if (corners.size() < 3) ++no_polygons;
    if (corners.size() > 3) polygons_.push_back({triangles.size(), corners.size()});
    for (size_t k = 2; k < corners.size(); ++k) triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

void RawMesh::add_strip(std::span<const uint32_t> corners) {
    if (corners.size() < 3) ++no_polygons;
    for (size_t k = 2; k < corners.size(); ++k) {
        std::array<uint32_t, 3> t = {corners[k - 2], corners[k - 1], corners[k]};
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        if (k % 2) std::swap(t[0], t[1]);
        triangles.push_back(t);
    }
}

void RawMesh::cut_polygons() {
    std::vector<uint32_t> corners;
    std::vector<Vec3d> points;
    PolygonCutter cutter;
    for (const Polygon& polygon : polygons_) {
        const auto fan = std::span(triangles).subspan(polygon.first_triangle, polygon.corners - 2);
        corners.assign({fan[0][0], fan[0][1]});
        for (const auto& triangle : fan) corners.push_back(triangle[2]);
        points.clear();
        for (const uint32_t corner : corners) points.push_back(positions[corner]);
        if (!cutter.cut(points)) ++unsound_polygons;
        for (size_t k = 0; k < fan.size(); ++k)
            for (size_t i = 0; i < 3; ++i) fan[k][i] = corners[cutter.triangles()[k][i]];
    }
    polygons_.clear();
}

double to_coordinate(const TextFile& text, std::string_view word, const char* what) {
    const double value = text.to_double(word, what);
    if (!std::isfinite(static_cast<float>(value))) return text.to_float(word, what);  // says so
    // Rounded to double and then to float, a number halfway between floats can end at the other one than the text's.
    constexpr uint64_t lost_bits = (uint64_t(1) << 29) - 1;
    if ((std::bit_cast<uint64_t>(value) & lost_bits) != (lost_bits + 1) / 2) return value;
    const double nearest = text.to_float(word, what);
    return double(static_cast<float>(value)) == nearest ? value : std::nextafter(value, nearest);
}

}  // namespace radiafit::tools
