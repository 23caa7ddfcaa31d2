// Figure 10 of the paper: the share of the device's peaks of arithmetic, memory traffic and texture reads that the
// fragment engines reach, by what their programs declare, how often they ran, and how long an iteration took. The same
// counts say what penalties cost, and are those that a model of the paper's chip starts from.
#include "rows/fig10_utilization.h"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/log.h"
#include "base/statistics.h"
#include "base/time_limit.h"
#include "bench/bundle.h"
#include "cpu/peaks.h"
#include "dataset/dataset_json.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fragment/peaks.h"
#include "iteration_time.h"
#include "model/lfm_start.h"
#include "reflectance_problem.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::fig10_utilization;

struct Options {
    std::string dataset = "star";
    std::vector<std::string> passes{"paper", "combined"};
    std::string storage = "fp32";  ///< of parameters; where it is another, the first passes are timed in 32 bits, too
    int repetitions = 9;
    FitRequest request;
    ReflectanceProblem reflectance;

    explicit Options(Config& c) : reflectance(c) {
        request.set("mode", "paper");
        request.set("view", "nearest");
        request.set("source", "disk-cold");
        c.read("dataset", dataset, [](const std::string& shape) {
            if (!shape.empty()) check_light_field_shape(shape);
        });
        read_maps(c, request.model);
        read_option(c, request, "source");
        c.read("passes", passes, valid_option("passes"));
        c.read("storage", storage, valid_option("storage"));
        c.read("repetitions", repetitions, limits::repetitions);
        c.finish();
    }
};

/// What one iteration after the first asks of the device. Steepest descent: a direction; conjugate gradients: a line
/// and a direction.
struct Usage {
    std::string optimizer = {};
    std::map<std::string, PassTally> tallies = {};
    uint64_t cleared_bytes = 0, switches = 0;
    uint64_t image_bytes = 0;  ///< streamed
    /// Operations of the passes that only penalties need; and of those that they share with the gradient's last step.
    uint64_t penalty_operations = 0, shared_operations = 0;

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

/// One problem with one kind of passes.
struct Contest {
    std::string problem, passes;
    std::function<IterationTime()> iterate;  ///< by an engine that has begun its fit
    std::vector<Usage> usages = {};          ///< [optimizer]
    std::vector<IterationTime> times = {};   ///< [repetition]
};

struct Peaks {
    GlPeaks gl;
    CpuPeaks cpu;
};

/// Of what body issues.
template <class E, class Body>
Usage tally(E& engine, const Body& body) {
    const IterationCounts counts = count_passes(engine, body);
    return {.tallies = counts.tallies, .cleared_bytes = engine.passes().cleared_bytes(), .switches = counts.switches};
}

/// Programs that compute penalties alone; the gradient's last step adds them to the sums over samples.
bool is_penalty(const std::string& label) {
    return label.starts_with("optimize/laplacian") || label.starts_with("optimize/penalty") ||
           label.starts_with("reflect/penalty");
}
bool is_last_step(const std::string& label) {
    return label.starts_with("optimize/gradient") || label.starts_with("reflect/gradient");
}

/// The engine has begun its iterations. image_bytes: of one sweep.
template <class E>
std::vector<Usage> count_usages(E& engine, uint64_t image_bytes) {
    // Penalties are gathered as a dot product is, by the same passes.
    const Usage dot = tally(engine, [&] { engine.dot({{vector::d, vector::d, vector::none, PRODUCT_NORM}}); });
    uint64_t gather = 0;
    for (const auto& [label, tally] : dot.tallies)
        if (!label.starts_with("optimize/dot")) gather += tally.work().operations;
    std::vector<Usage> usages;
    for (const std::string optimizer : optimizer_names) {
        const int sweeps = is_descent(optimizer) ? 1 : 2;
        const ConjugateGradients& schedule = is_descent(optimizer) ? paper_descent : paper_gradients;
        Usage usage = tally(engine, [&] {
            schedule.move(engine, 1);
            schedule.judge(engine, 1);
        });
        usage.optimizer = optimizer;
        usage.image_bytes = uint64_t(sweeps) * image_bytes;
        usage.penalty_operations = uint64_t(sweeps) * gather;
        for (const auto& [label, tally] : usage.tallies) {
            if (is_penalty(label)) usage.penalty_operations += tally.work().operations;
            if (is_last_step(label)) usage.shared_operations += tally.work().operations;
        }
        usages.push_back(std::move(usage));
    }
    return usages;
}

uint64_t image_bytes(const Dataset& dataset, const std::vector<uint32_t>& views) {
    uint64_t bytes = 0;
    for (const uint32_t v : views) bytes += pixel_bytes(dataset.views[v].camera, dataset.encoding);
    return bytes;
}

template <class E>
Contest contest(const char* problem, const FitRequest& request, std::shared_ptr<E> engine, std::span<const float> start,
                const Dataset& dataset, const std::vector<uint32_t>& views) {
    start_iterations(*engine, start);
    return {.problem = problem,
            .passes = to_string(request.passes),
            .iterate = [engine, images = dataset.folder / dataset_images_name,
                        source = request.source] { return time_iteration(*engine, images, source); },
            .usages = count_usages(*engine, image_bytes(dataset, views))};
}

Contest light_field_map(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                        const FitRequest& request) {
    const std::vector<uint32_t> views = dataset.split(false);
    const auto engine = std::make_shared<FragmentEngine>(dataset, atlas, rings, views, request.model_options(),
                                                         request.fragment_options());
    const ProblemStatistics statistics = engine->count();
    return contest("light field map", request, engine, lfm_start(engine->layout(), statistics.mean, request.seed),
                   dataset, views);
}

Contest lafortune(const ReflectanceProblem& problem, const FitRequest& request) {
    const std::shared_ptr<TexelFragmentEngine> engine = problem.engine(request.fragment_options());
    return contest("Lafortune", request, engine, engine->start(), problem.dataset(), problem.views());
}

void write_passes(const ResultFolder& results, const std::vector<Contest>& contests) {
    CsvFile rows(results.path(), rows::passes);
    for (const Contest& c : contests)
        for (const Usage& u : c.usages)
            for (const auto& [label, t] : u.tallies) {
                const Work work = t.work();
                rows.add({c.problem, u.optimizer, c.passes, label, t.draws, t.fragments, t.entries, work.operations,
                          work.reads, work.read_bytes, t.written_bytes, t.blended_bytes});
            }
    rows.commit();
}

/// Sums over an iteration's passes.
void write_work(const ResultFolder& results, const std::vector<Contest>& contests) {
    CsvFile rows(results.path(), rows::work);
    for (const Contest& c : contests)
        for (const Usage& u : c.usages) {
            const Work work = u.work();
            rows.add({c.problem, u.optimizer, c.passes, work.operations, work.reads, u.bytes(), u.switches,
                      u.image_bytes, u.penalty_operations, u.shared_operations});
        }
    rows.commit();
}

void write_iterations(const ResultFolder& results, const std::vector<Contest>& contests) {
    CsvFile rows(results.path(), rows::iterations);
    for (const Contest& c : contests)
        for (const std::string optimizer : optimizer_names)
            for (size_t r = 0; r < c.times.size(); ++r) {
                const HalfTime time = c.times[r].of(is_descent(optimizer));
                rows.add({c.problem, optimizer, c.passes, r, time.seconds, time.penalties, c.times[r].cached_share});
            }
    rows.commit();
}

void write_peaks(const ResultFolder& results, const std::vector<Peaks>& peaks, const std::string& renderer,
                 const std::string& processor) {
    CsvFile rows(results.path(), rows::peaks);
    for (size_t r = 0; r < peaks.size(); ++r) {
        const auto row = [&](const std::string& device, const char* peak, double rate) {
            rows.add({device, peak, r, rate});
        };
        const auto& [gl, cpu] = peaks[r];
        row(renderer, "operations of fragments", gl.operations_s);
        row(renderer, "texture reads", gl.reads_s);
        row(renderer, "bytes", gl.bytes_s);
        row(processor, "operations of one core", 1e9 * cpu.fma_gflop_s);
        row(processor, "bytes from one core's L2", 1e9 * cpu.l2_gb_s);
        row(processor, "bytes", 1e9 * cpu.triad_gb_s);
    }
    rows.commit();
}

/// The bars: medians over the repetitions, each by the peaks of its own round, and their 95 % intervals where there are
/// enough repetitions for one.
void write_utilization(const ResultFolder& results, const std::vector<Contest>& contests,
                       const std::vector<Peaks>& peaks, const FitRequest& request, const std::string& renderer) {
    CsvFile rows(results.path(), rows::utilization);
    Table table({"problem", "passes", "time per iteration", "computation", "memory bandwidth", "texture reads"});
    for (const Contest& c : contests)
        for (const Usage& u : c.usages) {
            std::vector<double> seconds, computation, bandwidth, reads;
            for (size_t r = 0; r < c.times.size(); ++r) {
                const double s = c.times[r].of(is_descent(u.optimizer)).seconds;
                seconds.push_back(s);
                computation.push_back(double(u.work().operations) / s / peaks[r].gl.operations_s);
                bandwidth.push_back(double(u.bytes()) / s / peaks[r].gl.bytes_s);
                reads.push_back(double(u.work().reads) / s / peaks[r].gl.reads_s);
            }
            const auto ends = [](const std::vector<double>& x) { return ends_of(median_interval(x, x.size())); };
            const IntervalEnds c_ends = ends(computation), b_ends = ends(bandwidth), r_ends = ends(reads);
            rows.add({c.problem, u.optimizer, c.passes, median(computation), c_ends.low, c_ends.high, median(bandwidth),
                      b_ends.low, b_ends.high, median(reads), r_ends.low, r_ends.high, median(seconds), seconds.size(),
                      request.text("source"), renderer});
            const auto percent = [](const std::vector<double>& x) { return fmt::format("{:.1f} %", 100 * median(x)); };
            table.add({fmt::format("{}, {}", c.problem, u.optimizer), c.passes,
                       fmt::format("{:.3f} s", median(seconds)), percent(computation), percent(bandwidth),
                       percent(reads)});
        }
    rows.commit();
    log_info("share of the measured peaks\n" + table.text());
}

void fig10(Experiment& experiment) {
    Options o(experiment.config());
    const bool maps = !o.dataset.empty();
    const Dataset dataset = maps ? experiment.dataset(o.dataset) : Dataset();
    o.reflectance.open(experiment);
    const auto context = Context::create(o.request.context);
    const std::string renderer = context->renderer();
    note_gl(*context, experiment.record());
    std::optional<TriangleAtlas> atlas;
    std::optional<VertexRings> rings;
    if (maps) {
        atlas.emplace(dataset.mesh, o.request.model.surface_side);
        rings.emplace(dataset.mesh);
    }

    std::vector<Contest> contests;
    const auto add = [&](const std::string& passes, const std::string& storage) {
        o.request.set("passes", passes);
        o.request.set("storage", storage);
        const size_t before = contests.size();
        if (maps) contests.push_back(light_field_map(dataset, *atlas, *rings, o.request));
        contests.push_back(lafortune(o.reflectance, o.request));
        for (size_t i = before; storage != o.storage && i < contests.size(); ++i) contests[i].passes += " in 32 bits";
    };
    for (const std::string& passes : o.passes) add(passes, o.storage);
    if (o.storage != "fp32") add(o.passes.front(), "fp32");
    std::vector<Peaks> peaks;
    for (int r = 0; another_round(r, o.repetitions); ++r) {
        peaks.push_back({measure_gl_peaks(), measure_cpu_peaks()});
        for (Contest& c : contests) c.times.push_back(c.iterate());
        log_info(fmt::format("repetition {} of {}", r + 1, o.repetitions));
    }

    ResultFolder results = experiment.open_results(renderer);
    write_peaks(results, peaks, renderer, experiment.cpu_name());
    write_passes(results, contests);
    write_work(results, contests);
    write_iterations(results, contests);
    write_utilization(results, contests, peaks, o.request, renderer);
    const bool cold = o.request.source == ImageSource::disk_cold;
    experiment.finish(
        results, fmt::format("stand-ins: {}{} images of the {} ({} scale); images from {} in every sweep; {} "
                             "repetitions; {} on {}",
                             maps ? "all of the " + dataset.name + " and " : "", o.reflectance.images(),
                             o.reflectance.dataset().name, experiment.profile(),
                             cold ? "disk, not in the page cache," : o.request.text("source"), o.repetitions, renderer,
                             experiment.cpu_device()));
}

}  // namespace

int fig10_utilization(int argc, const char* const* argv) {
    return run_experiment("fig10_utilization", argc, argv, fig10);
}

}  // namespace radiafit::harness
