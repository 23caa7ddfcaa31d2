#include "reference/pca_solver.h"

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>

#include "base/parallel.h"
#include "model/penalty.h"
#include "reference/triangulation.h"
#include "reference/truncated_svd.h"

namespace radiafit {
namespace {

double knob(const char* name) {
    const char* v = getenv(name);
    return v ? atof(v) : 0;
}

/// One vertex's light field, dense: a matrix per channel, [ring surface texels][reachable view texels].
struct DenseLightField {
    Eigen::MatrixXd channel[3];
    Eigen::MatrixXd invented;
    std::vector<uint8_t> seen;  ///< [ring surface texels] by some image
    uint64_t outside_hull = 0, unseen_texels = 0;
};

class Resampler {
public:
    Resampler(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, int view_side,
              const TileViews& tiles)
        : atlas_(&atlas),
          rings_(&rings),
          tiles_(&tiles),
          neighbours_(MapNeighbours::triangle(atlas.side())),
          frames_(vertex_frames(atlas.mesh())),
          view_texels_(reachable_view_texels(view_side)) {
        for (uint32_t texel : view_texels_)
            view_centers_.push_back(
                {(texel % uint32_t(view_side) + 0.5) / view_side, (texel / uint32_t(view_side) + 0.5) / view_side});
        for (uint32_t view : tiles.views) cameras_.push_back(dataset.views[view].camera.center());
    }

    const std::vector<uint32_t>& view_texels() const { return view_texels_; }

    /// False: no image sees any of the ring.
    bool resample(size_t v, DenseLightField& out) const {
        const auto ring = rings_->ring(v);
        const size_t texels = tiles_->texels_per_tile, rows = ring.size() * texels;
        for (Eigen::MatrixXd& m : out.channel) m.setZero(Eigen::Index(rows), Eigen::Index(view_texels_.size()));
        out.invented.setZero(Eigen::Index(rows), Eigen::Index(view_texels_.size()));
        out.seen.assign(rows, 0);
        out.outside_hull = out.unseen_texels = 0;
        for (size_t r = 0; r < ring.size(); ++r) interpolate_tile(v, ring[r].triangle, r * texels, out);
        if (std::find(out.seen.begin(), out.seen.end(), 1) == out.seen.end()) return false;
        fill_unseen(ring.size(), out);
        for (size_t r = 0; r < ring.size(); ++r)
            for (size_t local = 0; local < texels; ++local)
                for (Eigen::MatrixXd& m : out.channel)
                    m.row(Eigen::Index(r * texels + local)) *=
                        atlas_->barycentric(uint32_t(local))[ring[r].corner] * double(tiles_->scale);
        return true;
    }

private:
    void interpolate_tile(size_t v, uint32_t tile, size_t first_row, DenseLightField& out) const {
        const auto images = tiles_->images_of(tile);
        // Texels by the set of images that see them: mostly one set, more along what hides a part of the triangle.
        std::map<std::vector<uint16_t>, std::vector<uint32_t>> sets;
        for (uint32_t local = 0; local < tiles_->texels_per_tile; ++local) {
            std::vector<uint16_t> set;
            for (size_t i = 0; i < images.size(); ++i)
                if (tiles_->of(tile, i)[local].seen) set.push_back(uint16_t(i));
            if (!set.empty()) sets[std::move(set)].push_back(local);
        }
        std::vector<Vec2d> directions;
        for (const auto& [set, locals] : sets) {
            directions.clear();
            for (uint16_t i : set)
                directions.emplace_back(
                    view_coordinate(frames_[v], atlas_->mesh().positions[v], cameras_[images[i]]).data());
            const Triangulation triangulation(directions);
            for (size_t cell = 0; cell < view_centers_.size(); ++cell) {
                const Triangulation::Weights w = triangulation.at(view_centers_[cell]);
                if (!w.inside) out.outside_hull += locals.size();
                for (uint32_t local : locals) {
                    double sum[3] = {};
                    for (size_t k = 0; k < 3; ++k) {
                        const TileViews::Texel& t = tiles_->of(tile, set[w.point[k]])[local];
                        for (int c = 0; c < 3; ++c) sum[c] += w.weight[k] * t.rgb[c];
                    }
                    for (int c = 0; c < 3; ++c)
                        out.channel[c](Eigen::Index(first_row + local), Eigen::Index(cell)) = sum[c];
                    if (!w.inside) out.invented(Eigen::Index(first_row + local), Eigen::Index(cell)) = 1;
                }
            }
            for (uint32_t local : locals) out.seen[first_row + local] = 1;
        }
    }

    void fill_unseen(size_t ring_size, DenseLightField& out) const {
        const size_t texels = tiles_->texels_per_tile;
        for (uint8_t seen : out.seen) out.unseen_texels += (1 - seen) * view_texels_.size();
        if (out.unseen_texels == 0) return;
        Eigen::VectorXd mean[3];
        const double count = double(std::count(out.seen.begin(), out.seen.end(), 1));
        for (int c = 0; c < 3; ++c) mean[c] = out.channel[c].colwise().sum() / count;  // unseen rows are still zero
        for (size_t r = 0; r < ring_size; ++r) {
            uint8_t* seen = out.seen.data() + r * texels;
            if (std::find(seen, seen + texels, 1) == seen + texels) {
                for (size_t local = 0; local < texels; ++local)
                    for (int c = 0; c < 3; ++c) out.channel[c].row(Eigen::Index(r * texels + local)) = mean[c];
                continue;
            }
            grow_tile(r * texels, seen, out);
        }
    }

    /// Unseen texels beside known ones take their mean; then those beside these, until all are known.
    void grow_tile(size_t first_row, uint8_t* known, DenseLightField& out) const {
        const size_t texels = tiles_->texels_per_tile;
        std::vector<uint32_t> grown;
        do {
            grown.clear();
            for (uint32_t local = 0; local < texels; ++local) {
                if (known[local]) continue;
                int count = 0;
                for (uint32_t other : neighbours_.of(local)) count += known[other];
                if (count == 0) continue;
                for (Eigen::MatrixXd& m : out.channel) {
                    auto row = m.row(Eigen::Index(first_row + local));
                    for (uint32_t other : neighbours_.of(local))
                        if (known[other]) row += m.row(Eigen::Index(first_row + other)) / count;
                }
                grown.push_back(local);
            }
            for (uint32_t local : grown) known[local] = 1;
        } while (!grown.empty());
    }

    const TriangleAtlas* atlas_;
    const VertexRings* rings_;
    const TileViews* tiles_;
    MapNeighbours neighbours_;
    std::vector<Frame> frames_;
    std::vector<uint32_t> view_texels_;
    std::vector<Vec2d> view_centers_;
    std::vector<Vec3d> cameras_;
};

}  // namespace

std::vector<uint32_t> reachable_view_texels(int view_side) {
    const double m = view_side;
    const auto gap = [&](int j) {  // from the disc's middle to the nearest coordinate with a weight on column j
        const double low = std::max(0.0, (j - 0.5) / m), high = std::min(1.0, (j + 1.5) / m);
        return std::max({0.0, low - 0.5, 0.5 - high});
    };
    std::vector<uint32_t> texels;
    for (int y = 0; y < view_side; ++y)
        for (int x = 0; x < view_side; ++x)
            if (std::hypot(gap(x), gap(y)) < 0.5) texels.push_back(uint32_t(y * view_side + x));
    return texels;
}

PcaFit pca_solver(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout,
                  const TileViews& tiles) {
    const Resampler resampler(dataset, atlas, rings, layout.view_side(), tiles);
    const std::vector<uint32_t>& view_texels = resampler.view_texels();
    PcaFit fit;
    fit.parameters.assign(layout.size(), 0.0f);
    std::vector<uint64_t> outside(layout.problem_count(), 0), unseen(outside), entries(outside);
    std::vector<DenseLightField> scratch(static_cast<size_t>(thread_count()));
    const int em = int(knob("PCA_EM"));
    parallel_for(layout.problem_count(), 1, [&](size_t v, int worker) {
        DenseLightField& field = scratch[size_t(worker)];
        if (!resampler.resample(v, field)) return;
        entries[v] = uint64_t(field.channel[0].size());
        outside[v] = field.outside_hull;
        unseen[v] = field.unseen_texels;
        const size_t stride = layout.stride(), terms = size_t(layout.terms());
        for (size_t c = 0; c < 3; ++c) {
            TruncatedSvd svd = truncated_svd(field.channel[c], layout.terms());
            for (int it = 0; it < em; ++it) {
                const Eigen::MatrixXd approx = svd.g * svd.h.transpose();
                field.channel[c] = field.invented.array().select(approx, field.channel[c]);
                svd = truncated_svd(field.channel[c], layout.terms());
            }
            for (size_t k = 0; k < terms; ++k) {
                float* surface = fit.parameters.data() + layout.offset(v) + 4 * k + c;
                for (Eigen::Index i = 0; i < svd.g.rows(); ++i)
                    surface[size_t(i) * stride] = float(svd.g(i, Eigen::Index(k)));
                float* view = fit.parameters.data() + layout.view_offset(v) + 4 * k + c;
                for (size_t i = 0; i < view_texels.size(); ++i)
                    view[view_texels[i] * stride] = float(svd.h(Eigen::Index(i), Eigen::Index(k)));
            }
        }
    });
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        fit.entries += entries[v];
        fit.outside_hull += outside[v];
        fit.unseen_texels += unseen[v];
    }
    return fit;
}

}  // namespace radiafit
