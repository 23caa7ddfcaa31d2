#include "bench/light_field_scene.h"

#include "base/rng.h"
#include "bench/lfm_oracle.h"
#include "bench/work.h"
#include "compute/compute_engine.h"
#include "cpu/lfm_engine.h"
#include "fragment/fragment_engine.h"
#include "fragment/gl_distributor.h"
#include "model/lfm_start.h"
#include "samples/raster_distributor.h"

namespace radiafit::harness {
namespace {

/// Values in LfmLayout's order without its padding, which is every fourth.
template <class T>
std::vector<T> without_padding(const std::vector<T>& values) {
    std::vector<T> out;
    out.reserve(values.size() / 4 * 3);
    for (size_t i = 0; i < values.size(); ++i)
        if (i % 4 != 3) out.push_back(values[i]);
    return out;
}

struct LightFieldOnCpu {
    LfmProblem<float> problem;
    StreamEngine<float> engine;
    template <class... Args>
    explicit LightFieldOnCpu(Args&&... args) : problem(std::forward<Args>(args)...), engine(problem) {}
};

class LightFieldScene final : public BenchScene {
public:
    LightFieldScene(Dataset dataset, bool by_opengl)
        : dataset_((require_light_field(dataset), std::move(dataset))),
          atlas_(dataset_.mesh, options_.surface_side),
          rings_(dataset_.mesh),
          layout_(rings_, atlas_, options_.view_side, options_.terms),
          views_(dataset_.split(false)) {
        if (by_opengl) {
            GlDistributor distributor(atlas_);
            list_ = build_sample_list(dataset_, atlas_, views_, {&distributor});
        } else {
            list_ = distribute();
        }
        LfmProblem<float> problem(dataset_, atlas_, rings_, list_, options_);
        start_ = lfm_start(layout_, problem.count().mean, 1);
        Rng rng(1);
        for (size_t i = 0; i < layout_.size(); ++i) {
            point_.push_back(i % 4 == 3 ? 0 : rng.uniform(-0.5f, 1.5f));
            direction_.push_back(i % 4 == 3 ? 0 : rng.uniform(-1, 1));
        }
    }

    SceneFacts facts() const override {
        return {.images = views_.size(),
                .samples = list_.samples.size(),
                .sites = layout_.problem_count(),
                .parameters = layout_.parameter_count(),
                .site_samples = 3 * list_.samples.size()};
    }

    bool has(Device) const override { return true; }
    ExactSums exact_sums() override;
    DeviceSums sums(Device device) override;

    std::vector<double> reference_fit() override {
        LfmProblem<double> problem(dataset_, atlas_, rings_, list_, options_);
        StreamEngine<double> engine(problem);
        engine.count();
        engine.reset(start_);
        std::vector<double> errors;
        for (const TraceRow& row : optimize(engine, OptimizerOptions{.iterations = fit_iterations}).rows)
            errors.push_back(row.error);
        return errors;
    }
    double fit_tolerance() const override { return 1e-4; }

    std::unique_ptr<TimedDevice> contestant(Device device) override;

private:
    /// Penalties have no part in sums over samples.
    LfmOptions without_penalties() const {
        LfmOptions options = options_;
        options.lambda_surface = options.lambda_view = options.mu = 0;
        return options;
    }
    SampleList distribute() const {
        return build_sample_list(dataset_, atlas_, views_, worker_pointers(raster_distributors(atlas_)));
    }
    /// Compute shaders that distribute in every sweep; images from host memory.
    template <class Made>
    std::unique_ptr<Made> redistributing(Device device, const LfmOptions& options) const {
        const auto accumulate = device == Device::scattering ? Accumulate::scatter_fixed : Accumulate::gather;
        return std::make_unique<Made>(dataset_, atlas_, rings_, views_, options, StreamOptions{}, accumulate);
    }
    DeviceSums cpu_sums() const;
    template <class E>
    DeviceSums opengl_sums(E& engine) const;
    Kept kept(double sample_bytes, double gradient_orders) const {
        return {sample_bytes, gradient_orders, double(layout_.size() * sizeof(float))};
    }
    template <class Owner>
    std::unique_ptr<TimedDevice> started(std::unique_ptr<Owner> owner, EngineHooks hooks) const {
        owner->engine.count();
        return std::make_unique<EngineContestant<Owner>>(std::move(owner), start_, std::move(hooks));
    }

    LfmOptions options_;
    Dataset dataset_;
    TriangleAtlas atlas_;
    VertexRings rings_;
    LfmLayout layout_;
    std::vector<uint32_t> views_;
    SampleList list_;
    std::vector<float> start_, point_, direction_;
};

ExactSums LightFieldScene::exact_sums() {
    const LfmOracle oracle = lfm_oracle(dataset_, atlas_, rings_, layout_, without_penalties(), list_,
                                        {point_.begin(), point_.end()}, {direction_.begin(), direction_.end()});
    ExactSums out;
    out.samples = oracle.samples;
    for (size_t v = 0; v <= layout_.problem_count(); ++v)
        out.first_parameter.push_back(v < layout_.problem_count() ? layout_.offset(v) / 4 * 3 : layout_.size() / 4 * 3);
    out.sums[gradient_sum] = without_padding(oracle.gradient);
    out.sums[diagonal_sum] = without_padding(oracle.diagonal);
    out.sums[error_sum] = oracle.error;
    out.sums[gauss_newton_sum] = oracle.gauss_newton;
    out.sums[curvature_sum] = oracle.curvature;
    out.sums[third_sum] = oracle.third;
    out.sums[fourth_sum] = oracle.fourth;
    // Engines have E over S-bar, and the diagonal no lower than a share of its largest entry.
    for (size_t v = 0; v < layout_.problem_count(); ++v) {
        const double scale = oracle.samples[v] ? double(layout_.surface_texels(v)) / oracle.samples[v] : 1;
        for (size_t q = 0; q < out.sums.size(); ++q) {
            const bool of_parameters = q == gradient_sum || q == diagonal_sum;
            const size_t begin = of_parameters ? out.first_parameter[v] : 3 * v;
            const size_t end = of_parameters ? out.first_parameter[v + 1] : 3 * v + 3;
            double largest[3] = {};
            for (size_t i = begin; i < end; ++i) {
                ExactSum& sum = out.sums[q][i];
                sum.value *= scale, sum.magnitude *= scale;
                largest[i % 3] = std::max(largest[i % 3], sum.value);
            }
            for (size_t i = begin; q == diagonal_sum && i < end; ++i) {
                ExactSum& sum = out.sums[q][i];
                sum.value = std::max(sum.value, 1e-4 * largest[i % 3] + 1e-30);
                sum.magnitude = std::max(sum.magnitude, sum.value);
            }
        }
    }
    return out;
}

DeviceSums LightFieldScene::cpu_sums() const {
    LfmProblem<float> problem(dataset_, atlas_, rings_, list_, without_penalties());
    DeviceSums out{.samples = problem.count().samples};
    const size_t length = layout_.size() / 4;
    std::vector<Lanes<float>> point(length), direction(length), gradient(length), diagonal(length);
    problem.set(point_, point.data());
    problem.set(direction_, direction.data());
    for (const Quantity q : {error_sum, gauss_newton_sum, curvature_sum, third_sum, fourth_sum})
        out.sums[q].resize(problem.problem_count());
    parallel_for(problem.block_count(), 1, [&](size_t v, int) {
        const size_t at = problem.begin(v);
        double error[3];
        LineLanes line;
        problem.direction(v, &point[at], &gradient[at], &diagonal[at], error);
        problem.line(v, &point[at], &direction[at], line);
        for (int c = 0; c < 3; ++c) {
            const size_t i = 3 * v + size_t(c);
            out.sums[error_sum][i] = float(error[c]);
            out.sums[gauss_newton_sum][i] = float(line.gauss_newton[c]);
            out.sums[curvature_sum][i] = float(line.curvature[c]);
            out.sums[third_sum][i] = float(line.third[c]);
            out.sums[fourth_sum][i] = float(line.fourth[c]);
        }
    });
    std::vector<float> all(layout_.size());
    problem.get(gradient.data(), all);
    out.sums[gradient_sum] = without_padding(all);
    problem.get(diagonal.data(), all);
    out.sums[diagonal_sum] = without_padding(all);
    return out;
}

template <class E>
DeviceSums LightFieldScene::opengl_sums(E& engine) const {
    DeviceSums out{.samples = engine.count().samples};
    engine.reset(point_);
    engine.gradient_pass(true);
    const auto evaluation = engine.read_evaluation();
    engine.set_line(point_, direction_);
    engine.directional_pass();
    const auto line = engine.read_line();
    out.sums = {evaluation.error,
                without_padding(evaluation.gradient),
                without_padding(evaluation.diagonal),
                line.gauss_newton,
                line.curvature,
                line.third,
                line.fourth};
    return out;
}

DeviceSums LightFieldScene::sums(Device device) {
    if (!needs_opengl(device)) return cpu_sums();
    if (device == Device::compute) {
        ComputeEngine engine(dataset_, atlas_, rings_, list_, without_penalties());
        return opengl_sums(engine);
    }
    if (units_of(device) == Device::compute) {
        const auto engine = redistributing<ComputeEngine>(device, without_penalties());
        return opengl_sums(*engine);
    }
    FragmentEngine engine(dataset_, atlas_, rings_, views_, without_penalties(), fragment_options(device));
    return opengl_sums(engine);
}

std::unique_ptr<TimedDevice> LightFieldScene::contestant(Device device) {
    const auto least = [this](const Kept& kept) {
        return [this, kept](Pass pass) {
            return light_field_load(pass, double(list_.samples.size()), options_.terms, kept);
        };
    };
    const auto finish = [] { gl().Finish(); };
    if (!needs_opengl(device)) {
        EngineHooks hooks{.load = least(kept(sizeof(Sample), 1))};
        if (device == Device::cpu) hooks.distribute = [this] { distribute(); };
        return started(std::make_unique<LightFieldOnCpu>(dataset_, atlas_, rings_, list_, options_), hooks);
    }
    if (device == Device::compute) {
        constexpr double least_bytes = 4, orders = 2;  // by texel, and by triangle and image
        return started(std::make_unique<OnOpenGl<ComputeEngine>>(dataset_, atlas_, rings_, list_, options_),
                       {.wait = finish, .load = least(kept(least_bytes, orders))});
    }
    if (units_of(device) == Device::compute) {
        auto load = [this](Pass pass) {
            PassLoad of_model = light_field_load(pass, double(list_.samples.size()), options_.terms, {});
            of_model.bytes.reset();  // images are read by the pixel, whether or not it is a sample
            return of_model;
        };
        return started(redistributing<OnOpenGl<ComputeEngine>>(device, options_), {.wait = finish, .load = load});
    }
    auto owner = std::make_unique<OnOpenGl<FragmentEngine>>(dataset_, atlas_, rings_, views_, options_,
                                                            fragment_options(device));
    return started(std::move(owner), {.wait = finish});
}

}  // namespace

std::unique_ptr<BenchScene> light_field_scene(Dataset dataset, bool by_opengl) {
    return std::make_unique<LightFieldScene>(std::move(dataset), by_opengl);
}

}  // namespace radiafit::harness
