#include "reference/ring_resampler.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "model/lfm.h"

namespace radiafit::fits {

ResamplingCounts& ResamplingCounts::operator+=(const ResamplingCounts& other) {
    entries += other.entries;
    outside_hull += other.outside_hull;
    unseen_texels += other.unseen_texels;
    return *this;
}

RingResampler::RingResampler(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const TileViews& tiles, int view_side)
    : atlas_(&atlas),
      rings_(&rings),
      tiles_(&tiles),
      frames_(vertex_frames(atlas.mesh())),
      view_texels_(reachable_view_texels(view_side)) {
    const auto center = [&](uint32_t at) { return (at + 0.5) / view_side; };
    for (uint32_t texel : view_texels_)
        view_centers_.push_back({center(texel % uint32_t(view_side)), center(texel / uint32_t(view_side))});
    for (uint32_t view : tiles.views) cameras_.push_back(dataset.views[view].camera.center());
}

bool RingResampler::resample(size_t vertex, DenseLightField& out) const {
    const auto ring = rings_->ring(vertex);
    std::vector<size_t> first_rows = {0};  // of the ring's tiles
    for (const Corner& corner : ring) first_rows.push_back(first_rows.back() + atlas_->tile(corner.triangle).texels());
    const size_t rows = first_rows.back();
    const auto height = Eigen::Index(rows), width = Eigen::Index(view_texels_.size());
    for (Eigen::MatrixXd& m : out.channel) m.setZero(height, width);
    out.invented.setZero(height, width);
    out.seen.assign(rows, 0);
    out.counts = {};
    std::map<ImageSet, Mixing> mixings;
    for (size_t r = 0; r < ring.size(); ++r) interpolate_tile(vertex, ring[r].triangle, first_rows[r], mixings, out);
    if (std::find(out.seen.begin(), out.seen.end(), 1) == out.seen.end()) return false;
    fill_unseen(ring, first_rows, out);
    out.counts.entries = rows * view_texels_.size();
    for (size_t r = 0; r < ring.size(); ++r) {
        const TriangleTile& tile = atlas_->tile(ring[r].triangle);
        for (uint32_t local = 0; local < tile.texels(); ++local)
            for (Eigen::MatrixXd& m : out.channel)
                m.row(Eigen::Index(first_rows[r] + local)) *=
                    double(tile.barycentric(local)[ring[r].corner]) * double(tiles_->scale);
    }
    return true;
}

SubsetInterpolation RingResampler::interpolation(size_t vertex, uint32_t tile) const {
    std::vector<Vec2d> directions;
    for (const uint32_t image : tiles_->images_of(tile))
        directions.emplace_back(
            view_coordinate(frames_[vertex], atlas_->mesh().positions[vertex], cameras_[image]).data());
    return {std::move(directions), view_centers_};
}

void RingResampler::interpolate_tile(size_t vertex, uint32_t tile, size_t first_row,
                                     std::map<ImageSet, Mixing>& mixings, DenseLightField& out) const {
    const auto images = tiles_->images_of(tile);
    std::optional<SubsetInterpolation> interpolated;
    ImageSet set;
    std::vector<uint32_t> positions;              // of the set in the tile's images
    std::vector<const TileViews::Texel*> texels;  // of the set
    for (uint32_t local = 0; local < atlas_->tile(tile).texels(); ++local) {
        set.clear();
        positions.clear();
        texels.clear();
        for (size_t i = 0; i < images.size(); ++i)
            if (const TileViews::Texel& texel = tiles_->of(tile, i)[local]; texel.seen) {
                set.push_back(images[i]);
                positions.push_back(uint32_t(i));
                texels.push_back(&texel);
            }
        if (set.empty()) continue;
        const auto row = Eigen::Index(first_row + local);
        out.seen[first_row + local] = 1;
        // Mostly one set for the whole ring, more along what hides a part of it.
        auto found = mixings.find(set);
        if (found == mixings.end()) {
            if (!interpolated) interpolated.emplace(interpolation(vertex, tile));
            found = mixings.emplace(set, interpolated->of(positions)).first;
        }
        for (size_t column = 0; column < view_centers_.size(); ++column) {
            const Triangulation::Weights& w = found->second[column];
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                for (size_t k = 0; k < 3; ++k) sum += w.weight[k] * texels[w.point[k]]->rgb[c];
                out.channel[c](row, Eigen::Index(column)) = sum;
            }
            out.invented(row, Eigen::Index(column)) = w.inside ? 0 : 1;
            out.counts.outside_hull += !w.inside;
        }
    }
}

void RingResampler::fill_unseen(std::span<const Corner> ring, std::span<const size_t> first_rows,
                                DenseLightField& out) const {
    std::vector<uint8_t> known = out.seen;
    const auto unseen = size_t(std::count(known.begin(), known.end(), 0));
    if (unseen == 0) return;
    out.counts.unseen_texels = unseen * view_texels_.size();
    Eigen::RowVectorXd mean[3];
    for (int c = 0; c < 3; ++c)  // unseen rows are still zero
        mean[c] = out.channel[c].colwise().sum() / double(known.size() - unseen);
    for (size_t i = 0; i < known.size(); ++i)
        if (!known[i]) out.invented.row(Eigen::Index(i)).setOnes();
    for (size_t r = 0; r < ring.size(); ++r) {
        uint8_t *tile = known.data() + first_rows[r], *end = known.data() + first_rows[r + 1];
        if (std::find(tile, end, 1) != end)
            grow_tile(MapNeighbours::triangle(atlas_->side(ring[r].triangle)), first_rows[r], tile, out);
        else
            for (size_t row = first_rows[r]; row < first_rows[r + 1]; ++row)
                for (int c = 0; c < 3; ++c) out.channel[c].row(Eigen::Index(row)) = mean[c];
    }
}

/// Unseen texels beside known ones take their mean; then those beside these, until all are known.
void RingResampler::grow_tile(const MapNeighbours& neighbours, size_t first_row, uint8_t* known,
                              DenseLightField& out) const {
    std::vector<uint32_t> grown;
    do {
        grown.clear();
        for (uint32_t local = 0; local < neighbours.texel_count(); ++local) {
            if (known[local]) continue;
            int count = 0;
            for (uint32_t other : neighbours.of(local)) count += known[other];
            if (count == 0) continue;
            for (Eigen::MatrixXd& m : out.channel) {
                auto row = m.row(Eigen::Index(first_row + local));
                for (uint32_t other : neighbours.of(local))
                    if (known[other]) row += m.row(Eigen::Index(first_row + other)) / count;
            }
            grown.push_back(local);
        }
        for (uint32_t local : grown) known[local] = 1;
    } while (!grown.empty());
}

std::vector<uint32_t> reachable_view_texels(int view_side) {
    const double m = view_side;
    const auto gap = [&](int j) {  // from the disc's middle to the nearest coordinate with a weight on column j
        const double low = j == 0 ? 0 : (j - 0.5) / m, high = j == view_side - 1 ? 1 : (j + 1.5) / m;
        return std::max({0.0, low - 0.5, 0.5 - high});
    };
    std::vector<uint32_t> texels;
    for (int y = 0; y < view_side; ++y)
        for (int x = 0; x < view_side; ++x)
            if (std::hypot(gap(x), gap(y)) < 0.5) texels.push_back(uint32_t(y * view_side + x));
    return texels;
}

}  // namespace radiafit::fits
