#include "samples/raster_distributor.h"

#include <algorithm>

#include "geometry/mesh_part.h"

namespace radiafit {

namespace {

/// Tiles are padded to whole 512-bit registers of floats.
constexpr size_t lanes = 16;

/// atlas.position() and Camera::project() for all texels of a tile at once, with the very same operations: the pixel
/// (row * width + column) of each centre, or `outside`.
void project_tile(const std::array<Vec3f, 3>& corners, const std::array<std::vector<float>, 3>& weights,
                  const Camera& camera, uint32_t outside, std::vector<uint32_t>& pixels) {
    // Plain scalars and arrays: the compiler turns no loop over Eigen's into vector code.
    const float *w0 = weights[0].data(), *w1 = weights[1].data(), *w2 = weights[2].data();
    const float x0 = corners[0].x(), y0 = corners[0].y(), z0 = corners[0].z();
    const float x1 = corners[1].x(), y1 = corners[1].y(), z1 = corners[1].z();
    const float x2 = corners[2].x(), y2 = corners[2].y(), z2 = corners[2].z();
    const Mat3d& r = camera.cam_from_world_rotation;
    const Vec3d& t = camera.cam_from_world_translation;
    const double rxx = r(0, 0), rxy = r(0, 1), rxz = r(0, 2), tx = t.x();
    const double ryx = r(1, 0), ryy = r(1, 1), ryz = r(1, 2), ty = t.y();
    const double rzx = r(2, 0), rzy = r(2, 1), rzz = r(2, 2), tz = t.z();
    const double fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
    const int width = camera.width;
    const double right = camera.width, bottom = camera.height;
    uint32_t* out = pixels.data();
    const size_t count = weights[0].size() / lanes * lanes;
    for (size_t k = 0; k < count; ++k) {
        const double x = w0[k] * x0 + w1[k] * x1 + w2[k] * x2;
        const double y = w0[k] * y0 + w1[k] * y1 + w2[k] * y2;
        const double z = w0[k] * z0 + w1[k] * z1 + w2[k] * z2;
        const double depth = rzx * x + rzy * y + rzz * z + tz;
        const double px = fx * (rxx * x + rxy * y + rxz * z + tx) / depth + cx;
        const double py = fy * (ryx * x + ryy * y + ryz * z + ty) / depth + cy;
        const bool inside = (px >= 0) & (px < right) & (py >= 0) & (py < bottom);
        // Not below zero, so truncation is floor.
        const int column = static_cast<int>(inside ? px : 0.0), row = static_cast<int>(inside ? py : 0.0);
        out[k] = inside ? static_cast<uint32_t>(row * width + column) : outside;
    }
}

}  // namespace

RasterDistributor::RasterDistributor(const TriangleAtlas& atlas)
    : atlas_(&atlas),
      weights_(size_t(atlas.side()) + 1),
      tile_pixels_((atlas.texels_per_tile() + lanes - 1) / lanes * lanes) {
    for (uint32_t triangle = 0; triangle < atlas.tile_count(); ++triangle) {
        const TriangleTile& tile = atlas.tile(triangle);
        auto& weights = weights_[size_t(tile.side())];
        if (!weights[0].empty()) continue;
        for (size_t c = 0; c < 3; ++c) {
            weights[c].assign((tile.texels() + lanes - 1) / lanes * lanes, 1.0f / 3);
            for (uint32_t local = 0; local < tile.texels(); ++local) weights[c][local] = tile.barycentric(local)[c];
        }
    }
}

/// The item buffer; pixels outside the mask hold no item.
void RasterDistributor::fill_items(const TargetImage& image, Distribution& out) {
    const uint32_t texels = atlas_->texels_per_tile();
    const std::vector<RasterPixel>& pixels = rasterizer_.pixels();
    items_.resize(pixels.size() + 1);
    items_.back() = no_texel;
    tile_visible_.assign(atlas_->tile_count(), 0);
    uint32_t covered = 0;
    const Mesh& mesh = atlas_->mesh();
    const auto fill_by = [&](const auto* rgba, const auto& triangle_of, const auto& side_of) {
        uint32_t* items = items_.data();
        for (size_t k = 0; k < pixels.size(); ++k) {
            const RasterPixel& p = pixels[k];
            const uint32_t triangle = triangle_of(p.triangle);
            const uint32_t item = triangle * texels + TriangleTile::local_at(side_of(triangle), p.b1, p.b2);
            const bool holds = (triangle != no_triangle) & (rgba[4 * k + 3] != 0);
            items[k] = holds ? item : no_texel;
            covered += holds;
        }
    };
    const auto fill_of = [&](const auto* rgba, const auto& side_of) {
        if (mesh.surroundings)
            fill_by(
                rgba, [&](uint32_t visible) { return fitted_triangle(mesh, visible); }, side_of);
        else
            fill_by(
                rgba, [](uint32_t visible) { return visible; }, side_of);
    };
    const auto fill = [&](const auto* rgba) {
        if (atlas_->one_side())
            fill_of(rgba, [side = atlas_->side()](uint32_t) { return side; });
        else
            fill_of(rgba, [&](uint32_t t) { return t == no_triangle ? least_side : atlas_->side(t); });
    };
    image.bits == 8 ? fill(image.rgba8.data()) : fill(image.rgba16.data());
    for (size_t k = 0; k < pixels.size(); ++k)
        if (items_[k] != no_texel) tile_visible_[fitted_triangle(mesh, pixels[k].triangle)] = 1;
    out.covered_pixels = covered;
}

void RasterDistributor::distribute(const Camera& camera, const TargetImage& image, Distribution& out) {
    const Mesh& mesh = atlas_->mesh();
    const uint32_t texels = atlas_->texels_per_tile();
    rasterizer_.draw(visible_mesh(mesh), camera);
    fill_items(image, out);

    const uint32_t outside = static_cast<uint32_t>(items_.size() - 1);
    out.texel_pixel.resize(atlas_->texel_count());
    uint32_t kept = 0;
    for (uint32_t tile = 0; tile < atlas_->tile_count(); ++tile) {
        uint32_t* taken = out.texel_pixel.data() + size_t(tile) * texels;
        if (!tile_visible_[tile]) {
            std::fill_n(taken, texels, no_pixel);
            continue;
        }
        // A visible tile lies in front of the camera as a whole.
        const auto& [i0, i1, i2] = mesh.triangles[tile];
        const int side = atlas_->side(tile);
        const uint32_t used = TriangleTile::texels_of(side);
        project_tile({mesh.positions[i0], mesh.positions[i1], mesh.positions[i2]}, weights_[size_t(side)], camera,
                     outside, tile_pixels_);
        std::fill(taken + used, taken + texels, no_pixel);
        for (uint32_t local = 0; local < used; ++local) {
            const uint32_t pixel = tile_pixels_[local];
            const bool keeps = items_[pixel] == tile * texels + local;
            taken[local] = keeps ? pixel : no_pixel;
            kept += keeps;
        }
    }
    out.kept_pixels = kept;
}

std::vector<std::unique_ptr<Distributor>> raster_distributors(const TriangleAtlas& atlas, int count) {
    std::vector<std::unique_ptr<Distributor>> out;
    for (int i = 0; i < count; ++i) out.push_back(std::make_unique<RasterDistributor>(atlas));
    return out;
}

std::vector<Distributor*> worker_pointers(const std::vector<std::unique_ptr<Distributor>>& distributors) {
    std::vector<Distributor*> out;
    for (const auto& d : distributors) out.push_back(d.get());
    return out;
}

}  // namespace radiafit
