#include "cpu/surface_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/statistics.h"
#include "samples/picked_texels.h"

namespace radiafit {
namespace {

constexpr size_t texels_per_block = 128;
constexpr size_t least_known = 16;          ///< well-determined texels that the medians of a block need at least
constexpr size_t values_per_parameter = 2;  ///< of its samples, that a well-determined texel has at least
// A quantile of distances over that of a normal distribution's: parameters have heavy tails, which the median would not
// see.
constexpr double quantile_of_scatter = 0.9, normal_quantile = 1.6449;

class Learner {
public:
    Learner(const TexelModel& model, const Atlas& atlas, const TexelResult& fit)
        : model_(model), atlas_(atlas), fit_(fit), n_(size_t(model.parameters)) {
        for (uint32_t t = 0; t < atlas.texel_count(); ++t)
            if (atlas.usable(t)) usable_.push_back(t);
        prior_.block_of.resize(atlas.texel_count());
        prior_.parameters = n_;
    }

    std::optional<SurfacePrior> run() {
        std::vector<double> variances;
        size_t known = 0;
        for (const uint32_t t : usable_) {
            if (!well_determined(t)) continue;
            ++known;
            variances.push_back(2 * double(fit_.error[t]) / (3 * double(fit_.samples[t]) - double(n_)));
        }
        if (known < least_known) return std::nullopt;
        divide(usable_, medians_of(usable_, std::vector<float>(n_)));
        const double noise = median(std::move(variances));
        const size_t basis = size_t(model_.basis);
        for (size_t column = 0; column < basis + size_t(model_.shape); ++column) {
            const double deviation = column < basis ? scatter(3 * column, 3) : scatter(2 * basis + column, 1);
            prior_.weights.push_back(noise / (deviation * deviation));
        }
        return std::move(prior_);
    }

private:
    float parameter(uint32_t texel, size_t i) const { return fit_.parameters[texel * n_ + i]; }
    bool well_determined(uint32_t t) const {
        const Status status = fit_.status[t];
        return (status == Status::stationary || status == Status::max_iterations) &&
               3 * size_t(fit_.samples[t]) >= values_per_parameter * n_;
    }
    /// A lobe's shape means nothing where it has no height.
    double height(uint32_t t) const {
        double sum = 0;
        for (size_t i = 3 * size_t(model_.basis - std::max(model_.shaped, 1)); !of_shape(i); ++i)
            sum += double(parameter(t, i));
        return sum;
    }
    bool of_shape(size_t i) const { return i >= 3 * size_t(model_.basis); }
    /// The well-determined texels, to take medians of; for shapes, the half of them with the highest lobes.
    std::vector<uint32_t> telling(std::span<const uint32_t> texels, bool shape) const {
        std::vector<uint32_t> out;
        for (const uint32_t t : texels)
            if (well_determined(t)) out.push_back(t);
        if (!shape) return out;
        std::ranges::nth_element(out, out.begin() + std::ptrdiff_t(out.size() / 2), std::ranges::greater(),
                                 [&](uint32_t t) { return height(t); });
        out.resize(out.size() / 2);
        return out;
    }
    std::vector<float> medians_of(std::span<const uint32_t> texels, std::vector<float> otherwise) const {
        const std::array told = {telling(texels, false), telling(texels, true)};
        for (size_t i = 0; i < n_; ++i) {
            std::vector<double> values;
            for (const uint32_t t : told[of_shape(i)]) values.push_back(double(parameter(t, i)));
            if (values.size() >= least_known) otherwise[i] = float(median(std::move(values)));
        }
        model_.make_canonical(otherwise);
        return otherwise;
    }
    /// Halves the texels along their longest side until blocks are small. means: medians of these texels.
    void divide(std::span<uint32_t> texels, const std::vector<float>& means) {
        if (texels.size() <= texels_per_block) {
            const size_t block = prior_.means.size() / n_;
            for (const uint32_t t : texels) prior_.block_of[t] = uint32_t(block);
            prior_.means.insert(prior_.means.end(), means.begin(), means.end());
            return;
        }
        Vec3f low = Vec3f::Constant(1e30f), high = -low;
        for (const uint32_t t : texels) {
            low = low.cwiseMin(atlas_.position(t));
            high = high.cwiseMax(atlas_.position(t));
        }
        Eigen::Index axis = 0;
        (high - low).maxCoeff(&axis);
        const size_t half = texels.size() / 2;
        std::ranges::nth_element(texels, texels.begin() + std::ptrdiff_t(half), {},
                                 [&](uint32_t t) { return std::pair(atlas_.position(t)[axis], t); });
        for (const auto part : {texels.first(half), texels.subspan(half)}) divide(part, medians_of(part, means));
    }
    /// Standard deviation of `count` parameters from `first` on about their blocks' means.
    double scatter(size_t first, size_t count) const {
        std::vector<double> off;
        const std::vector<uint32_t> told = telling(usable_, of_shape(first));
        for (size_t i = first; i < first + count; ++i)
            for (const uint32_t t : told)
                if (!model_.held(int(i)))
                    off.push_back(std::abs(double(parameter(t, i)) - double(prior_.mean_of(t)[i])));
        constexpr double least = 0.05;  // also where a gauge holds most texels at one value
        return off.empty() ? 1 : std::max(least, quantile(std::move(off), quantile_of_scatter) / normal_quantile);
    }

    const TexelModel& model_;
    const Atlas& atlas_;
    const TexelResult& fit_;
    size_t n_;
    std::vector<uint32_t> usable_;
    SurfacePrior prior_;
};

}  // namespace

std::optional<SurfacePrior> learn_surface_prior(const TexelModel& model, const Atlas& atlas, const TexelResult& fit) {
    return Learner(model, atlas, fit).run();
}

SurfacePrior SurfacePrior::of(std::span<const uint32_t> texels) const {
    SurfacePrior out{parameters, means, {}, weights};
    for (const uint32_t t : texels) out.block_of.push_back(block_of[t]);
    return out;
}

bool poorly_seen(const TexelModel& model, Status status, uint32_t samples) {
    return status == Status::underdetermined || samples < enough_samples * uint32_t(model.independent);
}

std::vector<uint32_t> poorly_seen(const TexelModel& model, const TexelResult& fit) {
    std::vector<uint32_t> out;
    for (uint32_t t = 0; t < fit.status.size(); ++t)
        if (poorly_seen(model, fit.status[t], fit.samples[t])) out.push_back(t);
    return out;
}

void fit_with_prior(const SurfacePrior& prior, const TexelProblem& problem, const std::vector<uint32_t>& texels,
                    const TexelFitOptions& options, TexelResult& fit) {
    const TexelModel& model = *problem.options.model;
    const size_t n = size_t(model.parameters);
    const SurfacePrior known = prior.of(texels);
    const TexelLoader loader = problem.loader.of(texels);
    const TexelResult anew =
        texel_solvers(model).solve_lm({problem.source, loader, problem.options}, options, {}, &known);
    for (size_t i = 0; i < texels.size(); ++i) {
        const size_t t = texels[i];
        std::copy_n(&anew.parameters[i * n], n, &fit.parameters[t * n]);
        fit.error[t] = anew.error[i];
        fit.iterations[t] += anew.iterations[i];
        if (fit.status[t] != Status::underdetermined) fit.status[t] = anew.status[i];
    }
    fit.load_s += anew.load_s;
    fit.sample_iterations += anew.sample_iterations;
}

TexelResult solve_lm_with_surface(const TexelProblem& problem, const Atlas& atlas, const TexelFitOptions& fit,
                                  const std::function<void()>& progress) {
    const TexelModel& model = *problem.options.model;
    TexelResult out = texel_solvers(model).solve_lm(problem, fit, progress);
    const auto prior = learn_surface_prior(model, atlas, out);
    if (!prior) return out;
    const std::vector<uint32_t> texels = poorly_seen(model, out);
    const PickedTexels samples(problem.source, texels);
    fit_with_prior(*prior, {samples, problem.loader, problem.options}, texels, fit, out);
    return out;
}

}  // namespace radiafit
