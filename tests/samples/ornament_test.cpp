// The ornament: what it is made of, and that a sample is what the truth says of the texel that takes it.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "dataset/image_stream.h"
#include "dataset/truth.h"
#include "samples/raster_distributor.h"
#include "synthetic/closed_mesh.h"
#include "synthetic/moving_lights.h"
#include "synthetic/ornament_pattern.h"
#include "synthetic/synthetic.h"
#include "synthetic/viewpoints.h"
#include "temporary_folder.h"

namespace radiafit {
namespace {
namespace fs = std::filesystem;

class OrnamentTest : public ::testing::Test {
protected:
    OrnamentTest() { set_quiet(true); }
    ~OrnamentTest() override { set_thread_count(0); }

    fs::path generate(const OrnamentOptions& options, uint64_t seed = 1, const std::string& name = "set") const {
        generate_synthetic({.shape = "ornament", .scale = "smoke", .seed = seed, .ornament = options},
                           folder_.path() / name);
        return folder_.path() / name;
    }
    /// Every file of a dataset.
    static std::map<std::string, std::string> bytes_of(const fs::path& dataset) {
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(dataset)) {
            std::ostringstream text;
            text << std::ifstream(entry.path(), std::ios::binary).rdbuf();
            files[entry.path().filename().string()] = text.str();
        }
        return files;
    }
    TemporaryFolder folder_;
};

Sensor stores(Encoding encoding) { return {.encoding = encoding}; }

/// The formulas of docs/formats.md in the texel's frame.
Vec3d expected_radiance(const std::string& model, const std::array<float, 9>& p, const Vec3d& u, const Vec3d& v) {
    double first = 0, second = 0;
    if (model == "lafortune") {
        const double d = double(p[6]) * (u.x() * v.x() + u.y() * v.y()) + double(p[7]) * u.z() * v.z();
        first = u.z();
        second = d < 1e-4 ? 0 : std::pow(d, double(p[8]));
    } else {
        const double variance = double(p[6]) * double(p[6]), e = double(p[8]);
        const double theta_u = std::acos(u.z()), theta_v = std::acos(v.z());
        const double phi = std::atan2(u.y(), u.x()) - std::atan2(v.y(), v.x());
        first = u.z() * (1 - 0.5 * variance / (variance + 0.33) +
                         0.45 * variance / (variance + 0.09) * std::max(0.0, std::cos(phi)) *
                             std::sin(std::max(theta_u, theta_v)) * std::tan(std::min(theta_u, theta_v)));
        second = (e + 2) * (e + 4) / (8 * (std::pow(2, -e / 2) + e)) * std::pow((u + v).normalized().z(), e) * u.z();
    }
    return {double(p[0]) * first + double(p[3]) * second, double(p[1]) * first + double(p[4]) * second,
            double(p[2]) * first + double(p[5]) * second};
}

struct Agreement {
    double largest = 0, mean = 0;   ///< difference of a sample's channel from the truth
    std::vector<uint32_t> samples;  ///< [texels] of those with u_z, v_z > 0
    std::map<std::string, size_t> by_material;
    size_t black = 0, below = 0;  ///< samples with u_z <= 0; of these, not black
};

/// Every sample that the distributor hands a texel, against the texel's truth.
Agreement compare(const fs::path& folder) {
    const Dataset dataset = open_dataset(folder);
    const ReflectanceTruth truth = read_truth(folder);
    const TriangleAtlas atlas = reflectance_atlas(dataset, truth.side);
    RasterDistributor distributor(atlas);
    ImageStream stream(dataset, StreamSource::disk, TargetSpace::linear);
    TargetImage image;
    Distribution distribution;
    std::vector<float> values;
    Agreement a;
    a.samples.assign(atlas.texel_count(), 0);
    double sum = 0, count = 0;
    for (uint32_t view = 0; view < dataset.views.size(); ++view) {
        const Camera& camera = dataset.views[view].camera;
        const Light& light = *dataset.views[view].light;
        stream.load(view, image);
        stream.load_values(view, values);
        distributor.distribute(camera, image, distribution);
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
            const uint32_t pixel = distribution.texel_pixel[texel];
            if (pixel == no_pixel) continue;
            const Vec3d x = atlas.position(texel).cast<double>();
            const Frame frame = make_frame(atlas.normal(texel));
            const auto local = [&](const Vec3d& d) {
                return Vec3d(frame.tangent.cast<double>().dot(d), frame.bitangent.cast<double>().dot(d),
                             frame.normal.cast<double>().dot(d));
            };
            double strength = 1;
            Vec3d to_light = light.place;
            if (light.kind == Light::Kind::near) {
                to_light = light.place - x;
                strength = 1 / to_light.squaredNorm();
                to_light.normalize();
            }
            const Vec3d u = local(to_light), v = local((camera.center() - x).normalized());
            const Vec3f seen(values[3 * pixel], values[3 * pixel + 1], values[3 * pixel + 2]);
            if (u.z() <= 0) {
                ++a.black;
                a.below += seen.isZero() ? 0 : 1;
            }
            if (u.z() < 1e-6 || v.z() < 1e-6) continue;
            ++a.samples[texel];
            const TruthMaterial& material = truth.materials[truth.material[texel]];
            ++a.by_material[material.name];
            const Vec3d expected = strength * light.intensity.cwiseProduct(
                                                  expected_radiance(material.model, truth.parameters[texel], u, v));
            for (int c = 0; c < 3; ++c) {
                const double difference = std::abs(double(seen[c]) - expected[c]);
                a.largest = std::max(a.largest, difference);
                sum += difference;
                count += 1;
            }
        }
    }
    a.mean = sum / count;
    return a;
}

TEST_F(OrnamentTest, SamplesAreTheirTexelsTruthToFloatRounding) {
    for (const Light::Kind kind : {Light::Kind::distant, Light::Kind::near}) {
        Agreement a = compare(generate({.sensor = stores(Encoding::f32_linear), .light = kind}));
        // Frames, acos and a power of up to 50 in the test's own arithmetic; values are at most 1 and stored as float.
        EXPECT_LT(a.largest, 5e-6);
        EXPECT_LT(a.mean, 2e-7);
        EXPECT_GT(a.black, 1000u);
        EXPECT_EQ(a.below, 0u);
        for (const char* material : ornament_material_names) EXPECT_GT(a.by_material[material], 20000u) << material;
        std::nth_element(a.samples.begin(), a.samples.begin() + ptrdiff_t(a.samples.size() / 2), a.samples.end());
        EXPECT_GE(a.samples[a.samples.size() / 2], 40u) << "of the median texel, for nine parameters";
    }
}

TEST_F(OrnamentTest, SixteenBitsRoundTheTruth) {
    const Agreement a = compare(generate({}));
    EXPECT_LT(a.largest, 0.5 / 65535 + 5e-6);
    EXPECT_NEAR(a.mean, 0.25 / 65535, 0.02 / 65535) << "of a uniform error of half a step at most";
}

TEST_F(OrnamentTest, PixelsThatAverageAreOnlyAboutTheTruth) {
    const fs::path folder = generate({.sensor = stores(Encoding::f32_linear), .shading = Shading::pixel});
    EXPECT_FALSE(read_truth(folder).exact);
    EXPECT_TRUE(read_truth(generate({}, 1, "exact")).exact);
    const Agreement a = compare(folder);
    EXPECT_GT(a.mean, 1e-3);
    EXPECT_LT(a.mean, 0.1);
}

TEST_F(OrnamentTest, TruthIsInTheCanonicalGaugeWithinBoundsAndVaries) {
    const Mesh mesh = wrap_solid(ornament_solid(), {0, 0, 0}, 1280);
    const TriangleAtlas atlas(mesh, 8);
    const OrnamentPattern pattern(3);
    std::map<OrnamentMaterial, std::vector<TexelParameters>> by_material;
    double turned = 0;
    size_t neighbours = 0;
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        const Vec3d x = atlas.position(t).cast<double>();
        const OrnamentMaterial material = pattern.at(x).material;
        const TexelParameters p = pattern.parameters(x);
        by_material[material].push_back(p);
        for (size_t c = 0; c < 3; ++c) {
            ASSERT_GE(p[c], 0);
            ASSERT_GT(p[3 + c], 0);
            ASSERT_LE(p[c] + p[3 + c], 1) << "or a sensor whose white is 1 would clip it";
        }
        if (model_of(material) == ReflectanceModel::lafortune) {
            ASSERT_EQ(std::max(std::abs(p[6]), std::abs(p[7])), 1);
            ASSERT_TRUE(p[6] < 0 && p[7] > 0 && p[8] >= 4 && p[8] <= 60);
        }
        const auto normal = [&](uint32_t texel) {
            return pattern.normal(atlas.position(texel).cast<double>(), atlas.normal(texel).cast<double>(), 5e-3);
        };
        ASSERT_NEAR(normal(t).norm(), 1, 1e-12);
        ASSERT_GT(normal(t).dot(atlas.normal(t).cast<double>()), 0.6);
        if (t % atlas.texels_per_tile() != 0) {  // mostly the next in the same row
            turned += std::acos(std::min(1.0, normal(t).dot(normal(t - 1))));
            ++neighbours;
        }
    }
    EXPECT_GT(turned / double(neighbours) * 180 / std::numbers::pi, 8) << "degrees between a triangle's texels";
    for (const auto& [material, all] : by_material) {
        EXPECT_GT(double(all.size()) / atlas.texel_count(), 0.15) << ornament_material_names[size_t(material)];
        for (size_t k = 0; k < 9; ++k) {
            double sum = 0, squares = 0;
            for (const TexelParameters& p : all) sum += double(p[k]), squares += double(p[k]) * double(p[k]);
            const double mean = sum / double(all.size());
            const double spread = std::sqrt(std::max(0.0, squares / double(all.size()) - mean * mean));
            // The gauge fixes one of Cx and Cz; white leaves one number unused.
            const bool fixed = material == OrnamentMaterial::gold ? k == 6 : k == 7;
            if (!fixed) {
                EXPECT_GT(spread, 0.015 * std::abs(mean)) << ornament_material_names[size_t(material)] << " " << k;
            }
        }
    }
    EXPECT_EQ(by_material.size(), 3u);
}

TEST_F(OrnamentTest, SeedsReproduceByteForByteAndDiffer) {
    const OrnamentOptions noisy = {.sensor = {Encoding::u8_srgb, 0.01, 0.02}};
    set_thread_count(1);
    const auto one = bytes_of(generate(noisy, 5));
    set_thread_count(3);
    EXPECT_EQ(bytes_of(generate(noisy, 5)), one);
    const auto other = bytes_of(generate(noisy, 6));
    ASSERT_EQ(other.size(), one.size());
    for (const char* file : {"images.bin", "normals.f32", "truth_parameters.f32", "truth_material.u8"})
        EXPECT_NE(other.at(file), one.at(file)) << file;
    // The noise alone: another seed for the same light.
    const std::vector<Vec3f> grey(1000, Vec3f::Constant(0.5f));
    std::vector<uint8_t> a, b, c;
    noisy.sensor.expose(grey, 5, 0, a);
    noisy.sensor.expose(grey, 6, 0, b);
    noisy.sensor.expose(grey, 5, 1, c);
    EXPECT_NE(a, b);
    EXPECT_NE(a, c);
}

TEST(OrnamentScale, IsThePapers) {
    const SyntheticSize size = synthetic_size({.shape = "ornament", .scale = "paper"});
    EXPECT_EQ(size.triangles, 3690);
    const Mesh mesh = wrap_solid(ornament_solid(), {0, 0, 0}, size.triangles);
    EXPECT_EQ(mesh.triangle_count(), 3690u);
    EXPECT_TRUE(find_defects(mesh).degenerate_triangles.empty());
    const TriangleAtlas atlas(mesh, size.surface_side);
    EXPECT_EQ(atlas.texels_per_tile(), 136u);
    EXPECT_EQ(atlas.texel_count(), 501840u);
    const double bytes = double(size.views) * size.side * size.side * 3 * bytes_per_channel(Encoding::u16_linear);
    EXPECT_NEAR(bytes, 0.98e9, 0.02 * 0.98e9);
    // Finer than the images (Section 5.1.1), but not so fine that texels go without.
    for (const char* scale : {"smoke", "standard", "paper"}) {
        const SyntheticSize s = synthetic_size({.shape = "ornament", .scale = scale});
        const double texels = s.triangles * s.surface_side * (s.surface_side + 1) / 2.0,
                     pixels = double(s.side) * s.side;
        EXPECT_GT(texels / 2, 0.5 * pixels) << scale;
        EXPECT_GT(0.5 * pixels * s.views / texels, 60) << scale;
    }
}

TEST(Sensor, NoiseHasTheStatedVariance) {
    const Sensor sensor = {Encoding::f32_linear, 0.01, 0.03};
    const size_t pixels = 60000;
    for (const float level : {0.0f, 0.1f, 0.5f, 1.0f}) {
        std::vector<uint8_t> bytes;
        sensor.expose(std::vector<Vec3f>(pixels, Vec3f::Constant(level)), 7, 3, bytes);
        const auto* values = reinterpret_cast<const float*>(bytes.data());
        const double variance = 1e-4 + 9e-4 * double(level);
        double sum = 0, squares = 0, fourth = 0, between = 0;
        for (size_t i = 0; i < 3 * pixels; ++i) {
            const double z = (double(values[i]) - double(level)) / std::sqrt(variance);
            sum += z;
            squares += z * z;
            fourth += z * z * z * z;
            if (i > 0) between += z * (double(values[i - 1]) - double(level)) / std::sqrt(variance);
        }
        const double n = double(3 * pixels), deviation = 1 / std::sqrt(n);
        EXPECT_NEAR(sum / n, 0, 5 * deviation);
        EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2.0) * deviation);
        EXPECT_NEAR(fourth / n, 3, 5 * std::sqrt(96.0) * deviation) << "Gaussian";
        EXPECT_NEAR(between / n, 0, 5 * deviation) << "channels and pixels are independent";
    }
}

TEST(Sensor, QuantizationErrsUniformlyByHalfAStepAtMost) {
    Rng rng(5);
    std::vector<Vec3f> linear(50000);
    for (Vec3f& x : linear) x = {rng.uniform(), rng.uniform(), rng.uniform()};
    for (const Encoding encoding : {Encoding::u8_srgb, Encoding::u16_linear}) {
        std::vector<uint8_t> bytes;
        Sensor{encoding, 0, 0}.expose(linear, 1, 0, bytes);
        const bool narrow = encoding == Encoding::u8_srgb;
        const double step = narrow ? 1 / 255.0 : 1 / 65535.0;
        double squares = 0;
        for (size_t i = 0; i < 3 * linear.size(); ++i) {
            const double stored = narrow ? bytes[i] : reinterpret_cast<const uint16_t*>(bytes.data())[i];
            const double error = stored * step - encode(encoding, double(linear[i / 3][Eigen::Index(i % 3)]));
            ASSERT_LE(std::abs(error), 0.5 * step * (1 + 1e-9));
            squares += error * error;
        }
        const double variance = squares / double(3 * linear.size());
        EXPECT_NEAR(variance, step * step / 12, 0.03 * step * step / 12) << to_string(encoding);
    }
    // What the encoding cannot hold is cut off, but for floats.
    const std::vector<Vec3f> beyond = {Vec3f(-0.5f, 1.5f, 0.25f)};
    std::vector<uint8_t> bytes;
    Sensor{Encoding::u8_srgb, 0, 0}.expose(beyond, 1, 0, bytes);
    EXPECT_EQ(bytes[0], 0);
    EXPECT_EQ(bytes[1], 255);
    Sensor{Encoding::f32_linear, 0, 0}.expose(beyond, 1, 0, bytes);
    EXPECT_EQ(reinterpret_cast<const float*>(bytes.data())[0], -0.5f);
    EXPECT_EQ(reinterpret_cast<const float*>(bytes.data())[1], 1.5f);
}

TEST(MovingLights, StandOnTheCamerasSideAndNeverOverexpose) {
    const Mesh mesh = wrap_solid(ornament_solid(), {0, 0, 0}, 320);
    const std::vector<Camera> cameras = sphere_cameras(mesh, 300, 64, 2);
    double radius = 0;
    for (const Vec3f& p : mesh.positions) radius = std::max(radius, double(p.norm()));
    for (const Light::Kind kind : {Light::Kind::distant, Light::Kind::near}) {
        const std::vector<Light> lights = moving_lights(cameras, kind, radius, 2);
        ASSERT_EQ(lights.size(), cameras.size());
        double mean_cosine = 0;
        Vec3d middle = Vec3d::Zero();
        for (size_t i = 0; i < lights.size(); ++i) {
            check_light(lights[i], "light");
            const double cosine = lights[i].place.normalized().dot(cameras[i].center().normalized());
            EXPECT_GE(cosine, std::cos(widest_light * std::numbers::pi / 180) - 1e-9);
            mean_cosine += cosine / double(lights.size());
            middle += lights[i].place.normalized() / double(lights.size());
            for (const Vec3f& p : mesh.positions) {
                const Vec3d irradiance = lights[i].irradiance_at(p.cast<double>());
                EXPECT_LE(irradiance.maxCoeff(), 1 + 1e-9);
                EXPECT_GE(irradiance.minCoeff(), 0.25);
            }
        }
        // Even in solid angle: the cosine is uniform.
        EXPECT_NEAR(mean_cosine, 0.5 * (1 + std::cos(widest_light * std::numbers::pi / 180)), 0.02);
        EXPECT_LT(middle.norm(), 0.1) << "from all sides";
    }
}

TEST(OrnamentOptions, MistakesAreOneLine) {
    TemporaryFolder folder;
    const auto complaint = [&](const SyntheticOptions& options) {
        try {
            generate_synthetic(options, folder.path() / "set");
        } catch (const UserError& error) {
            EXPECT_FALSE(fs::exists(folder.path() / "set"));
            return std::string(error.what());
        }
        return std::string();
    };
    SyntheticOptions star = {.shape = "star"};
    star.ornament.light = Light::Kind::near;
    EXPECT_NE(complaint(star).find("leave these options out"), std::string::npos);
    SyntheticOptions options = {.shape = "ornament"};
    options.ornament.sensor.read_noise = -0.1;
    EXPECT_NE(complaint(options).find("[0, 1]"), std::string::npos);
    options.ornament.sensor = stores(Encoding::f16_linear);
    EXPECT_NE(complaint(options).find("not f16-linear"), std::string::npos);
    EXPECT_THROW(read_truth(folder.path()), UserError);
}

}  // namespace
}  // namespace radiafit
