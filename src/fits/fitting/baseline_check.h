#pragma once
#include <optional>
#include <string>

#include "fitting/fitted.h"

namespace radiafit::fits {

/// What a fit is worth on images that were held out, against its own baseline (baseline_of()).
struct BaselineCheck {
    size_t images = 0;             ///< judged: four at most, spread over those held out
    double fit = 0, baseline = 0;  ///< PSNR, dB, pooled over the images as stored
    bool baseline_is_better() const;
};

/// None where lamps stand still, or where no image was held out that shows anything.
std::optional<BaselineCheck> check_against_baseline(Fitted& fitted);

/// "on 4 held-out images the Lambertian baseline is better: 58.5 against 39.8 dB; ...": with what to do next.
std::string describe_baseline(const BaselineCheck& check, const Fitted& fitted);

}  // namespace radiafit::fits
