// Many small fits: fits a second at equal error, and how good parameters and error bars are.
#include "rows/batches.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "base/clock.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "batch/problems.h"
#include "experiment.h"
#include "fitting/limits.h"
#include "reference/curve_rivals.h"
#include "report/csv_file.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace rows = rows_of::batches;
using batch::CompiledModel;
using batch::Precision;

constexpr Range<int> fit_counts{1, 10'000'000};
constexpr Range<double> side_range{3, 64};

struct Options {
    int fits = 100'000, rival_fits = 10'000, statistics_fits = 100'000, repetitions = 5, seed = 1;
    std::vector<double> sides = {5, 10, 20};

    explicit Options(Config& c) {
        c.read("fits", fits, fit_counts);
        c.read("rival_fits", rival_fits, fit_counts);
        c.read("statistics_fits", statistics_fits, fit_counts);
        c.read("sides", sides, side_range);
        c.read("repetitions", repetitions, limits::repetitions);
        c.read("seed", seed, limits::draw_seed);
        c.finish();
    }
};

const std::string gaussian_peak = R"(
struct Terms { real x, y; };
struct Parameters { real height, x0, y0, width, ground; };
struct Values { real counts; };
Values value(Parameters p, Terms t) {
    real dx = t.x - p.x0, dy = t.y - p.y0;
    return Values(p.height * exp(-(dx * dx + dy * dy) / (2.0 * p.width * p.width)) + p.ground);
})";
const std::string elliptic_peak = R"(
struct Terms { real x, y; };
struct Parameters { real height, x0, y0, width_x, width_y, ground; };
struct Values { real counts; };
Values value(Parameters p, Terms t) {
    real dx = (t.x - p.x0) / p.width_x, dy = (t.y - p.y0) / p.width_y;
    return Values(p.height * exp(-0.5 * (dx * dx + dy * dy)) + p.ground);
})";
const std::string decay = R"(
struct Terms { real time; };
struct Parameters { real start, life, ground; };
struct Values { real counts; };
Values value(Parameters p, Terms t) { return Values(p.start * exp(-t.time / p.life) + p.ground); })";
const std::string lafortune = R"(
struct Terms { real across, along, down; };
struct Parameters { real red, green, blue, gloss_red, gloss_green, gloss_blue, Cx, Cz, log_n; };
struct Values { real r, g, b; };
Values value(Parameters p, Terms t) {
    real D = p.Cx * t.across + p.Cz * t.along;
    real lobe = SELECT(D < 1.0e-4, 0.0, exp(exp(p.log_n) * log(max(D, 1.0e-4))));
    return Values(p.red * t.down + p.gloss_red * lobe, p.green * t.down + p.gloss_green * lobe, p.blue * t.down + p.gloss_blue * lobe);
})";

/// Fits whose truth is known: the samples' places are the same for all.
struct Made {
    std::string name, text;
    bool counts = true;  ///< the noise is Poisson's; else normal, of `noise`
    double noise = 0;
    int samples = 0, parameters = 0, terms = 0, values = 1;
    bool gauge = false;                          ///< its parameters are not determined, only its values
    std::vector<double> places;                  ///< [samples][terms]
    std::vector<double> truth, targets, starts;  ///< [fits][...]
};

/// Truth and start of a parameter, each drawn evenly about a middle: the truth by `spread`, the start by `off` of the
/// truth.
struct Draw {
    double middle, spread, off;
};

void make(Made& made, const CompiledModel& model, const std::vector<Draw>& draws, size_t fits, uint64_t seed) {
    const auto P = size_t(made.parameters), S = size_t(made.samples * made.values);
    made.truth.resize(fits * P);
    made.starts.resize(fits * P);
    made.targets.resize(fits * S);
    parallel_for(fits, 256, [&](size_t k, int) {
        std::mt19937_64 random(seed * 0x9e3779b97f4a7c15u + k);
        std::uniform_real_distribution<double> even(-1, 1);
        double *truth = &made.truth[k * P], *start = &made.starts[k * P], *target = &made.targets[k * S];
        for (size_t i = 0; i < P; ++i) {
            truth[i] = draws[i].middle + draws[i].spread * even(random);
            start[i] = truth[i] + draws[i].off * even(random);
        }
        model.evaluate(truth, made.places.data(), made.samples, target, nullptr);
        for (size_t s = 0; s < S; ++s)
            target[s] = made.counts ? double(std::poisson_distribution<long>(std::max(0.0, target[s]))(random))
                                    : target[s] + made.noise * std::normal_distribution<double>()(random);
    });
}

std::vector<double> pixels(int side) {
    std::vector<double> out;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) out.insert(out.end(), {double(x), double(y)});
    return out;
}

/// Lamps and cameras about a texel, as terms of Lafortune's model.
std::vector<double> directions(int count) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<double> out;
    while (int(out.size()) < 3 * count) {
        Vec3d u(normal(random), normal(random), std::abs(normal(random)));
        u.normalize();
        Vec3d v = Vec3d(-u.x(), -u.y(), u.z()) + 0.5 * Vec3d(normal(random), normal(random), normal(random));
        v.normalize();
        if (u.z() < 0.2 || v.z() < 0.2) continue;
        out.insert(out.end(), {u.x() * v.x() + u.y() * v.y(), u.z() * v.z(), u.z()});
    }
    return out;
}

struct Kind {
    Made made;
    std::vector<Draw> draws;
};

std::vector<Kind> kinds(const Options& o) {
    std::vector<Kind> out;
    for (const double asked : o.sides) {
        const int side = int(asked);
        const double middle = 0.5 * (side - 1), width = side / 5.0;
        const Draw height{500, 100, 100}, place{middle, 0.1 * side, 0.08 * side}, wide{width, 0.1 * width, 0.1 * width},
            ground{10, 2, 3};
        out.push_back({{"gaussian peak", gaussian_peak, true, 0, side * side, 5, 2, 1, false, pixels(side), {}, {}, {}},
                       {height, place, place, wide, ground}});
        out.push_back({{"elliptic peak", elliptic_peak, true, 0, side * side, 6, 2, 1, false, pixels(side), {}, {}, {}},
                       {height, place, place, wide, wide, ground}});
    }
    std::vector<double> times;
    for (int i = 0; i < 40; ++i) times.push_back(0.25 * i);
    out.push_back({{"decay", decay, true, 0, 40, 3, 1, 1, false, times, {}, {}, {}},
                   {{1000, 300, 200}, {2, 0.5, 0.5}, {20, 5, 5}}});
    out.push_back({{"lafortune", lafortune, false, 0.005, 60, 9, 3, 3, true, directions(60), {}, {}, {}},
                   {{0.3, 0.1, 0.1},
                    {0.3, 0.1, 0.1},
                    {0.3, 0.1, 0.1},
                    {0.5, 0.2, 0.1},
                    {0.5, 0.2, 0.1},
                    {0.5, 0.2, 0.1},
                    {-1, 0, 0.05},
                    {1, 0, 0.05},
                    {2.5, 0.5, 0.3}}});
    return out;
}

template <class real>
std::vector<real> as(const std::vector<double>& numbers, size_t count) {
    return {numbers.begin(), numbers.begin() + std::ptrdiff_t(count)};
}

template <class real>
batch::Problems<real> problems_of(const Made& made, size_t fits, const std::vector<real>& places,
                                  const std::vector<real>& targets, const std::vector<real>& starts,
                                  const std::vector<real>& weights = {}) {
    return {fits, {}, size_t(made.samples), places, targets, weights, starts};
}

/// Sums of squared residuals, in doubles.
std::vector<double> errors_at(const Made& made, const CompiledModel& model, const std::vector<double>& parameters,
                              size_t fits) {
    std::vector<double> out(fits);
    const auto S = size_t(made.samples * made.values);
    parallel_for(fits, 64, [&](size_t k, int) {
        std::vector<double> values(S);
        model.evaluate(&parameters[k * size_t(made.parameters)], made.places.data(), made.samples, values.data(),
                       nullptr);
        for (size_t s = 0; s < S; ++s) out[k] += std::pow(values[s] - made.targets[k * S + s], 2);
    });
    return out;
}

/// A way to solve the first of the made fits: how many, and what comes out in doubles.
struct Contestant {
    std::string name, precision;
    int threads;
    size_t fits;
    std::function<double(std::vector<double>& parameters)> run;  ///< returns seconds
    std::vector<double> seconds = {}, errors = {};
};

template <class real>
Contestant ours(const Made& made, const CompiledModel& model, int threads, size_t fits) {
    struct Input {
        std::vector<real> places, targets, starts;
    };
    const auto S = size_t(made.samples * made.values);
    auto input =
        std::make_shared<Input>(Input{as<real>(made.places, made.places.size()), as<real>(made.targets, fits * S),
                                      as<real>(made.starts, fits * size_t(made.parameters))});
    return {"radiafit solve", sizeof(real) == 8 ? "double" : "float", threads, fits,
            [&made, &model, input, fits, threads](auto& parameters) {
                set_thread_count(threads);
                const Stopwatch clock;
                const auto found =
                    batch::solve(model, problems_of<real>(made, fits, input->places, input->targets, input->starts),
                                 {.tolerance = 1e-3, .covariance = false});
                const double seconds = clock.wall_s();
                parameters.assign(found.parameters.begin(), found.parameters.end());
                return seconds;
            }};
}

/// TinySolver, whose residuals and derivatives are the compiled model's, samples side by side.
Contestant rival(const Made& made, const CompiledModel& model, int threads, size_t fits) {
    struct One {
        const Made* made;
        const CompiledModel* model;
        const double* targets;
    };
    return {"TinySolver", "double", threads, fits, [&made, &model, fits, threads](auto& parameters) {
                set_thread_count(threads);
                std::vector<std::unique_ptr<fits::TinyCurveSolver>> solvers;
                for (int i = 0; i < threads; ++i)
                    solvers.push_back(fits::tiny_curve_solver(made.parameters, {.step = 1e-6}));
                parameters = as<double>(made.starts, fits * size_t(made.parameters));
                const int S = made.samples * made.values;
                const Stopwatch clock;
                parallel_for(fits, 64, [&](size_t k, int worker) {
                    const One one{&made, &model, &made.targets[k * size_t(S)]};
                    solvers[size_t(worker)]->solve(S, &parameters[k * size_t(made.parameters)], &one,
                                                   [](const void* of, const double* p, double* r, double* derivatives) {
                                                       const One& o = *static_cast<const One*>(of);
                                                       o.model->evaluate(p, o.made->places.data(), o.made->samples, r,
                                                                         derivatives);
                                                       for (int s = 0; s < o.made->samples * o.made->values; ++s)
                                                           r[s] -= o.targets[s];
                                                   });
                });
                return clock.wall_s();
            }};
}

void time_fits(const Options& o, const Made& made, const CompiledModel& in_doubles, const CompiledModel& in_floats,
               std::vector<rows::Fits>& out) {
    std::vector<Contestant> all;
    const auto fits = size_t(o.fits), few = std::min(fits, size_t(o.rival_fits));
    std::vector<int> threads = {1};
    if (core_count() > 1) threads.push_back(core_count());
    for (const int t : threads) {
        all.push_back(ours<float>(made, in_floats, t, fits));
        all.push_back(ours<double>(made, in_doubles, t, fits));
        all.push_back(rival(made, in_doubles, t, few));
    }
    for (int repetition = 0; repetition < o.repetitions; ++repetition)
        for (Contestant& c : all) {
            std::vector<double> parameters;
            c.seconds.push_back(c.run(parameters));
            if (repetition == 0) {
                set_thread_count(0);
                c.errors = errors_at(made, in_doubles, parameters, c.fits);
            }
        }
    set_thread_count(0);
    std::vector<double> best(fits, INFINITY);
    for (const Contestant& c : all)
        for (size_t k = 0; k < c.fits; ++k) best[k] = std::min(best[k], c.errors[k]);
    for (const Contestant& c : all) {
        size_t arrived = 0;
        for (size_t k = 0; k < c.fits; ++k) arrived += c.errors[k] <= (1 + 1e-5) * best[k];
        const Contestant& beside = *std::ranges::find_if(
            all, [&](const Contestant& r) { return r.name == "TinySolver" && r.threads == c.threads; });
        std::vector<double> rates, ratios;
        for (size_t i = 0; i < c.seconds.size(); ++i) {
            rates.push_back(double(c.fits) / c.seconds[i]);
            ratios.push_back(rates.back() / (double(beside.fits) / beside.seconds[i]));
        }
        out.push_back({made.name, made.samples, made.parameters, c.name, c.precision, c.threads, c.fits,
                       c.seconds.size(), double(arrived) / double(c.fits), median(rates),
                       *std::ranges::min_element(rates), *std::ranges::max_element(rates), median(ratios)});
    }
}

/// Cramér and Rao's bound of each parameter's variance at the truth: of counts that are Poisson's.
std::vector<double> bounds_at(const Made& made, const CompiledModel& model, const double* truth) {
    const Eigen::Index P = made.parameters;
    std::vector<double> values(size_t(made.samples)), derivatives(size_t(made.samples) * size_t(P));
    model.evaluate(truth, made.places.data(), made.samples, values.data(), derivatives.data());
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(P, P);
    for (size_t s = 0; s < values.size(); ++s) {
        const Eigen::Map<const Eigen::VectorXd> d(&derivatives[s * size_t(P)], P);
        information += d * d.transpose() / values[s];
    }
    const Eigen::VectorXd diagonal = information.llt().solve(Eigen::MatrixXd::Identity(P, P)).diagonal();
    return {diagonal.data(), diagonal.data() + P};
}

/// Of fits whose weights are 1 / variance, which for counts is the value itself: that of a first fit.
template <class real>
void judge_fits(const Options& o, const Made& made, const CompiledModel& model, const CompiledModel& in_doubles,
                std::vector<rows::Statistics>& out) {
    const size_t fits = std::min(size_t(o.fits), size_t(o.statistics_fits)), P = size_t(made.parameters),
                 S = size_t(made.samples);
    const std::vector<real> places = as<real>(made.places, made.places.size()),
                            targets = as<real>(made.targets, fits * S), starts = as<real>(made.starts, fits * P);
    const auto first =
        batch::solve(model, problems_of<real>(made, fits, places, targets, starts), {.covariance = false});
    std::vector<real> weights(fits * S);
    parallel_for(fits, 64, [&](size_t k, int) {
        std::vector<real> values(S);
        model.evaluate(&first.parameters[k * P], places.data(), made.samples, values.data(), nullptr);
        for (size_t s = 0; s < S; ++s) weights[k * S + s] = 1 / std::max(values[s], real(1));
    });
    const auto found = batch::solve(model, problems_of<real>(made, fits, places, targets, first.parameters, weights),
                                    {.known_noise = true, .covariance = false});
    std::vector<double> bounds(fits * P);
    parallel_for(fits, 64, [&](size_t k, int) {
        std::ranges::copy(bounds_at(made, in_doubles, &made.truth[k * P]), &bounds[k * P]);
    });
    for (size_t i = 0; i < P; ++i) {
        double count = 0, sum = 0, squares = 0, one = 0, two = 0;
        for (size_t k = 0; k < fits; ++k) {
            if (found.status[k] != int(batch::BatchStatus::converged)) continue;
            const double off = double(found.parameters[k * P + i]) - made.truth[k * P + i],
                         in_bounds = off / std::sqrt(bounds[k * P + i]),
                         in_sigma = std::abs(off) / double(found.deviations[k * P + i]);
            ++count;
            sum += in_bounds;
            squares += in_bounds * in_bounds;
            one += in_sigma < 1;
            two += in_sigma < 1.959964;
        }
        const double bias = sum / count;
        out.push_back({made.name, made.samples, sizeof(real) == 8 ? "double" : "float", model.text().parameters[i],
                       bias, 1 / (squares / count - bias * bias), one / count, two / count, size_t(count)});
    }
}

void batches(Experiment& experiment) {
    const Options o(experiment.config());
    ResultFolder results = experiment.open_results(experiment.cpu_device());
    std::vector<rows::Fits> fits;
    std::vector<rows::Statistics> statistics;
    std::vector<Kind> all = kinds(o);
    Progress progress("problems", all.size());
    for (auto& [made, draws] : all) {
        const batch::ModelText text = batch::read_model(made.name, made.text);
        const CompiledModel in_doubles(text, Precision::double_precision), in_floats(text, Precision::single_precision);
        make(made, in_doubles, draws, size_t(o.fits), uint64_t(o.seed));
        time_fits(o, made, in_doubles, in_floats, fits);
        if (made.counts) {
            judge_fits<double>(o, made, in_doubles, in_doubles, statistics);
            judge_fits<float>(o, made, in_floats, in_doubles, statistics);
        }
        made = {};
        progress.advance();
    }
    progress.finish();
    CsvFile fit_file(results.path(), rows::fits);
    CsvFile statistics_file(results.path(), rows::statistics);
    Table table(
        {"problem", "samples", "solver", "precision", "threads", "fits a second", "times TinySolver", "arrived"});
    for (const rows::Fits& row : fits) {
        fit_file.add(row);
        table.add({row.problem, std::to_string(row.samples), row.solver, row.precision, std::to_string(row.threads),
                   fmt::format("{:.3g}", row.fits_per_second), fmt::format("{:.1f}", row.times_rival),
                   fmt::format("{:.2f} %", 100 * row.arrived_share)});
    }
    for (const rows::Statistics& row : statistics) statistics_file.add(row);
    fit_file.commit();
    statistics_file.commit();
    log_info("many small fits\n" + table.text());
    experiment.finish(results, experiment.cpu_device());
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("batches", argc, argv, radiafit::harness::batches);
}
