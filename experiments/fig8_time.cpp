// Figure 8 of the paper: the time of the CPU baseline, distribution and optimization, against OpenGL's, image
// streaming, computation and switching; conjugate gradients and steepest descent in the paper's mode.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "app/limits.h"
#include "base/error.h"
#include "base/log.h"
#include "experiment.h"
#include "model/lfm_start.h"
#include "report/csv.h"
#include "report/table.h"

namespace radiafit {
namespace {

struct Options {
    std::string dataset = "star";
    int record_iterations = 100, repetitions = 1;
    FitRequest request;

    explicit Options(Config& c) {
        request.set("mode", "paper");
        request.set("view", "nearest");
        request.set("source", "disk-cold");
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, request.model);
        c.read("iterations", request.iterations, limits::some_iterations);
        c.read("record_iterations", record_iterations, limits::some_iterations);
        read_option(c, request, "source");
        c.read("repetitions", repetitions, limits::repetitions);
        c.finish();
    }
};

/// One bar. Seconds; what the parts leave of the total is the remainder.
struct Bar {
    std::string method, optimizer = {}, renderer = {};
    int iterations = 0;
    double distribution = 0, streaming = 0, computation = 0, switching = 0, total = 0;
    double cached_share = 0;                    ///< of the pages that were read from disk
    double error = 0;                           ///< sum of E_t at the end
    std::vector<double> vertex_error = {};      ///< E of each vertex, its three problems together
    std::vector<uint32_t> samples = {};         ///< of each vertex
    std::optional<double> agreeing_share = {};  ///< of the vertices, with the cpu engine's ends
    uint64_t bytes_written = 0, bytes_read = 0;
    double remainder() const { return total - distribution - streaming - computation - switching; }
};

/// What every method tells of its end.
void fill_end(Bar& bar, const FitOutcome& out) {
    bar.total = out.times.total;
    bar.error = out.trace.rows.back().error;
    bar.vertex_error.assign(out.fit.error.size() / 3, 0.0);
    bar.samples.resize(bar.vertex_error.size());
    for (size_t v = 0; v < bar.samples.size(); ++v) bar.samples[v] = out.fit.samples[3 * v];
    for (size_t i = 0; i < out.fit.error.size(); ++i) bar.vertex_error[i / 3] += double(out.fit.error[i]);
}

/// Agree before you time: throws SystemError unless both end at the same error, and fills the share of vertices with
/// samples that do within a relative 1e-4.
void check_end(Bar& bar, const Bar& expected) {
    if (!(std::abs(bar.error - expected.error) <= 5e-3 * expected.error))
        throw SystemError(
            fmt::format("{} and {} disagree: {:.6g}, {:.6g}", bar.method, expected.method, bar.error, expected.error));
    // A handful of samples can be fitted exactly: what is left then is rounding, which nobody can agree on. An error
    // counts as no less than that of residuals of one rounding of white.
    constexpr double rounding = 0x1p-24;
    size_t agreeing = 0, seen = 0;
    for (size_t v = 0; v < bar.vertex_error.size(); ++v) {
        if (bar.samples[v] == 0) continue;
        const double least = 0.5 * 3 * bar.samples[v] * rounding * rounding;
        const double error = expected.vertex_error[v];
        agreeing += std::abs(bar.vertex_error[v] - error) <= 1e-4 * std::max(error, least);
        ++seen;
    }
    bar.agreeing_share = double(agreeing) / double(seen);
}

/// The cpu engine over a sample list in memory: no bar of the figure, but the others must end where it does. Which
/// pixel a texel takes can differ between the distributors, so each has its own.
Bar cpu_engine(const Dataset& dataset, FitRequest request, const std::string& distributor) {
    request.set("source", "memory");
    request.set("distributor", distributor);
    Bar bar{.method = "cpu engine (samples by " + distributor + ")"};
    fill_end(bar, solve(dataset, request));
    return bar;
}

Bar two_step(const Dataset& dataset, FitRequest request, const std::string& record, const std::string& cpu) {
    request.solver = "two-step";
    request.set("record", record);
    request.cold = request.source == ImageSource::disk_cold;
    request.scratch = dataset.folder.parent_path();  // a disk, which the system's temporary folder need not be
    const FitOutcome out = solve(dataset, request);
    Bar bar{.method = "two-step (" + record + " record)", .optimizer = request.text("optimizer"), .renderer = cpu};
    bar.iterations = request.iterations;
    bar.distribution = out.times.distribution;
    bar.streaming = out.times.streaming;
    bar.computation = out.times.optimization;
    fill_end(bar, out);
    bar.cached_share = out.record_cached_share;
    bar.bytes_written = out.records.bytes_written;
    bar.bytes_read = out.record_bytes_read;
    return bar;
}

/// Seconds per image of the commands alone: the same sweeps, cut to one texel. The first of each also compiles.
struct Switching {
    double direction = 1e9, line = 1e9;
};
Switching switching_of(const Dataset& dataset, const FitRequest& request) {
    const auto context = Context::create(request.context);
    const TriangleAtlas atlas(dataset.mesh, request.model.surface_side);
    const VertexRings rings(dataset.mesh);
    FragmentOptions options = request.fragment_options();
    options.source = StreamSource::memory;
    options.scissored = true;
    FragmentEngine engine(dataset, atlas, rings, dataset.split(false), request.model_options(), options);
    const ProblemStatistics statistics = engine.count();
    engine.reset(lfm_start(engine.layout(), statistics.mean, 1));
    const auto per_image = [&](const auto& sweep) {
        const FragmentTimes before = engine.times();
        sweep();
        const FragmentTimes& after = engine.times();
        const double streaming = after.stream_s - before.stream_s + after.upload_s - before.upload_s;
        return (after.sweep_s - before.sweep_s - streaming) / double(after.images - before.images);
    };
    Switching least;
    for (int i = 0; i < 4; ++i) {
        least.direction = std::min(least.direction, per_image([&] { engine.gradient_pass(false); }));
        least.line = std::min(least.line, per_image([&] { engine.directional_pass(); }));
    }
    return least;
}

Bar fragment(Record& record, const Dataset& dataset, FitRequest request, const std::string& passes) {
    request.set("engine", "fragment");
    request.set("passes", passes);
    const Switching switching = switching_of(dataset, request);
    const FitOutcome out = solve(dataset, request);
    note_gl(out, record);
    Bar bar{.method = "OpenGL (" + passes + " passes)",
            .optimizer = request.text("optimizer"),
            .renderer = out.gl_renderer};
    bar.iterations = request.iterations;
    bar.streaming = out.times.streaming;
    // one sweep of lines for each iteration, but one alone for steepest descent; one of directions more than iterations
    const double images = double(out.sweeps.images) / double(out.sweeps.sweeps);
    const int lines = request.optimizer->lines ? request.iterations : 1;
    bar.switching = images * (switching.direction * (request.iterations + 1) + switching.line * lines);
    bar.computation = out.times.optimization - bar.switching;
    if (bar.computation < 0) {  // measured apart, on a machine that was busy then
        log_info(fmt::format("{}: switching alone took {:.2f} s, the whole {:.2f} s; run it again on an idle machine",
                             bar.method, bar.switching, out.times.optimization));
        bar.switching = out.times.optimization;
        bar.computation = 0;
    }
    fill_end(bar, out);
    bar.cached_share = out.images_cached_share;
    return bar;
}

/// The run with the median total of several.
template <class Run>
Bar median_of(int repetitions, const Run& run) {
    std::vector<Bar> bars;
    for (int i = 0; i < repetitions; ++i) bars.push_back(run());
    std::sort(bars.begin(), bars.end(), [](const Bar& a, const Bar& b) { return a.total < b.total; });
    return bars[bars.size() / 2];
}

void fig8(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const std::string cpu = experiment.cpu_name();
    std::vector<Bar> bars, records;
    for (const char* optimizer : {"cg", "sd"}) {
        FitRequest request = o.request;
        request.set("optimizer", optimizer);
        const auto measured = [&](const auto& run) {
            Bar bar = median_of(o.repetitions, run);
            log_info(fmt::format("{}, {}, {} iterations: {:.2f} s", bar.method, optimizer, bar.iterations, bar.total));
            return bar;
        };
        const Bar by_cpu = cpu_engine(dataset, request, "cpu"), by_gl = cpu_engine(dataset, request, "gl");
        for (const char* record : {"full", "compact"}) {
            bars.push_back(measured([&] { return two_step(dataset, request, record, cpu); }));
            check_end(bars.back(), by_cpu);
        }
        for (const char* passes : {"paper", "combined"}) {
            bars.push_back(measured([&] { return fragment(experiment.record(), dataset, request, passes); }));
            check_end(bars.back(), by_gl);
        }
        if (o.record_iterations == request.iterations) continue;  // the bars say it
        request.iterations = o.record_iterations;
        for (const char* record : {"full", "compact"})
            records.push_back(measured([&] { return two_step(dataset, request, record, cpu); }));
    }

    const std::string renderer = bars.back().renderer;
    ResultFolder results = experiment.open_results(renderer);
    CsvWriter rows(results.path() / "times.csv",
                   {"part", "method", "optimizer", "iterations", "distribution_s", "streaming_s", "computation_s",
                    "switching_s", "remainder_s", "total_s", "cached_share", "error", "agreeing_share", "bytes_written",
                    "bytes_read", "source", "renderer"});
    Table table({"method", "iterations", "distribution", "streaming, reading", "computation", "switching", "remainder",
                 "total", "same end"});
    const auto write = [&](const char* part, const Bar& b) {
        const auto s = [](double x) { return fmt::format("{:.4f}", x); };
        rows.row({part, b.method, b.optimizer, std::to_string(b.iterations), s(b.distribution), s(b.streaming),
                  s(b.computation), s(b.switching), s(b.remainder()), s(b.total), s(b.cached_share),
                  fmt::format("{:.8g}", b.error), b.agreeing_share ? s(*b.agreeing_share) : "",
                  std::to_string(b.bytes_written), std::to_string(b.bytes_read), o.request.text("source"), b.renderer});
        const auto seconds = [](double x) { return fmt::format("{:.2f} s", x); };
        table.add({fmt::format("{}, {}", b.method, b.optimizer), std::to_string(b.iterations), seconds(b.distribution),
                   seconds(b.streaming), seconds(b.computation), seconds(b.switching), seconds(b.remainder()),
                   seconds(b.total), b.agreeing_share ? fmt::format("{:.1f} %", 100 * *b.agreeing_share) : ""});
    };
    for (const Bar& bar : bars) write("figure", bar);
    for (const Bar& bar : records) write("record", bar);
    rows.commit();
    results.commit();
    log_info("where the time goes\n" + table.text());
    experiment.draw(results, fmt::format("{} ({} scale), {} iterations; OpenGL: {}; CPU: {}", dataset.name,
                                         experiment.profile(), o.request.iterations, renderer, cpu));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("fig8_time", argc, argv, radiafit::fig8); }
