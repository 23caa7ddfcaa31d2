#pragma once
// The samples of as many problems as there are lanes, and what they make of a model's value and derivatives. Compiled
// with a model's text.
#include "batch/kernel/chunk.h"
#include "batch/kernel/numbers.h"
#include "batch/kernel/small_matrix.h"

namespace radiafit::batch {

template <class number>
struct LossOf {
    using real = number;
    using element = number;
#pragma push_macro("SHARED_FN")
#undef SHARED_FN
#define SHARED_FN static inline
#include "model/loss.glsl"
#pragma pop_macro("SHARED_FN")
};

/// One problem's values [samples][values] and their derivatives [samples][values][parameters], samples side by side.
template <class real, class Model>
[[gnu::flatten]] void evaluate_samples(const real* parameters, const real* terms, long long samples, real* values,
                                       real* derivatives) {
    using number = Wide<real>;
    constexpr int P = Model::parameters, T = Model::terms, Y = Model::values, L = number::size;
    Jet<number, P> p[P], t[T], y[Y];
    for (int i = 0; i < P; ++i) {
        p[i] = Jet<number, P>(number(parameters[i]));
        p[i].d[i] = number(1);
    }
    for (long long first = 0; first < samples; first += L) {
        const int count = samples - first < L ? int(samples - first) : L;
        for (int k = 0; k < T; ++k) {
            number term;
            for (int lane = 0; lane < L; ++lane) term.v[lane] = terms[(first + (lane < count ? lane : 0)) * T + k];
            t[k] = Jet<number, P>(term);
        }
        Model::value(p, t, y);
        for (int lane = 0; lane < count; ++lane)
            for (int c = 0; c < Y; ++c) {
                const long long at = (first + lane) * Y + c;
                values[at] = y[c].v.v[lane];
                for (int i = 0; derivatives && i < P; ++i) derivatives[at * P + i] = y[c].d[i].v[lane];
            }
    }
}

/// At some parameters of each lane's problem: 1/2 sum of w r^2, or of the loss; its gradient, and Gauss and Newton's
/// matrix.
template <class number, int P>
struct LaneSums {
    number error, gradient[P], matrix[size_below(P)];
};

template <class real, class Model>
class LaneSamples {
    using number = Wide<real>;
    static constexpr int P = Model::parameters, T = Model::terms, Y = Model::values, L = number::size;
    using jet = Jet<number, P>;
    using Sums = LaneSums<number, P>;

public:
    /// storage: bytes_for() the most samples of a problem, aligned as vectors are.
    LaneSamples(const Chunk& chunk, void* storage)
        : chunk_(chunk), row_((chunk.shared_terms ? 0 : T) + Y + 1), rows_(static_cast<real*>(storage)) {
        squares_ = values_ = number(1);
        if (chunk_.shared_terms) share_terms();
    }
    static long long bytes_for(long long samples) { return samples * ((T + Y + 1) * L + T) * (long long)sizeof(real); }

    long long count(int lane) const { return counts_[lane]; }  ///< that are not missing
    const number& values() const { return values_; }           ///< of those
    const number& squares() const { return squares_; }         ///< sum of w y^2 over the targets
    void release(int lane) { used_[lane] = false; }            ///< its problem has ended, and none follows

    /// A problem's samples into a lane. Those that are missing have no weight, and another's terms.
    void load(int lane, long long problem) {
        const long long first = chunk_.offsets ? chunk_.offsets[problem] : problem * chunk_.samples;
        const long long samples = chunk_.offsets ? chunk_.offsets[problem + 1] - first : chunk_.samples;
        const bool shared = chunk_.shared_terms;
        const real* terms = numbers_of(chunk_.terms) + (shared ? 0 : first * T);
        const real* targets = numbers_of(chunk_.targets) + first * Y;
        const real* weights = chunk_.weights ? numbers_of(chunk_.weights) + first : nullptr;
        long long kept = 0, whole = -1;
        real squares = 0;
        for (long long s = 0; s < samples; ++s) {
            real weight = weights ? weights[s] : real(1);
            bool there = weight > 0 && is_finite(weight) && whole_terms(terms + s * T);
            for (int c = 0; c < Y; ++c) there = there && is_finite(targets[s * Y + c]);
            if (!there) weight = 0;
            kept += there;
            if (there && whole < 0) whole = s;
            real* row = rows_ + s * row_ * L + lane;
            if (!shared)
                for (int k = 0; k < T; ++k, row += L) *row = there ? terms[s * T + k] : real(0);
            for (int c = 0; c < Y; ++c, row += L) {
                *row = there ? targets[s * Y + c] : real(0);
                squares += weight * *row * *row;
            }
            *row = weight;
        }
        used_[lane] = true;
        counts_[lane] = kept;
        lengths_[lane] = samples;
        values_.v[lane] = real(kept * Y);
        squares_.v[lane] = squares;
        even_[lane] = !weights && kept == samples;
        if (kept < samples && whole >= 0 && !shared)
            for (long long s = 0; s < samples; ++s)
                if (rows_[(s * row_ + T + Y) * L + lane] == 0)
                    for (int k = 0; k < T; ++k) rows_[(s * row_ + k) * L + lane] = terms[whole * T + k];
        for (long long s = samples; s < filled_; ++s) pad(lane, s, whole < 0 ? 0 : whole);
        if (samples <= filled_) return;
        for (long long s = filled_; s < samples; ++s)
            for (int other = 0; other < L; ++other)
                if (other != lane) pad(other, s, 0);
        filled_ = samples;
    }
    /// At parameters of each lane.
    void evaluate(const number (&at)[P], Sums& sums) const {
        long long samples = 0;
        bool even = true;  // nothing but samples of weight 1
        for (int lane = 0; lane < L; ++lane) {
            if (!used_[lane]) continue;
            if (lengths_[lane] > samples) samples = lengths_[lane];
            even = even && even_[lane];
        }
        for (int lane = 0; lane < L; ++lane) even = even && (!used_[lane] || lengths_[lane] == samples);
        switch (chunk_.loss) {
            case BatchLoss::huber:
                return evaluate<BatchLoss::huber, false>(samples, at, sums);
            case BatchLoss::cauchy:
                return evaluate<BatchLoss::cauchy, false>(samples, at, sums);
            default:
                return even ? evaluate<BatchLoss::square, true>(samples, at, sums)
                            : evaluate<BatchLoss::square, false>(samples, at, sums);
        }
    }

private:
    static const real* numbers_of(const void* p) { return static_cast<const real*>(p); }

    static number vector_at(const real* from) {
        number x;
        __builtin_memcpy(&x.v, from, sizeof x.v);
        return x;
    }

    // Terms that all problems have, in the storage behind the rows; those of a sample that lacks one are another's.
    void share_terms() {
        shared_ = rows_ + chunk_.samples * row_ * L;
        const real* terms = numbers_of(chunk_.terms);
        long long whole = -1;
        for (long long s = 0; s < chunk_.samples; ++s)
            if (whole_terms(terms + s * T) && whole < 0) whole = s;
        for (long long s = 0; s < chunk_.samples; ++s)
            for (int k = 0; k < T; ++k)
                shared_[s * T + k] = whole_terms(terms + s * T) ? terms[s * T + k]
                                     : whole < 0                ? real(0)
                                                                : terms[whole * T + k];
    }
    static bool whole_terms(const real* terms) {
        for (int k = 0; k < T; ++k)
            if (!is_finite(terms[k])) return false;
        return true;
    }

    void pad(int lane, long long sample, long long like) {
        for (int k = 0; k < row_; ++k)
            rows_[(sample * row_ + k) * L + lane] = k + 1 < row_ ? rows_[(like * row_ + k) * L + lane] : real(0);
    }

    template <BatchLoss loss, bool even>
    void evaluate(long long samples, const number (&at)[P], Sums& to) const {
        return chunk_.shared_terms ? evaluate<loss, even, true>(samples, at, to)
                                   : evaluate<loss, even, false>(samples, at, to);
    }

    // Flattened: the model's functions become part of it, and products with derivatives that are zero go.
    template <BatchLoss loss, bool even, bool shared>
    [[gnu::flatten]] void evaluate(long long samples, const number (&at)[P], Sums& to) const {
        constexpr int terms_in_row = shared ? 0 : T, width = terms_in_row + Y + 1;
        Sums sums;
        sums.error = number(0);
        for (number& x : sums.gradient) x = number(0);
        for (number& x : sums.matrix) x = number(0);
        jet p[P];
#pragma GCC unroll 32
        for (int i = 0; i < P; ++i) {
            p[i] = jet(at[i]);
            p[i].d[i] = number(1);
        }
        const number scale{real(chunk_.loss_scale)};
        for (long long s = 0; s < samples; ++s) {
            const real* row = rows_ + s * width * L;
            jet t[T], y[Y];
#pragma GCC unroll 32
            for (int k = 0; k < T; ++k) {
                if constexpr (shared)
                    t[k] = jet(number(shared_[s * T + k]));
                else
                    t[k] = jet(vector_at(row + k * L));
            }
            Model::value(p, t, y);
            number weight(1), residual[Y], squared(0);
            if constexpr (!even) weight = vector_at(row + (width - 1) * L);
            // with a weight of 1 rounded as without one, so that what stands in other lanes makes no difference
            number& sum = loss == BatchLoss::square ? sums.error : squared;
#pragma GCC unroll 4
            for (int c = 0; c < Y; ++c) {
                residual[c] = y[c].v - vector_at(row + (terms_in_row + c) * L);
                const number weighted = even ? residual[c] : weight * residual[c];
                sum += weighted * residual[c];
            }
            if constexpr (loss == BatchLoss::huber) {
                sums.error += LossOf<number>::huber_value(squared, scale);
                weight *= LossOf<number>::huber_weight(squared, scale);
            }
            if constexpr (loss == BatchLoss::cauchy) {
                sums.error += LossOf<number>::cauchy_value(squared, scale);
                weight *= LossOf<number>::cauchy_weight(squared, scale);
            }
#pragma GCC unroll 4
            for (int c = 0; c < Y; ++c)
#pragma GCC unroll 32
                for (int i = 0; i < P; ++i) {
                    const number weighted = even ? y[c].d[i] : weight * y[c].d[i];
                    sums.gradient[i] += weighted * residual[c];
#pragma GCC unroll 32
                    for (int j = 0; j <= i; ++j) sums.matrix[place_below(i, j)] += weighted * y[c].d[j];
                }
        }
        sums.error *= number(0.5);
        to = sums;
    }

    const Chunk& chunk_;
    int row_;                 ///< numbers of a sample in a lane: its terms unless they are shared, targets, weight
    real* rows_;              ///< [samples][row_][lanes]
    real* shared_ = nullptr;  ///< [samples][T] terms of all problems
    long long filled_ = 0;    ///< rows that hold numbers in every lane
    bool used_[L] = {};
    long long counts_[L] = {}, lengths_[L] = {};  ///< samples without and with those that are missing
    bool even_[L] = {};                           ///< none is missing, and all weigh 1
    number values_, squares_;
};

}  // namespace radiafit::batch
