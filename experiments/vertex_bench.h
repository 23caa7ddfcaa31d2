#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/atomic_file.h"
#include "base/range.h"
#include "cpu/lfm_engine.h"
#include "experiment.h"
#include "fitting/solvers/solver.h"
#include "reference/lfm_vertex.h"

/// Light field maps vertex by vertex: optimizer after optimizer on the same samples, start and objective, which is the
/// paper's. What the experiments on convergence share.
namespace radiafit::harness {

/// How a vertex's three problems went; row 0 is the start.
struct Course {
    std::vector<std::array<double, 3>> errors;  ///< E_t after each iteration; it never rises
    std::array<double, 3> end;                  ///< E_t of what was returned
    /// Whether the problem came to rest before its iterations were over: E_t fell by less than a millionth in
    /// rest_iterations, or the optimizer found nothing more to do.
    std::array<bool, 3> at_rest = {};
    std::array<int, 3> stopped_at = {-1, -1, -1};  ///< the first row without the problem; -1: it ran on

    int iterations() const { return int(errors.size()) - 1; }
    double error(int iteration, size_t channel) const {
        return errors[size_t(std::min(iteration, iterations()))][channel];
    }
    /// First row, of those up to `last`, with an error of at most `level`; -1 if none.
    int first_below(double level, size_t channel, int last) const;
};

constexpr int rest_iterations = 200;

constexpr Range<int> drawn_vertices{0, 1'000'000'000, "0 is all"};

/// 0 to `last`, the later ones ever sparser: rows of a curve over a logarithmic axis.
std::vector<int> sparse_iterations(int last);

/// The vertex that a worker thread has loaded.
class BenchVertex {
public:
    BenchVertex(const VertexProblem& fresh, const TriangleAtlas& atlas, const VertexRings& rings,
                const LfmVertices& gatherer, const LfmOptions& model)
        : problem_(fresh), atlas_(&atlas), rings_(&rings), gatherer_(&gatherer), model_(model) {}
    BenchVertex(const BenchVertex&) = delete;
    BenchVertex& operator=(const BenchVertex&) = delete;

    /// block: its record; start: its part of lfm_start.
    void load(uint32_t vertex, const DiskRecords& records, const uint8_t* block, std::span<const float> start);
    uint32_t id() const { return id_; }
    /// Ends when all three problems have come to rest or have been stopped, or after options.iterations.
    Course optimize(const OptimizerOptions& options) { return optimize(options, start_); }
    /// The same from where the last run ended.
    Course go_on(const OptimizerOptions& options);
    /// Newton's steps on the view map, the surface maps in closed form. The solver needs the modern penalty for bounds:
    /// `errors` are of that objective, `end` is of the paper's.
    Course varpro(int iterations);
    /// Root mean square of Lambda over the vertex's samples: what a pixel's residual weighs in the problem's.
    double rms_weight();

private:
    Course optimize(const OptimizerOptions& options, std::span<const float> from);
    const LfmVertex& gathered();

    VertexProblem problem_;
    LaneEngine<VertexProblem> engine_{problem_};
    const TriangleAtlas* atlas_;
    const VertexRings* rings_;
    const LfmVertices* gatherer_;
    LfmOptions model_;
    uint32_t id_ = 0;
    std::span<const float> start_;
    LfmVertex gathered_;
    bool is_gathered_ = false;
};

/// A dataset's training photographs, distributed to vertices.
class VertexBench {
public:
    /// maps: sides. vertices: how many take part, drawn by seed; 0: all that have samples.
    VertexBench(const Dataset& dataset, const LfmOptions& maps, int vertices, int seed);

    const std::vector<uint32_t>& seen() const { return seen_; }  ///< vertices that take part, ascending
    /// Places in seen() of `count` vertices drawn by seed, or of all if they are fewer; ascending.
    std::vector<size_t> draw(size_t count, uint64_t seed) const;
    /// body(place in seen(), vertex) for all of them in the paper's mode with this lambda, threads over vertices.
    void for_each(double lambda, const std::string& task,
                  const std::function<void(size_t i, BenchVertex& vertex)>& body) const;

private:
    const Dataset* dataset_;
    FitRequest request_;
    TriangleAtlas atlas_;
    VertexRings rings_;
    SharedSamples samples_;
    AtomicFolder folder_;
    std::optional<DiskRecords> records_;
    std::vector<uint32_t> seen_;
};

}  // namespace radiafit::harness
