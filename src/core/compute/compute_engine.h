#pragma once
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "compute/problem_buffers.h"
#include "compute/sample_sweeps.h"
#include "geometry/vertex_rings.h"
#include "gl/context.h"
#include "optim/engine.h"

namespace radiafit {

/// Light field maps by OpenGL's compute shaders, over samples that were distributed once and stay on the device, or
/// over images that stream and are distributed in every sweep. Fulfils Engine. Passes over vertices give a work group
/// to each; sums over samples come about as `accumulate` says, and all ways but that in floats give the same bits for
/// the same fit. The context must be current wherever it is used, and when it is destroyed.
class ComputeEngine {
public:
    /// rings and the atlas' mesh must outlive it. Throws UserError for options out of range, and where a buffer
    /// would be larger than the device allows.
    ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                  const SampleList& samples, const LfmOptions& options, Accumulate accumulate = Accumulate::gather);
    /// views: indices of the images to fit. The dataset and the atlas must outlive it, too; all triangles have one
    /// side. Throws UserError likewise.
    ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                  std::vector<uint32_t> views, const LfmOptions& options, const StreamOptions& stream,
                  Accumulate accumulate = Accumulate::gather);
    ComputeEngine(const ComputeEngine&) = delete;
    ComputeEngine& operator=(const ComputeEngine&) = delete;

    size_t problem_count() const { return 3 * layout_.problem_count(); }
    const LfmLayout& layout() const { return layout_; }

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
    EngineSummary summary() { return problems_.summary(); }
    void outcomes(std::span<ProblemOutcome> out) const { problems_.outcomes(out); }
    void read_errors(std::span<float> out) const { problems_.read_errors(out); }
    void read_parameters(std::span<float> out) const { read(vectors_[vector::p].buffer, out); }

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

    Accumulate accumulate() const { return accumulate_; }         ///< as accumulate_here() has it
    const SweepTimes& times() const { return sweeps_->times(); }  ///< of images, where they stream
    /// Allocated on the device by this engine.
    uint64_t bytes() const { return uint64_t(Context::current().allocated_bytes() - allocated_before_); }

private:
    ComputeEngine(const TriangleAtlas& atlas, const VertexRings& rings, const LfmOptions& options, float target_scale,
                  Accumulate accumulate);
    FetchedBuffer make_vector() const;
    static void read(const Buffer& buffer, std::span<float> out);
    std::vector<float> read_problems() const;                                        ///< [vertices][of_vertex][4]
    std::vector<float> sums_of(int what, const std::vector<float>& problems) const;  ///< [M]
    void make_programs();
    const Program& update_program(Update which);

    int64_t allocated_before_ = Context::current().allocated_bytes();
    LfmOptions options_;
    Accumulate accumulate_;
    LfmLayout layout_;
    MapTables tables_;
    ProblemBuffers problems_;
    const VertexRings* rings_;
    int first_term_ = 0, last_term_ = 1 << 30;
    std::vector<FetchedBuffer> vectors_;  ///< those of optim/verbs.h, then the optimizer's own
    FetchedBuffer smoothed_;
    SweepResources resources_;
    std::unique_ptr<SampleSweeps> sweeps_;
    Program laplacian_, gradient_passes_[2], line_, dot_;
    std::map<Update, Program> updates_;
    std::vector<uint32_t> sample_counts_;  ///< [vertices], from count()
};

}  // namespace radiafit
