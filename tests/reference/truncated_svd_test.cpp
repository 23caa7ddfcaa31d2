// The leading singular values and vectors, against the full decomposition.
#include "reference/truncated_svd.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <tuple>

#include "base/rng.h"

namespace radiafit {
using namespace fits;
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd random_matrix(int rows, int columns, Rng& rng) {
    MatrixXd a(rows, columns);
    for (Index i = 0; i < a.size(); ++i) a.data()[i] = double(rng.uniform(-1, 1));
    return a;
}

/// Where every entry is measured.
void refine(const MatrixXd& a, TruncatedSvd& svd) { refine_measured(a, Unmeasured::Zero(a.rows(), a.cols()), svd); }

TEST(TruncatedSvd, AgreesWithTheFullDecomposition) {
    Rng rng(11);
    std::vector<MatrixXd> matrices = {random_matrix(40, 12, rng), random_matrix(9, 30, rng), random_matrix(1, 5, rng),
                                      random_matrix(5, 1, rng), MatrixXd::Zero(6, 4)};
    matrices.push_back(random_matrix(20, 2, rng) * random_matrix(2, 15, rng));  // rank 2
    matrices.push_back(matrices.back().transpose());
    matrices.push_back(MatrixXd::Constant(20, 15, -0.3));
    // large enough for orthogonal iteration: values that fall off, that don't, that lack rank, and that are all zero
    for (const double falls : {0.5, 0.999}) {
        matrices.push_back(random_matrix(120, 90, rng));
        for (Index i = 0; i < 90; ++i) matrices.back().col(i) *= std::pow(falls, double(i));
    }
    matrices.push_back(random_matrix(80, 2, rng) * random_matrix(2, 70, rng));
    matrices.push_back(matrices.back().transpose());
    matrices.push_back(MatrixXd::Zero(60, 70));
    for (const MatrixXd& a : matrices)
        for (int terms : {1, 2, 3, 6}) {
            SCOPED_TRACE(std::to_string(a.rows()) + " x " + std::to_string(a.cols()) + ", " + std::to_string(terms));
            const Eigen::JacobiSVD<MatrixXd> full(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
            const Index kept = std::min<Index>(terms, full.singularValues().size());
            const MatrixXd best = full.matrixU().leftCols(kept) * full.singularValues().head(kept).asDiagonal() *
                                  full.matrixV().leftCols(kept).transpose();
            const TruncatedSvd svd = truncated_svd(a, terms);
            ASSERT_EQ(svd.g.cols(), terms);
            ASSERT_EQ(svd.h.cols(), terms);
            EXPECT_LT((svd.g * svd.h.transpose() - best).norm(), 1e-8 * std::max(1.0, a.norm()));
            for (Index k = 0; k < terms; ++k) {
                if (k >= kept || full.singularValues()[k] < 1e-7 * full.singularValues()[0] || a.norm() == 0) {
                    EXPECT_EQ(svd.g.col(k).norm() + svd.h.col(k).norm(), 0);
                    continue;
                }
                EXPECT_NEAR(svd.h.col(k).squaredNorm(), double(a.cols()), 1e-9 * double(a.cols()));
                EXPECT_GE(svd.h.col(k).sum(), 0);
            }
        }
}

TEST(TruncatedSvd, RefinementApproachesItFromAnywhere) {
    Rng rng(13);
    for (const auto& [rows, columns] : {std::pair{50, 20}, {12, 30}}) {
        const MatrixXd a = random_matrix(rows, columns, rng);
        const double least = (a -
                              [&] {
                                  const TruncatedSvd best = truncated_svd(a, 3);
                                  return MatrixXd(best.g * best.h.transpose());
                              }())
                                 .norm();
        TruncatedSvd svd{MatrixXd::Zero(rows, 3), random_matrix(columns, 3, rng)};
        double before = a.norm();
        for (int i = 0; i < 300; ++i) {
            refine(a, svd);
            const double now = (a - svd.g * svd.h.transpose()).norm();
            ASSERT_LE(now, before * (1 + 1e-12));
            before = now;
        }
        EXPECT_NEAR(before, least, 1e-6 * least);
    }
    const MatrixXd one = MatrixXd::Constant(9, 7, 0.4);  // lacks the rank for three terms
    TruncatedSvd of_one = truncated_svd(one, 3);
    refine(one, of_one);
    EXPECT_LT((of_one.g * of_one.h.transpose() - one).norm(), 1e-12);
    EXPECT_EQ(of_one.h.rightCols(2).norm(), 0);
    TruncatedSvd none{MatrixXd::Zero(4, 2), MatrixXd::Zero(3, 2)};
    refine(MatrixXd::Zero(4, 3), none);
    EXPECT_EQ(none.g.norm() + none.h.norm(), 0);
}

// The same as filling in and refining one after the other.
TEST(TruncatedSvd, RefillingApproachesTheMeasuredEntries) {
    Rng rng(17);
    for (const auto& [rows, columns, terms] : {std::tuple{50, 20, 1}, {50, 20, 3}, {12, 30, 2}, {3, 8, 4}}) {
        const MatrixXd a = random_matrix(rows, columns, rng);
        Unmeasured unmeasured(rows, columns);
        for (Index i = 0; i < a.size(); ++i) unmeasured.data()[i] = rng.uniform(0, 1) < 0.3f;
        unmeasured.col(1).setOnes();
        unmeasured.col(2).setZero();
        const auto measured_distance = [&](const TruncatedSvd& svd) {
            return (unmeasured.array() > 0).select(0, a - svd.g * svd.h.transpose()).norm();
        };
        TruncatedSvd svd = truncated_svd(a, terms), apart = svd;
        double before = measured_distance(svd);
        for (int i = 0; i < 20; ++i) {
            const MatrixXd filled = (unmeasured.array() > 0).select(apart.g * apart.h.transpose(), a);
            refine(filled, apart);
            refine_measured(a, unmeasured, svd);
            const double now = measured_distance(svd);
            ASSERT_LE(now, before * (1 + 1e-12) + 1e-14);
            before = now;
            ASSERT_LT((svd.g * svd.h.transpose() - apart.g * apart.h.transpose()).norm(), 1e-11 * filled.norm());
        }
    }
}

}  // namespace
}  // namespace radiafit
