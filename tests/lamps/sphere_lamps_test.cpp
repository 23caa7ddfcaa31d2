// Lamps by glossy spheres, on a made dome whose lamps are known.
#include "lamps/sphere_lamps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lamp_dome.h"
#include "lamps/refine_lamps.h"

namespace radiafit {
using namespace testing;
namespace {

double degrees_between(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

/// How far off, in standard deviations: few beyond two, hardly any beyond four.
void expect_covered(const std::vector<double>& errors, const std::string& what) {
    size_t beyond_two = 0, beyond_four = 0;
    double squares = 0;
    for (const double e : errors) beyond_two += e > 2, beyond_four += e > 4, squares += e * e / double(errors.size());
    EXPECT_LE(double(beyond_two), 0.15 * double(errors.size())) << what;
    EXPECT_LE(double(beyond_four), 0.02 * double(errors.size())) << what;
    EXPECT_GT(squares, 0.02) << what << ": deviations are far too large";
}

struct MadeDome {
    LampDome dome;
    std::vector<LuminanceImage> images = dome.images();
    std::vector<Circle> circles;
    std::vector<std::vector<std::optional<Highlight>>> highlights;  ///< [image][circle]
    MadeDome() {
        SphereFinder finder;
        for (const LuminanceImage& image : images) finder.add(image);
        circles = finder.find(2);
        for (const LuminanceImage& image : images) {
            highlights.emplace_back();
            for (const Circle& c : circles) highlights.back().push_back(find_highlight(image, c));
        }
    }
};
const MadeDome& made() {
    static const MadeDome dome;
    return dome;
}

/// How far lamps are from where they should be, and how far that is in standard deviations.
struct Errors {
    double worst_angle = 0, worst_distance = 0;
    std::vector<double> angles, distances;
};
Errors errors_of(const std::vector<CalibratedLamp>& lamps, const std::vector<uint32_t>& images) {
    Errors out;
    for (size_t k = 0; k < lamps.size(); ++k) {
        const Vec3d truth = made().dome.lamps[images[k]].place, place = lamps[k].light.place;
        const double angle = degrees_between(place, truth), distance = std::abs(place.norm() / truth.norm() - 1);
        out.worst_angle = std::max(out.worst_angle, angle);
        out.worst_distance = std::max(out.worst_distance, distance);
        out.angles.push_back(angle / std::sqrt(2.0) / lamps[k].deviation_degrees());
        out.distances.push_back(distance / lamps[k].deviation_of_distance());
    }
    return out;
}

TEST(SphereOutline, FindsTheSpheres) {
    ASSERT_EQ(made().circles.size(), 2u);
    for (const Circle& truth : made().dome.spheres) {
        const auto off = [&](const Circle& c) { return (c.centre - truth.centre).norm(); };
        const Circle& found = *std::ranges::min_element(made().circles, {}, off);
        EXPECT_LT(off(found), 0.15);
        EXPECT_NEAR(found.radius, truth.radius, 0.25);
    }
}

TEST(SphereOutline, RefinesWhatIsGivenRoughly) {
    SphereFinder finder;
    for (const LuminanceImage& image : made().images) finder.add(image);
    for (const Circle& truth : made().dome.spheres) {
        const auto found = finder.refined({truth.centre + Vec2d(2, -4), 1.04 * truth.radius});
        ASSERT_TRUE(found.has_value());
        EXPECT_LT((found->centre - truth.centre).norm(), 0.15);
        EXPECT_NEAR(found->radius, truth.radius, 0.25);
    }
    EXPECT_FALSE(SphereFinder().refined({{100, 100}, 20}).has_value());
}

TEST(SphereLamps, HighlightsAreWhereTheMirrorSaysOfNearAndFarCameras) {
    const GlossySphere sphere{{0.1, -0.2, 0.07}, 0.07};
    for (const auto& eye : {std::optional<Vec3d>(), std::optional<Vec3d>({0.2, 0.3, 3})}) {
        const PictureFrame frame{400, 300, 0.0025, eye};
        const Light lamp{Light::Kind::near, {0.5, 0.4, 0.9}, Vec3d::Ones()};
        const Vec2d place = highlight_of(lamp, sphere, frame);
        // The line of sight there meets the sphere, and is mirrored to the lamp.
        const Vec3d at = frame.plane_point(place), up = frame.direction_to_camera(at), from = at - sphere.centre;
        const double along = from.dot(up);
        const Vec3d met =
            at + (-along + std::sqrt(along * along - from.squaredNorm() + sphere.radius * sphere.radius)) * up;
        const Vec3d n = (met - sphere.centre) / sphere.radius;
        EXPECT_LT(degrees_between(2 * n.dot(up) * n - up, lamp.place - met), 1e-5);
    }
}

TEST(SphereLamps, OutlineOfANearCameraIsUndone) {
    const PictureFrame frame{400, 300, 0.0025, Vec3d(0.2, 0.3, 2)};
    const GlossySphere sphere = sphere_of({{310, 60}, 30, 0}, frame);
    EXPECT_NEAR(sphere.centre.z(), sphere.radius, 1e-12);
    // Lines of sight at the outline's edge touch the sphere.
    double least = 1e9, most = 0;
    for (int i = 0; i < 32; ++i) {
        const Vec3d at = frame.plane_point({310 + 30 * std::cos(i * M_PI / 16), 60 + 30 * std::sin(i * M_PI / 16)});
        const Vec3d up = frame.direction_to_camera(at), from = sphere.centre - at;
        const double distance = (from - from.dot(up) * up).norm() / sphere.radius;
        least = std::min(least, distance), most = std::max(most, distance);
    }
    EXPECT_GT(least, 0.98);
    EXPECT_LT(most, 1.02);
}

TEST(SphereLamps, PlacesOfTwoSpheres) {
    const SphereLamps found = lamps_by_spheres(made().circles, made().highlights, made().dome.frame());
    ASSERT_TRUE(found.near);
    EXPECT_GE(found.lamps.size(), made().images.size() * 9 / 10);
    const Errors errors = errors_of(found.lamps, found.images);
    EXPECT_LT(errors.worst_angle, 0.5);
    EXPECT_LT(errors.worst_distance, 0.03);
    expect_covered(errors.angles, "directions");
    expect_covered(errors.distances, "distances");
}

TEST(SphereLamps, DirectionsOfOneSphere) {
    std::vector<std::vector<std::optional<Highlight>>> one;
    for (const auto& of_image : made().highlights) one.push_back({of_image[0]});
    const SphereLamps found = lamps_by_spheres({made().circles[0]}, one, made().dome.frame());
    EXPECT_FALSE(found.near);
    EXPECT_GE(found.lamps.size(), made().images.size() * 9 / 10);
    const GlossySphere sphere = sphere_of(made().circles[0], made().dome.frame());
    for (size_t k = 0; k < found.lamps.size(); ++k) {  // from where the sphere mirrors the lamp
        const Vec3d lamp = made().dome.lamps[found.images[k]].place;
        const Vec3d half = ((lamp - sphere.centre).normalized() + Vec3d::UnitZ()).normalized();
        EXPECT_LT(degrees_between(found.lamps[k].light.place, lamp - sphere.centre - sphere.radius * half), 0.5) << k;
    }
}

// What the surface shows makes lamps surer: directions within 0.3 degrees, places within 1 %, strengths within 2 %.
TEST(RefineLamps, OfTwoSpheresAndTheSurface) {
    const SphereLamps said = lamps_by_spheres(made().circles, made().highlights, made().dome.frame());
    const RefinedLamps found =
        refine_lamps(said.lamps, said.covariance, samples_of(made().dome, made().images, said.images));
    const Errors before = errors_of(said.lamps, said.images), errors = errors_of(found.lamps, said.images);
    EXPECT_LT(errors.worst_angle, 0.3);
    EXPECT_LT(errors.worst_distance, 0.01);
    EXPECT_LT(errors.worst_distance, before.worst_distance);
    expect_covered(errors.angles, "directions");
    expect_covered(errors.distances, "distances");
    double mean = 0;
    for (const uint32_t i : said.images) mean += std::log(made().dome.strengths[i]) / double(said.images.size());
    for (size_t k = 0; k < said.images.size(); ++k)
        EXPECT_NEAR(std::log(found.strengths[k][0]), std::log(made().dome.strengths[said.images[k]]) - mean, 0.02) << k;
}

TEST(RefineLamps, StrengthsOfKnownLampsAndTheirDeviations) {
    std::vector<CalibratedLamp> lamps;
    std::vector<uint32_t> images;
    for (const Light& light : made().dome.lamps) {
        images.push_back(uint32_t(lamps.size()));
        lamps.push_back({.light = light});
    }
    const RefinedLamps found = refine_lamps(lamps, {}, samples_of(made().dome, made().images, images));
    std::vector<double> errors;
    for (size_t i = 0; i < lamps.size(); ++i) {
        const double off = std::abs(std::log(found.strengths[i][1] / made().dome.strengths[i]));
        EXPECT_LT(off, 0.01) << i;
        errors.push_back(off / found.deviations[i][1]);
        EXPECT_EQ(found.lamps[i].light.place, lamps[i].light.place);
    }
    expect_covered(errors, "strengths");
}

}  // namespace
}  // namespace radiafit
