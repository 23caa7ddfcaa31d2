#pragma once
#include <algorithm>
#include <vector>

#include "base/lanes.h"
#include "reference/lane_cholesky.h"

namespace radiafit {

/// S = X' A^-1 X for one matrix per lane, added up over systems A that come factored. In 32 bits, a register full of
/// columns at a time.
class SchurLanes {
public:
    using F = Lanes<float>;
    /// rows: of X, at most.
    SchurLanes(size_t rows, size_t columns)
        : rows_(rows),
          columns_(columns),
          width_((columns + per_block - 1) / per_block * registers),
          x_(rows * width_),
          sum_(columns_padded() * width_) {}

    void clear_sum() { std::fill(sum_.begin(), sum_.end(), Register{}); }
    void clear_x() { std::fill(x_.begin(), x_.end(), Register{}); }
    F& x(size_t i, size_t j) { return x_[i * width_ + j / per_register].lanes[j % per_register]; }
    /// Entry of the sum's lower triangle, j <= i.
    const F& at(size_t i, size_t j) const { return sum_[i * width_ + j / per_register].lanes[j % per_register]; }

    /// A = L L' as LaneCholesky::factor() leaves it; X, which is overwritten, has as many rows.
    void add(const LaneCholesky& l) {
        rows_ = l.size();
        substitute(l);
        for (size_t m = 0; m < columns_; m += per_register)
            for (size_t n = 0; n <= m; n += per_block) {
                const size_t left = (m - n) / per_register + 1;  // registers up to the diagonal
                if (left == 1) multiply<1>(m, n);
                if (left == 2) multiply<2>(m, n);
                if (left == 3) multiply<3>(m, n);
                if (left >= 4) multiply<4>(m, n);
            }
    }

private:
    static constexpr size_t per_register = 4, registers = 4, per_block = per_register * registers;
    using Wide = float __attribute__((vector_size(64)));
    union Register {
        Wide wide{};
        F lanes[per_register];
    };
    static Wide broadcast(const F& x) {
        const auto twice = __builtin_shufflevector(x, x, 0, 1, 2, 3, 0, 1, 2, 3);  // in one step GCC 12 goes by memory
        return __builtin_shufflevector(twice, twice, 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
    }
    size_t columns_padded() const { return width_ * per_register; }

    /// X <- L^-1 X.
    void substitute(const LaneCholesky& l) {
        factors_.resize(l.band() + 1);
        for (size_t i = 0; i < rows_; ++i) {
            const size_t first = i > l.band() ? i - l.band() : 0;
            for (size_t j = first; j <= i; ++j) factors_[j - first] = __builtin_convertvector(l.at(i, j), F);
            for (size_t at = 0; at < width_; at += registers) {
                Register* own = &x_[i * width_ + at];
                Wide sum[registers];
                for (size_t r = 0; r < registers; ++r) sum[r] = own[r].wide;
                for (size_t j = first; j < i; ++j) {
                    const Register* other = &x_[j * width_ + at];
                    const Wide factor = broadcast(factors_[j - first]);
                    for (size_t r = 0; r < registers; ++r) sum[r] -= factor * other[r].wide;
                }
                const Wide pivot = broadcast(factors_[i - first]);
                for (size_t r = 0; r < registers; ++r) own[r].wide = sum[r] * pivot;
            }
        }
    }

    /// S += X' X in rows [m, m + per_register), `wide` registers of columns from n on.
    template <size_t wide>
    void multiply(size_t m, size_t n) {
        Wide sum[per_register][wide];
        Register* out = &sum_[m * width_ + n / per_register];
        for (size_t a = 0; a < per_register; ++a)
            for (size_t r = 0; r < wide; ++r) sum[a][r] = out[a * width_ + r].wide;
        for (size_t i = 0; i < rows_; ++i) {
            const Register* row = &x_[i * width_];
            const Register* right = row + n / per_register;
            for (size_t a = 0; a < per_register; ++a) {
                const Wide factor = broadcast(row[m / per_register].lanes[a]);
                for (size_t r = 0; r < wide; ++r) sum[a][r] += factor * right[r].wide;
            }
        }
        for (size_t a = 0; a < per_register; ++a)
            for (size_t r = 0; r < wide; ++r) out[a * width_ + r].wide = sum[a][r];
    }

    size_t rows_, columns_;
    size_t width_;               ///< registers of a row
    std::vector<Register> x_;    ///< [rows][width]
    std::vector<Register> sum_;  ///< [columns, rounded up][width]
    std::vector<F> factors_;     ///< a row of L
};

}  // namespace radiafit
