#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/range.h"

namespace radiafit::limits {
constexpr Range<int> dense_sources{2, 16}, dense_agree{1, 16};
constexpr Range<double> dense_region{0.1, 10}, dense_cost{0.01, 2};
}  // namespace radiafit::limits

/// The face of stereo: depths of calibrated photographs, what `radiafit capture depths` calls.
namespace radiafit::tools {

struct DenseOptions {
    std::filesystem::path model;   ///< a COLMAP model of undistorted photographs, with its points
    std::filesystem::path images;  ///< folder of these photographs
    int sources = 6;               ///< others that each photograph is compared with (stereo/source_views.h)
    int agree = 2;                 ///< others that have to agree on a depth (stereo/agreement.h)
    double region = 1.2;           ///< size of the ball that depths are looked for in (stereo/region.h)
    double cost = 0.5;             ///< the largest (stereo/patch_match.h)
    uint64_t seed = 1;
    bool force = false;  ///< go on where memory or disk will not suffice
};

struct DenseReport {
    struct View {
        std::string name;
        size_t sources = 0;
        size_t pixels = 0;   ///< whose ray meets the region
        size_t matched = 0;  ///< that have a depth
        size_t agreed = 0;   ///< on which others agree: those that are written
    };
    std::vector<View> views;
};

/// Writes depth and normal maps of all photographs (stereo/stereo_folder.h); the folder is written atomically.
/// Photographs that share no points with two others have empty maps. What is finished is kept in unfinished_depths(out)
/// meanwhile; a run that makes the same maps goes on from it. Throws UserError.
DenseReport compute_depths(const DenseOptions& options, const std::filesystem::path& out);

/// OUT.parts/depths.journal: maps that are finished, not yet compared (base/journal.h); removed by the run that
/// finishes all.
std::filesystem::path unfinished_depths(const std::filesystem::path& out);

}  // namespace radiafit::tools
