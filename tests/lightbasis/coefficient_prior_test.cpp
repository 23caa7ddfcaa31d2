// What a prior and samples say of coefficients, by coefficients and by samples.
#include "basis/coefficient_prior.h"

#include <gtest/gtest.h>

#include <random>

namespace radiafit::fits {
namespace {

Eigen::MatrixXd random_matrix(std::mt19937& random, Eigen::Index rows, Eigen::Index columns) {
    std::normal_distribution<double> normal;
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST(Expectation, IsTheSameByCoefficientsAndBySamples) {
    using Prior = CoefficientPrior<Eigen::Dynamic, 1>;
    std::mt19937 random(3);
    constexpr double noise = 0.02;
    constexpr Eigen::Index coefficients = 7, texels = 3;
    const Eigen::MatrixXd root = random_matrix(random, coefficients, coefficients);
    const Prior prior{random_matrix(random, coefficients, 1), root * root.transpose()};
    Expectation<Eigen::Dynamic, 1> expectation(prior, noise);
    expectation.find_precision();
    for (const Eigen::Index samples : {1, 4, 12}) {
        const Eigen::MatrixXd seen_by = random_matrix(random, samples, coefficients),
                              residuals = random_matrix(random, samples, texels), by_prior = seen_by * prior.covariance;
        Moments<Eigen::Dynamic, 1> one(coefficients), other(coefficients);
        expectation.add_by_coefficients(seen_by.transpose() * seen_by, seen_by.transpose() * residuals, one);
        expectation.add_by_samples(by_prior, by_prior * seen_by.transpose(), residuals, other);
        EXPECT_EQ(one.texels, other.texels);
        EXPECT_LT((one.mean - other.mean).norm(), 1e-9 * one.mean.norm());
        const auto next = maximized<Eigen::Dynamic, 1>(prior, one, nullptr),
                   also = maximized<Eigen::Dynamic, 1>(prior, other, nullptr);
        EXPECT_LT((next.covariance - also.covariance).norm(), 1e-9 * next.covariance.norm());
        EXPECT_EQ(also.covariance, also.covariance.transpose());
    }
}

}  // namespace
}  // namespace radiafit::fits
