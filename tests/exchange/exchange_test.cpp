// What other programs get of a fit: textures that don't bleed, polynomials that show what the fit shows, glTF whose
// numbers are where it says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/rng.h"
#include "exchange/gltf.h"
#include "exchange/padded_tiles.h"
#include "exchange/relight.h"
#include "image/image_file.h"
#include "mesh_shapes.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace tools;
namespace {

/// As a graphics chip looks a texture up linearly at (x, y), in texels from its top left corner.
float bilinear(const TextureImage& texture, float x, float y) {
    const auto at = [&](int column, int row) {
        column = std::clamp(column, 0, texture.width - 1);
        row = std::clamp(row, 0, texture.height - 1);
        return texture.values[size_t(row) * size_t(texture.width) + size_t(column)];
    };
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f), u = x - 0.5f - left, v = y - 0.5f - top;
    const int i = int(left), j = int(top);
    return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

TEST(PaddedTiles, NoTriangleBleedsIntoAnother) {
    for (const int side : {2, 3, 5, 12}) {
        const Mesh mesh = testing::ball(3);
        const TriangleAtlas atlas(mesh, side);
        std::vector<float> values(atlas.texel_count());
        for (uint32_t t = 0; t < atlas.texel_count(); ++t) values[t] = float(t / atlas.texels_per_tile() + 1);
        const PaddedTiles tiles(atlas);
        const TextureImage texture = tiles.bake(values, 1, SurfaceLookup::nearest);
        Rng rng(7);
        for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
            const auto corners = tiles.corners(t);
            for (int sample = 0; sample < 40; ++sample) {
                float b1 = rng.uniform(), b2 = rng.uniform();
                if (sample < 4) b1 = float(sample % 2), b2 = float(sample / 2);  // corners; one beyond, turned back
                if (b1 + b2 > 1) b1 = 1 - b1, b2 = 1 - b2;
                if (sample % 5 == 4) b2 = 1 - b1;  // on the diagonal
                float at[2];
                for (size_t c = 0; c < 2; ++c)
                    at[c] = corners[0][c] + b1 * (corners[1][c] - corners[0][c]) + b2 * (corners[2][c] - corners[0][c]);
                ASSERT_NEAR(bilinear(texture, at[0], at[1]), float(t + 1), 1e-3f * float(t + 1))
                    << "side " << side << ", triangle " << t << " at " << b1 << ", " << b2;
            }
        }
    }
}

TEST(PaddedTiles, AtlasCornersAreWhereTheAtlasPutsTexels) {
    const Mesh mesh = testing::ball(2);
    const auto sides = std::make_shared<std::vector<uint8_t>>(mesh.triangle_count());
    for (size_t t = 0; t < sides->size(); ++t) (*sides)[t] = uint8_t(2 + t % 5);
    for (const TriangleAtlas& atlas : {TriangleAtlas(mesh, 6), TriangleAtlas(mesh, 6, sides)})
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
            if (!atlas.usable(texel)) continue;
            const uint32_t t = texel / atlas.texels_per_tile();
            const auto [i, j] = atlas.tile(t).cell(texel % atlas.texels_per_tile());
            const auto corners = atlas_corners(atlas, t);
            const float b1 = (float(i) + 0.5f) / float(atlas.side(t)), b2 = (float(j) + 0.5f) / float(atlas.side(t));
            for (size_t c = 0; c < 2; ++c) {
                const float at =
                    corners[0][c] + b1 * (corners[1][c] - corners[0][c]) + b2 * (corners[2][c] - corners[0][c]);
                ASSERT_EQ(int(std::floor(at)), atlas.place(texel)[c]) << "texel " << texel;
            }
        }
}

TEST(SurfaceLook, RoughnessFallsWithTheExponent) {
    EXPECT_FLOAT_EQ(roughness_of(0), 1);
    // A Blinn-Phong lobe of exponent 4n has alpha^2 = 2 / (4n + 2), and roughness is the root of alpha.
    for (const double n : {1.0, 10.0, 200.0})
        EXPECT_NEAR(std::pow(double(roughness_of(n)), 4), 2 / (4 * n + 2), 1e-6) << n;
    EXPECT_LT(roughness_of(200), roughness_of(20));
}

/// A grid of so many texels, and a camera far above it.
Dataset flat_sample(int width, int height) {
    Dataset dataset;
    dataset.name = "flat";
    dataset.grid = Grid::centered(width, height, 1);
    View view;
    view.camera.width = width;
    view.camera.height = height;
    view.camera_direction = Vec3d::UnitZ();
    view.light = Light{};
    dataset.views = {view};
    return dataset;
}

/// sRGB values that are polynomials of the lamp's direction, another one in each pixel and channel.
double polynomial(size_t pixel, size_t channel, double x, double y) {
    const double p = double(pixel % 17) / 17, q = double(pixel % 5) / 5;
    return 0.4 + 0.1 * p + 0.05 * double(channel) + 0.15 * q * x + 0.2 * p * y - 0.1 * x * x + 0.05 * p * x * y -
           0.12 * y * y;
}

Contestant polynomials() {
    return {[](const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
                rgb.resize(3 * pixels.size());
                const Vec3d& lamp = view.light->place;
                for (size_t i = 0; i < rgb.size(); ++i)
                    rgb[i] = float(srgb_decode(polynomial(i / 3, i % 3, lamp.x(), lamp.y())));
            },
            TargetSpace::linear};
}

TEST(Relight, PolynomialsComeBack) {
    const Dataset dataset = flat_sample(19, 13);
    const Relight relight = relight_of(polynomials(), dataset, dataset.views[0], {});
    const auto info = nlohmann::json::parse(relight.info);
    EXPECT_EQ(info.at("width"), 19);
    EXPECT_EQ(info.at("height"), 13);
    const TemporaryFolder folder;
    std::vector<ImageFile> planes;
    for (const std::string& bytes : relight.planes) {
        write_file(folder.path() / "plane.jpg", bytes);
        planes.push_back(read_image(folder.path() / "plane.jpg"));
        ASSERT_EQ(planes.back().rgb8.size(), 3u * 19 * 13);
    }
    const auto& material = info.at("materials").at(0);
    double squares = 0;
    size_t count = 0;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.5, 0.2}, {-0.3, -0.6}}) {
        const double basis[] = {1, x, y, x * x, x * y, y * y};
        for (size_t i = 0; i < planes[0].rgb8.size(); ++i) {
            double value = 0;
            for (size_t k = 0; k < planes.size(); ++k)
                value += basis[k] * material.at("scale").at(3 * k + i % 3).get<double>() *
                         (planes[k].rgb8[i] / 255.0 - material.at("bias").at(3 * k + i % 3).get<double>());
            squares += std::pow(value - polynomial(i / 3, i % 3, x, y), 2);
            ++count;
        }
    }
    EXPECT_LT(std::sqrt(squares / double(count)), 0.006);  // two or three steps of 1/255 each of six planes, of JPEG
}

// What a viewer computes of the components: OpenLIME's bilinear interpolation between the lamps of its octahedral grid.
TEST(Relight, ComponentsComeBack) {
    const Dataset dataset = flat_sample(40, 31);
    const Relight relight =
        relight_of(polynomials(), dataset, dataset.views[0], {.basis = RelightOptions::Basis::bilinear, .planes = 9});
    const auto info = nlohmann::json::parse(relight.info);
    ASSERT_EQ(info.at("nplanes"), 9);
    const int across = info.at("resolution");
    const auto& material = info.at("materials").at(0);
    const auto basis = info.at("basis").get<std::vector<int>>();
    ASSERT_EQ(basis.size(), size_t(10 * 3 * across * across));
    const TemporaryFolder folder;
    std::vector<ImageFile> planes;
    for (const std::string& bytes : relight.planes) {
        write_file(folder.path() / "plane.jpg", bytes);
        planes.push_back(read_image(folder.path() / "plane.jpg"));
    }
    ASSERT_EQ(planes.size(), 3u);
    const auto at_node = [&](int plane, int node, int c) {
        const int byte = basis[size_t((plane * across * across + node) * 3 + c)];
        return plane == 0 ? byte / 255.0 : (byte - 127) / material.at("range").at(size_t(plane - 1)).get<double>();
    };
    double squares = 0;
    size_t count = 0;
    for (const auto& [lx, ly] : {std::pair{0.0, 0.0}, {0.5, 0.2}, {-0.3, -0.6}}) {
        const double lz = std::sqrt(1 - lx * lx - ly * ly), s = std::abs(lx) + std::abs(ly) + lz;
        const double x = ((lx + ly) / s + 1) / 2 * (across - 1), y = ((ly - lx) / s + 1) / 2 * (across - 1);
        const int sx = std::min(across - 2, int(x)), sy = std::min(across - 2, int(y));
        const auto weight = [&](int plane, int c) {
            double sum = 0;
            for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}})
                sum += (i ? x - sx : 1 - x + sx) * (j ? y - sy : 1 - y + sy) *
                       at_node(plane, sx + i + (sy + j) * across, c);
            return sum;
        };
        for (int c = 0; c < 3; ++c) {
            std::array<double, 10> w{};
            for (int plane = 0; plane < 10; ++plane) w[size_t(plane)] = weight(plane, c);
            for (size_t p = 0; p < 40 * 31; ++p) {
                double value = w[0];
                for (size_t k = 0; k < 9; ++k)
                    value += w[k + 1] * material.at("scale").at(k).get<double>() *
                             (planes[k / 3].rgb8[3 * p + k % 3] / 255.0 - material.at("bias").at(k).get<double>());
                squares += std::pow(value - polynomial(p, size_t(c), lx, ly), 2);
                ++count;
            }
        }
    }
    EXPECT_LT(std::sqrt(squares / double(count)), 0.008);
    EXPECT_THROW(
        relight_of(polynomials(), dataset, dataset.views[0], {.basis = RelightOptions::Basis::bilinear, .planes = 8}),
        UserError);
}

TEST(Relight, NeedsAGrid) {
    Dataset dataset;
    dataset.name = "ball";
    dataset.mesh = testing::ball(2);
    EXPECT_THROW(relight_of(polynomials(), dataset, View(), {}), UserError);
}

TEST(Gltf, ChunksAndBufferViewsLieWhereItSays) {
    Dataset dataset = flat_sample(4, 3);
    const GridAtlas atlas = make_atlas(dataset.grid);
    SurfaceLook look;
    look.atlas = {std::shared_ptr<const void>(), &atlas};
    look.base_colour.assign(12, Vec3f(0.5f, 0.25f, 2));
    look.roughness.assign(12, 0.5f);
    look.albedo = true;
    dataset.name = "named \xff \"so\"";  // neither UTF-8 nor free of quotes
    const std::string bytes = glb_of(look, dataset, "model", {{"a.exr", "abc"}, {"fit.json", "{}"}});
    uint32_t words[5];
    std::memcpy(words, bytes.data(), sizeof(words));
    EXPECT_EQ(words[0], 0x46546C67u);
    EXPECT_EQ(words[1], 2u);
    ASSERT_EQ(words[2], bytes.size());
    const auto json = nlohmann::json::parse(bytes.substr(20, words[3]));
    const size_t binary = 20 + words[3] + 8;
    EXPECT_EQ(binary % 4, 0u);
    size_t end = 0;
    for (const auto& view : json.at("bufferViews")) {
        EXPECT_EQ(view.at("byteOffset").get<size_t>() % 4, 0u);
        EXPECT_GE(view.at("byteOffset").get<size_t>(), end);
        end = view.at("byteOffset").get<size_t>() + view.at("byteLength").get<size_t>();
    }
    EXPECT_EQ(json.at("buffers").at(0).at("byteLength"), end);
    EXPECT_LE(binary + end, bytes.size());
    const auto& files = json.at("extras").at("radiafit").at("files");
    const auto& view = json.at("bufferViews").at(files.at(0).at("bufferView").get<size_t>());
    EXPECT_EQ(bytes.substr(binary + view.at("byteOffset").get<size_t>(), view.at("byteLength")), "abc");

    const TemporaryFolder folder;
    write_file(folder.path() / "ours.glb", bytes);
    write_file(folder.path() / "cut.glb", bytes.substr(0, 3));
    EXPECT_TRUE(is_our_glb(folder.path() / "ours.glb"));
    EXPECT_FALSE(is_our_glb(folder.path() / "cut.glb"));
    EXPECT_FALSE(is_our_glb(folder.path() / "none.glb"));
}

}  // namespace
}  // namespace radiafit
