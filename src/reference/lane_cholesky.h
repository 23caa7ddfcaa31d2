#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/lanes.h"

namespace radiafit {

/// Symmetric positive definite matrices of one band, one per lane: A = L L' and A x = b. The lane of padding holds the
/// identity.
class LaneCholesky {
public:
    using V = Lanes<double>;
    /// A zero matrix whose entries (i, j) with |i - j| > band stay zero.
    LaneCholesky(size_t size, size_t band) : size_(size), band_(std::min(band, size - 1)), entries_(size * width()) {
        clear();
    }
    size_t size() const { return size_; }

    void clear() { std::fill(entries_.begin(), entries_.end(), V{}); }
    /// Entry of the lower triangle, j <= i <= j + band.
    V& at(size_t i, size_t j) { return entries_[i * width() + band_ + j - i]; }
    const V& at(size_t i, size_t j) const { return entries_[i * width() + band_ + j - i]; }

    /// Overwrites A by L, with 1 / L(i, i) on the diagonal. False if a lane is not positive definite.
    bool factor() {
        for (size_t i = 0; i < size_; ++i) {
            at(i, i)[3] = 1;
            const size_t first = i > band_ ? i - band_ : 0;
            for (size_t j = first; j < i; ++j) {
                const size_t shared = std::max(first, j > band_ ? j - band_ : 0);
                at(i, j) = (at(i, j) - dot(&at(i, shared), &at(j, shared), j - shared)) * at(j, j);
            }
            const V pivot = at(i, i) - dot(&at(i, first), &at(i, first), i - first);
            for (int c = 0; c < 4; ++c) {
                if (!(pivot[c] > 0)) return false;
                at(i, i)[c] = 1 / std::sqrt(pivot[c]);
            }
        }
        return true;
    }

    /// After factor(): b <- the solution of A x = b.
    void solve(V* b) const {
        for (size_t i = 0; i < size_; ++i) {
            const size_t first = i > band_ ? i - band_ : 0;
            b[i] = (b[i] - dot(&at(i, first), b + first, i - first)) * at(i, i);
        }
        for (size_t i = size_; i-- > 0;) {
            b[i] *= at(i, i);
            for (size_t j = i > band_ ? i - band_ : 0; j < i; ++j) b[j] -= at(i, j) * b[i];
        }
    }

private:
    size_t width() const { return band_ + 1; }
    static V dot(const V* a, const V* b, size_t count) {
        V sum[4] = {};  // four chains, so that additions don't wait for one another
        size_t i = 0;
        for (; i + 4 <= count; i += 4)
            for (size_t j = 0; j < 4; ++j) sum[j] += a[i + j] * b[i + j];
        for (; i < count; ++i) sum[0] += a[i] * b[i];
        return sum[0] + sum[1] + (sum[2] + sum[3]);
    }

    size_t size_, band_;
    std::vector<V> entries_;  ///< [row][band + 1], the diagonal last
};

}  // namespace radiafit
