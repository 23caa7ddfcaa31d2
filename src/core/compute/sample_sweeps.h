#pragma once
#include <memory>
#include <vector>

#include "compute/buffer_engine.h"
#include "compute/compute_options.h"
#include "compute/map_tables.h"
#include "dataset/dataset.h"
#include "fragment/image_sweep.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

namespace radiafit {

/// The words of shaders/compute/problems.glsl, in vec4s.
namespace of_vertex {
enum { density, lambda_view, error, line, count = line + 4 };
}
inline constexpr size_t tile_sums = 4;

/// What sweeps over samples work on, and what they leave their sums in. All outlives them.
struct SweepResources {
    const LfmOptions& options;
    const LfmLayout& layout;
    MapTables& tables;
    ProblemBuffers& problems;
    std::vector<BufferVector>& vectors;

    /// A program of shaders/compute, with tables and problems bound and options set; more: definitions beside theirs.
    Program program(const std::string& file, const Defines& more = {}) const;
    /// The same, with `maps` as its maps.
    Program program_over(int vector, const std::string& file, const Defines& more = {}) const;
};

/// What is known of tiles' samples before a fit.
struct TileStatistics {
    std::vector<uint32_t> samples;  ///< [tiles]
    std::vector<float> targets;     ///< [tiles][3 corners][3] sums of L t
};

/// Sums over the samples of a light field map: what a ComputeEngine does in several ways. Passes over vertices
/// that are compiled with sums() and bound by bind_to() find them.
class SampleSweeps {
public:
    virtual ~SampleSweeps() = default;
    virtual Defines sums() const = 0;
    virtual void bind_to(const Program& program) const = 0;
    virtual TileStatistics count() = 0;
    /// At the trial: E and the sums of its gradient; diagonal: also those of diag(J'J).
    virtual void gradient_pass(bool diagonal) = 0;
    /// At p along d.
    virtual void directional_pass() = 0;
    virtual const SweepTimes& times() const;  ///< of images, where they stream
};

/// Sweeps over samples that stay on the device. `resources.tables` are filled and uploaded.
std::unique_ptr<SampleSweeps> make_cached_gather(const SweepResources& resources, const Dataset& dataset,
                                                 const TriangleAtlas& atlas, const VertexRings& rings,
                                                 const SampleList& samples);
/// Sweeps in which the same samples scatter; `accumulate`: in which way, as accumulate_here() returned it.
std::unique_ptr<SampleSweeps> make_cached_scatter(const SweepResources& resources, const Dataset& dataset,
                                                  const TriangleAtlas& atlas, const VertexRings& rings,
                                                  const SampleList& samples, Accumulate accumulate);
/// Sweeps over images that stream and are distributed in each; `resources.tables` are uploaded.
std::unique_ptr<SampleSweeps> make_streamed_gather(const SweepResources& resources, const Dataset& dataset,
                                                   const TriangleAtlas& atlas, std::vector<uint32_t> views,
                                                   const StreamOptions& stream);
std::unique_ptr<SampleSweeps> make_streamed_scatter(const SweepResources& resources, const Dataset& dataset,
                                                    const TriangleAtlas& atlas, std::vector<uint32_t> views,
                                                    const StreamOptions& stream, Accumulate accumulate);

}  // namespace radiafit
