// Figure 8 of the paper: the time of the CPU baseline, distribution and optimization, against OpenGL's, image
// streaming, computation and switching; conjugate gradients and steepest descent in the paper's mode. Every round runs
// each contestant once, so that what slows the machine for a while meets all.
#include "rows/fig8_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "base/time_limit.h"
#include "bench/bundle.h"
#include "dataset/dataset_json.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fragment/fragment_engine.h"
#include "iteration_time.h"
#include "model/lfm_start.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::fig8_time;

constexpr const char *paper_passes = "OpenGL (paper passes)", *compact_record = "two-step (compact record)";
constexpr Range<double> budget_seconds{0, 1e6};
/// The time of an iteration is measured on those after the first.
constexpr Range<int> iterations_after_the_first{2, limits::iterations.upper, "the first is not timed"};

struct Options {
    std::string dataset = "star";
    std::vector<int> share_iterations{25, 100};
    int repetitions = 9, software_iterations = 2, limited_iterations = 3;
    double software_seconds = 45;
    std::string storage = "fp32";  ///< of OpenGL's parameters; where it is another, 32 bits are timed beside
    FitRequest request;

    explicit Options(Config& c) {
        request.set("mode", "paper");
        request.set("view", "nearest");
        request.set("source", "disk-cold");
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, request.model);
        c.read("iterations", request.iterations, iterations_after_the_first);
        c.read("share_iterations", share_iterations, limits::some_iterations);
        read_option(c, request, "source");
        c.read("storage", storage, valid_option("storage"));
        c.read("repetitions", repetitions, limits::repetitions);
        c.read("software_iterations", software_iterations, iterations_after_the_first);
        c.read("limited_iterations", limited_iterations, iterations_after_the_first);
        c.read("software_seconds", software_seconds, budget_seconds);
        c.finish();
    }
    /// That OpenGL's whole fits run.
    int opengl_iterations(bool software) const {
        const int most = software ? software_iterations : time_is_limited() ? limited_iterations : request.iterations;
        return std::min(most, request.iterations);
    }
};

/// Ends of whole fits.
struct End {
    double error = 0;                       ///< sum of E_t
    std::vector<double> vertex_error = {};  ///< E of each vertex, its three problems together
    std::vector<uint32_t> samples = {};     ///< of each vertex
};

End end_of(const FitOutcome& out) {
    End end{.error = out.trace.rows.back().error};
    end.vertex_error.assign(out.fit.error.size() / 3, 0.0);
    end.samples.resize(end.vertex_error.size());
    for (size_t v = 0; v < end.samples.size(); ++v) end.samples[v] = out.fit.samples[3 * v];
    for (size_t i = 0; i < out.fit.error.size(); ++i) end.vertex_error[i / 3] += double(out.fit.error[i]);
    return end;
}

/// Agree before you time: throws SystemError unless both end at the same error; the share of vertices with samples that
/// do within a relative 1e-4.
double agreeing_share(const std::string& name, const End& end, const End& expected) {
    if (!(std::abs(end.error - expected.error) <= 5e-3 * expected.error))
        throw SystemError(
            fmt::format("{} and the cpu engine disagree: {:.6g}, {:.6g}", name, end.error, expected.error));
    // A handful of samples can be fitted exactly: what is left then is rounding, which nobody can agree on. An error
    // counts as no less than that of residuals of one rounding of white.
    constexpr double rounding = 0x1p-24;
    size_t agreeing = 0, seen = 0;
    for (size_t v = 0; v < end.vertex_error.size(); ++v) {
        if (end.samples[v] == 0) continue;
        const double least = 0.5 * 3 * end.samples[v] * rounding * rounding;
        const double error = expected.vertex_error[v];
        agreeing += std::abs(end.vertex_error[v] - error) <= 1e-4 * std::max(error, least);
        ++seen;
    }
    return double(agreeing) / double(seen);
}

/// The cpu engine over a sample list in memory: no bar of the figure, but the others must end where it does. Which
/// pixel a texel takes can differ between the distributors, so each has its own.
End cpu_engine(const Dataset& dataset, FitRequest request, const std::string& distributor) {
    request.set("source", "memory");
    request.set("distributor", distributor);
    return end_of(solve(dataset, request));
}

/// One kind of OpenGL's passes, as rows name it.
struct Passes {
    std::string name, passes, storage;
    int images_per_pass = 0;  ///< 0: as many as the passes take
};

/// image_by_image: and combined passes one image at a time, of which single iterations alone are timed.
std::vector<Passes> passes_of(const Options& o, bool image_by_image) {
    std::vector<Passes> all = {{paper_passes, "paper", o.storage}};
    if (image_by_image) all.push_back({"OpenGL (combined passes, image by image)", "combined", o.storage, 1});
    all.push_back({"OpenGL (combined passes)", "combined", o.storage});
    if (o.storage != "fp32") all.push_back({"OpenGL (paper passes in 32 bits)", "paper", "fp32"});
    return all;
}

/// Whole fits by one contestant, [run].
struct Runs {
    std::string method, optimizer;
    int threads = 0, iterations = 0;
    std::optional<double> agreeing = {};  ///< share of the vertices, with the cpu engine's ends
    double error = 0;
    uint64_t bytes_written = 0, bytes_read = 0;  ///< of the two-step solver's records
    std::vector<int> rounds = {};                ///< that it ran in: others had no time for it
    std::vector<FitTimes> times = {};
    std::vector<double> iteration_s = {};   ///< of OpenGL: an iteration's time, by those after the first
    std::vector<double> cached_share = {};  ///< of the pages that were read from disk

    std::string name() const {
        return fmt::format("{}, {}, {} threads, {} iterations", method, optimizer, threads, iterations);
    }
    /// Seconds of that many iterations, [run].
    std::vector<double> totals(int of_iterations) const {
        std::vector<double> out;
        for (size_t r = 0; r < times.size(); ++r)
            out.push_back(times[r].total + (iteration_s.empty() ? 0.0 : (of_iterations - iterations) * iteration_s[r]));
        return out;
    }
};

void run_two_step(Runs& runs, const Dataset& dataset, FitRequest request, const std::string& record,
                  const std::optional<End>& expected) {
    request.solver = "two-step";
    request.set("optimizer", runs.optimizer);
    request.set("record", record);
    request.iterations = runs.iterations;
    request.cold = request.source == ImageSource::disk_cold;
    request.scratch = dataset.folder.parent_path();  // a disk, which the system's temporary folder need not be
    const int threads = thread_count();
    set_thread_count(runs.threads);
    const FitOutcome out = solve(dataset, request);
    set_thread_count(threads);
    const End end = end_of(out);
    if (expected) runs.agreeing = agreeing_share(runs.name(), end, *expected);
    runs.error = end.error;
    runs.bytes_written = out.records.bytes_written;
    runs.bytes_read = out.record_bytes_read;
    runs.times.push_back(out.times);
    runs.cached_share.push_back(out.record_cached_share);
}

void run_opengl(Runs& runs, const Dataset& dataset, FitRequest request, const Passes& passes, const End& expected) {
    request.set("optimizer", runs.optimizer);
    request.set("engine", "fragment");
    request.set("passes", passes.passes);
    request.set("storage", passes.storage);
    request.iterations = runs.iterations;
    const FitOutcome out = solve(dataset, request);
    const End end = end_of(out);
    runs.agreeing = agreeing_share(runs.name(), end, expected);
    runs.error = end.error;
    runs.times.push_back(out.times);
    const std::vector<TraceRow>& rows = out.trace.rows;
    runs.iteration_s.push_back((rows.back().time_s - rows[1].time_s) / double(rows.size() - 2));
    runs.cached_share.push_back(out.images_cached_share);
}

/// A solver that runs whole fits; run() adds a repetition.
struct Contestant {
    Runs runs;
    bool opengl;
    std::function<void(Runs&)> run;
    double seconds = 0;  ///< of its last run, agreement included

    /// Whether it is in every round even where time is limited: what claim C3 compares round by round, but for the CPU
    /// on one thread, which can take longer than all others together. So a limited run can refute the claim, and not
    /// confirm it.
    bool compared() const {
        return opengl ? runs.method == paper_passes
                      : runs.method == compact_record && runs.threads == thread_count() && runs.agreeing.has_value();
    }
};

/// Single iterations of one kind of passes: as they are; and cut to one texel, which leaves the commands alone.
class Iterations {
public:
    Iterations(const Passes& passes, const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
               FitRequest request)
        : name(passes.name), images_(dataset.folder / dataset_images_name), source_(request.source) {
        request.set("passes", passes.passes);
        request.set("storage", passes.storage);
        const auto make = [&](bool scissored) {
            request.set("source", scissored ? "device" : request.text("source"));
            FragmentOptions options = request.fragment_options();
            options.scissored = scissored;
            options.images_per_pass = passes.images_per_pass;
            auto engine = std::make_unique<FragmentEngine>(dataset, atlas, rings, dataset.split(false),
                                                           request.model_options(), options);
            const ProblemStatistics statistics = engine->count();
            start_iterations(*engine, lfm_start(engine->layout(), statistics.mean, request.seed));
            return engine;
        };
        whole_ = make(false);
        scissored_ = make(true);
    }

    void run() {
        times.push_back(time_iteration(*whole_, images_, source_));
        const IterationTime cut = time_iteration(*scissored_, images_, ImageSource::device);
        line_switching.push_back(cut.line.sweep);
        direction_switching.push_back(cut.direction.sweep);
    }
    double switching(size_t r, bool descent) const {
        return direction_switching[r] + (descent ? 0 : line_switching[r]);
    }
    IterationCounts count(bool descent) { return count_iteration(*whole_, descent); }

    std::string name;
    std::vector<IterationTime> times = {};                              ///< [repetition]
    std::vector<double> line_switching = {}, direction_switching = {};  ///< [repetition] seconds

private:
    std::filesystem::path images_;
    ImageSource source_;
    std::unique_ptr<FragmentEngine> whole_, scissored_;
};

void write_repetitions(const ResultFolder& results, const std::vector<Contestant>& all) {
    CsvFile rows(results.path(), rows::repetitions);
    for (const Contestant& c : all) {
        const Runs& runs = c.runs;
        for (size_t r = 0; r < runs.times.size(); ++r) {
            const FitTimes& t = runs.times[r];
            const double iteration =
                runs.iteration_s.empty() ? t.optimization / double(runs.iterations) : runs.iteration_s[r];
            rows.add({runs.method, runs.optimizer, runs.threads, runs.iterations, size_t(runs.rounds[r]),
                      t.distribution, t.streaming, t.optimization, t.total, iteration, runs.error,
                      runs.cached_share[r]});
        }
    }
    rows.commit();
}

void write_iterations(const ResultFolder& results, const std::vector<Iterations>& all) {
    CsvFile rows(results.path(), rows::iterations);
    for (const Iterations& one : all)
        for (const std::string optimizer : optimizer_names)
            for (size_t r = 0; r < one.times.size(); ++r) {
                const HalfTime time = one.times[r].of(is_descent(optimizer));
                rows.add({one.name, optimizer, r, time.seconds, time.streaming, one.switching(r, is_descent(optimizer)),
                          one.times[r].cached_share});
            }
    rows.commit();
}

void write_work(const ResultFolder& results, std::vector<Iterations>& all) {
    CsvFile rows(results.path(), rows::work);
    for (Iterations& one : all)
        for (const std::string optimizer : optimizer_names) {
            const IterationCounts counts = one.count(is_descent(optimizer));
            rows.add({one.name, optimizer, counts.work.operations, counts.work.reads, counts.draws, counts.switches});
        }
    rows.commit();
}

/// The parts of a fit of so many iterations. Seconds; what they leave of the total is the remainder.
struct Bar {
    double distribution = 0, streaming = 0, computation = 0, switching = 0, total = 0;
    double remainder() const { return total - distribution - streaming - computation - switching; }
};

/// The bar of the run with the median total.
Bar two_step_bar(const Runs& runs) {
    std::vector<FitTimes> times = runs.times;
    const auto middle = times.begin() + long(times.size() / 2);
    std::ranges::nth_element(times, middle, {}, &FitTimes::total);
    return {.distribution = middle->distribution,
            .streaming = middle->streaming,
            .computation = middle->optimization,
            .total = middle->total};
}

/// A direction more than iterations; a line for each, but one alone for steepest descent. What these sweeps leave of
/// the total: counting samples, passes over maps, and making it all ready.
Bar opengl_bar(const Runs& runs, int iterations, const Iterations& one) {
    const double directions = iterations + 1, lines = is_descent(runs.optimizer) ? 1 : iterations;
    const auto of_rounds = [&](const auto& seconds) {  // of those that it ran in
        std::vector<double> all;
        for (const int round : runs.rounds) all.push_back(seconds(size_t(round)));
        return median(all);
    };
    const auto sum = [&](double HalfTime::*part) {
        return of_rounds(
            [&](size_t r) { return directions * one.times[r].direction.*part + lines * one.times[r].line.*part; });
    };
    Bar bar{.streaming = sum(&HalfTime::streaming), .total = median(runs.totals(iterations))};
    bar.switching =
        of_rounds([&](size_t r) { return directions * one.direction_switching[r] + lines * one.line_switching[r]; });
    // timed apart, which may be at a slower time
    bar.computation = std::max(0.0, std::min(sum(&HalfTime::sweep), bar.total) - bar.streaming - bar.switching);
    return bar;
}

std::vector<Contestant> contestants(const Options& o, const Dataset& dataset, bool software) {
    std::vector<Contestant> out;
    const int opengl_iterations = o.opengl_iterations(software);
    const int most = thread_count();
    for (const char* optimizer : {"cg", "sd"}) {
        FitRequest request = o.request;
        request.set("optimizer", optimizer);
        const End by_cpu = cpu_engine(dataset, request, "cpu");
        const auto two_step = [&](const std::string& record, int threads, int iterations, std::optional<End> expected) {
            out.push_back({{.method = "two-step (" + record + " record)",
                            .optimizer = optimizer,
                            .threads = threads,
                            .iterations = iterations},
                           false,
                           [&dataset, request, record, expected](Runs& runs) {
                               run_two_step(runs, dataset, request, record, expected);
                           }});
        };
        for (const char* record : {"full", "compact"})
            for (const int threads : std::set{1, most}) two_step(record, threads, request.iterations, by_cpu);
        for (const int iterations : o.share_iterations)
            if (iterations != request.iterations) two_step("full", most, iterations, {});
        request.iterations = opengl_iterations;
        const End by_gl = cpu_engine(dataset, request, "gl");
        for (const Passes& passes : passes_of(o, false))
            out.push_back(
                {{.method = passes.name, .optimizer = optimizer, .threads = most, .iterations = opengl_iterations},
                 true,
                 [&dataset, request, passes, by_gl](Runs& runs) {
                     run_opengl(runs, dataset, request, passes, by_gl);
                 }});
    }
    return out;
}

void write_times(const ResultFolder& results, const Options& o, const std::vector<Contestant>& all,
                 const std::vector<Iterations>& iterations, const std::string& cpu, const std::string& renderer) {
    CsvFile rows(results.path(), rows::times);
    Table table({"method", "threads", "distribution", "streaming, reading", "computation", "switching", "remainder",
                 "total", "same end"});
    for (const Contestant& c : all) {
        const Runs& runs = c.runs;
        if (!runs.agreeing) continue;  // no bar: of other iterations, for claim C4
        const auto own = std::ranges::find(iterations, runs.method, &Iterations::name);
        const Bar bar = c.opengl ? opengl_bar(runs, o.request.iterations, *own) : two_step_bar(runs);
        const std::vector<double> totals = runs.totals(o.request.iterations);
        const auto [low, high] = ends_of(median_interval(totals, totals.size()));
        rows.add({runs.method,
                  runs.optimizer,
                  runs.threads,
                  o.request.iterations,
                  runs.iterations,
                  bar.distribution,
                  bar.streaming,
                  bar.computation,
                  bar.switching,
                  bar.remainder(),
                  bar.total,
                  low,
                  high,
                  totals.size(),
                  runs.error,
                  *runs.agreeing,
                  runs.bytes_written,
                  runs.bytes_read,
                  o.request.text("source"),
                  c.opengl ? renderer : cpu});
        const auto seconds = [](double x) { return fmt::format("{:.2f} s", x); };
        table.add({fmt::format("{}, {}", runs.method, runs.optimizer), std::to_string(runs.threads),
                   seconds(bar.distribution), seconds(bar.streaming), seconds(bar.computation), seconds(bar.switching),
                   seconds(bar.remainder()), seconds(bar.total), fmt::format("{:.1f} %", 100 * *runs.agreeing)});
    }
    rows.commit();
    log_info(fmt::format("where the time of {} iterations goes\n{}", o.request.iterations, table.text()));
}

void fig8(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const TriangleAtlas atlas(dataset.mesh, o.request.model.surface_side);
    const VertexRings rings(dataset.mesh);
    const auto context = Context::create(o.request.context);
    note_gl(*context, experiment.record());
    const bool software = context->software();
    if (!software && o.opengl_iterations(software) < o.request.iterations) note_rounds_left_out();
    std::vector<Contestant> all = contestants(o, dataset, software);
    context->make_current();
    std::vector<Iterations> iterations;
    for (const Passes& passes : passes_of(o, true)) iterations.emplace_back(passes, dataset, atlas, rings, o.request);

    double opengl_seconds = 0, iterations_seconds = 0;
    const auto least_seconds = [&] {  // of a round
        double seconds = iterations_seconds;
        for (const Contestant& c : all)
            if (c.compared() && !(software && c.opengl)) seconds += c.seconds;
        return seconds;
    };
    for (int r = 0; another_round(r, o.repetitions, r > 0 ? std::optional(least_seconds()) : std::nullopt); ++r) {
        std::vector<Contestant*> candidates;
        for (Contestant& c : all)
            if (!c.opengl || !software || r == 0 || opengl_seconds < o.software_seconds) candidates.push_back(&c);
        const double seconds = r == 0 ? std::numeric_limits<double>::infinity()
                                      : seconds_left() / (o.repetitions - r) - iterations_seconds;
        std::vector<InRound> turns;
        for (const Contestant* c : candidates) turns.push_back({c->compared(), c->seconds});
        const std::vector<bool> chosen = those_in_time(turns, seconds);
        std::vector<Contestant*> running;
        for (size_t i = 0; i < candidates.size(); ++i)
            if (chosen[i]) running.push_back(candidates[i]);
        if (running.size() < candidates.size()) note_rounds_left_out();
        for (Contestant* c : running) {
            const Stopwatch clock;
            c->runs.rounds.push_back(r);
            c->run(c->runs);
            c->seconds = clock.wall_s();
            if (c->opengl) opengl_seconds += c->runs.times.back().total;
        }
        context->make_current();
        const Stopwatch clock;
        for (Iterations& one : iterations) one.run();
        iterations_seconds = clock.wall_s();
        log_info(fmt::format(
            "repetition {} of {}{}", r + 1, o.repetitions,
            running.size() == all.size()
                ? ""
                : fmt::format(": {} of {} solvers, and OpenGL's single iterations", running.size(), all.size())));
    }

    ResultFolder results = experiment.open_results(context->renderer());
    write_repetitions(results, all);
    write_iterations(results, iterations);
    write_work(results, iterations);
    write_times(results, o, all, iterations, experiment.cpu_name(), context->renderer());
    const int ran = all.back().runs.iterations;
    experiment.finish(results,
                      fmt::format("{} stand-in ({} scale), {} iterations{}; CPU: {}; OpenGL: {}", dataset.name,
                                  experiment.profile(), o.request.iterations,
                                  ran == o.request.iterations ? "" : fmt::format(" (OpenGL: reckoned from {})", ran),
                                  experiment.cpu_device(), context->renderer()));
}

}  // namespace

int fig8_time(int argc, const char* const* argv) { return run_experiment("fig8_time", argc, argv, fig8); }

}  // namespace radiafit::harness
