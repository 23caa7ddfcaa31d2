// Batched fits of Lafortune texels on one core, against Ceres on the same texels in the same run. Times are CPU time of
// the one thread, so that other programs on the machine weigh less.
#include <benchmark/benchmark.h>

#include <map>

#include "base/clock.h"
#include "base/flush_subnormals.h"
#include "cpu/peaks.h"
#include "cpu/texel_models.h"
#include "reference/ceres_texel.h"
#include "texel_scene.h"

namespace radiafit::harness {
namespace {

using namespace testing;
using Text = texel_text::lafortune<double>;
using Fit = TexelFit<texel_text::lafortune<Pack>>;

constexpr size_t samples_per_texel = 230;
constexpr double noise = 0.005;

// Operations of a sweep on one sample of one texel, a multiply-add being two: D 3, log 20, exp 20, D^n and its slopes
// 7, residuals 12, their squares 8, weights 5, 15 linear sums 30, 15 shared sums 30.
constexpr double sweep_flops = 135;
constexpr double sweep_bytes = 28;

/// Texels whose lobes many samples meet, or few.
struct Lobes {
    const char* name;
    double n_low, n_high;
};
constexpr Lobes lobes[] = {{"moderate", 3, 30}, {"sharp", 30, 150}};

struct Scene {
    std::vector<LafortuneTexel> texels;
    std::vector<Fit::Batch> batches;
    std::vector<Fit::Parameters> starts;
    CpuPeaks peaks = measure_cpu_peaks();

    explicit Scene(const Lobes& which, size_t count = 512) : batches(count / 8) {
        Rng rng(1);
        for (size_t i = 0; i < count; ++i) {
            texels.push_back(sample_texel(rng, random_lobe(rng, which.n_low, which.n_high), samples_per_texel, noise));
            for (const LafortuneSample& s : texels.back()) batches[i / 8].push(int(i % 8), s);
        }
        for (const auto& batch : batches)
            for (const auto& start : Fit::start(batch)) starts.push_back(start);
    }
    static const Scene& of(int64_t which) {
        static std::map<int64_t, Scene> scenes;
        return scenes.try_emplace(which, lobes[which]).first->second;
    }
};

double rmse(double error) { return std::sqrt(2 * error / double(3 * samples_per_texel)); }

void fit(benchmark::State& state) {
    const Scene& scene = Scene::of(state.range(0));
    double iterations = 0, error = 0, trials = 0;
    for (const auto& batch : scene.batches) {
        int longest = 0;
        for (const auto& o : Fit().solve(batch)) {
            iterations += o.iterations;
            error += rmse(o.error);
            longest = std::max(longest, o.iterations);
        }
        trials += longest;
    }
    const double begin = cpu_time_s();
    for (auto _ : state)
        for (const auto& batch : scene.batches) benchmark::DoNotOptimize(Fit().solve(batch));
    const auto texels = double(scene.texels.size());
    state.counters["fits_per_s"] = texels * double(state.iterations()) / (cpu_time_s() - begin);
    state.counters["rmse"] = error / texels;
    state.counters["iterations"] = iterations / texels;
    state.counters["of_pack"] = trials / double(scene.batches.size());
    state.SetLabel(lobes[state.range(0)].name);
}

void best_start(benchmark::State& state) {
    const Scene& scene = Scene::of(state.range(0));
    const double begin = cpu_time_s();
    for (auto _ : state)
        for (const auto& batch : scene.batches) benchmark::DoNotOptimize(Fit::start(batch));
    const double texels = double(scene.texels.size()) * double(state.iterations());
    state.counters["us_per_texel"] = 1e6 * (cpu_time_s() - begin) / texels;
}

/// Samples into lanes.
void fill(benchmark::State& state) {
    const Scene& scene = Scene::of(0);
    Fit::Batch batch;
    const double begin = cpu_time_s();
    for (auto _ : state) {
        batch.clear();
        for (size_t i = 0; i < 8; ++i)
            for (const LafortuneSample& s : scene.texels[i]) batch.push(int(i), s);
        benchmark::DoNotOptimize(batch.rows().data());
    }
    state.counters["us_per_texel"] = 1e6 * (cpu_time_s() - begin) / (8 * double(state.iterations()));
}

void sweep(benchmark::State& state) {
    const Scene& scene = Scene::of(state.range(0));
    TexelLocal<texel_text::lafortune<Pack>>::Parameters p;
    for (size_t i = 0; i < p.size(); ++i)
        for (int lane = 0; lane < 8; ++lane) p[i].set(lane, scene.starts[size_t(lane)][i]);
    const FlushSubnormals flush;
    const double begin = cpu_time_s();
    for (auto _ : state) benchmark::DoNotOptimize(texel_sums<texel_text::lafortune<Pack>>(scene.batches[0].rows(), p));
    const double seconds = cpu_time_s() - begin, total = 8 * double(samples_per_texel) * double(state.iterations());
    state.counters["ns_per_sample"] = 1e9 * seconds / total;
    state.counters["gflop_per_s"] = 1e-9 * sweep_flops * total / seconds;
    state.counters["of_fma_peak"] = 1e-9 * sweep_flops * total / seconds / scene.peaks.fma_gflop_s;
    state.counters["of_l2_peak"] = 1e-9 * sweep_bytes * total / seconds / scene.peaks.l2_gb_s;
}

/// Ceres begins at the same starts; the search for them isn't in its time but is in the batch's.
void ceres(benchmark::State& state, CeresTexelOptions::Linear linear) {
    const Scene& scene = Scene::of(state.range(0));
    constexpr size_t count = 128;
    CeresTexelOptions options;
    options.linear = linear;
    const auto solver = ceres_texels<Text>(options);
    const auto solve = [&](size_t i) {
        LafortuneModel::Parameters start;
        std::copy(scene.starts[i].begin(), scene.starts[i].end(), start.begin());
        return solver->solve(scene.texels[i], start);
    };
    double iterations = 0, error = 0, ours = 0, good = 0;
    for (size_t i = 0; i < count; i += 8) {
        const auto outcomes = Fit().solve(scene.batches[i / 8]);
        for (size_t lane = 0; lane < 8; ++lane) {
            const auto o = solve(i + lane);
            iterations += o.iterations;
            error += rmse(o.error);
            ours += rmse(outcomes[lane].error);
            good += rmse(outcomes[lane].error) <= 1.05 * rmse(o.error) ? 1 : 0;
        }
    }
    if (good < 0.97 * count) return state.SkipWithError("the two disagree: no comparison of times");
    const double begin = cpu_time_s();
    for (auto _ : state)
        for (size_t i = 0; i < count; ++i) benchmark::DoNotOptimize(solve(i));
    const double own = (cpu_time_s() - begin) / double(state.iterations()) / count;
    const double again = cpu_time_s();
    for (int i = 0; i < 20; ++i)
        for (size_t k = 0; k < count / 8; ++k) benchmark::DoNotOptimize(Fit().solve(scene.batches[k]));
    const double batched = (cpu_time_s() - again) / 20 / count;
    state.counters["fits_per_s"] = 1 / own;
    state.counters["rmse"] = error / count;
    state.counters["rmse_batched"] = ours / count;
    state.counters["iterations"] = iterations / count;
    state.counters["batched_is_faster"] = own / batched;
    state.SetLabel(lobes[state.range(0)].name);
}

BENCHMARK(fill);
BENCHMARK(sweep)->Arg(0)->Arg(1);
BENCHMARK(best_start)->Arg(0);
BENCHMARK(fit)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ceres, dense_qr, CeresTexelOptions::Linear::dense_qr)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ceres, dense_normal_cholesky, CeresTexelOptions::Linear::dense_normal_cholesky)
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace radiafit::harness

BENCHMARK_MAIN();
