#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "base/lanes.h"
#include "base/rings.h"

namespace radiafit::fits {

/// Symmetric positive definite matrices of one band, one per lane: A = L L' and A x = b. The lane of padding holds the
/// identity.
class LaneCholesky {
public:
    using V = Lanes<double>;
    /// A zero matrix whose entries (i, j) with |i - j| > band stay zero.
    LaneCholesky(size_t size, size_t band) : size_(size), band_(std::min(band, size - 1)), diagonal_(size) {
        size_t entries = 0;
        for (size_t i = 0; i < size; ++i) {
            entries += std::min(i, band_) + 1;
            diagonal_[i] = entries - 1;
        }
        entries_.resize(entries);
        clear();
    }
    size_t size() const { return size_; }
    size_t band() const { return band_; }

    void clear() { std::fill(entries_.begin(), entries_.end(), V{}); }
    /// Entry of the lower triangle, j <= i <= j + band.
    V& at(size_t i, size_t j) { return entries_[diagonal_[i] + j - i]; }
    const V& at(size_t i, size_t j) const { return entries_[diagonal_[i] + j - i]; }

    /// y = A x, before factor().
    void multiply(const V* x, V* y) const {
        for (size_t i = 0; i < size_; ++i) {
            const size_t first = first_of(i);
            const V* row = &at(i, first);
            y[i] = at(i, i) * x[i] + dot(row, x + first, i - first);
            for (size_t j = first; j < i; ++j) y[j] += row[j - first] * x[i];
        }
    }

    /// Overwrites A by L, with 1 / L(i, i) on the diagonal. Bit c of the result: lane c isn't positive definite (then
    /// no lane is factored).
    unsigned factor() {
        columns_.assign(panel * size_, V{});
        for (size_t begin = 0; begin < size_; begin += panel) {
            const size_t end = std::min(begin + panel, size_);
            if (const unsigned bad = factor_panel(begin, end)) return bad;
            const size_t last = std::min(size_, end + band_);
            size_t i = end;  // what the panel's columns take from the rest, two rows at once
            for (; i + 2 <= last; i += 2) {
                const size_t first = std::max(end, first_of(i + 1));
                if (first > end) subtract<1>(i, first - 1, first);  // the upper row's band begins one earlier
                subtract<2>(i, first, i + 1);
                subtract<1>(i + 1, i + 1, i + 2);
            }
            if (i < last) subtract<1>(i, std::max(end, first_of(i)), i + 1);
        }
        return 0;
    }

    /// After factor(): b <- the solution of A x = b.
    void solve(V* b) const {
        for (size_t i = 0; i < size_; ++i) {
            const size_t first = first_of(i);
            b[i] = (b[i] - dot(&at(i, first), b + first, i - first)) * at(i, i);
        }
        for (size_t i = size_; i-- > 0;) {
            b[i] *= at(i, i);
            const size_t first = first_of(i);
            const V* row = &at(i, first);
            for (size_t j = first; j < i; ++j) b[j] -= row[j - first] * b[i];
        }
    }

private:
    static constexpr size_t panel = 4;  ///< columns that are eliminated together

    size_t first_of(size_t i) const { return i > band_ ? i - band_ : 0; }
    V* column(size_t p) { return &columns_[p * size_]; }

    /// Columns [begin, end) of L, which column() holds as well down to the last row that any of them reaches.
    unsigned factor_panel(size_t begin, size_t end) {
        const size_t last = std::min(size_, end + band_);
        for (size_t j = begin; j < end; ++j) {
            V* own = column(j - begin);
            const size_t reach = std::min(size_, j + band_ + 1);
            for (size_t i = j; i < reach; ++i) own[i] = at(i, j);
            std::fill(own + reach, own + std::max(reach, last), V{});
            for (size_t p = 0; p < j - begin; ++p) {
                const V* before = column(p);
                for (size_t i = j; i < reach; ++i) own[i] -= before[j] * before[i];
            }
            own[j][3] = 1;
            unsigned bad = 0;
            for (int c = 0; c < 3; ++c)
                if (!(own[j][c] > 0)) bad |= 1u << c;
            if (bad) return bad;
            own[j] = reciprocal_root(own[j]);
            for (size_t i = j + 1; i < reach; ++i) own[i] *= own[j];
            for (size_t i = j; i < reach; ++i) at(i, j) = own[i];
        }
        return 0;
    }
    /// Subtracts the product of the panel's columns from columns [first, past) of `rows` rows of the rest.
    template <size_t rows>
    void subtract(size_t i, size_t first, size_t past) {
        V f[rows][panel];
        V* row[rows];
        for (size_t r = 0; r < rows; ++r) {
            for (size_t p = 0; p < panel; ++p) f[r][p] = column(p)[i + r];
            row[r] = &entries_[diagonal_[i + r] - (i + r)];
        }
        const V* panel_column[panel];
        for (size_t p = 0; p < panel; ++p) panel_column[p] = column(p);
        for (size_t k = first; k < past; ++k) {
            V sum[rows];
            for (size_t r = 0; r < rows; ++r) sum[r] = row[r][k];
            for (size_t p = 0; p < panel; ++p)
                for (size_t r = 0; r < rows; ++r) sum[r] -= f[r][p] * panel_column[p][k];
            for (size_t r = 0; r < rows; ++r) row[r][k] = sum[r];
        }
    }
    static V reciprocal_root(V x) {
        Eigen::Map<Eigen::Array4d> lanes(reinterpret_cast<double*>(&x));
        lanes = lanes.sqrt().inverse();
        return x;
    }
    static V dot(const V* a, const V* b, size_t count) {
        V sum[4] = {};  // four chains, so that additions don't wait for one another
        size_t i = 0;
        for (; i + 4 <= count; i += 4)
            for (size_t j = 0; j < 4; ++j) sum[j] += a[i + j] * b[i + j];
        for (; i < count; ++i) sum[0] += a[i] * b[i];
        return sum[0] + sum[1] + (sum[2] + sum[3]);
    }

    size_t size_, band_;
    std::vector<size_t> diagonal_;  ///< [row] place of (i, i)
    std::vector<V> entries_;        ///< rows of the lower triangle within the band, one after another
    std::vector<V> columns_;        ///< [panel][size]
};

}  // namespace radiafit::fits
