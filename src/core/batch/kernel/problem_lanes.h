#pragma once
// Many small problems of one model, each in a lane, which takes the next problem as soon as one has ended. They are
// solved by Levenberg and Marquardt's method (Levenberg 1944, Marquardt 1963; scaled as in Moré 1978; damped as in
// Madsen, Nielsen and Tingleff 2004, section 3.2), or by one that uses gradients alone. Compiled with a model's text,
// for the widest vectors that the machine has.
#include "batch/kernel/chunk.h"
#include "batch/kernel/first_order.h"
#include "batch/kernel/lane_samples.h"
#include "batch/kernel/numbers.h"
#include "batch/kernel/small_matrix.h"

namespace radiafit::batch {

template <class real, class Model>
class ProblemLanes {
    using number = Wide<real>;
    using Mask = typename number::Mask;
    static constexpr int P = Model::parameters, L = number::size;
    using Sums = LaneSums<number, P>;
    using Factor = CholeskyFactor<number, P>;
    static constexpr int below = size_below(P);
    static constexpr bool is_double = sizeof(real) == 8;
    static constexpr real epsilon = is_double ? real(2.220446e-16) : real(1.1920929e-7);
    static constexpr real infinity = real(__builtin_inf());
    static constexpr real least_normal = is_double ? real(2.3e-308) : real(1.2e-38);
    static constexpr real largest = is_double ? real(1.7e308) : real(3.4e38);
    static constexpr real least_pivot = (is_double ? 4 : 16) * P * epsilon;  ///< of a matrix whose diagonal is 1

public:
    /// storage: bytes_for() the most samples of a problem, aligned as vectors are.
    ProblemLanes(const Chunk& chunk, void* storage)
        : chunk_(chunk), samples_(chunk, storage), adam_(chunk.learning_rate) {
        for (int i = 0; i < P; ++i) {
            at_[i] = trial_[i] = most_[i] = scale_[i] = last_[i] = sums_.gradient[i] = number(0);
            held_[i] = Mask{};
            lower_[i] = number(reals(chunk_.lower)[i]);
            upper_[i] = number(reals(chunk_.upper)[i]);
            fixed_[i] = chunk_.fixed[i] ? ~Mask{} : Mask{};
        }
        sums_.error = damping_ = growth_ = promised_ = allowance_ = shortest_ = number(1);
        steps_ = number(0);
        for (number& x : sums_.matrix) x = number(0);
        occupied_ = fresh_ = polished_ = better_ = bounded_ = Mask{};
        for (int lane = 0; lane < L; ++lane) problem_[lane] = -1;
    }
    static long long bytes_for(long long samples) { return LaneSamples<real, Model>::bytes_for(samples); }

    void run() {
        for (long long i = chunk_.first; i < chunk_.first + chunk_.count; ++i) {
            out(chunk_.error)[i] = infinity;
            chunk_.status[i] = int(BatchStatus::no_samples);
        }
        for (int lane = 0; lane < L; ++lane) take_next(lane);
        while (any_of(occupied_)) {
            Sums trial;
            samples_.evaluate(trial_, trial);
            Mask ended = accept(trial);
            ended |= propose(trial);
            if (!any_of(ended)) continue;
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
            if (!loaded) samples_.load(lane, problem);
            if (samples_.count(lane) == 0) {
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
            directions_.begin(lane);
            adam_.begin(lane);
            return;
        }
        samples_.release(lane);
    }

    // Moves to the trial where it is better; elsewhere the damping grows. Returns lanes whose start is not finite.
    Mask accept(const Sums& trial) {
        whole_ = is_finite(trial.error) & is_finite(samples_.squares());
        for (int i = 0; i < P; ++i)
            whole_ &= fixed_[i] | (is_finite(trial.gradient[i]) & is_finite(trial.matrix[place_below(i, i)]));
        better_ = occupied_ & (fresh_ | (whole_ & (trial.error < sums_.error + allowance_)));
        const number x = number(2) * (sums_.error - trial.error) / promised_ - number(1);
        const number factor = min(max(number(1) - x * x * x, number(1.0 / 3)), number(2));
        const number moved = max(damping_ * number::select(better_, factor, growth_), number(1e-20));
        damping_ = number::select(fresh_, damping_, moved);
        growth_ = number::select(better_, number(2), growth_ * number(2));
        steps_ += number::select(occupied_ & ~fresh_, number(1), number(0));
        const Mask lost = fresh_ & ~whole_;
        fresh_ = Mask{};
        const auto take = [this](number& to, const number& from) { to = number::select(better_, from, to); };
        take(sums_.error, trial.error);
        for (int k = 0; k < below; ++k) take(sums_.matrix[k], trial.matrix[k]);
        for (int i = 0; i < P; ++i) {
            take(at_[i], trial_[i]);
            take(sums_.gradient[i], trial.gradient[i]);
            most_[i] = max(most_[i], sums_.matrix[place_below(i, i)]);
        }
        if (any_of(lost))
            for (int lane = 0; lane < L; ++lane)
                if (lost[lane]) status_[lane] = BatchStatus::not_finite;
        lost_ = lost;
        return lost;
    }

    // Looks at at_: what may move, how far the minimum of Gauss and Newton's model lies; then sets trial_ to the next
    // step. Returns lanes that have ended, and why in status_.
    Mask propose(const Sums& trial) {
        number scaled[below], gradient[P], forward[P], free(0);
        bounded_ = Mask{};
        for (int i = 0; i < P; ++i) {
            const number& diagonal = sums_.matrix[place_below(i, i)];
            const Mask outward = ((at_[i] <= lower_[i]) & (sums_.gradient[i] >= number(0))) |
                                 ((at_[i] >= upper_[i]) & (sums_.gradient[i] <= number(0)));
            const Mask unseen = diagonal <= number(0);  // no sample depends on it
            held_[i] = fixed_[i] | outward | unseen;
            bounded_ |= outward & ~fixed_[i];
            free += number::select(fixed_[i] | (outward & ~unseen), number(0), number(1));
            scale_[i] = number::select(held_[i], number(0), number(1) / sqrt(diagonal));
        }
        for (int i = 0; i < P; ++i) {
            for (int j = 0; j < i; ++j)
                scaled[place_below(i, j)] = sums_.matrix[place_below(i, j)] * scale_[i] * scale_[j];
            scaled[place_below(i, i)] = number(1);
            gradient[i] = sums_.gradient[i] * scale_[i];
        }
        factor_ = Factor(scaled, number(least_pivot));
        factor_.forward(gradient, forward);
        for (int i = 0; i < P; ++i) last_[i] = forward[i];
        factor_.backward(last_);
        for (int i = 0; i < P; ++i) last_[i] *= scale_[i];
        number decrement(0);  // how far the minimum of Gauss and Newton's model lies, by the matrix' norm
        for (int i = 0; i < P; ++i) decrement += forward[i] * forward[i];

        // near: where rounding of values and of their sum hides whether the error still falls
        const number& error = sums_.error;
        const number hidden = number(epsilon) * (number(16) * error + number(4) * sqrt(error * samples_.squares()));
        const Mask near = decrement <= number(2) * hidden;
        allowance_ = number::select(near, hidden, number(0));
        const number damping = number::select(near, number(0), damping_);
        const bool wanders = chunk_.optimizer == BatchOptimizer::adam;
        if (wanders)
            wander(trial);
        else if (chunk_.optimizer == BatchOptimizer::levenberg_marquardt)
            step_by_matrix(scaled, gradient, damping);
        else
            step_along_direction(damping);
        const Mask stays = bound_trial();

        freedom_ = samples_.values() - free;
        const number variance = number(2) * error / max(freedom_, number(1));
        const Mask small = decrement <= number(real(chunk_.tolerance * chunk_.tolerance)) * variance;
        const number floor =
            number(32 * epsilon * epsilon) * samples_.squares();  // of exact samples; below all numbers it says nothing
        const Mask exact = (error <= floor) & (floor > number(least_normal));
        // near the minimum on until steps no longer become shorter
        const Mask settled = near & (stays | (polished_ & (decrement > number(0.5) * shortest_)));
        polished_ |= near;
        shortest_ = number::select(near, decrement, shortest_);
        const Mask done = small | exact | settled;
        const Mask stalled = wanders ? Mask{} : ~done & (stays | (damping_ > number(1e16)));
        const Mask spent = steps_ >= number(chunk_.iterations);
        const Mask ended = occupied_ & ~lost_ & (done | stalled | spent);
        if (any_of(ended))
            for (int lane = 0; lane < L; ++lane)
                if (ended[lane])
                    status_[lane] = done[lane]      ? minimum(lane)
                                    : stalled[lane] ? BatchStatus::stalled
                                                    : BatchStatus::max_iterations;
        return ended;
    }

    // Levenberg and Marquardt's step.
    void step_by_matrix(number (&scaled)[below], const number (&gradient)[P], const number& damping) {
        number step[P];
        for (int i = 0; i < P; ++i)
            scaled[place_below(i, i)] +=
                number::select(held_[i], number(0), damping * most_[i] * scale_[i] * scale_[i]);
        const Factor damped(scaled, number(least_pivot));
        damped.forward(gradient, step);
        damped.backward(step);
        for (int i = 0; i < P; ++i) trial_[i] = at_[i] - step[i] * scale_[i];
    }

    // To the minimum of Gauss and Newton's model along a direction, which damping draws nearer; to the first bound at
    // most.
    void step_along_direction(const number& damping) {
        number over[P], along[P], slope(0);
        for (int i = 0; i < P; ++i) over[i] = scale_[i] * scale_[i];
        if (chunk_.optimizer == BatchOptimizer::conjugate_gradients)
            directions_.conjugate(better_, sums_.gradient, over);
        else
            directions_.lbfgs(better_, at_, sums_.gradient, over);
        for (int i = 0; i < P; ++i) {
            const number& d = directions_[i];
            const Mask outward = ((at_[i] <= lower_[i]) & (d < number(0))) | ((at_[i] >= upper_[i]) & (d > number(0)));
            along[i] = number::select(outward, number(0), d);
            slope += sums_.gradient[i] * along[i];
        }
        const Mask down = slope < number(0);  // else the steepest, which leads within the bounds
        slope = number(0);
        number curvature(0), length(largest);
        for (int i = 0; i < P; ++i) {
            along[i] = number::select(down, along[i], -over[i] * sums_.gradient[i]);
            slope += sums_.gradient[i] * along[i];
            number by = number(0.5) * (sums_.matrix[place_below(i, i)] + damping * most_[i]) * along[i];
            for (int j = 0; j < i; ++j) by += sums_.matrix[place_below(i, j)] * along[j];
            curvature += number(2) * by * along[i];
            const Mask up = along[i] > number(0), moves = up | (along[i] < number(0));
            const number room = number::select(up, upper_[i], lower_[i]) - at_[i];
            length = number::select(moves, min(length, room / number::select(moves, along[i], number(1))), length);
        }
        const Mask bends = curvature > number(0);
        length = number::select(bends, min(length, -slope / number::select(bends, curvature, number(1))), number(0));
        for (int i = 0; i < P; ++i) {
            trial_[i] = at_[i] + length * along[i];
            const number rounding = number(8 * epsilon) * (abs(at_[i]) + abs(trial_[i]));  // of a step to the bound
            trial_[i] = number::select(abs(trial_[i] - lower_[i]) <= rounding, lower_[i], trial_[i]);
            trial_[i] = number::select(abs(trial_[i] - upper_[i]) <= rounding, upper_[i], trial_[i]);
        }
    }

    void wander(const Sums& trial) {
        number diagonal[P];
        for (int i = 0; i < P; ++i) diagonal[i] = number::select(fixed_[i], number(0), trial.matrix[place_below(i, i)]);
        adam_.move(trial_, at_, whole_, trial, diagonal);
    }

    // Keeps the trial within the bounds, and what is held where it is. Returns lanes where it stays at at_; promised_
    // is how much Gauss and Newton's model promises of it.
    Mask bound_trial() {
        number moved[P];
        Mask stays = ~Mask{};
        for (int i = 0; i < P; ++i) {
            trial_[i] = min(max(trial_[i], lower_[i]), upper_[i]);
            trial_[i] = number::select(held_[i], at_[i], trial_[i]);
            moved[i] = trial_[i] - at_[i];
            stays &= moved[i].v == 0;
        }
        promised_ = number(0);
        for (int i = 0; i < P; ++i) {
            number by = number(0.5) * sums_.matrix[place_below(i, i)] * moved[i] + sums_.gradient[i];
            for (int j = 0; j < i; ++j) by += sums_.matrix[place_below(i, j)] * moved[j];
            promised_ -= by * moved[i];
        }
        return stays;
    }

    static bool is_minimum(BatchStatus status) {
        return status == BatchStatus::converged || status == BatchStatus::at_bound;
    }

    // What a minimum is called. A parameter that no sample depends on is not determined.
    BatchStatus minimum(int lane) const {
        bool determined = freedom_.v[lane] >= 0 && factor_.least.v[lane] > least_pivot;
        for (int i = 0; i < P; ++i)
            if (!chunk_.fixed[i] && !(sums_.matrix[place_below(i, i)].v[lane] > 0)) determined = false;
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
        chunk_.seen[problem] = samples_.count(lane);
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
                for (int k = j; k < i; ++k) sum -= factor_.l[place_below(i, k)].v[lane] * inverse[k][j];
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
                const bool unseen = !(sums_.matrix[place_below(i, i)].v[lane] > 0);  // no sample depends on it
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
    LaneSamples<real, Model> samples_;
    SearchDirections<number, P> directions_;
    Adam<number, P> adam_;
    long long next_ = 0;  ///< of the chunk's problems

    // Of the problem in each lane.
    long long problem_[L], start_[L] = {};  ///< and from which of its starts
    BatchStatus status_[L] = {};
    /// whole_: of which the trial's sums are finite; better_: at_ is the trial; lost_: the start was not finite.
    Mask occupied_, fresh_, polished_, whole_, better_, bounded_, lost_, held_[P], fixed_[P];
    number at_[P], trial_[P], lower_[P], upper_[P];
    number most_[P], scale_[P],
        last_[P];  ///< most_: of the matrix' diagonal so far; last_: Gauss and Newton's step from at_
    Sums sums_;    ///< at at_
    Factor factor_;
    number damping_, growth_, promised_, freedom_, steps_;
    number allowance_, shortest_;  ///< what rounding leaves of errors; decrement of the last step below that
};

}  // namespace radiafit::batch
