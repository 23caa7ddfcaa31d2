#pragma once
#include <cmath>
#include <numbers>
#include <random>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "geometry/mesh.h"
#include "gl/context.h"

/// Small scenes for the tests of gl/: everything an atlas must survive in one mesh, and images of noise.
namespace radiafit {

/// A bumpy sphere of 20 * 4^levels triangles with a hole, closed elsewhere.
inline Mesh bumpy_sphere(int levels) {
    Mesh mesh;
    const float t = 0.5f * (1 + std::sqrt(5.0f));
    for (const auto& p : {Vec3f{-1, t, 0},
                          {1, t, 0},
                          {-1, -t, 0},
                          {1, -t, 0},
                          {0, -1, t},
                          {0, 1, t},
                          {0, -1, -t},
                          {0, 1, -t},
                          {t, 0, -1},
                          {t, 0, 1},
                          {-t, 0, -1},
                          {-t, 0, 1}})
        mesh.positions.push_back(p.normalized());
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::vector<std::array<uint32_t, 3>> finer;
        auto middle = [&](uint32_t a, uint32_t b) {
            const Vec3f m = (mesh.positions[a] + mesh.positions[b]).normalized();
            for (uint32_t i = 0; i < mesh.positions.size(); ++i)
                if ((mesh.positions[i] - m).norm() < 1e-4f) return i;
            mesh.positions.push_back(m);
            return static_cast<uint32_t>(mesh.positions.size() - 1);
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (Vec3f& p : mesh.positions) p *= 1 + 0.1f * std::sin(5 * p.x()) * std::cos(4 * p.y() + p.z());
    mesh.triangles.erase(mesh.triangles.begin() + 3);
    return mesh;
}

/// The sphere, and beside it a fan whose hub has valence 40; then a degenerate triangle and a vertex nobody uses.
inline Mesh awkward_mesh(int levels) {
    Mesh mesh = bumpy_sphere(levels);
    const uint32_t hub = static_cast<uint32_t>(mesh.positions.size());
    const int spokes = 40;
    mesh.positions.emplace_back(0, 0, 1.35f);
    for (int i = 0; i < spokes; ++i) {
        const float a = 2 * std::numbers::pi_v<float> * float(i) / spokes;
        mesh.positions.emplace_back(0.8f * std::cos(a), 0.8f * std::sin(a), 1.3f + 0.05f * float(i % 3));
    }
    for (uint32_t i = 0; i < spokes; ++i) {
        mesh.triangles.push_back({hub, hub + 1 + i, hub + 1 + (i + 1) % spokes});
        if (i == 7) mesh.triangles.push_back({hub, hub + 3, hub + 3});  // a vertex twice
    }
    mesh.positions.emplace_back(3, 3, 3);
    return mesh;
}

/// Cameras all around at 3.2 radii.
inline Camera orbit_camera(int i, int count, int width, int height) {
    const double z = 1 - 2 * (i + 0.5) / count, a = 2.4 * i, r = std::sqrt(1 - z * z);
    return Camera::look_at(3.2 * Vec3d(r * std::cos(a), r * std::sin(a), z), Vec3d(0.02, 0.01, 0.05),
                           Vec3d(0.1, 0.2, 1), 0.75, width, height);
}

/// Noise, with a tenth of the pixels masked out.
inline TargetImage noise_image(int width, int height, unsigned seed) {
    std::mt19937 rng(seed);
    TargetImage image;
    image.width = width;
    image.height = height;
    image.rgba8.resize(size_t(width) * height * 4);
    for (size_t i = 0; i < image.rgba8.size(); ++i)
        image.rgba8[i] = i % 4 == 3 ? (rng() % 10 ? 255 : 0) : uint8_t(rng() % 256);
    return image;
}

inline std::unique_ptr<Context> make_context(ContextKind kind) {
    ContextOptions options;
    options.kind = kind;
    options.debug = true;
    return Context::create(options);
}

}  // namespace radiafit
