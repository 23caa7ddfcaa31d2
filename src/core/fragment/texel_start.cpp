#include "fragment/texel_start.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "model/small_solve.h"
#include "model/texel_local.h"
#include "model/texel_texts.h"

namespace radiafit {
namespace {

// Uniforms that start.frag has room for.
constexpr int most_shape_uniforms = 10;
// Pivots below this part of their diagonal entry are zero but for the rounding of sums of floats.
constexpr double noise = 1e-6;

template <int basis>
struct Fit {
    std::array<std::array<double, size_t(basis)>, 3> a;  ///< [channel]
    double change = 0;                                   ///< of the error, from all coefficients 0
};

// One candidate's least squares. numbers: those of its group.
template <int basis>
Fit<basis> solve(const float* numbers, int candidate, const double (&bounds)[basis][2]) {
    SmallMatrix<double, basis> normal{};
    SmallVector<double, basis> slope[3];
    const float* at = numbers;
    for (size_t k = 0; k < size_t(basis); ++k) {
        if (k + 1 == size_t(basis)) at += candidate * (basis + 3);
        for (size_t j = 0; j <= k; ++j) normal[k][j] = double(*at++);
        for (auto& channel : slope) channel[k] = -double(*at++);
    }
    const bool bounded = are_meant({bounds[basis - 1][0], bounds[basis - 1][1]});
    // a plain linear fit has no bounds that would keep coefficients small where samples don't determine each of them
    const SmallFactor<double, basis> factor(normal, bounded ? noise : 10 * noise,
                                            bounded ? SmallPivots::raised : SmallPivots::left_out);
    Fit<basis> fit{};
    for (size_t c = 0; c < 3; ++c) {
        const auto best = bounded_step<double, basis>(normal, factor, slope[c], {}, bounds);
        fit.a[c] = best.step;
        fit.change += best.change;
    }
    return fit;
}

template <class Text>
void take_group(const StartLayout& layout, const TexelModel& model, int group, std::span<const float> numbers,
                std::vector<float>& parameters, std::vector<double>& lowest) {
    constexpr int basis = Text::basis_count;
    const int starts = int(model.starts.size()), first = group * layout.candidates;
    const int count = std::min(layout.candidates, std::max(1, starts) - first);
    const size_t stride = 4 * size_t(layout.targets()), each = size_t(model.parameters);
    parallel_for(lowest.size(), 256, [&](size_t texel, int) {
        for (int i = 0; i < count; ++i) {
            const auto fit = solve<basis>(numbers.data() + texel * stride, i, Text::coefficient_bounds);
            if (!(fit.change < lowest[texel])) continue;
            lowest[texel] = fit.change;
            float* p = parameters.data() + texel * each;
            for (size_t k = 0; k < size_t(basis); ++k)
                for (size_t c = 0; c < 3; ++c) p[3 * k + c] = float(fit.a[c][k]);
            for (size_t j = 0; j < size_t(model.shape); ++j)
                p[3 * size_t(basis) + j] = float(model.starts[size_t(first + i)][j]);
        }
    });
}

}  // namespace

StartLayout::StartLayout(const TexelModel& model) {
    const int plain = model.basis - 1, starts = std::max<int>(1, int(model.starts.size()));
    const int shared = plain * (plain + 1) / 2 + 3 * plain, of_candidate = model.basis + 3;
    candidates = std::clamp((4 * most_targets - shared) / of_candidate, 1, starts);
    if (model.shape > 0) candidates = std::clamp(most_shape_uniforms / ((model.shape + 2) / 3), 1, candidates);
    groups = (starts + candidates - 1) / candidates;
    numbers = shared + candidates * of_candidate;
}

StartSolver::StartSolver(const TexelModel& model, size_t texels)
    : model_(&model), layout_(model), parameters_(texels * size_t(model.parameters)), lowest_(texels) {
    for (size_t texel = 0; texel < texels && model.shape > 0; ++texel)
        for (size_t j = 0; j < size_t(model.shape); ++j)
            parameters_[texel * size_t(model.parameters) + 3 * size_t(model.basis) + j] = float(model.starts[0][j]);
}

void StartSolver::take(int group, std::span<const float> numbers) {
#define TAKE(NAME)                          \
    if (std::string(#NAME) == model_->name) \
        return take_group<texel_text::NAME<double>>(layout_, *model_, group, numbers, parameters_, lowest_);
    RADIAFIT_TEXEL_MODELS(TAKE)
#undef TAKE
    throw SystemError(std::string(model_->name) + ": a model that the registry doesn't have");
}

}  // namespace radiafit
