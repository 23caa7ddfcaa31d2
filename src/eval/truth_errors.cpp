#include "eval/truth_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace radiafit {
namespace {

/// Parameter i of a model as a truth may name it, and its value of the model's.
struct Named {
    std::string name;
    bool logarithm = false;
    double value(float p) const { return logarithm ? std::exp(double(p)) : double(p); }
};
Named named(const TexelModel& model, int i) {
    const std::string name = model.parameter_name(i);
    if (name.starts_with("log_")) return {name.substr(4), true};
    return {name, false};
}

double quantile(std::vector<double>& values, double q) {
    if (values.empty()) return 0;
    const auto at = values.begin() + ptrdiff_t(q * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

std::vector<MaterialErrors> truth_errors(const ReflectanceFit& fit, const ReflectanceTruth& truth) {
    const TexelModel& model = *fit.options.model;
    const size_t n = size_t(model.parameters);
    if (truth.material.size() != fit.samples.size())
        throw UserError(fmt::format("the truth has {} texels, the fit {}; generate the dataset anew",
                                    truth.material.size(), fit.samples.size()));
    std::vector<MaterialErrors> out;
    for (size_t m = 0; m < truth.materials.size(); ++m) {
        const TruthMaterial& material = truth.materials[m];
        MaterialErrors errors;
        errors.name = material.name;
        errors.comparable = material.model == model.name;
        std::vector<size_t> truth_index(n);
        for (size_t i = 0; errors.comparable && i < n; ++i) {
            const auto at =
                std::find(material.parameters.begin(), material.parameters.end(), named(model, int(i)).name);
            errors.comparable = at != material.parameters.end();
            if (errors.comparable) truth_index[i] = size_t(at - material.parameters.begin());
        }
        double squared = 0, samples = 0;
        std::vector<double> worst;
        std::vector<std::vector<double>> each(n);
        for (size_t t = 0; t < fit.samples.size(); ++t) {
            if (truth.material[t] != m || int(fit.samples[t]) < model.independent) continue;
            if (fit.status[t] == Status::not_finite) continue;
            squared += 2 * double(fit.error[t]);
            samples += 3.0 * fit.samples[t];
            ++errors.texels;
            if (!errors.comparable) continue;
            double largest = 0;
            for (size_t i = 0; i < n; ++i) {
                const double expected = double(truth.parameters[t][truth_index[i]]);
                const double error = std::abs(named(model, int(i)).value(fit.parameters[t * n + i]) - expected) /
                                     std::max(std::abs(expected), 1e-6);
                each[i].push_back(error);
                largest = std::max(largest, error);
            }
            worst.push_back(largest);
        }
        errors.rmse = samples > 0 ? std::sqrt(squared / samples) : 0;
        errors.worst_median = quantile(worst, 0.5);
        errors.worst_90 = quantile(worst, 0.9);
        for (size_t i = 0; errors.comparable && i < n; ++i) {
            errors.parameters.push_back(named(model, int(i)).name);
            errors.median.push_back(quantile(each[i], 0.5));
        }
        out.push_back(std::move(errors));
    }
    return out;
}

}  // namespace radiafit
