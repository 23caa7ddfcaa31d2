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
    uint64_t sample_iterations = 0, largest_working_set = 0;
    Worker(std::unique_ptr<VertexSource> s, const VertexProblem& fresh) : source(std::move(s)), problem(fresh) {}
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
    std::vector<TraceSum> traces((vertices + chunk - 1) / chunk);
    const auto end_of = [&](size_t c) { return std::min((c + 1) * chunk, vertices); };
    const auto fields = [&](auto& visit, size_t c) {
        const size_t begin = c * chunk, end = end_of(c), from = layout.offset(begin);
        visit(std::span(out.parameters).subspan(from, layout.offset(end) - from));
        visit(std::span(out.outcomes).subspan(3 * begin, 3 * (end - begin)));
        visit(traces[c].rows());
    };
    const auto solve = [&](size_t c, int worker) {
        auto& mine = workers[size_t(worker)];
        if (!mine) mine = std::make_unique<Worker>(sources(), fresh);
        const size_t begin = c * chunk, end = end_of(c);
        mine->source->begin(begin, end);
        for (size_t v = begin; v < end; ++v) {
            mine->source->load(v, mine->problem);
            mine->engine.count();
            const Trace trace = optimize_terms(mine->engine, options.optimizer, fresh.options().terms, options.deflate,
                                               {out.parameters.data() + layout.offset(v), layout.block_size(v)});
            mine->engine.outcomes({out.outcomes.data() + 3 * v, 3});
            traces[c].add(trace.rows);
            mine->sample_iterations += uint64_t(statistics.samples[v]) * uint64_t(trace.rows.back().iteration);
            mine->largest_working_set = std::max(mine->largest_working_set, mine->problem.working_set_bytes());
        }
    };
    finish_blocks(options.journal, traces.size(), fields, solve, [&](size_t c) {
        for (size_t v = c * chunk; progress && v < end_of(c); ++v) progress();
    });
    out.trace = sum_over_threads(traces, thread_count());
    for (const auto& worker : workers) {
        if (!worker) continue;
        out.sample_iterations += worker->sample_iterations;
        out.largest_working_set = std::max(out.largest_working_set, worker->largest_working_set);
    }
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
