// Passes of the fragment engine over reflectance samples, images resident on the device, by process CPU time per sample
// that counts: under a software renderer that is the time of one core, however many work; of a GPU it says nothing.
// Passes over texels that a verb ends with are included; they weigh less, the more images there are. Arguments: width
// and height of images, their number. One eye: all images are seen from one place, as under a fixed camera.
#include <benchmark/benchmark.h>

#include <numeric>

#include "base/clock.h"
#include "fragment/peaks.h"
#include "fragment/texel_engine.h"
#include "gl_scene.h"
#include "temporary_folder.h"

namespace radiafit::harness {
namespace {

/// Noise in 16 bits, over a grid whose texels take a pixel in every image, or over a sphere of about as many texels.
class Scene {
public:
    /// side: of images in pixels, and of a grid in texels.
    Scene(bool grid, Passes passes, int side, int view_count, bool one_eye = false) {
        std::mt19937 rng(1);
        std::uniform_real_distribution<double> uniform(-1, 1);
        const auto any = [&] { return Vec3d(uniform(rng), uniform(rng), uniform(rng)); };
        Dataset header;
        header.name = "noise";
        header.encoding = Encoding::u16_linear;
        if (grid)
            header.grid = Grid::centered(side, side, 2.0 / side);
        else
            header.mesh = bumpy_sphere(4);
        DatasetWriter writer(folder_.path() / "noise");
        writer.set_encoding(header.encoding);
        std::vector<uint16_t> pixels(3 * size_t(side) * size_t(side));
        for (auto& channel : pixels) channel = uint16_t(rng());
        const std::vector<uint8_t> mask(pixels.size() / 3, 1);
        for (int i = 0; i < view_count; ++i) {
            View view;
            view.name = "view" + std::to_string(i);
            Vec3d towards = (Vec3d::UnitZ() + 0.5 * any()).normalized();
            if (grid) {
                view.camera = header.grid.camera_at(one_eye ? Vec3d(0, 0, 3) : Vec3d(3 * towards), view.name);
            } else {
                view.camera = orbit_camera(i, view_count, side, side);
                towards = view.camera.center().normalized();
            }
            view.light = Light{Light::Kind::near, 2.5 * towards + 0.7 * any(), Vec3d(4, 4, 4)};
            writer.add(view, reinterpret_cast<const uint8_t*>(pixels.data()), mask);
        }
        writer.finish(header);
        dataset_ = open_dataset(folder_.path() / "noise");
        if (grid)
            atlas_ = std::make_unique<GridAtlas>(make_atlas(dataset_.grid));
        else
            atlas_ = std::make_unique<TriangleAtlas>(dataset_.mesh, std::max(4, side / 72));
        std::vector<uint32_t> views(dataset_.views.size());
        std::iota(views.begin(), views.end(), 0u);
        TexelOptions options;
        options.model = find_texel_model("lafortune");
        FragmentOptions fragment_options;
        fragment_options.passes = passes;
        fragment_options.keep_on_device = true;
        engine_ = std::make_unique<TexelFragmentEngine>(dataset_, *atlas_, views, options, fragment_options);
        for (const uint32_t n : engine_->count().samples) samples_ += n;
        const std::vector<float> start = engine_->start();
        engine_->reset(start);
        engine_->set_line(start, std::vector<float>(start.size(), 0.01f));
    }
    TexelFragmentEngine& engine() { return *engine_; }
    double samples() const { return samples_; }
    double pairs() const { return double(atlas_->texel_count()) * double(dataset_.views.size()); }

private:
    TemporaryFolder folder_;
    Dataset dataset_;
    std::unique_ptr<Atlas> atlas_;
    std::unique_ptr<TexelFragmentEngine> engine_;
    double samples_ = 0;
};

/// What a verb's passes declare to cost, all together.
Work declared(TexelFragmentEngine& engine, void (*verb)(TexelFragmentEngine&)) {
    engine.passes().tally(true);
    verb(engine);
    Work work;
    for (const auto& [label, tally] : engine.passes().tallies()) work += tally.work();
    engine.passes().tally(false);
    return work;
}

void run(benchmark::State& state, bool grid, bool one_eye, Passes passes, void (*verb)(TexelFragmentEngine&)) {
    static const std::unique_ptr<Context> context = Context::create({});
    static const GlPeaks peaks = measure_gl_peaks();
    Scene scene(grid, passes, int(state.range(0)), int(state.range(1)), one_eye);
    const Work work = declared(scene.engine(), verb);  // the first one compiles, too
    gl().Finish();
    double cpu_s = 1e30, wall_s = 1e30;  // of the fastest turn: others' work on the machine only adds
    for (auto _ : state) {
        const double cpu = cpu_time_s(), wall = wall_time_s();
        verb(scene.engine());
        gl().Finish();
        cpu_s = std::min(cpu_s, cpu_time_s() - cpu);
        wall_s = std::min(wall_s, wall_time_s() - wall);
    }
    state.counters["ns_per_sample"] = 1e9 * cpu_s / scene.samples();
    state.counters["counting"] = scene.samples() / scene.pairs();
    state.counters["operations"] = double(work.operations) / scene.samples();
    state.counters["of_operation_peak"] = double(work.operations) / wall_s / peaks.operations_s;
    state.counters["of_read_peak"] = double(work.reads) / wall_s / peaks.reads_s;
}

constexpr auto direction = [](TexelFragmentEngine& engine) { engine.gradient_pass(false); };
constexpr auto with_diagonal = [](TexelFragmentEngine& engine) { engine.gradient_pass(true); };
constexpr auto line = [](TexelFragmentEngine& engine) { engine.directional_pass(); };

#define OF_SCENE(name, grid, one_eye, passes, ...)                                     \
    BENCHMARK_CAPTURE(run, name##_direction, grid, one_eye, passes, direction)         \
    __VA_ARGS__->Unit(benchmark::kMillisecond);                                        \
    BENCHMARK_CAPTURE(run, name##_with_diagonal, grid, one_eye, passes, with_diagonal) \
    __VA_ARGS__->Unit(benchmark::kMillisecond);                                        \
    BENCHMARK_CAPTURE(run, name##_line, grid, one_eye, passes, line) __VA_ARGS__->Unit(benchmark::kMillisecond)
OF_SCENE(grid_one_eye_combined, true, true, Passes::combined, ->Args({400, 230})->UseRealTime());
OF_SCENE(grid_combined, true, false,
         Passes::combined, ->Args({400, 16})->Args({400, 230})->Args({1000, 48})->UseRealTime());
OF_SCENE(mesh_combined, false, false, Passes::combined, ->Args({576, 64})->UseRealTime());
OF_SCENE(grid_paper, true, false, Passes::paper, ->Args({400, 16})->UseRealTime());
OF_SCENE(mesh_paper, false, false, Passes::paper, ->Args({576, 16})->UseRealTime());

}  // namespace
}  // namespace radiafit::harness

BENCHMARK_MAIN();
