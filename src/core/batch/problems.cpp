#include "batch/problems.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>

#include "base/choose.h"
#include "base/error.h"
#include "base/journal.h"
#include "base/log.h"
#include "base/parallel.h"

namespace radiafit::batch {
namespace {

constexpr size_t problems_at_once = 1024;
constexpr size_t alignment = 64;

void require_size(const char* what, size_t found, size_t needed, const std::string& form) {
    if (found != needed) throw UserError(fmt::format("{}: {} numbers, where {} makes {}", what, found, form, needed));
}

}  // namespace

void check_offsets(std::span<const int64_t> offsets, const std::string& name) {
    if (offsets[0] != 0) throw UserError(fmt::format("{}: begin with {}; the first is 0", name, offsets[0]));
    for (size_t i = 1; i < offsets.size(); ++i)
        if (offsets[i] < offsets[i - 1])
            throw UserError(
                fmt::format("{}: number {} is {}, less than the one before it; they never fall", name, i, offsets[i]));
}

template <class real>
void check_weights(std::span<const real> weights, const std::string& name) {
    for (const real w : weights)
        if (w < 0 || std::isinf(w))
            throw UserError(fmt::format("{}: {} is {}; a weight is 1 / variance, and 0 leaves out", name, w,
                                        w < 0 ? "below 0" : "not finite"));
}

void check_options(const ModelText& model, const Options& o) {
    const size_t P = model.parameters.size();
    for (const auto* bounds : {&o.lower, &o.upper})
        if (!bounds->empty()) require_size("bounds", bounds->size(), P, fmt::format("{} parameters", P));
    if (!o.fixed.empty()) require_size("fixed", o.fixed.size(), P, fmt::format("{} parameters", P));
    for (size_t i = 0; i < P; ++i) {
        const double low = o.lower.empty() ? -INFINITY : o.lower[i], high = o.upper.empty() ? INFINITY : o.upper[i];
        if (!(low <= high))
            throw UserError(fmt::format("bounds of {}: from {} to {}; the lower one is no more than the upper one",
                                        model.parameters[i], low, high));
    }
    if (o.iterations.value_or(0) < 0) throw UserError(fmt::format("iterations = {}: choose 0 or more", *o.iterations));
    if (!(o.learning_rate > 0 && std::isfinite(o.learning_rate)))
        throw UserError(fmt::format("learning-rate = {}: choose a number above 0", o.learning_rate));
    if (!(o.tolerance >= 0)) throw UserError(fmt::format("tolerance = {}: choose 0 or more", o.tolerance));
    if (!(o.loss_scale > 0)) throw UserError(fmt::format("loss-scale = {}: choose a number above 0", o.loss_scale));
}

template <class real>
void check_problems(const ModelText& model, const Problems<real>& p, const Options& o) {
    const size_t P = model.parameters.size(), T = model.terms.size(), Y = model.values.size();
    if (!p.offsets.empty()) {
        require_size("offsets", p.offsets.size(), p.count + 1, fmt::format("{} problems + 1", p.count));
        check_offsets(p.offsets, "offsets");
    }
    const size_t all = p.all_samples();
    require_size("targets", p.targets.size(), all * Y, fmt::format("{} samples of {} values", all, Y));
    const bool shared = p.offsets.empty() && p.terms.size() == p.samples * T;
    if (!shared) require_size("terms", p.terms.size(), all * T, fmt::format("{} samples of {} terms", all, T));
    if (!p.weights.empty()) require_size("weights", p.weights.size(), all, fmt::format("{} samples", all));
    check_weights(p.weights, "weights");
    if (p.start_count == 0) throw UserError("starts: there are none");
    if (p.starts.size() != p.start_count * P)
        require_size("starts", p.starts.size(), p.start_count * p.count * P,
                     fmt::format("{} of {} problems and {} parameters", p.start_count, p.count, P));
    for (size_t i = 0; i < p.starts.size(); ++i)
        if (!std::isfinite(p.starts[i]))
            throw UserError(fmt::format("starts: {} of problem {} is no finite number", model.parameters[i % P],
                                        p.first + i / P % std::max<size_t>(1, p.count)));
    check_options(model, o);
}

template <class real>
size_t Problems<real>::most_samples() const {
    if (offsets.empty()) return samples;
    int64_t most = 0;
    for (size_t i = 0; i + 1 < offsets.size(); ++i) most = std::max(most, offsets[i + 1] - offsets[i]);
    return size_t(most);
}

template <class real>
std::vector<size_t> Solution<real>::counts() const {
    std::vector<size_t> out(size_t(BatchStatus::count));
    for (const int32_t s : status) ++out[size_t(s)];
    return out;
}

namespace {
size_t place_of(const ModelText& model, const std::string& what, const std::string& name) {
    const auto found = std::ranges::find(model.parameters, name);
    if (found == model.parameters.end()) reject_name(what, name, model.parameters);
    return size_t(found - model.parameters.begin());
}
}  // namespace

std::vector<double> of_parameters(const ModelText& model, const std::string& what, const ByName& named,
                                  double without) {
    std::vector<double> out(model.parameters.size(), without);
    for (const auto& [name, value] : named) out[place_of(model, what, name)] = value;
    return out;
}

std::vector<bool> among_parameters(const ModelText& model, const std::string& what,
                                   const std::vector<std::string>& names) {
    std::vector<bool> out(model.parameters.size());
    for (const std::string& name : names) out[place_of(model, what, name)] = true;
    return out;
}

int default_iterations(BatchOptimizer optimizer) {
    return optimizer == BatchOptimizer::levenberg_marquardt ? 200 : 2000;
}

const std::vector<std::pair<std::string, BatchOptimizer>>& batch_optimizers() {
    static const std::vector<std::pair<std::string, BatchOptimizer>> all = {{"lm", BatchOptimizer::levenberg_marquardt},
                                                                            {"cg", BatchOptimizer::conjugate_gradients},
                                                                            {"lbfgs", BatchOptimizer::lbfgs},
                                                                            {"adam", BatchOptimizer::adam}};
    return all;
}
const std::vector<std::pair<std::string, BatchLoss>>& batch_losses() {
    static const std::vector<std::pair<std::string, BatchLoss>> all = {
        {"square", BatchLoss::square}, {"huber", BatchLoss::huber}, {"cauchy", BatchLoss::cauchy}};
    return all;
}
const std::vector<std::pair<std::string, Precision>>& precisions() {
    static const std::vector<std::pair<std::string, Precision>> all = {{"double", Precision::double_precision},
                                                                       {"float", Precision::single_precision}};
    return all;
}

const char* name_of(BatchStatus status) {
    static constexpr const char* names[] = {"converged",       "at_bound",   "max_iterations", "stalled",
                                            "underdetermined", "no_samples", "not_finite"};
    static_assert(std::size(names) == size_t(BatchStatus::count));
    return names[size_t(status)];
}

const char* meaning_of(BatchStatus status) {
    static constexpr const char* meanings[] = {"at a minimum, which the samples determine",
                                               "at a minimum, with a parameter at a bound",
                                               "took as many steps as were allowed",
                                               "no step lowers the error, yet its gradient is not zero",
                                               "at a minimum, but the samples don't determine all parameters",
                                               "has no samples",
                                               "the error of the start, or its derivatives, are no finite numbers"};
    static_assert(std::size(meanings) == size_t(BatchStatus::count));
    return meanings[size_t(status)];
}

template <class real>
Solution<real> solve(const CompiledModel& model, const Problems<real>& problems, const Options& options) {
    const size_t P = model.text().parameters.size(), T = model.text().terms.size();
    if ((model.precision() == Precision::double_precision) != (sizeof(real) == 8))
        throw std::logic_error("batch::solve: the model was compiled for another precision");
    check_problems(model.text(), problems, options);
    Solution<real> out;
    out.parameters.resize(problems.count * P);
    out.deviations.resize(problems.count * P);
    if (options.covariance) out.covariance.resize(problems.count * P * P);
    out.error.resize(problems.count);
    out.status.resize(problems.count);
    out.steps.resize(problems.count);
    out.samples.resize(problems.count);

    std::vector<real> lower(P, -std::numeric_limits<real>::infinity()), upper(P, std::numeric_limits<real>::infinity());
    std::ranges::transform(options.lower, lower.begin(), [](double x) { return real(x); });
    std::ranges::transform(options.upper, upper.begin(), [](double x) { return real(x); });
    std::vector<unsigned char> fixed(P, 0);
    std::ranges::copy(options.fixed, fixed.begin());
    const bool one_start = problems.starts.size() == problems.start_count * P;
    std::vector<long long> offsets(problems.offsets.begin(), problems.offsets.end());
    std::vector<long long> seen(problems.count);
    const Chunk all{
        .first = 0,
        .count = (long long)problems.count,
        .offsets = offsets.empty() ? nullptr : offsets.data(),
        .samples = (long long)problems.samples,
        .terms = problems.terms.data(),
        .shared_terms = problems.offsets.empty() && problems.terms.size() == problems.samples * T,
        .targets = problems.targets.data(),
        .weights = problems.weights.empty() ? nullptr : problems.weights.data(),
        .starts = problems.starts.data(),
        .start_count = (long long)problems.start_count,
        .starts_of_each = one_start ? 1 : (long long)problems.count,
        .lower = lower.data(),
        .upper = upper.data(),
        .fixed = fixed.data(),
        .optimizer = options.optimizer,
        .learning_rate = options.learning_rate,
        .iterations = options.iterations.value_or(default_iterations(options.optimizer)),
        .tolerance = options.tolerance > 0 ? options.tolerance
                     : sizeof(real) == 8   ? 1e-9
                                           : 1e-3,
        .loss = options.loss,
        .loss_scale = options.loss_scale,
        .known_noise = options.known_noise,
        .parameters = out.parameters.data(),
        .deviations = out.deviations.data(),
        .covariance = options.covariance ? out.covariance.data() : nullptr,
        .error = out.error.data(),
        .status = out.status.data(),
        .steps = out.steps.data(),
        .seen = seen.data(),
    };
    const size_t bytes = size_t(model.storage_bytes((long long)problems.most_samples()));
    std::vector<std::vector<std::byte>> storage(static_cast<size_t>(thread_count()));
    const size_t chunks = (problems.count + problems_at_once - 1) / problems_at_once;
    std::optional<Progress> own_progress;
    if (!options.progress) own_progress.emplace("solve", problems.count);
    Progress& progress = options.progress ? *options.progress : *own_progress;
    const auto count_of = [&](size_t i) { return std::min(problems_at_once, problems.count - i * problems_at_once); };
    const auto fields = [&](auto& visit, size_t i) {
        const auto part = [&](auto& numbers, size_t of_each) {
            visit(std::span(numbers).subspan(i * problems_at_once * of_each, count_of(i) * of_each));
        };
        part(out.parameters, P);
        part(out.deviations, P);
        if (options.covariance) part(out.covariance, P * P);
        part(out.error, 1);
        part(out.status, 1);
        part(out.steps, 1);
        part(seen, 1);
    };
    const auto work = [&](size_t i, int worker) {
        storage[size_t(worker)].resize(bytes + alignment);
        void* own = storage[size_t(worker)].data();
        size_t space = bytes + alignment;
        std::align(alignment, bytes, own, space);
        Chunk some = all;
        some.first = (long long)(i * problems_at_once);
        some.count = (long long)count_of(i);
        model.solve(some, own);
    };
    finish_blocks(options.journal, chunks, fields, work, [&](size_t i) { progress.advance(count_of(i)); });
    out.samples.assign(seen.begin(), seen.end());
    return out;
}

template struct Problems<float>;
template struct Problems<double>;
template struct Solution<float>;
template struct Solution<double>;
template void check_weights(std::span<const float>, const std::string&);
template void check_weights(std::span<const double>, const std::string&);
template void check_problems(const ModelText&, const Problems<float>&, const Options&);
template void check_problems(const ModelText&, const Problems<double>&, const Options&);
template Solution<float> solve(const CompiledModel&, const Problems<float>&, const Options&);
template Solution<double> solve(const CompiledModel&, const Problems<double>&, const Options&);

}  // namespace radiafit::batch
