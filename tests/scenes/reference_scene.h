// A vertex for the reference solvers, and the truth about it.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/lfm_oracle.h"
#include "cpu/lfm_problem.h"
#include "model/lfm_start.h"
#include "reference/vertex_runs.h"
#include "scenes.h"

namespace radiafit::testing {
using namespace fits;
using namespace harness;

using V = Lanes<double>;

inline LfmOptions smooth(int terms = 1, ViewLookup lookup = ViewLookup::bilinear) {
    LfmOptions o;
    o.terms = terms;
    o.surface_side = 5;
    o.view_side = 4;
    o.lookup = lookup;
    o.lambda_surface = 1e-2f, o.lambda_view = 2e-2f, o.mu = 0.7f;
    o.lower = 0, o.upper = 1;
    return o;
}

/// A sheet whose samples come from a glossy surface that no light field map of few terms holds exactly.
struct Scene : SampledScene {
    LfmVertices vertices;

    explicit Scene(const LfmOptions& o, uint64_t seed = 1)
        : SampledScene(o, sheet_dataset(troubled_mesh(3, 7, seed), 20, 64, seed),
                       [&](const TriangleAtlas& tiles, const Dataset& set) { return glossy(tiles, set, seed); }),
          vertices(dataset, atlas, rings, samples, o) {}

    static SampleList glossy(const TriangleAtlas& atlas, const Dataset& dataset, uint64_t seed) {
        SampleList list = random_samples(atlas, dataset.views.size(), 0.8f, seed);
        for (size_t tile = 0; tile < list.tile_count(); ++tile)
            for (uint32_t g = list.tile_groups[tile]; g < list.tile_groups[tile + 1]; ++g)
                for (uint32_t s = list.groups[g].first; s < list.groups[g + 1].first; ++s) {
                    Sample& sample = list.samples[s];
                    const Vec3d x = atlas.position(uint32_t(tile), sample.local).cast<double>();
                    const Vec3d eye = (dataset.views[list.groups[g].image].camera.center() - x).normalized();
                    for (int c = 0; c < 3; ++c) {
                        const double diffuse = 0.3 + 0.2 * std::sin(5 * x[0] + c) * std::cos(4 * x[1]);
                        const double gloss = 0.3 * std::pow(std::max(0.0, eye.dot(Vec3d(0.3, 0.1 * c, 0.9))), 8);
                        const double noise = 0.02 * (sample.rgb[c] / 65535.0 - 0.5);
                        sample.rgb[c] = uint16_t(65535 * std::clamp(diffuse + gloss + noise, 0.0, 1.0));
                    }
                }
        return list;
    }
    size_t vertex_with_samples(size_t from = 0) const {
        while (!vertices.statistics().samples[from]) ++from;
        return from;
    }
    LfmVertex gather(size_t v) const {
        LfmVertex out;
        vertices.gather(v, out);
        return out;
    }
};

inline std::vector<V> random_block(size_t count, uint64_t seed) {
    std::vector<V> out(count);
    Rng rng(seed);
    for (V& x : out) x = V{rng.uniform(-0.4f, 1.6f), rng.uniform(-0.4f, 1.6f), rng.uniform(-0.4f, 1.6f), 0};
    return out;
}
inline std::vector<double> channel_of(const std::vector<V>& p, int c) {
    std::vector<double> x;
    for (const V& value : p) x.push_back(value[c]);
    return x;
}

/// E_t and its gradient as the engines define them, in double, and the magnitude of each entry's terms.
struct Truth {
    double error[3];
    std::vector<V> gradient, magnitude;
};
inline Truth truth_of(const Scene& scene, size_t v, const std::vector<V>& p) {
    LfmProblem<double> problem(scene.dataset, scene.atlas, scene.rings, scene.samples, scene.options);
    const auto statistics = problem.count();
    EXPECT_EQ(statistics.samples, scene.vertices.statistics().samples);
    EXPECT_EQ(statistics.mean, scene.vertices.statistics().mean);
    Truth out{{}, std::vector<V>(p.size()), std::vector<V>(p.size())};
    problem.direction(v, p.data(), out.gradient.data(), nullptr, out.error);

    const LfmLayout& layout = problem.layout();
    std::vector<double> all(layout.size());
    for (size_t i = 0; i < p.size(); ++i)
        for (int c = 0; c < 4; ++c) all[layout.offset(v) + 4 * i + size_t(c)] = p[i][c];
    const auto oracle =
        lfm_oracle(scene.dataset, scene.atlas, scene.rings, layout, scene.options, scene.samples, all, {});
    const double density = double(oracle.samples[v]) / double(problem.texels(v));
    for (size_t i = 0; i < p.size(); ++i)
        for (int c = 0; c < 3; ++c)  // 64: the sum of magnitudes of a row of L'L; 1.6: the largest |p|
            out.magnitude[i][c] = oracle.gradient[layout.offset(v) + 4 * i + size_t(c)].magnitude / density +
                                  1.6 * (64 * double(scene.options.lambda_surface) + double(scene.options.mu));
    return out;
}

inline double gradient_norm(const Scene& scene, size_t v, const std::vector<V>& p, int c) {
    double sum = 0;
    for (const V& g : truth_of(scene, v, p).gradient) sum += g[c] * g[c];
    return std::sqrt(sum);
}
inline std::vector<V> block_of(const Scene& scene, const std::vector<float>& parameters, size_t v) {
    const LfmLayout& layout = scene.vertices.layout();
    std::vector<V> p(layout.block_size(v) / 4);
    for (size_t i = 0; i < p.size(); ++i)
        for (int c = 0; c < 4; ++c) p[i][c] = double(parameters[layout.offset(v) + 4 * i + size_t(c)]);
    return p;
}

/// Runs one vertex in double, without the rounding to float of what is returned.
inline std::vector<V> solve_one(const Scene& scene, size_t v, const VertexSolver& solver, VertexRun& run) {
    auto p = block_of(scene, lfm_start(scene.vertices.layout(), scene.vertices.statistics().mean, 1), v);
    solver(scene.gather(v), p, run);
    return p;
}

}  // namespace radiafit::testing
