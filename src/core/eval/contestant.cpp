#include "eval/contestant.h"

#include <memory>

#include "eval/lfm_renderer.h"
#include "eval/reflectance_renderer.h"

namespace radiafit {

Contestant contestant_of(const LightFieldFit& fit, const Mesh& mesh) {
    const auto renderer = std::make_shared<LfmRenderer>(mesh, fit);
    return {[renderer](const View& view, const auto& pixels, std::vector<float>& rgb, int worker) {
                renderer->shade(view.camera, pixels, rgb, worker);
            },
            fit.space};
}

Contestant contestant_of(const ReflectanceFit& fit, const Atlas& atlas) {
    const auto renderer = std::make_shared<ReflectanceRenderer>(atlas, fit);
    return {[renderer](const View& view, const auto& pixels, std::vector<float>& rgb, int) {
                renderer->shade(view, pixels, rgb);
            },
            TargetSpace::linear};
}

}  // namespace radiafit
