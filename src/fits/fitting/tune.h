#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/interrupt.h"
#include "base/range.h"
#include "dataset/dataset.h"
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
    double psnr = 0, ape = 0;  ///< on the views left out
    double seconds = 0;        ///< of the fit
};

/// Fits of the models that the dataset's kind of light allows, then of settings beside the best one's, option by
/// option, as long as one is better by 0.02 dB and time is left. Best first. `tried`: after each. A signal ends it with
/// what was tried so far, and is stored in `stopped`, if given. Throws UserError where nothing can be fitted or
/// judged.
std::vector<TriedSetting> tune(const Dataset& dataset, const TuneOptions& options,
                               const std::function<void(const TriedSetting&)>& tried = {},
                               std::optional<Interrupted>* stopped = nullptr);

}  // namespace radiafit::fits
