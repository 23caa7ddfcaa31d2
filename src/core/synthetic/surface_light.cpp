#include "synthetic/surface_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "geometry/ray_cast.h"

namespace radiafit {
namespace {

constexpr double offset = 2e-3;  // of a shadow ray's start from the outer surface
constexpr int lamp_rays = 8, sky_rays = 40;
static_assert(sizeof(PointLight) == 11 * sizeof(float), "interpolated as eleven floats");
using Floats = Eigen::Array<float, 11, 1>;

/// Directions to points of each lamp's disc, by the sunflower arrangement.
std::array<std::array<Vec3d, lamp_rays>, lamp_count> disc_directions() {
    std::array<std::array<Vec3d, lamp_rays>, lamp_count> all;
    for (size_t l = 0; l < lamp_count; ++l) {
        const Vec3d axis = lamps()[l].direction.cast<double>(), u = axis.unitOrthogonal(), v = axis.cross(u);
        for (int k = 0; k < lamp_rays; ++k) {
            const double r = double(lamp_radius) * std::sqrt((k + 0.5) / lamp_rays), turn = 2.399963 * k;
            all[l][size_t(k)] = (axis + r * std::cos(turn) * u + r * std::sin(turn) * v).normalized();
        }
    }
    return all;
}

std::vector<Vec3d> sky_directions() {
    std::vector<Vec3d> all;
    for (int k = 0; k < sky_rays; ++k) {
        const double z = 1 - (2.0 * k + 1) / sky_rays, radius = std::sqrt(1 - z * z), turn = 2.399963 * k;
        all.emplace_back(radius * std::cos(turn), radius * std::sin(turn), z);
    }
    return all;
}

class Illuminator {
public:
    Illuminator(const Mesh& mesh, const Solid& solid)
        : solid_(solid), caster_(mesh), discs_(disc_directions()), sky_(sky_directions()) {}

    PointLight at(const Vec3d& x, const Vec3d& mesh_normal) const {
        PointLight light;
        // Shadow rays start a little outside mesh and solid: a coarse mesh's own facets must not throw shadows on it.
        // The normal has detail from the solid, but never strays far from the mesh, whose details may be coarser.
        const Vec3d start_on = solid_.project(x);
        const Vec3d normal = (solid_.gradient(start_on).normalized() + mesh_normal).normalized();
        const double outside = std::max(0.0, (start_on - x).dot(mesh_normal));
        const Vec3d start = x + (outside + offset) * mesh_normal;
        light.normal = normal.cast<float>();
        for (size_t l = 0; l < lamp_count; ++l) {
            int seen = 0;
            for (const Vec3d& d : discs_[l]) seen += d.dot(normal) > 0 && !caster_.occluded(start, d) ? 1 : 0;
            light.lamp_visible[l] = float(seen) / lamp_rays;
            const float cosine = std::max(0.0f, light.normal.dot(lamps()[l].direction));
            light.irradiance += light.lamp_visible[l] * cosine * lamps()[l].radiance;
        }
        double seen = 0, all = 0;
        for (const Vec3d& d : sky_) {
            const double cosine = d.dot(normal);
            if (cosine <= 0) continue;
            all += cosine;
            if (caster_.occluded(start, d)) continue;
            seen += cosine;
            light.irradiance += float(cosine * 4 / sky_rays) * sky(d.cast<float>());  // 4 / count: integral / pi
        }
        light.sky_visible = float(seen / all);
        return light;
    }

private:
    const Solid& solid_;
    RayCaster caster_;
    std::array<std::array<Vec3d, lamp_rays>, lamp_count> discs_;
    std::vector<Vec3d> sky_;
};

}  // namespace

SurfaceLight::SurfaceLight(const Mesh& mesh, const Solid& solid, int side)
    : side_(side), points_per_triangle_(size_t((side + 1) * (side + 2) / 2)) {
    points_.resize(mesh.triangle_count() * points_per_triangle_);
    const Illuminator illuminator(mesh, solid);
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    parallel_for(mesh.triangle_count(), 16, [&](size_t t, int) {
        std::array<Vec3d, 3> corner, normal;
        for (size_t k = 0; k < 3; ++k) {
            corner[k] = mesh.positions[mesh.triangles[t][k]].cast<double>();
            normal[k] = normals[mesh.triangles[t][k]].cast<double>();
        }
        for (int j = 0; j <= side; ++j)
            for (int i = 0; i + j <= side; ++i) {
                const double b1 = double(i) / side, b2 = double(j) / side;
                points_[t * points_per_triangle_ + lattice_index(i, j)] =
                    illuminator.at((1 - b1 - b2) * corner[0] + b1 * corner[1] + b2 * corner[2],
                                   ((1 - b1 - b2) * normal[0] + b1 * normal[1] + b2 * normal[2]).normalized());
            }
    });
}

PointLight SurfaceLight::at(uint32_t triangle, float b1, float b2) const {
    const PointLight* points = points_.data() + triangle * points_per_triangle_;
    const float u = b1 * float(side_), v = b2 * float(side_);
    const int j = std::clamp(int(v), 0, side_ - 1), i = std::clamp(int(u), 0, side_ - 1 - j);
    const float fu = u - float(i), fv = v - float(j);
    const auto floats = [&](int ii, int jj) {
        return Eigen::Map<const Floats>(points[lattice_index(ii, jj)].normal.data());
    };
    PointLight light;
    Eigen::Map<Floats> out(light.normal.data());
    // The lower or the upper half of the lattice cell.
    if (fu + fv <= 1 || i + j + 2 > side_)
        out = (1 - fu - fv) * floats(i, j) + fu * floats(i + 1, j) + fv * floats(i, j + 1);
    else
        out = (fu + fv - 1) * floats(i + 1, j + 1) + (1 - fv) * floats(i + 1, j) + (1 - fu) * floats(i, j + 1);
    return light;
}

}  // namespace radiafit
