#pragma once
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <random>

#include "capture/import_lights.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"

namespace radiafit::testing {
using namespace tools;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

/// A Lambertian sphere under ten lamps, and the files that `import lights` takes of it.
class LightsTest : public FolderTest {
protected:
    static constexpr int width = 24, height = 20, count = 10;
    static constexpr size_t pixels = size_t(width) * height;

    LightsTest() {
        options_.images = root_ / "images";
        options_.lights = root_ / "lights.txt";
        std::mt19937 random(5);
        const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
        for (int i = 0; i < count; ++i) {
            lights_.push_back(Vec3d(uniform(-1, 1), uniform(-1, 1), uniform(0.3, 1)).normalized());
            intensities_.push_back({uniform(0.5, 1), uniform(0.5, 1), uniform(0.5, 1)});
        }
        for (size_t p = 0; p < pixels; ++p) {
            // The upper half of a sphere of radius 9 around the images' middle; y is up, rows go down.
            const double x = (double(p % width) + 0.5 - width / 2.0) / 9,
                         y = (height / 2.0 - double(p / width) - 0.5) / 9;
            const bool inside = x * x + y * y < 1;
            inside_.push_back(inside);
            normals_.push_back(inside ? Vec3f(float(x), float(y), float(std::sqrt(1 - x * x - y * y))) : Vec3f::Zero());
            albedo_.push_back({uniform(0.1, 1), uniform(0.1, 1), uniform(0.1, 1)});
        }
    }

    Vec3d radiance(int light, size_t pixel) const {
        const double cosine = std::max(0.0, normals_[pixel].cast<double>().dot(lights_[size_t(light)]));
        return cosine * albedo_[pixel].cwiseProduct(intensities_[size_t(light)]);
    }
    std::vector<float> linear_image(int light) const {
        std::vector<float> values;
        for (size_t p = 0; p < pixels; ++p)
            for (int c = 0; c < 3; ++c) values.push_back(float(radiance(light, p)[c]));
        return values;
    }
    static std::vector<uint16_t> rounded(const std::vector<float>& values, double largest) {
        std::vector<uint16_t> stored;
        for (const float v : values) stored.push_back(static_cast<uint16_t>(std::lround(largest * double(v))));
        return stored;
    }
    static std::string name(int i, const char* ending = ".png") { return fmt::format("{:02}{}", i, ending); }

    void write_text() {
        std::string lights, intensities;
        for (int i = 0; i < count; ++i) {
            const Vec3d &l = lights_[size_t(i)], &e = intensities_[size_t(i)];
            lights += fmt::format("{} {} {}\n", 7 * l.x(), 7 * l.y(), 7 * l.z());  // any length will do
            intensities += fmt::format("{}, {}, {}\n", e.x(), e.y(), e.z());
        }
        write_bytes(options_.lights, "# towards the lamps\n" + lights);
        write_bytes(options_.intensities = root_ / "intensities.txt", intensities);
    }
    void write_shape() {
        std::vector<float> normals;
        std::vector<uint16_t> mask;
        for (size_t p = 0; p < pixels; ++p) {
            for (int c = 0; c < 3; ++c) normals.push_back(normals_[p][c]);
            mask.push_back(inside_[p] ? 255 : 0);
        }
        write_bytes(options_.normals = root_ / "normals.pfm", encode_pfm(width, height, normals));
        write_bytes(options_.mask = root_ / "mask.png", encode_png(width, height, 1, 8, mask));
    }
    /// The sphere under ten lamps, 16 bits.
    void write_sphere() {
        for (int i = 0; i < count; ++i)
            write_bytes(options_.images / name(i), encode_png(width, height, 3, 16, rounded(linear_image(i), 65535)));
        write_text();
        write_shape();
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

    LightImportOptions options_;
    LightImportReport report_;
    std::vector<Vec3d> lights_, intensities_, albedo_;
    std::vector<Vec3f> normals_;
    std::vector<bool> inside_;
};

}  // namespace radiafit::testing
