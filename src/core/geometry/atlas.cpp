#include "geometry/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace radiafit {

namespace {
// The widest texture every OpenGL 4.5 implementation offers.
constexpr int largest_layout = 16384;
}  // namespace

TriangleAtlas::TriangleAtlas(const Mesh& mesh, int side, TileSides sides)
    : mesh_(&mesh), side_(side), sides_(std::move(sides)), tile_(&TriangleTile::of_side(side)) {
    if (sides_ && sides_->size() != mesh.triangle_count())
        throw UserError(
            fmt::format("sides of {} surface maps were given for {} triangles", sides_->size(), mesh.triangle_count()));
    for (size_t t = 0; sides_ && t < sides_->size(); ++t)
        if ((*sides_)[t] < least_side || (*sides_)[t] > side)
            throw UserError(fmt::format("triangle {}'s surface map has side {}, which is outside [{}, {}]", t,
                                        (*sides_)[t], least_side, side));
    const size_t rectangles = (mesh.triangle_count() + 1) / 2;
    // Nearly square: r * side columns against rectangles / r * (side + 1) rows.
    const double per_row = std::ceil(std::sqrt(double(rectangles) * (side + 1) / side));
    rectangles_per_row_ = std::max(1, static_cast<int>(per_row));
    const size_t rows = (rectangles + rectangles_per_row_ - 1) / rectangles_per_row_;
    const size_t width = size_t(rectangles_per_row_) * side, height = rows * (side + 1);
    if (width > largest_layout || height > largest_layout)
        throw UserError(
            fmt::format("{} triangles at surface side {} need a layout of {} x {} texels, but {} is the most; "
                        "choose a smaller side or a coarser mesh",
                        mesh.triangle_count(), side, width, height, largest_layout));
    width_ = static_cast<int>(width);
    height_ = static_cast<int>(height);
    tile_count_ = static_cast<uint32_t>(mesh.triangle_count());
    texels_per_tile_ = tile_->texels();
    for (uint32_t t = 0; t < tile_count_; ++t) used_texels_ += TriangleTile::texels_of(this->side(t));
    degenerate_.resize(tile_count_);
    for (uint32_t t = 0; t < tile_count_; ++t) degenerate_[t] = is_degenerate(mesh, t);
    normals_ = vertex_normals(mesh);
}

std::array<int, 2> TriangleAtlas::place(uint32_t texel) const {
    const uint32_t tile = texel / texels_per_tile_;
    const auto [i, j] = this->tile(tile).cell(texel % texels_per_tile_);
    const uint32_t rectangle = tile / 2;
    const int x0 = static_cast<int>(rectangle % rectangles_per_row_) * side_;
    const int y0 = static_cast<int>(rectangle / rectangles_per_row_) * (side_ + 1);
    if (tile % 2 == 0) return {x0 + i, y0 + j};
    return {x0 + side_ - 1 - i, y0 + side_ - j};
}

void TriangleAtlas::set_normals(std::vector<Vec3f> normals) {
    if (normals.size() != texel_count())
        throw UserError(fmt::format("{} normals were given for an atlas of {} texels", normals.size(), texel_count()));
    texel_normals_ = std::move(normals);
}

Vec3f TriangleAtlas::normal(uint32_t texel) const {
    if (!texel_normals_.empty()) return texel_normals_[texel];
    const uint32_t triangle = texel / texels_per_tile_;
    const auto& [i0, i1, i2] = mesh_->triangles[triangle];
    const auto& b = tile(triangle).barycentric(texel % texels_per_tile_);
    const Vec3f n = b[0] * normals_[i0] + b[1] * normals_[i1] + b[2] * normals_[i2];
    const float length = n.norm();
    return length > 0 ? Vec3f(n / length) : Vec3f(Vec3f::UnitZ());  // opposite normals may cancel
}

GridAtlas::GridAtlas(int width, int height, std::vector<Vec3f> positions, std::vector<Vec3f> normals,
                     std::vector<uint8_t> usable)
    : positions_(std::move(positions)), normals_(std::move(normals)), usable_(std::move(usable)) {
    if (width < 1 || height < 1 || width > largest_layout || height > largest_layout)
        throw UserError(fmt::format("a grid of {} x {} texels is out of range; choose sides in [1, {}]", width, height,
                                    largest_layout));
    const size_t texels = size_t(width) * height;
    if (positions_.size() != texels || normals_.size() != texels || (!usable_.empty() && usable_.size() != texels))
        throw UserError(fmt::format("a grid of {} x {} needs {} positions, normals and flags, but got {}, {} and {}",
                                    width, height, texels, positions_.size(), normals_.size(), usable_.size()));
    tile_count_ = 1;
    texels_per_tile_ = static_cast<uint32_t>(texels);
    width_ = width;
    height_ = height;
}

}  // namespace radiafit
