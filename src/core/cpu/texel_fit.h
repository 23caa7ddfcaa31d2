#pragma once
#include "cpu/texel_sums.h"
#include "model/status.h"
#include "optim/trace.h"

/// Levenberg-Marquardt for texel-local models, eight texels at a time, one sweep over their samples per trial.
/// Coefficients are linear: after every sweep they are solved exactly, so that steps are in the shape alone (variable
/// projection, Golub and Pereyra 1973, with Kaufman's Jacobian). A model without a shape is one linear solve.
namespace radiafit {

struct TexelFitOptions {
    int iterations = 50;
    /// A texel is done when a step in its shape lowers E by no more, or promises no more, relatively.
    double tolerance = 1e-6;
};

template <int count>
struct TexelOutcome {
    std::array<float, size_t(count)> parameters;  ///< TexelLocal's order, in the canonical gauge, always finite
    double error = 0;                             ///< E = 1/2 sum w r^2
    int iterations = 0;                           ///< trials
    uint32_t samples = 0;                         ///< with a weight
    Status status = Status::active;
};

/// What is known of eight texels before they are seen: adds
///     1/2 sum over the coefficients of weight_k (a_kc - mean_kc)^2 + 1/2 sum over the shape of weight_i (s_i -
///     mean_i)^2
/// to E, so that what samples don't determine stays at the means.
template <class Text>
struct TexelPrior {
    static constexpr size_t B = size_t(Text::basis_count), Q = size_t(Text::shape_count);
    std::array<std::array<WidePack, B>, 3> mean{};  ///< [channel][basis], of each texel
    std::array<double, B> weight{};
    std::array<WidePack, Q> shape_mean{};
    std::array<double, Q> shape_weight{};
};

/// `Text`: a model's text with real = Pack. Every texel takes its own steps and ends by itself: which others share its
/// pack does not change a bit of its result.
///
/// How a texel ends: stationary; max_iterations; underdetermined (its samples don't determine all parameters: the fit
/// is as good as any, its parameters mean little); no_samples and not_finite (a sample is): the model's first start, no
/// coefficients.
template <class Text>
class TexelFit {
public:
    using Model = TexelLocal<Text>;
    using Batch = TexelBatch<Text::term_count>;
    using Prior = TexelPrior<Text>;
    using Outcome = TexelOutcome<Model::parameters>;
    using Outcomes = std::array<Outcome, Pack::size>;
    using Parameters = std::array<float, size_t(Model::parameters)>;

    explicit TexelFit(TexelFitOptions options = {}) : options_(options) {}

    /// From the best of the model's starts. Allocates nothing. `trace`, if given, gets the batch's rows: the sum of
    /// E over a texel's samples, from the start on.
    Outcomes solve(const Batch& batch, Trace* trace = nullptr, const Prior* prior = nullptr) const;
    /// From given parameters, which are put within bounds.
    Outcomes solve(const Batch& batch, const std::array<Parameters, Pack::size>& start) const;
    /// The best of the model's starts for each texel, its coefficients solved for.
    static std::array<Parameters, Pack::size> start(const Batch& batch);

private:
    static constexpr int B = Model::basis, Q = Model::shape, C = Model::shared;
    using Mask = WidePack::Mask;
    /// Parameters and what the samples say of them.
    struct Point {
        std::array<SmallVector<WidePack, B>, 3> a;  ///< [channel][basis]
        SmallVector<WidePack, Q> s;
        TexelSums<Text> sums;
        void take(const Mask& which, const Point& other);
    };
    /// E's Gauss-Newton model along the shape, the coefficients at their optimum throughout.
    struct Quadratic {
        SmallMatrix<WidePack, Q> curvature;  ///< lower triangle
        SmallVector<WidePack, Q> gradient;
    };
    struct Step {
        SmallVector<WidePack, Q> by;
        WidePack promised;  ///< how much the model says E falls
    };

    static Point best_start(const Batch& batch, const Prior* prior);
    Outcomes run(const Batch& batch, const Point& start, Trace* trace, const Prior* prior) const;
    static void evaluate(const Batch& batch, Point& p, const Prior* prior);
    static void add_prior(const Prior& prior, Point& p);
    // Only for models with a shape: templates, so that others don't have them.
    template <class T = Text>
    static void add_prior(const Prior& prior, StartSums<T>& sums);
    template <class = Text>
    static Quadratic along_shape(const Point& p, const Prior* prior);
    template <class = Text>
    static Step propose(const Point& p, const WidePack& damping, const Prior* prior);
    template <class = Text>
    static Point moved(const Point& from, const Step& step);
    template <class = Text>
    static SmallMatrix<WidePack, Q> with_gauge(const SmallVector<WidePack, Q>& s, const SmallMatrix<WidePack, Q>& of);
    static WidePack least_pivot(const Point& p, const Prior* prior);
    template <class = Text>
    static WidePack least_pivot_of_all(const Point& p, const SmallMatrix<WidePack, C>& shared);
    static Parameters parameters_of(const Point& p, int lane, bool fitted);
    static typename Text::Shape shape_of(const SmallVector<WidePack, Q>& s) {
        typename Text::Shape out{};
        for (size_t i = 0; i < size_t(Q); ++i) out.x[i] = narrow(s[i]);
        return out;
    }

    TexelFitOptions options_;
};

}  // namespace radiafit
