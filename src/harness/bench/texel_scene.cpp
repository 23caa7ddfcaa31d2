#include "bench/texel_scene.h"

#include <numeric>

#include "base/rng.h"
#include "bench/texel_oracle.h"
#include "bench/work.h"
#include "compute/texel_compute_engine.h"
#include "cpu/texel_batch_loader.h"
#include "cpu/texel_models.h"
#include "cpu/texel_solver.h"
#include "fragment/gl_distributor.h"
#include "fragment/texel_engine.h"
#include "samples/raster_distributor.h"

namespace radiafit::harness {
namespace {

using Text = texel_text::lafortune<Pack>;
using ExactText = texel_text::lafortune<double>;
using Texels = TexelBatches<Text>;
constexpr size_t per_texel = Texels::N;  // parameters

/// The CPU's samples. Texels are in another order there: texel_of[i] is its i-th.
struct Batches {
    std::vector<Texels::Batch> batches;
    std::vector<uint32_t> texel_of;

    Batches(const TexelSource& source, const TexelLoader& loader)
        : batches((source.texel_count() + Pack::size - 1) / Pack::size), texel_of(source.texel_count()) {
        using Loader = TexelBatchLoader<Text>;
        std::vector<Loader> workers(static_cast<size_t>(thread_count()));
        parallel_for(source.block_count(), 1, [&](size_t block, int worker) {
            Loader& w = workers[size_t(worker)];
            const uint32_t begin = uint32_t(block) * TexelSource::block;
            const size_t count = w.load(source, loader, begin);
            for (size_t i = 0; i < w.order.size(); ++i) texel_of[begin + i] = begin + w.order[i];
            for (size_t b = 0; b < count; ++b) batches[block * Loader::batches_per_block + b] = w.batches[b];
        });
    }
    /// Values [texels][each] in this order, from the atlas', and back.
    std::vector<float> sorted(const std::vector<float>& values, size_t each) const {
        std::vector<float> out(values.size());
        for (size_t i = 0; i < texel_of.size(); ++i) std::copy_n(&values[texel_of[i] * each], each, &out[i * each]);
        return out;
    }
    std::vector<float> unsorted(const std::vector<float>& values, size_t each) const {
        std::vector<float> out(values.size());
        for (size_t i = 0; i < texel_of.size(); ++i) std::copy_n(&values[i * each], each, &out[texel_of[i] * each]);
        return out;
    }
};

struct TexelsOnCpu {
    Texels problem;
    LaneEngine<Texels> engine;
    TexelsOnCpu(const Batches& all, const TexelOptions& options)
        : problem(all.batches, all.texel_of.size(), options), engine(problem) {}
};

class TexelScene final : public BenchScene {
public:
    TexelScene(Dataset dataset, bool by_opengl)
        : dataset_((require_lights(dataset), std::move(dataset))),
          atlas_(reflectance_atlas(dataset_, dataset_.normal_map.side)),
          views_(dataset_.split(false)) {
        options_.model = find_texel_model("lafortune");
        options_.surface_side = atlas_.side();
        if (by_opengl) {
            GlDistributor distributor(atlas_);
            source_ = gather_texels(dataset_, atlas_, views_, {&distributor});
        } else {
            source_ = distribute();
        }
        loader_.emplace(dataset_, atlas_, views_, options_);
        batches_.emplace(*source_, *loader_);
        const TexelResult at_start = solve(0);
        start_ = at_start.parameters;
        samples_ = std::accumulate(at_start.samples.begin(), at_start.samples.end(), uint64_t(0));
        Rng rng(1);
        for (size_t texel = 0; texel < atlas_.texel_count(); ++texel)
            for (const auto& [lowest, highest] : options_.model->bounds) {
                const double low = std::max(lowest, -2.0) - 0.1, high = std::min(highest, 2.0) + 0.1;  // some beyond
                point_.push_back(rng.uniform(float(low), float(high)));
                direction_.push_back(rng.uniform(-1, 1));
            }
    }

    SceneFacts facts() const override {
        return {.images = views_.size(),
                .samples = samples_,
                .sites = atlas_.texel_count(),
                .parameters = atlas_.texel_count() * per_texel,
                .site_samples = samples_};
    }

    bool has(Device device) const override { return device != Device::redistributing && device != Device::scattering; }
    ExactSums exact_sums() override;
    DeviceSums sums(Device device) override;

    std::vector<double> reference_fit() override {
        std::vector<double> errors;
        for (const TraceRow& row : solve(fit_iterations).trace.rows) errors.push_back(row.error);
        return errors;
    }
    double fit_tolerance() const override { return 2e-3; }

    std::unique_ptr<TimedDevice> contestant(Device device) override;

private:
    TexelResult solve(int iterations) const {
        return texel_solvers(*options_.model)
            .stream({*source_, *loader_, options_}, OptimizerOptions{.iterations = iterations}, {});
    }
    std::unique_ptr<TexelSource> distribute() const {
        return gather_texels(dataset_, atlas_, views_, worker_pointers(raster_distributors(atlas_)));
    }
    DeviceSums cpu_sums() const;
    template <class E>
    DeviceSums opengl_sums(E& engine) const;
    template <class Owner>
    std::unique_ptr<TimedDevice> started(std::unique_ptr<Owner> owner, std::vector<float> start,
                                         EngineHooks hooks) const {
        owner->engine.count();
        return std::make_unique<EngineContestant<Owner>>(std::move(owner), std::move(start), std::move(hooks));
    }

    Dataset dataset_;
    TexelOptions options_;
    TriangleAtlas atlas_;
    std::vector<uint32_t> views_;
    std::unique_ptr<TexelSource> source_;
    std::optional<TexelLoader> loader_;
    std::optional<Batches> batches_;
    std::vector<float> start_, point_, direction_;  ///< [texels][per_texel]
    uint64_t samples_ = 0;                          ///< that count
};

ExactSums TexelScene::exact_sums() {
    const size_t texels = atlas_.texel_count();
    ExactSums out;
    out.samples.resize(texels);
    for (size_t texel = 0; texel <= texels; ++texel) out.first_parameter.push_back(per_texel * texel);
    for (const Quantity q : {error_sum, gauss_newton_sum, curvature_sum}) out.sums[q].resize(texels);
    for (const Quantity q : {gradient_sum, diagonal_sum}) out.sums[q].resize(texels * per_texel);
    parallel_for(source_->block_count(), 1, [&](size_t block, int) {
        TexelSamples samples;
        const uint32_t begin = uint32_t(block) * TexelSource::block;
        source_->read(begin, samples);
        for (uint32_t i = 0; i + 1 < samples.first.size(); ++i) {
            const uint32_t texel = begin + i;
            std::vector<ExactSample<ExactText>> exact;
            for (const TexelRadiance& s : samples.of(i)) {
                exact.emplace_back(dataset_.views[views_[s.image]], atlas_, texel, s.value);
                if (!exact.back().above) exact.pop_back();
            }
            out.samples[texel] = uint32_t(exact.size());
            TexelLocal<ExactText>::Parameters p, d;
            std::copy_n(&point_[per_texel * texel], per_texel, p.begin());
            std::copy_n(&direction_[per_texel * texel], per_texel, d.begin());
            const ExactTexel<ExactText> of(exact, options_, p, d);
            out.sums[error_sum][texel] = of.error;
            out.sums[gauss_newton_sum][texel] = of.gauss_newton;
            out.sums[curvature_sum][texel] = of.curvature;
            std::copy(of.gradient.begin(), of.gradient.end(), &out.sums[gradient_sum][per_texel * texel]);
            std::copy(of.diagonal.begin(), of.diagonal.end(), &out.sums[diagonal_sum][per_texel * texel]);
        }
    });
    return out;
}

DeviceSums TexelScene::cpu_sums() const {
    TexelsOnCpu on(*batches_, options_);
    Texels& problem = on.problem;
    const size_t texels = problem.problem_count(), length = problem.begin(problem.block_count());
    const std::vector<uint32_t> samples = problem.count().samples;
    std::vector<Pack> point(length), direction(length), gradient(length), diagonal(length);
    problem.set(batches_->sorted(point_, per_texel), point.data());
    problem.set(batches_->sorted(direction_, per_texel), direction.data());
    std::vector<float> error(texels), gauss_newton(texels), curvature(texels), all(texels * per_texel);
    parallel_for(problem.block_count(), 16, [&](size_t block, int) {
        const size_t at = problem.begin(block), first = block * Pack::size;
        double errors[Pack::size];
        Texels::Sums line;
        problem.direction(block, &point[at], &gradient[at], &diagonal[at], errors);
        problem.line(block, &point[at], &direction[at], line);
        for (size_t lane = 0; lane < Pack::size && first + lane < texels; ++lane) {
            error[first + lane] = float(errors[lane]);
            gauss_newton[first + lane] = line.gauss_newton[int(lane)];
            curvature[first + lane] = line.curvature[int(lane)];
        }
    });
    DeviceSums out;
    out.samples.resize(texels);
    for (size_t i = 0; i < texels; ++i) out.samples[batches_->texel_of[i]] = samples[i];
    out.sums[error_sum] = batches_->unsorted(error, 1);
    out.sums[gauss_newton_sum] = batches_->unsorted(gauss_newton, 1);
    out.sums[curvature_sum] = batches_->unsorted(curvature, 1);
    problem.get(gradient.data(), all);
    out.sums[gradient_sum] = batches_->unsorted(all, per_texel);
    problem.get(diagonal.data(), all);
    out.sums[diagonal_sum] = batches_->unsorted(all, per_texel);
    return out;
}

template <class E>
DeviceSums TexelScene::opengl_sums(E& engine) const {
    DeviceSums out{.samples = engine.count().samples};
    engine.reset(point_);
    engine.gradient_pass(true);
    const auto evaluation = engine.read_evaluation();
    engine.set_line(point_, direction_);
    engine.directional_pass();
    const auto line = engine.read_line();
    out.sums = {evaluation.error, evaluation.gradient, evaluation.diagonal, line.gauss_newton, line.curvature};
    return out;
}

DeviceSums TexelScene::sums(Device device) {
    if (!needs_opengl(device)) return cpu_sums();
    if (device == Device::compute) {
        TexelComputeEngine engine(dataset_, atlas_, views_, options_, *source_);
        return opengl_sums(engine);
    }
    TexelFragmentEngine engine(dataset_, atlas_, views_, options_, fragment_options(device));
    return opengl_sums(engine);
}

std::unique_ptr<TimedDevice> TexelScene::contestant(Device device) {
    const auto least = [this](double sample_bytes, double numbers) {
        const Kept kept{sample_bytes, 1, double(atlas_.texel_count()) * numbers * sizeof(float)};
        return [this, kept](Pass pass) { return lafortune_load(pass, double(samples_), kept); };
    };
    const auto finish = [] { gl().Finish(); };
    if (!needs_opengl(device)) {
        EngineHooks hooks{.load = least(double(sizeof(Texels::Batch::Row)) / Pack::size, per_texel)};
        if (device == Device::cpu) hooks.distribute = [this] { distribute(); };
        return started(std::make_unique<TexelsOnCpu>(*batches_, options_), batches_->sorted(start_, per_texel), hooks);
    }
    if (device == Device::compute) {
        constexpr double sample_bytes = 8, numbers = 12;  // 16 bits a channel and the image; three maps of four numbers
        return started(std::make_unique<OnOpenGl<TexelComputeEngine>>(dataset_, atlas_, views_, options_, *source_),
                       start_, {.wait = finish, .load = least(sample_bytes, numbers)});
    }
    auto owner =
        std::make_unique<OnOpenGl<TexelFragmentEngine>>(dataset_, atlas_, views_, options_, fragment_options(device));
    return started(std::move(owner), start_, {.wait = finish});
}

}  // namespace

std::unique_ptr<BenchScene> texel_scene(Dataset dataset, bool by_opengl) {
    return std::make_unique<TexelScene>(std::move(dataset), by_opengl);
}

}  // namespace radiafit::harness
