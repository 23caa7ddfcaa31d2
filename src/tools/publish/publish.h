#pragma once
#include <optional>

#include "eval/judge.h"
#include "publish/page.h"
#include "publish/page_model.h"
#include "publish/page_words.h"

namespace radiafit::tools {

/// A fit that is to be shown, of any family. All must outlive publish().
struct Published {
    const Dataset& dataset;
    const FitRecord& record;
    std::string description;  ///< of the model: "lafortune, 9 parameters in each of 4096 texels"
    Contestant fit, baseline;
    std::string baseline_name;
    bool takes_light;                ///< may be shown under any lamp
    std::vector<uint32_t> training;  ///< views that were fitted
    PageModel model;
    /// [texels] of the model's atlas, for specular enhancement, where the fit tells finer ones than it is shaded with:
    /// unit, of a grid x right, y up, z out of its plane, of a mesh in its coordinates. Empty: there are none.
    std::vector<Vec3f> fit_normals = {};
};

struct PublishOptions {
    double fidelity =
        50;  ///< dB: PSNR of the page's pictures against the fit's; less where the page would be too large
    double megabytes = 30;  ///< of the page, at most
    int views = 8;          ///< of each split whose photographs are on the page, at most
    PageWords words = {};
};

/// How much of the fit the page keeps: stated on it, and to the user.
struct PublishOutcome {
    Page page;
    double fidelity = 0;  ///< dB: of pictures by the maps as the page has them, against the fit's; infinite: alike
    double psnr = 0, shown_psnr = 0, baseline_psnr = 0;  ///< of the fit, of the page's maps, of the baseline
    Split split = Split::test;                           ///< that these are of
    size_t photographs = 0;                              ///< in this split
};

/// About how long publish() takes for a fit of so many numbers, of which a picture takes so long with all threads at
/// work, by what coding takes on this machine.
double expected_seconds(size_t numbers, double view_seconds, size_t judged_views, const PublishOptions& options = {});

/// Encodes the maps, decodes them again, and has the judge compare renders of both. Throws UserError where no page of
/// so few megabytes can be made.
PublishOutcome publish(Published fit, const PublishOptions& options);

}  // namespace radiafit::tools
