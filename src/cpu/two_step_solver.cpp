#include "cpu/two_step_solver.h"

#include <memory>

#include "base/clock.h"
#include "base/parallel.h"
#include "cpu/lfm_engine.h"
#include "model/lfm_start.h"

namespace radiafit {
namespace {

constexpr size_t chunk = 16;  ///< vertices read in one piece

struct Worker {
    VertexProblem problem;
    LaneEngine<VertexProblem> engine{problem};
    std::vector<uint8_t> blocks;
    double read_s = 0;
    uint64_t bytes_read = 0, sample_iterations = 0, largest_working_set = 0;
    explicit Worker(VertexProblem p) : problem(std::move(p)) {}
};

}  // namespace

TwoStepResult solve_two_step(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const DiskRecords& records, const LfmOptions& options, const TwoStepOptions& two_step,
                             const std::function<void()>& progress) {
    const LfmLayout layout(rings, atlas, options.view_side, options.terms);
    const size_t vertices = layout.problem_count();
    TwoStepResult out;
    for (size_t v = 0; v < vertices; ++v) {
        out.statistics.samples.push_back(records.vertex(v).samples);
        out.statistics.mean.insert(out.statistics.mean.end(), records.vertex(v).mean, records.vertex(v).mean + 3);
    }
    out.parameters = lfm_start(layout, out.statistics.mean, two_step.seed);
    out.outcomes.resize(3 * vertices);

    const VertexProblem fresh(dataset, atlas, rings, records, options);
    std::vector<std::unique_ptr<Worker>> workers{size_t(thread_count())};
    std::vector<TraceSum> traces((vertices + chunk - 1) / chunk);
    parallel_for(traces.size(), 1, [&](size_t c, int worker) {
        if (!workers[size_t(worker)]) workers[size_t(worker)] = std::make_unique<Worker>(fresh);
        Worker& w = *workers[size_t(worker)];
        const size_t begin = c * chunk, end = std::min(begin + chunk, vertices);
        Stopwatch reading;
        records.read(begin, end, w.blocks);
        w.read_s += reading.wall_s();
        w.bytes_read += w.blocks.size();
        const uint8_t* block = w.blocks.data();
        for (size_t v = begin; v < end; block += records.block_bytes(v), ++v) {
            w.problem.load(v, block);
            w.engine.count();
            const Trace trace = optimize_terms(w.engine, two_step.optimizer, options.terms, two_step.deflate,
                                               {out.parameters.data() + layout.offset(v), layout.block_size(v)});
            w.engine.outcomes({out.outcomes.data() + 3 * v, 3});
            traces[c].add(trace.rows);
            w.sample_iterations += uint64_t(records.vertex(v).samples) * uint64_t(trace.rows.back().iteration);
            w.largest_working_set = std::max(w.largest_working_set, w.problem.working_set_bytes());
            if (progress) progress();
        }
    });

    TraceSum sum;
    for (const TraceSum& trace : traces) sum.add(trace.rows());  // in the order of chunks, whoever solved them
    out.trace.rows = sum.rows();
    const double threads = thread_count();
    for (TraceRow& row : out.trace.rows) row.time_s /= threads;
    for (const auto& w : workers) {
        if (!w) continue;
        out.read_s += w->read_s / threads;
        out.bytes_read += w->bytes_read;
        out.sample_iterations += w->sample_iterations;
        out.largest_working_set = std::max(out.largest_working_set, w->largest_working_set);
    }
    return out;
}

}  // namespace radiafit
