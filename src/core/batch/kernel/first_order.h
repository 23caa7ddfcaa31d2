#pragma once
// Where methods that know the gradient, but no matrix, go next: a problem a lane.
#include "batch/kernel/numbers.h"

namespace radiafit::batch {

/// Directions of conjugate gradients (Polak and Ribière's, restarted where beta is below 0) and of limited-memory BFGS
/// (Nocedal and Wright 2006, algorithm 7.4). Both begin with the gradient over the diagonal of Gauss and Newton's
/// matrix, and return to it where a step was in vain.
template <class number, int P>
class SearchDirections {
    using Mask = typename number::Mask;
    static constexpr int pairs = 5;  ///< that BFGS remembers

public:
    SearchDirections() {
        for (int lane = 0; lane < number::size; ++lane) begin(lane);
    }
    /// A new problem in a lane, of which nothing of the last one is left.
    void begin(int lane) {
        begun_[lane] = 0;
        last_norm_.v[lane] = 1;
        for (int i = 0; i < P; ++i) {
            direction_[i].v[lane] = last_point_[i].v[lane] = last_gradient_[i].v[lane] = 0;
            for (int k = 0; k < pairs; ++k) moved_[k][i].v[lane] = changed_[k][i].v[lane] = 0;
        }
    }

    const number& operator[](int i) const { return direction_[i]; }

    /// At the point that a step led to in these lanes; over: 1 / diagonal, 0 of parameters that are held.
    void conjugate(const Mask& stepped, const number (&gradient)[P], const number (&over)[P]) {
        number down[P], norm(0), change(0);
        for (int i = 0; i < P; ++i) {
            down[i] = over[i] * gradient[i];
            norm += down[i] * gradient[i];
            change += down[i] * (gradient[i] - last_gradient_[i]);
        }
        const Mask follows = begun_ & (last_norm_ > number(0));
        const number beta =
            number::select(follows, max(change, number(0)) / number::select(follows, last_norm_, number(1)), number(0));
        number to[P];
        for (int i = 0; i < P; ++i)
            to[i] = number::select(over[i] > number(0), beta * direction_[i] - down[i], number(0));
        turn(stepped, gradient, down, to);
        for (int i = 0; i < P; ++i) last_gradient_[i] = number::select(stepped, gradient[i], last_gradient_[i]);
        last_norm_ = number::select(stepped, norm, last_norm_);
        begun_ |= stepped;
    }

    // Of pairs, what they say of parameters that are free now.
    void lbfgs(const Mask& stepped, const number (&at)[P], const number (&gradient)[P], const number (&over)[P]) {
        remember(stepped, at, gradient);
        number to[P], down[P], share[pairs], over_curvature[pairs], free[P];
        for (int i = 0; i < P; ++i) {
            free[i] = number::select(over[i] > number(0), number(1), number(0));
            to[i] = free[i] * gradient[i];
            down[i] = over[i] * gradient[i];
        }
        for (int k = 0; k < pairs; ++k) {
            number curvature(0);
            for (int i = 0; i < P; ++i) curvature += free[i] * moved_[k][i] * changed_[k][i];
            const Mask usable = (curvature > number(0)) & is_finite(number(1) / curvature);
            over_curvature[k] =
                number::select(usable, number(1) / number::select(usable, curvature, number(1)), number(0));
            share[k] = over_curvature[k] * dot(moved_[k], to);
            for (int i = 0; i < P; ++i) to[i] -= share[k] * free[i] * changed_[k][i];
        }
        for (int i = 0; i < P; ++i) to[i] *= over[i];
        for (int k = pairs - 1; k >= 0; --k) {
            const number more = share[k] - over_curvature[k] * dot(changed_[k], to);
            for (int i = 0; i < P; ++i) to[i] += more * free[i] * moved_[k][i];
        }
        for (int i = 0; i < P; ++i) to[i] = -to[i];
        turn(stepped, gradient, down, to);
    }

private:
    static number dot(const number (&a)[P], const number (&b)[P]) {
        number sum(0);
        for (int i = 0; i < P; ++i) sum += a[i] * b[i];
        return sum;
    }

    // How the gradient changed along the last step, unless it is the first point.
    void remember(const Mask& stepped, const number (&at)[P], const number (&gradient)[P]) {
        const auto take = [&](number& to, const number& from) { to = number::select(stepped, from, to); };
        for (int i = 0; i < P; ++i) {
            for (int k = pairs - 1; k > 0; --k) {
                take(moved_[k][i], moved_[k - 1][i]);
                take(changed_[k][i], changed_[k - 1][i]);
            }
            take(moved_[0][i], number::select(begun_, at[i] - last_point_[i], number(0)));
            take(changed_[0][i], number::select(begun_, gradient[i] - last_gradient_[i], number(0)));
            take(last_point_[i], at[i]);
            take(last_gradient_[i], gradient[i]);
        }
        begun_ |= stepped;
    }

    // Where it doesn't lead down, or was tried in vain, the steepest direction.
    void turn(const Mask& stepped, const number (&gradient)[P], const number (&down)[P], const number (&to)[P]) {
        const Mask leads = stepped & (dot(gradient, to) < number(0));
        for (int i = 0; i < P; ++i) direction_[i] = number::select(leads, to[i], -down[i]);
    }

    Mask begun_;  ///< lanes that have a last point
    number direction_[P], last_point_[P], last_gradient_[P];
    number last_norm_;                            ///< of the last gradient, by the diagonal
    number moved_[pairs][P], changed_[pairs][P];  ///< the newest first; 0: none
};

/// Adam (Kingma and Ba 2015), which goes on from every trial. A parameter's unit is by how much it alone would have to
/// move to change the model's values by as much as they miss the targets at the start, by its largest derivatives so
/// far.
template <class number, int P>
class Adam {
    using Mask = typename number::Mask;

public:
    explicit Adam(double rate) : first_rate_(rate) {
        for (int lane = 0; lane < number::size; ++lane) begin(lane);
    }
    void begin(int lane) {
        left_.v[lane] = square_left_.v[lane] = 1;
        rate_.v[lane] = first_rate_;
        for (int i = 0; i < P; ++i) mean_[i].v[lane] = square_[i].v[lane] = unit_[i].v[lane] = most_[i].v[lane] = 0;
    }

    /// Moves a trial on, by the error, the gradient and the matrix' diagonal there; where they are not finite, back to
    /// the best point, and on by half the rate.
    template <class Sums>
    void move(number (&trial)[P], const number (&best)[P], const Mask& finite, const Sums& sums,
              const number (&diagonal)[P]) {
        const number decay(0.9), square_decay(0.999);
        start_error_ = number::select(left_ >= number(1), sums.error, start_error_);
        rate_ = number::select(finite, rate_, number(0.5) * rate_);
        left_ = number::select(finite, left_ * decay, left_);
        square_left_ = number::select(finite, square_left_ * square_decay, square_left_);
        for (int i = 0; i < P; ++i) {
            const Mask more = finite & (diagonal[i] > most_[i]);
            most_[i] = number::select(more, diagonal[i], most_[i]);
            unit_[i] = number::select(more, sqrt(number(2) * start_error_ / most_[i]), unit_[i]);
            const number g = sums.gradient[i] * unit_[i];
            mean_[i] = number::select(finite, decay * mean_[i] + (number(1) - decay) * g, mean_[i]);
            square_[i] =
                number::select(finite, square_decay * square_[i] + (number(1) - square_decay) * g * g, square_[i]);
            const number root = sqrt(square_[i] / (number(1) - square_left_));
            const Mask moves = root > number(0);
            const number step =
                rate_ * unit_[i] * mean_[i] / ((number(1) - left_) * number::select(moves, root, number(1)));
            trial[i] = number::select(finite, number::select(moves, trial[i] - step, trial[i]), best[i]);
        }
    }

private:
    double first_rate_;
    number mean_[P], square_[P], unit_[P], most_[P];  ///< most_: of the diagonal
    number start_error_;
    number left_, square_left_;  ///< of the means' first value, which is 0
    number rate_;
};

}  // namespace radiafit::batch
