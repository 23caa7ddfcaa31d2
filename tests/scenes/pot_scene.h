#pragma once
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/rng.h"
#include "capture_fixture.h"
#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/raster.h"
#include "stereo_scene.h"

/// A pot with a flared rim, a handle and a deep hollow, on a table: what makes meshes from photographs go astray. Its
/// surface is known in closed form, and all one piece; z is up, the table at 0 and round, the pot 1.25 high and 1.8
/// across with its handle.
namespace radiafit::testing {

class PotScene {
public:
    static constexpr double table_radius = 2, foot = 0.45, tube = 0.055, arc = 0.33, diagonal = 2.6;

    Mesh mesh() const {
        Mesh out;
        add_pot(out);
        add_handle(out);
        add_table(out);
        return out;
    }

    double distance_to_pot(const Vec3d& p) const {
        const double r = std::hypot(p.x(), p.y());
        double nearest = INFINITY;
        for (size_t i = 1; i < profile.size(); ++i)
            nearest = std::min(nearest, to_segment({r, p.z()}, profile[i - 1], profile[i]));
        return std::min(nearest, distance_to_handle(p));
    }
    double distance(const Vec3d& p) const {
        const double r = std::hypot(p.x(), p.y());
        return std::min(distance_to_pot(p), std::hypot(p.z(), r - std::clamp(r, foot, table_radius)));
    }

    /// Two rings: sixteen cameras from the side and eight from above, which see into the hollow.
    static std::vector<Camera> cameras(int width, int height) {
        std::vector<Camera> out;
        for (int i = 0; i < 24; ++i) {
            const bool high = i >= 16;
            const double around = 2 * pi * (high ? (i - 16 + 0.5) / 8 : i / 16.0), up = (high ? 58 : 24) * pi / 180;
            const Vec3d eye = Vec3d(0, 0, 0.55) +
                              5 * Vec3d(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
            out.push_back(Camera::look_at(eye, Vec3d(0, 0, 0.55), Vec3d::UnitZ(), 0.48, width, height));
        }
        return out;
    }

    /// Of a matt surface that is patterned all over, [camera.height][camera.width][3] bytes.
    static std::vector<uint16_t> photograph(const Mesh& mesh, const Camera& camera) {
        Rasterizer raster;
        raster.draw(mesh, camera);
        std::vector<uint16_t> pixels;
        uint64_t noise = uint64_t(1e6 * (10 + camera.center().x())) << 24;
        pixels.reserve(3 * raster.pixels().size());
        for (const RasterPixel& seen : raster.pixels()) {
            if (seen.triangle == no_triangle) {
                pixels.insert(pixels.end(), 3, 128);
                continue;
            }
            const auto& [a, b, c] = mesh.triangles[seen.triangle];
            const Vec3d p = ((1 - seen.b1 - seen.b2) * mesh.positions[a] + seen.b1 * mesh.positions[b] +
                             seen.b2 * mesh.positions[c])
                                .cast<double>();
            for (const double hue : {0.0, 50.0, 100.0}) {
                const Vec3d shifted = p + Vec3d::Constant(hue);
                const float value = 0.5f * texture_at(shifted) + 0.5f * texture_at(4 * shifted);
                const float grain = random_uniform(3, noise) + random_uniform(4, noise) - 1;  // deviation 0.4
                ++noise;
                pixels.push_back(uint16_t(std::clamp(128 + 90 * (value - 0.5f) + 12 * grain, 0.f, 255.f)));
            }
        }
        return pixels;
    }

    /// photos/N.png, and model/ in COLMAP's text form with points on the surface in the tracks of all that see them.
    static void write(const fs::path& folder, const Mesh& mesh, const std::vector<Camera>& cameras) {
        std::string lines_of_cameras, lines_of_images, lines_of_points;
        std::vector<Rasterizer> rasters(cameras.size());
        parallel_for(cameras.size(), 1, [&](size_t i, int) {
            const Camera& c = cameras[i];
            write_bytes(folder / fmt::format("photos/{:02}.png", i),
                        encode_png(c.width, c.height, 3, 8, photograph(mesh, c)));
            rasters[i].draw(mesh, c);
        });
        for (size_t i = 0; i < cameras.size(); ++i) {
            const Camera& c = cameras[i];
            const Eigen::Quaterniond q(c.cam_from_world_rotation);
            const Vec3d& t = c.cam_from_world_translation;
            lines_of_cameras +=
                fmt::format("{} PINHOLE {} {} {} {} {} {}\n", i + 1, c.width, c.height, c.fx, c.fy, c.cx, c.cy);
            lines_of_images += fmt::format("{} {} {} {} {} {} {} {} {} {:02}.png\n\n", i + 1, q.w(), q.x(), q.y(),
                                           q.z(), t.x(), t.y(), t.z(), i + 1, i);
        }
        Rng rng(11);
        for (int k = 0; k < 3000; ++k) {
            const auto& t = mesh.triangles[rng.index(uint32_t(mesh.triangle_count()))];
            const Vec3d p = ((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3).cast<double>();
            std::string track;
            for (size_t i = 0; i < cameras.size(); ++i)
                if (sees(rasters[i], cameras[i], p)) track += fmt::format(" {} {}", i + 1, k);
            if (!track.empty())
                lines_of_points += fmt::format("{} {} {} {} 0 0 0 0.5{}\n", k, p.x(), p.y(), p.z(), track);
        }
        write_bytes(folder / "model/cameras.txt", lines_of_cameras);
        write_bytes(folder / "model/images.txt", lines_of_images);
        write_bytes(folder / "model/points3D.txt", lines_of_points);
    }

    static bool sees(const Rasterizer& raster, const Camera& camera, const Vec3d& p) {
        const Vec3d at = camera.project(p);
        if (!(at.z() > 0 && at.x() >= 0 && at.y() >= 0 && at.x() < camera.width && at.y() < camera.height))
            return false;
        const size_t pixel = size_t(at.y()) * size_t(camera.width) + size_t(at.x());
        return at.z() * double(raster.inverse_depth()[pixel]) < 1.005;
    }

    /// A triangle from an edge at `vertex` to the nearest of the first `count` vertices.
    static void join(Mesh& mesh, size_t vertex, size_t count) {
        uint32_t nearest = 0;
        for (uint32_t v = 1; v < count; ++v)
            if ((mesh.positions[v] - mesh.positions[vertex]).norm() <
                (mesh.positions[nearest] - mesh.positions[vertex]).norm())
                nearest = v;
        mesh.triangles.push_back({uint32_t(vertex), uint32_t(vertex + 1), nearest});
    }

private:
    using Vec2d = std::array<double, 2>;
    static constexpr int around = 120;  // vertices of a ring
    static constexpr double pi = 3.14159265358979;
    /// Radius and height, from the foot up the outside, over the rim and down the hollow.
    static constexpr std::array<Vec2d, 19> profile = {{{0.45, 0},
                                                       {0.62, 0.2},
                                                       {0.74, 0.45},
                                                       {0.74, 0.65},
                                                       {0.62, 0.88},
                                                       {0.5, 1.02},
                                                       {0.55, 1.12},
                                                       {0.7, 1.2},
                                                       {0.71, 1.23},
                                                       {0.69, 1.25},
                                                       {0.65, 1.24},
                                                       {0.52, 1.16},
                                                       {0.45, 1.03},
                                                       {0.56, 0.88},
                                                       {0.67, 0.65},
                                                       {0.67, 0.45},
                                                       {0.56, 0.22},
                                                       {0.35, 0.08},
                                                       {0, 0.06}}};
    static constexpr double middle_r = 0.72, middle_z = 0.8, arc_from = -95 * pi / 180,
                            arc_to = 115 * pi / 180;  // of the handle's arc

    static double to_segment(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
        const double dx = b[0] - a[0], dy = b[1] - a[1];
        const double t = std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        return std::hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy);
    }
    static double distance_to_handle(const Vec3d& p) {
        const double x = p.x() - middle_r, z = p.z() - middle_z, angle = std::clamp(std::atan2(z, x), arc_from, arc_to);
        const double across = std::hypot(x - arc * std::cos(angle), z - arc * std::sin(angle));
        return std::abs(std::hypot(across, p.y()) - tube);
    }

    /// A lattice of rows and columns; the columns close where `round`. Faces are to the left of a column's way up.
    template <class Place>
    static void add_lattice(Mesh& mesh, int rows, int columns, bool round, const Place& place) {
        const auto first = uint32_t(mesh.vertex_count());
        const int across = round ? columns : columns + 1;
        for (int i = 0; i <= rows; ++i)
            for (int j = 0; j < across; ++j) mesh.positions.push_back(Vec3d(place(i, j)).template cast<float>());
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) {
                const auto at = [&](int row, int column) { return first + uint32_t(row * across + column % across); };
                mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
                mesh.triangles.push_back({at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)});
            }
    }
    static void add_pot(Mesh& mesh) {
        constexpr int steps = 6;
        add_lattice(mesh, int(profile.size() - 1) * steps, around, true, [&](int row, int column) {
            const auto segment = std::min(size_t(row / steps), profile.size() - 2);
            const double t = double(row) / steps - double(segment), angle = 2 * pi * column / around;
            const double r = (1 - t) * profile[segment][0] + t * profile[segment + 1][0];
            return Vec3d(r * std::cos(angle), r * std::sin(angle),
                         (1 - t) * profile[segment][1] + t * profile[segment + 1][1]);
        });
    }
    static void add_handle(Mesh& mesh) {
        constexpr int steps = 60, sides = 24;
        const size_t first = mesh.vertex_count();
        add_lattice(mesh, steps, sides, true, [&](int row, int column) {
            const double a = arc_from + (arc_to - arc_from) * row / steps, b = 2 * pi * column / sides;
            const double out = arc + tube * std::cos(b);
            return Vec3d(middle_r + out * std::cos(a), tube * std::sin(b), middle_z + out * std::sin(a));
        });
        // Its ends are within the wall, where a triangle each joins them to it.
        for (const size_t end : {first, first + size_t(steps) * sides}) join(mesh, end, first);
    }
    /// From the pot's foot on, whose vertices it shares.
    static void add_table(Mesh& mesh) {
        constexpr int steps = 40;
        const auto first = uint32_t(mesh.vertex_count());
        for (int i = 1; i <= steps; ++i)
            for (int j = 0; j < around; ++j) {
                const double r = foot + (table_radius - foot) * i / steps, angle = 2 * pi * j / around;
                mesh.positions.push_back(Vec3d(r * std::cos(angle), r * std::sin(angle), 0).cast<float>());
            }
        const auto at = [&](int row, int column) {
            return (row == 0 ? 0 : first + uint32_t((row - 1) * around)) + uint32_t(column % around);
        };
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < around; ++j) {
                mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
                mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
            }
    }
};

}  // namespace radiafit::testing
