#pragma once
#include <cmath>
#include <map>
#include <numbers>

#include "base/rng.h"
#include "geometry/mesh.h"

/// Meshes for tests, all counter-clockwise from outside (or from +z).
namespace radiafit::testing {

/// A closed sphere of 8 side² triangles, in octants; `bump` makes it a star whose arms hide one another.
inline Mesh ball(int side, float bump = 0) {
    Mesh mesh;
    std::map<std::array<int, 3>, uint32_t> ids;
    const auto vertex = [&](int x, int y, int z) {
        const auto [it, fresh] = ids.try_emplace({x, y, z}, static_cast<uint32_t>(mesh.positions.size()));
        if (fresh) {
            const Vec3f d = Vec3f(float(x), float(y), float(z)).normalized();
            mesh.positions.push_back(d *
                                     (1 + bump * std::sin(6 * d.x()) * std::sin(5 * d.y() + 1) * std::cos(4 * d.z())));
        }
        return it->second;
    };
    for (const int sx : {1, -1})
        for (const int sy : {1, -1})
            for (const int sz : {1, -1})
                for (int i = 0; i < side; ++i)
                    for (int j = 0; i + j < side; ++j) {
                        const auto at = [&](int a, int b) { return vertex(sx * a, sy * b, sz * (side - a - b)); };
                        const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
                            if (sx * sy * sz < 0) std::swap(b, c);
                            mesh.triangles.push_back({a, b, c});
                        };
                        add(at(i, j), at(i + 1, j), at(i, j + 1));
                        if (i + j + 1 < side) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                    }
    return mesh;
}

/// `valence` triangles around vertex 0, closed or with a boundary, facing +z.
inline Mesh fan(int valence, bool closed, Rng& rng) {
    Mesh mesh;
    mesh.positions.push_back({0, 0, rng.uniform(-0.2f, 0.2f)});
    const int rim = closed ? valence : valence + 1;
    const float turn = closed ? 2 * std::numbers::pi_v<float> : 5;
    for (int k = 0; k < rim; ++k) {
        const float a = turn * float(k) / float(closed ? rim : rim - 1), r = rng.uniform(0.5f, 1.5f);
        mesh.positions.push_back({r * std::cos(a), r * std::sin(a), rng.uniform(-0.2f, 0.2f)});
    }
    for (int k = 0; k < valence; ++k)
        mesh.triangles.push_back({0, static_cast<uint32_t>(1 + k), static_cast<uint32_t>(1 + (k + 1) % rim)});
    return mesh;
}

/// Appends `other`, moved aside, as a separate component.
inline void append(Mesh& mesh, const Mesh& other, const Vec3f& shift) {
    const uint32_t base = static_cast<uint32_t>(mesh.positions.size());
    for (const Vec3f& p : other.positions) mesh.positions.push_back(p + shift);
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + base, b + base, c + base});
}

/// Fans of random valence up to 100, open and closed, with degenerate triangles and unreferenced vertices among them.
inline Mesh random_mesh(uint64_t seed) {
    Rng rng(seed);
    Mesh mesh;
    const uint32_t parts = 3 + rng.index(5);
    for (uint32_t k = 0; k < parts; ++k) {
        const bool closed = rng.index(2) == 0;
        const int valence = closed ? 3 + int(rng.index(98)) : 1 + int(rng.index(100));
        append(mesh, fan(valence, closed, rng), {3 * float(k), 0, 0});
        const uint32_t v = rng.index(static_cast<uint32_t>(mesh.positions.size()));
        const uint32_t w = rng.index(static_cast<uint32_t>(mesh.positions.size()));
        mesh.triangles.push_back({v, w, v});          // a vertex twice
        mesh.positions.push_back(mesh.positions[v]);  // a place twice
        mesh.triangles.push_back({v, w, uint32_t(mesh.positions.size() - 1)});
        mesh.positions.push_back({float(k), 100, 0});  // referenced by nothing
    }
    return mesh;
}

}  // namespace radiafit::testing
