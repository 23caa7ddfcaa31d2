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

std::string describe_suspicious(const std::vector<std::string>& names) {
    if (names.empty()) return "";
    return fmt::format(
        "look at {}: even the simplest fit of all images misses {} by far more than the others; "
        "radiafit fit --leave-out-outliers fits without",
        fmt::join(names, ", "), names.size() == 1 ? "it" : "them");
}

}  // namespace radiafit::fits
