#pragma once
#include <memory>
#include <span>
#include <vector>

#include "compute/buffer_engine.h"
#include "compute/sample_sweeps.h"
#include "geometry/vertex_rings.h"

namespace radiafit {

/// Light field maps by OpenGL's compute shaders, over samples that were distributed once and stay on the device, or
/// over images that stream and are distributed in every sweep. Fulfils Engine. Passes over vertices give a work group
/// to each; sums over samples come about as `accumulate` says, and all ways but that in floats give the same bits for
/// the same fit. The context must be current wherever it is used, and when it is destroyed.
class ComputeEngine final : public BufferEngine {
public:
    /// rings and the atlas' mesh must outlive it. Throws UserError for options out of range, and where a buffer
    /// would be larger than the device allows.
    ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                  const SampleList& samples, const LfmOptions& options, Accumulate accumulate = Accumulate::gather);
    /// views: indices of the images to fit. The dataset and the atlas must outlive it, too; all triangles have one
    /// side. Throws UserError as the constructor above.
    ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                  std::vector<uint32_t> views, const LfmOptions& options, const StreamOptions& stream,
                  Accumulate accumulate = Accumulate::gather);

    size_t parameter_count() const override { return layout_.size(); }
    const LfmLayout& layout() const { return layout_; }

    // The verbs of optim/engine.h that DeviceEngine and BufferEngine lack.
    ProblemStatistics count();
    void gradient_pass(bool diagonal);
    void directional_pass();
    Line read_line() const override;

    Accumulate accumulate() const { return accumulate_; }         ///< as accumulate_here() has it
    const SweepTimes& times() const { return sweeps_->times(); }  ///< of images, where they stream

private:
    ComputeEngine(const TriangleAtlas& atlas, const VertexRings& rings, const LfmOptions& options, float target_scale,
                  Accumulate accumulate);
    Program program(const std::string& file, const Defines& more) const override {
        return resources_.program(file, more);
    }
    std::vector<float> trial_errors() const override { return sums_of(of_vertex::error, read_problems()); }
    std::vector<float> read_problems() const;                                        ///< [vertices][of_vertex][4]
    std::vector<float> sums_of(int what, const std::vector<float>& problems) const;  ///< [M]
    void make_programs();

    LfmOptions options_;
    Accumulate accumulate_;
    LfmLayout layout_;
    MapTables tables_;
    const VertexRings* rings_;
    FetchedBuffer smoothed_;
    SweepResources resources_;
    std::unique_ptr<SampleSweeps> sweeps_;
    Program laplacian_, gradient_passes_[2], line_;
};

}  // namespace radiafit
