#pragma once
#include <memory>

#include "base/error.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fragment/texel_engine.h"

namespace radiafit::harness {

/// The paper's second problem, in the experiments that compare the two: Lafortune's model on the ornament, steepest
/// descent and conjugate gradients in the paper's mode. Reads reflectance, reflectance_side and reflectance_images.
class ReflectanceProblem {
public:
    explicit ReflectanceProblem(Config& c) {
        options_.model = find_texel_model("lafortune");
        options_.mode = Mode::paper;
        c.read("reflectance", shape_, [](const std::string& shape) {
            if (shape != "ornament") throw UserError(shape + " has no lamp that moves; choose ornament");
        });
        c.read("reflectance_side", options_.surface_side, limits::map_side);
        c.read("reflectance_images", images_, limits::images);
    }
    /// Once, after the config is finished.
    void open(const Experiment& experiment) {
        dataset_ = experiment.dataset(shape_);
        atlas_ = texel_atlas(dataset_, options_.surface_side);
        views_ = spread_views(dataset_.split(false), images_);
    }
    const Dataset& dataset() const { return dataset_; }
    const std::vector<uint32_t>& views() const { return views_; }
    size_t images() const { return views_.size(); }
    /// Samples counted.
    std::unique_ptr<TexelFragmentEngine> engine(const FragmentOptions& options) const {
        auto engine = std::make_unique<TexelFragmentEngine>(dataset_, *atlas_, views_, options_, options);
        engine->count();
        return engine;
    }

private:
    std::string shape_ = "ornament";
    int images_ = 32;
    TexelOptions options_ = {};
    Dataset dataset_;
    std::unique_ptr<Atlas> atlas_;
    std::vector<uint32_t> views_;
};

}  // namespace radiafit::harness
