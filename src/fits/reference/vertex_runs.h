#pragma once
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/clock.h"
#include "optim/trace.h"
#include "reference/lfm_vertex.h"

/// Solvers that take one vertex after another, and how each went.
namespace radiafit::fits {

/// One vertex's three problems. Row 0 is the start.
struct VertexRun {
    struct Channel {
        std::vector<double> error;   ///< [rows] E_t
        std::vector<double> time_s;  ///< [rows] since the solver got the problem
        Status status = Status::no_samples;
        uint32_t iterations() const { return error.empty() ? 0 : uint32_t(error.size() - 1); }
        /// First row with an error of at most `level`; -1 if none.
        int first_below(double level) const;
    };
    Channel channel[3];
    bool joint = false;               ///< the channels went side by side on one clock, not one after another
    double setup_s = 0;               ///< spent before: building the solver's structures
    double (*clock)() = wall_time_s;  ///< what times are taken with

    /// Seconds until all channels had done `rows` rows, or as many as they have; set-up not counted.
    double time_at(int row) const { return time_at({row, row, row}); }
    double time_at(const std::array<int, 3>& rows) const;
};

/// The error at which a problem of the vertex may stop: rule 1 of Section 5.3.2. stop_residual: root mean square; 0 =
/// off.
double enough_error(const LfmVertex& vertex, double stop_residual);

/// Writes a run whose channels go side by side. Made when the solver gets the vertex: its clock starts then.
class JointRows {
public:
    JointRows(const LfmVertex& vertex, double stop_residual, VertexRun& run);

    /// Row 0.
    void begin(const Lanes<double>& error);
    /// A further row; ends the channel where the error is small enough.
    void add(int c, double error);
    /// Ends channels whose last row's error is small enough.
    void end_where_enough();
    void end(int c, Status why) { run_->channel[c].status = why; }
    /// Channels still active have used up their iterations.
    void finish();

    double error(int c) const { return run_->channel[c].error.back(); }  ///< of the last row
    bool active(int c) const { return run_->channel[c].status == Status::active; }
    bool any_active() const { return active(0) || active(1) || active(2); }

private:
    void write(int c, double error);

    VertexRun* run_;
    double enough_, start_;
};

struct RunsResult {
    std::vector<float> parameters;  ///< [layout.size()]
    std::vector<VertexRun> runs;    ///< [vertices]
};

/// Improves p (a vertex's block, lanes) from the start and says how it went.
using VertexSolver = std::function<void(const LfmVertex& vertex, std::span<Lanes<double>> p, VertexRun& run)>;

/// Throws UserError for the paper's bounds penalty, which is no sum of squares; `solver` is the name users know.
void require_modern_penalty(const LfmOptions& model, const char* solver);

/// From lfm_start(seed), every vertex with samples, or the chosen ones; the others keep the start. Threads over
/// vertices.
RunsResult solve_vertices(const LfmVertices& vertices, uint64_t seed, const VertexSolver& solver,
                          const std::vector<uint32_t>* chosen = nullptr);

/// Row k: the sum of E_t after k iterations of every problem, and the time to it summed over vertices, set-up included,
/// divided by the number of threads.
Trace trace_of(std::span<const VertexRun> runs, int threads);

}  // namespace radiafit::fits
