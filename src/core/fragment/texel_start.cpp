#include "fragment/texel_start.h"

#include <algorithm>

#include "base/parallel.h"

namespace radiafit {
namespace {

constexpr int most_shape_uniforms = 10;  // that start.frag has room for

}  // namespace

StartLayout::StartLayout(const TexelModel& model) {
    const int starts = std::max<int>(1, int(model.starts.size()));
    const auto numbers_of = [](int functions) { return functions * (functions + 1) / 2 + 3 * functions; };
    shared = numbers_of(model.basis - std::max(model.shaped, 1));
    of_candidate = numbers_of(model.basis) - shared;
    candidates = std::clamp((4 * most_targets - shared) / of_candidate, 1, starts);
    if (model.shape > 0) candidates = std::clamp(most_shape_uniforms / ((model.shape + 2) / 3), 1, candidates);
    groups = (starts + candidates - 1) / candidates;
    numbers = shared + candidates * of_candidate;
}

StartSolver::StartSolver(const TexelModel& model, size_t texels)
    : model_(&model),
      layout_(model),
      parameters_(texels * size_t(model.parameters)),
      lowest_(texels, std::numeric_limits<double>::infinity()) {
    std::vector<float> unseen;  // what a texel without samples has
    for (size_t i = 0; i < size_t(3 * model.basis); ++i)
        unseen.push_back(float(std::clamp(0.0, model.bounds[i][0], model.bounds[i][1])));
    for (size_t j = 0; j < size_t(model.shape); ++j) unseen.push_back(float(model.starts[0][j]));
    for (size_t texel = 0; texel < texels; ++texel) std::ranges::copy(unseen, &parameters_[texel * unseen.size()]);
}

void StartSolver::take(int group, std::span<const float> numbers) {
    const int starts = int(model_->starts.size()), first = group * layout_.candidates;
    const int count = std::min(layout_.candidates, std::max(1, starts) - first);
    const size_t stride = 4 * size_t(layout_.targets()), each = size_t(model_->parameters);
    const size_t of_candidate = size_t(layout_.of_candidate), shared = size_t(layout_.shared);
    parallel_for(lowest_.size(), 256, [&](size_t texel, int) {
        const std::span<const float> of_texel = numbers.subspan(texel * stride, stride);
        std::vector<float> sums(of_texel.begin(), of_texel.begin() + std::ptrdiff_t(shared + of_candidate));
        std::vector<float> coefficients(3 * size_t(model_->basis));
        for (int i = 0; i < count; ++i) {
            std::ranges::copy(of_texel.subspan(shared + size_t(i) * of_candidate, of_candidate),
                              sums.begin() + std::ptrdiff_t(shared));
            const double change = model_->coefficients_of(sums, coefficients);
            if (!(change < lowest_[texel])) continue;
            lowest_[texel] = change;
            float* p = parameters_.data() + texel * each;
            std::ranges::copy(coefficients, p);
            for (size_t j = 0; j < size_t(model_->shape); ++j)
                p[coefficients.size() + j] = float(model_->starts[size_t(first + i)][j]);
        }
    });
}

}  // namespace radiafit
