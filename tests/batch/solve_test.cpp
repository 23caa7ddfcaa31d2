// What `solve` finds of many small problems, against what is known of them without it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "batch/problems.h"

namespace radiafit::batch {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

struct OwnFolder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("radiafit-batch-" + std::to_string(getpid()));
    ~OwnFolder() { std::filesystem::remove_all(path); }
};

/// Compiled once for all tests; into a folder of their own, so that they don't see what a user has.
template <class real = double>
const CompiledModel& compiled(const std::string& text) {
    static const bool ready = [] {
        static const OwnFolder folder;
        setenv("XDG_CACHE_HOME", folder.path.c_str(), 1);
        return true;
    }();
    static std::map<std::pair<std::string, size_t>, std::unique_ptr<CompiledModel>> all;
    auto& model = all[{text, sizeof(real)}];
    if (ready && !model)
        model = std::make_unique<CompiledModel>(
            read_model("model", text), sizeof(real) == 8 ? Precision::double_precision : Precision::single_precision);
    return *model;
}

const std::string peak = R"(
struct Terms { real x, y; };
struct Parameters { real height, x0, y0, width, ground; };
struct Values { real counts; };
Values value(Parameters p, Terms t) {
    real dx = t.x - p.x0, dy = t.y - p.y0;
    return Values(p.height * exp(-(dx * dx + dy * dy) / (2.0 * p.width * p.width)) + p.ground);
})";
double peak_at(const double* p, double x, double y) {
    const double dx = x - p[1], dy = y - p[2];
    return p[0] * std::exp(-(dx * dx + dy * dy) / (2 * p[3] * p[3])) + p[4];
}

/// Peaks on 7 x 7 pixels.
template <class real>
struct Peaks {
    static constexpr size_t side = 7, samples = side * side, parameters = 5;
    size_t count;
    std::vector<real> terms, targets, weights, starts;
    std::vector<double> truth;

    Peaks(size_t n, double noise, unsigned seed = 1) : count(n) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (size_t i = 0; i < samples; ++i) {
            terms.push_back(real(i % side));
            terms.push_back(real(i / side));
        }
        for (size_t k = 0; k < n; ++k) {
            const double p[] = {100 + 20 * uniform(random), 3 + 0.6 * uniform(random), 3 + 0.6 * uniform(random),
                                1.3 + 0.2 * uniform(random), 10 + 3 * uniform(random)};
            truth.insert(truth.end(), p, p + 5);
            for (size_t i = 0; i < samples; ++i)
                targets.push_back(real(peak_at(p, double(i % side), double(i / side)) + noise * normal(random)));
            for (const double start : {90.0, 3.0, 3.0, 1.1, 8.0}) starts.push_back(real(start));
        }
    }
    Problems<real> problems() const { return {count, {}, samples, terms, targets, weights, starts}; }
};

TEST(BatchSolve, ExactSamplesGiveTheTruth) {
    const Peaks<double> made(40, 0);
    const auto found = solve(compiled(peak), made.problems(), {});
    for (size_t i = 0; i < found.parameters.size(); ++i)
        EXPECT_NEAR(found.parameters[i], made.truth[i], 1e-9 * made.truth[i]);
    EXPECT_EQ(found.counts()[size_t(BatchStatus::converged)], made.count);
    const Peaks<float> single(40, 0);
    const auto rough = solve(compiled<float>(peak), single.problems(), {});
    for (size_t i = 0; i < rough.parameters.size(); ++i)
        EXPECT_NEAR(rough.parameters[i], single.truth[i], 2e-4 * single.truth[i]);
}

// At a minimum the error rises whichever way a parameter moves, and its gradient is next to nothing.
TEST(BatchSolve, EndsAreMinima) {
    const Peaks<double> made(30, 4);
    const auto found = solve(compiled(peak), made.problems(), {});
    const auto error = [&](size_t k, const double* p) {
        double sum = 0;
        for (size_t i = 0; i < made.samples; ++i) {
            const double r = peak_at(p, made.terms[2 * i], made.terms[2 * i + 1]) - made.targets[k * made.samples + i];
            sum += r * r;
        }
        return sum;
    };
    for (size_t k = 0; k < made.count; ++k) {
        ASSERT_EQ(found.status[k], int(BatchStatus::converged));
        std::vector<double> p(&found.parameters[5 * k], &found.parameters[5 * k] + 5);
        const double least = error(k, p.data());
        EXPECT_NEAR(found.error[k], least, 1e-10 * least);
        for (size_t i = 0; i < 5; ++i) {
            const double sigma = found.deviations[5 * k + i], middle = p[i];
            double beside[2];
            for (int side = 0; side < 2; ++side) {
                p[i] = middle + (side ? 1e-3 : -1e-3) * sigma;
                beside[side] = error(k, p.data());
                EXPECT_GT(beside[side], least);
            }
            p[i] = middle;
            EXPECT_LT(std::abs(beside[1] - beside[0]), 1e-2 * (beside[1] + beside[0] - 2 * least));
        }
    }
}

// All of them end at the minima that Levenberg and Marquardt's method finds, with bounds and parameters that stay, too.
TEST(BatchSolve, EveryOptimizerFindsTheSameMinima) {
    const Peaks<double> made(60, 2);
    const double none = std::numeric_limits<double>::infinity();
    for (const bool bounded : {false, true}) {
        Options options;
        if (bounded) {
            options.lower = {-none, 2.9, -none, 1.25, -none};
            options.upper = {none, none, 3.1, none, none};
            options.fixed = {false, false, false, false, true};
        }
        const auto by_matrix = solve(compiled(peak), made.problems(), options);
        for (const auto& [name, optimizer] : batch_optimizers()) {
            options.optimizer = optimizer;
            options.iterations = optimizer == BatchOptimizer::adam ? 20000 : 4000;
            options.tolerance = optimizer == BatchOptimizer::adam ? 1e-3 : 1e-6;
            const auto found = solve(compiled(peak), made.problems(), options);
            for (size_t k = 0; k < made.count; ++k) {
                ASSERT_EQ(found.status[k], by_matrix.status[k]) << name << " " << k;
                EXPECT_NEAR(found.error[k], by_matrix.error[k], 1e-5 * by_matrix.error[k]) << name << " " << k;
                for (size_t i = 5 * k; i < 5 * k + 5; ++i) {
                    EXPECT_NEAR(found.parameters[i], by_matrix.parameters[i], 0.003 * by_matrix.deviations[i] + 1e-9)
                        << name << " " << k << " " << i % 5;
                    EXPECT_NEAR(found.deviations[i], by_matrix.deviations[i], 0.003 * by_matrix.deviations[i]) << name;
                }
            }
        }
    }
}

// None of them is what another is: the more one knows of the curvature, the fewer steps it takes.
// Whatever stands in the lanes beside a problem, or stood in its own before: starts at which nothing is finite, too.
TEST(BatchSolve, NoOptimizerMindsItsNeighbours) {
    const Peaks<double> made(60, 2);
    Peaks<double> spoiled = made;
    for (size_t k = 0; k < made.count; k += 3) spoiled.starts[5 * k] = 1e308;
    for (const auto& [name, optimizer] : batch_optimizers()) {
        const Options options{.optimizer = optimizer, .iterations = 300, .tolerance = 1e-3};
        const auto alone = solve(compiled(peak), made.problems(), options);
        const auto beside = solve(compiled(peak), spoiled.problems(), options);
        for (size_t k = 0; k < made.count; ++k) {
            if (k % 3 == 0) continue;
            EXPECT_EQ(alone.steps[k], beside.steps[k]) << name << " " << k;
            for (size_t i = 5 * k; i < 5 * k + 5; ++i)
                EXPECT_EQ(alone.parameters[i], beside.parameters[i]) << name << " " << k;
        }
    }
}

// Another unit of the targets, a power of 2, is another unit of two parameters and changes no step.
TEST(BatchSolve, NoOptimizerMindsTheUnit) {
    const Peaks<double> made(30, 2);
    Peaks<double> tiny = made;
    const double unit = std::ldexp(1.0, -60);
    for (double& y : tiny.targets) y *= unit;
    for (size_t k = 0; k < made.count; ++k)
        for (const size_t i : {0, 4}) tiny.starts[5 * k + i] *= unit;
    for (const auto& [name, optimizer] : batch_optimizers()) {
        const Options options{.optimizer = optimizer, .iterations = 300, .tolerance = 1e-3};
        EXPECT_EQ(solve(compiled(peak), made.problems(), options).steps,
                  solve(compiled(peak), tiny.problems(), options).steps)
            << name;
    }
}

// At a height of 0 no sample depends on where the peak is, nor on its width; a step further all do.
TEST(BatchSolve, ParametersThatMatterLaterAreFound) {
    Peaks<double> made(20, 1);
    for (size_t k = 0; k < made.count; ++k) made.starts[5 * k] = 0;
    for (const auto& [name, optimizer] : batch_optimizers()) {
        const auto found =
            solve(compiled(peak), made.problems(), {.optimizer = optimizer, .iterations = 20000, .tolerance = 1e-2});
        EXPECT_EQ(found.counts()[size_t(BatchStatus::converged)], made.count) << name;
    }
}

TEST(BatchSolve, OptimizersDifferByWhatTheyKnow) {
    const Peaks<double> made(60, 2);
    std::map<std::string, int64_t> steps;
    for (const auto& [name, optimizer] : batch_optimizers()) {
        const auto found =
            solve(compiled(peak), made.problems(), {.optimizer = optimizer, .iterations = 3000, .tolerance = 1e-4});
        steps[name] = std::accumulate(found.steps.begin(), found.steps.end(), int64_t(0));
    }
    EXPECT_LT(steps["lm"], steps["lbfgs"]);
    EXPECT_LT(steps["lbfgs"], steps["cg"]);
    EXPECT_LT(steps["cg"], steps["adam"]);
}

TEST(BatchSolve, ErrorBarsCover) {
    const Peaks<double> made(4000, 3);
    const auto found = solve(compiled(peak), made.problems(), {});
    double within_one = 0, within_two = 0, variance = 0;
    for (size_t i = 0; i < found.parameters.size(); ++i) {
        const double off = std::abs(found.parameters[i] - made.truth[i]) / found.deviations[i];
        within_one += off < 1;
        within_two += off < 1.959964;
    }
    for (size_t k = 0; k < made.count; ++k) variance += found.error[k] / double(made.samples - 5) / double(made.count);
    EXPECT_NEAR(within_one / double(found.parameters.size()), 0.6827, 0.02);
    EXPECT_NEAR(within_two / double(found.parameters.size()), 0.95, 0.01);
    EXPECT_NEAR(variance, 9, 0.15);
    // the covariance' diagonal is the deviations' square, and noise that is known replaces that of the residuals
    Peaks<double> weighted = made;
    weighted.weights.assign(weighted.targets.size(), 1.0 / 9);
    const auto known = solve(compiled(peak), weighted.problems(), {.known_noise = true});
    for (size_t k = 0; k < made.count; ++k) {
        const double ratio = std::sqrt(found.error[k] / double(made.samples - 5)) / 3;
        for (size_t i = 0; i < 5; ++i) {
            EXPECT_NEAR(found.covariance[(5 * k + i) * 5 + i], std::pow(found.deviations[5 * k + i], 2),
                        1e-9 * found.covariance[(5 * k + i) * 5 + i]);
            EXPECT_NEAR(found.deviations[5 * k + i], known.deviations[5 * k + i] * ratio,
                        1e-6 * found.deviations[5 * k + i]);
        }
    }
}

// What stands in the other lanes, and how many threads there are, changes no bit of a problem.
TEST(BatchSolve, ProblemsDontMeet) {
    const Peaks<double> made(3000, 3);
    const auto all = solve(compiled(peak), made.problems(), {});
    set_thread_count(1);
    EXPECT_EQ(solve(compiled(peak), made.problems(), {}).parameters, all.parameters);
    set_thread_count(0);
    for (const size_t k : {0, 17, 2999}) {
        Problems<double> one = made.problems();
        one.count = 1;
        one.targets = one.targets.subspan(k * made.samples, made.samples);
        one.starts = one.starts.subspan(k * 5, 5);
        const auto alone = solve(compiled(peak), one, {});
        EXPECT_TRUE(std::equal(alone.parameters.begin(), alone.parameters.end(), &all.parameters[5 * k]));
        EXPECT_EQ(alone.steps[0], all.steps[k]);
    }
}

// Samples that are missing are as if they had never been there: not a number, no weight, or not in the arrays.
TEST(BatchSolve, MissingSamplesAreLeftOut) {
    Peaks<double> made(50, 2);
    std::vector<double> weights(made.targets.size(), 1), terms, targets;
    std::vector<int64_t> offsets = {0};
    Peaks<double> holes = made, weighted = made;
    for (size_t k = 0; k < made.count; ++k) {
        for (size_t i = 0; i < made.samples; ++i) {
            if ((i * 7 + k) % 5 == 0) {
                holes.targets[k * made.samples + i] = nan_value;
                weights[k * made.samples + i] = 0;
                continue;
            }
            terms.insert(terms.end(), {made.terms[2 * i], made.terms[2 * i + 1]});
            targets.push_back(made.targets[k * made.samples + i]);
        }
        offsets.push_back(int64_t(targets.size()));
    }
    weighted.weights = weights;
    const auto a = solve(compiled(peak), holes.problems(), {}), b = solve(compiled(peak), weighted.problems(), {}),
               c = solve(compiled(peak), Problems<double>{made.count, offsets, 0, terms, targets, {}, made.starts}, {});
    EXPECT_EQ(a.parameters, b.parameters);
    EXPECT_EQ(a.parameters, c.parameters);
    EXPECT_EQ(a.samples, c.samples);
    EXPECT_EQ(a.deviations, c.deviations);
}

TEST(BatchSolve, BoundsHoldAndFixedParametersStay) {
    const Peaks<double> made(60, 2);
    const double inf = std::numeric_limits<double>::infinity();
    Options options{.lower = {0, -inf, -inf, 1.3, 0}, .upper = {inf, inf, inf, inf, 9.5}};
    const auto bounded = solve(compiled(peak), made.problems(), options);
    size_t at_bound = 0;
    for (size_t k = 0; k < made.count; ++k) {
        const double *p = &bounded.parameters[5 * k], *sigma = &bounded.deviations[5 * k];
        EXPECT_GE(p[3], 1.3);
        EXPECT_LE(p[4], 9.5);
        const bool touches = p[3] == 1.3 || p[4] == 9.5;
        EXPECT_EQ(bounded.status[k], int(touches ? BatchStatus::at_bound : BatchStatus::converged)) << k;
        EXPECT_EQ(sigma[3] == 0, p[3] == 1.3);
        at_bound += touches;
    }
    EXPECT_GT(at_bound, made.count / 4);
    EXPECT_LT(at_bound, made.count);

    options = {.fixed = {false, false, false, true, false}};
    const auto fixed = solve(compiled(peak), made.problems(), options),
               free = solve(compiled(peak), made.problems(), {});
    for (size_t k = 0; k < made.count; ++k) {
        EXPECT_EQ(fixed.parameters[5 * k + 3], 1.1);
        EXPECT_EQ(fixed.deviations[5 * k + 3], 0);
        EXPECT_GE(fixed.error[k], free.error[k]);
    }
}

const std::string wave = R"(
struct Terms { real x; };
struct Parameters { real frequency; };
struct Values { real y; };
Values value(Parameters p, Terms t) { return Values(sin(p.frequency * t.x)); })";

TEST(BatchSolve, OfSeveralStartsTheBestEndIsTaken) {
    std::vector<double> terms, targets;
    for (int i = 0; i < 40; ++i) terms.push_back(0.25 * i), targets.push_back(std::sin(2.2 * 0.25 * i));
    const std::vector<double> starts = {0.5, 5.0, 2.0, 3.4};
    Problems<double> problems{1, {}, 40, terms, targets, {}, {}};
    double least = INFINITY;
    for (const double& start : starts) {
        problems.starts = {&start, 1};
        least = std::min(least, solve(compiled(wave), problems, {}).error[0]);
    }
    problems.starts = starts;
    problems.start_count = 4;
    const auto best = solve(compiled(wave), problems, {});
    EXPECT_EQ(best.error[0], least);
    EXPECT_NEAR(best.parameters[0], 2.2, 1e-9);
    problems.starts = {starts.data(), 1};
    problems.start_count = 1;
    EXPECT_GT(solve(compiled(wave), problems, {}).error[0], 1);  // a minimum, but not the least
}

const std::string line = R"(
struct Terms { real x; };
struct Parameters { real slope, offset; };
struct Values { real y, z; };
Values value(Parameters p, Terms t) { return Values(p.slope * t.x + p.offset, p.slope - p.offset * t.x); })";

// Of a linear model the normal equations say the rest.
TEST(BatchSolve, LinearModelsTakeTwoSteps) {
    const std::vector<double> terms = {0, 1, 2, 3}, targets = {1, 0, 3, -1, 4, -2.5, 7.5, -3}, weights = {1, 2, 0.5, 1},
                              starts = {0, 0};
    double ss = 0, so = 0, oo = 0, s = 0, o = 0;
    for (size_t i = 0; i < 4; ++i) {
        const double x = terms[i], w = weights[i], y = targets[2 * i], z = targets[2 * i + 1];
        ss += w * (x * x + 1), so += w * (x - x), oo += w * (1 + x * x), s += w * (x * y + z), o += w * (y - x * z);
    }
    const auto found = solve(compiled(line), Problems<double>{1, {}, 4, terms, targets, weights, starts}, {});
    EXPECT_NEAR(found.parameters[0], (s * oo - o * so) / (ss * oo - so * so), 1e-12);
    EXPECT_NEAR(found.parameters[1], (o * ss - s * so) / (ss * oo - so * so), 1e-12);
    EXPECT_LE(found.steps[0], 6);
}

TEST(BatchSolve, RobustLossesHardlySeeOutliers) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0, 0.05);
    std::vector<double> terms, targets;
    for (int i = 0; i < 60; ++i) {
        terms.push_back(0.1 * i);
        const bool outlier = i % 10 == 3;
        targets.push_back(2 * terms.back() + 1 + normal(random) + (outlier ? 5 : 0));
        targets.push_back(2 - terms.back() + normal(random));
    }
    const std::vector<double> starts = {0, 0};
    const Problems<double> problems{1, {}, 60, terms, targets, {}, starts};
    const auto off = [&](BatchLoss loss) {
        const auto found = solve(compiled(line), problems, {.loss = loss, .loss_scale = 0.1});
        EXPECT_EQ(found.status[0], int(BatchStatus::converged));
        return std::hypot(found.parameters[0] - 2, found.parameters[1] - 1);
    };
    EXPECT_GT(off(BatchLoss::square), 0.1);
    EXPECT_LT(off(BatchLoss::huber), 0.05);
    EXPECT_LT(off(BatchLoss::cauchy), 0.02);
}

TEST(BatchSolve, SaysHowProblemsEnded) {
    // 0: the parameters' sum alone is determined; 1: none; 2: no finite start; 3: too few steps
    const std::string text = R"(
struct Terms { real x; };
struct Parameters { real a, b; };
struct Values { real y; };
Values value(Parameters p, Terms t) { return Values(exp((p.a + p.b) * t.x)); })";
    std::vector<double> terms, targets;
    std::vector<int64_t> offsets = {0, 20, 20, 40};
    for (int i = 0; i < 40; ++i) terms.push_back(0.1 * (i % 20)), targets.push_back(std::exp(0.7 * terms.back()));
    const std::vector<double> starts = {0.1, 0.1, 0.1, 0.1, 1e5, 0.1};
    const auto found = solve(compiled(text), Problems<double>{3, offsets, 0, terms, targets, {}, starts}, {});
    EXPECT_EQ(found.status[0], int(BatchStatus::underdetermined));
    EXPECT_NEAR(found.parameters[0] + found.parameters[1], 0.7, 1e-6);
    EXPECT_TRUE(std::isinf(found.deviations[0]));
    EXPECT_EQ(found.status[1], int(BatchStatus::no_samples));
    EXPECT_EQ(found.status[2], int(BatchStatus::not_finite));
    EXPECT_EQ(found.parameters[4], 1e5);
    const auto soon = solve(
        compiled(text), Problems<double>{1, {}, 20, {terms.data(), 20}, {targets.data(), 20}, {}, {starts.data(), 2}},
        {.iterations = 1});
    EXPECT_EQ(soon.status[0], int(BatchStatus::max_iterations));
}

// A neighbour with a hole has weights, and this problem still none.
TEST(BatchSolve, HolesOfNeighboursChangeNoBit) {
    const Peaks<double> made(64, 3);
    Peaks<double> holes = made;
    for (size_t k = 1; k < made.count; k += 2) holes.targets[k * made.samples + k % made.samples] = nan_value;
    const auto a = solve(compiled(peak), made.problems(), {}), b = solve(compiled(peak), holes.problems(), {});
    for (size_t k = 0; k < made.count; k += 2) {
        EXPECT_EQ(a.error[k], b.error[k]) << k;
        for (size_t i = 0; i < 5; ++i) {
            EXPECT_EQ(a.parameters[5 * k + i], b.parameters[5 * k + i]);
            EXPECT_EQ(a.deviations[5 * k + i], b.deviations[5 * k + i]);
        }
    }
}

TEST(BatchSolve, WhatFloatsCannotHoldIsNoMinimum) {
    const std::string text = R"(
struct Terms { real x; };
struct Parameters { real a, tau; };
struct Values { real y; };
Values value(Parameters p, Terms t) { return Values(p.a * exp(-t.x / p.tau)); })";
    std::vector<float> terms, targets;
    for (int i = 0; i < 20; ++i) {
        terms.push_back(1e-15f * float(i));
        targets.push_back(1e6f * std::exp(-terms.back() / 8e-15f));
    }
    const std::vector<float> starts = {8e5f, 5e-15f}, small = {1, 1};
    EXPECT_EQ(solve(compiled<float>(text), Problems<float>{1, {}, 20, terms, targets, {}, starts}, {}).status[0],
              int(BatchStatus::not_finite));  // the square of a derivative is infinite
    for (float& y : targets) y *= 1e-30f;
    for (float& x : terms) x *= 1e15f;
    EXPECT_NE(solve(compiled<float>(text), Problems<float>{1, {}, 20, terms, targets, {}, small}, {}).steps[0], 0);
}

TEST(BatchSolve, InfiniteDerivativesCountAsNone) {
    const std::string text = R"(
struct Terms { real t; };
struct Parameters { real a, tau, beta; };
struct Values { real y; };
Values value(Parameters p, Terms t) { return Values(p.a * exp(-pow(t.t / p.tau, p.beta))); })";
    std::vector<double> terms, targets;
    for (int i = 0; i < 40; ++i) terms.push_back(i), targets.push_back(3 * std::exp(-std::pow(i / 9.0, 0.7)));
    const std::vector<double> starts = {2, 6, 0.9};
    const auto found = solve(compiled(text), Problems<double>{1, {}, 40, terms, targets, {}, starts}, {});
    EXPECT_EQ(found.status[0], int(BatchStatus::converged));
    EXPECT_NEAR(found.parameters[1], 9, 1e-8);
    EXPECT_NEAR(found.parameters[2], 0.7, 1e-9);
}

TEST(BatchModel, AKeptModelThatWasCutIsCompiledAgain) {
    compiled(line);
    const auto kept = [] {
        std::set<std::filesystem::path> files;
        for (const auto& file : std::filesystem::directory_iterator(compiled_models_folder()))
            files.insert(file.path());
        return files;
    };
    const auto now = std::chrono::system_clock::now().time_since_epoch().count();
    const ModelText model = read_model("own.glsl", line + "// at " + std::to_string(now) + "\n");
    const std::set<std::filesystem::path> before = kept();
    EXPECT_GT(CompiledModel(model, Precision::double_precision).seconds(), 0);
    EXPECT_EQ(CompiledModel(model, Precision::double_precision).seconds(), 0);
    for (const auto& file : kept())
        if (!before.contains(file)) std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    EXPECT_GT(CompiledModel(model, Precision::double_precision).seconds(), 0);
}

TEST(BatchSolve, WrongArraysAreRefused) {
    const Peaks<double> made(3, 0);
    const auto complaint = [&](auto change, Options options = {}) {
        Problems<double> p = made.problems();
        change(p);
        try {
            solve(compiled(peak), p, options);
        } catch (const UserError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const auto nothing = [](Problems<double>&) {};
    EXPECT_EQ(complaint(nothing), "");
    EXPECT_NE(complaint([](auto& p) { p.targets = p.targets.first(10); }).find("targets: 10 numbers"),
              std::string::npos);
    EXPECT_NE(complaint([](auto& p) { p.terms = p.terms.first(10); }).find("terms: 10 numbers"), std::string::npos);
    EXPECT_NE(complaint([](auto& p) { p.weights = p.targets.first(3); }).find("weights: 3 numbers"), std::string::npos);
    EXPECT_NE(complaint([](auto& p) { p.starts = p.starts.first(7); }).find("starts: 7 numbers"), std::string::npos);
    EXPECT_NE(complaint(nothing, {.lower = {0, 0, 0, 2, 0}, .upper = {1, 1, 1, 1, 1}}).find("bounds of width"),
              std::string::npos);
    EXPECT_NE(complaint(nothing, {.lower = {0}}).find("bounds: 1 numbers"), std::string::npos);
    EXPECT_NE(complaint(nothing, {.loss_scale = 0}).find("loss-scale"), std::string::npos);
    static const std::vector<int64_t> falling = {0, 100, 50, 147}, late = {1, 49, 98, 147};
    EXPECT_NE(complaint([](auto& p) { p.offsets = falling; }).find("offsets: number 2"), std::string::npos);
    EXPECT_NE(complaint([](auto& p) { p.offsets = late; }).find("offsets: begin with 1"), std::string::npos);
}

TEST(BatchModel, WhatTheCompilerMissesIsTold) {
    const auto complaint = [](const std::string& text) {
        try {
            const CompiledModel model(read_model("own.glsl", text), Precision::double_precision);
        } catch (const UserError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    compiled(line);
    std::string text = line;
    text.replace(text.find("t.x + p.offset"), 3, "t.w");
    EXPECT_EQ(complaint(text).substr(0, 11), "own.glsl:5:");
    EXPECT_NE(complaint(text).find("w"), std::string::npos);
    text = line;
    text.replace(text.find("p.slope * "), 10, "slope2 * ");
    EXPECT_NE(complaint(text).find("slope2"), std::string::npos);
}

}  // namespace
}  // namespace radiafit::batch
