#include "viewbasis/solve_view_basis.h"

#include <Eigen/Cholesky>

#include "base/parallel.h"
#include "viewbasis/finish_tiles.h"

namespace radiafit::fits {
namespace {

/// One thread's solver. Width: the rank, filled up with zeros to whole vectors.
template <int Width>
class TexelSolver {
public:
    TexelSolver(const ViewBasis& basis) : basis_(basis) {
        for (size_t b = 0; b < basis.cubes.size(); ++b) {
            functions_.emplace_back(Eigen::Matrix<float, Width, view_terms>::Zero());
            functions_.back().topRows(basis.rank) = basis.block(b).rightCols(basis.rank).transpose();
        }
    }

    /// z: [rank][3].
    void solve(size_t block, std::span<const TexelView> views, float* z, float& error) {
        Eigen::Matrix<float, Width, Width> matrix = basis_.noise * Eigen::Matrix<float, Width, Width>::Identity();
        Eigen::Matrix<float, Width, 3> right = Eigen::Matrix<float, Width, 3>::Zero();
        const auto means = basis_.block(block).template leftCols<3>();
        seen_.clear();
        for (const TexelView& view : views) {
            const ViewTerms b = view_polynomials(view.direction);
            seen_.push_back({functions_[block] * b, view.colour - means.transpose() * b});
            const auto& [phi, colour] = seen_.back();
            const Eigen::Vector<float, Width> weighted = view_sample_weight(view.direction) * phi;
            matrix.noalias() += weighted * phi.transpose();
            right.noalias() += weighted * colour.transpose();
        }
        right = matrix.llt().solve(right);
        for (const Seen& s : seen_) error += 0.5f * (s.colour - right.transpose() * s.phi).squaredNorm();
        Eigen::Map<Eigen::Matrix<float, 3, Eigen::Dynamic>>(z, 3, basis_.rank) = right.topRows(basis_.rank).transpose();
    }

private:
    struct Seen {
        Eigen::Vector<float, Width> phi;
        Vec3f colour;  ///< less the mean
    };
    const ViewBasis& basis_;
    std::vector<Eigen::Matrix<float, Width, view_terms>> functions_;
    std::vector<Seen> seen_;
};

template <int Width>
void solve_tiles(const TriangleAtlas& atlas, const TexelViewReader& reader, const ViewBasis& basis, Journal* journal,
                 ViewBasisSolution& out) {
    std::vector<TexelSolver<Width>> solvers(size_t(thread_count()), {basis});
    std::vector<std::vector<std::vector<TexelView>>> read(solvers.size());
    finish_tiles(
        journal, atlas,
        [&](auto& visit, size_t texel, size_t count) {
            const size_t numbers = 3 * size_t(basis.rank);
            visit(std::span(out.parameters).subspan(texel * numbers, count * numbers));
            visit(std::span(out.samples).subspan(texel, count));
            visit(std::span(out.error).subspan(texel, count));
        },
        [&](uint32_t tile, int worker) {
            auto& texels = read[size_t(worker)];
            reader.read(tile, texels);
            for (size_t l = 0, t = size_t(tile) * atlas.texels_per_tile(); l < texels.size(); ++l, ++t) {
                out.samples[t] = uint32_t(texels[l].size());
                if (!texels[l].empty())
                    solvers[size_t(worker)].solve(basis.block_at(atlas.position(uint32_t(t))), texels[l],
                                                  &out.parameters[t * 3 * size_t(basis.rank)], out.error[t]);
            }
        });
}

}  // namespace

ViewBasisSolution solve_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                   const ViewBasis& basis, Journal* journal) {
    ViewBasisSolution out(atlas.texel_count(), basis.rank);
    const TexelViewReader reader(dataset, atlas, samples, basis.up);
    const auto solve = basis.rank <= 8    ? solve_tiles<8>
                       : basis.rank <= 16 ? solve_tiles<16>
                       : basis.rank <= 24 ? solve_tiles<24>
                                          : solve_tiles<32>;
    solve(atlas, reader, basis, journal, out);
    return out;
}

}  // namespace radiafit::fits
