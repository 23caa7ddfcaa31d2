// Which views are left out so that others are far from all that is fitted.
#include "fitting/off_photographs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/rng.h"

namespace radiafit {
using namespace fits;
namespace {

View looking_from(const Vec3d& direction) {
    View view;
    const Vec3d up = std::abs(direction.y()) < 0.9 ? Vec3d(Vec3d::UnitY()) : Vec3d(Vec3d::UnitX());
    view.camera = Camera::look_at(5 * direction.normalized(), Vec3d::Zero(), up, 0.5, 32, 32);
    return view;
}

Dataset around(size_t views, double spread, uint64_t seed) {
    Dataset dataset;
    dataset.mesh.positions = {{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}, {0, 0, 1}};
    dataset.mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    Rng rng(seed);
    const auto number = [&] { return 2 * double(rng.uniform()) - 1; };
    for (size_t i = 0; i < views; ++i)
        dataset.views.push_back(looking_from(Vec3d(spread * number(), spread * number(), spread * number() + 1e-3)));
    return dataset;
}

std::vector<uint32_t> all_of(const Dataset& dataset) {
    std::vector<uint32_t> out(dataset.views.size());
    std::iota(out.begin(), out.end(), 0u);
    return out;
}

double degrees_between(const View& a, const View& b) {
    const Vec3d centre = Vec3d::Zero();  // of the mesh's box
    return std::acos(a.direction_to_camera(centre).dot(b.direction_to_camera(centre))) * 57.29577951308232;
}

TEST(OffPhotographs, NothingThatIsFittedIsNear) {
    for (uint64_t seed = 0; seed < 20; ++seed)
        for (const double degrees : off_degrees) {
            const Dataset dataset = around(60, 1, seed);
            const FarViews far = far_views(dataset, all_of(dataset), degrees);
            ASSERT_FALSE(far.judged.empty()) << degrees;
            EXPECT_LE(far.judged.size(), 6u);
            EXPECT_GE(2 * far.fitted.size(), dataset.views.size());
            for (const uint32_t j : far.judged) {
                for (const uint32_t f : far.fitted)
                    EXPECT_GE(degrees_between(dataset.views[j], dataset.views[f]), degrees - 1e-9);
                for (const uint32_t other : far.judged) {
                    if (other == j) continue;
                    EXPECT_GE(degrees_between(dataset.views[j], dataset.views[other]), degrees - 1e-9);
                }
            }
            EXPECT_EQ(far.judged, far_views(dataset, all_of(dataset), degrees).judged);
        }
}

TEST(OffPhotographs, ViewsFromOneSideHaveNone) {
    Dataset dataset = around(0, 1, 0);
    for (int i = 0; i < 20; ++i) dataset.views.push_back(looking_from(Vec3d(0.01 * i, 0, 1)));
    EXPECT_TRUE(far_views(dataset, all_of(dataset), 15).judged.empty());
    EXPECT_FALSE(far_views(dataset, all_of(dataset), 1).judged.empty());
}

TEST(OffPhotographs, LampsCountAsCamerasDo) {
    Dataset dataset = around(0, 1, 0);
    for (int i = 0; i < 40; ++i) {
        dataset.views.push_back(looking_from(Vec3d::UnitZ()));
        const double angle = 0.05 * i;
        dataset.views.back().light = Light{Light::Kind::distant, {std::sin(angle), 0, std::cos(angle)}, Vec3d::Ones()};
    }
    const FarViews far = far_views(dataset, all_of(dataset), 15);
    ASSERT_FALSE(far.judged.empty());
    const double nearest = std::cos(15 / 57.29577951308232);
    for (const uint32_t j : far.judged)
        for (const uint32_t f : far.fitted)
            EXPECT_LE(dataset.views[j].light->place.dot(dataset.views[f].light->place), nearest + 1e-9);
}

}  // namespace
}  // namespace radiafit
