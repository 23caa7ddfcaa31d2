#pragma once
#include <cmath>
#include <vector>

#include "base/rng.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

/// Small scenes that hold every trouble a mesh can bring, and sample lists that need no images.
namespace radiafit::testing {

/// A bumpy sheet of 2 * cells^2 triangles with boundaries, a fan whose hub has `spokes` triangles, one degenerate
/// triangle and one unreferenced vertex. Faces +z.
inline Mesh troubled_mesh(int cells, int spokes, uint64_t seed) {
    Mesh mesh;
    Rng rng(seed);
    const auto bump = [&] { return rng.uniform(-0.05f, 0.05f); };
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i)
            mesh.positions.push_back({float(i) / cells + bump() / cells, float(j) / cells + bump() / cells, bump()});
    const auto at = [&](int i, int j) { return uint32_t(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    const auto hub = uint32_t(mesh.positions.size());
    mesh.positions.push_back({1.6f, 0.5f, 0.1f});
    for (int i = 0; i < spokes; ++i) {
        const float angle = 6.2831853f * float(i) / float(spokes);
        mesh.positions.push_back({1.6f + 0.5f * std::cos(angle), 0.5f + 0.5f * std::sin(angle), bump()});
    }
    for (int i = 0; i < spokes; ++i)
        mesh.triangles.push_back({hub, hub + 1 + uint32_t(i), hub + 1 + uint32_t((i + 1) % spokes)});
    mesh.triangles.push_back({0, 1, 1});            // degenerate
    mesh.positions.push_back({0.5f, 0.5f, -1.0f});  // unreferenced
    return mesh;
}

/// A dataset of that mesh with `views` cameras above it; it has no images.
inline Dataset sheet_dataset(Mesh mesh, int views, int size, uint64_t seed) {
    Dataset dataset;
    dataset.name = "sheet";
    dataset.mesh = std::move(mesh);
    Rng rng(seed);
    for (int i = 0; i < views; ++i) {
        View view;
        view.name = "view" + std::to_string(i);
        const Vec3d eye(1.0 + 2.5 * rng.uniform(-1, 1), 0.5 + 2.5 * rng.uniform(-1, 1), 2.0 + rng.uniform());
        view.camera = Camera::look_at(eye, {1.0, 0.5, 0.0}, {0, 1, 0}, 0.9, size, size);
        dataset.views.push_back(view);
    }
    return dataset;
}

/// Samples that no camera took: each usable tile has, in a share of the images, a random set of its texels.
inline SampleList random_samples(const TriangleAtlas& atlas, size_t images, float share, uint64_t seed) {
    SampleList list;
    Rng rng(seed);
    for (uint32_t i = 0; i < images; ++i) list.views.push_back(i);
    list.tile_groups.push_back(0);
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
        for (uint32_t image = 0; image < images && !atlas.degenerate(tile); ++image) {
            if (rng.uniform() > share) continue;
            const auto first = uint32_t(list.samples.size());
            for (uint32_t local = 0; local < atlas.tile(tile).texels(); ++local)
                if (rng.uniform() < 0.4f)
                    list.samples.push_back(
                        {{uint16_t(rng.bits() >> 16), uint16_t(rng.bits() >> 16), uint16_t(rng.bits() >> 16)},
                         uint16_t(local)});
            if (list.samples.size() > first) list.groups.push_back({image, first});
        }
        list.tile_groups.push_back(uint32_t(list.groups.size()));
    }
    list.groups.push_back({0, uint32_t(list.samples.size())});
    return list;
}

/// Surface maps of sides from 2 to surface_side, drawn for each triangle.
inline LfmOptions with_own_sides(LfmOptions options, const Mesh& mesh, uint64_t seed = 1) {
    Rng rng(seed);
    std::vector<uint8_t> sides;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        sides.push_back(
            uint8_t(t == 0 ? options.surface_side : 2 + int(rng.index(uint32_t(options.surface_side) - 1))));
    options.sides = std::make_shared<const std::vector<uint8_t>>(std::move(sides));
    return options;
}

/// What engines and solvers are made of.
struct SampledScene {
    Dataset dataset;
    TriangleAtlas atlas;
    VertexRings rings;
    SampleList samples;
    LfmOptions options;

    /// sample(atlas, dataset) gives the samples.
    template <class Sampler>
    SampledScene(const LfmOptions& o, Dataset set, const Sampler& sample)
        : dataset(std::move(set)),
          atlas(surface_atlas(dataset.mesh, o)),
          rings(dataset.mesh),
          samples(sample(atlas, dataset)),
          options(o) {}
};

}  // namespace radiafit::testing
