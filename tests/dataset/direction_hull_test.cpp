// Directions amid others and at their rim.
#include "geometry/direction_hull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <set>

#include "base/rng.h"
#include "dataset/view_directions.h"

namespace radiafit {
namespace {

Vec3d toward(double polar, double azimuth) {
    return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
}

Vec3d random_direction(Rng& rng, double widest) {
    return toward(widest * double(rng.uniform()), 2 * M_PI * double(rng.uniform()));
}

/// A cone of three: their sums lie inside, and one that a plane through two of them parts from the third lies outside
/// by its angle to that plane, where it is nearest to the side between them.
TEST(DirectionHull, KnowsATriangle) {
    const std::vector<Vec3d> corners = {Vec3d::UnitX(), Vec3d::UnitY(), Vec3d::UnitZ()};
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        const Vec3d inside = Vec3d(rng.uniform(), rng.uniform(), rng.uniform()).normalized();
        EXPECT_EQ(angle_outside(corners, inside), 0) << inside.transpose();
        const double below = 0.01 + double(rng.uniform());
        const Vec3d outside = Vec3d(0.1 + double(rng.uniform()), 0.1 + double(rng.uniform()), -below).normalized();
        EXPECT_NEAR(angle_outside(corners, outside), std::asin(-outside.z()), 1e-9) << outside.transpose();
    }
    EXPECT_NEAR(angle_outside(corners, Vec3d(-1, 0, 0)), M_PI / 2, 1e-9);
    EXPECT_EQ(angle_outside(corners, Vec3d::UnitY()), 0);
}

/// Against the definition: outside if some plane has all others on one side and the direction on the other.
TEST(DirectionHull, AgreesWithSeparatingPlanes) {
    Rng rng(2);
    size_t outside = 0;
    for (int round = 0; round < 60; ++round) {
        std::vector<Vec3d> others;
        for (int i = 0; i < 12; ++i) others.push_back(random_direction(rng, 1.2));
        const Vec3d direction = random_direction(rng, 1.4);
        bool separated = false;  // by a plane through two of them
        for (size_t i = 0; i < others.size(); ++i)
            for (size_t j = 0; j < others.size() && !separated; ++j) {
                const Vec3d normal = others[i].cross(others[j]);
                if (normal.norm() < 1e-9 || normal.dot(direction) >= -1e-9) continue;
                bool all = true;
                for (const Vec3d& o : others) all = all && normal.dot(o) >= -1e-12;
                separated = all;
            }
        EXPECT_EQ(angle_outside(others, direction) > 0, separated) << round;
        outside += separated;
    }
    EXPECT_GT(outside, 10u);
    EXPECT_LT(outside, 50u);
}

/// Those that are taken are as many as asked for, different, and amid the others; the first of each eight of a grid in
/// rows, one of its edges, are not.
TEST(DirectionHull, SpreadsAmidTheOthers) {
    std::vector<Vec3d> grid;
    for (int row = 0; row < 12; ++row)
        for (int column = 0; column < 8; ++column)
            grid.push_back(Vec3d((row - 5.5) / 6, (column - 3.5) / 4, 1.5).normalized());
    const auto beyond = [&](const std::set<size_t>& held_out) {
        std::vector<Vec3d> training;
        for (size_t i = 0; i < grid.size(); ++i)
            if (!held_out.contains(i)) training.push_back(grid[i]);
        size_t count = 0;
        for (const size_t i : held_out) count += angle_outside(training, grid[i]) > 0;
        return count;
    };
    const std::vector<size_t> chosen = spread_over(grid, 12);
    EXPECT_EQ(chosen.size(), 12u);
    EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
    const std::set<size_t> held_out(chosen.begin(), chosen.end());
    EXPECT_EQ(held_out.size(), 12u);
    EXPECT_EQ(beyond(held_out), 0u);
    EXPECT_EQ(spread_over(grid, 12), chosen);
    std::set<size_t> every;
    for (size_t i = 0; i < grid.size(); i += 8) every.insert(i);
    EXPECT_EQ(beyond(every), every.size());
    EXPECT_EQ(spread_over(std::vector<Vec3d>(5, Vec3d::UnitZ()), 3).size(), 3u);  // all the same
}

TEST(ViewDirections, TellWhatIsExtrapolated) {
    std::vector<View> views(9);
    for (int i = 0; i < 9; ++i) {
        views[size_t(i)].camera_direction = Vec3d::UnitZ();  // the same for all: it says nothing
        views[size_t(i)].light = Light{Light::Kind::distant, toward(0.1 * i, 0.0), Vec3d::Ones()};
    }
    views[4].held_out = views[8].held_out = true;
    const std::vector<double> angles = angles_outside(Vec3d::Zero(), views);
    EXPECT_EQ(angles[0], 0);
    EXPECT_EQ(angles[4], 0);
    EXPECT_NEAR(angles[8], 0.1, 1e-9);
    const std::string note = outside_note(views, angles);
    EXPECT_NE(note.find("1 of 2 held-out images"), std::string::npos) << note;
    EXPECT_NE(note.find("by 6 degrees"), std::string::npos) << note;
    views[8].held_out = false;
    EXPECT_EQ(outside_note(views, angles_outside(Vec3d::Zero(), views)), "");
}

}  // namespace
}  // namespace radiafit
