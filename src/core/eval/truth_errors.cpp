#include "eval/truth_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/statistics.h"

namespace radiafit {
TruthComparison::TruthComparison(const TexelModel& model, const TruthMaterial& material)
    : possible_(material.model == model.name) {
    for (int i = 0; possible_ && i < model.parameters; ++i) {
        const std::string name = model.parameter_name(i);
        const bool logarithm = name.starts_with("log_");
        const auto& known = material.parameters;
        const auto at = std::find(known.begin(), known.end(), logarithm ? name.substr(4) : name);
        possible_ = at != known.end();
        if (possible_) parameters_.push_back({*at, logarithm, size_t(at - known.begin())});
    }
}

double TruthComparison::error(size_t i, std::span<const float> p, const std::array<float, 9>& truth) const {
    const auto& [name, logarithm, at] = parameters_[i];
    const double found = logarithm ? std::exp(double(p[i])) : double(p[i]), expected = double(truth[at]);
    return std::abs(found - expected) / std::max(std::abs(expected), 1e-6);
}

double TruthComparison::truth_of(size_t i, const std::array<float, 9>& truth) const {
    const double value = double(truth[parameters_[i].at]);
    return parameters_[i].logarithm ? std::log(value) : value;
}

double TruthComparison::worst(std::span<const float> p, const std::array<float, 9>& truth) const {
    double worst = possible_ ? 0 : NAN;
    for (size_t i = 0; i < parameters_.size(); ++i) worst = std::max(worst, error(i, p, truth));
    return worst;
}

TruthShare MaterialErrors::within_all() const {
    TruthShare sum;
    for (const TruthShare& share : within) sum.add(share);
    return sum;
}

std::vector<MaterialErrors> truth_errors(const ReflectanceFit& fit, const ReflectanceTruth& truth,
                                         std::span<const float> deviations) {
    const TexelModel& model = *fit.options.model;
    const size_t n = size_t(model.parameters);
    if (truth.material.size() != fit.samples.size())
        throw UserError(fmt::format("{}: the truth has {} texels where the dataset has {}; generate it anew",
                                    fit.dataset_path.string(), truth.material.size(), fit.samples.size()));
    std::vector<MaterialErrors> out;
    for (size_t m = 0; m < truth.materials.size(); ++m) {
        const TruthMaterial& material = truth.materials[m];
        MaterialErrors errors;
        errors.name = material.name;
        const TruthComparison comparison(model, material);
        errors.comparable = comparison.possible();
        double squared = 0, samples = 0;
        std::vector<double> worst;
        std::vector<std::vector<double>> each(n);
        if (errors.comparable && !deviations.empty()) errors.within.resize(n);
        for (size_t t = 0; t < fit.samples.size(); ++t) {
            if (truth.material[t] != m || int(fit.samples[t]) < model.independent) continue;
            if (fit.status[t] == Status::not_finite) continue;
            squared += 2 * double(fit.error[t]);
            samples += 3.0 * fit.samples[t];
            ++errors.texels;
            if (!errors.comparable) continue;
            const std::span<const float> p(&fit.parameters[t * n], n);
            for (size_t i = 0; i < n; ++i) each[i].push_back(comparison.error(i, p, truth.parameters[t]));
            for (size_t i = 0; i < errors.within.size(); ++i) {
                const double deviation = double(deviations[t * n + i]);
                if (!(deviation > 0 && std::isfinite(deviation))) continue;
                const double off = std::abs(double(p[i]) - comparison.truth_of(i, truth.parameters[t]));
                errors.within[i].add({1, off <= deviation});
            }
            worst.push_back(comparison.worst(p, truth.parameters[t]));
        }
        errors.rmse = samples > 0 ? std::sqrt(squared / samples) : 0;
        if (!worst.empty()) {
            errors.worst_median = median(worst);
            errors.worst_90 = quantile(worst, 0.9);
        }
        for (size_t i = 0; errors.comparable && i < n; ++i) {
            errors.parameters.push_back(comparison.name(i));
            errors.median.push_back(each[i].empty() ? 0 : median(each[i]));
        }
        out.push_back(std::move(errors));
    }
    return out;
}

}  // namespace radiafit
