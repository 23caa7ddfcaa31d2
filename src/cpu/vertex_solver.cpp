#include "cpu/vertex_solver.h"

#include "base/parallel.h"
#include "cpu/lfm_engine.h"
#include "cpu/ring_samples.h"
#include "model/lfm_start.h"

namespace radiafit {
namespace {

constexpr size_t chunk = 16;  ///< vertices that a thread takes at a time

struct Worker {
    std::unique_ptr<VertexSource> source;
    VertexProblem problem;
    LaneEngine<VertexProblem> engine{problem};
    Worker(std::unique_ptr<VertexSource> s, const VertexProblem& fresh) : source(std::move(s)), problem(fresh) {}
};

/// Of a chunk, besides its part of the solution.
struct Chunk {
    TraceSum trace;
    uint64_t sample_iterations = 0, largest_working_set = 0;
};

class ListSource final : public VertexSource {
public:
    ListSource(const SampleList& samples, const std::vector<float>& means) : samples_(&samples), means_(&means) {}
    void load(size_t v, VertexProblem& problem) override { problem.load(v, *samples_, means_->data() + 3 * v); }

private:
    const SampleList* samples_;
    const std::vector<float>* means_;
};

}  // namespace

VertexSolution solve_vertices(const LfmLayout& layout, ProblemStatistics statistics, const VertexProblem& fresh,
                              const VertexSolverOptions& options,
                              const std::function<std::unique_ptr<VertexSource>()>& sources,
                              const std::function<void()>& progress) {
    const size_t vertices = layout.problem_count();
    VertexSolution out;
    out.parameters = lfm_start(layout, statistics.mean, options.seed);
    out.outcomes.resize(3 * vertices);
    std::vector<std::unique_ptr<Worker>> workers{size_t(thread_count())};
    std::vector<Chunk> chunks((vertices + chunk - 1) / chunk);
    const auto solve = [&](Chunk& its, Worker& mine, size_t begin, size_t end) {
        mine.source->begin(begin, end);
        for (size_t v = begin; v < end; ++v) {
            mine.source->load(v, mine.problem);
            mine.engine.count();
            const Trace trace = optimize_terms(mine.engine, options.optimizer, fresh.options().terms, options.deflate,
                                               {out.parameters.data() + layout.offset(v), layout.block_size(v)});
            mine.engine.outcomes({out.outcomes.data() + 3 * v, 3});
            its.trace.add(trace.rows);
            its.sample_iterations += uint64_t(statistics.samples[v]) * uint64_t(trace.rows.back().iteration);
            its.largest_working_set = std::max(its.largest_working_set, mine.problem.working_set_bytes());
        }
    };
    parallel_for(chunks.size(), 1, [&](size_t c, int worker) {
        const size_t begin = c * chunk, end = std::min(begin + chunk, vertices);
        const auto fields = [&](auto& visit) {
            const size_t from = layout.offset(begin), last = end - 1;
            visit(std::span(out.parameters).subspan(from, layout.offset(last) + layout.block_size(last) - from));
            visit(std::span(out.outcomes).subspan(3 * begin, 3 * (end - begin)));
            visit(chunks[c].trace.rows());
            visit(chunks[c].sample_iterations);
            visit(chunks[c].largest_working_set);
        };
        once(options.journal.get(), c, fields, [&] {
            auto& mine = workers[size_t(worker)];
            if (!mine) mine = std::make_unique<Worker>(sources(), fresh);
            solve(chunks[c], *mine, begin, end);
        });
        for (size_t v = begin; progress && v < end; ++v) progress();
    });
    std::vector<TraceSum> traces;
    for (Chunk& c : chunks) {
        traces.push_back(std::move(c.trace));
        out.sample_iterations += c.sample_iterations;
        out.largest_working_set = std::max(out.largest_working_set, c.largest_working_set);
    }
    out.trace = sum_over_threads(traces, thread_count());
    out.statistics = std::move(statistics);
    return out;
}

VertexSolution solve_vertices(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                              const SampleList& samples, const LfmOptions& model, const VertexSolverOptions& options,
                              const std::function<void()>& progress) {
    const ProblemStatistics statistics = count_rings(rings, samples, TargetWeights<float>(atlas, samples.scale));
    return solve_vertices(
        LfmLayout(rings, atlas, model.view_side, model.terms), statistics,
        VertexProblem(dataset, atlas, rings, samples.views, model), options,
        [&] { return std::make_unique<ListSource>(samples, statistics.mean); }, progress);
}

uint64_t vertex_solver_bytes(size_t texels, size_t samples, int terms, const Room& room) {
    constexpr size_t sample = sizeof(Lanes<float>) + sizeof(uint32_t);
    return LaneEngine<VertexProblem>::bytes(texels * uint64_t(terms), 1, room) + samples * sample;
}

}  // namespace radiafit
