// `import lights` of images that tell their lamps: by spheres, and by the surface. A made dome whose lamps are known.
#include <sstream>

#include "capture/import_lights.h"
#include "capture/light_file.h"
#include "capture_fixture.h"
#include "dataset/checksums.h"
#include "dataset/dataset.h"
#include "image/image_file.h"
#include "lamp_dome.h"

namespace radiafit {
using namespace testing;
namespace {

double degrees_apart(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

/// Grey, 16 bits.
void write_dome(const LampDome& dome, const fs::path& folder) {
    const std::vector<LuminanceImage> images = dome.images();
    for (size_t i = 0; i < images.size(); ++i) {
        std::vector<uint16_t> stored;
        for (const float v : images[i].values) stored.push_back(uint16_t(std::lround(65535 * double(v))));
        write_bytes(folder / fmt::format("{:02}.png", i), encode_png(dome.width, dome.height, 1, 16, stored));
    }
}

/// Fields of lamps.csv: [line][column], the header first.
std::vector<std::vector<std::string>> read_table(const fs::path& file) {
    std::vector<std::vector<std::string>> lines;
    std::istringstream text(read_bytes(file));
    for (std::string line; std::getline(text, line);) {
        lines.emplace_back();
        std::istringstream fields(line + ",");
        for (std::string field; std::getline(fields, field, ',');) lines.back().push_back(field);
    }
    return lines;
}
double number_in(const std::vector<std::vector<std::string>>& table, size_t line, const std::string& column) {
    const auto at = std::ranges::find(table[0], column);
    EXPECT_NE(at, table[0].end()) << column;
    return std::stod(table[line][size_t(at - table[0].begin())]);
}

/// Errors over their standard deviations: about 1 each, none beyond four. Lamps of one dome share the outlines' errors,
/// so that their mean square varies from dome to dome more than that of as many independent numbers.
void expect_errors_covered(const std::vector<double>& errors, const std::string& what) {
    double squares = 0;
    for (const double e : errors) squares += e * e / double(errors.size());
    EXPECT_LT(std::sqrt(squares), 1.5) << what;
    EXPECT_GT(std::sqrt(squares), 0.4) << what << ": deviations are far too large";
    EXPECT_LT(*std::ranges::max_element(errors), 4) << what;
}

class LampCalibrationTest : public FolderTest {
protected:
    /// The dome, written once for all tests.
    static const LampDome& dome() {
        static const LampDome made;
        return made;
    }
    static const fs::path& images() {
        static const struct Folder : FolderTest {
            Folder() { write_dome(dome(), root_); }
            void TestBody() override {}
            using FolderTest::root_;
        } folder;
        return folder.root_;
    }

    LampCalibrationTest() {
        options_.images = images();
        options_.normals = "flat";
        options_.holdout = "none";
    }
    Dataset import() {
        report_ = import_lights(options_, root_ / "set");
        return open_dataset(root_ / "set");
    }
    std::string refused() {
        const std::string text = complaint([&] { import_lights(options_, root_ / "set"); });
        EXPECT_FALSE(fs::exists(root_ / "set"));
        return text;
    }
    /// One or both spheres, some pixels off.
    void give_circles(size_t count) {
        std::string lines = "# x y radius\n";
        for (const Circle& c : std::span(dome().spheres).first(count))
            lines += fmt::format("{} {} {}\n", c.centre.x() + 2, c.centre.y() - 4, 1.04 * c.radius);
        options_.spheres = root_ / "circles.txt";
        write_bytes(options_.spheres, lines);
    }
    /// The first so many images alone: what takes time grows with the cube of their number.
    void name_images(int count) {
        std::string lines;
        for (int i = 0; i < count; ++i) lines += fmt::format("{:02}.png\n", i);
        write_bytes(options_.names = root_ / "names.txt", lines);
    }
    static size_t number_of(const View& view) { return size_t(std::stoi(view.name)); }

    /// Places within 1 %, directions within 0.3 degrees, intensities within 2 % of what they are. The dome's unit is
    /// what an image's width covers. allowed: times that.
    static void expect_true_lamps(const Dataset& set, const LampDome& made, double allowed = 1) {
        double mean = 0;
        for (const View& view : set.views) mean += std::log(made.strengths[number_of(view)]) / double(set.views.size());
        for (const View& view : set.views) {
            const Vec3d truth = made.lamps[number_of(view)].place;
            EXPECT_EQ(view.light->kind, Light::Kind::near);
            EXPECT_LT((view.light->place - truth).norm(), 0.01 * allowed * truth.norm()) << view.name;
            EXPECT_LT(degrees_apart(view.light->place, truth), 0.3 * allowed) << view.name;
            const double intensity = made.strengths[number_of(view)] / std::exp(mean) * truth.squaredNorm();
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(view.light->intensity[c] / intensity, 1, 0.02 * allowed) << view.name;
        }
    }

    LightImportOptions options_;
    LightImportReport report_;
};

TEST_F(LampCalibrationTest, SpheresTellPlacesAndIntensities) {
    options_.spheres = "auto";
    options_.sample_width = 1;
    const Dataset set = import();
    ASSERT_GE(set.views.size(), dome().lamps.size() * 9 / 10);
    expect_true_lamps(set, dome());

    // What an import leaves for people: standard deviations that hold, and a picture.
    const auto table = read_table(set.folder / "lamps.csv");
    ASSERT_EQ(table.size(), set.views.size() + 1);
    std::vector<double> angles, distances, intensities;
    double mean = 0;
    for (const View& view : set.views) mean += std::log(dome().strengths[number_of(view)]) / double(set.views.size());
    for (size_t i = 0; i < set.views.size(); ++i) {
        const View& view = set.views[i];
        const Vec3d truth = dome().lamps[number_of(view)].place;
        EXPECT_EQ(table[i + 1][0], view.name);
        EXPECT_EQ(table[i + 1][1], "position");
        EXPECT_EQ(number_in(table, i + 1, "x"), view.light->place.x());
        EXPECT_EQ(number_in(table, i + 1, "blue"), view.light->intensity.z());
        EXPECT_EQ(number_in(table, i + 1, "spheres"), 2);
        EXPECT_LT(number_in(table, i + 1, "highlight_pixels"), 1);
        angles.push_back(degrees_apart(view.light->place, truth) / std::sqrt(2.0) / number_in(table, i + 1, "degrees"));
        distances.push_back(std::abs(view.light->place.norm() / truth.norm() - 1) /
                            number_in(table, i + 1, "distance_share"));
        const double strength = view.light->intensity.x() / view.light->place.squaredNorm() * std::exp(mean);
        intensities.push_back(std::abs(std::log(strength / dome().strengths[number_of(view)])) /
                              number_in(table, i + 1, "red_share"));
    }
    expect_errors_covered(angles, "directions");
    expect_errors_covered(distances, "distances");
    expect_errors_covered(intensities, "intensities");
    const ImageFile picture = read_image(set.folder / "lamps.png");
    EXPECT_GE(picture.width, 1000);

    // The spheres are no surface, and all else is.
    const GridAtlas atlas = make_atlas(set.grid);
    for (int y = 0; y < dome().height; ++y)
        for (int x = 0; x < dome().width; ++x) {
            double nearest = 10;  // radii
            for (const Circle& c : dome().spheres)
                nearest = std::min(nearest, (Vec2d(x + 0.5, y + 0.5) - c.centre).norm() / c.radius);
            const bool usable = atlas.usable(uint32_t(y * dome().width + x));
            if (nearest < 1.05) {
                ASSERT_FALSE(usable) << x << " " << y;
            }
            if (nearest > 1.15) {
                ASSERT_TRUE(usable) << x << " " << y;
            }
        }
    expect_in("2 spheres, in pixels of the files at (", fmt::format("{}", fmt::join(report_.remarks, "\n")));

    // These files are the dataset's: checked, and replaced with it.
    check_pixels(set);
    options_.spheres.clear();
    options_.sample_width = 0;
    std::string directions;
    for (const Light& light : dome().lamps)
        directions += fmt::format("{} {} {}\n", light.place.x(), light.place.y(), light.place.z());
    write_bytes(options_.lights = root_ / "lights.txt", directions);
    EXPECT_FALSE(fs::exists(import().folder / "lamps.csv"));
}

TEST_F(LampCalibrationTest, CirclesMayBeGivenRoughlyAndTheMaskMayLeaveSpheresOut) {
    give_circles(2);
    options_.sample_width = 1;
    std::vector<uint16_t> mask;
    for (int y = 0; y < dome().height; ++y)
        for (int x = 0; x < dome().width; ++x) mask.push_back(dome().near_sphere(x, y) ? 0 : 255);
    write_bytes(options_.mask = root_ / "mask.png", encode_png(dome().width, dome().height, 1, 8, mask));
    name_images(12);
    expect_true_lamps(import(), dome(), 2);
}

TEST_F(LampCalibrationTest, OneSphereTellsDirectionsAndItsRadiusTheScale) {
    give_circles(1);
    name_images(12);
    options_.sphere_radius = 20;
    options_.normals.clear();
    const Dataset set = import();
    ASSERT_GE(set.views.size(), 11u);
    const double pixel = 20 / dome().spheres[0].radius;
    EXPECT_NEAR(set.grid.right.norm(), pixel, 0.005 * pixel);
    EXPECT_TRUE(report_.computed_normals);
    const GlossySphere sphere = sphere_of(dome().spheres[0], dome().frame());
    for (const View& view : set.views) {
        EXPECT_EQ(view.light->kind, Light::Kind::distant);
        const Vec3d lamp = dome().lamps[number_of(view)].place;
        const Vec3d half = ((lamp - sphere.centre).normalized() + Vec3d::UnitZ()).normalized();
        EXPECT_LT(degrees_apart(view.light->place, lamp - sphere.centre - sphere.radius * half), 0.5) << view.name;
    }
}

TEST_F(LampCalibrationTest, ImagesWithoutHighlightsAreLeftOutAndNamed) {
    options_.images = root_ / "images";
    fs::create_directories(options_.images);
    for (const char* name : {"00.png", "01.png", "02.png", "03.png", "04.png", "06.png", "07.png"})
        fs::create_symlink(images() / name, options_.images / name);
    // As if the lamp's mirror image were covered.
    std::vector<uint16_t> stored;
    for (const float v : dome().image(5).values)
        stored.push_back(uint16_t(std::lround(65535 * std::min(0.3, double(v)))));
    write_bytes(options_.images / "05.png", encode_png(dome().width, dome().height, 1, 16, stored));
    give_circles(2);
    name_images(8);
    write_bytes(options_.intensities = root_ / "power.txt", "1\n2\n3\n4\n5\n6\n7\n8\n");
    const Dataset set = import();
    expect_in("05.png", fmt::format("{}", fmt::join(report_.notes, "\n")));
    for (const View& view : set.views) {
        EXPECT_NE(view.name, "05.png");
        EXPECT_EQ(view.light->intensity, Vec3d::Constant(double(number_of(view) + 1)));  // its own line's
        EXPECT_GT(view.light->place.norm(), 900);                                        // in pixels
    }
    EXPECT_EQ(read_table(set.folder / "lamps.csv")[1][10], "");  // nothing was found of intensities

    fs::remove_all(root_ / "set");
    write_bytes(options_.names = root_ / "names.txt", "05.png\n00.png\n01.png\n");
    options_.intensities.clear();
    expect_in("the lamps of only 2 of 3 images are seen on two spheres", refused());
}

/// 9 degrees off the axis it sees spheres as ellipses, and their highlights elsewhere.
TEST_F(LampCalibrationTest, ANearCameraSeesSpheresAslant) {
    LampDome near(12);
    near.eye = Vec3d(0.15, -0.1, 2.2);
    write_dome(near, options_.images = root_ / "images");
    options_.spheres = "auto";
    options_.sample_width = 1;
    write_bytes(options_.camera_positions = root_ / "eye.txt",
                fmt::format("{}\n", fmt::join(std::span(near.eye->data(), 3), " ")));
    const Dataset set = import();
    ASSERT_GE(set.views.size(), near.lamps.size() - 1);
    expect_true_lamps(set, near, 2);
}

/// Lamps far away; all that is known of them is off by three degrees.
TEST_F(LampCalibrationTest, TheSurfaceCorrectsLampsThatAreRoughlyKnown) {
    LampDome far(16, 1, 1000);
    far.width = 240;
    far.height = 180;
    far.pixel = 1.0 / 240;
    far.spheres.clear();
    write_dome(far, options_.images = root_ / "images");
    std::mt19937 random(4);
    std::normal_distribution<double> off(0, 3 * M_PI / 180);
    std::vector<Vec3d> said;
    std::string lines;
    for (const Light& lamp : far.lamps) {
        const Vec3d d = lamp.place.normalized(), across = d.cross(Vec3d(0.3, -0.2, 0.9)).normalized();
        const double a = off(random), b = off(random);
        said.push_back((d + a * across + b * d.cross(across)).normalized());
        lines += fmt::format("{} {} {}\n", said.back().x(), said.back().y(), said.back().z());
    }
    write_bytes(options_.lights = root_ / "lights.txt", lines);
    options_.refine_lamps = 3;
    const Dataset set = import();
    ASSERT_EQ(set.views.size(), far.lamps.size());
    double before = 0, after = 0;
    std::vector<double> covered;
    const auto table = read_table(set.folder / "lamps.csv");
    for (size_t i = 0; i < set.views.size(); ++i) {
        const double now = degrees_apart(set.views[i].light->place, far.lamps[i].place);
        before += std::pow(degrees_apart(said[i], far.lamps[i].place), 2);
        after += std::pow(now, 2);
        covered.push_back(now / std::sqrt(2.0) / number_in(table, i + 1, "degrees"));
        EXPECT_EQ(table[i + 1][1], "direction");
    }
    EXPECT_LT(after, 0.5 * before);
    expect_errors_covered(covered, "directions");
    EXPECT_FALSE(fs::exists(set.folder / "lamps.png"));

    fs::remove_all(root_ / "set");
    options_.refine_lamps = 0;
    options_.spheres = "auto";
    options_.lights.clear();
    expect_in("images: no glossy sphere was found in these images: say where one is ('spheres' FILE", refused());
}

TEST_F(LampCalibrationTest, CirclesAndOptionsAreChecked) {
    const auto with = [&](const std::string& text) {
        write_bytes(options_.spheres = root_ / "circles.txt", text);
        return refused();
    };
    expect_in("circles.txt: holds no circle", with("# none\n"));
    expect_in("circles.txt:1: a circle takes three numbers, here are 2", with("140 580\n"));
    expect_in("circles.txt:1: the circle's radius is 0", with("140 580 0\n"));
    expect_in("circles.txt:2: the circle at (950, 700) of radius 80 is not within the images' 960 x 720 pixels",
              with("140 580 80\n950 700 80\n"));
    expect_in("circles.txt:2: the circle at (150, 580) overlaps the one at (140, 580)",
              with("140 580 80\n150 580 70\n"));
    expect_in("the lamps of only 0 of 24 images are seen on the spheres", with("480 360 40\n"));
    options_.spheres = "auto:none";
    expect_in("auto:N = 'none'", refused());
    options_.spheres = "auto";
    options_.refine_lamps = 2;
    expect_in("'refine_lamps' means nothing with 'spheres'", refused());
    options_.refine_lamps = 0;
    options_.sphere_radius = options_.sample_width = 3;
    expect_in("'sphere_radius' says how large things are by the spheres", refused());
    options_.sample_width = 0;
    write_bytes(options_.camera_positions = root_ / "eyes.txt", "0 0 3\n0 0 3\n");
    expect_in("eyes.txt: 2 camera positions, but spheres", refused());
}

}  // namespace
}  // namespace radiafit
