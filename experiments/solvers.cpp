// Solvers side by side: Ceres in each of its settings, alternating least squares, variable projection, and the CPU
// two-step solver's optimizers, on the same vertices, one thread. What counts is the time to the same error.
#include "rows/solvers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "base/clock.h"
#include "base/error.h"
#include "base/instructions.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "base/statistics.h"
#include "cpu/lfm_engine.h"
#include "engineering.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "fitting/solvers/solver.h"
#include "model/lfm_start.h"
#include "optim/optimizer.h"
#include "reference/als_solver.h"
#include "reference/ceres_solver.h"
#include "reference/varpro_solver.h"
#include "report/csv_file.h"
#include "report/table.h"
#include "samples/disk_records.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::solvers;

constexpr Range<double> contest_seconds{0, 1e6};

struct Options {
    std::string dataset = "star";
    int vertices = 60, seed = 1, surface_side = 8, view_side = 8, cap = 3000, repetitions = 5;
    double lambda = 1e-3, tolerance = 1.01, seconds = 8;

    explicit Options(Config& c) {
        c.read("dataset", dataset, check_light_field_shape);
        c.read("vertices", vertices, limits::repetitions);
        c.read("seed", seed, limits::draw_seed);
        c.read("surface_side", surface_side, limits::map_side);
        c.read("view_side", view_side, limits::map_side);
        c.read("lambda", lambda, limits::weight);
        c.read("tolerance", tolerance, limits::tolerance);
        c.read("cap", cap, limits::some_iterations);
        c.read("repetitions", repetitions, limits::repetitions);
        c.read("seconds", seconds, contest_seconds);
        c.finish();
    }
    /// The objective of every solver: E_t with the modern penalty, which is a sum of squares.
    FitRequest request() const {
        FitRequest r;
        r.model.surface_side = surface_side;
        r.model.view_side = view_side;
        r.model.lambda_surface = r.model.lambda_view = float(lambda);
        return r;
    }
};

using V = Lanes<double>;

/// One vertex under every solver.
struct Vertex {
    uint32_t id;
    LfmVertex gathered;                               ///< for the reference solvers
    std::vector<V> start;                             ///< lfm_start
    double best[3] = {INFINITY, INFINITY, INFINITY};  ///< least E_t of any solver
};

/// Takes a chosen vertex from its place in the list. Samples are at hand already, as the solver wants them.
using Solve = std::function<void(size_t vertex, std::span<V> p, VertexRun& run)>;

struct Contestant {
    std::string solver, setting;
    Engineering how;
    Solve solve;
    double spent_s = 0;
    std::vector<VertexRun> runs;                ///< of the last repetition; fewer than all vertices for a slow one
    std::vector<std::array<double, 3>> errors;  ///< of the last repetition: E_t of what was returned, in double
    std::vector<std::vector<double>> to_101;    ///< [repetition][vertex] seconds to the tolerance
    std::vector<std::vector<double>> to_end;    ///< [repetition][vertex] seconds until the solver ends by itself
    size_t vertices() const { return runs.size(); }
    std::string name() const { return setting.empty() ? solver : solver + " " + setting; }
};

/// The two-step solver's problem and engine for each chosen vertex, loaded once.
class TwoStep {
public:
    TwoStep(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const DiskRecords& records,
            const LfmOptions& options, std::span<const uint32_t> chosen)
        : fresh_(dataset, atlas, rings, records.views(), options) {
        std::vector<uint8_t> block;
        for (uint32_t v : chosen) {
            problems_.push_back(std::make_unique<VertexProblem>(fresh_));
            records.read(v, v + 1, block);
            problems_.back()->load(v, records, block.data());
            engines_.emplace_back(*problems_.back());
            engines_.back().count();
        }
    }

    void solve(size_t vertex, const OptimizerOptions& options, std::span<V> p, VertexRun& run) {
        LaneEngine<VertexProblem>& engine = engines_[vertex];
        std::vector<float> block(4 * p.size());
        for (size_t i = 0; i < block.size(); ++i) block[i] = float(p[i / 4][long(i % 4)]);
        run.joint = true;
        float errors[3];
        double start = run.clock();
        engine.reset(block);
        optimize(engine, options, [&](int) {
            const double now = run.clock();
            engine.read_errors(errors);
            for (int c = 0; c < 3; ++c) {
                run.channel[c].error.push_back(double(errors[c]));
                run.channel[c].time_s.push_back(now - start);
            }
            start += run.clock() - now;
        });
        ProblemOutcome outcomes[3];
        engine.outcomes(outcomes);
        for (int c = 0; c < 3; ++c) {  // a channel that stopped has no more rows
            run.channel[c].status = outcomes[c].status;
            run.channel[c].error.resize(outcomes[c].iterations + 1);
            run.channel[c].time_s.resize(outcomes[c].iterations + 1);
        }
        engine.read_parameters(block);
        for (size_t i = 0; i < block.size(); ++i) p[i / 4][long(i % 4)] = double(block[i]);
    }

private:
    VertexProblem fresh_;
    std::vector<std::unique_ptr<VertexProblem>> problems_;
    std::vector<LaneEngine<VertexProblem>> engines_;
};

constexpr const char* ceres_name = "ceres";

std::vector<Contestant> contestants(const Options& o, const LfmOptions& model, const std::vector<Vertex>& vertices,
                                    TwoStep& two_step) {
    std::vector<Contestant> out;
    const auto add = [&](const char* solver, const std::string& setting, const Engineering& how, const Solve& solve) {
        Contestant& c = out.emplace_back();
        c.solver = solver, c.setting = setting, c.how = how, c.solve = solve;
    };
    const auto reference = [&](const char* solver, const std::string& setting, const Engineering& how,
                               const VertexSolver& solve) {
        add(solver, setting, how,
            [solve, &vertices](size_t v, std::span<V> p, VertexRun& run) { solve(vertices[v].gathered, p, run); });
    };
    constexpr int channels = 3;
    for (const NamedRule& ours : named_rules())
        add("two-step", ours.name, {in_32, channels, compiled_instructions()},
            [&two_step, rule = ours.rule, &o](size_t v, std::span<V> p, VertexRun& run) {
                two_step.solve(v, {.rule = rule, .iterations = o.cap}, p, run);
            });
    const VertexSolver varpro = varpro_solver(model, {.iterations = o.cap});
    reference("varpro", "", {in_64_but_schur, channels, widest_instructions()}, varpro);
    if (run_avx512() && std::string_view(compiled_instructions()) != widest_instructions())
        reference("varpro", compiled_instructions(), {in_64_but_schur, channels, compiled_instructions()},
                  [varpro](const LfmVertex& vertex, std::span<V> p, VertexRun& run) {
                      const BaseInstructions only;
                      varpro(vertex, p, run);
                  });
    reference("als", "", {"64", channels, compiled_instructions()}, als_solver(model, {.iterations = o.cap}));
    for (const CeresSetting& s : ceres_settings())
        reference(ceres_name, s.name, {"64", 1, ceres_instructions()},
                  ceres_solver(model, {.setting = s.name, .iterations = o.cap}));
    return out;
}

/// Rows at which the channels are within the tolerance; a channel that never is has its last row.
struct Reached {
    std::array<int, 3> row;
    std::array<bool, 3> reached;
};
Reached reached(const VertexRun& run, const Vertex& vertex, double tolerance) {
    Reached out;
    for (size_t c = 0; c < 3; ++c) {
        const int row = run.channel[c].first_below(tolerance * vertex.best[c]);
        out.reached[c] = row >= 0;
        out.row[c] = row >= 0 ? row : int(run.channel[c].iterations());
    }
    return out;
}

/// One solver on one vertex. Agree before you time: what it says of its result is what the result is, but for 32 bits.
void run(Contestant& c, size_t v, Vertex& vertex) {
    std::vector<V> p = vertex.start;
    VertexRun run;
    run.clock = cpu_time_s;
    const double start = cpu_time_s();
    c.solve(v, p, run);
    c.spent_s += cpu_time_s() - start;
    const V error = lfm_error(vertex.gathered, p.data());
    for (int k = 0; k < 3; ++k) {
        const double said = run.channel[k].error.back();
        if (!(std::abs(said - error[k]) <= 1e-4 * error[k]))
            throw SystemError(
                fmt::format("{}, vertex {}: says {:.8g}, leaves {:.8g}", c.name(), vertex.id, said, error[k]));
        vertex.best[k] = std::min(vertex.best[k], error[k]);
    }
    c.runs.push_back(std::move(run));
    c.errors.push_back({error[0], error[1], error[2]});
}

/// All solvers on a vertex before the next one, so that all meet the same machine. Whoever has spent its seconds takes
/// no further vertex in the first repetition, and no part in the next.
void run_all(const Options& o, std::vector<Contestant>& all, std::vector<Vertex>& vertices) {
    for (int repetition = 0; repetition < o.repetitions; ++repetition) {
        std::vector<Contestant*> running;
        for (Contestant& c : all)
            if (c.spent_s < o.seconds) running.push_back(&c);
        for (Contestant* c : running) c->runs.clear(), c->errors.clear();
        Progress progress(fmt::format("repetition {}, vertices", repetition + 1), vertices.size());
        for (size_t v = 0; v < vertices.size(); ++v, progress.advance())
            for (Contestant* c : running)
                if (repetition > 0 || c->spent_s < o.seconds) run(*c, v, vertices[v]);
        for (Contestant* c : running) {
            c->to_101.emplace_back();
            c->to_end.emplace_back();
            for (size_t v = 0; v < c->vertices(); ++v) {
                const VertexRun& run = c->runs[v];
                c->to_101.back().push_back(run.time_at(reached(run, vertices[v], o.tolerance).row));
                c->to_end.back().push_back(run.time_at(o.cap));
            }
        }
    }
}

/// Sums over the first `count` vertices, one for each repetition.
std::vector<double> sums(const std::vector<std::vector<double>>& seconds, size_t count) {
    std::vector<double> out;
    for (const auto& one : seconds) out.push_back(std::accumulate(one.begin(), one.begin() + long(count), 0.0));
    return out;
}

/// Over the repetitions.
double median_to_101(const Contestant& c, size_t vertex) {
    std::vector<double> seconds;
    for (const auto& repetition : c.to_101) seconds.push_back(repetition[vertex]);
    return median(seconds);
}

/// Seconds to the tolerance over another's, on the vertices that both took.
struct Ratio {
    double all = 0;     ///< of the sums
    double median = 0;  ///< over vertices
};
Ratio ratio(const Contestant& c, const Contestant& unit) {
    const size_t count = std::min(c.vertices(), unit.vertices());
    std::vector<double> ratios;
    for (size_t v = 0; v < count; ++v) ratios.push_back(median_to_101(c, v) / median_to_101(unit, v));
    return {median(sums(c.to_101, count)) / median(sums(unit.to_101, count)), median(ratios)};
}

/// What one row says.
struct Summary {
    const Contestant* contestant;
    double reached_share = 0, iterations = 0, final_over_best = 0;  ///< medians over problems
    double seconds = 0, least = 0, most = 0;                        ///< to the tolerance, all its vertices
    double setup = 0, to_end = 0;
    Ratio to_modern = {},
          to_varpro = {};  ///< its seconds over those of modern conjugate gradients and of variable projection
    double per_vertex(double s) const { return s / double(contestant->vertices()); }
};

Summary summarize(const Options& o, const Contestant& c, const std::vector<Vertex>& vertices) {
    Summary out{.contestant = &c};
    std::vector<double> iterations, final;
    for (size_t v = 0; v < c.vertices(); ++v) {
        const Reached r = reached(c.runs[v], vertices[v], o.tolerance);
        out.setup += c.runs[v].setup_s;
        for (size_t k = 0; k < 3; ++k) {
            iterations.push_back(r.row[k]);
            final.push_back(c.errors[v][k] / vertices[v].best[k]);
            out.reached_share += r.reached[k];
        }
    }
    out.reached_share /= double(final.size());
    out.iterations = median(iterations);
    out.final_over_best = median(final);
    const std::vector<double> seconds = sums(c.to_101, c.vertices());
    out.seconds = median(seconds);
    out.least = *std::min_element(seconds.begin(), seconds.end());
    out.most = *std::max_element(seconds.begin(), seconds.end());
    out.to_end = median(sums(c.to_end, c.vertices()));
    return out;
}

std::vector<uint32_t> draw(const ProblemStatistics& statistics, const Options& o) {
    std::vector<uint32_t> with_samples;
    for (uint32_t v = 0; v < statistics.samples.size(); ++v)
        if (statistics.samples[v]) with_samples.push_back(v);
    Rng rng(uint64_t(o.seed));
    const size_t count = std::min(with_samples.size(), size_t(o.vertices));
    for (size_t i = 0; i < count; ++i)
        std::swap(with_samples[i], with_samples[i + rng.index(uint32_t(with_samples.size() - i))]);
    with_samples.resize(count);
    return with_samples;
}

void write_problems(const ResultFolder& results, const Options& o, const std::vector<Summary>& table,
                    const std::vector<Vertex>& vertices) {
    CsvFile problems(results.path(), rows::problems);
    for (const Summary& s : table) {
        const Contestant& c = *s.contestant;
        for (size_t v = 0; v < c.vertices(); ++v) {
            const Reached r = reached(c.runs[v], vertices[v], o.tolerance);
            for (size_t k = 0; k < 3; ++k)
                problems.add({c.solver, c.setting, vertices[v].id, std::string(1, "rgb"[k]), r.row[k], r.reached[k],
                              int(c.runs[v].channel[k].iterations()), c.errors[v][k], vertices[v].best[k]});
        }
    }
    problems.commit();
}

/// What the performance profile of the report is of: a vertex's three problems are solved, and timed, together.
void write_vertices(const ResultFolder& results, const Options& o, const std::vector<Summary>& table,
                    const std::vector<Vertex>& vertices) {
    CsvFile rows(results.path(), rows::vertices);
    for (const Summary& s : table) {
        const Contestant& c = *s.contestant;
        for (size_t v = 0; v < c.vertices(); ++v) {
            const Reached r = reached(c.runs[v], vertices[v], o.tolerance);
            rows.add({c.solver, c.setting, vertices[v].id, size_t(std::ranges::count(r.reached, true)),
                      median_to_101(c, v)});
        }
    }
    rows.commit();
}

/// The sums over a solver's vertices that the medians of solvers.csv are of.
void write_repetitions(const ResultFolder& results, const std::vector<Summary>& table) {
    CsvFile repetitions(results.path(), rows::repetitions);
    for (const Summary& s : table) {
        const Contestant& c = *s.contestant;
        const std::vector<double> to_101 = sums(c.to_101, c.vertices()), to_end = sums(c.to_end, c.vertices());
        for (size_t i = 0; i < to_101.size(); ++i)
            repetitions.add({c.solver, c.setting, c.vertices(), i, to_101[i], to_end[i]});
    }
    repetitions.commit();
}

void report(Experiment& experiment, const Options& o, const std::vector<Contestant>& all,
            const std::vector<Vertex>& vertices) {
    const auto named = [&](const std::string& name) -> const Contestant& {
        return *std::ranges::find_if(all, [&](const Contestant& c) { return c.name() == name; });
    };
    std::vector<Summary> table;
    for (const Contestant& c : all) {
        table.push_back(summarize(o, c, vertices));
        table.back().to_modern = ratio(c, named("two-step cg modern"));
        table.back().to_varpro = ratio(c, named("varpro"));
    }
    std::ranges::stable_sort(table, {}, [](const Summary& s) { return s.per_vertex(s.seconds); });

    ResultFolder results = experiment.open_results(experiment.cpu_device());
    CsvFile rows(results.path(), rows::solvers);
    Table text({"solver", "vertices", "per vertex, to 1.01", "spread", "times cg modern", "median vertex",
                "times varpro", "median vertex", "reached", "iterations to it", "final / best",
                "per vertex, to its end"});
    for (const Summary& s : table) {
        const Contestant& c = *s.contestant;
        rows.add({c.solver,
                  c.setting,
                  1,
                  c.vertices(),
                  3 * c.vertices(),
                  s.reached_share,
                  s.seconds,
                  s.least,
                  s.most,
                  s.to_modern.all,
                  s.to_modern.median,
                  s.to_varpro.all,
                  s.to_varpro.median,
                  s.iterations,
                  s.final_over_best,
                  s.setup,
                  s.to_end,
                  c.to_101.size(),
                  c.how.precision,
                  c.how.together,
                  c.how.instructions});
        const auto per_vertex = [&](double seconds) { return fmt::format("{:.3g} ms", 1e3 * s.per_vertex(seconds)); };
        text.add({c.name(), std::to_string(c.vertices()), per_vertex(s.seconds),
                  c.to_101.size() > 1 ? fmt::format("{:.1f} %", 50 * (s.most - s.least) / s.seconds) : "one run",
                  fmt::format("{:.2f}", s.to_modern.all), fmt::format("{:.2f}", s.to_modern.median),
                  fmt::format("{:.2f}", s.to_varpro.all), fmt::format("{:.2f}", s.to_varpro.median),
                  fmt::format("{:.1f} %", 100 * s.reached_share), fmt::format("{:g}", s.iterations),
                  fmt::format("{:.4f}", s.final_over_best), per_vertex(s.to_end)});
    }
    rows.commit();
    write_problems(results, o, table, vertices);
    write_vertices(results, o, table, vertices);
    write_repetitions(results, table);
    log_info("time until a vertex's three problems are within the tolerance of the least error\n" + text.text());
    const auto ceres =
        std::find_if(table.begin(), table.end(), [](const Summary& s) { return s.contestant->solver == ceres_name; });
    log_info(
        fmt::format("Ceres' best setting, {}, takes {:.1f} times as long as varpro ({:.1f} on the median vertex), "
                    "{:.1f} times as long as cg modern ({:.1f})",
                    ceres->contestant->setting, ceres->to_varpro.all, ceres->to_varpro.median, ceres->to_modern.all,
                    ceres->to_modern.median));
    experiment.finish(results, fmt::format("{} ({} scale), {} vertices, three problems each; {}", o.dataset,
                                           experiment.profile(), vertices.size(), experiment.cpu_device()));
}

void compare_solvers(Experiment& experiment) {
    const Options o(experiment.config());
    const Dataset dataset = experiment.dataset(o.dataset);
    const FitRequest request = o.request();
    const TriangleAtlas atlas(dataset.mesh, o.surface_side);
    const VertexRings rings(dataset.mesh);
    const LfmOptions model = request.model_options();
    const SharedSamples samples = distribute(dataset, atlas, request);
    const LfmVertices gatherer(dataset, atlas, rings, samples.list, model);

    const AtomicFolder folder(std::filesystem::temp_directory_path() / "radiafit-solvers");
    const Distributors distributors = make_distributors(atlas, request);
    write_records(folder.path(), dataset, atlas, rings, dataset.split(false), distributors.workers(),
                  {.memory = request.sort_memory, .key = "solvers"});
    const DiskRecords records(folder.path(), "solvers");

    const std::vector<uint32_t> chosen = draw(gatherer.statistics(), o);
    require_seen(!chosen.empty(), dataset, request);
    const LfmLayout& layout = gatherer.layout();
    const std::vector<float> start = lfm_start(layout, gatherer.statistics().mean, 1);
    std::vector<Vertex> vertices(chosen.size());
    for (size_t i = 0; i < chosen.size(); ++i) {
        vertices[i].id = chosen[i];
        gatherer.gather(chosen[i], vertices[i].gathered);
        vertices[i].start.resize(vertices[i].gathered.size());
        for (size_t j = 0; j < 4 * vertices[i].start.size(); ++j)
            vertices[i].start[j / 4][long(j % 4)] = double(start[layout.offset(chosen[i]) + j]);
    }
    TwoStep two_step(dataset, atlas, rings, records, model, chosen);
    set_thread_count(1);  // of the contest; samples were distributed by all
    std::vector<Contestant> all = contestants(o, model, vertices, two_step);
    run_all(o, all, vertices);
    report(experiment, o, all, vertices);
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("solvers", argc, argv, radiafit::harness::compare_solvers);
}
