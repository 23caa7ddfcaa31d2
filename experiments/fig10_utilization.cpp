// Figure 10 of the paper: the share of the device's peaks of arithmetic, memory traffic and texture reads that the
// fragment engines reach, by what their programs declare, how often they ran, and how long an iteration took.
#include <fmt/format.h>

#include "app/limits.h"
#include "base/error.h"
#include "base/file.h"
#include "base/log.h"
#include "cpu/peaks.h"
#include "dataset/dataset_json.h"
#include "experiment.h"
#include "gl/peaks.h"
#include "model/lfm_start.h"
#include "optim/optimizer.h"
#include "reflectance_problem.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

constexpr Range<int> timed_iterations{2, limits::iterations.upper, "the first is not timed"};

struct Options {
    std::string dataset = "star";
    std::vector<std::string> passes{"paper", "combined"};
    FitRequest request;
    ReflectanceProblem reflectance;

    explicit Options(Config& c) : reflectance(c) {
        request.set("mode", "paper");
        request.set("view", "nearest");
        request.set("source", "disk-cold");
        request.iterations = 5;
        c.read("dataset", dataset, [](const std::string& shape) {
            if (!shape.empty()) check_light_field_shape(shape);
        });
        read_maps(c, request.model);
        read_option(c, request, "source");
        c.read("passes", passes, valid_option("passes"));
        c.read("iterations", request.iterations, timed_iterations);
        c.finish();
    }
};

/// One iteration of one problem after the first: a direction and, but for steepest descent, a line.
struct Usage {
    std::string problem, optimizer, passes;
    std::map<std::string, PassTally> tallies = {};
    uint64_t cleared_bytes = 0;
    double seconds = 0;
    double cached_share = 0;  ///< of the pages of the images, where they come from disk

    Work work() const {
        Work sum;
        for (const auto& [label, tally] : tallies) sum += tally.work();
        return sum;
    }
    /// Asked of memory, however much of it caches serve.
    uint64_t bytes() const {
        uint64_t sum = work().read_bytes + cleared_bytes;
        for (const auto& [label, tally] : tallies) sum += tally.written_bytes + tally.blended_bytes;
        return sum;
    }
};

/// Counts the passes of one iteration, and times others.
template <Engine E>
void measure(E& engine, std::span<const float> start, OptimizerOptions optimizer, Usage& usage) {
    PassRunner& passes = engine.passes();
    OptimizerOptions two = optimizer;
    two.iterations = 2;
    engine.reset(start);
    optimize(engine, two, [&](int iteration) {
        if (iteration == 1) passes.tally(true);
    });
    passes.tally(false);
    usage.tallies = passes.tallies();
    usage.cleared_bytes = passes.cleared_bytes();
    for (const auto& [label, tally] : usage.tallies)
        if (!tally.cost)
            throw UserError(
                fmt::format("{} declares no cost in src/gl/pass_costs.cpp; choose a dataset with 8 bits a "
                            "channel",
                            label));
    engine.reset(start);
    const std::vector<TraceRow> rows = optimize(engine, optimizer).rows;
    usage.seconds = (rows.back().time_s - rows[1].time_s) / double(rows.size() - 2);
}

Usage light_field_map(const Dataset& dataset, FitRequest request, const char* optimizer, const std::string& passes) {
    request.set("optimizer", optimizer);
    request.set("passes", passes);
    const TriangleAtlas atlas(dataset.mesh, request.model.surface_side);
    const VertexRings rings(dataset.mesh);
    FragmentEngine engine(dataset, atlas, rings, dataset.split(false), request.model_options(),
                          request.fragment_options());
    const ProblemStatistics statistics = engine.count();
    Usage usage{.problem = "light field map", .optimizer = optimizer, .passes = passes};
    measure(engine, lfm_start(engine.layout(), statistics.mean, request.seed), request.optimizer_options(), usage);
    usage.cached_share = cached_share(dataset.folder / dataset_images_name);
    return usage;
}

Usage lafortune(const ReflectanceProblem& problem, FitRequest request, const char* optimizer,
                const std::string& passes) {
    request.set("optimizer", optimizer);
    request.set("passes", passes);
    const auto engine = problem.engine(request.fragment_options());
    Usage usage{.problem = "Lafortune", .optimizer = optimizer, .passes = passes};
    measure(*engine, engine->start(), request.optimizer_options(), usage);
    usage.cached_share = cached_share(problem.dataset().folder / dataset_images_name);
    return usage;
}

void write_passes(const ResultFolder& results, const std::vector<Usage>& usages) {
    CsvWriter rows(results.path() / "passes.csv",
                   {"problem", "optimizer", "passes", "program", "draws", "fragments", "entries", "operations", "reads",
                    "read_bytes", "written_bytes", "blended_bytes"});
    for (const Usage& u : usages)
        for (const auto& [label, t] : u.tallies) {
            const Work work = t.work();
            std::vector<std::string> row{u.problem, u.optimizer, u.passes, label};
            for (uint64_t value : {t.draws, t.fragments, t.entries, work.operations, work.reads, work.read_bytes,
                                   t.written_bytes, t.blended_bytes})
                row.push_back(std::to_string(value));
            rows.row(row);
        }
    rows.commit();
}

void write_peaks(const ResultFolder& results, const GlPeaks& gl, const CpuPeaks& cpu, const std::string& renderer,
                 const std::string& processor) {
    CsvWriter rows(results.path() / "peaks.csv", {"device", "peak", "per_second"});
    const auto row = [&](const std::string& device, const char* peak, double rate) {
        rows.row({device, peak, fmt::format("{:.4g}", rate)});
    };
    row(renderer, "operations of fragments", gl.operations_s);
    row(renderer, "texture reads", gl.reads_s);
    row(renderer, "bytes", gl.bytes_s);
    row(processor, "operations of one core", 1e9 * cpu.fma_gflop_s);
    row(processor, "bytes from one core's L2", 1e9 * cpu.l2_gb_s);
    row(processor, "bytes", 1e9 * cpu.triad_gb_s);
    rows.commit();
    log_info(fmt::format(
        "peaks of {}: {:.3g} G operations/s, {:.3g} G texture reads/s, {:.3g} GB/s; the CPU itself: "
        "{:.3g} G operations/s a core, {:.3g} GB/s",
        renderer, 1e-9 * gl.operations_s, 1e-9 * gl.reads_s, 1e-9 * gl.bytes_s, cpu.fma_gflop_s, cpu.triad_gb_s));
}

void fig10(Experiment& experiment) {
    Options o(experiment.config());
    const bool maps = !o.dataset.empty();
    const Dataset dataset = maps ? experiment.dataset(o.dataset) : Dataset();
    o.reflectance.open(experiment);
    const auto context = Context::create(o.request.context);
    const std::string renderer = context->renderer();
    note_gl(*context, experiment.record());
    const GlPeaks peaks = measure_gl_peaks();
    const CpuPeaks cpu = measure_cpu_peaks();

    std::vector<Usage> usages;
    for (const std::string& passes : o.passes)
        for (const char* optimizer : {"sd", "cg"})
            if (maps) usages.push_back(light_field_map(dataset, o.request, optimizer, passes));
    for (const std::string& passes : o.passes)
        for (const char* optimizer : {"sd", "cg"})
            usages.push_back(lafortune(o.reflectance, o.request, optimizer, passes));

    ResultFolder results = experiment.open_results(renderer);
    write_peaks(results, peaks, cpu, renderer, experiment.cpu_name());
    write_passes(results, usages);
    CsvWriter rows(results.path() / "utilization.csv",
                   {"problem", "optimizer", "passes", "computation_share", "bandwidth_share", "reads_share",
                    "operations", "bytes", "reads", "seconds_per_iteration", "source", "cached_share", "renderer"});
    Table table({"problem", "passes", "time per iteration", "computation", "memory bandwidth", "texture reads"});
    for (const Usage& u : usages) {
        const Work work = u.work();
        const double computation = double(work.operations) / u.seconds / peaks.operations_s;
        const double bandwidth = double(u.bytes()) / u.seconds / peaks.bytes_s;
        const double reads = double(work.reads) / u.seconds / peaks.reads_s;
        const auto share = [](double x) { return fmt::format("{:.5f}", x); };
        rows.row({u.problem, u.optimizer, u.passes, share(computation), share(bandwidth), share(reads),
                  std::to_string(work.operations), std::to_string(u.bytes()), std::to_string(work.reads),
                  fmt::format("{:.5g}", u.seconds), o.request.text("source"), share(u.cached_share), renderer});
        const auto percent = [](double x) { return fmt::format("{:.1f} %", 100 * x); };
        table.add({fmt::format("{}, {}", u.problem, u.optimizer), u.passes, fmt::format("{:.3f} s", u.seconds),
                   percent(computation), percent(bandwidth), percent(reads)});
    }
    rows.commit();
    results.commit();
    log_info("share of the measured peaks\n" + table.text());
    experiment.draw(
        results, fmt::format("{}{} ({} scale), images from {}; {}", maps ? dataset.name + " and " : "",
                             o.reflectance.dataset().name, experiment.profile(), o.request.text("source"), renderer));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("fig10_utilization", argc, argv, radiafit::fig10); }
