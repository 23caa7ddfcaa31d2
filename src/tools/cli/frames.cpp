#include "cli/frames.h"

#include <algorithm>
#include <optional>

#include "base/log.h"
#include "cli/pictures.h"
#include "cli/video.h"

namespace radiafit::tools {

double render_frames(const RenderOptions& options, const Contestant& fit, const Dataset& dataset,
                     const std::vector<NamedView>& frames, const char* what) {
    std::optional<Pictures> pictures;
    if (!options.output.empty()) pictures.emplace(options.output, options.background);
    for (const NamedView& frame : frames)
        if (pictures) pictures->check(frame.name, {".png", ".exr"});
    std::optional<Video> video;
    if (!options.video.empty()) video.emplace(options.video, options.background);
    double least_share = 1;
    Progress progress(what, frames.size());
    for (const NamedView& frame : frames) {
        if (fit.share_of_fit) least_share = std::min(least_share, fit.share_of_fit(frame.view));
        const LightImage image = render(fit, dataset, frame.view, options.points());
        if (pictures) pictures->add(frame.name, image);
        if (video) video->add(image);
        progress.advance();
    }
    progress.finish();
    if (video) video->encode();
    if (pictures) pictures->commit();
    if (video) video->commit();
    return least_share;
}

}  // namespace radiafit::tools
