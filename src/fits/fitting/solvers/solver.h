#pragma once
#include <memory>
#include <optional>
#include <span>

#include "fitting/fit_facts.h"
#include "fitting/solvers/solve.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "gl/context.h"
#include "optim/engine.h"

namespace radiafit {
class TexelSolvers;
struct SweepTimes;
struct TexelFitOptions;
struct TexelProblem;
struct VertexShape;
struct VertexSolution;
}  // namespace radiafit

/// The solvers that `--solver` names: one table, one function each.
namespace radiafit::fits {

/// One fit as its solver sees it.
class FitTask {
public:
    const Dataset& dataset;
    const FitRequest& request;
    const TriangleAtlas& atlas;
    const VertexRings& rings;
    const std::vector<uint32_t>& views;  ///< to fit
    const IterationHook& each_iteration;
    LfmOptions options;  ///< of the model that is fitted; a solver that fits a smaller one sets it here
    FitOutcome& out;

    FitTask(const Dataset& dataset, const FitRequest& request, const TriangleAtlas& atlas, const VertexRings& rings,
            const std::vector<uint32_t>& views, const IterationHook& each_iteration, const SharedSamples* shared,
            FitOutcome& out);
    /// The shared list, or one distributed at the first call and timed as distribution.
    const SampleList& samples();
    LfmLayout layout() const;

private:
    const SharedSamples* shared_;
    std::optional<SharedSamples> own_;
};

/// Throws UserError where no training view has a sample, but of a part of a fit, which may well be unseen.
void require_seen(bool seen, const Dataset& dataset, const FitRequest& request);

/// The distributors that a request names, one per thread (or one, with its own context), as SampleCollector takes them.
struct Distributors {
    std::unique_ptr<Context> context;
    std::vector<std::unique_ptr<Distributor>> owned;
    std::vector<Distributor*> workers() const;
};
/// Over a grid every texel has its own pixel, and `distributor` means nothing.
Distributors make_distributors(const Atlas& atlas, const FitRequest& request);

/// A fit of a texel-local model as its solver sees it.
struct TexelTask {
    const Dataset& dataset;
    const FitRequest& request;
    const std::vector<uint32_t>& views;
    const IterationHook& each_iteration;
    const SharedTexels* shared;
    TexelOptions options;
    ReflectanceOutcome& out;

    const TexelSolvers& solvers() const;
    TexelFitOptions fit_options() const;
};

struct Solver {
    const char* name;
    const char* help;
    /// A light field map: fills out.fit's parameters and problems, and out.times; none: it fits no such.
    void (*solve)(FitTask& task) = nullptr;
    std::optional<SolverFacts> facts = {};            ///< of solve
    void (*solve_texels)(TexelTask& task) = nullptr;  ///< a texel-local model; none: it fits no such
    std::optional<SolverFacts> texel_facts = {};      ///< of solve_texels
    int halo = 0;  ///< how far beyond a vertex's triangles its solution looks at samples: so many rings of them
    /// Bytes that a thread takes for the largest vertex, beyond parameters and samples; null: it holds no more.
    uint64_t (*vertex_bytes)(const FitRequest& request, const VertexShape& largest) = nullptr;
};
std::span<const Solver> solvers();
/// Throws UserError that lists the names there are.
const Solver& find_solver(const std::string& name);

void solve_stream(FitTask& task);
void solve_mean(FitTask& task);
void solve_two_step(FitTask& task);
void solve_ceres(FitTask& task);
void solve_als(FitTask& task);
void solve_varpro(FitTask& task);
void solve_pca(FitTask& task);
/// Of requests that differ in their refills alone, fewest first, from one resampling.
void solve_pca(std::span<FitTask* const> tasks);
void solve_texel_stream(TexelTask& task);
void solve_texel_two_step(TexelTask& task);
void solve_texel_ceres(TexelTask& task);
void solve_texel_ceres_varpro(TexelTask& task);
void solve_texel_tiny(TexelTask& task);
void solve_texel_tiny_pack(TexelTask& task);

/// Where optimizers begin [texels][parameters]: for every texel the best of the model's starts.
std::vector<float> starts_of(const TexelProblem& problem);

/// Fills what the fit's record says of its request.
void describe_request(const FitRequest& request, FitRecord& fit);

/// Around everything that a solver of records does: calls `write(folder)` where records are wanted and not there yet,
/// timed as distribution, then `read(folder)`. See FitRequest::records, scratch and cold.
void with_records(const Dataset& dataset, const FitRequest& request, FitTimes& times,
                  const std::function<void(const std::filesystem::path& folder)>& write,
                  const std::function<void(const std::filesystem::path& folder)>& read);
/// All that decides what records hold, if they are to stay; else empty. sides: the sides of surface maps, as the key
/// writes them.
std::string record_key(const Dataset& dataset, const FitRequest& request, const std::vector<uint32_t>& views,
                       const std::string& sides, const std::string& kind);
/// Drops records from the page cache if so requested, and notes how much of them is there.
void note_page_cache(const std::filesystem::path& records, const FitRequest& request, FitRun& run);

/// The context that a request names; `run` takes down what it is.
std::unique_ptr<Context> open_context(const FitRequest& request, FitRun& run);
/// Takes into `run` what an engine reports of its sweeps over images that stream. seconds: of all its work.
void take_sweeps(const SweepTimes& times, double seconds, const Dataset& dataset, FitRun& run);

/// For those that return problems' outcomes: E itself from E_t, and all that fit.json says of problems.
void fill_outcomes(FitTask& task, const LfmLayout& layout, const ProblemStatistics& statistics,
                   std::span<const ProblemOutcome> outcomes, std::vector<float> parameters);

/// The same of a solution vertex by vertex, with its trace.
void take_solution(FitTask& task, VertexSolution&& solution);

/// For solvers that return parameters only: fills the fit's problems (raw E, samples, the given status and iterations)
/// by evaluating the model once over the samples. Problems without samples say so whatever `status` is.
void fill_problems(FitTask& task, std::vector<float> parameters, Status status, uint32_t iterations);

}  // namespace radiafit::fits
