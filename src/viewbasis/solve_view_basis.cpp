#include "viewbasis/solve_view_basis.h"

#include <Eigen/Cholesky>

#include "base/parallel.h"
#include "viewbasis/finish_tiles.h"

namespace radiafit {
namespace {

/// One thread's room for a tile. Width: the rank, filled up with zeros to whole vectors.
template <int Width>
class TileSolver {
public:
    TileSolver(const TriangleAtlas& atlas, const SampleList& samples, const TexelViewReader& reader,
               const ViewBasis& basis)
        : atlas_(atlas), samples_(samples), reader_(reader), basis_(basis) {
        for (const BlockBasis& block : basis.blocks) {
            u_.emplace_back(Functions::Zero());
            u_.back().topRows(basis.rank) = block.u.transpose();
        }
    }

    void solve(uint32_t tile, ViewBasisSolution& out) {
        const uint32_t first = tile * atlas_.texels_per_tile(), texels = atlas_.tile(tile).texels();
        prepare(first, texels);
        add_samples(tile);
        for (uint32_t l = 0; l < texels; ++l) {
            if (texels_[l].samples == 0) continue;
            texels_[l].z = texels_[l].matrix.llt().solve(texels_[l].right);
            out.samples[first + l] = texels_[l].samples;
            const size_t rank = size_t(basis_.rank);
            for (size_t k = 0; k < rank; ++k)
                for (size_t c = 0; c < 3; ++c)
                    out.parameters[((first + l) * rank + k) * 3 + c] = texels_[l].z(Eigen::Index(k), Eigen::Index(c));
        }
        for (const Seen& s : seen_)
            out.error[first + s.local] += 0.5f * (s.colour - texels_[s.local].z.transpose() * s.phi).squaredNorm();
    }

private:
    using Functions = Eigen::Matrix<float, Width, view_terms>;
    struct Texel {
        Eigen::Matrix<float, Width, Width> matrix;
        Eigen::Matrix<float, Width, 3> right, z;
        Frame frame;
        Vec3f position;
        size_t block;
        uint32_t samples;
    };
    struct Seen {
        Eigen::Matrix<float, Width, 1> phi;
        Vec3f colour;  ///< less the mean
        uint32_t local;
    };

    void prepare(uint32_t first, uint32_t texels) {
        texels_.resize(texels);
        for (uint32_t l = 0; l < texels; ++l) {
            Texel& texel = texels_[l];
            texel.matrix = basis_.noise * Eigen::Matrix<float, Width, Width>::Identity();
            texel.right.setZero();
            texel.position = atlas_.position(first + l);
            texel.frame = view_frame(atlas_.normal(first + l), basis_.up);
            texel.block = basis_.block_at(texel.position);
            texel.samples = 0;
        }
    }
    void add_samples(uint32_t tile) {
        seen_.clear();
        for (uint32_t g = samples_.tile_groups[tile]; g < samples_.tile_groups[tile + 1]; ++g) {
            const Vec3f& eye = reader_.eye(samples_.groups[g].image);
            for (const Sample& s : samples_.of_group(g)) {
                Texel& texel = texels_[s.local];
                const Vec3f direction = view_direction(texel.frame, texel.position, eye);
                const ViewTerms b = view_polynomials(direction);
                Seen& seen = seen_.emplace_back();
                seen.phi.noalias() = u_[texel.block] * b;
                seen.colour = samples_.scale * Vec3f(s.rgb[0], s.rgb[1], s.rgb[2]) -
                              basis_.blocks[texel.block].mean.transpose() * b;
                seen.local = s.local;
                const Eigen::Matrix<float, Width, 1> weighted = view_sample_weight(direction) * seen.phi;
                texel.matrix.noalias() += weighted * seen.phi.transpose();
                texel.right.noalias() += weighted * seen.colour.transpose();
                ++texel.samples;
            }
        }
    }

    const TriangleAtlas& atlas_;
    const SampleList& samples_;
    const TexelViewReader& reader_;
    const ViewBasis& basis_;
    std::vector<Functions, Eigen::aligned_allocator<Functions>> u_;
    std::vector<Texel, Eigen::aligned_allocator<Texel>> texels_;
    std::vector<Seen, Eigen::aligned_allocator<Seen>> seen_;
};

template <int Width>
void solve_tiles(const TriangleAtlas& atlas, const SampleList& samples, const TexelViewReader& reader,
                 const ViewBasis& basis, Journal* journal, ViewBasisSolution& out) {
    std::vector<TileSolver<Width>> solvers(size_t(thread_count()), {atlas, samples, reader, basis});
    finish_tiles(
        journal, atlas,
        [&](auto& visit, size_t texel, size_t count) {
            const size_t numbers = 3 * size_t(basis.rank);
            visit(std::span(out.parameters).subspan(texel * numbers, count * numbers));
            visit(std::span(out.samples).subspan(texel, count));
            visit(std::span(out.error).subspan(texel, count));
        },
        [&](uint32_t tile, int worker) { solvers[size_t(worker)].solve(tile, out); });
}

}  // namespace

ViewBasisSolution solve_view_basis(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                   const ViewBasis& basis, Journal* journal) {
    ViewBasisSolution out;
    out.parameters.assign(size_t(atlas.texel_count()) * size_t(basis.rank) * 3, 0.0f);
    out.samples.assign(atlas.texel_count(), 0);
    out.error.assign(atlas.texel_count(), 0.0f);
    const TexelViewReader reader(dataset, atlas, samples, basis.up);
    const auto solve = basis.rank <= 8    ? solve_tiles<8>
                       : basis.rank <= 16 ? solve_tiles<16>
                       : basis.rank <= 24 ? solve_tiles<24>
                                          : solve_tiles<32>;
    solve(atlas, samples, reader, basis, journal, out);
    return out;
}

}  // namespace radiafit
