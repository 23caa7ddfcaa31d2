#pragma once
#include <functional>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "eval/error_bars.h"
#include "fit/fit_folder.h"
#include "geometry/atlas.h"
#include "geometry/raster.h"

namespace radiafit {

/// Anything that can colour points of the surface as a view's camera sees them: rgb [points][3] out, at `points` that
/// lie on the mesh (others don't matter; over a grid, `triangle` is the texel). They may be the centres of the view's
/// pixels, or several points of each, or some of these; neighbours in the list are mostly neighbours in the picture.
/// `worker` is parallel_for's: calls with different workers may run at once.
struct Contestant {
    std::function<void(const View& view, const std::vector<RasterPixel>& points, std::vector<float>& rgb, int worker)>
        shade;
    TargetSpace space = TargetSpace::stored;  ///< of the values it hands out
    /// How much of the fit a view shows, where a contestant fades to something safer far from the images that were
    /// fitted: 1 is all of it, 0 nothing. None: always all.
    std::function<double(const View& view)> share_of_fit = {};
    /// Its error bars at the points, as shade() is called: [points] out. None: it has none.
    std::function<void(const View& view, const std::vector<RasterPixel>& pixels, std::vector<ErrorBar>& bars)>
        error_bars = {};
};
/// The fit must be of this mesh (open_fitted_dataset() makes sure), of texels in this atlas; both outlive the
/// contestant.
Contestant contestant_of(const LightFieldFit& fit, const Mesh& mesh);
Contestant contestant_of(const ReflectanceFit& fit, const Atlas& atlas);

}  // namespace radiafit
