#pragma once
// Symmetric matrices of as many rows as a problem has parameters, a problem a lane.
#include "batch/kernel/numbers.h"

namespace radiafit::batch {

/// Of the numbers on and below the diagonal, row by row: where that of row i, column j <= i is, and how many there are.
constexpr int place_below(int i, int j) { return i * (i + 1) / 2 + j; }
constexpr int size_below(int rows) { return rows * (rows + 1) / 2; }

/// Cholesky's factor of a matrix whose diagonal is about 1, one over its diagonal, and the least pivot. Pivots below
/// `least_pivot` are taken for it.
template <class number, int P>
struct CholeskyFactor {
    number l[size_below(P)], over[P], least;

    CholeskyFactor() = default;  ///< holds nothing yet
    CholeskyFactor(const number (&m)[size_below(P)], const number& least_pivot) {
        least = number(1);
#pragma GCC unroll 16
        for (int i = 0; i < P; ++i) {
#pragma GCC unroll 16
            for (int j = 0; j < i; ++j) {
                number x = m[place_below(i, j)];
                for (int k = 0; k < j; ++k) x -= l[place_below(i, k)] * l[place_below(j, k)];
                l[place_below(i, j)] = x * over[j];
            }
            number pivot = m[place_below(i, i)];
            for (int k = 0; k < i; ++k) pivot -= l[place_below(i, k)] * l[place_below(i, k)];
            least = min(least, pivot);
            const number root = sqrt(max(pivot, least_pivot));
            l[place_below(i, i)] = root;
            over[i] = number(1) / root;
        }
    }
    void forward(const number (&b)[P], number (&x)[P]) const {
        for (int i = 0; i < P; ++i) {
            number sum = b[i];
            for (int k = 0; k < i; ++k) sum -= l[place_below(i, k)] * x[k];
            x[i] = sum * over[i];
        }
    }
    void backward(number (&x)[P]) const {
        for (int i = P - 1; i >= 0; --i) {
            number sum = x[i];
            for (int k = i + 1; k < P; ++k) sum -= l[place_below(k, i)] * x[k];
            x[i] = sum * over[i];
        }
    }
};

}  // namespace radiafit::batch
