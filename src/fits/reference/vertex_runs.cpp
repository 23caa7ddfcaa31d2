#include "reference/vertex_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/wording.h"
#include "model/lfm_start.h"

namespace radiafit::fits {

int VertexRun::Channel::first_below(double level) const {
    const auto found = std::find_if(error.begin(), error.end(), [&](double e) { return e <= level; });
    return found == error.end() ? -1 : int(found - error.begin());
}

double VertexRun::time_at(const std::array<int, 3>& rows) const {
    double sum = 0, longest = 0;
    for (int c = 0; c < 3; ++c) {
        const Channel& one = channel[c];
        if (one.time_s.empty()) continue;
        const double time = one.time_s[std::min(size_t(rows[size_t(c)]), one.time_s.size() - 1)];
        sum += time;
        longest = std::max(longest, time);
    }
    return joint ? longest : sum;
}

double enough_error(const LfmVertex& vertex, double stop_residual) {
    return 0.5 * double(vertex.surface_texels()) * stop_residual * stop_residual;
}

JointRows::JointRows(const LfmVertex& vertex, double stop_residual, VertexRun& run)
    : run_(&run), enough_(enough_error(vertex, stop_residual)), start_(run.clock()) {
    run.joint = true;
}

void JointRows::begin(const Lanes<double>& error) {
    for (int c = 0; c < 3; ++c) {
        end(c, std::isfinite(error[c]) ? Status::active : Status::not_finite);
        write(c, error[c]);
    }
}

void JointRows::add(int c, double error) {
    write(c, error);
    if (error <= enough_) end(c, Status::residual);
}

void JointRows::end_where_enough() {
    for (int c = 0; c < 3; ++c)
        if (error(c) <= enough_) end(c, Status::residual);
}

void JointRows::write(int c, double error) {
    run_->channel[c].error.push_back(error);
    run_->channel[c].time_s.push_back(run_->clock() - start_);
}

void JointRows::finish() {
    for (int c = 0; c < 3; ++c)
        if (active(c)) end(c, Status::max_iterations);
}

void require_modern_penalty(const LfmOptions& model, const char* solver) {
    if (model.mode == Mode::paper && model.mu > 0)
        throw UserError(fmt::format(
            "solver '{}' minimizes sums of squares, and the paper's bounds penalty is none; choose {} modern, or {} 0",
            solver, option_name("mode"), option_name("mu")));
}

RunsResult solve_vertices(const LfmVertices& vertices, uint64_t seed, const VertexSolver& solver,
                          const std::vector<uint32_t>* chosen) {
    const LfmLayout& layout = vertices.layout();
    const ProblemStatistics& statistics = vertices.statistics();
    RunsResult out{lfm_start(layout, statistics.mean, seed), std::vector<VertexRun>(layout.problem_count())};
    parallel_for(chosen ? chosen->size() : layout.problem_count(), 1, [&](size_t i, int) {
        const size_t v = chosen ? (*chosen)[i] : i;
        if (statistics.samples[v] == 0) return;
        LfmVertex vertex;
        vertices.gather(v, vertex);
        float* block = &out.parameters[layout.offset(v)];
        std::vector<Lanes<double>> p(vertex.size());
        for (size_t j = 0; j < p.size(); ++j)
            for (int c = 0; c < 4; ++c) p[j][c] = double(block[4 * j + size_t(c)]);
        solver(vertex, p, out.runs[v]);
        for (size_t j = 0; j < p.size(); ++j)
            for (int c = 0; c < 4; ++c) block[4 * j + size_t(c)] = float(p[j][c]);
    });
    return out;
}

Trace trace_of(std::span<const VertexRun> runs, int threads) {
    size_t rows = 0;
    for (const VertexRun& run : runs)
        for (const auto& c : run.channel) rows = std::max(rows, c.error.size());
    Trace trace;
    for (size_t k = 0; k < rows; ++k) {
        TraceRow row{.iteration = int(k)};
        for (const VertexRun& run : runs) {
            row.time_s += (run.setup_s + run.time_at(int(k))) / threads;
            for (const auto& c : run.channel) {
                if (c.error.empty()) continue;
                const size_t last = std::min(k, c.error.size() - 1);
                row.error += c.error[last];
                row.accepted += k == last && (k == 0 || c.error[k] < c.error[k - 1]);
                row.active += k + 1 < c.error.size();
            }
        }
        trace.rows.push_back(row);
    }
    return trace;
}

}  // namespace radiafit::fits
