#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "bench/exact_sum.h"
#include "bench/loss_oracle.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

/// Eq. 14-15 written down naively in double, sample by sample, with no code in common with the engines but the view
/// footprint. Penalties are left out and nothing is normalized. In the magnitudes of terms the sums inside a term
/// (residual, view look-up) are opened, too.
namespace radiafit::harness {

struct LfmOracle {
    std::vector<ExactSum> error;                                   ///< [vertices * 3] E = 1/2 sum r^2
    std::vector<ExactSum> gradient;                                ///< [layout.size()]
    std::vector<ExactSum> diagonal;                                ///< [layout.size()] diag(J'J)
    std::vector<ExactSum> gauss_newton, curvature, third, fourth;  ///< [vertices * 3]
    std::vector<uint32_t> samples;                                 ///< [vertices]
};

/// What a vertex's samples in one image share.
struct LfmOracleView {
    std::array<size_t, 4> texel;   ///< of the view map
    std::array<double, 4> weight;  ///< of these
    double root = 1;               ///< of the samples' weight

    LfmOracleView(const Frame& frame, const Vec3f& position, const Vec3d& eye, const LfmOptions& options) {
        const auto m = size_t(options.view_side);
        const ViewFootprint f = view_footprint(frame, position, eye, options.view_side, options.lookup);
        texel = {f.texel, f.texel + size_t(1), f.texel + m, f.texel + m + 1};
        if (options.loss.weights == SampleWeights::facing) {
            const Vec3d to_camera = eye - position.cast<double>();
            const double along = to_camera.dot(frame.normal.cast<double>());
            root = along > 0 ? std::sqrt(along / to_camera.norm()) : 0;
        }
        for (size_t j = 0; j < 4; ++j) weight[j] = double(float(f.weight[j] * root));
    }
};

/// p, d in layout order; d may be empty.
inline LfmOracle lfm_oracle(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                            const LfmLayout& layout, const LfmOptions& options, const SampleList& list,
                            const std::vector<double>& p, const std::vector<double>& d) {
    LfmOracle out;
    const size_t problems = 3 * layout.problem_count();
    for (auto* sums : {&out.error, &out.gauss_newton, &out.curvature, &out.third, &out.fourth}) sums->resize(problems);
    out.gradient.resize(layout.size());
    out.diagonal.resize(layout.size());
    out.samples.resize(layout.problem_count());
    const auto frames = vertex_frames(dataset.mesh);
    std::vector<Vec3d> eyes;
    for (const uint32_t view : list.views) eyes.push_back(dataset.views[view].camera.center());

    const auto add_sample = [&](uint32_t v, uint32_t tile, int corner, const LfmOracleView& seen, const Sample& s) {
        const double lambda = seen.root * double(atlas.tile(tile).barycentric(s.local)[size_t(corner)]);
        for (int c = 0; c < 3; ++c) {
            const auto surface = [&](int k) {
                return layout.map_offset(tile, uint32_t(corner)) + s.local * layout.stride() + size_t(4 * k + c);
            };
            const auto view = [&](int k, size_t j) {
                return layout.view_offset(v) + seen.texel[j] * layout.stride() + size_t(4 * k + c);
            };
            ExactSum r = exact(-lambda * s.rgb[c] * double(list.scale)), a, b;
            for (int k = 0; k < options.terms; ++k) {
                ExactSum h, dh;
                for (size_t j = 0; j < 4; ++j) {
                    h += exact(seen.weight[j] * p[view(k, j)]);
                    if (!d.empty()) dh += exact(seen.weight[j] * d[view(k, j)]);
                }
                r += exact(p[surface(k)]) * h;
                if (d.empty()) continue;
                a += exact(d[surface(k)]) * h;
                a += exact(p[surface(k)]) * dh;
                b += exact(d[surface(k)]) * dh;
            }
            const LossOracle loss(options.loss, r.value, r.magnitude);
            const ExactSum weight{loss.weight, loss.weight * (1 + loss.sensitivity)};
            for (int k = 0; k < options.terms; ++k) {
                ExactSum h;
                for (size_t j = 0; j < 4; ++j) {
                    h += exact(seen.weight[j] * p[view(k, j)]);
                    const ExactSum by_view = exact(seen.weight[j] * p[surface(k)]);
                    out.gradient[view(k, j)] += weight * r * by_view;
                    out.diagonal[view(k, j)] += weight * by_view * by_view;
                }
                out.gradient[surface(k)] += weight * r * h;
                out.diagonal[surface(k)] += weight * h * h;
            }
            const size_t i = 3 * size_t(v) + size_t(c);
            out.error[i] += {loss.value, weight.magnitude * r.magnitude * r.magnitude / 2};
            out.gauss_newton[i] += weight * a * a;
            out.curvature[i] += weight * a * a;
            out.curvature[i] += weight * exact(2) * r * b;
            out.third[i] += weight * a * b;
            out.fourth[i] += weight * b * b;
        }
    };
    parallel_for(layout.problem_count(), 1, [&](size_t v, int) {
        for (const Corner& corner : rings.ring(v))
            for (uint32_t g = list.tile_groups[corner.triangle]; g < list.tile_groups[corner.triangle + 1]; ++g) {
                const LfmOracleView seen(frames[v], dataset.mesh.positions[v], eyes[list.groups[g].image], options);
                for (const Sample& s : list.of_group(g)) {
                    ++out.samples[v];
                    add_sample(uint32_t(v), corner.triangle, corner.corner, seen, s);
                }
            }
    });
    return out;
}

}  // namespace radiafit::harness
