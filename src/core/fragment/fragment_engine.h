#pragma once
#include <memory>
#include <span>
#include <vector>

#include "fragment/device_engine.h"
#include "fragment/fragment_options.h"
#include "fragment/image_sweep.h"
#include "fragment/map_passes.h"

namespace radiafit {

/// The paper's engine for light field maps (Section 5): images stream through the device one by one (or batch by
/// batch), are distributed anew in every sweep, and everything that N or M counts lives in textures. Fulfils Engine.
/// The context must be current wherever it is used, and when it is destroyed.
class FragmentEngine final : public DeviceEngine<MapVector, ProblemNumbers> {
public:
    /// dataset, atlas and rings must outlive it. views: indices of the images to fit. Throws UserError for options out
    /// of range and for sizes beyond the device's limits.
    FragmentEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                   std::vector<uint32_t> views, const LfmOptions& options, const FragmentOptions& fragment_options);

    size_t parameter_count() const override { return layout_.size(); }
    const LfmLayout& layout() const { return layout_; }
    const ProblemGrid& grid() const { return shape_.grid; }

    // The verbs of optim/engine.h that DeviceEngine lacks.
    ProblemStatistics count();
    void gradient_pass(bool diagonal);
    void directional_pass();
    void dot(std::initializer_list<DotProduct> products);
    void step(Step which, const Turn& turn);
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants) {
        map_passes_->update(which, vectors, numbers, constants);
        exchange_spares(which, vectors);
    }
    Line read_line() const override;

    SweepTimes times() const { return images_.times(); }
    PassRunner& passes() { return run_; }  ///< to tally them

private:
    template <class Body>
    void sweep(const Body& body);
    MapVector make_vector() const override { return {shape_, fragment_options_.storage}; }
    void make_products(int count) override { problems_.make_products(count); }
    void drop_targets() override {
        if (map_passes_) map_passes_->drop_targets();
    }
    std::vector<float> trial_errors() const override;

    LfmOptions options_;
    FragmentOptions fragment_options_;
    LfmLayout layout_;
    MapShape shape_;
    ImageSweep images_;
    SlsMesh mesh_;
    PassRunner run_;
    ProblemTextures problems_;
    Gathers gathers_;
    Texture vertices_;
    MapSums gradient_sums_, square_sums_;
    std::unique_ptr<MapPasses> map_passes_;
    std::unique_ptr<ImagePasses> image_passes_;
};

}  // namespace radiafit
