#pragma once
// Levenberg-Marquardt for many small problems of one model, each in a lane, which takes the next problem as soon as one
// has ended (Levenberg 1944, Marquardt 1963; scaled as in Moré 1978; damped as in Madsen, Nielsen and Tingleff 2004,
// section 3.2). Compiled with a model's text, for the widest vectors that the machine has.
#include "batch/kernel/chunk.h"
#include "batch/kernel/numbers.h"

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

/// Model: `parameters`, `terms`, `values`, and value(p, t, y), which sets y[values] for p[parameters] and t[terms], all
/// of them Jets of Wide<real>.

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

template <class real, class Model>
class ProblemLanes {
    using number = Wide<real>;
    using Mask = typename number::Mask;
    static constexpr int P = Model::parameters, T = Model::terms, Y = Model::values, L = number::size;
    using jet = Jet<number, P>;
    static constexpr int below = P * (P + 1) / 2;
    static constexpr int at(int i, int j) { return i * (i + 1) / 2 + j; }  // j <= i
    static constexpr bool is_double = sizeof(real) == 8;
    static constexpr real epsilon = is_double ? real(2.220446e-16) : real(1.1920929e-7);
    static constexpr real infinity = real(__builtin_inf());
    static constexpr real least_normal = is_double ? real(2.3e-308) : real(1.2e-38);
    static constexpr real least_pivot = (is_double ? 4 : 16) * P * epsilon;  ///< of a matrix whose diagonal is 1

    /// At some parameters: 1/2 sum of w r^2, its gradient, and Gauss and Newton's matrix.
    struct Sums {
        number error, gradient[P], matrix[below];
    };

public:
    /// storage: bytes_for() the most samples of a problem, aligned as vectors are.
    ProblemLanes(const Chunk& chunk, void* storage)
        : chunk_(chunk), row_((chunk.shared_terms ? 0 : T) + Y + 1), rows_(static_cast<real*>(storage)) {
        for (int i = 0; i < P; ++i) {
            at_[i] = trial_[i] = most_[i] = scale_[i] = last_[i] = sums_.gradient[i] = number(0);
            held_[i] = Mask{};
            lower_[i] = number(reals(chunk_.lower)[i]);
            upper_[i] = number(reals(chunk_.upper)[i]);
            fixed_[i] = chunk_.fixed[i] ? ~Mask{} : Mask{};
        }
        sums_.error = damping_ = growth_ = promised_ = squares_ = allowance_ = shortest_ = values_ = number(1);
        steps_ = number(0);
        for (number& x : sums_.matrix) x = number(0);
        occupied_ = fresh_ = polished_ = better_ = bounded_ = Mask{};
        for (int lane = 0; lane < L; ++lane) problem_[lane] = -1;
        if (chunk_.shared_terms) share_terms();
    }
    static long long bytes_for(long long samples) { return samples * ((T + Y + 1) * L + T) * (long long)sizeof(real); }

    void run() {
        for (long long i = chunk_.first; i < chunk_.first + chunk_.count; ++i) {
            out(chunk_.error)[i] = infinity;
            chunk_.status[i] = int(BatchStatus::no_samples);
        }
        for (int lane = 0; lane < L; ++lane) take_next(lane);
        while (any(occupied_)) {
            Sums trial;
            evaluate(trial);
            Mask ended = accept(trial);
            ended |= propose();
            if (!any(ended)) continue;
            for (int lane = 0; lane < L; ++lane)
                if (ended[lane]) {
                    write(lane);
                    take_next(lane);
                }
        }
    }

private:
    static const real* reals(const void* p) { return static_cast<const real*>(p); }
    static real* out(void* p) { return static_cast<real*>(p); }

    static bool any(const Mask& mask) {
        unsigned long long words[sizeof(Mask) / 8], all = 0;
        __builtin_memcpy(words, &mask, sizeof mask);
        for (const unsigned long long word : words) all |= word;
        return all != 0;
    }

    // Not by comparison, since the compiler may take all numbers for finite.
    static bool finite(float x) {
        unsigned bits;
        __builtin_memcpy(&bits, &x, sizeof bits);
        return (bits & 0x7f800000u) != 0x7f800000u;
    }
    static bool finite(double x) {
        unsigned long long bits;
        __builtin_memcpy(&bits, &x, sizeof bits);
        return (bits & 0x7ff0000000000000ull) != 0x7ff0000000000000ull;
    }
    static Mask finite(const number& x) {
        using Integer = decltype(Mask{}[0] + 0);
        constexpr auto exponent = is_double ? 0x7ff0000000000000ll : 0x7f800000ll;
        const Mask bits = (Mask)x.v & (Mask{} + (Integer)exponent);
        return bits != Mask{} + (Integer)exponent;
    }

    static number load(const real* from) {
        number x;
        __builtin_memcpy(&x.v, from, sizeof x.v);
        return x;
    }

    // Terms that all problems have, in the storage behind the rows; those of a sample that lacks one are another's.
    void share_terms() {
        shared_ = rows_ + chunk_.samples * row_ * L;
        const real* terms = reals(chunk_.terms);
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
            if (!finite(terms[k])) return false;
        return true;
    }

    // The problem again from its next start; or the next problem that has samples; or none.
    void take_next(int lane) {
        const bool again = problem_[lane] >= 0 && start_[lane] + 1 < chunk_.start_count;
        long long same = again ? problem_[lane] : -1;
        problem_[lane] = -1;
        occupied_[lane] = fresh_[lane] = 0;
        while (same >= 0 || next_ < chunk_.count) {
            const bool loaded = same >= 0;
            const long long problem = loaded ? same : chunk_.first + next_++, from = loaded ? start_[lane] + 1 : 0;
            same = -1;
            start_[lane] = from;
            const real* start =
                reals(chunk_.starts) + (from * chunk_.starts_of_each + (chunk_.starts_of_each > 1 ? problem : 0)) * P;
            if (!loaded) load_samples(lane, problem);
            if (count_[lane] == 0) {
                without_samples(problem, start);
                continue;
            }
            problem_[lane] = problem;
            for (int i = 0; i < P; ++i) {
                real x = start[i];
                if (!chunk_.fixed[i]) {
                    if (x < lower_[i].v[lane]) x = lower_[i].v[lane];
                    if (x > upper_[i].v[lane]) x = upper_[i].v[lane];
                }
                trial_[i].v[lane] = at_[i].v[lane] = x;
                most_[i].v[lane] = 0;
            }
            sums_.error.v[lane] = infinity;
            damping_.v[lane] = real(1e-3);
            growth_.v[lane] = 2;
            promised_.v[lane] = 1;
            allowance_.v[lane] = 0;
            steps_.v[lane] = 0;
            occupied_[lane] = fresh_[lane] = -1;
            polished_[lane] = 0;
            return;
        }
    }

    // A problem's samples into a lane. Those that are missing have no weight, and another's terms.
    void load_samples(int lane, long long problem) {
        const long long first = chunk_.offsets ? chunk_.offsets[problem] : problem * chunk_.samples;
        const long long samples = chunk_.offsets ? chunk_.offsets[problem + 1] - first : chunk_.samples;
        const bool shared = chunk_.shared_terms;
        const real* terms = reals(chunk_.terms) + (shared ? 0 : first * T);
        const real* targets = reals(chunk_.targets) + first * Y;
        const real* weights = chunk_.weights ? reals(chunk_.weights) + first : nullptr;
        long long kept = 0, whole = -1;
        real squares = 0;
        for (long long s = 0; s < samples; ++s) {
            real weight = weights ? weights[s] : real(1);
            bool there = weight > 0 && finite(weight) && whole_terms(terms + s * T);
            for (int c = 0; c < Y; ++c) there = there && finite(targets[s * Y + c]);
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
        count_[lane] = kept;
        length_[lane] = samples;
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
    void pad(int lane, long long sample, long long like) {
        for (int k = 0; k < row_; ++k)
            rows_[(sample * row_ + k) * L + lane] = k + 1 < row_ ? rows_[(like * row_ + k) * L + lane] : real(0);
    }

    void evaluate(Sums& sums) const {
        long long samples = 0;
        bool even = true;  // nothing but samples of weight 1
        for (int lane = 0; lane < L; ++lane) {
            if (problem_[lane] < 0) continue;
            if (length_[lane] > samples) samples = length_[lane];
            even = even && even_[lane];
        }
        for (int lane = 0; lane < L; ++lane) even = even && (problem_[lane] < 0 || length_[lane] == samples);
        switch (chunk_.loss) {
            case BatchLoss::huber:
                return evaluate<BatchLoss::huber, false>(samples, sums);
            case BatchLoss::cauchy:
                return evaluate<BatchLoss::cauchy, false>(samples, sums);
            default:
                return even ? evaluate<BatchLoss::square, true>(samples, sums)
                            : evaluate<BatchLoss::square, false>(samples, sums);
        }
    }
    template <BatchLoss loss, bool even>
    void evaluate(long long samples, Sums& to) const {
        return chunk_.shared_terms ? evaluate<loss, even, true>(samples, to) : evaluate<loss, even, false>(samples, to);
    }

    // Flattened: the model's functions become part of it, and products with derivatives that are zero go.
    template <BatchLoss loss, bool even, bool shared>
    [[gnu::flatten]] void evaluate(long long samples, Sums& to) const {
        constexpr int terms_in_row = shared ? 0 : T, width = terms_in_row + Y + 1;
        Sums sums;
        sums.error = number(0);
        for (number& x : sums.gradient) x = number(0);
        for (number& x : sums.matrix) x = number(0);
        jet p[P];
#pragma GCC unroll 32
        for (int i = 0; i < P; ++i) {
            p[i] = jet(trial_[i]);
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
                    t[k] = jet(load(row + k * L));
            }
            Model::value(p, t, y);
            number weight(1), residual[Y], squared(0);
            if constexpr (!even) weight = load(row + (width - 1) * L);
            // with a weight of 1 rounded as without one, so that what stands in other lanes makes no difference
            number& sum = loss == BatchLoss::square ? sums.error : squared;
#pragma GCC unroll 4
            for (int c = 0; c < Y; ++c) {
                residual[c] = y[c].v - load(row + (terms_in_row + c) * L);
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
                    for (int j = 0; j <= i; ++j) sums.matrix[at(i, j)] += weighted * y[c].d[j];
                }
        }
        sums.error *= number(0.5);
        to = sums;
    }

    // Moves to the trial where it is better; elsewhere the damping grows. Returns lanes whose start is not finite.
    Mask accept(const Sums& trial) {
        Mask whole = finite(trial.error) & finite(squares_);
        for (int i = 0; i < P; ++i) whole &= fixed_[i] | (finite(trial.gradient[i]) & finite(trial.matrix[at(i, i)]));
        better_ = occupied_ & (fresh_ | (whole & (trial.error < sums_.error + allowance_)));
        const number x = number(2) * (sums_.error - trial.error) / promised_ - number(1);
        const number factor = min(max(number(1) - x * x * x, number(1.0 / 3)), number(2));
        const number moved = max(damping_ * number::select(better_, factor, growth_), number(1e-20));
        damping_ = number::select(fresh_, damping_, moved);
        growth_ = number::select(better_, number(2), growth_ * number(2));
        steps_ += number::select(occupied_ & ~fresh_, number(1), number(0));
        const Mask lost = fresh_ & ~whole;
        fresh_ = Mask{};
        const auto take = [this](number& to, const number& from) { to = number::select(better_, from, to); };
        take(sums_.error, trial.error);
        for (int k = 0; k < below; ++k) take(sums_.matrix[k], trial.matrix[k]);
        for (int i = 0; i < P; ++i) {
            take(at_[i], trial_[i]);
            take(sums_.gradient[i], trial.gradient[i]);
            most_[i] = max(most_[i], sums_.matrix[at(i, i)]);
        }
        if (any(lost))
            for (int lane = 0; lane < L; ++lane)
                if (lost[lane]) status_[lane] = BatchStatus::not_finite;
        lost_ = lost;
        return lost;
    }

    /// Cholesky's factor of a matrix whose diagonal is about 1, one over its diagonal, and the least pivot.
    struct Factor {
        number l[below], over[P], least;

        explicit Factor(const number (&m)[below]) {
            least = number(1);
#pragma GCC unroll 16
            for (int i = 0; i < P; ++i) {
#pragma GCC unroll 16
                for (int j = 0; j < i; ++j) {
                    number x = m[at(i, j)];
                    for (int k = 0; k < j; ++k) x -= l[at(i, k)] * l[at(j, k)];
                    l[at(i, j)] = x * over[j];
                }
                number pivot = m[at(i, i)];
                for (int k = 0; k < i; ++k) pivot -= l[at(i, k)] * l[at(i, k)];
                least = min(least, pivot);
                const number root = sqrt(max(pivot, number(least_pivot)));
                l[at(i, i)] = root;
                over[i] = number(1) / root;
            }
        }
        Factor() = default;
        void forward(const number (&b)[P], number (&x)[P]) const {
            for (int i = 0; i < P; ++i) {
                number sum = b[i];
                for (int k = 0; k < i; ++k) sum -= l[at(i, k)] * x[k];
                x[i] = sum * over[i];
            }
        }
        void backward(number (&x)[P]) const {
            for (int i = P - 1; i >= 0; --i) {
                number sum = x[i];
                for (int k = i + 1; k < P; ++k) sum -= l[at(k, i)] * x[k];
                x[i] = sum * over[i];
            }
        }
    };

    // Sets trial_ to the next step. Returns lanes that have ended, and why in status_.
    Mask propose() {
        number scaled[below], gradient[P], forward[P], step[P], free(0);
        bounded_ = Mask{};
        for (int i = 0; i < P; ++i) {
            const number& diagonal = sums_.matrix[at(i, i)];
            const Mask outward = ((at_[i] <= lower_[i]) & (sums_.gradient[i] >= number(0))) |
                                 ((at_[i] >= upper_[i]) & (sums_.gradient[i] <= number(0)));
            const Mask unseen = diagonal <= number(0);  // no sample depends on it
            held_[i] = fixed_[i] | outward | unseen;
            bounded_ |= outward & ~fixed_[i];
            free += number::select(fixed_[i] | (outward & ~unseen), number(0), number(1));
            scale_[i] = number::select(held_[i], number(0), number(1) / sqrt(diagonal));
        }
        for (int i = 0; i < P; ++i) {
            for (int j = 0; j < i; ++j) scaled[at(i, j)] = sums_.matrix[at(i, j)] * scale_[i] * scale_[j];
            scaled[at(i, i)] = number(1);
            gradient[i] = sums_.gradient[i] * scale_[i];
        }
        factor_ = Factor(scaled);
        factor_.forward(gradient, forward);
        for (int i = 0; i < P; ++i) last_[i] = forward[i];
        factor_.backward(last_);
        for (int i = 0; i < P; ++i) last_[i] *= scale_[i];
        number decrement(0);  // how far the minimum of Gauss and Newton's model lies, by the matrix' norm
        for (int i = 0; i < P; ++i) decrement += forward[i] * forward[i];

        // near: where rounding of values and of their sum hides whether the error still falls
        const number& error = sums_.error;
        const number hidden = number(epsilon) * (number(16) * error + number(4) * sqrt(error * squares_));
        const Mask near = decrement <= number(2) * hidden;
        allowance_ = number::select(near, hidden, number(0));
        const number damping = number::select(near, number(0), damping_);
        for (int i = 0; i < P; ++i)
            scaled[at(i, i)] += number::select(held_[i], number(0), damping * most_[i] * scale_[i] * scale_[i]);
        const Factor damped(scaled);
        damped.forward(gradient, step);
        damped.backward(step);
        number moved[P];
        Mask stays = ~Mask{};
        for (int i = 0; i < P; ++i) {
            trial_[i] = min(max(at_[i] - step[i] * scale_[i], lower_[i]), upper_[i]);
            trial_[i] = number::select(held_[i], at_[i], trial_[i]);
            moved[i] = trial_[i] - at_[i];
            stays &= moved[i].v == 0;
        }
        promised_ = number(0);
        for (int i = 0; i < P; ++i) {
            number by = number(0.5) * sums_.matrix[at(i, i)] * moved[i] + sums_.gradient[i];
            for (int j = 0; j < i; ++j) by += sums_.matrix[at(i, j)] * moved[j];
            promised_ -= by * moved[i];
        }

        freedom_ = values_ - free;
        const number variance = number(2) * error / max(freedom_, number(1));
        const Mask small = decrement <= number(real(chunk_.tolerance * chunk_.tolerance)) * variance;
        const number floor =
            number(32 * epsilon * epsilon) * squares_;  // of exact samples; below all numbers it says nothing
        const Mask exact = (error <= floor) & (floor > number(least_normal));
        // near the minimum on until steps no longer become shorter
        const Mask settled = near & (stays | (polished_ & (decrement > number(0.5) * shortest_)));
        polished_ |= near;
        shortest_ = number::select(near, decrement, shortest_);
        const Mask done = small | exact | settled;
        const Mask stalled = ~done & (stays | (damping_ > number(1e16)));
        const Mask spent = steps_ >= number(chunk_.iterations);
        const Mask ended = occupied_ & ~lost_ & (done | stalled | spent);
        if (any(ended))
            for (int lane = 0; lane < L; ++lane)
                if (ended[lane])
                    status_[lane] = done[lane]      ? minimum(lane)
                                    : stalled[lane] ? BatchStatus::stalled
                                                    : BatchStatus::max_iterations;
        return ended;
    }

    static bool is_minimum(BatchStatus status) {
        return status == BatchStatus::converged || status == BatchStatus::at_bound;
    }

    // What a minimum is called. A parameter that no sample depends on is not determined.
    BatchStatus minimum(int lane) const {
        bool determined = freedom_.v[lane] >= 0 && factor_.least.v[lane] > least_pivot;
        for (int i = 0; i < P; ++i)
            if (!chunk_.fixed[i] && !(sums_.matrix[at(i, i)].v[lane] > 0)) determined = false;
        if (!determined) return BatchStatus::underdetermined;
        return bounded_[lane] ? BatchStatus::at_bound : BatchStatus::converged;
    }

    void without_samples(long long problem, const real* start) {
        for (int i = 0; i < P; ++i) {
            out(chunk_.parameters)[problem * P + i] = start[i];
            out(chunk_.deviations)[problem * P + i] = infinity;
        }
        for (int k = 0; chunk_.covariance && k < P * P; ++k)
            out(chunk_.covariance)[problem * P * P + k] = k % (P + 1) == 0 ? infinity : real(0);
        out(chunk_.error)[problem] = 0;
        chunk_.steps[problem] = 0;
        chunk_.seen[problem] = 0;
    }

    // A lane's problem, if no other of its starts led to less.
    void write(int lane) {
        const long long problem = problem_[lane];
        const bool finite_start = status_[lane] != BatchStatus::not_finite;
        const real error = 2 * sums_.error.v[lane];
        const bool first = chunk_.status[problem] == int(BatchStatus::no_samples);
        // a minimum is no worse than what another start left unfinished a little below it
        const real best = out(chunk_.error)[problem];
        const real slack = !first && is_minimum(BatchStatus(chunk_.status[problem])) && !is_minimum(status_[lane])
                               ? real(1e-6)
                               : real(0);
        if (!first && (!finite_start || !(error < best - slack * best))) return;
        chunk_.status[problem] = int(status_[lane]);
        chunk_.steps[problem] = int(steps_.v[lane]);
        chunk_.seen[problem] = count_[lane];
        out(chunk_.error)[problem] = finite_start ? error : infinity;
        for (int i = 0; i < P; ++i) {
            real x = at_[i].v[lane];
            if (is_minimum(status_[lane]) && !held_[i][lane]) {  // the last step, too short to be tried
                x -= last_[i].v[lane];
                if (x < lower_[i].v[lane]) x = lower_[i].v[lane];
                if (x > upper_[i].v[lane]) x = upper_[i].v[lane];
            }
            out(chunk_.parameters)[problem * P + i] = x;
        }

        // the inverse of the factor, and its product with its own transpose
        real inverse[P][P];
        for (int j = 0; j < P; ++j)
            for (int i = j; i < P; ++i) {
                real sum = i == j ? real(1) : real(0);
                for (int k = j; k < i; ++k) sum -= factor_.l[at(i, k)].v[lane] * inverse[k][j];
                inverse[i][j] = sum * factor_.over[i].v[lane];
            }
        const real freedom = freedom_.v[lane];
        const bool known =
            status_[lane] != BatchStatus::underdetermined && finite_start && (chunk_.known_noise || freedom > 0);
        const real variance = chunk_.known_noise ? real(1) : error / (freedom > 0 ? freedom : 1);
        for (int i = 0; i < P; ++i)
            for (int j = chunk_.covariance ? 0 : i; j <= i; ++j) {
                real sum = 0;
                for (int k = i; k < P; ++k) sum += inverse[k][i] * inverse[k][j];
                const bool unseen = !(sums_.matrix[at(i, i)].v[lane] > 0);  // no sample depends on it
                const bool unknown =
                    (!known && !chunk_.fixed[i] && !chunk_.fixed[j]) || (unseen && !chunk_.fixed[i] && i == j);
                const real spread = variance * sum * scale_[i].v[lane] * scale_[j].v[lane];
                const real covariance = !unknown ? spread : i == j ? infinity : real(0);
                if (i == j) out(chunk_.deviations)[problem * P + i] = unknown ? infinity : real(__builtin_sqrt(spread));
                if (!chunk_.covariance) continue;
                out(chunk_.covariance)[(problem * P + i) * P + j] = covariance;
                out(chunk_.covariance)[(problem * P + j) * P + i] = covariance;
            }
    }

    const Chunk& chunk_;
    int row_;                 ///< numbers of a sample in a lane: its terms unless they are shared, targets, weight
    real* rows_;              ///< [samples][row_][lanes]
    real* shared_ = nullptr;  ///< [samples][T] terms of all problems
    long long filled_ = 0;    ///< rows that hold numbers in every lane
    long long next_ = 0;      ///< of the chunk's problems

    // Of the problem in each lane.
    long long problem_[L], start_[L] = {};      ///< and from which of its starts
    long long count_[L] = {}, length_[L] = {};  ///< its samples, without and with those that are missing
    bool even_[L] = {};                         ///< none is missing, and all weigh 1
    BatchStatus status_[L] = {};
    Mask occupied_, fresh_, polished_, better_, bounded_, lost_, held_[P], fixed_[P];
    number at_[P], trial_[P], lower_[P], upper_[P];
    number most_[P], scale_[P],
        last_[P];  ///< most_: of the matrix' diagonal so far; last_: Gauss and Newton's step from at_
    Sums sums_;    ///< at at_
    Factor factor_;
    number damping_, growth_, promised_, squares_, values_, freedom_, steps_;
    number allowance_, shortest_;  ///< what rounding leaves of errors; decrement of the last step below that
};

}  // namespace radiafit::batch
