#include "stereo/model_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/read_file.h"
#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "capture/file_names.h"

namespace radiafit::tools {
namespace {

constexpr double least_registered = 0.75;  // of all
constexpr double largest_error = 1.5;      // pixels
constexpr double least_track = 3;          // photographs
constexpr size_t least_points = 30;        // of a photograph

constexpr const char* retake =
    "take more photographs between neighbours, 10 to 15 degrees apart, sharp, with the object still and something "
    "structured around it";

/// "a.jpg, b.jpg and 7 more"
std::string listed(const std::vector<std::string>& names) {
    constexpr size_t most = 8;
    const size_t shown = std::min(most, names.size());
    std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + ptrdiff_t(shown), ", "));
    if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
    return text;
}

void find_what_is_poor(ModelCheck& check) {
    std::vector<std::string> missing, weak;
    for (const ModelCheck::Photograph& p : check.photographs) {
        if (!p.registered)
            missing.push_back(p.name);
        else if (p.points < least_points)
            weak.push_back(p.name);
    }
    const auto say = [&](std::string line) { check.poor.push_back(std::move(line)); };
    if (double(check.registered) < least_registered * double(check.photographs.size()))
        say(fmt::format("only {} of {} photographs were registered, not {}: {}", check.registered,
                        check.photographs.size(), listed(missing), retake));
    if (check.reprojection_error > largest_error)
        say(
            fmt::format("the mean reprojection error is {:.2f} pixels, above {}: use one lens at one zoom and focus "
                        "for all photographs, and leave out what is blurred",
                        check.reprojection_error, largest_error));
    if (check.track_length < least_track)
        say(fmt::format("points are seen by {:.1f} photographs in the mean, fewer than {}: {}", check.track_length,
                        least_track, retake));
    if (!weak.empty())
        say(fmt::format("fewer than {} points are seen by {}: leave them out, or {}", least_points, listed(weak),
                        retake));
}

}  // namespace

ModelCheck check_model(const std::filesystem::path& folder, const std::filesystem::path& photographs) {
    const Calibration model = read_colmap(folder);
    const std::vector<SparsePoint> points = read_colmap_points(folder, model);
    if (points.empty())
        throw UserError(
            fmt::format("{}: the model has no points to check its cameras by: {}; where cameras are known otherwise, "
                        "an import needs no points, and checks them by the mesh",
                        folder.string(), retake));
    ModelCheck check;
    std::map<std::string, ModelCheck::Photograph> all;
    for (const std::string& name : list_images(photographs)) all[name].name = name;
    std::vector<size_t> seen(model.images.size(), 0);
    for (const SparsePoint& point : points) {
        check.reprojection_error += point.error;
        check.track_length += double(point.images.size());
        for (const uint32_t i : point.images) ++seen[i];
    }
    check.reprojection_error /= double(points.size());
    check.track_length /= double(points.size());
    for (size_t i = 0; i < model.images.size(); ++i) all[model.images[i].name] = {model.images[i].name, true, seen[i]};
    check.points = points.size();
    check.registered = model.images.size();
    for (auto& [name, photograph] : all) check.photographs.push_back(std::move(photograph));
    find_what_is_poor(check);
    return check;
}

}  // namespace radiafit::tools
