#pragma once
#include <algorithm>
#include <vector>

#include "base/instructions.h"
#include "base/lanes.h"
#include "reference/lane_cholesky.h"

namespace radiafit::fits {

/// S = X' A^-1 X for one matrix per lane, added up over systems A that come factored. In 32 bits, registers full of
/// columns at a time: of 64 bytes where there is AVX-512, else of 32.
class SchurLanes {
public:
    using F = Lanes<float>;
    /// rows: of X, at most.
    SchurLanes(size_t rows, size_t columns)
        : rows_(rows),
          columns_(columns),
          width_((columns + per_block - 1) / per_block * per_block),
          x_(rows * width_ / per_line),
          sum_(width_ * width_ / per_line) {}

    void clear_sum() { std::fill(sum_.begin(), sum_.end(), Line{}); }
    void clear_x() { std::fill(x_.begin(), x_.end(), Line{}); }
    F& x(size_t i, size_t j) { return x_[0].lanes[i * width_ + j]; }
    /// Entry of the sum's lower triangle, j <= i.
    const F& at(size_t i, size_t j) const { return sum_[0].lanes[i * width_ + j]; }

    /// A = L L' as LaneCholesky::factor() leaves it; X, which is overwritten, has as many rows.
    void add(const LaneCholesky& l) {
        rows_ = l.size();
        if (run_avx512())
            with_widest_vectors([&] { add_by<Wide, 4>(l); });
        else
            add_by<Narrow, 2>(l);
    }

private:
    using Wide [[gnu::vector_size(64), gnu::may_alias]] = float;
    using Narrow [[gnu::vector_size(32), gnu::may_alias]] = float;
    static constexpr size_t per_line = 4, per_block = 16;
    struct alignas(64) Line {
        F lanes[per_line] = {};
    };
    static void broadcast(const F& x, Narrow& to) { to = __builtin_shufflevector(x, x, 0, 1, 2, 3, 0, 1, 2, 3); }
    static void broadcast(const F& x, Wide& to) {
        const auto twice = __builtin_shufflevector(x, x, 0, 1, 2, 3, 0, 1, 2, 3);  // in one step GCC 12 uses memory
        to = __builtin_shufflevector(twice, twice, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    template <class Register>
    static constexpr size_t columns_of = sizeof(Register) / sizeof(F);
    template <class Register>
    static Register* at(std::vector<Line>& lines, size_t column) {
        return reinterpret_cast<Register*>(&lines[0].lanes[column]);
    }

    /// wide: registers of columns that are summed at a time.
    template <class Register, size_t wide>
    void add_by(const LaneCholesky& l) {
        substitute<Register>(l);
        for (size_t m = 0; m < columns_; m += per_line)
            for (size_t n = 0; n <= m; n += wide * columns_of<Register>) multiply_up_to<Register, wide>(m, n);
    }

    /// X <- L^-1 X.
    template <class Register>
    void substitute(const LaneCholesky& l) {
        constexpr size_t registers = 4;
        factors_.resize(l.band() + 1);
        for (size_t i = 0; i < rows_; ++i) {
            const size_t first = i > l.band() ? i - l.band() : 0;
            for (size_t j = first; j <= i; ++j) factors_[j - first] = __builtin_convertvector(l.at(i, j), F);
            for (size_t column = 0; column < width_; column += registers * columns_of<Register>) {
                Register* own = at<Register>(x_, i * width_ + column);
                Register sum[registers], factor;
                for (size_t r = 0; r < registers; ++r) sum[r] = own[r];
                for (size_t j = first; j < i; ++j) {
                    const Register* other = at<Register>(x_, j * width_ + column);
                    broadcast(factors_[j - first], factor);
                    for (size_t r = 0; r < registers; ++r) sum[r] -= factor * other[r];
                }
                broadcast(factors_[i - first], factor);
                for (size_t r = 0; r < registers; ++r) own[r] = sum[r] * factor;
            }
        }
    }

    /// Multiplies as many of `most` registers as lie before the diagonal, or on it.
    template <class Register, size_t most>
    void multiply_up_to(size_t m, size_t n) {
        const size_t left = (m + per_line - n) / columns_of<Register>;
        if constexpr (most > 1)
            if (left < most) return multiply_up_to<Register, most - 1>(m, n);
        multiply<Register, most>(m, n);
    }

    /// S += X' X in rows [m, m + per_line), `wide` registers of columns from n on.
    template <class Register, size_t wide>
    void multiply(size_t m, size_t n) {
        Register sum[per_line][wide];
        for (size_t a = 0; a < per_line; ++a)
            for (size_t r = 0; r < wide; ++r) sum[a][r] = at<Register>(sum_, (m + a) * width_ + n)[r];
        for (size_t i = 0; i < rows_; ++i) {
            const F* left = &x(i, m);
            const Register* right = at<Register>(x_, i * width_ + n);
            for (size_t a = 0; a < per_line; ++a) {
                Register factor;
                broadcast(left[a], factor);
                for (size_t r = 0; r < wide; ++r) sum[a][r] += factor * right[r];
            }
        }
        for (size_t a = 0; a < per_line; ++a)
            for (size_t r = 0; r < wide; ++r) at<Register>(sum_, (m + a) * width_ + n)[r] = sum[a][r];
    }

    size_t rows_, columns_;
    size_t width_;            ///< of a row of x and of the sum: columns, rounded up to whole blocks
    std::vector<Line> x_;     ///< [rows][width]
    std::vector<Line> sum_;   ///< [width][width]
    std::vector<F> factors_;  ///< a row of L
};

}  // namespace radiafit::fits
