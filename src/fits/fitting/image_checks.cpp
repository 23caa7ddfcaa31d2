#include "fitting/image_checks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/error.h"
#include "base/resources.h"
#include "eval/outliers.h"
#include "fitting/family.h"
#include "fitting/resolve_options.h"

namespace radiafit::fits {
namespace {

FitRequest simplest_fit(const Dataset& dataset) {
    FitRequest request;
    if (dataset.light_moves())
        request.set("model", "lambert").set("optimizer", "lm");
    else
        request.set("solver", "mean");
    resolve_options([](const char* option) { return std::string_view(option) != "--surface-side"; }, dataset, request);
    if (!dataset.light_moves()) request.set("surface_side", "2");  // texels as large as the mesh has them
    return request;
}

/// Whether a fit takes no more than half of the free memory.
bool small(const Dataset& dataset, const FitRequest& request) {
    constexpr size_t views_to_count_samples_on = 8;
    return total_bytes(plan(dataset, request, views_to_count_samples_on).memory) <= available_memory() / 2;
}

/// The quick fit of the first family that has one.
std::optional<FitRequest> quick_fit() {
    for (const Family* family : families()) {
        if (family->quick().empty()) continue;
        FitRequest request;
        for (const auto& [option, value] : family->quick()) request.set(option, value);
        return request.set("validation", "8");
    }
    return {};
}

/// Error of every eighth training photograph, as stored, predicted with its gain by a fit of the others.
double error_left_out(const Dataset& dataset, const FitRequest& request) {
    FinishedFit done = family_of(request).fit(dataset, request);
    Dataset left_out = dataset;
    left_out.views.clear();
    for (const uint32_t v : judged_views(dataset, request)) left_out.views.push_back(dataset.views[v]);
    // judged like training photographs, whose exposure is what the dataset says
    const ErrorSums errors = judge(contestant_of(done.fit), left_out, Split::train, {.pixel_points = 1}).stored;
    return std::sqrt(errors.squared / double(errors.values));
}

template <class Change>
Dataset with_gains(Dataset dataset, const Change& change) {
    for (View& view : dataset.views) view.gain = change(view.gain);
    return dataset;
}
Gain one_for_all(const Gain& gain) { return std::cbrt(gain[0] * gain[1] * gain[2]); }

}  // namespace

std::vector<std::string> suspicious_images(const Dataset& dataset) {
    constexpr size_t least_images = 5;  // as outlying_images() has it
    if (dataset.split(false).size() < least_images) return {};
    try {
        const FitRequest request = simplest_fit(dataset);
        if (!small(dataset, request)) return {};
        FinishedFit done = family_of(request).fit(dataset, request);
        return outlying_images(judge(contestant_of(done.fit), dataset, Split::train, {.pixel_points = 1}));
    } catch (const UserError&) {  // no image shows the surface: a fit will say so
        return {};
    }
}

std::optional<GainBenefit> gain_benefit(const Dataset& dataset) {
    const auto any = [&](const auto& has) {
        return std::ranges::any_of(dataset.views, [&](const View& view) { return has(view.gain); });
    };
    constexpr size_t least_images = 16;  // two are left out
    if (dataset.light_moves() || dataset.split(false).size() < least_images) return {};
    const auto request = quick_fit();
    if (!request || !any([](const Gain& gain) { return gain != 1; }) || !small(dataset, *request)) return {};
    try {
        const double without = error_left_out(with_gains(dataset, [](const Gain&) { return Gain(); }), *request);
        GainBenefit benefit;
        benefit.lowered = 1 - error_left_out(dataset, *request) / without;
        if (any([](const Gain& gain) { return !gain.uniform(); }))
            benefit.lowered_by_one_for_all = 1 - error_left_out(with_gains(dataset, one_for_all), *request) / without;
        return benefit;
    } catch (const UserError&) {
        return {};
    }
}

std::string describe_gains(const GainBenefit& benefit) {
    constexpr double least_benefit = 0.01;
    const auto change = [](double lowered) {
        return fmt::format("{} the error of photographs left out by {:.1f} %", lowered < 0 ? "raise" : "lower",
                           100 * std::abs(lowered));
    };
    std::string line = "gains are needed: they " + change(benefit.lowered);
    if (benefit.lowered < least_benefit)
        line = fmt::format("gains are not needed: they {}; --gains none does {}", change(benefit.lowered),
                           benefit.lowered < 0 ? "better" : "as well");
    if (!benefit.lowered_by_one_for_all) return line;
    line += fmt::format("; one gain for all channels would {}", change(*benefit.lowered_by_one_for_all));
    if (benefit.lowered - *benefit.lowered_by_one_for_all < least_benefit && benefit.lowered >= least_benefit)
        line += ", so that --gains estimate does as well";
    return line;
}

std::string describe_suspicious(const std::vector<std::string>& names) {
    if (names.empty()) return "";
    return fmt::format(
        "look at {}: even the simplest fit of all images misses {} by far more than the others; "
        "radiafit fit --leave-out-outliers fits without",
        fmt::join(names, ", "), names.size() == 1 ? "it" : "them");
}

}  // namespace radiafit::fits
