#include <map>

#include "synthetic/closed_mesh.h"

namespace radiafit {

Mesh subdivided(const Mesh& mesh, int n) {
    Mesh out;
    out.positions = mesh.positions;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> edges;  // from the lower vertex to the higher: first of n - 1
    const auto between = [&](uint32_t a, uint32_t b, int step) {
        const Vec3f &p = mesh.positions[a], &q = mesh.positions[b];
        return Vec3f(p + (q - p) * (float(step) / float(n)));
    };
    const auto on_edge = [&](uint32_t a, uint32_t b, int step) {
        if (a > b) return std::tuple(b, a, n - step);
        return std::tuple(a, b, step);
    };
    for (const auto& [v0, v1, v2] : mesh.triangles) {
        // vertices (i, j): i steps towards v1, j towards v2
        std::vector<std::vector<uint32_t>> at(size_t(n) + 1);
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n - j; ++i) {
                const int k = n - i - j;
                const auto edge = j == 0 ? on_edge(v0, v1, i) : i == 0 ? on_edge(v0, v2, j) : on_edge(v1, v2, j);
                uint32_t vertex = i == n ? v1 : j == n ? v2 : v0;
                if (k != n && i != n && j != n && (i == 0 || j == 0 || k == 0)) {
                    const auto [low, high, step] = edge;
                    const auto [found, fresh] = edges.try_emplace({low, high}, uint32_t(out.positions.size()));
                    for (int s = 1; fresh && s < n; ++s) out.positions.push_back(between(low, high, s));
                    vertex = found->second + uint32_t(step) - 1;
                } else if (k != n && i != n && j != n) {
                    const Vec3f &p0 = mesh.positions[v0], &p1 = mesh.positions[v1], &p2 = mesh.positions[v2];
                    vertex = uint32_t(out.positions.size());
                    out.positions.push_back((p0 * float(k) + p1 * float(i) + p2 * float(j)) / float(n));
                }
                at[size_t(j)].push_back(vertex);
            }
        for (size_t j = 0; j < size_t(n); ++j)
            for (size_t i = 0; i + j < size_t(n); ++i) {
                out.triangles.push_back({at[j][i], at[j][i + 1], at[j + 1][i]});
                if (i + j + 1 < size_t(n)) out.triangles.push_back({at[j][i + 1], at[j + 1][i + 1], at[j + 1][i]});
            }
    }
    return out;
}

}  // namespace radiafit
