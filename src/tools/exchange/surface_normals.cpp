#include "exchange/surface_normals.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "dataset/texel_shading.h"
#include "dataset/view_directions.h"
#include "eval/texel_pixels.h"
#include "model/photometric_stereo.h"

namespace radiafit::tools {
namespace {

constexpr size_t most_lamps = 64;
constexpr size_t texels_at_once = 32768;  // of which a thread holds what all lamps show

Mat3d plane_from_world(const Grid& grid) {
    Mat3d out;
    out << grid.right.normalized().transpose(), -grid.down.normalized().transpose(), grid.normal().transpose();
    return out;
}

std::vector<const View*> evenly(const Dataset& dataset, const std::vector<uint32_t>& training) {
    std::vector<const View*> out;
    const size_t count = std::min(most_lamps, training.size());
    for (size_t i = 0; i < count; ++i) out.push_back(&dataset.views[training[i * training.size() / count]]);
    return out;
}

/// Mean of the channels that the lamp has light in, over that light; not a number without any.
float reflected(const float* rgb, const Vec3f& irradiance) {
    float sum = 0;
    int lit = 0;
    for (int c = 0; c < 3; ++c)
        if (irradiance[c] > 0) sum += rgb[c] / irradiance[c], ++lit;
    return lit > 0 ? sum / float(lit) : std::numeric_limits<float>::quiet_NaN();
}

/// Rows: axes whose third is on the surface's outer side, so that normals have it above 0.
Mat3d frame_of(const TexelShading::Place& place) {
    Mat3d out;
    out << place.frame.tangent.cast<double>().transpose(), place.frame.bitangent.cast<double>().transpose(),
        place.frame.normal.cast<double>().transpose();
    return out;
}

}  // namespace

std::vector<Vec3f> SurfaceNormals::or_else(const SurfaceNormals& others) const {
    std::vector<Vec3f> out = normals;
    for (size_t t = 0; t < out.size(); ++t)
        if (out[t].isZero(0)) out[t] = others.normals[t];
    return out;
}

std::vector<Vec3f> in_world(std::vector<Vec3f> normals, const Dataset& dataset) {
    if (!dataset.has_grid()) return normals;
    const Eigen::Matrix3f turn = plane_from_world(dataset.grid).transpose().cast<float>();
    for (Vec3f& normal : normals) normal = turn * normal;
    return normals;
}

SurfaceNormals normals_of_dataset(const Atlas& atlas, const Dataset& dataset) {
    const Mat3d turn = dataset.has_grid() ? plane_from_world(dataset.grid) : Mat3d(Mat3d::Identity());
    SurfaceNormals out;
    out.normals.assign(atlas.texel_count(), Vec3f::Zero());
    for (uint32_t t = 0; t < atlas.texel_count(); ++t)
        if (atlas.usable(t)) out.normals[t] = (turn * atlas.normal(t).cast<double>()).cast<float>();
    return out;
}

bool has_own_normals(const Dataset& dataset) {
    const Vec3f plane = dataset.has_grid() ? Vec3f(dataset.grid.normal().cast<float>()) : Vec3f(Vec3f::Zero());
    return std::ranges::any_of(dataset.grid.texel_normals,
                               [&](const Vec3f& n) { return !n.isZero(0) && (n - plane).norm() > 1e-3f; });
}

std::optional<SurfaceNormals> normals_of_fit(const Contestant& contestant, const Atlas& atlas, const Dataset& dataset,
                                             const std::vector<uint32_t>& training) {
    const std::vector<const View*> views = evenly(dataset, training);
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    std::vector<Vec3d> from_centre;
    for (const View* view : views) from_centre.push_back(view->light->direction_from(centre));
    if (!lamps_give_normals(from_centre)) return std::nullopt;

    const bool flat = dataset.has_grid();
    const Mat3d plane = flat ? plane_from_world(dataset.grid) : Mat3d(Mat3d::Identity());
    const std::vector<RasterPixel> pixels = texel_pixels(atlas);
    SurfaceNormals out;
    out.normals.assign(pixels.size(), Vec3f::Zero());
    out.lamps = views.size();
    parallel_for((pixels.size() + texels_at_once - 1) / texels_at_once, 1, [&](size_t block, int worker) {
        const size_t first = block * texels_at_once, count = std::min(texels_at_once, pixels.size() - first);
        const std::vector<RasterPixel> some(pixels.begin() + ptrdiff_t(first),
                                            pixels.begin() + ptrdiff_t(first + count));
        std::vector<float> rgb, values(count * views.size());
        for (size_t l = 0; l < views.size(); ++l) {
            contestant.shade(*views[l], some, rgb, worker);
            for (size_t i = 0; i < count; ++i) {
                if (some[i].triangle == no_triangle) continue;
                const Vec3d position = atlas.position(uint32_t(first + i)).cast<double>();
                values[i * views.size() + l] =
                    reflected(&rgb[3 * i], views[l]->light->irradiance_at(position).cast<float>());
            }
        }
        std::vector<Vec3d> lamps(views.size());
        for (size_t i = 0; i < count; ++i) {
            if (some[i].triangle == no_triangle) continue;
            const TexelShading::Place place = TexelShading::place(atlas, uint32_t(first + i));
            const Mat3d frame = flat ? plane : frame_of(place);
            for (size_t l = 0; l < views.size(); ++l)
                lamps[l] = frame * views[l]->light->direction_from(place.position);
            const Vec3f normal = photometric_normal(lamps, std::span(values).subspan(i * views.size(), views.size()));
            out.normals[first + i] = flat ? normal : Vec3f((frame.transpose() * normal.cast<double>()).cast<float>());
        }
    });
    return out;
}

SurfaceNormals finest_normals(const Contestant& contestant, const Atlas& atlas, const Dataset& dataset,
                              const std::vector<uint32_t>& training) {
    SurfaceNormals own = normals_of_dataset(atlas, dataset);
    if (has_own_normals(dataset)) return own;
    auto found = normals_of_fit(contestant, atlas, dataset, training);
    if (!found) return own;
    return {found->or_else(own), found->lamps};
}

}  // namespace radiafit::tools
