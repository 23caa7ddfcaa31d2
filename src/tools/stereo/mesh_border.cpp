#include "stereo/mesh_border.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

namespace radiafit::tools {
namespace {

constexpr uint32_t none = no_triangle;

Vec3f twice_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) { return (b - a).cross(c - a); }
Vec3f twice_area(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
    return twice_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
}

uint64_t key_of(uint32_t a, uint32_t b) { return uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

/// The same triangles, without vertices that none has.
Mesh without_unused_vertices(const Mesh& mesh) {
    Mesh out;
    std::vector<uint32_t> place(mesh.vertex_count(), none);
    for (const auto& t : mesh.triangles)
        for (const uint32_t v : t) place[v] = 0;
    for (size_t v = 0; v < place.size(); ++v)
        if (place[v] != none) {
            place[v] = uint32_t(out.positions.size());
            out.positions.push_back(mesh.positions[v]);
        }
    out.triangles = mesh.triangles;
    for (auto& t : out.triangles)
        for (uint32_t& v : t) v = place[v];
    return out;
}

/// Of each vertex that has exactly two border edges, its neighbours along them; else none.
std::vector<std::array<uint32_t, 2>> border_neighbours(const Mesh& mesh) {
    std::vector<std::array<uint32_t, 2>> neighbours(mesh.vertex_count(), {none, none});
    std::vector<uint8_t> edges(mesh.vertex_count(), 0);
    const auto add = [&](uint32_t v, uint32_t other) {
        if (edges[v] < 2) neighbours[v][edges[v]] = other;
        edges[v] = uint8_t(std::min(edges[v] + 1, 3));
    };
    for (const auto& [a, b] : border_edges(mesh)) add(a, b), add(b, a);
    for (size_t v = 0; v < edges.size(); ++v)
        if (edges[v] != 2) neighbours[v] = {none, none};
    return neighbours;
}

/// Without triangles that have two or three border edges, unless these are more than 1 % of the area, as in a coarse
/// mesh.
Mesh without_ears(const Mesh& mesh) {
    std::vector<uint64_t> border;
    for (const auto& [a, b] : border_edges(mesh)) border.push_back(key_of(a, b));
    std::ranges::sort(border);
    std::vector<uint8_t> keep;
    double area = 0, lost = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        int count = 0;
        for (const uint64_t key : {key_of(a, b), key_of(b, c), key_of(c, a)})
            count += std::ranges::binary_search(border, key);
        keep.push_back(count < 2);
        const auto own = double(twice_area(mesh, {a, b, c}).norm());
        area += own, lost += keep.back() ? 0 : own;
    }
    constexpr double most_lost = 0.01;
    return lost <= most_lost * area ? part_of_triangles(mesh, keep) : mesh;
}

}  // namespace

std::vector<std::array<uint32_t, 2>> border_edges(const Mesh& mesh) {
    struct Edge {
        uint64_t key;
        uint32_t from, to;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangle_count());
    for (const auto& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = t[k], b = t[(k + 1) % 3];
            edges.push_back({key_of(a, b), a, b});
        }
    std::ranges::stable_sort(edges, {}, &Edge::key);
    std::vector<std::array<uint32_t, 2>> border;
    for (size_t i = 0; i < edges.size();) {
        size_t end = i;
        while (end < edges.size() && edges[end].key == edges[i].key) ++end;
        if (end == i + 1) border.push_back({edges[i].from, edges[i].to});
        i = end;
    }
    return border;
}

double border_length(const Mesh& mesh) {
    double length = 0;
    for (const auto& [a, b] : border_edges(mesh)) length += double((mesh.positions[a] - mesh.positions[b]).norm());
    return length;
}

std::vector<uint32_t> connected(size_t vertices, std::span<const std::array<uint32_t, 2>> edges) {
    std::vector<uint32_t> parent(vertices);
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const auto& [from, to] : edges) {
        const uint32_t a = root(from), b = root(to);
        parent[std::max(a, b)] = std::min(a, b);
    }
    for (uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
    return parent;
}

std::vector<uint32_t> pieces_of(const Mesh& mesh) {
    std::vector<std::array<uint32_t, 2>> edges;
    for (const auto& [a, b, c] : mesh.triangles) edges.insert(edges.end(), {{a, b}, {a, c}});
    return connected(mesh.vertex_count(), edges);
}

Mesh part_of_triangles(const Mesh& mesh, std::span<const uint8_t> keep) {
    Mesh part{mesh.positions, {}};
    for (size_t t = 0; t < keep.size(); ++t)
        if (keep[t]) part.triangles.push_back(mesh.triangles[t]);
    return without_unused_vertices(part);
}

Mesh large_pieces(const Mesh& mesh, double least_share) {
    if (mesh.triangles.empty()) return {};
    const std::vector<uint32_t> piece = pieces_of(mesh);
    std::vector<double> area(mesh.vertex_count(), 0);
    for (const auto& t : mesh.triangles) area[piece[t[0]]] += double(twice_area(mesh, t).norm());
    const auto largest = uint32_t(std::ranges::max_element(area) - area.begin());
    std::vector<uint8_t> keep;
    for (const auto& t : mesh.triangles)
        keep.push_back(piece[t[0]] == largest || (least_share < 1 && area[piece[t[0]]] >= least_share * area[largest]));
    return part_of_triangles(mesh, keep);
}

Mesh clipped(const Mesh& mesh, std::span<const double> values) {
    Mesh out{mesh.positions, {}};
    std::map<uint64_t, uint32_t> cuts;  // vertices on cut edges
    const auto cut = [&](uint32_t a, uint32_t b) {
        const auto [found, added] = cuts.try_emplace(key_of(a, b), 0);
        if (added) {
            if (a > b) std::swap(a, b);  // the same bits from either side
            const auto share = float(values[a] / (values[a] - values[b]));
            const Vec3f at = mesh.positions[a] + share * (mesh.positions[b] - mesh.positions[a]);
            // An end that it falls on takes its place, so that triangles there stay joined.
            found->second = at == mesh.positions[a] ? a : at == mesh.positions[b] ? b : uint32_t(out.positions.size());
            if (found->second == out.positions.size()) out.positions.push_back(at);
        }
        return found->second;
    };
    for (const auto& t : mesh.triangles) {
        std::vector<uint32_t> polygon;
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = t[k], b = t[(k + 1) % 3];
            if (values[a] > 0) polygon.push_back(a);
            if ((values[a] > 0) != (values[b] > 0)) polygon.push_back(cut(a, b));
        }
        for (size_t k = 2; k < polygon.size(); ++k) {
            const auto [a, b, c] = std::array{polygon[0], polygon[k - 1], polygon[k]};
            if (a != b && b != c && c != a) out.triangles.push_back({a, b, c});
        }
    }
    return without_unused_vertices(out);
}

Mesh with_smooth_border(const Mesh& mesh, int rounds) {
    Mesh out = without_ears(without_ears(mesh));
    const std::vector<std::array<uint32_t, 2>> neighbours = border_neighbours(out);
    const std::vector<Vec3f> normals = vertex_normals(out);
    for (int round = 0; round < rounds; ++round) {
        std::vector<Vec3f> moved = out.positions;
        for (size_t v = 0; v < moved.size(); ++v) {
            const auto& [a, b] = neighbours[v];
            if (a == none) continue;
            Vec3f step = ((out.positions[a] + out.positions[b]) / 2 - out.positions[v]) / 2;
            step -= normals[v].dot(step) * normals[v];
            moved[v] += step;
        }
        // A triangle that would turn over or nearly vanish keeps its vertices.
        constexpr float least_share = 0.2f;  // of its area that is left
        for (bool held = true; held;) {
            held = false;
            for (const auto& t : out.triangles) {
                const Vec3f before = twice_area(out, t), after = twice_area(moved[t[0]], moved[t[1]], moved[t[2]]);
                if (before.dot(after) > least_share * before.squaredNorm()) continue;
                for (const uint32_t v : t)
                    if (moved[v] != out.positions[v]) moved[v] = out.positions[v], held = true;
            }
        }
        out.positions = std::move(moved);
    }
    return out;
}

}  // namespace radiafit::tools
