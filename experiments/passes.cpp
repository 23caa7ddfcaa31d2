// From the paper's passes to samples in the CPU's caches, step by step (Sections 6.5 and 6.6): what an image and a
// sweep over it cost where passes write to one target each, then to several, over several images at a time, in compute
// shaders, and on the CPU; with samples found again in every sweep, and kept. All steps by turns in one run.
#include "rows/passes.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <memory>

#include "base/clock.h"
#include "base/error.h"
#include "base/log.h"
#include "base/statistics.h"
#include "base/time_limit.h"
#include "bench/bundle.h"
#include "compute/compute_engine.h"
#include "cpu/lfm_engine.h"
#include "cpu/vertex_solver.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fragment/fragment_engine.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "iteration_time.h"
#include "model/lfm_start.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::passes;

struct Options {
    std::string dataset = "star";
    int images = 20, rounds = 9, cached_iterations = 10, solved_iterations = 25;
    FitRequest request;

    explicit Options(Config& c) {
        request.set("mode", "paper");
        c.read("dataset", dataset, check_light_field_shape);
        read_maps(c, request.model);
        c.read("images", images, limits::repetitions);
        c.read("rounds", rounds, limits::repetitions);
        c.read("cached_iterations", cached_iterations, limits::some_iterations);
        c.read("solved_iterations", solved_iterations, limits::some_iterations);
        c.finish();
    }
};

constexpr int sweeps_per_iteration = 2;  // a line and a gradient

/// One step of the ladder.
struct Step {
    std::string name;
    bool on_cpu;
    std::function<double()> iterate;  ///< seconds of an iteration, which has two sweeps over the images
    double error = 0;                 ///< sum of E_t at the start
    std::vector<double> seconds = {};
};

class Ladder {
public:
    Ladder(const Dataset& dataset, const Options& o)
        : dataset_(dataset),
          o_(o),
          views_(spread_views(dataset.split(false), o.images)),
          rings_(dataset.mesh),
          atlas_(dataset.mesh, o.request.model.surface_side),
          model_(o.request.model_options()),
          samples_(distribute(dataset, atlas_, o.request, views_)) {}

    void add_fragment(const std::string& name, const std::string& passes, int images_per_pass) {
        FitRequest request = o_.request;
        request.set("passes", passes);
        FragmentOptions options = request.fragment_options();
        options.images_per_pass = images_per_pass;
        options.keep_on_device = true;
        add_opengl(name, std::make_shared<FragmentEngine>(dataset_, atlas_, rings_, views_, model_, options), 1);
    }
    void add_redistributing(const std::string& name, Accumulate accumulate) {
        add_opengl(name,
                   std::make_shared<ComputeEngine>(dataset_, atlas_, rings_, views_, model_,
                                                   StreamOptions{.keep_on_device = true}, accumulate),
                   1);
    }
    void add_cached(const std::string& name, Accumulate accumulate) {
        add_opengl(name, std::make_shared<ComputeEngine>(dataset_, atlas_, rings_, samples_.list, model_, accumulate),
                   o_.cached_iterations);
    }
    /// Distributes all images before each sweep, as every other thread of this program would.
    void add_cpu(bool redistributes) {
        const auto problem = std::make_shared<LfmProblem<float>>(dataset_, atlas_, rings_, samples_.list, model_);
        const auto engine = std::make_shared<StreamEngine<float>>(*problem);
        const std::vector<float> first = lfm_start(problem->layout(), engine->count().mean, o_.request.seed);
        Step& step = add(redistributes ? "CPU, redistributing" : "CPU, cached samples", true, *engine, first);
        step.iterate = [this, problem, engine, first, redistributes] {
            start_iterations(*engine, first);  // again: a problem that has stopped would be skipped
            double seconds = seconds_per_iteration(*engine, o_.cached_iterations);
            for (int sweep = 0; redistributes && sweep < sweeps_per_iteration; ++sweep)
                seconds += distribute(dataset_, atlas_, o_.request, views_).seconds;
            return seconds;
        };
    }

    /// As `fit` does on the CPU: one vertex after another to its end, the loading of its samples included.
    void add_solver() {
        FitRequest request = o_.request;
        request.iterations = o_.solved_iterations;
        const auto solve = [this, options = request.vertex_solver_options()] {
            return solve_vertices(dataset_, atlas_, rings_, samples_.list, model_, options);
        };
        const double error = solve().trace.rows.front().error;
        steps_.push_back({"CPU, cached samples, vertex by vertex", true,
                          [this, solve] {
                              const Stopwatch clock;
                              solve();
                              return clock.wall_s() / o_.solved_iterations;
                          },
                          error});
    }

    /// Agree before you time: throws SystemError unless all begin with the same error. The rasterizers differ in some
    /// pixels at edges.
    void check() const {
        for (const Step& step : steps_)
            if (!(std::abs(step.error / steps_.front().error - 1) < 0.01))
                throw SystemError(fmt::format("{}: error {:.6g}, {}: {:.6g}", step.name, step.error,
                                              steps_.front().name, steps_.front().error));
    }
    /// All by turns: what slows the machine for a while meets all of them.
    void run() {
        Progress progress("rounds", size_t(o_.rounds));
        for (int round = 0; another_round(round, o_.rounds); ++round, progress.advance())
            for (Step& step : steps_) step.seconds.push_back(step.iterate());
    }
    const std::vector<Step>& steps() const { return steps_; }
    size_t images() const { return views_.size(); }
    uint64_t samples() const { return samples_.list.samples.size(); }

private:
    template <class E>
    void add_opengl(const std::string& name, const std::shared_ptr<E>& engine, int iterations) {
        const std::vector<float> first = lfm_start(engine->layout(), engine->count().mean, o_.request.seed);
        add(name, false, *engine, first).iterate = [engine, first, iterations] {
            start_iterations(*engine, first);
            return seconds_per_iteration(*engine, iterations);
        };
    }
    template <class E>
    Step& add(const std::string& name, bool on_cpu, E& engine, const std::vector<float>& first) {
        start_iterations(engine, first);
        return steps_.emplace_back(Step{name, on_cpu, {}, engine.summary().error});
    }

    const Dataset& dataset_;
    const Options& o_;
    std::vector<uint32_t> views_;
    VertexRings rings_;
    TriangleAtlas atlas_;
    LfmOptions model_;
    SharedSamples samples_;
    std::vector<Step> steps_;
};

/// For one image in one sweep.
double milliseconds(const Step& step, size_t round, size_t images) {
    return 1e3 * step.seconds[round] / (sweeps_per_iteration * double(images));
}

void write_rows(const ResultFolder& results, const Ladder& ladder, const std::string& gl, const std::string& cpu) {
    CsvFile rounds(results.path(), rows::rounds);
    CsvFile ladder_rows(results.path(), rows::ladder);
    Table table({"step", "ms per image and sweep", "95 % interval", "over the step before", "over the first"});
    for (size_t i = 0; i < ladder.steps().size(); ++i) {
        const Step& step = ladder.steps()[i];
        const std::string renderer = step.on_cpu ? cpu : gl;
        std::vector<double> ms, over_previous, over_first;
        for (size_t round = 0; round < step.seconds.size(); ++round) {
            ms.push_back(milliseconds(step, round, ladder.images()));
            over_previous.push_back(ms.back() / milliseconds(ladder.steps()[i ? i - 1 : 0], round, ladder.images()));
            over_first.push_back(ms.back() / milliseconds(ladder.steps().front(), round, ladder.images()));
            rounds.add({i, step.name, round, ladder.images(), ladder.samples(), ms.back(), renderer});
        }
        const auto [low, high] = ends_of(median_interval(ms, ms.size()));
        const auto number = [](double x) { return fmt::format("{:.4g}", x); };
        ladder_rows.add({i, step.name, median(ms), low, high, median(over_previous), median(over_first), renderer});
        table.add({step.name, number(median(ms)), low ? number(*low) + " to " + number(*high) : "too few rounds",
                   number(median(over_previous)), number(median(over_first))});
    }
    rounds.commit();
    ladder_rows.commit();
    log_info("from the paper's passes to cached samples\n" + table.text());
}

void measure(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const auto context = Context::create(o.request.context);
    note_gl(*context, experiment.record());
    Ladder ladder(dataset, o);
    ladder.add_fragment("the paper's passes", "paper", 0);
    ladder.add_fragment("combined passes, image by image", "combined", 1);
    ladder.add_fragment("combined passes, several images", "combined", 0);
    ladder.add_redistributing("compute, redistributing, gather", Accumulate::gather);
    ladder.add_redistributing("compute, redistributing, scatter", Accumulate::scatter_fixed);
    ladder.add_cached("compute, cached samples, scatter", Accumulate::scatter_fixed);
    ladder.add_cached("compute, cached samples, gather", Accumulate::gather);
    ladder.add_cpu(true);
    ladder.add_cpu(false);
    ladder.add_solver();
    ladder.check();
    ladder.run();
    ResultFolder results = experiment.open_results(context->renderer());
    write_rows(results, ladder, context->renderer(), experiment.cpu_name());
    const Camera& camera = dataset.views.front().camera;
    experiment.finish(
        results, fmt::format("{} images of {} x {} of the {} stand-in ({} scale), {} rounds; OpenGL: {}; "
                             "CPU: {}",
                             ladder.images(), camera.width, camera.height, dataset.name, experiment.profile(), o.rounds,
                             context->renderer(), experiment.cpu_device()));
}

}  // namespace

int passes(int argc, const char* const* argv) { return run_experiment("passes", argc, argv, measure); }

}  // namespace radiafit::harness
