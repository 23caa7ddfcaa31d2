#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace radiafit {

inline constexpr uint32_t no_texel = 0xffffffffu;

/// Surface location space (SLS): a texel for every surface location a model is fitted at, and where it stands in a
/// 2-D texture. Two kinds behind one face: triangle tiles and a grid.
/// Texel index = tile * texels_per_tile() + local; a grid is one tile.
class Atlas {
public:
    virtual ~Atlas() = default;

    uint32_t tile_count() const { return tile_count_; }
    uint32_t texels_per_tile() const { return texels_per_tile_; }
    uint32_t texel_count() const { return tile_count_ * texels_per_tile_; }
    int width() const { return width_; }  ///< of the 2-D layout, texels
    int height() const { return height_; }

    /// Column and row of a texel in the 2-D layout. No two texels share a place; places without a texel are padding.
    virtual std::array<int, 2> place(uint32_t texel) const = 0;
    virtual Vec3f position(uint32_t texel) const = 0;  ///< world space, the texel's centre
    virtual Vec3f normal(uint32_t texel) const = 0;    ///< unit, world space
    /// False for texels of degenerate triangles, or of a grid's masked pixels: they never take a sample.
    virtual bool usable(uint32_t texel) const = 0;

protected:
    uint32_t tile_count_ = 0, texels_per_tile_ = 0;
    int width_ = 0, height_ = 0;
};

/// One triangular tile of side n per triangle: cells floor(b1 n), floor(b2 n), i + j < n, so n(n+1)/2 texels.
/// Two triangles share one n x (n+1) rectangle (even triangle upright at (i, j), odd one turned at (n-1-i, n-j)).
class TriangleAtlas final : public Atlas {
public:
    /// The mesh must outlive the atlas. Throws UserError for side outside [2, 64] or a layout wider than 16384.
    TriangleAtlas(const Mesh& mesh, int side);

    int side() const { return side_; }
    int rectangles_per_row() const { return rectangles_per_row_; }
    /// The tile-local texel that holds barycentric (b1, b2); rounding at the rim is clamped into the tile.
    uint32_t local_at(float b1, float b2) const {
        int i = std::clamp(static_cast<int>(b1 * float(side_)), 0, side_ - 1);
        int j = std::clamp(static_cast<int>(b2 * float(side_)), 0, side_ - 1);
        // Beyond the diagonal by rounding only: step back along the longer coordinate.
        const int beyond = std::max(0, i + j - (side_ - 1));
        const bool along_i = i > j;
        i -= along_i ? beyond : 0;
        j -= along_i ? 0 : beyond;
        return local_of_cell(i, j);
    }
    /// Barycentric weights of the three vertices at a tile-local texel's centre. A diagonal cell's own centroid.
    std::array<float, 3> barycentric(uint32_t local) const { return barycentric_[local]; }
    /// Cell (i, j) of a tile-local texel. Local order: row by row, j outer, i inner.
    std::array<int, 2> cell(uint32_t local) const { return cell_[local]; }
    uint32_t local_of_cell(int i, int j) const { return static_cast<uint32_t>(j * side_ - j * (j - 1) / 2 + i); }

    std::array<int, 2> place(uint32_t texel) const override;
    Vec3f position(uint32_t texel) const override {
        return position(texel / texels_per_tile_, texel % texels_per_tile_);
    }
    Vec3f position(uint32_t triangle, uint32_t local) const {
        const auto& [i0, i1, i2] = mesh_->triangles[triangle];
        const auto& b = barycentric_[local];
        return b[0] * mesh_->positions[i0] + b[1] * mesh_->positions[i1] + b[2] * mesh_->positions[i2];
    }
    Vec3f normal(uint32_t texel) const override;  ///< interpolated vertex normals, unless set_normals() gave others
    /// Unit normals [texel_count()] finer than the mesh's. Throws UserError for another number of them.
    void set_normals(std::vector<Vec3f> normals);
    bool usable(uint32_t texel) const override { return !degenerate_[texel / texels_per_tile_]; }
    bool degenerate(uint32_t triangle) const { return degenerate_[triangle] != 0; }
    const Mesh& mesh() const { return *mesh_; }

private:
    const Mesh* mesh_;
    int side_, rectangles_per_row_;
    std::vector<std::array<float, 3>> barycentric_;
    std::vector<std::array<int, 2>> cell_;
    std::vector<uint8_t> degenerate_;
    std::vector<Vec3f> normals_;        ///< [V]
    std::vector<Vec3f> texel_normals_;  ///< [texel_count()] or empty
};

/// One texel per pixel of a fixed camera, or of a flat sample: texel = row * width + column, the identity layout and
/// distribution. Positions, unit normals and usability are given per texel.
class GridAtlas final : public Atlas {
public:
    /// positions, normals [width * height]; usable likewise, or empty for all. Throws UserError on a size that differs.
    GridAtlas(int width, int height, std::vector<Vec3f> positions, std::vector<Vec3f> normals,
              std::vector<uint8_t> usable);
    std::array<int, 2> place(uint32_t texel) const override {
        return {static_cast<int>(texel) % width_, static_cast<int>(texel) / width_};
    }
    Vec3f position(uint32_t texel) const override { return positions_[texel]; }
    Vec3f normal(uint32_t texel) const override { return normals_[texel]; }
    bool usable(uint32_t texel) const override { return usable_.empty() || usable_[texel] != 0; }

private:
    std::vector<Vec3f> positions_, normals_;
    std::vector<uint8_t> usable_;
};

}  // namespace radiafit
