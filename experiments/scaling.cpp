// Memory and time against the size of the problem (Sections 3.2, 4.3, 6.3 and 6.6; claims C13, C14, C15 and C18): bytes
// of the fragment engine over parameters; seconds of an iteration over radiance samples and over texels of the surface;
// gathered and scattered; and what it costs to find every texel's pixel again in each sweep over the images.
#include "rows/scaling.h"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "base/log.h"
#include "base/statistics.h"
#include "base/time_limit.h"
#include "bench/bundle.h"
#include "compute/compute_engine.h"
#include "cpu/lfm_engine.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fragment/fragment_engine.h"
#include "fragment/fragment_plan.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "gl/held_bytes.h"
#include "iteration_time.h"
#include "model/lfm_start.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::scaling;

constexpr const char* cpu_engine = "cpu";

struct Options {
    std::string dataset = "star";
    std::vector<int> sides = {8, 12, 16, 24, 32}, texel_sides = sides, images = {5, 10, 20, 40, 87};
    int side = 8, texel_images = 5, distribution_images = 20, rounds = 9, cpu_iterations = 10;
    double lambda = 1e-3;

    explicit Options(Config& c) {
        c.read("dataset", dataset, check_light_field_shape);
        c.read("sides", sides, limits::map_side);
        c.read("texel_sides", texel_sides, limits::map_side);
        c.read("side", side, limits::map_side);
        c.read("images", images, limits::repetitions);
        c.read("texel_images", texel_images, limits::repetitions);
        c.read("distribution_images", distribution_images, limits::repetitions);
        c.read("rounds", rounds, limits::repetitions);
        c.read("cpu_iterations", cpu_iterations, limits::some_iterations);
        c.read("lambda", lambda, limits::weight);
        c.finish();
        if (sides.size() < 3) c.reject("sides", "a slope needs at least 3");
        if (texel_sides.size() < 3) c.reject("texel_sides", "a slope needs at least 3");
        if (images.size() < 3) c.reject("images", "a slope needs at least 3");
    }
    void check(Config& c, const Dataset& opened) const {
        const size_t training = opened.split(false).size();
        const auto at_most = [&](const char* key, int count) {
            if (size_t(count) > training)
                c.reject(key, fmt::format("holds {}, but {} has {} training views", count, opened.name, training));
        };
        for (const int count : images) at_most("images", count);
        at_most("texel_images", texel_images);
        at_most("distribution_images", distribution_images);
    }
    /// The paper's conjugate gradients.
    FitRequest request(int surface_side, int view_side) const {
        FitRequest r;
        r.set("mode", "paper");
        r.model.surface_side = surface_side;
        r.model.view_side = view_side;
        r.model.lambda_surface = r.model.lambda_view = float(lambda);
        return r;
    }
};

// Memory.

struct Memory {
    std::string passes, storage;
    int side;
    uint64_t parameters = 0, planned = 0, allocated = 0, told_by_gl = 0, paper_layout = 0;
    std::optional<int64_t> process = {};  ///< by how much its resident memory grew, where OpenGL runs in it
};

/// Pages of this process that are in memory.
int64_t resident_bytes() {
    int64_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * sysconf(_SC_PAGESIZE);
}

Memory memory_of(const Dataset& dataset, const VertexRings& rings, const FitRequest& request) {
    const TriangleAtlas atlas(dataset.mesh, request.model.surface_side);
    Memory m{.passes = request.text("passes"), .storage = request.text("storage"), .side = request.model.surface_side};
    std::vector<PlanRow> planned = plan(dataset, request).memory;
    if (Context::current().software())
        std::erase_if(planned, [](const PlanRow& row) { return row.array == on_their_way; });
    m.planned = total_bytes(planned);
    m.paper_layout = total_bytes(paper_layout(dataset.mesh.triangle_count(), dataset.mesh.vertex_count(),
                                              request.model.surface_side, request.model.view_side));
    malloc_trim(0);  // what earlier engines left is given back first, or this one would take it unseen
    const uint64_t held_before = held_bytes();
    const int64_t resident_before = resident_bytes();
    const FragmentEngine engine(dataset, atlas, rings, dataset.split(false), request.model_options(),
                                request.fragment_options());
    gl().Finish();
    if (Context::current().software()) m.process = resident_bytes() - resident_before;
    m.told_by_gl = held_bytes() - held_before;
    m.allocated = engine.bytes();
    m.parameters = engine.layout().parameter_count();
    return m;
}

std::vector<Memory> memory_of_all(const Dataset& dataset, const VertexRings& rings, const Options& o) {
    std::vector<Memory> memory;
    for (const char* passes : {"paper", "combined"})
        for (const char* storage : {"fp32", "fp16"})
            for (const int side : o.sides) {
                FitRequest request = o.request(side, side);
                request.set("engine", "fragment");
                request.set("source", "disk");  // images are not part of the engine's memory
                request.set("passes", passes);
                request.set("storage", storage);
                memory.push_back(memory_of(dataset, rings, request));
            }
    return memory;
}

// Time.

/// Seconds, and those of them in sweeps over images.
struct Taken {
    double seconds;
    std::optional<double> sweeps = {};
};

/// What is timed by turns with the others of its part.
struct Contestant {
    std::string part, engine, what;
    int side;
    size_t images;
    uint64_t texels = 0, samples = 0, parameters = 0;
    std::function<Taken()> measure = {};  ///< of an iteration, or of distributing all images once
    std::vector<double> seconds = {};     ///< [round]
    std::vector<double> sweeps = {};      ///< [round] of these, in sweeps over images; empty where none stream

    std::string name() const { return what == iteration ? engine : engine + ", " + what; }
    static constexpr const char *iteration = "iteration", *kept = "iteration, samples kept",
                                *distribution = "distribution";
};

/// Fragment programs and what they need.
struct Fragment {
    TriangleAtlas atlas;
    std::unique_ptr<FragmentEngine> engine;

    Fragment(const Dataset& dataset, const VertexRings& rings, const std::vector<uint32_t>& views, FitRequest request,
             const std::string& passes, bool keep_images, bool keep_samples)
        : atlas(dataset.mesh, request.model.surface_side) {
        request.set("passes", passes);
        FragmentOptions options = request.fragment_options();
        options.keep_on_device = keep_images;
        options.keep_samples = keep_samples;
        engine = std::make_unique<FragmentEngine>(dataset, atlas, rings, views, request.model_options(), options);
    }
};

template <class Engine>
ProblemStatistics begin_fit(Engine& engine, const FitRequest& request) {
    const ProblemStatistics statistics = engine.count();
    start_iterations(engine, lfm_start(engine.layout(), statistics.mean, request.seed));
    return statistics;
}

/// Makes contestants, which own their engines, over spread training views.
class Contest {
public:
    Contest(const Dataset& dataset, const VertexRings& rings, const Options& o)
        : dataset_(dataset), rings_(rings), o_(o) {}

    void add_fragment(const std::string& part, const std::string& passes, int side, int images, bool keep_images,
                      bool keep_samples = false) {
        const FitRequest request = o_.request(side, o_.side);
        const auto held =
            std::make_shared<Fragment>(dataset_, rings_, views(images), request, passes, keep_images, keep_samples);
        add_opengl(part, "fragment " + passes, keep_samples, side, images, held, request);
    }

    /// Compute shaders that distribute in every sweep, or, kept, read samples that stay on the device.
    void add_compute(const std::string& part, Accumulate accumulate, int side, int images, bool keep_images,
                     bool keep_samples = false) {
        struct Held {
            TriangleAtlas atlas;
            std::unique_ptr<ComputeEngine> engine = {};
        };
        const auto held = std::make_shared<Held>(Held{TriangleAtlas(dataset_.mesh, side)});
        const FitRequest request = o_.request(side, o_.side);
        if (keep_samples)
            held->engine = std::make_unique<ComputeEngine>(
                dataset_, held->atlas, rings_, distribute(dataset_, held->atlas, request, views(images)).list,
                request.model_options(), accumulate);
        else
            held->engine =
                std::make_unique<ComputeEngine>(dataset_, held->atlas, rings_, views(images), request.model_options(),
                                                StreamOptions{.keep_on_device = keep_images}, accumulate);
        const std::string engine = accumulate == Accumulate::gather ? "compute gather" : "compute scatter";
        add_opengl(part, engine, keep_samples, side, images, held, request);
    }

    void add_cpu(const std::string& part, int side, int images) {
        struct Held {
            TriangleAtlas atlas;
            SharedSamples samples;
            std::unique_ptr<LfmProblem<float>> problem = {};
            std::unique_ptr<StreamEngine<float>> engine = {};
            std::vector<float> start = {};
        };
        const FitRequest request = o_.request(side, o_.side);
        const auto held = std::make_shared<Held>(Held{TriangleAtlas(dataset_.mesh, side), {}});
        held->samples = distribute(dataset_, held->atlas, request, views(images));
        held->problem = std::make_unique<LfmProblem<float>>(dataset_, held->atlas, rings_, held->samples.list,
                                                            request.model_options());
        held->engine = std::make_unique<StreamEngine<float>>(*held->problem);
        held->start = lfm_start(held->problem->layout(), held->engine->count().mean, request.seed);
        Contestant& c =
            add(part, cpu_engine, Contestant::iteration, side, images, held->problem->layout().parameter_count());
        c.samples = held->samples.list.samples.size();
        c.measure = [held, iterations = o_.cpu_iterations] {
            start_iterations(*held->engine, held->start);  // again: a problem that has stopped would be skipped
            return Taken{seconds_per_iteration(*held->engine, iterations)};
        };
    }

    void add_cpu_distribution(const std::string& part, int side, int images) {
        const auto atlas = std::make_shared<TriangleAtlas>(dataset_.mesh, side);
        const FitRequest request = o_.request(side, o_.side);
        const auto once = [this, atlas, request, images] {
            return distribute(dataset_, *atlas, request, views(images));
        };
        Contestant& c = add(part, cpu_engine, Contestant::distribution, side, images, 0);
        c.samples = once().list.samples.size();
        c.measure = [once] { return Taken{once().seconds}; };
    }

    /// All by turns: what slows the machine for a while meets all of them.
    std::vector<Contestant> run() {
        Progress progress(contestants_.front().part + ", rounds", size_t(o_.rounds));
        for (int round = 0; another_round(round, o_.rounds); ++round, progress.advance())
            for (Contestant& c : contestants_) {
                const Taken taken = c.measure();
                c.seconds.push_back(taken.seconds);
                if (taken.sweeps) c.sweeps.push_back(*taken.sweeps);
            }
        for (Contestant& c : contestants_) c.measure = {};  // lets go of its engine
        return std::move(contestants_);
    }

private:
    std::vector<uint32_t> views(int images) const { return spread_views(dataset_.split(false), images); }
    /// held: an engine, which has begun its fit, and what it needs.
    template <class Held>
    void add_opengl(const std::string& part, const std::string& engine, bool keep_samples, int side, int images,
                    const std::shared_ptr<Held>& held, const FitRequest& request) {
        const ProblemStatistics statistics = begin_fit(*held->engine, request);
        Contestant& c = add(part, engine, keep_samples ? Contestant::kept : Contestant::iteration, side, images,
                            held->engine->layout().parameter_count());
        for (const uint32_t of_vertex : statistics.samples) c.samples += of_vertex;
        c.samples /= 3;  // each is in three rings
        c.measure = [held] {
            const SweepTimes before = held->engine->times();
            Taken taken{seconds_per_iteration(*held->engine, 1)};
            const SweepTimes& after = held->engine->times();
            if (after.sweeps > before.sweeps) taken.sweeps = after.sweep_s - before.sweep_s;
            return taken;
        };
    }
    Contestant& add(const std::string& part, const std::string& engine, const std::string& what, int side, int images,
                    uint64_t parameters) {
        const uint64_t texels = dataset_.mesh.triangle_count() * uint64_t(side) * uint64_t(side + 1) / 2;
        return contestants_.emplace_back(Contestant{part, engine, what, side, size_t(images), texels, 0, parameters});
    }

    const Dataset& dataset_;
    const VertexRings& rings_;
    const Options& o_;
    std::vector<Contestant> contestants_;
};

std::vector<Contestant> time_all(const Dataset& dataset, const VertexRings& rings, const Options& o) {
    std::vector<Contestant> all;
    const auto run = [&](const auto& fill) {
        Contest contest(dataset, rings, o);
        fill(contest);
        std::ranges::move(contest.run(), std::back_inserter(all));
    };
    run([&](Contest& contest) {
        for (const int images : o.images) {
            contest.add_cpu("samples", o.side, images);
            for (const char* passes : {"paper", "combined"})
                contest.add_fragment("samples", passes, o.side, images, false);
        }
    });
    run([&](Contest& contest) {
        for (const int side : o.texel_sides) {
            contest.add_cpu("texels", side, o.texel_images);
            for (const char* passes : {"paper", "combined"})
                contest.add_fragment("texels", passes, side, o.texel_images, false);
            for (const Accumulate accumulate : {Accumulate::gather, Accumulate::scatter_fixed})
                contest.add_compute("texels", accumulate, side, o.texel_images, false);
        }
    });
    run([&](Contest& contest) {  // images stay on the device, so that none streams, kept samples or not
        for (const bool keep : {false, true})
            contest.add_fragment("distribution", "paper", o.side, o.distribution_images, true, keep);
        for (const Accumulate accumulate : {Accumulate::gather, Accumulate::scatter_fixed})
            for (const bool keep : {false, true})
                contest.add_compute("distribution", accumulate, o.side, o.distribution_images, true, keep);
        contest.add_cpu("distribution", o.side, o.distribution_images);
        contest.add_cpu_distribution("distribution", o.side, o.distribution_images);
    });
    return all;
}

// Rows.

/// Medians over rounds, each with its interval of 95 % where there were enough.
class Summary {
public:
    explicit Summary(const ResultFolder& results) : rows_(results.path(), rows::summary) {}
    void add(const std::string& of, const std::string& engine, double value, const std::optional<Interval>& interval) {
        const auto number = [](double x) { return fmt::format("{:.4f}", x); };
        const auto [low, high] = ends_of(interval);
        rows_.add({of, engine, value, low, high});
        table_.add({of, engine, number(value), low ? number(*low) + " to " + number(*high) : "too few rounds"});
    }
    void add(const std::string& of, const std::string& engine, const std::vector<double>& values) {
        add(of, engine, median(values), median_interval(values, values.size()));
    }
    /// Slopes of log y over log x, one for each round.
    void add_slopes(const std::string& of, const std::vector<Contestant>& all, const std::string& part,
                    uint64_t Contestant::*x, std::vector<double> Contestant::*y = &Contestant::seconds) {
        std::map<std::string, std::vector<const Contestant*>> lines;
        for (const Contestant& c : all)
            if (c.part == part && !(c.*y).empty()) lines[c.name()].push_back(&c);
        for (const auto& [name, line] : lines) {
            std::vector<double> slopes;
            for (size_t round = 0; round < (line.front()->*y).size(); ++round) {
                Points points;
                for (const Contestant* c : line) points.emplace_back(double(c->*x), (c->*y)[round]);
                slopes.push_back(log_slope(points));
            }
            add(of, name, slopes);
        }
    }
    void commit() {
        rows_.commit();
        log_info("slopes of logarithms, and ratios of times\n" + table_.text());
    }

private:
    CsvFile<rows::Summary> rows_;
    Table table_{{"of", "engine", "median", "95 % interval"}};
};

void write_memory(const ResultFolder& results, const Dataset& dataset, const std::vector<Memory>& memory,
                  Summary& summary) {
    CsvFile rows(results.path(), rows::memory);
    Table table({"engine", "side of maps", "parameters", "plan", "allocated", "OpenGL's own account",
                 "growth of the process", "Section 6.3's accounting"});
    const auto megabytes = [](double b) { return fmt::format("{:.2f} MB", b / 1e6); };
    std::map<std::string, Points> bytes;
    for (const Memory& m : memory) {
        rows.add({"fragment", m.storage, m.passes, m.side, dataset.mesh.triangle_count(), dataset.mesh.vertex_count(),
                  m.parameters, m.planned, m.allocated, m.told_by_gl, m.process, m.paper_layout});
        const std::string name = fmt::format("fragment {} {}", m.passes, m.storage);
        table.add({name, std::to_string(m.side), std::to_string(m.parameters), megabytes(double(m.planned)),
                   megabytes(double(m.allocated)), megabytes(double(m.told_by_gl)),
                   m.process ? megabytes(double(*m.process)) : "", megabytes(double(m.paper_layout))});
        bytes[name].emplace_back(double(m.parameters), double(m.told_by_gl));
    }
    rows.commit();
    log_info("memory, the same for either optimizer\n" + table.text());
    for (const auto& [engine, points] : bytes) {
        const double slope = log_slope(points);  // counted, so the same in every round
        summary.add("bytes over parameters", engine, slope, Interval{slope, slope});
    }
}

void write_times(const ResultFolder& results, const std::vector<Contestant>& times, const std::string& gl_renderer,
                 const std::string& cpu) {
    CsvFile rows(results.path(), rows::time);
    for (const Contestant& c : times)
        for (size_t round = 0; round < c.seconds.size(); ++round)
            rows.add({c.part, c.engine, c.what, c.side, c.images, c.texels, c.samples, c.parameters, round,
                      c.seconds[round], c.sweeps.empty() ? std::nullopt : std::optional(c.sweeps[round]),
                      c.engine == cpu_engine ? cpu : gl_renderer});
    rows.commit();
}

/// Over all training images: what costs once an iteration weighs more with fewer.
void write_work(const ResultFolder& results, const Dataset& dataset, const VertexRings& rings,
                const FitRequest& request) {
    CsvFile rows(results.path(), rows::work);
    const std::vector<uint32_t> views = dataset.split(false);
    Progress progress("counting declared work", 4);
    for (const bool keep : {false, true}) {
        const Fragment held(dataset, rings, views, request, "paper", false, keep);
        begin_fit(*held.engine, request);
        for (const char* optimizer : optimizer_names) {
            const Work work = count_iteration(*held.engine, is_descent(optimizer)).work;
            rows.add({"distribution", "fragment paper", keep ? Contestant::kept : Contestant::iteration, optimizer,
                      views.size(), work.operations, work.reads});
            progress.advance();
        }
    }
    rows.commit();
}

/// What distribution costs, round by round: time with over time without.
void add_ratios(const std::vector<Contestant>& times, Summary& summary) {
    const auto of = [&](const std::string& engine, const std::string& what) -> const std::vector<double>& {
        return std::ranges::find_if(times,
                                    [&](const Contestant& c) {
                                        return c.part == "distribution" && c.engine == engine && c.what == what;
                                    })
            ->seconds;
    };
    size_t rounds = SIZE_MAX;
    for (const Contestant& c : times)
        if (c.part == "distribution") rounds = std::min(rounds, c.seconds.size());
    for (const char* engine : {"fragment paper", "compute gather", "compute scatter"}) {
        std::vector<double> ratios;
        for (size_t round = 0; round < rounds; ++round)
            ratios.push_back(of(engine, Contestant::iteration)[round] / of(engine, Contestant::kept)[round]);
        summary.add("time with distribution over time without", engine, ratios);
    }
    std::vector<double> cpu;
    for (size_t round = 0; round < rounds; ++round)
        cpu.push_back(1 +
                      of(cpu_engine, Contestant::distribution)[round] / of(cpu_engine, Contestant::iteration)[round]);
    summary.add("time with distribution over time without", cpu_engine, cpu);
}

void measure(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    o.check(experiment.config(), dataset);
    const VertexRings rings(dataset.mesh);
    share_time(3);  // samples, texels, distribution
    const auto context = Context::create(o.request(o.side, o.side).context);
    note_gl(*context, experiment.record());
    const std::vector<Memory> memory = memory_of_all(dataset, rings, o);
    const std::vector<Contestant> times = time_all(dataset, rings, o);

    ResultFolder results = experiment.open_results(context->renderer());
    Summary summary(results);
    write_memory(results, dataset, memory, summary);
    write_times(results, times, context->renderer(), experiment.cpu_name());
    write_work(results, dataset, rings, o.request(o.side, o.side));
    summary.add_slopes("seconds over samples", times, "samples", &Contestant::samples);
    summary.add_slopes("seconds over texels", times, "texels", &Contestant::texels);
    summary.add_slopes("seconds of sweeps over texels", times, "texels", &Contestant::texels, &Contestant::sweeps);
    add_ratios(times, summary);
    summary.commit();
    experiment.finish(results,
                      fmt::format("{} ({} scale), {} rounds; OpenGL: {}; CPU: {}", dataset.name, experiment.profile(),
                                  o.rounds, context->renderer(), experiment.cpu_device()));
}

}  // namespace

int scaling(int argc, const char* const* argv) { return run_experiment("scaling", argc, argv, measure); }

}  // namespace radiafit::harness
