#include "reference/truncated_svd.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/decompositions.h"
#include "base/rng.h"

namespace radiafit::fits {
namespace {

// Singular values below this share of the largest count as zero. Gram matrices square the singular values, so what is
// smaller drowns in rounding: far below what photographs of 8 or 16 bits hold.
constexpr double negligible = 1e-7;

/// Terms from right singular vectors, the columns of h in descending order, and A times them, g; nothing from the first
/// negligible one on.
TruncatedSvd scaled(TruncatedSvd out) {
    const double scale = std::sqrt(double(out.h.rows())), largest = out.g.col(0).norm();
    bool ended = false;
    for (Eigen::Index k = 0; k < out.h.cols(); ++k) {
        ended = ended || !(out.g.col(k).norm() > negligible * largest);
        if (ended) {
            out.g.col(k).setZero();
            out.h.col(k).setZero();
            continue;
        }
        const double sign = out.h.col(k).sum() < 0 ? -1 : 1;
        out.g.col(k) *= sign / scale;
        out.h.col(k) *= sign * scale;
    }
    return out;
}

Eigen::MatrixXd gram(const Eigen::MatrixXd& rows) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
    out.selfadjointView<Eigen::Lower>().rankUpdate(rows);
    return out;
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& narrow) {
    return Eigen::HouseholderQR<Eigen::MatrixXd>(narrow).householderQ() *
           Eigen::MatrixXd::Identity(narrow.rows(), narrow.cols());
}

/// Eigenvectors of a Gram matrix's largest eigenvalues, descending: [size][count]. Only its lower half is read. By
/// orthogonal iteration with some vectors more than asked for, which takes a few products where eigenvalues fall off
/// as those of photographs do; where they don't, by all eigenvectors.
Eigen::MatrixXd first_eigenvectors(const Eigen::MatrixXd& of, Eigen::Index count) {
    constexpr Eigen::Index more = 6, small = 32;
    constexpr int most_rounds = 40;
    const Eigen::Index size = of.rows(), block = count + more;
    Rng rng(1);
    Eigen::MatrixXd v(size, block);
    for (double& x : v.reshaped()) x = double(rng.uniform(-1, 1));
    const auto symmetric = of.selfadjointView<Eigen::Lower>();
    for (int round = 0; size > std::max(small, 2 * block) && round < most_rounds; ++round) {
        v = orthonormal(v);
        Eigen::MatrixXd image = symmetric * v;
        const SymmetricEigen within = symmetric_eigen(v.transpose() * image);  // the best within the span
        const Eigen::MatrixXd turn = within.vectors.rowwise().reverse();
        const Eigen::VectorXd values = within.values.reverse();
        v *= turn;
        image *= turn;
        const double off = (image.leftCols(count) - v.leftCols(count) * values.head(count).asDiagonal()).norm();
        if (off <= 1e-13 * values[0]) return v.leftCols(count);
        v = std::move(image);
    }
    return symmetric_eigen(of).vectors.rowwise().reverse().leftCols(count);
}

/// Orthonormal also where `narrow` lacks rank; descending.
Eigen::MatrixXd left_singular_vectors(const Eigen::MatrixXd& narrow) {
    return Eigen::JacobiSVD<Eigen::MatrixXd>(narrow, Eigen::ComputeThinU).matrixU();
}

}  // namespace

TruncatedSvd truncated_svd(const Eigen::MatrixXd& a, int terms) {
    const Eigen::Index count = std::min<Eigen::Index>({terms, a.rows(), a.cols()});
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(a.cols(), terms);
    if (a.cols() <= a.rows())
        v.leftCols(count) = first_eigenvectors(gram(a.transpose()), count);
    else
        v.leftCols(count) = left_singular_vectors(a.transpose() * first_eigenvectors(gram(a), count));
    return scaled({a * v, v});
}

void refine_measured(const Eigen::MatrixXd& a, const Unmeasured& unmeasured, TruncatedSvd& svd) {
    const Eigen::Index rows = a.rows(), terms = svd.h.cols(), count = std::min({terms, rows, a.cols()});
    // Column after column, while a cache holds it. Of columns without a measured entry only g and h are needed.
    Eigen::VectorXd filled(rows);
    const auto each_column = [&](const auto& measured, const auto& wholly_unmeasured) {
        for (Eigen::Index j = 0; j < a.cols(); ++j) {
            const uint8_t* open = unmeasured.col(j).data();
            if (!std::memchr(open, 0, size_t(rows))) {
                wholly_unmeasured(j);
                continue;
            }
            const double* entry = a.col(j).data();
            filled.noalias() = svd.g * svd.h.row(j).transpose();
            for (Eigen::Index i = 0; i < rows; ++i) filled[i] = open[i] ? filled[i] : entry[i];
            measured(j);
        }
    };
    Eigen::MatrixXd ah = Eigen::MatrixXd::Zero(rows, terms), of_h = Eigen::MatrixXd::Zero(terms, terms);
    each_column([&](Eigen::Index j) { ah.noalias() += filled * svd.h.row(j); },
                [&](Eigen::Index j) { of_h.noalias() += svd.h.row(j).transpose() * svd.h.row(j); });
    ah.noalias() += svd.g * of_h;
    const Eigen::MatrixXd q = orthonormal(ah.leftCols(count)), gq = svd.g.transpose() * q;
    Eigen::MatrixXd b(a.cols(), count), ab = Eigen::MatrixXd::Zero(rows, count),
                                        of_b = Eigen::MatrixXd::Zero(terms, count);
    each_column(
        [&](Eigen::Index j) {
            b.row(j).noalias() = filled.transpose() * q;
            ab.noalias() += filled * b.row(j);
        },
        [&](Eigen::Index j) {
            b.row(j).noalias() = svd.h.row(j) * gq;
            of_b.noalias() += svd.h.row(j).transpose() * b.row(j);
        });
    ab.noalias() += svd.g * of_b;
    // b = u s w^T, so that A u = A b w / s
    const Eigen::JacobiSVD<Eigen::MatrixXd> decomposed(b, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& s = decomposed.singularValues();
    TruncatedSvd refined{Eigen::MatrixXd::Zero(rows, terms), Eigen::MatrixXd::Zero(a.cols(), terms)};
    refined.h.leftCols(count) = decomposed.matrixU();
    for (Eigen::Index k = 0; k < count && s[k] > negligible * s[0]; ++k)
        refined.g.col(k).noalias() = ab * decomposed.matrixV().col(k) / s[k];
    svd = scaled(std::move(refined));
}

}  // namespace radiafit::fits
