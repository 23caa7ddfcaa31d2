#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "batch/compiled_model.h"

namespace radiafit {
class Journal;
class Progress;
}  // namespace radiafit

/// Many small least-squares problems of one model,
///     1/2 sum over samples s of w_s |value(p, t_s) - y_s|^2,
/// each with its own parameters p, weights w and targets y; a robust loss may stand in place of w |r|^2.
namespace radiafit::batch {

/// Whose arrays belong to the caller. Numbers are `real`s, float or double.
template <class real>
struct Problems {
    size_t count = 0;
    /// [count + 1] where each problem's samples begin; empty: each has `samples`.
    std::span<const int64_t> offsets = {};
    size_t samples = 0;
    std::span<const real> terms;    ///< [all samples][terms], or [samples][terms] where all problems have the same
    std::span<const real> targets;  ///< [all samples][values]; a sample with a number that is none is missing
    std::span<const real> weights;  ///< [all samples], 1 / variance; empty: 1. 0: missing
    std::span<const real> starts;   ///< [start_count][count or 1][parameters]
    size_t start_count = 1;         ///< the best end of so many is taken
    size_t first = 0;               ///< of more problems, these are those from this one on: for messages alone

    size_t all_samples() const { return offsets.empty() ? count * samples : size_t(offsets.back()); }
    size_t most_samples() const;
};

struct Options {
    BatchOptimizer optimizer = BatchOptimizer::levenberg_marquardt;
    double learning_rate = 0.01;  ///< of Adam: its first step of a parameter, where 1 changes values by the residuals
    std::optional<int> iterations = {};  ///< at most; none: default_iterations()
    double tolerance =
        0;  ///< ends where a parameter's next step is so many of its standard deviations; 0: by precision
    std::vector<double> lower = {}, upper = {};  ///< [parameters]; empty: none
    std::vector<bool> fixed = {};                ///< [parameters] stay as they start; empty: none
    BatchLoss loss = BatchLoss::square;
    double loss_scale = 1;     ///< of a residual times the root of its weight, beyond which the loss is robust
    bool known_noise = false;  ///< weights are 1 / variance; else relative to it, and it is found from the residuals
    bool covariance = true;
    Journal* journal = nullptr;    ///< of problems that are solved; null: none is kept
    Progress* progress = nullptr;  ///< advances by a step a problem; null: one of its own
};

template <class real>
struct Solution {
    std::vector<real> parameters;  ///< [count][parameters]
    std::vector<real> deviations;  ///< [count][parameters] standard; 0 of fixed ones and those at a bound
    std::vector<real> covariance;  ///< [count][parameters][parameters]; empty: not asked for
    std::vector<real> error;       ///< [count] sum of w |r|^2, or of the loss
    std::vector<int32_t> status;   ///< [count] BatchStatus
    std::vector<int32_t> steps;    ///< [count]
    std::vector<int64_t> samples;  ///< [count] that are not missing

    std::vector<size_t> counts() const;  ///< by BatchStatus
};

/// Values by parameter, such as {"width", 2}.
using ByName = std::map<std::string, double>;
/// [parameters] of these, `without` where a parameter is not named. Throws UserError for a name that is none; `what` is
/// theirs in messages.
std::vector<double> of_parameters(const ModelText& model, const std::string& what, const ByName& named, double without);
/// [parameters] whether each is named; likewise.
std::vector<bool> among_parameters(const ModelText& model, const std::string& what,
                                   const std::vector<std::string>& names);

/// How many an optimizer may take where nothing else is said.
int default_iterations(BatchOptimizer optimizer);

/// By name, for options.
const std::vector<std::pair<std::string, BatchOptimizer>>& batch_optimizers();
const std::vector<std::pair<std::string, BatchLoss>>& batch_losses();
const std::vector<std::pair<std::string, Precision>>& precisions();

const char* name_of(BatchStatus status);     ///< "at_bound"
const char* meaning_of(BatchStatus status);  ///< in a few words

/// Throws UserError for bounds that cross, or other options that can't be.
void check_options(const ModelText& model, const Options& options);
/// Throws UserError for offsets (one at least) that don't begin with 0, or fall.
/// name: theirs in messages.
void check_offsets(std::span<const int64_t> offsets, const std::string& name);
/// Throws UserError for weights that are none; likewise.
template <class real>
void check_weights(std::span<const real> weights, const std::string& name);
/// Throws UserError for arrays whose sizes don't fit the model, offsets that fall, weights that are none, or a
/// start that is no number; and as check_options() does.
template <class real>
void check_problems(const ModelText& model, const Problems<real>& problems, const Options& options);

/// Solves them on all cores. Throws as check_problems() does. The same bits whatever the number of threads.
template <class real>
Solution<real> solve(const CompiledModel& model, const Problems<real>& problems, const Options& options);

}  // namespace radiafit::batch
