#include "geometry/mesh_part.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace radiafit {
namespace {

/// The lower 21 bits, each followed by two zeros.
uint64_t spread(uint64_t bits) {
    bits = (bits | bits << 32) & 0x001f00000000ffff;
    bits = (bits | bits << 16) & 0x001f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

std::vector<uint64_t> morton_codes(std::span<const Vec3f> points) {
    const Box box = bounding_box(points);
    constexpr double cells = 1 << 21;
    const double extent = std::max(double((box.high - box.low).maxCoeff()), 1e-300);
    std::vector<uint64_t> codes;
    for (const Vec3f& p : points) {
        const Vec3d at = (p - box.low).cast<double>() / extent * cells;
        uint64_t code = 0;
        for (int axis = 0; axis < 3; ++axis) code |= spread(uint64_t(std::clamp(at[axis], 0.0, cells - 1))) << axis;
        codes.push_back(code);
    }
    return codes;
}

/// The part of `triangles`, ascending. own: [whole's V], not 0 for the vertices that have a problem in the part.
Mesh cut(const std::shared_ptr<const Mesh>& whole, std::vector<uint32_t> triangles, const std::vector<uint8_t>& own) {
    const auto around = std::make_shared<Surroundings>();
    around->whole = whole;
    std::vector<uint8_t> used = own;
    for (const uint32_t t : triangles)
        for (const uint32_t v : whole->triangles[t]) used[v] = 1;
    Mesh part;
    std::vector<uint32_t> in_part(whole->vertex_count());
    for (uint32_t v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        in_part[v] = uint32_t(part.positions.size());
        part.positions.push_back(whole->positions[v]);
        around->vertices.push_back(v);
        around->rim.push_back(!own[v]);
    }
    around->part_triangle.assign(whole->triangle_count(), no_triangle);
    for (const uint32_t t : triangles) {
        around->part_triangle[t] = uint32_t(part.triangles.size());
        const auto& [a, b, c] = whole->triangles[t];
        part.triangles.push_back({in_part[a], in_part[b], in_part[c]});
    }
    around->triangles = std::move(triangles);
    part.surroundings = around;
    return part;
}

}  // namespace

std::vector<std::vector<uint32_t>> groups_of_neighbours(std::span<const Vec3f> points,
                                                        std::span<const uint64_t> weights, size_t count) {
    const std::vector<uint64_t> codes = morton_codes(points);
    std::vector<uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, [&](uint32_t a, uint32_t b) { return std::pair(codes[a], a) < std::pair(codes[b], b); });
    const double whole = double(std::accumulate(weights.begin(), weights.end(), uint64_t(0)));
    std::vector<std::vector<uint32_t>> groups(count);
    uint64_t before = 0;
    for (const uint32_t i : order) {
        const double middle = double(before) + 0.5 * double(weights[i]);
        groups[std::min(count - 1, size_t(middle / whole * double(count)))].push_back(i);
        before += weights[i];
    }
    for (auto& group : groups) std::ranges::sort(group);
    return groups;
}

Mesh part_around(const std::shared_ptr<const Mesh>& whole, const VertexRings& rings, std::span<const uint32_t> vertices,
                 int halo) {
    std::vector<uint8_t> own(whole->vertex_count(), 0), taken(whole->triangle_count(), 0);
    std::vector<uint32_t> around(vertices.begin(), vertices.end());
    for (const uint32_t v : vertices) own[v] = 1;
    std::vector<uint8_t> reached = own;
    for (int step = 0; step <= halo; ++step) {
        std::vector<uint32_t> next;
        for (const uint32_t v : around)
            for (const Corner& corner : rings.ring(v)) {
                if (taken[corner.triangle]) continue;
                taken[corner.triangle] = 1;
                for (const uint32_t other : whole->triangles[corner.triangle])
                    if (!reached[other]) {
                        reached[other] = 1;
                        next.push_back(other);
                    }
            }
        around = std::move(next);
    }
    std::vector<uint32_t> triangles;
    for (uint32_t t = 0; t < taken.size(); ++t)
        if (taken[t]) triangles.push_back(t);
    return cut(whole, std::move(triangles), own);
}

Mesh part_of(const std::shared_ptr<const Mesh>& whole, std::vector<uint32_t> triangles) {
    return cut(whole, std::move(triangles), std::vector<uint8_t>(whole->vertex_count(), 0));
}

Box bounding_box(std::span<const Vec3f> points) {
    Box box;
    for (const Vec3f& p : points) {
        box.low = box.low.cwiseMin(p);
        box.high = box.high.cwiseMax(p);
    }
    return box;
}

bool may_show(const Camera& camera, const Box& box) {
    // Planes through the camera's centre and the image's edges, moved a pixel outwards: rounding must not lose a point.
    const double left = -1, top = -1, right = camera.width + 1.0, bottom = camera.height + 1.0;
    std::array<bool, 5> beyond;
    beyond.fill(true);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3f p(corner & 1 ? box.high.x() : box.low.x(), corner & 2 ? box.high.y() : box.low.y(),
                      corner & 4 ? box.high.z() : box.low.z());
        const Vec3d c = camera.to_camera(p.cast<double>());
        const double x = camera.fx * c.x() + camera.cx * c.z(), y = camera.fy * c.y() + camera.cy * c.z();
        const bool outside[5] = {c.z() <= 0, x<left * c.z(), x> right * c.z(), y<top * c.z(), y> bottom * c.z()};
        for (size_t plane = 0; plane < beyond.size(); ++plane) beyond[plane] = beyond[plane] && outside[plane];
    }
    return std::ranges::none_of(beyond, [](bool all) { return all; });
}

}  // namespace radiafit
