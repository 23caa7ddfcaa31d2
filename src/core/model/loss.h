#pragma once
#include "base/pack.h"
#include "model/prelude.h"

/// What a residual costs: its square, or a robust loss, which grows slower where residuals are large
/// (shaders/model/loss.glsl). A residual is that of one channel of a light field map, or of all channels of a
/// texel-local model, |r|. To add one: its text there, its name here.
namespace radiafit {

/// X(name) for each loss but the square.
#define RADIAFIT_LOSSES(X) X(huber) X(cauchy)

#define RADIAFIT_NAME(name) , name
enum class LossKind { square RADIAFIT_LOSSES(RADIAFIT_NAME) };
#undef RADIAFIT_NAME
#define RADIAFIT_NAME(name) , #name
inline constexpr const char* loss_names[] = {"square" RADIAFIT_LOSSES(RADIAFIT_NAME)};  ///< by LossKind
#undef RADIAFIT_NAME

/// What a sample's squared residual is multiplied by: one, or the cosine between the surface's normal and the direction
/// to the camera (shaders/model/weight.glsl). A light field map takes its vertex's normal.
enum class SampleWeights { equal, facing };

struct Loss {
    LossKind kind = LossKind::square;
    float scale = 0.05f;  ///< delta: residuals well below it cost their square; in units of the targets
    SampleWeights weights = SampleWeights::equal;  ///< a residual is sqrt(weight) times what it would be
    bool robust() const { return kind != LossKind::square; }
    bool weighted() const { return weights != SampleWeights::equal; }
};

namespace shared_text {
using std::log, std::max, std::min, std::sqrt;
template <class real>
struct WeightText {
#include "model/weight.glsl"
};
template <class real_type>
struct LossText {
    using real = real_type;
    using element = real;
#include "model/loss.glsl"
};
}  // namespace shared_text

inline double sample_weight(SampleWeights weights, double cosine) {
    return weights == SampleWeights::facing ? shared_text::WeightText<double>::facing_weight(cosine) : 1;
}

/// A loss as kernels take it: value(s) and weight(s) of a squared residual s, a number or a pack. reweighs: whether
/// samples may weigh differently.
struct SquareLoss {
    static constexpr bool reweighs = false;
    template <class real>
    real value(const real& s) const {
        return s;
    }
    template <class real>
    real weight(const real&) const {
        return real(1.0f);
    }
};
struct WeightedSquareLoss : SquareLoss {
    static constexpr bool reweighs = true;
};
#define RADIAFIT_LOSS(name)                                                    \
    struct name##_loss {                                                       \
        static constexpr bool reweighs = true;                                 \
        float scale;                                                           \
        template <class real>                                                  \
        real value(const real& s) const {                                      \
            return shared_text::LossText<real>::name##_value(s, real(scale));  \
        }                                                                      \
        template <class real>                                                  \
        real weight(const real& s) const {                                     \
            return shared_text::LossText<real>::name##_weight(s, real(scale)); \
        }                                                                      \
    };
RADIAFIT_LOSSES(RADIAFIT_LOSS)
#undef RADIAFIT_LOSS

/// body(loss) with the one that is named. Returns what it returns.
template <class Body>
auto with_loss(const Loss& loss, const Body& body) {
    switch (loss.kind) {
#define RADIAFIT_CASE(name) \
    case LossKind::name:    \
        return body(name##_loss{loss.scale});
        RADIAFIT_LOSSES(RADIAFIT_CASE)
#undef RADIAFIT_CASE
        default:
            return loss.weighted() ? body(WeightedSquareLoss{}) : body(SquareLoss{});
    }
}

}  // namespace radiafit
