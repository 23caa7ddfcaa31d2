#pragma once
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "base/parallel.h"
#include "lamps/sphere_lamps.h"
#include "lamps/surface_samples.h"

namespace radiafit::testing {
using namespace tools;

/// A matt relief with two chrome spheres on it, as a camera sees it under near lamps of different strengths.
struct LampDome {
    int width = 960, height = 720;
    double pixel = 1.0 / 960;
    std::vector<Circle> spheres = {{{140.3, 585.6}, 80.4, 0}, {{809.8, 132.1}, 73.7, 0}};
    std::vector<Light> lamps;       ///< of intensity 1
    std::vector<double> strengths;  ///< irradiance at the origin; geometric mean 1
    double lamp_radius = 0.05, noise = 0.01;
    std::optional<Vec3d> eye = {};  ///< where the camera is; none: far away

    uint32_t seed;

    explicit LampDome(int count = 24, uint32_t seed_of_all = 1, double distance = 1.3) : seed(seed_of_all) {
        std::mt19937 random(seed);
        const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
        double mean = 0;
        for (int i = 0; i < count; ++i) {
            const double z = uniform(0.35, 0.95), around = uniform(0, 6.2831853), r = std::sqrt(1 - z * z);
            lamps.push_back({Light::Kind::near,
                             uniform(0.9, 1.1) * distance * Vec3d(r * std::cos(around), r * std::sin(around), z),
                             Vec3d::Ones()});
            strengths.push_back(std::exp(uniform(-0.35, 0.35)));
            mean += std::log(strengths.back()) / count;
        }
        for (double& s : strengths) s /= std::exp(mean);
    }

    PictureFrame frame() const { return {width, height, pixel, eye}; }
    Vec3d normal(const Vec3d& x) const {
        const double dx = 0.35 * std::sin(21 * x.x() + 3 * std::sin(9 * x.y())),
                     dy = 0.3 * std::sin(17 * x.y() + 5 * x.x());
        return Vec3d(-dx, -dy, 1).normalized();
    }
    double albedo(const Vec3d& x) const {
        return 0.35 + 0.2 * std::sin(40 * x.x()) * std::cos(31 * x.y()) + 0.1 * std::sin(140 * x.x() + 90 * x.y());
    }
    double plane(const Vec3d& x, size_t lamp) const {
        const Vec3d to = lamps[lamp].place - x;
        const double irradiance = strengths[lamp] * lamps[lamp].place.squaredNorm() / to.squaredNorm();
        return albedo(x) * irradiance * std::max(0.0, normal(x).dot(to.normalized()));
    }
    /// What is seen in one direction of the camera's.
    double seen(const Vec2d& place, size_t lamp, const std::vector<GlossySphere>& glossy) const {
        const Vec3d x = frame().plane_point(place), up = frame().direction_to_camera(x);
        for (const GlossySphere& sphere : glossy) {
            const Vec3d off = x - sphere.centre;
            const double nearest = -off.dot(up),
                         inside = sphere.radius * sphere.radius - (off + nearest * up).squaredNorm();
            if (inside <= 0) continue;
            const Vec3d from = x + (nearest + std::sqrt(inside)) * up, n = (from - sphere.centre) / sphere.radius;
            const Vec3d mirrored = 2 * n.dot(up) * n - up, to = lamps[lamp].place - from;
            if (mirrored.cross(to.normalized()).norm() < lamp_radius / to.norm() && mirrored.dot(to) > 0) return 30;
            if (mirrored.z() >= 0) return 0.01;
            const Vec3d met = from - from.z() / mirrored.z() * mirrored;
            return met.norm() < 1 ? 0.6 * plane(met, lamp) : 0.01;
        }
        return plane(x, lamp);
    }
    bool near_sphere(int x, int y) const {
        return std::ranges::any_of(
            spheres, [&](const Circle& c) { return (Vec2d(x + 0.5, y + 0.5) - c.centre).norm() < c.radius + 4; });
    }
    /// [height][width], through a lens that blurs a little, up to 1.
    LuminanceImage image(size_t lamp) const {
        LuminanceImage sharp{width, height, std::vector<float>(size_t(width) * size_t(height))}, out = sharp;
        std::vector<GlossySphere> glossy;
        for (const Circle& outline : spheres) glossy.push_back(sphere_of(outline, frame()));
        for (size_t y = 0; y < size_t(height); ++y)
            for (int x = 0; x < width; ++x) {
                const int n = near_sphere(x, int(y)) ? 4 : 1;
                double sum = 0;
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i)
                        sum += seen({x + (i + 0.5) / n, double(y) + (j + 0.5) / n}, lamp, glossy);
                sharp.values[y * size_t(width) + size_t(x)] = float(sum / (n * n));
            }
        std::mt19937 random{1000 * seed + uint32_t(lamp)};
        std::normal_distribution<double> normal;
        double lens[5], whole = 0;
        for (int i = 0; i < 5; ++i) whole += lens[i] = std::exp(-0.5 * (i - 2) * (i - 2) / (0.7 * 0.7));
        LuminanceImage across = sharp;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                double sum = 0;
                for (int i = 0; i < 5; ++i)
                    sum += lens[i] / whole * double(sharp.at(std::clamp(x + i - 2, 0, width - 1), y));
                across.values[size_t(y) * size_t(width) + size_t(x)] = float(sum);
            }
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                double sum = noise * normal(random);
                for (int j = 0; j < 5; ++j)
                    sum += lens[j] / whole * double(across.at(x, std::clamp(y + j - 2, 0, height - 1)));
                out.values[size_t(y) * size_t(width) + size_t(x)] = float(std::clamp(sum, 0.0, 1.0));
            }
        return out;
    }
    std::vector<LuminanceImage> images() const {
        std::vector<LuminanceImage> out(lamps.size());
        parallel_for(lamps.size(), 1, [&](size_t i, int) { out[i] = image(i); });
        return out;
    }
};

/// Of these images, a pixel of every `step` in either direction, off the spheres.
inline SurfaceSamples samples_of(const LampDome& dome, const std::vector<LuminanceImage>& images,
                                 const std::vector<uint32_t>& which, int step = 10) {
    SurfaceSamples out;
    out.images = which.size();
    for (int y = step / 2; y < dome.height; y += step)
        for (int x = step / 2; x < dome.width; x += step) {
            const Vec2d place(x + 0.5, y + 0.5);
            if (std::ranges::any_of(dome.spheres,
                                    [&](const Circle& c) { return (place - c.centre).norm() < 1.5 * c.radius; }))
                continue;
            out.positions.push_back(dome.frame().plane_point(place));
            out.patches.push_back(uint32_t((y / 64) * 1000 + x / 64));
            for (const uint32_t i : which)
                for (int c = 0; c < 3; ++c) out.values.push_back(images[i].at(x, y) < 0.99f ? images[i].at(x, y) : NAN);
        }
    return out;
}

}  // namespace radiafit::testing
