#include "lightbasis/solve_light_basis.h"

#include <algorithm>

#include "base/decompositions.h"
#include "base/parallel.h"

namespace radiafit::fits {

LightBasisSolver::LightBasisSolver(const LightBasis& basis)
    : basis_(&basis), at_samples_(std::make_shared<const LampFunctions>(basis, sample_smoothing)) {}

void LightBasisSolver::look_from(size_t block, const std::vector<LampAndHalf>& directions) {
    if (block == block_ && directions == directions_) return;
    accuracy_known_ = false;
    block_ = block;
    directions_ = directions;
    const auto n = Eigen::Index(directions.size());
    const Eigen::Index rank = basis_->rank;
    Eigen::MatrixXf kernels(Eigen::Index(basis_->lamps.size()), n);
    for (Eigen::Index i = 0; i < n; ++i) kernels.col(i) = at_samples_->kernel(directions[size_t(i)]);
    mean_.resize(3 * n, 1);
    functions_.resize(3 * n, rank);
    const LightBasis::Block& numbers = at_samples_->block(block);
    for (int c = 0; c < 3; ++c) {
        const auto of_channel = numbers.middleRows(c * kernels.rows(), kernels.rows());
        mean_.middleRows(c * n, n).noalias() = kernels.transpose() * of_channel.col(0);
        functions_.middleRows(c * n, n).noalias() = kernels.transpose() * of_channel.rightCols(rank);
    }
    const Eigen::MatrixXd functions = functions_.cast<double>();
    matrix_ = double(basis_->noise) * Eigen::MatrixXd::Identity(rank, rank);
    matrix_.noalias() += functions.transpose() * functions;
    cholesky_.compute(matrix_);
}

float LightBasisSolver::solve(size_t block, const TexelLights& lights, std::span<float> z) {
    look_from(block, lights.directions);
    const auto n = Eigen::Index(lights.size());
    const Eigen::Map<const Eigen::Matrix3Xf> values(lights.values.data()->data(), 3, n);
    Eigen::VectorXf residual(3 * n);
    for (int c = 0; c < 3; ++c) residual.segment(c * n, n) = values.row(c).transpose();
    residual -= mean_;
    Eigen::Map<Eigen::VectorXf> solution(z.data(), Eigen::Index(z.size()));
    const Eigen::VectorXf right = functions_.transpose() * residual;
    solution = cholesky_.solve(right.cast<double>()).cast<float>();
    return 0.5f * (residual - functions_ * solution).squaredNorm();
}

void LightBasisSolver::find_accuracy() {
    if (accuracy_known_) return;
    const Eigen::Index rank = matrix_.rows();
    const Eigen::MatrixXd inverse = cholesky_.solve(Eigen::MatrixXd::Identity(rank, rank));
    deviation_ = inverse.diagonal().cwiseMax(0).cwiseSqrt().cast<float>();
    determined_ = double(rank) - double(basis_->noise) * inverse.trace();
    deficient_ = uint32_t((symmetric_eigenvalues(matrix_).array() < 2 * double(basis_->noise)).count());
    accuracy_known_ = true;
}

double LightBasisSolver::determined() { return find_accuracy(), determined_; }
uint32_t LightBasisSolver::deficient() { return find_accuracy(), deficient_; }
const Eigen::VectorXf& LightBasisSolver::deviation() { return find_accuracy(), deviation_; }

Vec3f LightBasisSolver::deviation_at(const LampAndHalf& at) {
    const auto functions = at_samples_->at(block_, at);
    Vec3f out;
    for (int c = 0; c < 3; ++c)
        out[c] = float(
            cholesky_.matrixL().solve(functions.row(c).rightCols(basis_->rank).transpose().cast<double>()).norm());
    return out;
}

LightBasisSolution solve_light_basis(const Atlas& atlas, const TexelSource& source, const TexelLightReader& reader,
                                     const LightBasis& basis, Journal* journal) {
    const size_t texels = atlas.texel_count(), rank = size_t(basis.rank);
    LightBasisSolution out(texels, basis.rank);
    std::vector<LightBasisSolver> solvers(size_t(thread_count()), LightBasisSolver{basis});
    const auto texels_of = [&](size_t block) {
        const size_t begin = block * TexelSource::block;
        return std::pair(begin, std::min<size_t>(TexelSource::block, texels - begin));
    };
    finish_blocks(
        journal, source.block_count(),
        [&](auto& visit, size_t block) {
            const auto [begin, count] = texels_of(block);
            visit(std::span(out.parameters).subspan(begin * rank, count * rank));
            visit(std::span(out.samples).subspan(begin, count));
            visit(std::span(out.error).subspan(begin, count));
        },
        [&](size_t block, int worker) {
            const auto [begin, count] = texels_of(block);
            TexelSamples samples;
            TexelLights lights;
            source.read(uint32_t(begin), samples);
            for (size_t t = begin; t < begin + count; ++t) {
                reader.read(uint32_t(t), samples.of(t - begin), lights);
                out.samples[t] = uint32_t(lights.size());
                if (lights.size() > 0)
                    out.error[t] = solvers[size_t(worker)].solve(basis.block_at(atlas.position(uint32_t(t))), lights,
                                                                 std::span(out.parameters).subspan(t * rank, rank));
            }
        });
    return out;
}

}  // namespace radiafit::fits
