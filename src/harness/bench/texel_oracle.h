#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bench/exact_sum.h"
#include "bench/loss_oracle.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "model/texel_local.h"
#include "model/texel_options.h"

/// Eq. 16-17 and the objective of single texels in double, sample by sample. `Text`: a model's text with real = double.
namespace radiafit::harness {

/// What a sample says, in double.
template <class Text>
struct ExactSample {
    typename Text::Terms terms;
    std::array<double, 3> target;
    double cosine;  ///< u_z
    double facing;  ///< v_z
    bool above;     ///< lamp and camera are above the surface: else it doesn't count

    /// value [3]: linear light of the pixel that the texel takes.
    template <class Value>
    ExactSample(const View& view, const Atlas& atlas, uint32_t texel, const Value& value) {
        using real3 = typename Text::real3;
        const Vec3d x = atlas.position(texel).cast<double>();
        const Frame frame = make_frame(atlas.normal(texel));
        const auto local = [&](const Vec3d& d) {
            return real3{frame.tangent.cast<double>().dot(d), frame.bitangent.cast<double>().dot(d),
                         frame.normal.cast<double>().dot(d)};
        };
        const real3 u = local(view.light->direction_from(x)), to_camera = local(view.direction_to_camera(x));
        const Vec3d irradiance = view.light->irradiance_at(x);
        terms = Text::sample_terms(u, to_camera);
        for (size_t c = 0; c < 3; ++c) target[c] = double(value[c]) / irradiance[Eigen::Index(c)];
        cosine = u.z, facing = to_camera.z;
        above = u.z > 0 && to_camera.z > 0;
    }
};

/// Everything that an engine's passes say of one texel, over its samples' number, penalties included.
template <class Text>
struct ExactTexel {
    using Model = TexelLocal<Text>;
    ExactSum error, gauss_newton, curvature;
    std::array<ExactSum, size_t(Model::parameters)> gradient, diagonal;

    /// What a quantity can be taken for: its value, and what terms that are wrong by 5e-7 make of it. They are products
    /// of 32-bit unit vectors; grazing directions and steep lobes magnify that.
    template <class Of>
    static auto sizes(const typename Text::Terms& terms, const Of& of) {
        auto size = of(terms);
        for (double& x : size) x = std::abs(x);
        constexpr double step = 1e-6, share = 5e-7 / 1e-5;  // of the tolerance
        for (int j = 0; j < Text::term_count; ++j) {
            auto above = terms, below = terms;
            above.x[j] += step;
            below.x[j] -= step;
            const auto up = of(above), down = of(below);
            for (size_t i = 0; i < size.size(); ++i) size[i] += share * std::abs(up[i] - down[i]) / (2 * step);
        }
        return size;
    }

    ExactTexel(const std::vector<ExactSample<Text>>& samples, const TexelOptions& options,
               const typename Model::Parameters& p, const typename Model::Parameters& d) {
        constexpr int B = Model::basis, Q = Model::shape;
        const double per_sample = samples.empty() ? 0 : 1 / double(samples.size());
        for (const ExactSample<Text>& s : samples) {
            const auto columns_at = [&](const auto& terms) { return Model::columns(Model::shape_of(p), terms); };
            const auto bend_at = [&](const auto& terms) {
                const auto bend = Model::bend(p, d, terms);
                return std::array<double, 6>{bend.first[0],  bend.first[1],  bend.first[2],
                                             bend.second[0], bend.second[1], bend.second[2]};
            };
            const auto columns = columns_at(s.terms), column_size = sizes(s.terms, columns_at);
            const auto bend = bend_at(s.terms), bend_size = sizes(s.terms, bend_at);
            const auto value = Model::value(p, s.terms);
            std::array<double, 3> residual, residual_size;
            double squared = 0, squared_size = 0;
            for (size_t c = 0; c < 3; ++c) {
                residual[c] = value[c] - s.target[c];
                residual_size[c] = s.target[c];
                for (size_t k = 0; k < size_t(B); ++k) residual_size[c] += std::abs(p[3 * k + c]) * column_size[k];
                squared += residual[c] * residual[c], squared_size += residual_size[c] * residual_size[c];
            }
            const double weight = options.loss.weights == SampleWeights::facing ? s.facing : 1;
            // a weight that is wrong by 5e-7
            const double sure = 1 + (options.loss.weighted() ? 0.05 / weight : 0);
            const LossOracle loss(options.loss, std::sqrt(weight * squared), std::sqrt(weight * squared_size));
            const double each = per_sample * weight * loss.weight, uncertain = each * (sure + loss.sensitivity);
            error.add(per_sample * loss.value, 0.5 * squared_size * uncertain);
            for (size_t c = 0; c < 3; ++c) {
                const double r = residual[c], size = residual_size[c];
                double first_size = bend_size[c];
                for (size_t k = 0; k < size_t(B); ++k) first_size += std::abs(d[3 * k + c]) * column_size[k];
                const double first = bend[c], second = bend[3 + c], second_size = bend_size[3 + c];
                gauss_newton.add(each * first * first, uncertain * first_size * first_size);
                curvature.add(each * (first * first + r * second),
                              uncertain * (first_size * first_size + size * second_size));
                for (size_t k = 0; k < size_t(B); ++k) {
                    gradient[3 * k + c].add(each * r * columns[k], uncertain * size * column_size[k]);
                    diagonal[3 * k + c].add(each * columns[k] * columns[k],
                                            uncertain * column_size[k] * column_size[k]);
                }
                for (size_t i = 0; i < size_t(Q); ++i) {
                    double column = 0, of_size = 0;
                    for (size_t slope = i; slope < size_t(Model::slopes); slope += size_t(Q)) {
                        const double lobe = p[3 * size_t(Model::slope_basis(int(slope))) + c];
                        column += lobe * columns[size_t(B) + slope];
                        of_size += std::abs(lobe) * column_size[size_t(B) + slope];
                    }
                    gradient[3 * size_t(B) + i].add(each * r * column, uncertain * size * of_size);
                    diagonal[3 * size_t(B) + i].add(each * column * column, uncertain * of_size * of_size);
                }
            }
        }
        for (size_t i = 0; i < p.size(); ++i) {
            const double a = Model::bounds(int(i))[0], b = Model::bounds(int(i))[1], mu = double(options.mu);
            if (p[i] >= a && p[i] <= b) continue;
            const double beyond = p[i] < a ? p[i] - a : p[i] - b;
            const bool paper = options.mode == Mode::paper;
            error.add(mu * (paper ? (p[i] - a) * (p[i] - b) : 0.5 * beyond * beyond));
            gradient[i].add(mu * (paper ? 2 * p[i] - a - b : beyond));
            const double second = mu * (paper ? 2 : 1) * d[i] * d[i];
            gauss_newton.add(second);
            curvature.add(second);
        }
        for (size_t i = 0; i < p.size(); ++i)
            if (Model::held(int(i))) gradient[i] = {};  // no magnitude either: it is 0 exactly
        double largest = 0, largest_size = 0;
        for (const ExactSum& sum : diagonal) {
            largest = std::max(largest, sum.value);
            largest_size = std::max(largest_size, sum.magnitude);
        }
        for (ExactSum& sum : diagonal) {
            sum.value = std::max(sum.value, 1e-4 * largest + 1e-30);
            sum.magnitude = std::max({sum.magnitude, sum.value, 1e-4 * largest_size});
        }
    }
};

}  // namespace radiafit::harness
