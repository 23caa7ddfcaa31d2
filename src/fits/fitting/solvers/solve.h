#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dataset/image_stream.h"
#include "fit/fit_folder.h"
#include "fitting/fit_request.h"
#include "model/lfm.h"
#include "optim/trace.h"
#include "reference/resampling_counts.h"
#include "samples/block_file.h"
#include "samples/distributor.h"
#include "samples/texel_source.h"

/// Fits a dataset by a choice of solver, optimizer and engine: the one way to do so, for the command line and for
/// experiments alike.
namespace radiafit::fits {

/// Seconds by activity; what is not named is unaccounted.
struct FitTimes {
    double distribution = 0, streaming = 0, optimization = 0, total = 0;
    double outside = 0;  ///< emptying the page cache, which is no part of the total
};

/// What else a run reports with its fit.
struct FitRun {
    Trace trace;
    FitTimes times;
    std::string gl_vendor, gl_renderer, gl_version;
    double sweep_cpu_ms_per_image = 0;  ///< process CPU time of sweeps over images that stream
    double images_cached_share = 0;     ///< of images.bin's pages, when they were done
    std::string accumulation;           ///< how the compute engine summed over samples, for people; else empty
    uint64_t engine_bytes = 0;          ///< device memory (or vectors) of the engine
    size_t group_size = 0;              ///< invocations of the compute engine's work groups; else 0
    // Of the two-step solver.
    RecordStatistics records;
    uint64_t record_bytes_read = 0;
    uint64_t sample_iterations = 0;  ///< radiance samples of each vertex (or texel) times its iterations
    double record_cached_share = 0;  ///< of the records' pages, when step 2 began
    uint64_t working_set_bytes = 0;  ///< of the largest vertex
};

struct FitOutcome : FitRun {
    LightFieldFit fit;
    DistributionStatistics distribution;  ///< where a sample list was built
    ResamplingCounts resampling;          ///< of the pca solver
};

/// Called after every iteration with a way to read each problem's E_t.
using IterationHook = std::function<void(int iteration, const std::function<void(std::span<float>)>& read_errors)>;

/// The training views that a request fits.
std::vector<uint32_t> fitted_views(const Dataset& dataset, const FitRequest& request);
/// The views that its fit is judged by: those held out, or with `validation` the training views that it leaves out.
std::vector<uint32_t> judged_views(const Dataset& dataset, const FitRequest& request);
/// What options are chosen by: the training views alone, those that a fit with this `validation` left out held out.
Dataset for_validation(Dataset dataset, int validation);

/// A sample list that several fits share, so that they solve the very same problems. Built for training views.
struct SharedSamples {
    SampleList list;
    DistributionStatistics statistics;
    double seconds = 0;
};
SharedSamples distribute(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request);
/// The same over the given views.
SharedSamples distribute(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                         const std::vector<uint32_t>& views);

/// The samples of these views that the request's fit reads, where it reads a list.
SampleList list_samples(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                        const std::vector<uint32_t>& views, DistributionStatistics* statistics = nullptr);

/// The request with model.sides chosen, by these views, if it asks for them by texels_per_pixel.
FitRequest with_sides(FitRequest request, const Dataset& dataset, const std::vector<uint32_t>& views);

/// Fits training views (or `views`). `samples`, if given, must come from distribute() with equal sides, space and
/// views; engines that redistribute every pass ignore it.
FitOutcome solve(const Dataset& dataset, const FitRequest& request, const SharedSamples* samples = nullptr,
                 const IterationHook& each_iteration = {}, const std::vector<uint32_t>* views = nullptr);

/// Fits of the pca solver with so many refills each, ascending, from one resampling; each has the time of all. Throws
/// std::invalid_argument for another solver, and for refills that are none or not in order.
std::vector<FitOutcome> solve_by_refills(const Dataset& dataset, const FitRequest& request,
                                         std::span<const int> refills);

struct ReflectanceOutcome : FitRun {
    ReflectanceFit fit;
    std::unique_ptr<Atlas> atlas;
    uint64_t samples = 0;  ///< pixels in texels, those that don't count included
    /// Of a part whose request has a prior, which is known only from the whole surface: the fit is one without it, and
    /// these are the samples of its texels that are poorly_seen(), of others none.
    TexelSamples poorly_seen;
};
/// Samples by texel that several fits share; `request` as those of the fits, as far as it means something here.
struct SharedTexels {
    std::unique_ptr<TexelSource> source;
    std::vector<uint32_t> texels = {};  ///< that the source is of, ascending; a fit is of these alone. Empty: all
    double seconds = 0;
};
SharedTexels distribute_texels(const Dataset& dataset, const FitRequest& request, const std::vector<uint32_t>& views);
/// The same for a texel-local model over a dataset with lights. `samples`, if given, are distribute_texels()'s with
/// equal side and views.
ReflectanceOutcome solve_reflectance(const Dataset& dataset, const FitRequest& request,
                                     const IterationHook& each_iteration = {},
                                     const std::vector<uint32_t>* views = nullptr,
                                     const SharedTexels* samples = nullptr);

/// Bytes per array, before anything is allocated or written.
struct PlanRow {
    std::string array, shape;
    uint64_t count, bytes;
    unsigned stages = while_all;  ///< sum of those that hold it
    /// A fit finds its samples, learns what all of its problems have in common (not every family does), solves, and
    /// writes maps.
    enum Stages : unsigned {
        while_distributing = 1,
        while_learning = 2,
        while_solving = 4,
        while_writing = 8,
        while_all = 15
    };
};
/// Bytes in the stage that holds most.
uint64_t total_bytes(const std::vector<PlanRow>& rows);
struct Plan {
    std::vector<PlanRow> memory, disk;  ///< disk: upper bounds, since what is written shrinks
    std::vector<PlanRow> paper;         ///< the paper's layout of the same, where it has one
};
/// What the program itself takes with its libraries, which `radiafit --version` loads too.
inline constexpr uint64_t program_bytes = 150'000'000;
/// Samples are counted on every eighth fitted view but eight at least, or on `most_views`.
Plan plan(const Dataset& dataset, const FitRequest& request, size_t most_views = SIZE_MAX);
/// How long a fit takes on this machine, writing it left out.
struct PlannedSeconds {
    double distributing = 0, solving = 0;
};
/// By doing both for a few images and some of the vertices. For light field maps by `stream` on the CPU, else none.
std::optional<PlannedSeconds> plan_seconds(const Dataset& dataset, const FitRequest& request);
/// Section 6.3's accounting for a mesh: 16 bytes per texel, half of each tile unused.
std::vector<PlanRow> paper_layout(size_t triangles, size_t vertices, int surface_side, int view_side);

}  // namespace radiafit::fits
