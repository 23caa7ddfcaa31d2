#pragma once
#include <cmath>
#include <vector>

#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "loss_oracle.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

/// Eq. 14-15 written down naively in double, sample by sample, with no code in common with the engines but the view
/// footprint. Penalties are left out and nothing is normalized. Beside each sum stands the sum of its terms'
/// magnitudes, the sums inside a term (residual, view look-up) opened too: what a rounding error may be measured
/// against.
namespace radiafit::testing {

struct Sum {
    double value = 0, magnitude = 0;
    Sum& operator+=(const Sum& term) {
        value += term.value, magnitude += term.magnitude;
        return *this;
    }
    friend Sum operator*(const Sum& a, const Sum& b) { return {a.value * b.value, a.magnitude * b.magnitude}; }
};
inline Sum term(double value) { return {value, std::abs(value)}; }

struct LfmOracle {
    std::vector<Sum> error;                                   ///< [vertices * 3] E = 1/2 sum r^2
    std::vector<Sum> gradient;                                ///< [layout.size()]
    std::vector<Sum> diagonal;                                ///< [layout.size()] diag(J'J)
    std::vector<Sum> gauss_newton, curvature, third, fourth;  ///< [vertices * 3]
    std::vector<uint32_t> samples;                            ///< [vertices]
};

/// p, d in layout order; d may be empty.
inline LfmOracle lfm_oracle(const Dataset& dataset, const TriangleAtlas& atlas, const LfmLayout& layout,
                            const LfmOptions& options, const SampleList& list, const std::vector<double>& p,
                            const std::vector<double>& d) {
    LfmOracle out;
    const size_t problems = 3 * layout.problem_count();
    for (auto* sums : {&out.error, &out.gauss_newton, &out.curvature, &out.third, &out.fourth}) sums->resize(problems);
    out.gradient.resize(layout.size());
    out.diagonal.resize(layout.size());
    out.samples.resize(layout.problem_count());
    const auto frames = vertex_frames(dataset.mesh);
    const int m = options.view_side;
    for (size_t tile = 0; tile < list.tile_count(); ++tile)
        for (uint32_t group = list.tile_groups[tile]; group < list.tile_groups[tile + 1]; ++group)
            for (const Sample& s : list.of_group(group))
                for (int corner = 0; corner < 3; ++corner) {
                    const uint32_t v = dataset.mesh.triangles[tile][corner];
                    ++out.samples[v];
                    const Camera& camera = dataset.views[list.views[list.groups[group].image]].camera;
                    ViewFootprint f =
                        view_footprint(frames[v], dataset.mesh.positions[v], camera.center(), m, options.lookup);
                    const int texel[4] = {f.texel, f.texel + 1, f.texel + m, f.texel + m + 1};
                    double lambda = double(atlas.tile(uint32_t(tile)).barycentric(s.local)[size_t(corner)]);
                    if (options.loss.weights == SampleWeights::facing) {
                        const Vec3d to_camera = camera.center() - dataset.mesh.positions[v].cast<double>();
                        const double along = to_camera.dot(frames[v].normal.cast<double>());
                        const double root = along > 0 ? std::sqrt(along / to_camera.norm()) : 0;
                        for (float& w : f.weight) w = float(w * root);
                        lambda *= root;
                    }
                    for (int c = 0; c < 3; ++c) {
                        const auto surface = [&](int k) {
                            return layout.map_offset(uint32_t(tile), corner) + s.local * layout.stride() + 4 * k + c;
                        };
                        const auto view = [&](int k, int j) {
                            return layout.view_offset(v) + texel[j] * layout.stride() + 4 * k + c;
                        };
                        Sum r = term(-lambda * s.rgb[c] * double(list.scale)), a, b;
                        for (int k = 0; k < options.terms; ++k) {
                            Sum h, dh;
                            for (int j = 0; j < 4; ++j) {
                                h += term(f.weight[j] * p[view(k, j)]);
                                if (!d.empty()) dh += term(f.weight[j] * d[view(k, j)]);
                            }
                            r += term(p[surface(k)]) * h;
                            if (d.empty()) continue;
                            a += term(d[surface(k)]) * h;
                            a += term(p[surface(k)]) * dh;
                            b += term(d[surface(k)]) * dh;
                        }
                        const LossOracle loss(options.loss, r.value, r.magnitude);
                        const Sum weight{loss.weight, loss.weight * (1 + loss.sensitivity)};
                        for (int k = 0; k < options.terms; ++k) {
                            Sum h;
                            for (int j = 0; j < 4; ++j) {
                                h += term(f.weight[j] * p[view(k, j)]);
                                const Sum by_view = term(f.weight[j] * p[surface(k)]);
                                out.gradient[view(k, j)] += weight * r * by_view;
                                out.diagonal[view(k, j)] += weight * by_view * by_view;
                            }
                            out.gradient[surface(k)] += weight * r * h;
                            out.diagonal[surface(k)] += weight * h * h;
                        }
                        const size_t i = 3 * v + c;
                        out.error[i] += {loss.value, weight.magnitude * r.magnitude * r.magnitude / 2};
                        out.gauss_newton[i] += weight * a * a;
                        out.curvature[i] += weight * a * a;
                        out.curvature[i] += weight * term(2) * r * b;
                        out.third[i] += weight * a * b;
                        out.fourth[i] += weight * b * b;
                    }
                }
    return out;
}

}  // namespace radiafit::testing
