#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "lamps/light_stack.h"

namespace radiafit::testing {
using namespace tools;

/// A relief, of a height function, matt with a little gloss, with the shadows that it casts, as a far camera sees it
/// under near lamps of different strengths. The picture is 1 wide.
struct ReliefDome {
    int width = 72, height = 54;
    double noise = 0.01;  ///< of a white surface that faces a lamp of mean strength
    std::vector<Light> lamps;
    std::vector<double> strengths;

    explicit ReliefDome(uint32_t seed, int count = 24) : random_(seed) {
        const double distance = uniform(1.5, 4);
        for (int i = 0; i < count; ++i) {
            const double z = uniform(0.35, 0.95), around = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
            const Vec3d place = distance * uniform(0.95, 1.05) * Vec3d(r * std::cos(around), r * std::sin(around), z);
            lamps.push_back({Light::Kind::near, place, Vec3d::Ones()});
            strengths.push_back(std::exp(uniform(-0.35, 0.35)));
        }
        double slopes = 0;
        for (int i = 0; i < 14; ++i) {
            Wave w = wave(0.09, 0.5);
            w.size = w.along.norm() > 40 ? 1 / w.along.norm() : 0.02;
            slopes += 0.25 * w.size * w.size * w.along.squaredNorm();
            waves_.push_back(w);
        }
        const double steepness = uniform(0.2, 0.4);  // root mean square of either slope
        for (Wave& w : waves_) w.size *= steepness / std::sqrt(slopes);
        for (int i = 0; i < 6; ++i) paint_.push_back(wave(0.05, 1));
        gloss_ = uniform(0, 0.3);
        shape();
    }

    /// With what a light file says of the lamps.
    LightStack stack(std::vector<Light> said) {
        LightStack out{.width = width,
                       .height = height,
                       .pixel = 1.0 / width,
                       .names = {},
                       .lamps = std::move(said),
                       .values = {}};
        std::normal_distribution<double> normal;
        for (size_t i = 0; i < lamps.size(); ++i) out.names.push_back("image" + std::to_string(i + 1) + ".png");
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (size_t i = 0; i < lamps.size(); ++i)
                    out.values.push_back(float(std::max(0.0, seen(x, y, i) + noise * normal(random_))));
        return out;
    }
    double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); }
    std::mt19937& random() { return random_; }

private:
    struct Wave {
        Vec2d along;
        double phase, size;
    };
    Wave wave(double shortest, double longest) {
        const double length = shortest * std::pow(longest / shortest, uniform(0, 1)),
                     angle = uniform(0, 2 * std::numbers::pi);
        return {2 * std::numbers::pi / length * Vec2d(std::cos(angle), std::sin(angle)),
                uniform(0, 2 * std::numbers::pi), 1};
    }
    void shape() {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const Vec2d at((x + 0.5 - 0.5 * width) / width, (0.5 * height - y - 0.5) / width);
                double h = 0, paint = 0.5;
                Vec2d slope = Vec2d::Zero();
                for (const Wave& w : waves_) {
                    const double phase = w.along.dot(at) + w.phase;
                    h += w.size * std::sin(phase);
                    slope += w.size * std::cos(phase) * w.along;
                }
                for (const Wave& w : paint_) paint += 0.06 * std::sin(w.along.dot(at) + w.phase);
                heights_.push_back(h);
                normals_.push_back(Vec3d(-slope.x(), -slope.y(), 1).normalized());
                albedo_.push_back(paint);
            }
    }
    size_t index(int x, int y) const { return size_t(y) * size_t(width) + size_t(x); }
    double height_at(double x, double y) const {
        const int left = int(x), top = int(y);
        const double a = x - left, b = y - top;
        return (1 - b) * ((1 - a) * heights_[index(left, top)] + a * heights_[index(left + 1, top)]) +
               b * ((1 - a) * heights_[index(left, top + 1)] + a * heights_[index(left + 1, top + 1)]);
    }
    bool in_shadow(int x, int y, const Vec3d& to) const {
        const Vec2d across = Vec2d(to.x(), -to.y()).normalized();
        const double rise = to.z() / to.head<2>().norm() / width;  // per pixel
        for (double t = 1.5; t * rise < 0.3; ++t) {
            const double u = x + t * across.x(), v = y + t * across.y();
            if (u < 0 || v < 0 || u >= width - 1 || v >= height - 1) return false;
            if (height_at(u, v) > heights_[index(x, y)] + t * rise) return true;
        }
        return false;
    }
    double seen(int x, int y, size_t lamp) const {
        const size_t k = index(x, y);
        const Vec3d at((x + 0.5 - 0.5 * width) / width, (0.5 * height - y - 0.5) / width, heights_[k]);
        const Vec3d to = lamps[lamp].place - at, l = to.normalized();
        const double cosine = normals_[k].dot(l);
        if (cosine <= 0 || in_shadow(x, y, to)) return 0;
        const double irradiance = strengths[lamp] * lamps[lamp].place.squaredNorm() / to.squaredNorm();
        const double mirrored = std::max(0.0, normals_[k].dot(Vec3d(l + Vec3d::UnitZ()).normalized()));
        return irradiance * cosine * (albedo_[k] + gloss_ * std::pow(mirrored, 40));
    }

    std::mt19937 random_;
    std::vector<Wave> waves_, paint_;
    double gloss_;
    std::vector<double> heights_, albedo_;
    std::vector<Vec3d> normals_;
};

}  // namespace radiafit::testing
