// Passes of the compute engine over a light field map, by process CPU time per sample, vertex and pass: under a
// software renderer that is the time of one core; of a GPU it tells nothing, and wall time per image is told beside.
// The CPU engine's passes stand next to it.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>

#include "base/clock.h"
#include "base/log.h"
#include "base/wording.h"
#include "compute/compute_engine.h"
#include "cpu/lfm_engine.h"
#include "model/lfm_start.h"
#include "samples/raster_distributor.h"

namespace radiafit {
namespace {

struct Scene {
    Dataset dataset;
    TriangleAtlas atlas;
    VertexRings rings;
    SampleList list;
    LfmProblem<float> problem;
    StreamEngine<float> cpu;
    std::unique_ptr<Context> context;
    ComputeEngine compute;

    explicit Scene(const std::filesystem::path& path)
        : dataset(open_dataset(path)),
          atlas(dataset.mesh, 8),
          rings(dataset.mesh),
          list(build_sample_list(dataset, atlas, dataset.split(false), worker_pointers(raster_distributors(atlas)))),
          problem(dataset, atlas, rings, list, {}),
          cpu(problem),
          context(Context::create({})),
          compute(dataset, atlas, rings, list, {}) {
        const ProblemStatistics statistics = cpu.count();
        compute.count();
        const std::vector<float> start = lfm_start(compute.layout(), statistics.mean, 1);
        cpu.reset(start);
        compute.reset(start);
        cpu.make_room({});
        compute.make_room({});
    }
    double samples() const { return 3.0 * double(list.samples.size()); }  ///< each of three vertices
};
std::unique_ptr<Scene> scene;

template <class Pass>
void time_pass(benchmark::State& state, const Pass& pass) {
    pass();
    gl().Finish();
    const double cpu_begin = cpu_time_s(), begin = wall_time_s();
    for (auto _ : state) {
        pass();
        gl().Finish();
    }
    const double passes = double(state.iterations());
    state.counters["cpu_ns_per_sample"] = 1e9 * (cpu_time_s() - cpu_begin) / passes / scene->samples();
    state.counters["ms_per_image"] = 1e3 * (wall_time_s() - begin) / passes / double(scene->list.image_count());
}

void add(const std::string& name, const auto& pass) {
    benchmark::RegisterBenchmark(("compute/" + name).c_str(),
                                 [=](benchmark::State& state) { time_pass(state, [&] { pass(scene->compute); }); })
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("cpu/" + name).c_str(),
                                 [=](benchmark::State& state) { time_pass(state, [&] { pass(scene->cpu); }); })
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

void add_all() {
    add("gradient", [](auto& engine) { engine.gradient_pass(false); });
    add("gradient_and_preconditioner", [](auto& engine) { engine.gradient_pass(true); });
    add("line", [](auto& engine) { engine.directional_pass(); });
    add("dot", [](auto& engine) { engine.dot({{vector::trial_g, vector::trial_g, vector::none, PRODUCT_NORM}}); });
    add("advance", [](auto& engine) {
        engine.update(Update::advance, {vector::trial, vector::p, vector::d}, {number::taken}, {});
    });
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) {
    radiafit::name_options_by_flag();
    benchmark::Initialize(&argc, argv);
    if (argc != 2) {
        radiafit::log_error("bench_compute",
                            "usage: bench_compute DATASET [--benchmark_...]; radiafit generate makes one");
        return 2;
    }
    try {
        radiafit::scene = std::make_unique<radiafit::Scene>(argv[1]);
        fmt::print("{}: {} samples, {} vertices, {} images\n", radiafit::scene->context->renderer(),
                   radiafit::scene->list.samples.size(), radiafit::scene->rings.vertex_count(),
                   radiafit::scene->list.image_count());
        radiafit::add_all();
        benchmark::RunSpecifiedBenchmarks();
        radiafit::scene.reset();
    } catch (const std::exception& e) {
        radiafit::log_error("bench_compute", e.what());
        return 2;
    }
    return 0;
}
