// What a page says and opens on.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/error.h"
#include "dataset_fixture.h"
#include "publish/first_view.h"
#include "publish/page_words.h"

namespace radiafit {
using namespace tools;
namespace {

TEST(PageWords, LengthsHaveANumberAndAUnit) {
    EXPECT_DOUBLE_EQ(parse_length("scale", "1mm"), 1e-3);
    EXPECT_DOUBLE_EQ(parse_length("scale", "2.5 cm"), 2.5e-2);
    EXPECT_DOUBLE_EQ(parse_length("scale", "1e-3m"), 1e-3);
    EXPECT_DOUBLE_EQ(parse_length("scale", "12in"), parse_length("scale", "1ft"));
    for (const char* text : {"", "1", "mm", "0mm", "-1mm", "1 parsec", "1mm2", "nan mm", "inf m"})
        EXPECT_THROW(parse_length("scale", text), UserError) << text;
}

constexpr double degree = 0.017453292519943295;

View seen_from(double degrees, int height = 100) {
    View view;
    const Vec3d eye(10 * std::sin(degrees * degree), 0, 10 * std::cos(degrees * degree));
    view.camera = Camera::look_at(eye, Vec3d::Zero(), Vec3d::UnitY(), 0.6, 100, 100);
    view.camera.height = height;
    return view;
}

std::vector<uint32_t> all_of(const Dataset& dataset) {
    std::vector<uint32_t> all(dataset.views.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

TEST(FirstView, IsAmidTheOthersAndWhole) {
    Dataset dataset;
    dataset.mesh = tetrahedron();
    for (const double angle : {-60, -40, -30, -20, 10, 80}) dataset.views.push_back(seen_from(angle));
    const std::vector<uint32_t> all = all_of(dataset);
    EXPECT_EQ(first_view(dataset, all, all), 2u);
    dataset.views[2] = seen_from(-30, 45);  // cut below its middle
    EXPECT_EQ(first_view(dataset, all, all), 1u);
    EXPECT_EQ(first_view(dataset, all, {5, 2, 4}), 2u) << "of those on the page, by their place there";
}

TEST(FirstView, OfAGridIsLitFromTheUpperLeft) {
    Dataset dataset;
    dataset.grid = Grid::centered(8, 8, 1);
    for (const Vec3d& lamp : {Vec3d(0, 0, 1), Vec3d(1, 1, 1), Vec3d(-1, 1, 1.4), Vec3d(-1, -1, 1.4)}) {
        View view;
        view.camera_direction = Vec3d::UnitZ();
        view.light = Light{.place = lamp.normalized()};
        dataset.views.push_back(view);
    }
    EXPECT_EQ(first_view(dataset, all_of(dataset), all_of(dataset)), 2u);
}

}  // namespace
}  // namespace radiafit
