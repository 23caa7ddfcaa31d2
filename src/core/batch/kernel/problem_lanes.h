#pragma once
// Levenberg-Marquardt for many small problems of one model, each in a lane, which takes the next problem as soon as one has
// ended (Levenberg 1944, Marquardt 1963; scaled as in Moré 1978; damped as in Madsen, Nielsen and Tingleff 2004, section 3.2).
// Compiled with a model's text, for the widest vectors that the machine has.
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

/// Model: `parameters`, `terms`, `values`, and value(p, t, y), which sets y[values] for p[parameters] and t[terms], all of
/// them Jets of Wide<real>.

/// One problem's values [samples][values] and their derivatives [samples][values][parameters], samples side by side.
template <class real, class Model>
void evaluate_samples(const real* parameters, const real* terms, long long samples, real* values, real* derivatives) {
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
    static constexpr real least_pivot = (is_double ? 4 : 16) * P * epsilon;  ///< of a matrix whose diagonal is 1

    /// At some parameters: 1/2 sum of w r^2, its gradient, and Gauss and Newton's matrix.
    struct Sums {
        number error, gradient[P], matrix[below];
    };

public:
    /// storage: bytes_for() the most samples of a problem, aligned as vectors are.
    ProblemLanes(const Chunk& chunk, void* storage) : chunk_(chunk), rows_(static_cast<real*>(storage)) {
        for (int i = 0; i < P; ++i) at_[i] = trial_[i] = most_[i] = scale_[i] = number(0);
        sums_.error = damping_ = growth_ = promised_ = allowance_ = squares_ = shortest_ = number(1);
        for (number& x : sums_.gradient) x = number(0);
        for (number& x : sums_.matrix) x = number(0);
    }
    static long long bytes_for(long long samples) { return samples * (T + Y + 1) * L * (long long)sizeof(real); }

    void run() {
        for (long long i = chunk_.first; i < chunk_.first + chunk_.count; ++i) begin(i);
        for (int lane = 0; lane < L; ++lane) take_next(lane);
        while (longest() > 0) {
            Sums trial;
            evaluate(trial);
            accept(trial);
            propose();
            for (int lane = 0; lane < L; ++lane)
                if (problem_[lane] >= 0 && ended_[lane]) {
                    write(lane);
                    take_next(lane);
                }
        }
    }

private:
    const real* reals(const void* p) const { return static_cast<const real*>(p); }
    real* out(void* p) const { return static_cast<real*>(p); }

    void begin(long long problem) {
        out(chunk_.error)[problem] = infinity;
        chunk_.status[problem] = int(BatchStatus::no_samples);
    }

    // The next problem that has samples, from the next of its starts; or none.
    void take_next(int lane) {
        problem_[lane] = -1;
        count_[lane] = 0;
        while (next_ < chunk_.count) {
            const long long problem = chunk_.first + next_, from = next_start_;
            if (++next_start_ == chunk_.start_count) next_start_ = 0, ++next_;
            const real* start = reals(chunk_.starts) +
                                (from * chunk_.starts_of_each + (chunk_.starts_of_each > 1 ? problem : 0)) * P;
            load(lane, problem);
            if (count_[lane] == 0) {
                without_samples(problem, start);
                continue;
            }
            problem_[lane] = problem;
            for (int i = 0; i < P; ++i) {
                real x = start[i];
                if (!chunk_.fixed[i]) {
                    if (x < reals(chunk_.lower)[i]) x = reals(chunk_.lower)[i];
                    if (x > reals(chunk_.upper)[i]) x = reals(chunk_.upper)[i];
                }
                trial_[i].v[lane] = x;
                at_[i].v[lane] = x;
                most_[i].v[lane] = 0;
            }
            sums_.error.v[lane] = infinity;
            damping_.v[lane] = real(1e-3);
            growth_.v[lane] = 2;
            promised_.v[lane] = 1;
            allowance_.v[lane] = 0;
            fresh_[lane] = 1;
            ended_[lane] = 0;
            steps_[lane] = 0;
            polished_[lane] = false;
            return;
        }
    }

    // A problem's samples into a lane, without those that are missing; behind them its first ones again with no weight.
    void load(int lane, long long problem) {
        const long long first = chunk_.offsets ? chunk_.offsets[problem] : problem * chunk_.samples;
        const long long samples = chunk_.offsets ? chunk_.offsets[problem + 1] - first : chunk_.samples;
        const real* terms = reals(chunk_.terms) + (chunk_.shared_terms ? 0 : first * T);
        const real* targets = reals(chunk_.targets) + first * Y;
        const real* weights = chunk_.weights ? reals(chunk_.weights) + first : nullptr;
        long long kept = 0;
        real squares = 0;
        for (long long s = 0; s < samples; ++s) {
            const real weight = weights ? weights[s] : real(1);
            bool there = weight > 0 && finite(weight);
            for (int c = 0; c < Y; ++c) there = there && finite(targets[s * Y + c]);
            for (int k = 0; k < T; ++k) there = there && finite(terms[s * T + k]);
            if (!there) continue;
            real* row = rows_ + kept * (T + Y + 1) * L + lane;
            for (int k = 0; k < T; ++k) row[k * L] = terms[s * T + k];
            for (int c = 0; c < Y; ++c) {
                row[(T + c) * L] = targets[s * Y + c];
                squares += weight * targets[s * Y + c] * targets[s * Y + c];
            }
            row[(T + Y) * L] = weight;
            ++kept;
        }
        count_[lane] = kept;
        squares_.v[lane] = squares;
        for (long long s = kept; kept > 0 && s < filled_; ++s) pad(lane, s);
        if (kept > filled_) {
            for (long long s = filled_; s < kept; ++s)
                for (int other = 0; other < L; ++other)
                    if (other != lane) pad(other, s);
            filled_ = kept;
        }
    }
    void pad(int lane, long long sample) {
        real* row = rows_ + sample * (T + Y + 1) * L + lane;
        for (int k = 0; k < T + Y; ++k) row[k * L] = count_[lane] > 0 ? rows_[k * L + lane] : real(0);
        row[(T + Y) * L] = 0;
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

    long long longest() const {
        long long most = 0;
        for (int lane = 0; lane < L; ++lane)
            if (problem_[lane] >= 0 && count_[lane] > most) most = count_[lane];
        return most;
    }

    static number load(const real* from) {
        number x;
        __builtin_memcpy(&x.v, from, sizeof x.v);
        return x;
    }

    void evaluate(Sums& sums) const {
        switch (chunk_.loss) {
            case BatchLoss::huber: return evaluate<BatchLoss::huber>(sums);
            case BatchLoss::cauchy: return evaluate<BatchLoss::cauchy>(sums);
            default: return evaluate<BatchLoss::square>(sums);
        }
    }

    template <BatchLoss loss>
    void evaluate(Sums& to) const {
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
        const long long samples = longest();
        for (long long s = 0; s < samples; ++s) {
            const real* row = rows_ + s * (T + Y + 1) * L;
            jet t[T > 0 ? T : 1], y[Y];
#pragma GCC unroll 32
            for (int k = 0; k < T; ++k) t[k] = jet(load(row + k * L));
            Model::value(p, t, y);
            number weight = load(row + (T + Y) * L), residual[Y], squared(0);
#pragma GCC unroll 4
            for (int c = 0; c < Y; ++c) {
                residual[c] = y[c].v - load(row + (T + c) * L);
                squared += residual[c] * residual[c];
            }
            squared *= weight;
            if constexpr (loss == BatchLoss::square)
                sums.error += squared;
            else if constexpr (loss == BatchLoss::huber) {
                sums.error += LossOf<number>::huber_value(squared, scale);
                weight *= LossOf<number>::huber_weight(squared, scale);
            } else {
                sums.error += LossOf<number>::cauchy_value(squared, scale);
                weight *= LossOf<number>::cauchy_weight(squared, scale);
            }
#pragma GCC unroll 4
            for (int c = 0; c < Y; ++c)
#pragma GCC unroll 32
                for (int i = 0; i < P; ++i) {
                    const number weighted = weight * y[c].d[i];
                    sums.gradient[i] += weighted * residual[c];
#pragma GCC unroll 32
                    for (int j = 0; j <= i; ++j) sums.matrix[at(i, j)] += weighted * y[c].d[j];
                }
        }
        sums.error *= number(0.5);
        to = sums;
    }

    // Moves to the trial where it is better; elsewhere the damping grows.
    void accept(const Sums& trial) {
        for (int lane = 0; lane < L; ++lane) {
            better_[lane] = 0;
            if (problem_[lane] < 0) continue;
            const real error = trial.error.v[lane], before = sums_.error.v[lane];
            if (fresh_[lane]) {
                fresh_[lane] = 0;
                better_[lane] = -1;
                if (!finite(error)) ended_[lane] = 1, status_[lane] = BatchStatus::not_finite;
                continue;
            }
            ++steps_[lane];
            if (finite(error) && error < before + allowance_.v[lane]) {
                better_[lane] = -1;
                const real gain = (before - error) / promised_.v[lane], x = 2 * gain - 1;
                real factor = 1 - x * x * x;
                if (factor < real(1.0 / 3)) factor = real(1.0 / 3);
                if (factor > 2) factor = 2;
                damping_.v[lane] *= factor;
                if (damping_.v[lane] < real(1e-20)) damping_.v[lane] = real(1e-20);
                growth_.v[lane] = 2;
            } else {
                damping_.v[lane] *= growth_.v[lane];
                growth_.v[lane] *= 2;
            }
        }
        const auto take = [this](number& to, const number& from) { to = number::select(better_, from, to); };
        take(sums_.error, trial.error);
        for (int i = 0; i < P; ++i) {
            take(at_[i], trial_[i]);
            take(sums_.gradient[i], trial.gradient[i]);
        }
        for (int k = 0; k < below; ++k) take(sums_.matrix[k], trial.matrix[k]);
        for (int i = 0; i < P; ++i) most_[i] = max(most_[i], sums_.matrix[at(i, i)]);
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

    // Tests where lanes are, and sets trial_ to the next step.
    void propose() {
        number scaled[below], gradient[P], forward[P], step[P];
        bounded_ = Mask{};
        for (int i = 0; i < P; ++i) {
            const number lower{reals(chunk_.lower)[i]}, upper{reals(chunk_.upper)[i]};
            const Mask outward = ((at_[i] <= lower) & (sums_.gradient[i] >= number(0))) |
                                 ((at_[i] >= upper) & (sums_.gradient[i] <= number(0)));
            const Mask fixed = chunk_.fixed[i] ? ~Mask{} : Mask{};
            held_[i] = fixed | outward | (sums_.matrix[at(i, i)] <= number(0));
            bounded_ |= outward & ~fixed;
            scale_[i] = number::select(held_[i], number(0), number(1) / sqrt(sums_.matrix[at(i, i)]));
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

        Mask near;  // where rounding of values and of their sum hides whether the error still falls
        number damping;
        for (int lane = 0; lane < L; ++lane) {
            const real error = sums_.error.v[lane];
            allowance_.v[lane] = epsilon * (16 * error + 4 * real(__builtin_sqrt(error * squares_.v[lane])));
            near[lane] = decrement.v[lane] <= 2 * allowance_.v[lane] ? -1 : 0;
            damping.v[lane] = near[lane] ? real(0) : damping_.v[lane];
        }
        for (int i = 0; i < P; ++i)
            scaled[at(i, i)] += number::select(held_[i], number(0), damping * most_[i] * scale_[i] * scale_[i]);
        const Factor damped(scaled);
        damped.forward(gradient, step);
        damped.backward(step);
        number moved[P];
        Mask stays = ~Mask{};
        for (int i = 0; i < P; ++i) {
            trial_[i] = min(max(at_[i] - step[i] * scale_[i], number(reals(chunk_.lower)[i])), number(reals(chunk_.upper)[i]));
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

        for (int lane = 0; lane < L; ++lane) {
            if (problem_[lane] < 0 || ended_[lane]) continue;
            const real error = sums_.error.v[lane];
            const long long freedom = count_[lane] * Y - free_parameters(lane);
            const real variance = 2 * error / real(freedom > 1 ? freedom : 1);
            const bool small = decrement.v[lane] <= real(chunk_.tolerance * chunk_.tolerance) * variance;
            const bool exact = error <= 32 * epsilon * epsilon * squares_.v[lane];
            bool done = small || exact;
            if (near[lane]) {  // until steps no longer become shorter
                done = done || stays[lane] || (polished_[lane] && decrement.v[lane] > real(0.5) * shortest_.v[lane]);
                polished_[lane] = true;
                shortest_.v[lane] = decrement.v[lane];
            } else {
                allowance_.v[lane] = 0;
            }
            if (done)
                end(lane, minimum(lane, freedom));
            else if (stays[lane] || damping_.v[lane] > real(1e16))
                end(lane, BatchStatus::stalled);
            else if (steps_[lane] >= chunk_.iterations)
                end(lane, BatchStatus::max_iterations);
        }
    }

    int free_parameters(int lane) const {
        int free = 0;
        for (int i = 0; i < P; ++i) free += !(chunk_.fixed[i] || (held_[i][lane] && sums_.matrix[at(i, i)].v[lane] > 0));
        return free;
    }

    // What a minimum is called. A parameter that no sample depends on is not determined.
    BatchStatus minimum(int lane, long long freedom) const {
        bool determined = freedom >= 0 && factor_.least.v[lane] > least_pivot;
        for (int i = 0; i < P; ++i)
            if (!chunk_.fixed[i] && !(sums_.matrix[at(i, i)].v[lane] > 0)) determined = false;
        if (!determined) return BatchStatus::underdetermined;
        return bounded_[lane] ? BatchStatus::at_bound : BatchStatus::converged;
    }

    void end(int lane, BatchStatus status) {
        ended_[lane] = 1;
        status_[lane] = status;
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
        const bool worse = !first && (!finite_start || !(error < out(chunk_.error)[problem]));
        if (worse) return;
        chunk_.status[problem] = int(status_[lane]);
        chunk_.steps[problem] = steps_[lane];
        chunk_.seen[problem] = count_[lane];
        out(chunk_.error)[problem] = finite_start ? error : infinity;
        const bool at_minimum = status_[lane] == BatchStatus::converged || status_[lane] == BatchStatus::at_bound;
        for (int i = 0; i < P; ++i) {
            real x = at_[i].v[lane];
            if (at_minimum && !held_[i][lane]) {  // the last step, too short to be tried
                x -= last_[i].v[lane];
                if (x < reals(chunk_.lower)[i]) x = reals(chunk_.lower)[i];
                if (x > reals(chunk_.upper)[i]) x = reals(chunk_.upper)[i];
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
        const long long freedom = count_[lane] * Y - free_parameters(lane);
        const bool known = status_[lane] != BatchStatus::underdetermined && finite_start && (chunk_.known_noise || freedom > 0);
        const real variance = chunk_.known_noise ? real(1) : error / real(freedom > 0 ? freedom : 1);
        for (int i = 0; i < P; ++i)
            for (int j = 0; j <= i; ++j) {
                real sum = 0;
                for (int k = i; k < P; ++k) sum += inverse[k][i] * inverse[k][j];
                const bool unknown = !known && !chunk_.fixed[i] && !chunk_.fixed[j];
                const real spread = variance * sum * scale_[i].v[lane] * scale_[j].v[lane];
                const real covariance = !unknown ? spread : i == j ? infinity : real(0);
                if (i == j)
                    out(chunk_.deviations)[problem * P + i] = unknown ? infinity : real(__builtin_sqrt(spread));
                if (!chunk_.covariance) continue;
                out(chunk_.covariance)[(problem * P + i) * P + j] = covariance;
                out(chunk_.covariance)[(problem * P + j) * P + i] = covariance;
            }
    }

    const Chunk& chunk_;
    real* rows_;            ///< [samples][T + Y + 1][lanes]: terms, targets, weight
    long long filled_ = 0;  ///< rows that hold numbers in every lane
    long long next_ = 0, next_start_ = 0;

    // Of the problem in each lane.
    long long problem_[L], count_[L] = {};
    BatchStatus status_[L];
    int steps_[L];
    bool fresh_[L], ended_[L], polished_[L];
    number at_[P], trial_[P], most_[P], scale_[P], last_[P];  ///< most_: of the matrix' diagonal so far; last_: Gauss
                                                              ///< and Newton's step down from at_
    Mask held_[P], bounded_, better_;
    Sums sums_;  ///< at at_
    Factor factor_;
    number damping_, growth_, promised_, squares_;
    number allowance_, shortest_;  ///< what rounding leaves of errors; decrement of the last step below that
};

}  // namespace radiafit::batch
