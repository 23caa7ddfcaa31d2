#include "fitting/baseline_check.h"

#include <fmt/format.h>

#include "base/error.h"
#include "eval/judge.h"

namespace radiafit::fits {
namespace {

/// With four of its held-out images at most, spread over all.
Dataset with_few_held_out(Dataset dataset) {
    constexpr size_t most = 4;
    const auto held_out = dataset.split(true);
    for (size_t i = 0; i < held_out.size(); ++i) {
        const bool kept = held_out.size() <= most || (i * most) / held_out.size() != ((i + 1) * most) / held_out.size();
        dataset.views[held_out[i]].held_out = kept;
    }
    return dataset;
}

}  // namespace

bool BaselineCheck::baseline_is_better() const {
    constexpr double margin = 0.1;  // dB
    return baseline > fit + margin;
}

std::optional<BaselineCheck> check_against_baseline(Fitted& fitted) {
    if (!takes_light(fitted) || fitted.dataset().split(true).empty()) return {};
    const Dataset judged = with_few_held_out(fitted.dataset());
    Fitted baseline = baseline_of(fitted);
    try {
        const JudgeResult of_fit = judge(contestant_of(fitted), judged, Split::test);
        const JudgeResult of_baseline = judge(contestant_of(baseline), judged, Split::test);
        return BaselineCheck{of_fit.images.size(), of_fit.psnr(), of_baseline.psnr()};
    } catch (const UserError&) {  // no held-out image shows anything, which `judge` says
        return {};
    }
}

std::string describe_baseline(const BaselineCheck& check, const Fitted& fitted) {
    return fmt::format(
        "on {} held-out image{} the {} baseline is better: PSNR {:.2f} against {:.2f} dB; `radiafit tune` compares "
        "models and options on this dataset",
        check.images, check.images == 1 ? "" : "s", baseline_name(fitted), check.baseline, check.fit);
}

}  // namespace radiafit::fits
