#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "synthetic/solid.h"

namespace radiafit {
namespace {

double around(Rng& rng, double value, double share) { return value * (1 + share * double(rng.uniform(-1, 1))); }

/// A uniformly random rotation (Shoemake 1992).
Mat3d random_rotation(Rng& rng) {
    const double u = rng.uniform(), a = 2 * std::numbers::pi * rng.uniform(), b = 2 * std::numbers::pi * rng.uniform();
    const double x = std::sqrt(1 - u) * std::sin(a), y = std::sqrt(1 - u) * std::cos(a);
    const double z = std::sqrt(u) * std::sin(b), w = std::sqrt(u) * std::cos(b);
    Mat3d r;
    r << 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),  //
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),   //
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y);
    return r;
}

}  // namespace

Solid star_solid(uint64_t seed) {
    Rng rng(seed, 1);
    Solid solid;
    solid.ellipsoid(Vec3d::Zero(), {0.65, 0.65, 0.65}, 0.1);
    const Mat3d turn = random_rotation(rng);
    const double golden = 0.5 * (1 + std::sqrt(5.0));
    for (int i = 0; i < 12; ++i) {  // the corners of an icosahedron
        Vec3d corner = Vec3d::Zero();
        corner[i % 3] = i / 3 % 2 == 0 ? 1 : -1;
        corner[(i + 1) % 3] = i / 6 % 2 == 0 ? golden : -golden;
        const Vec3d sway(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        const Vec3d direction = (turn * (corner.normalized() + 0.06 * sway)).normalized();
        const double tip = around(rng, 0.11, 0.12);
        solid.round_cone(0.40 * direction, 0.40, (around(rng, 0.95, 0.04) - tip) * direction, tip, 0.24);
        solid.tip(direction);
    }
    return solid;
}

Solid bust_solid(uint64_t seed, double detail) {
    Rng rng(seed, 1);
    const double wide = around(rng, 1, 0.04), long_nose = around(rng, 1, 0.1), bun = around(rng, 1, 0.1);
    Solid solid;
    solid.ellipsoid({0, 0.09, -0.48}, {0.46 * wide, 0.36, 0.44}, 0.1);  // chest
    for (const double side : {-1.0, 1.0}) {
        const Vec3d shoulder(side * 0.50 * wide, 0.11, -0.29);
        solid.round_cone({side * 0.08, 0.11, -0.06}, 0.12, shoulder, 0.15, 0.16);
        solid.round_cone(shoulder, 0.16, {side * 0.56 * wide, 0.11, -0.62}, 0.16, 0.22);  // upper arm
    }
    solid.round_cone({0, 0.11, -0.20}, 0.17, {0, 0.06, 0.25}, 0.145, 0.18);  // neck
    solid.ellipsoid({0, 0.04, 0.52}, {0.275, 0.345, 0.34}, 0.12);            // skull
    solid.ellipsoid({0, -0.12, 0.35}, {0.195, 0.20, 0.26}, 0.12);            // face
    solid.ellipsoid({0, -0.255, 0.165}, {0.085, 0.07, 0.065}, 0.08);         // chin
    solid.ellipsoid({0, -0.255, 0.545}, {0.17, 0.07, 0.045}, 0.07);          // brow
    const double nose = std::clamp(detail, 0.045, 0.06);
    solid.round_cone({0, -0.295, 0.50}, 0.65 * nose, {0, -0.295 - 0.10 * long_nose, 0.36}, nose, nose);  // nose
    for (const double side : {-1.0, 1.0}) {
        solid.ellipsoid({side * 0.10, -0.345, 0.475}, {0.065, 0.07, 0.045}, 0.05, true);  // eye socket
        solid.ellipsoid({side * 0.098, -0.255, 0.475}, {0.05, 0.05, 0.04}, 0.02);         // eye
        solid.ellipsoid({side * 0.275, 0.03, 0.42}, {0.04, 0.075, 0.105}, 0.04);          // ear
        solid.ellipsoid({side * 0.12, -0.225, 0.345}, {0.08, 0.07, 0.075}, 0.09);         // cheek
    }
    solid.ellipsoid({0, -0.305, 0.285}, {0.075, 0.045, 0.020}, 0.02);              // upper lip
    solid.ellipsoid({0, -0.300, 0.245}, {0.062, 0.045, 0.022}, 0.02);              // lower lip
    solid.ellipsoid({0, 0.12, 0.62}, {0.285, 0.32, 0.31}, 0.04);                   // hair
    solid.ellipsoid({0, 0.44, 0.62}, {0.14 * bun, 0.13 * bun, 0.14 * bun}, 0.06);  // bun
    solid.floor(-0.50, 0.05);
    return solid;
}

Solid ornament_solid() {
    Solid solid;
    solid.ellipsoid(Vec3d::Zero(), {0.80, 0.80, 0.76}, 0.1);
    solid.round_cone({0, 0, 0.64}, 0.20, {0, 0, 0.80}, 0.09, 0.08);
    solid.ellipsoid({0, 0, 0.89}, {0.10, 0.10, 0.10}, 0.03);
    solid.round_cone({0, 0, -0.64}, 0.20, {0, 0, -0.95}, 0.045, 0.10);
    solid.tip({0, 0, 1});
    solid.tip({0, 0, -1});
    return solid;
}

}  // namespace radiafit
