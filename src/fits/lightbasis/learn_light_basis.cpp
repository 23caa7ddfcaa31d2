#include "lightbasis/learn_light_basis.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include "base/parallel.h"
#include "basis/coefficient_prior.h"
#include "lightbasis/by_directions.h"
#include "lightbasis/reference_lamps.h"
#include "viewbasis/learn_view_basis.h"

namespace radiafit::fits {
namespace {

constexpr auto dynamic = Eigen::Dynamic;
using Prior = CoefficientPrior<dynamic, 1>;
using Sums = Moments<dynamic, 1>;

constexpr size_t texels_at_once = 512;  // whose sums are made together: those that are lit alike share a decomposition

/// From which directions texels are lit and seen.
struct LitFrom {
    explicit LitFrom(const std::vector<LampAndHalf>& from) : directions(from) {}
    std::vector<LampAndHalf> directions;
    Eigen::MatrixXf weights;  ///< [reference lamps][samples] of values under these, once they are known
};

struct LearnedTexel {
    std::shared_ptr<LitFrom> from;  ///< null: too few samples
    Eigen::MatrixXf values;         ///< [samples][3]
};

/// Texels that are drawn, read in one pass over the samples.
class LearnedTexels {
public:
    LearnedTexels(const Atlas& atlas, const TexelSource& source, const TexelLightReader& reader,
                  const std::vector<bool>& wanted) {
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel)
            if (wanted[texel]) place_.emplace(texel, place_.size());
        texels_.resize(place_.size());
        ByDirections<LitFrom> known;
        parallel_for(source.block_count(), 1, [&](size_t block, int) {
            const uint32_t begin = uint32_t(block) * TexelSource::block,
                           end = std::min(begin + TexelSource::block, source.texel_count());
            if (std::find(wanted.begin() + begin, wanted.begin() + end, true) == wanted.begin() + end) return;
            TexelSamples samples;
            TexelLights lights;
            source.read(begin, samples);
            for (uint32_t texel = begin; texel < end; ++texel) {
                if (!wanted[texel]) continue;
                reader.read(texel, samples.of(texel - begin), lights);
                if (lights.size() < 3) continue;
                const Eigen::Map<const Eigen::Matrix3Xf> values(lights.values.data()->data(), 3,
                                                                Eigen::Index(lights.size()));
                texels_[place_.at(texel)] = {known.of(lights.directions), values.transpose()};
            }
        });
    }
    /// Of texels that were read with half vectors, which make no difference.
    void leave_out_half() {
        ByDirections<LitFrom> known;
        for (LearnedTexel& texel : texels_) {
            if (!texel.from) continue;
            std::vector<LampAndHalf> directions = texel.from->directions;
            for (LampAndHalf& at : directions) at = {at.lamp};
            texel.from = known.of(directions);
        }
    }
    const LearnedTexel& operator[](uint32_t texel) const { return texels_[place_.at(texel)]; }

    /// Of these texels, for these reference lamps.
    void find_weights(const std::vector<uint32_t>& texels, const std::vector<LampAndHalf>& lamps,
                      const LightKernel<double>& kernel) {
        const std::unordered_set<LitFrom*> distinct = ways(texels);
        const std::vector<LitFrom*> all(distinct.begin(), distinct.end());
        const Eigen::MatrixXd weights = lamp_weights(lamps, kernel, sample_smoothing);
        parallel_for(all.size(), 1, [&](size_t i, int) {
            LitFrom& from = *all[i];
            Eigen::MatrixXd kernels(weights.rows(), Eigen::Index(from.directions.size()));
            for (Eigen::Index k = 0; k < kernels.cols(); ++k)
                for (Eigen::Index j = 0; j < kernels.rows(); ++j)
                    kernels(j, k) = kernel(lamps[size_t(j)], from.directions[size_t(k)]);
            from.weights = (weights * kernels).cast<float>();
        });
    }
    /// How many ways there are in which these texels are lit.
    size_t patterns(const std::vector<uint32_t>& texels) const { return ways(texels).size(); }

private:
    std::unordered_set<LitFrom*> ways(const std::vector<uint32_t>& texels) const {
        std::unordered_set<LitFrom*> all;
        for (const uint32_t texel : texels)
            if (const auto& from = (*this)[texel].from) all.insert(from.get());
        return all;
    }

    std::unordered_map<uint32_t, size_t> place_;  ///< in texels_
    std::vector<LearnedTexel> texels_;
};

/// At most `most` of the texels that have samples, evenly.
std::vector<LampValues> some_values(const LearnedTexels& all, const std::vector<uint32_t>& texels, size_t most) {
    std::vector<LampValues> out;
    const size_t step = std::max<size_t>(1, texels.size() / most);
    for (size_t i = 0; i < texels.size(); i += step)
        if (const LearnedTexel& texel = all[texels[i]]; texel.from)
            out.push_back({&texel.from->directions, &texel.values});
    return out;
}

/// Before anything is known: the kernel under the reference lamps, channels mostly alike, as large as values vary.
Prior vague_prior(const std::vector<LampAndHalf>& lamps, const LightKernel<double>& kernel,
                  const std::vector<LampValues>& texels) {
    constexpr double alike = 0.9;
    const auto n = Eigen::Index(lamps.size());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0, count = 0;
    for (const LampValues& texel : texels) {
        sum += texel.values->colwise().sum().transpose().cast<double>();
        squares += double(texel.values->squaredNorm());
        count += double(texel.values->rows());
    }
    const Eigen::Vector3d mean = sum / std::max(1.0, count);
    const double variance = std::max(1e-6, squares / std::max(1.0, 3 * count) - mean.squaredNorm() / 3);
    Prior prior{Eigen::VectorXd::Zero(3 * n), Eigen::MatrixXd::Zero(3 * n, 3 * n)};
    for (int c = 0; c < 3; ++c) {
        prior.mean.segment(c * n, n).setConstant(mean[c]);
        for (int d = 0; d < 3; ++d)
            for (Eigen::Index i = 0; i < n; ++i)
                for (Eigen::Index j = 0; j < n; ++j)
                    prior.covariance(c * n + i, d * n + j) =
                        (c == d ? 1 : alike) * variance *
                        (kernel(lamps[size_t(i)], lamps[size_t(j)]) / 3 + (i == j ? sample_smoothing : 0));
    }
    return prior;
}

/// Adds what texels' samples say, those that are lit from the same directions together.
void add_texels(const Expectation<dynamic, 1>& expectation, const LearnedTexels& all, std::span<const uint32_t> texels,
                Sums& sums) {
    const Prior& prior = expectation.prior();
    std::vector<std::pair<const LitFrom*, std::vector<const LearnedTexel*>>> alike;
    for (const uint32_t t : texels) {
        const LearnedTexel& texel = all[t];
        if (!texel.from) continue;
        const auto found = std::ranges::find(alike, texel.from.get(), [](const auto& a) { return a.first; });
        if (found == alike.end())
            alike.push_back({texel.from.get(), {&texel}});
        else
            found->second.push_back(&texel);
    }
    for (const auto& [from, some] : alike) {
        const Eigen::MatrixXd weights = from->weights.transpose().cast<double>();
        const Eigen::Index samples = weights.rows(), n = weights.cols(), texels_alike = Eigen::Index(some.size());
        const Eigen::MatrixXd seen = weights.transpose() * weights;
        Eigen::MatrixXd residuals(3 * samples, texels_alike);
        for (int c = 0; c < 3; ++c) {
            const Eigen::VectorXd of_mean = weights * prior.mean.segment(c * n, n);
            for (Eigen::Index i = 0; i < texels_alike; ++i)
                residuals.col(i).segment(c * samples, samples) =
                    some[size_t(i)]->values.col(c).cast<double>() - of_mean;
        }
        if (samples > n) {
            Eigen::MatrixXd seen_all = Eigen::MatrixXd::Zero(3 * n, 3 * n), right(3 * n, texels_alike);
            for (int c = 0; c < 3; ++c) {
                seen_all.block(c * n, c * n, n, n) = seen;
                right.middleRows(c * n, n).noalias() = weights.transpose() * residuals.middleRows(c * samples, samples);
            }
            expectation.add_by_coefficients(seen_all, right, sums);
        } else {
            Eigen::MatrixXd by_prior(3 * samples, 3 * n), covariance(3 * samples, 3 * samples);
            for (int c = 0; c < 3; ++c) {
                by_prior.middleRows(c * samples, samples).noalias() = weights * prior.covariance.middleRows(c * n, n);
                sums.seen.block(c * n, c * n, n, n) += double(texels_alike) * seen;
            }
            for (int c = 0; c < 3; ++c)
                covariance.middleCols(c * samples, samples).noalias() =
                    by_prior.middleCols(c * n, n) * weights.transpose();
            expectation.add_by_samples(by_prior, covariance, residuals, sums);
        }
        sums.weight += double(from->directions.size() * some.size());
    }
}

BasisTexels drawn_texels(const Dataset& dataset, const Atlas& atlas, const LightBasisOptions& options) {
    const SurfaceExtent extent = dataset.has_grid() ? extent_of(dataset.grid) : extent_of(dataset.mesh);
    return draw_basis_texels(atlas, extent, size_t(options.texels), options.blocks, size_t(options.block_texels));
}

/// Every so many-th texel, where they are lit in more ways than so many, so that few are cheaper for their neighbours.
void thin(std::vector<uint32_t>& texels, size_t patterns, size_t most) {
    const size_t step = (patterns + most - 1) / std::max<size_t>(1, most);
    size_t kept = 0;
    for (size_t i = 0; step > 1 && i < texels.size(); i += step) texels[kept++] = texels[i];
    if (step > 1) texels.resize(kept);
}

/// What learning goes by, after thinning: of the whole surface and of its blocks each about so many ways to be lit.
std::vector<uint32_t> thinned(BasisTexels& drawn, const LearnedTexels& texels, size_t most) {
    constexpr size_t least_of_block = 60;
    thin(drawn.everywhere, texels.patterns(drawn.everywhere), most);
    std::vector<uint32_t> all = drawn.everywhere;
    for (auto& block : drawn.of_block) {
        thin(block, texels.patterns(block), std::max(least_of_block, most / drawn.of_block.size()));
        all.insert(all.end(), block.begin(), block.end());
    }
    return all;
}

}  // namespace

void check_options(const LightBasisOptions& o) {
    radiafit::require("numbers", o.rank, limits::light_rank);
    radiafit::require("noise", o.noise, limits::noise_variance);
    radiafit::require("blocks", o.blocks, limits::blocks);
}

int light_blocks(const Atlas& atlas) {
    constexpr uint32_t texels_each = 6000;
    return std::clamp(int(atlas.texel_count() / texels_each), 1, 400);
}

std::vector<bool> learned_from(const Dataset& dataset, const Atlas& atlas, const LightBasisOptions& options) {
    check_options(options);
    return drawn_texels(dataset, atlas, options).mask(atlas);
}

LightBasis learn_light_basis(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                             const TexelSource& source, const LightBasisOptions& options,
                             const LightUnderneath& underneath, Journal* journal) {
    check_options(options);
    BasisTexels drawn = drawn_texels(dataset, atlas, options);
    LightBasis basis{drawn.blocks};
    basis.noise = float(options.noise);
    basis.curve = options.curve;
    set_frame_and_white(dataset, views, basis);
    const bool with_half = cameras_move(dataset, views);
    basis.half_length = with_half ? 1.0f : 0.0f;  // until more is known
    const TexelLightReader reader(dataset, atlas, views, basis, underneath);
    LearnedTexels texels(atlas, source, reader, drawn.mask(atlas));
    constexpr size_t most_ways = 2000, most_ways_with_half = 1000;  // these have more reference lamps, and cost more
    std::vector<uint32_t> used = thinned(drawn, texels, most_ways);
    constexpr size_t for_kernel = 500, for_kernel_alone = 60;  // where each needs a decomposition of its own
    const auto some_texels = [&] {
        return some_values(texels, drawn.everywhere,
                           texels.patterns(drawn.everywhere) > for_kernel ? for_kernel_alone : for_kernel);
    };
    const ChosenKernel kernel = choose_kernel(some_texels(), with_half);
    basis.length = float(kernel.length);
    basis.half_length = float(kernel.half_length);
    basis.half_share = float(kernel.half_share);
    if (with_half && !basis.by_half()) texels.leave_out_half();
    if (basis.by_half()) used = thinned(drawn, texels, most_ways_with_half);
    basis.smoothing = float(kernel.smoothing);
    const std::vector<LampValues> some = some_texels();
    basis.lamps = reference_lamps(dataset, views, basis, kernel, some);
    basis.rank = options.rank;
    basis.numbers.resize(basis.cubes.size() * basis.block_size());
    texels.find_weights(used, basis.lamps, kernel);
    const auto numbers = [&](size_t block) {
        return std::span(basis.numbers).subspan(block * basis.block_size(), basis.block_size());
    };
    const auto rows = Eigen::Index(basis.rows());
    learn_blocks(
        drawn, vague_prior(basis.lamps, kernel, some), options.rounds, journal,
        [&](const Prior& prior, const std::vector<uint32_t>& of) {
            Expectation<dynamic, 1> expectation(prior, options.noise);
            expectation.find_precision();
            return summed<dynamic, 1>(of, texels_at_once, rows, [&](std::span<const uint32_t> part, Sums& sums) {
                add_texels(expectation, texels, part, sums);
            });
        },
        [&](auto& visit, size_t block) { visit(numbers(block)); },
        [&](size_t block, const Prior& prior, const Sums& sums) {
            auto out = LightBasis::Block::Map(numbers(block).data(), rows, 1 + basis.rank);
            out.setZero();  // functions beyond as many as there are
            const int functions = std::min(basis.rank, int(rows));
            out.col(0) = prior.mean.cast<float>();
            out.middleCols(1, functions) = functions_of_most_variance(prior, sums, functions).cast<float>();
        });
    return basis;
}

}  // namespace radiafit::fits
