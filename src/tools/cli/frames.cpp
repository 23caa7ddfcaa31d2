#include "cli/frames.h"

#include <algorithm>
#include <optional>

#include "base/clock.h"
#include "base/forecast.h"
#include "base/parallel.h"
#include "cli/pictures.h"
#include "cli/video.h"

namespace radiafit::tools {

void make_pictures(const char* task, size_t count, const std::function<void(size_t, int)>& make) {
    if (count == 0) return;
    Forecast forecast;
    const Stopwatch clock;
    make(0, 0);
    const auto at_once = double(std::clamp<size_t>(count - 1, 1, size_t(thread_count())));
    const size_t part = forecast.add(count - 1, std::max(clock.cpu_s() / at_once, 1e-6));
    ForecastProgress progress(task, forecast);
    progress.begin(part);
    parallel_for(count - 1, 1, [&](size_t i, int worker) {
        make(i + 1, worker);
        progress.advance();
    });
    progress.finish();
}

double render_frames(const RenderOptions& options, const Contestant& fit, const Dataset& dataset,
                     const std::vector<NamedView>& frames, const char* what) {
    std::optional<Pictures> pictures;
    if (!options.output.empty()) pictures.emplace(options.output, options.background);
    for (const NamedView& frame : frames)
        if (pictures) pictures->check(frame.name, {".png", ".exr"});
    std::optional<Video> video;
    if (!options.video.empty()) video.emplace(options.video, options.background);
    double least_share = 1;
    for (const NamedView& frame : frames)
        if (fit.share_of_fit) least_share = std::min(least_share, fit.share_of_fit(frame.view));
    make_pictures(what, frames.size(), [&](size_t i, int worker) {
        const LightImage image = render(fit, dataset, frames[i].view, options.points(), worker);
        if (pictures) pictures->add(frames[i].name, image);
        if (video) video->add(i, image);
    });
    if (video) video->encode();
    if (pictures) pictures->commit();
    if (video) video->commit();
    return least_share;
}

}  // namespace radiafit::tools
