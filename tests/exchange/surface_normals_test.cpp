// Normals by photometric stereo on what a fit shows, and the relief that they make: of made surfaces, with gloss and
// shadows.
#include "exchange/surface_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/atomic_file.h"
#include "dataset/grid.h"
#include "exchange/relief.h"
#include "geometry/shortest_turn.h"
#include "image/image_file.h"
#include "mesh_shapes.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace tools;
namespace {

/// Lamps on a spiral from 15 to 75 degrees from the axis.
std::vector<Vec3d> dome(int count, const Vec3d& axis) {
    const Eigen::Quaterniond turn = shortest_turn(Vec3d::UnitZ(), axis);
    std::vector<Vec3d> out;
    for (int i = 0; i < count; ++i) {
        const double angle = (15 + 60 * (i + 0.5) / count) * M_PI / 180, around = 2.4 * i;
        out.push_back(turn *
                      Vec3d(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around), std::cos(angle)));
    }
    return out;
}

/// Matt but for a lobe as narrow as a glaze's, with a shadow on one side where lamps stand low; `camera`: towards it.
float shown(const Vec3d& normal, const Vec3d& lamp, const Vec3d& camera, bool gloss) {
    const double cosine = normal.dot(lamp);
    if (!(cosine > 0)) return 0;
    const double lobe = std::pow(std::max(0.0, normal.dot((lamp + camera).normalized())), 200);
    const bool shadow = gloss && lamp.x() > 0.8;
    return float(shadow ? 0.02 : 0.6 * cosine + (gloss ? lobe : 0));
}

double degrees_between(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

struct Cap {
    static constexpr int side = 81;
    static constexpr double radius = 40;  // texels; the cap goes up to 60 degrees
    double texel;
    Dataset dataset;
    std::vector<Vec3d> normals;   ///< 0 off the cap
    std::vector<double> heights;  ///< world units

    /// near: the lamps stand at a distance of three radii of the cap in place of far away.
    Cap(double texel_, bool near, bool hole) : texel(texel_) {
        dataset.grid = Grid::centered(side, side, texel);
        for (int row = 0; row < side; ++row)
            for (int column = 0; column < side; ++column) {
                const double x = column - 0.5 * (side - 1), y = 0.5 * (side - 1) - row;
                const double square = radius * radius - x * x - y * y, z = std::sqrt(std::max(0.0, square));
                const bool off = square < radius * radius / 4 || (hole && std::abs(x + 5) < 9 && std::abs(y) < 6);
                normals.push_back(off ? Vec3d(Vec3d::Zero()) : Vec3d(x, y, z).normalized());
                heights.push_back(z * texel);
                dataset.grid.texel_normals.push_back(off ? Vec3f(Vec3f::Zero()) : Vec3f(Vec3f::UnitZ()));
            }
        for (const Vec3d& lamp : dome(40, Vec3d::UnitZ())) {
            View view;
            view.camera_direction = Vec3d::UnitZ();
            view.light = near ? Light{Light::Kind::near, 3 * radius * texel * lamp, Vec3d(9, 4, 2)}
                              : Light{Light::Kind::distant, lamp, Vec3d(2, 0, 1)};
            dataset.views.push_back(view);
        }
    }
    Contestant contestant(bool gloss) const {
        return {[this, gloss](const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
                    rgb.assign(3 * pixels.size(), 0.0f);
                    for (size_t i = 0; i < pixels.size(); ++i) {
                        const uint32_t t = pixels[i].triangle;
                        if (t == no_triangle) continue;
                        const Vec3d at = dataset.grid.position(int(t) % side, int(t) / side);
                        const Vec3d light = view.light->irradiance_at(at);
                        const float value = shown(normals[t], view.light->direction_from(at), Vec3d::UnitZ(), gloss);
                        for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = value * float(light[ptrdiff_t(c)]);
                    }
                },
                TargetSpace::linear};
    }
    std::vector<uint32_t> training() const {
        std::vector<uint32_t> out(dataset.views.size());
        std::iota(out.begin(), out.end(), 0u);
        return out;
    }
};

TEST(SurfaceNormals, ACapsNormalsAndReliefComeBack) {
    for (const auto& [gloss, near, hole, texel] :
         {std::tuple{false, false, false, 1.0}, {true, false, true, 1.0}, {true, true, false, 0.05}}) {
        const Cap cap(texel, near, hole);
        const GridAtlas atlas = make_atlas(cap.dataset.grid);
        EXPECT_FALSE(has_own_normals(cap.dataset));
        const auto found = normals_of_fit(cap.contestant(gloss), atlas, cap.dataset, cap.training());
        ASSERT_TRUE(found);
        EXPECT_EQ(found->lamps, 40u);
        double worst = 0, least = INFINITY, most = -INFINITY, mean = 0, count = 0, off = 0;
        for (size_t t = 0; t < cap.normals.size(); ++t) {
            if (cap.normals[t].isZero(0)) {
                ASSERT_TRUE(found->normals[t].isZero(0));
                continue;
            }
            worst = std::max(worst, degrees_between(found->normals[t].cast<double>(), cap.normals[t]));
            least = std::min(least, cap.heights[t]);
            most = std::max(most, cap.heights[t]);
        }
        EXPECT_LT(worst, 0.5);

        const Relief relief = relief_of(*found, atlas, cap.dataset.grid);
        EXPECT_EQ(relief.parts, 1);
        EXPECT_EQ(relief.in_pixels(), texel == 1);
        const auto difference = [&](size_t t) { return double(relief.heights.values[2 * t]) - cap.heights[t]; };
        for (size_t t = 0; t < cap.normals.size(); ++t) {
            ASSERT_EQ(relief.heights.values[2 * t + 1], cap.normals[t].isZero(0) ? 0.0f : 1.0f);
            if (!cap.normals[t].isZero(0)) mean += difference(t), ++count;
        }
        for (size_t t = 0; t < cap.normals.size(); ++t)
            if (!cap.normals[t].isZero(0)) off = std::max(off, std::abs(difference(t) - mean / count));
        EXPECT_LT(off, 0.01 * (most - least));
        EXPECT_NEAR(relief.most - relief.least, most - least, 0.02 * (most - least));
    }
}

TEST(SurfaceNormals, LampsInOnePlaneTellNone) {
    Cap cap(1, false, false);
    for (size_t i = 0; i < cap.dataset.views.size(); ++i) {
        const double angle = 0.03 * double(i);
        cap.dataset.views[i].light->place = Vec3d(std::sin(angle), 0, std::cos(angle));
    }
    const GridAtlas atlas = make_atlas(cap.dataset.grid);
    EXPECT_FALSE(normals_of_fit(cap.contestant(false), atlas, cap.dataset, cap.training()));
    EXPECT_FALSE(normals_of_fit(cap.contestant(false), atlas, cap.dataset, {0, 1}));
    const SurfaceNormals plane = finest_normals(cap.contestant(false), atlas, cap.dataset, {0, 1});
    EXPECT_EQ(plane.lamps, 0u);
    EXPECT_EQ(plane.normals, normals_of_dataset(atlas, cap.dataset).normals);
}

// The atlas's normals stand for a fit's bumps: what is found is not the mesh's own.
TEST(SurfaceNormals, AMeshHasThemInItsCoordinates) {
    Dataset dataset;
    dataset.mesh = testing::ball(2);
    for (const Vec3d& axis : {Vec3d(Vec3d::UnitZ()), Vec3d(-Vec3d::UnitZ()), Vec3d(Vec3d::UnitX()),
                              Vec3d(-Vec3d::UnitX()), Vec3d(Vec3d::UnitY()), Vec3d(-Vec3d::UnitY())})
        for (const Vec3d& lamp : dome(10, axis)) {
            View view;
            view.camera_direction = axis;
            view.light = Light{Light::Kind::distant, lamp, Vec3d::Ones()};
            dataset.views.push_back(view);
        }
    const TriangleAtlas atlas(dataset.mesh, 4);
    const auto bumpy = [&](uint32_t t) {
        const Vec3d n = atlas.normal(t).cast<double>();
        return Vec3d(n + 0.2 * Vec3d(std::sin(7 * n.y()), std::sin(5 * n.z()), std::sin(6 * n.x()))).normalized();
    };
    const Contestant contestant{
        [&](const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
            rgb.assign(3 * pixels.size(), 0.0f);
            for (size_t i = 0; i < pixels.size(); ++i) {
                if (pixels[i].triangle == no_triangle) continue;
                const uint32_t t = pixels[i].triangle * atlas.texels_per_tile() +
                                   atlas.local_at(pixels[i].triangle, pixels[i].b1, pixels[i].b2);
                std::fill_n(&rgb[3 * i], 3, shown(bumpy(t), view.light->place, *view.camera_direction, false));
            }
        },
        TargetSpace::linear};
    std::vector<uint32_t> training(dataset.views.size());
    std::iota(training.begin(), training.end(), 0u);
    const auto found = normals_of_fit(contestant, atlas, dataset, training);
    ASSERT_TRUE(found);
    const SurfaceNormals own = normals_of_dataset(atlas, dataset);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        if (!atlas.usable(t)) continue;
        ASSERT_LT(degrees_between(found->normals[t].cast<double>(), bumpy(t)), 0.5) << t;
        ASSERT_LT((own.normals[t] - atlas.normal(t)).norm(), 1e-6f);
    }
}

TEST(SurfaceNormals, AGridsAreThoseOfItsPlane) {
    Dataset dataset;
    dataset.grid.width = 2;
    dataset.grid.height = 1;
    dataset.grid.right = Vec3d(0, 2, 0);  // x right, y up, z out of it: world y, z, x
    dataset.grid.down = Vec3d(0, 0, -3);
    dataset.grid.texel_normals = {Vec3f(0.8f, 0.6f, 0), Vec3f(0.8f, 0, -0.6f)};
    const GridAtlas atlas = make_atlas(dataset.grid);
    EXPECT_TRUE(has_own_normals(dataset));
    const SurfaceNormals normals = normals_of_dataset(atlas, dataset);
    const std::vector<Vec3f> back = in_world(normals.normals, dataset);
    for (size_t t = 0; t < back.size(); ++t) EXPECT_LT((back[t] - dataset.grid.texel_normals[t]).norm(), 1e-6f);
    EXPECT_EQ(finest_normals({}, atlas, dataset, {}).normals, normals.normals);  // the fit isn't asked
    EXPECT_LT((normals.normals[0] - Vec3f(0.6f, 0, 0.8f)).norm(), 1e-6f);
    EXPECT_LT((normals.normals[1] - Vec3f(0, -0.6f, 0.8f)).norm(), 1e-6f);
    const Relief relief = relief_of(normals, atlas, dataset.grid);
    EXPECT_EQ(relief.step, (std::array<double, 2>{2, 3}));
    EXPECT_NEAR(relief.heights.values[2] - relief.heights.values[0], -0.75, 1e-6);  // 2 * (slopes -0.75 and 0) / 2
}

TEST(Relief, ThePngHasItsEndsAndNone) {
    Relief relief;
    relief.heights = {3, 1, 2, {-2, 1, 0, 0, 6, 1}};
    relief.least = -2;
    relief.most = 6;
    const TemporaryFolder folder;
    write_file(folder.path() / "height.png", height_png(relief));
    const ImageFile png = read_image(folder.path() / "height.png");
    ASSERT_EQ(png.bits, 16);
    std::vector<uint16_t> red;
    for (size_t i = 0; i < png.rgb16.size(); i += 3) red.push_back(png.rgb16[i]);
    EXPECT_EQ(red, (std::vector<uint16_t>{1, 0, 65535}));
}

}  // namespace
}  // namespace radiafit
