#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "base/journal.h"
#include "base/parallel.h"
#include "basis/basis_texels.h"

/// What the texels of a surface have in common where the values of each are linear in coefficients x, of which few are
/// determined by its own samples: x ~ N(mean, covariance), learned by expectation and maximization over texels
/// (empirical Bayes; Dempster, Laird and Rubin 1977). A sample of weight w that observes b . x has noise of the
/// variance noise / w.
///
/// D: coefficients, or Eigen::Dynamic. R: vectors x of a texel, which share the covariance and have a mean each: 3
/// where the channels do, 1 where one vector has the coefficients of all of them.
namespace radiafit::fits {

template <int D, int R>
struct CoefficientPrior {
    using Matrix = Eigen::Matrix<double, D, D>;
    using Vectors = Eigen::Matrix<double, D, R>;
    Vectors mean;
    Matrix covariance;
};

/// Sums over texels of what the next prior is made from. Of `covariance` the lower triangle counts.
template <int D, int R>
struct Moments {
    using Prior = CoefficientPrior<D, R>;
    double texels = 0;
    typename Prior::Vectors mean;
    typename Prior::Matrix covariance;  ///< around the last prior's mean, the R vectors added up
    typename Prior::Matrix seen;        ///< sum over samples of w b b'
    double weight = 0;                  ///< of samples

    explicit Moments(Eigen::Index coefficients)
        : mean(Prior::Vectors::Zero(coefficients, R)),
          covariance(Prior::Matrix::Zero(coefficients, coefficients)),
          seen(covariance) {}
    void add(const Moments& other) {
        texels += other.texels;
        mean += other.mean;
        covariance += other.covariance;
        seen += other.seen;
        weight += other.weight;
    }
};

/// Expectation: what a prior and texels' samples say of their coefficients.
template <int D, int R>
class Expectation {
public:
    using Prior = CoefficientPrior<D, R>;
    using Matrix = typename Prior::Matrix;

    /// The prior must outlive it.
    Expectation(const Prior& prior, double noise) : prior_(prior), noise_(noise) {}
    const Prior& prior() const { return prior_; }

    /// For add_by_coefficients().
    void find_precision() { precision_ = prior_.covariance.llt().solve(identity()); }

    /// Adds texels that have been seen alike, all but the samples' weight, to `sums`. seen: sum over a texel's samples
    /// of w b b'. right: [D][R x texels] sum of w b (y - b . mean). For samples that outnumber the coefficients.
    template <class Right>
    void add_by_coefficients(const Matrix& seen, const Eigen::MatrixBase<Right>& right, Moments<D, R>& sums) const {
        const Eigen::Index texels = right.cols() / R;
        sums.seen += double(texels) * seen;
        const Eigen::LLT<Matrix> posterior(precision_ + seen / noise_);
        const typename Right::PlainObject offset = posterior.solve(right / noise_);
        sums.texels += double(texels);
        for (Eigen::Index i = 0; i < texels; ++i) sums.mean += offset.template middleCols<R>(R * i);
        sums.covariance += double(right.cols()) * posterior.solve(identity()) + offset * offset.transpose();
    }

    /// The same by the samples, for fewer of them than coefficients (Rasmussen and Williams 2006, equations 2.25 and
    /// 2.26). by_prior: [samples][D] sqrt(w) b' covariance. covariance: [samples][samples] of what they show,
    /// sqrt(w) b' covariance b sqrt(w). residuals: [samples][R x texels] sqrt(w) (y - b . mean). All but `seen`.
    template <class Rows, class Square, class Right>
    void add_by_samples(const Eigen::MatrixBase<Rows>& by_prior, const Eigen::MatrixBase<Square>& covariance,
                        const Eigen::MatrixBase<Right>& residuals, Moments<D, R>& sums) const {
        const Eigen::Index texels = residuals.cols() / R;
        typename Square::PlainObject noisy = covariance;
        noisy.diagonal().array() += noise_;
        const Eigen::LLT<typename Square::PlainObject> cholesky(noisy);
        const typename Rows::PlainObject root = cholesky.matrixL().solve(by_prior);
        const Eigen::Matrix<double, D, Eigen::Dynamic> offset = root.transpose() * cholesky.matrixL().solve(residuals);
        sums.texels += double(texels);
        for (Eigen::Index i = 0; i < texels; ++i) sums.mean += offset.template middleCols<R>(R * i);
        auto lower = sums.covariance.template selfadjointView<Eigen::Lower>();
        lower.rankUpdate(root.transpose(), -double(residuals.cols()));
        lower.rankUpdate(offset);
        sums.covariance.template triangularView<Eigen::Lower>() += double(residuals.cols()) * prior_.covariance;
    }

private:
    auto identity() const { return Matrix::Identity(prior_.covariance.rows(), prior_.covariance.cols()); }

    const Prior& prior_;
    double noise_;
    Matrix precision_;
};

/// Maximization. `common`, if given, counts as so many more texels in the covariance.
template <int D, int R>
CoefficientPrior<D, R> maximized(const CoefficientPrior<D, R>& last, const Moments<D, R>& sums,
                                 const CoefficientPrior<D, R>* common) {
    using Prior = CoefficientPrior<D, R>;
    constexpr double common_texels = 100;
    const double own = sums.texels, borrowed = common ? common_texels : 0;
    if (own + borrowed == 0) return last;
    Prior next;
    const typename Prior::Vectors offset = sums.mean / (own + 0.1 * borrowed);  // a mean needs fewer texels
    next.mean = last.mean + offset;
    typename Prior::Matrix covariance = sums.covariance.template selfadjointView<Eigen::Lower>();
    covariance = covariance / R - own * offset * offset.transpose() / R;
    if (common) covariance += borrowed * common->covariance;
    covariance /= own + borrowed;
    next.covariance = 0.5 * (covariance + covariance.transpose()) +
                      1e-12 * covariance.trace() * Prior::Matrix::Identity(covariance.rows(), covariance.cols());
    return next;
}

/// [D][rank]: the functions of most variance over what was seen, as columns, such that x = mean + their sum with
/// weights z ~ N(0, I) has the prior's covariance as far as so few can.
template <int D, int R>
Eigen::MatrixXd functions_of_most_variance(const CoefficientPrior<D, R>& prior, const Moments<D, R>& sums, int rank) {
    using Matrix = typename CoefficientPrior<D, R>::Matrix;
    const Matrix root = prior.covariance.llt().matrixL();
    const Matrix seen =
        sums.weight > 0 ? Matrix(sums.seen / sums.weight) : Matrix(Matrix::Identity(root.rows(), root.cols()));
    const Eigen::SelfAdjointEigenSolver<Matrix> spectrum(root.transpose() * seen * root);
    return root * spectrum.eigenvectors().rowwise().reverse().leftCols(rank);
}

/// Sums over texels, `at_once` at a time on all cores, and these added up in their order: the same for any number of
/// threads. add(texels, sums): of some of them.
template <int D, int R, class Add>
Moments<D, R> summed(std::span<const uint32_t> texels, size_t at_once, Eigen::Index coefficients, const Add& add) {
    std::vector<Moments<D, R>> parts((texels.size() + at_once - 1) / at_once, Moments<D, R>(coefficients));
    parallel_for(parts.size(), 1, [&](size_t part, int) {
        const size_t begin = part * at_once;
        add(texels.subspan(begin, std::min(at_once, texels.size() - begin)), parts[part]);
    });
    Moments<D, R> sums(coefficients);
    for (const auto& part : parts) sums.add(part);
    return sums;
}

/// First the prior of the whole surface, from `start` on, in so many rounds, and from there each block's:
/// finish(block, prior, moments) is called once for each, several at a time. moments(prior, texels) sums over some.
/// fields: as finish_blocks() has it (base/journal.h).
template <int D, int R, class MomentsOf, class Fields, class Finish>
void learn_blocks(const BasisTexels& texels, CoefficientPrior<D, R> start, int rounds, Journal* journal,
                  const MomentsOf& moments, const Fields& fields, const Finish& finish) {
    CoefficientPrior<D, R> common = std::move(start);
    for (int round = 0; round < rounds; ++round)
        common = maximized<D, R>(common, moments(common, texels.everywhere), nullptr);
    const bool one_for_all = texels.of_block.empty();
    finish_blocks(journal, texels.blocks.cubes.size(), fields, [&](size_t block, int) {
        const auto& of = one_for_all ? texels.everywhere : texels.of_block[block];
        CoefficientPrior<D, R> prior = common;
        for (int round = 0; round < rounds && !one_for_all; ++round)
            prior = maximized<D, R>(prior, moments(prior, of), &common);
        finish(block, prior, moments(prior, of));
    });
}

}  // namespace radiafit::fits
