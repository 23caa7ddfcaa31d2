#include "reference/tiny_texel.h"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "base/pack.h"
#include "model/texel_texts.h"
#include "reference/texel_residuals.h"

namespace radiafit::fits {
namespace {

/// As ceres::TinySolver asks for it. Beyond a bound the model is that at the bound.
template <class Text>
class TinyFunction {
public:
    using Scalar = double;
    using Model = TexelLocal<Text>;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Model::parameters };

    void take(TexelSamples<Text> samples) { samples_ = samples; }
    int NumResiduals() const { return 3 * int(samples_.size()); }
    bool operator()(const double* x, double* residuals, double* jacobian) const {
        typename Model::Parameters p;
        for (int i = 0; i < Model::parameters; ++i)
            p[size_t(i)] = std::clamp(x[i], Model::bounds(i)[0], Model::bounds(i)[1]);
        const size_t rows = size_t(NumResiduals());
        texel_residuals<Text>(samples_, p, residuals, jacobian, 1, rows);
        for (size_t i = 0; jacobian && i < p.size(); ++i)
            if (p[i] != x[i]) std::fill_n(jacobian + i * rows, rows, 0.0);
        return true;
    }

private:
    TexelSamples<Text> samples_;
};

/// The same in 32-bit floats, eight samples side by side; the last eight are filled up with samples of weight 0.
template <class Text>
class TinyPackFunction {
public:
    using Scalar = float;
    using Lanes = typename Text::template with<Pack>;
    using Model = TexelLocal<Lanes>;
    enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Model::parameters };

    void take(TexelSamples<Text> samples) {
        eights_.clear();
        for (size_t first = 0; first < samples.size(); first += Pack::size) {
            Eight& eight = eights_.emplace_back();
            for (size_t lane = 0; lane < size_t(Pack::size); ++lane) {
                const bool there = first + lane < samples.size();
                const auto& sample = samples[there ? first + lane : first];
                for (size_t k = 0; k < size_t(Text::term_count); ++k) eight.terms.x[k].set(int(lane), sample.term[k]);
                for (size_t c = 0; c < 3; ++c) eight.target[c].set(int(lane), sample.target[c]);
                eight.root.set(int(lane), there ? std::sqrt(sample.weight) : 0.0f);
            }
        }
    }
    int NumResiduals() const { return 3 * Pack::size * int(eights_.size()); }
    bool operator()(const float* x, float* residuals, float* jacobian) const {
        constexpr size_t B = size_t(Model::basis), Q = size_t(Model::shape), N = size_t(Model::parameters);
        const size_t rows = size_t(NumResiduals());
        typename Model::Parameters p;
        for (size_t i = 0; i < N; ++i)
            p[i] = Pack(std::clamp(x[i], float(Model::bounds(int(i))[0]), float(Model::bounds(int(i))[1])));
        if (jacobian) std::fill_n(jacobian, N * rows, 0.0f);
        const auto shape = Model::shape_of(p);
        for (const Eight& eight : eights_) {
            std::array<Pack, size_t(Model::shared)> q;
            if (jacobian) {
                q = Model::columns(shape, eight.terms);
            } else {
                const auto basis = Lanes::basis(shape, eight.terms);
                std::copy_n(basis.x, B, q.begin());
            }
            for (size_t c = 0; c < 3; ++c, residuals += Pack::size) {
                Pack value(0.0f);
                for (size_t k = 0; k < B; ++k) value += p[3 * k + c] * q[k];
                store(residuals, eight.root * (value - eight.target[c]));
                if (!jacobian) continue;
                for (size_t k = 0; k < B; ++k) store(jacobian + (3 * k + c) * rows, eight.root * q[k]);
                const auto slope = [&](size_t i) {
                    return eight.root * p[3 * size_t(Model::slope_basis(int(i))) + c] * q[B + i];
                };
                for (size_t i = 0; i < Q; ++i) {
                    Pack sum = slope(i);
                    for (size_t l = 1; l < size_t(Model::shaped); ++l) sum += slope(l * Q + i);
                    store(jacobian + (3 * B + i) * rows, sum);
                }
                jacobian += Pack::size;
            }
        }
        for (size_t i = 0; jacobian && i < N; ++i)
            if (p[i][0] != x[i]) std::fill_n(jacobian - rows + i * rows, rows, 0.0f);
        return true;
    }

private:
    struct Eight {
        typename Model::Terms terms;
        Pack target[3];
        Pack root;  ///< of the weight
    };
    static void store(float* to, const Pack& x) { std::memcpy(to, &x.v, sizeof x.v); }

    std::vector<Eight> eights_;
};

template <class Text, class Function>
class ByTinySolver final : public CeresTexels<Text> {
public:
    explicit ByTinySolver(const CeresTexelOptions& options) : options_(options) {}

private:
    using Scalar = typename Function::Scalar;
    CeresTexelOutcome<Text> solve_some(TexelSamples<Text> samples,
                                       const typename TexelLocal<Text>::Parameters& start) override {
        function_.take(samples);
        typename ceres::TinySolver<Function>::Parameters x;
        for (size_t i = 0; i < start.size(); ++i) x[Eigen::Index(i)] = Scalar(start[i]);
        residuals_.resize(size_t(function_.NumResiduals()));
        function_(x.data(), residuals_.data(), nullptr);
        Scalar cost = 0;
        for (const Scalar r : residuals_) cost += r * r / 2;
        solver_.options.max_num_iterations = options_.iterations;
        solver_.options.function_tolerance = Scalar(options_.tolerance) * cost;  // TinySolver's is absolute
        solver_.options.cost_threshold = 0;
        solver_.options.gradient_tolerance = Scalar(1e-14);
        solver_.options.parameter_tolerance = Scalar(1e-12);
        solver_.options.initial_trust_region_radius = Scalar(options_.initial_radius);
        const auto& summary = solver_.Solve(function_, &x);
        if (!std::isfinite(summary.final_cost)) return {start, double(cost), summary.iterations, Status::not_finite};
        typename TexelLocal<Text>::Parameters p;
        for (size_t i = 0; i < p.size(); ++i)
            p[i] = std::clamp(double(x[Eigen::Index(i)]), TexelLocal<Text>::bounds(int(i))[0],
                              TexelLocal<Text>::bounds(int(i))[1]);
        return {p, double(summary.final_cost), summary.iterations,
                summary.iterations < options_.iterations ? Status::stationary : Status::max_iterations};
    }

    CeresTexelOptions options_;
    Function function_;
    ceres::TinySolver<Function> solver_;
    std::vector<Scalar> residuals_;
};

}  // namespace

template <class Text>
std::unique_ptr<CeresTexels<Text>> tiny_texels([[maybe_unused]] const CeresTexelOptions& options) {
    if constexpr (TexelLocal<Text>::parameters > most_ceres_parameters) {
        throw std::logic_error("tiny_texels: ceres_texels() refuses it");
    } else {
        if (options.method == CeresTexelOptions::Method::tiny_pack)
            return std::make_unique<ByTinySolver<Text, TinyPackFunction<Text>>>(options);
        return std::make_unique<ByTinySolver<Text, TinyFunction<Text>>>(options);
    }
}

#define EACH(NAME) \
    template std::unique_ptr<CeresTexels<texel_text::NAME<double>>> tiny_texels(const CeresTexelOptions&);
RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH

}  // namespace radiafit::fits
