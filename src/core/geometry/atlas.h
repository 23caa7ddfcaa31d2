#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/triangle_tile.h"

namespace radiafit {

inline constexpr uint32_t no_texel = 0xffffffffu;

/// Surface location space (SLS): a texel for every surface location a model is fitted at, and its place in a
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

/// Sides of triangles' tiles, each in [least_side, largest_side]; null where all have the same.
using TileSides = std::shared_ptr<const std::vector<uint8_t>>;

/// A triangular tile per triangle, of one side for all or of several. Two triangles share one rectangle of the largest
/// side, n x (n+1): the even triangle upright, cell (i, j) at (i, j); the odd one turned, at (n-1-i, n-j). A tile's
/// texels come first among the texels_per_tile() places of its triangle; the other places hold none, and aren't usable.
class TriangleAtlas final : public Atlas {
public:
    /// The mesh must outlive the atlas. sides, if not null: [triangles], none above `side`. Throws UserError for a side
    /// out of range, another number of sides than triangles, or a layout wider than 16384.
    TriangleAtlas(const Mesh& mesh, int side, TileSides sides = nullptr);

    int side() const { return side_; }  ///< the largest
    int side(uint32_t triangle) const { return sides_ ? (*sides_)[triangle] : side_; }
    bool one_side() const { return !sides_; }  ///< the same for all
    const TriangleTile& tile(uint32_t triangle) const {
        return sides_ ? TriangleTile::of_side(side(triangle)) : *tile_;
    }
    uint64_t used_texels() const { return used_texels_; }  ///< of all tiles, places without a texel left out
    int rectangles_per_row() const { return rectangles_per_row_; }
    uint32_t local_at(uint32_t triangle, float b1, float b2) const {
        return TriangleTile::local_at(side(triangle), b1, b2);
    }

    std::array<int, 2> place(uint32_t texel) const override;
    Vec3f position(uint32_t texel) const override {
        return position(texel / texels_per_tile_, texel % texels_per_tile_);
    }
    Vec3f position(uint32_t triangle, uint32_t local) const {
        const auto& [i0, i1, i2] = mesh_->triangles[triangle];
        const auto& b = tile(triangle).barycentric(local);
        return b[0] * mesh_->positions[i0] + b[1] * mesh_->positions[i1] + b[2] * mesh_->positions[i2];
    }
    Vec3f normal(uint32_t texel) const override;  ///< interpolated vertex normals, unless set_normals() gave others
    /// Unit normals [texel_count()] finer than the mesh's. Throws UserError for another number of them.
    void set_normals(std::vector<Vec3f> normals);
    bool usable(uint32_t texel) const override {
        const uint32_t triangle = texel / texels_per_tile_;
        return !degenerate_[triangle] && texel % texels_per_tile_ < TriangleTile::texels_of(side(triangle));
    }
    bool degenerate(uint32_t triangle) const { return degenerate_[triangle] != 0; }
    const Mesh& mesh() const { return *mesh_; }

private:
    const Mesh* mesh_;
    int side_, rectangles_per_row_;
    TileSides sides_;
    const TriangleTile* tile_;  ///< of the largest side
    uint64_t used_texels_ = 0;
    std::vector<uint8_t> degenerate_;
    std::vector<Vec3f> normals_;        ///< [V]
    std::vector<Vec3f> texel_normals_;  ///< [texel_count()] or empty
};

/// One texel per pixel of a fixed camera, or of a flat sample: texel = row * width + column, the identity layout and
/// distribution. Positions, unit normals and usability are given per texel.
class GridAtlas final : public Atlas {
public:
    /// positions, normals [width * height]; usable: the same size, or empty for all. Throws UserError on other sizes.
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
