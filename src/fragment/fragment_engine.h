#pragma once
#include <array>
#include <memory>
#include <span>

#include "fragment/fragment_options.h"
#include "fragment/image_sweep.h"
#include "fragment/map_passes.h"
#include "gl/context.h"
#include "optim/engine.h"

namespace radiafit {

/// Where the time of the sweeps over images went, since construction.
struct FragmentTimes : SweepTimes {
    PassCounters counters;  ///< of all passes
};

/// The paper's engine for light field maps (Section 5): images stream through the device one by one (or batch by
/// batch), are distributed anew in every sweep, and everything that N or M counts lives in textures. Fulfils Engine.
/// The context must be current wherever it is used, and when it is destroyed.
class FragmentEngine {
public:
    /// dataset, atlas and rings must outlive it. views: indices of the images to fit. Throws UserError for options out
    /// of range and for sizes beyond the device's limits.
    FragmentEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                   std::vector<uint32_t> views, const LfmOptions& options, const FragmentOptions& fragment_options);
    ~FragmentEngine();

    size_t problem_count() const { return 3 * layout_.problem_count(); }
    const LfmLayout& layout() const { return layout_; }
    const ProblemGrid& grid() const { return shape_.grid; }

    // The verbs of optim/engine.h.
    ProblemStatistics count();
    void reset(std::span<const float> start);
    void fit_terms(int first, int last) { first_term_ = first, last_term_ = last; }
    void make_room(const Room& room);
    void gradient_pass(bool diagonal);
    void directional_pass();
    void dot(std::initializer_list<DotProduct> products);
    void step(Step which, const Turn& turn);
    void update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                std::initializer_list<float> constants);
    EngineSummary summary() { return numbers_.summary(run_); }
    void outcomes(std::span<ProblemOutcome> out) const { numbers_.outcomes(out); }
    void read_errors(std::span<float> out) const { numbers_.read_errors(out); }
    void read_parameters(std::span<float> out) const;

    // What tests and agreement checks look at.
    struct Evaluation {
        std::vector<float> error;     ///< [M] E_t at the trial point
        std::vector<float> gradient;  ///< [N] Parameters order
        std::vector<float> diagonal;  ///< [N] fresh preconditioner
    };
    Evaluation read_evaluation() const;  ///< after gradient_pass(true)
    struct Line {
        std::vector<float> gauss_newton, curvature, third, fourth;  ///< [M], penalties included
    };
    Line read_line() const;                                             ///< after directional_pass()
    void set_line(std::span<const float> p, std::span<const float> d);  ///< [N] each, for directional_pass()

    const FragmentTimes& times() const;
    PassRunner& passes() { return run_; }  ///< to tally them
    /// Allocated on the device by this engine; fragment/fragment_plan.h foretells it.
    uint64_t bytes() const { return bytes_; }

private:
    template <class Body>
    void sweep(const Body& body);

    int64_t allocated_before_ = Context::current().allocated_bytes();
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
    ProblemNumbers numbers_;
    std::vector<MapVector> vectors_;  ///< those of optim/verbs.h, then the optimizer's own
    MapSums gradient_sums_, square_sums_;
    std::unique_ptr<MapPasses> map_passes_;
    std::unique_ptr<ImagePasses> image_passes_;
    std::vector<uint32_t> samples_;  ///< [vertices], from count()
    mutable FragmentTimes times_;
    int first_term_ = 0, last_term_ = 1 << 30;
    uint64_t bytes_ = 0;
};

}  // namespace radiafit
