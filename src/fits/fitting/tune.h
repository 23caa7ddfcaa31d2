#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/interrupt.h"
#include "base/range.h"
#include "dataset/dataset.h"
#include "eval/metrics.h"
#include "fitting/fit_options.h"

namespace radiafit::limits {
constexpr Range<double> tune_seconds{1, 1e6};
constexpr Range<int> tune_validation{2, 1'000'000};
}  // namespace radiafit::limits

/// Which model, and which of its options, suit a dataset: judged on training views that the fits leave out.
namespace radiafit::fits {

struct TuneOptions {
    double seconds = 300;  ///< about so long; the first fit is always tried
    int validation = 8;    ///< every so many-th training view is left out to judge by; see left_out_every()
    FitSetting fixed;      ///< options that every fit has; models to which one of them means nothing are not tried
};

/// TuneOptions::validation, or what leaves out two of the dataset's training views where that would be fewer; 2 at
/// least.
int left_out_every(const Dataset& dataset, const TuneOptions& options);

struct TriedSetting {
    FitSetting setting;
    double psnr = 0, ape = 0;             ///< on the views left out
    double seconds = 0;                   ///< of the fit
    double judge_seconds = 0;             ///< of judging these views
    size_t numbers = 0;                   ///< of the fit (number_count())
    std::vector<ErrorSums> errors;        ///< of each of these views, in one order for all settings
    std::optional<double> off_psnr = {};  ///< off_photographs_degrees from all views of another fit; of few settings

    size_t bytes() const { return sizeof(float) * numbers; }  ///< of its maps, as floats
};

/// A setting that was left out for want of time, and what a fit of its model took.
struct UntriedSetting {
    FitSetting setting;
    double seconds = 0;
};

struct Tuned {
    std::vector<TriedSetting> tried;  ///< best first
    size_t recommended = 0;           ///< of these; see recommended_of()
    std::vector<UntriedSetting> left_out;
    std::vector<std::string> models_left_out;  ///< since an option that every fit has means nothing to them
    std::optional<double> off_left_out =
        {};  ///< models were not compared off the photographs, for want of so many seconds
};

/// How far the views are from those that are fitted, by which models are compared off the photographs.
inline constexpr double off_photographs_degrees = 25;

/// Fits of the models that the dataset's kind of light allows, then of settings beside the best one's, option by
/// option, as long as one is better by 0.02 dB and time is left. Of light that stays, the best settings of models that
/// are within 1 dB of the best one are then fitted without the views around some, and judged there
/// (fitting/off_photographs.h), for which up to a third of the time is kept. `tried`: after each. A signal ends it with
/// what was tried so far, and is stored in `stopped`, if given. Throws UserError where nothing can be fitted or judged.
Tuned tune(const Dataset& dataset, const TuneOptions& options,
           const std::function<void(const TriedSetting&)>& tried = {}, std::optional<Interrupted>* stopped = nullptr);

/// Of settings, best first, the one with the fewest numbers that the best one's further numbers are not worth: the best
/// one is better by less than 0.05 dB for each time that it has twice as many, or not beyond the noise of the views
/// that were left out: with these views drawn anew (Efron's bootstrap, both settings on the same draws), it has the
/// lower error in less than 97.5 % of 2,000 draws.
size_t smallest_as_good(const std::vector<TriedSetting>& best_first);

/// smallest_as_good(), of the model that is best amid the photographs and off them: that whose off_psnr and PSNR have
/// the highest mean. Of all models where fewer than two have an off_psnr.
size_t recommended_of(const std::vector<TriedSetting>& best_first);

}  // namespace radiafit::fits
