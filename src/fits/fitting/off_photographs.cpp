#include "fitting/off_photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/wording.h"
#include "dataset/view_directions.h"
#include "eval/judge.h"
#include "fitting/family.h"

namespace radiafit::fits {
namespace {

/// [views][views] degrees between them, as seen from the surface's centre.
std::vector<std::vector<double>> angles_between(const Dataset& dataset, const std::vector<uint32_t>& views) {
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    const auto degrees = [](const Vec3d& a, const Vec3d& b) {
        return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180 / std::numbers::pi;
    };
    std::vector<std::vector<double>> out(views.size(), std::vector<double>(views.size(), 0));
    for (size_t i = 0; i < views.size(); ++i)
        for (size_t j = 0; j < i; ++j) {
            const View &a = dataset.views[views[i]], &b = dataset.views[views[j]];
            double angle = degrees(a.direction_to_camera(centre), b.direction_to_camera(centre));
            if (a.light)
                angle = std::max(angle, degrees(a.light->direction_from(centre), b.light->direction_from(centre)));
            out[i][j] = out[j][i] = angle;
        }
    return out;
}

}  // namespace

FarViews far_views(const Dataset& dataset, const std::vector<uint32_t>& views, double degrees, size_t most) {
    const std::vector<std::vector<double>> angles = angles_between(dataset, views);
    const size_t count = views.size();
    std::vector<bool> near(count, false), judged(count, false);
    const auto near_with = [&](size_t more) {
        size_t sum = 0;
        for (size_t i = 0; i < count; ++i) sum += near[i] || angles[more][i] < degrees;
        return sum;
    };
    FarViews out;
    for (size_t taken = 0; taken < most; ++taken) {
        // The farthest from those that are taken, whose neighbours may be left out, too; first the one with the most.
        size_t best = count;
        double highest = -1;
        for (size_t i = 0; i < count; ++i) {
            if (near[i] || 2 * near_with(i) > count) continue;
            double value = taken == 0 ? double(near_with(i)) : std::numeric_limits<double>::infinity();
            for (size_t j = 0; j < count; ++j)
                if (judged[j]) value = std::min(value, angles[i][j]);
            if (value > highest) best = i, highest = value;
        }
        if (best == count) break;
        judged[best] = true;
        for (size_t i = 0; i < count; ++i)
            if (angles[best][i] < degrees) near[i] = true;
    }
    for (size_t i = 0; i < count; ++i) {
        if (judged[i]) out.judged.push_back(views[i]);
        if (!near[i]) out.fitted.push_back(views[i]);
    }
    std::ranges::sort(out.judged);
    std::ranges::sort(out.fitted);
    return out;
}

Dataset split_by(const Dataset& dataset, const FarViews& far) {
    Dataset split = dataset;
    split.views.clear();
    for (const uint32_t v : far.fitted) split.views.push_back(dataset.views[v]);
    for (const uint32_t v : far.judged) {
        split.views.push_back(dataset.views[v]);
        split.views.back().held_out = true;
    }
    return split;
}

std::vector<OffPhotographs> judge_off_photographs(const Dataset& dataset, const FitRecord& fit, int pixel_points,
                                                  const std::function<void(const OffPhotographs&)>& judged) {
    FitRequest again = fitted_request(fit);
    if (again.memory > 0)
        throw UserError(
            fmt::format("{} fits in one piece, and this fit was made within a limit of memory ({}); judge a fit "
                        "without that limit",
                        option_name("off-photographs"), option_name("memory")));
    const std::vector<uint32_t> fitted = fitted_views(dataset, fit);
    again.validation = 0;
    again.leave_out.clear();
    again.records.clear();
    std::vector<OffPhotographs> out;
    for (const double degrees : off_degrees) {
        const FarViews far = far_views(dataset, fitted, degrees);
        if (far.judged.empty()) continue;
        const Dataset split = split_by(dataset, far);
        FinishedFit done = family_of(again).fit(split, again);
        Fitted baseline = baseline_of(done.fit);
        const JudgeOptions options{.pixel_points = pixel_points};
        const JudgeResult of_fit = judge(contestant_of(done.fit), split, Split::test, options),
                          of_baseline = judge(contestant_of(baseline), split, Split::test, options);
        double worst = std::numeric_limits<double>::infinity();
        for (size_t i = 0; i < of_fit.images.size(); ++i)
            worst = std::min(worst, of_fit.images[i].stored.psnr() - of_baseline.images[i].stored.psnr());
        out.push_back({degrees, far.judged.size(), far.fitted.size(), of_fit.stored, of_baseline.stored, worst});
        if (judged) judged(out.back());
    }
    if (out.empty())
        throw UserError(
            fmt::format("{}: around no view so few others lie that half of all are left without them; {} needs "
                        "views from more sides",
                        dataset.folder.string(), option_name("off-photographs")));
    return out;
}

}  // namespace radiafit::fits
