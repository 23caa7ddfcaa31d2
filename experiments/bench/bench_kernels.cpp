// The kernels that carry the CPU engines, each with the operations and bytes it declares and their share of what this
// machine reached in the same run.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>

#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/wording.h"
#include "cpu/lfm_engine.h"
#include "cpu/peaks.h"
#include "cpu/two_step_solver.h"
#include "cpu/vertex_solver.h"
#include "model/lfm_start.h"
#include "model/lfm_text.h"
#include "reference/ring_resampler.h"
#include "samples/raster_distributor.h"
#include "synthetic/synthetic.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

/// What a kernel does for one radiance sample of one vertex, K = 1: useful operations on three channels, and bytes that
/// come from beyond L1 (the maps of a vertex stay there).
struct Cost {
    double flops, bytes;
};
// r = g h - L t, r^2, r h and r g with their sums: 8 a channel. A widened target and its place.
constexpr Cost direction_cost{24, 20};
// r, a = dg h + g dh, b = dg dh, and four products with their sums: 14 a channel.
constexpr Cost line_cost{42, 20};

struct Scene {
    Dataset dataset;
    TriangleAtlas atlas;
    VertexRings rings;
    SampleList list;
    AtomicFolder folder;  // never committed, so it is removed at the end
    std::unique_ptr<DiskRecords> records;
    LfmOptions options;
    size_t vertex = 0;  ///< one with the median number of samples
    CpuPeaks peaks;

    explicit Scene(const fs::path& path)
        : dataset(open_dataset(path)),
          atlas(dataset.mesh, 8),
          rings(dataset.mesh),
          folder(fs::temp_directory_path() / "radiafit-bench", AtomicFolder::Existing::replace),
          peaks(measure_cpu_peaks()) {
        const auto owned = raster_distributors(atlas);
        const std::vector<Distributor*> workers = worker_pointers(owned);
        list = build_sample_list(dataset, atlas, dataset.split(false), workers, TargetSpace::stored, nullptr);
        write_records(folder.path(), dataset, atlas, rings, dataset.split(false), workers, {});
        records = std::make_unique<DiskRecords>(folder.path(), "");
        std::vector<std::pair<uint32_t, size_t>> by_samples;
        for (size_t v = 0; v < records->vertex_count(); ++v)
            if (records->vertex(v).samples) by_samples.emplace_back(records->vertex(v).samples, v);
        std::nth_element(by_samples.begin(), by_samples.begin() + long(by_samples.size() / 2), by_samples.end());
        vertex = by_samples[by_samples.size() / 2].second;
    }
};
std::unique_ptr<Scene> scene;

/// `seconds` the whole loop took, of one core or of all that were asked for.
void tell(benchmark::State& state, double seconds, double samples, Cost cost, int threads = 1) {
    const double total = samples * double(state.iterations());
    state.counters["ns_per_sample"] = 1e9 * seconds / total;
    if (cost.flops == 0) return;
    state.counters["gflop_per_s"] = 1e-9 * total * cost.flops / seconds;
    state.counters["of_fma_peak"] = 1e-9 * total * cost.flops / seconds / threads / scene->peaks.fma_gflop_s;
    const double samples_bytes = cost.bytes * scene->records->vertex(scene->vertex).samples;
    if (samples_bytes < 48 * 1024) return;  // these stay in L1
    state.counters["of_l2_peak"] = 1e-9 * total * cost.bytes / seconds / threads / scene->peaks.l2_gb_s;
}

/// The median vertex, loaded, at its start and along its gradient.
struct Loaded {
    VertexProblem problem;
    std::vector<Lanes<float>> p, d, g;
    double samples;
    Loaded() : problem(scene->dataset, scene->atlas, scene->rings, scene->records->views(), scene->options) {
        std::vector<uint8_t> block;
        scene->records->read(scene->vertex, scene->vertex + 1, block);
        problem.load(scene->vertex, *scene->records, block.data());
        samples = scene->records->vertex(scene->vertex).samples;
        p.assign(problem.begin(1), Lanes<float>{0.7f, 0.6f, 0.5f, 0});
        d = g = p;
    }
};

void direction(benchmark::State& state) {
    Loaded x;
    double error[3];
    const double begin = cpu_time_s();
    for (auto _ : state) {
        x.problem.direction(0, x.p.data(), x.g.data(), nullptr, error);
        benchmark::DoNotOptimize(error[0]);
    }
    tell(state, cpu_time_s() - begin, x.samples, direction_cost);
}

void line(benchmark::State& state) {
    Loaded x;
    LineLanes sums;
    const double begin = cpu_time_s();
    for (auto _ : state) {
        x.problem.line(0, x.p.data(), x.d.data(), sums);
        benchmark::DoNotOptimize(sums);
    }
    tell(state, cpu_time_s() - begin, x.samples, line_cost);
}

/// What the paper's record holds of a sample (Section 4.3), unpacked: nothing is left to do but the sums.
struct PaperSample {
    float target[3];
    uint32_t texel;       ///< in the ring's surface maps, one after another
    float coordinate[2];  ///< in the vertex's view map, 0 to 1
};

std::vector<PaperSample> paper_samples(const Scene& s, size_t v) {
    const Frame frame = vertex_frames(s.dataset.mesh)[v];
    std::vector<PaperSample> result;
    uint32_t map = 0;
    for (const Corner& corner : s.rings.ring(v)) {
        for (uint32_t g = s.list.tile_groups[corner.triangle]; g < s.list.tile_groups[corner.triangle + 1]; ++g) {
            const auto at = view_coordinate(frame, s.dataset.mesh.positions[v],
                                            s.dataset.views[s.list.views[s.list.groups[g].image]].camera.center());
            for (const Sample& sample : s.list.of_group(g)) {
                const float weight =
                    s.atlas.tile(corner.triangle).barycentric(sample.local)[corner.corner] * s.list.scale;
                PaperSample x{{}, map + sample.local, {float(at[0]), float(at[1])}};
                for (size_t c = 0; c < 3; ++c) x.target[c] = weight * float(sample.rgb[c]);
                result.push_back(x);
            }
        }
        map += s.atlas.tile(corner.triangle).texels();
    }
    return result;
}

/// Both passes as one would write them first: record after record, channel after channel, each looking into the view
/// map at the record's coordinate.
void straightforward(benchmark::State& state) {
    const Scene& s = *scene;
    const LfmLayout layout(s.rings, s.atlas, s.options.view_side, 1);
    const size_t v = s.vertex, view = layout.view_offset(v) - layout.offset(v);
    const size_t m = size_t(s.options.view_side);
    const std::vector<PaperSample> samples = paper_samples(s, v);
    std::vector<float> p(layout.block_size(v), 0.6f), d(p.size(), 0.1f), g(p.size());
    struct Place {
        size_t texel[4];
        float weight[4];
    };
    using Text = LfmText<float>;
    const auto place = [&](const PaperSample& x) {
        const auto footprint = Text::lfm_view_bilinear({x.coordinate[0], x.coordinate[1]}, float(m));
        const auto w = Text::lfm_view_weights(footprint);
        const size_t first = view + 4 * (size_t(footprint.y) * m + size_t(footprint.x));
        return Place{{first, first + 4, first + 4 * m, first + 4 * m + 4}, {w.x, w.y, w.z, w.w}};
    };
    const auto look_up = [](const std::vector<float>& x, const Place& at, size_t c) {
        float h = 0;
        for (int j = 0; j < 4; ++j) h += at.weight[j] * x[at.texel[j] + c];
        return h;
    };
    const double begin = cpu_time_s();
    for (auto _ : state) {
        double error[3] = {}, sums[4][3] = {};
        std::fill(g.begin(), g.end(), 0.0f);
        for (const PaperSample& x : samples) {
            const Place at = place(x);
            for (size_t c = 0; c < 3; ++c) {
                const size_t texel = 4 * x.texel + c;
                const float h = look_up(p, at, c), r = p[texel] * h - x.target[c];
                error[c] += 0.5 * double(r) * double(r);
                g[texel] += r * h;
                for (int j = 0; j < 4; ++j) g[at.texel[j] + c] += at.weight[j] * r * p[texel];
            }
        }
        for (const PaperSample& x : samples) {
            const Place at = place(x);
            for (size_t c = 0; c < 3; ++c) {
                const size_t texel = 4 * x.texel + c;
                const float h = look_up(p, at, c), dh = look_up(d, at, c);
                const float r = p[texel] * h - x.target[c], a = d[texel] * h + p[texel] * dh, b = d[texel] * dh;
                sums[0][c] += double(a * a);
                sums[1][c] += double(a * a + 2 * r * b);
                sums[2][c] += double(a * b);
                sums[3][c] += double(b * b);
            }
        }
        benchmark::DoNotOptimize(error);
        benchmark::DoNotOptimize(sums);
        benchmark::ClobberMemory();
    }
    tell(state, cpu_time_s() - begin, double(samples.size()), {});
}

/// All vertices from disk to their end, `threads` of them at a time: per sample, vertex and iteration of modern CG.
void two_step(benchmark::State& state) {
    set_thread_count(int(state.range(0)));
    const VertexSolverOptions options{.optimizer = {.iterations = 20}};
    uint64_t sample_iterations = 0;
    const double begin = wall_time_s();
    for (auto _ : state) {
        const TwoStepResult result =
            solve_two_step(scene->dataset, scene->atlas, scene->rings, *scene->records, scene->options, options);
        sample_iterations = result.sample_iterations;
    }
    tell(state, wall_time_s() - begin, double(sample_iterations),
         {direction_cost.flops + line_cost.flops, direction_cost.bytes + line_cost.bytes}, int(state.range(0)));
    set_thread_count(0);
}

/// The same from the sample list in memory, as the solver stream on the CPU.
void stream(benchmark::State& state) {
    set_thread_count(int(state.range(0)));
    uint64_t sample_iterations = 0;
    const double begin = wall_time_s();
    for (auto _ : state)
        sample_iterations = solve_vertices(scene->dataset, scene->atlas, scene->rings, scene->list, scene->options,
                                           {.optimizer = {.iterations = 20}})
                                .sample_iterations;
    tell(state, wall_time_s() - begin, double(sample_iterations),
         {direction_cost.flops + line_cost.flops, direction_cost.bytes + line_cost.bytes}, int(state.range(0)));
    set_thread_count(0);
}

/// One iteration of modern CG over the sample list in memory, all vertices: a sweep for the line, one for the gradient.
void stream_iteration(benchmark::State& state) {
    set_thread_count(1);
    LfmProblem<float> problem(scene->dataset, scene->atlas, scene->rings, scene->list, scene->options);
    StreamEngine<float> engine(problem);
    const ProblemStatistics statistics = engine.count();
    engine.reset(lfm_start(problem.layout(), statistics.mean, 1));
    double samples = 0;
    for (uint32_t n : statistics.samples) samples += n;
    const ConjugateGradients schedule({.refresh_every = 1 << 30, .first_refresh = 0});
    engine.make_room(schedule.room());
    int k = 0;
    const auto iterate = [&] {
        schedule.judge(engine, k);
        schedule.move(engine, k++);
    };
    iterate();
    const double begin = cpu_time_s();
    for (auto _ : state) iterate();
    tell(state, cpu_time_s() - begin, samples, {});
    set_thread_count(0);
}

void rasterizer(benchmark::State& state) {
    Rasterizer raster;
    size_t k = 0;
    const double begin = cpu_time_s();
    for (auto _ : state)
        raster.draw(scene->dataset.mesh, scene->dataset.views[k++ % scene->dataset.views.size()].camera);
    state.counters["ns_per_triangle"] =
        1e9 * (cpu_time_s() - begin) / double(state.iterations()) / double(scene->dataset.mesh.triangle_count());
}

void distribution(benchmark::State& state) {
    RasterDistributor distributor(scene->atlas);
    ImageStream stream(scene->dataset, StreamSource::memory);
    TargetImage image;
    Distribution out;
    double kept = 0;
    uint32_t k = 0;
    const double begin = cpu_time_s();
    for (auto _ : state) {
        const uint32_t view = k++ % uint32_t(scene->dataset.views.size());
        stream.load(view, image);
        distributor.distribute(scene->dataset.views[view].camera, image, out);
        kept += out.kept_pixels;
    }
    state.counters["ns_per_sample"] = 1e9 * (cpu_time_s() - begin) / kept;
}

/// What factorization starts from, dense: of the median vertex, at the paper's high resolution.
void resampling(benchmark::State& state) {
    const TriangleAtlas atlas(scene->dataset.mesh, 16);
    const TileViews tiles = resample_tiles(scene->dataset, atlas, scene->dataset.split(false), TargetSpace::stored);
    const RingResampler resampler(scene->dataset, atlas, scene->rings, tiles, 16);
    DenseLightField field;
    const double begin = cpu_time_s();
    for (auto _ : state) benchmark::DoNotOptimize(resampler.resample(scene->vertex, field));
    state.counters["ns_per_entry"] =
        1e9 * (cpu_time_s() - begin) / double(state.iterations()) / double(field.counts.entries);
}

BENCHMARK(direction);
BENCHMARK(line);
BENCHMARK(straightforward);
BENCHMARK(two_step)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(stream)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(stream_iteration)->Iterations(40)->Unit(benchmark::kMillisecond);
BENCHMARK(rasterizer)->Unit(benchmark::kMicrosecond);
BENCHMARK(distribution)->Unit(benchmark::kMicrosecond);
BENCHMARK(resampling)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    radiafit::name_options_by_flag();
    benchmark::Initialize(&argc, argv);
    if (argc != 2) {
        radiafit::log_error("bench_kernels",
                            "usage: bench_kernels DATASET [--benchmark_...]; radiafit generate makes one");
        return 2;
    }
    try {
        radiafit::harness::scene = std::make_unique<radiafit::harness::Scene>(argv[1]);
        const radiafit::CpuPeaks& p = radiafit::harness::scene->peaks;
        fmt::print("peaks: triad {:.1f} GB/s on {} threads; one core: L2 {:.0f} GB/s, multiply-add {:.0f} GFLOP/s\n",
                   p.triad_gb_s, radiafit::thread_count(), p.l2_gb_s, p.fma_gflop_s);
        fmt::print("median vertex: {} samples\n",
                   radiafit::harness::scene->records->vertex(radiafit::harness::scene->vertex).samples);
        benchmark::RunSpecifiedBenchmarks();
        radiafit::harness::scene.reset();
    } catch (const std::exception& e) {
        radiafit::log_error("bench_kernels", e.what());
        return 2;
    }
    return 0;
}
