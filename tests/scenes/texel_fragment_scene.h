#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "bench/texel_oracle.h"
#include "fragment/gl_distributor.h"
#include "gl_scene.h"
#include "model/texel_options.h"
#include "model/texel_texts.h"
#include "temporary_folder.h"

/// Images of noise under a lamp each, over a mesh or a grid, and what they say of each texel in double.
namespace radiafit::testing {
using namespace harness;

/// The models of so many parameters at most; of the harmonics the largest of order 2 or 3.
inline std::vector<const TexelModel*> models_up_to(int parameters) {
    std::vector<const TexelModel*> models;
    for (const TexelModel* model : texel_models()) {
        const bool first_of_another = model->name == std::string_view("hsh2") && parameters >= 27;
        if (model->parameters <= std::min(parameters, 27) && !first_of_another) models.push_back(model);
    }
    return models;
}

struct TexelScene {
    bool grid = false;
    Light::Kind light = Light::Kind::distant;
    Encoding encoding = Encoding::u16_linear;
    int views = 7;
    bool one_eye = false;  ///< over a grid
};

/// A packed dataset, removed at the end.
class TexelDataset {
public:
    explicit TexelDataset(const TexelScene& scene) {
        constexpr int width = 150, height = 130, columns = 37, rows = 29;
        std::mt19937 rng(5);
        std::uniform_real_distribution<double> uniform(-1, 1);
        const auto any = [&] { return Vec3d(uniform(rng), uniform(rng), uniform(rng)); };
        const Mesh mesh = awkward_mesh(1);
        Dataset header;
        if (scene.grid) {
            header.grid = Grid::centered(columns, rows, 0.05);
            for (int i = 0; i < columns * rows; ++i)
                header.grid.texel_normals.push_back(
                    i % 11 == 3 ? Vec3f(0, 0, 0) : Vec3f((Vec3d::UnitZ() + 0.4 * any()).normalized().cast<float>()));
        } else {
            header.mesh = mesh;
        }
        header.name = "noise";
        header.encoding = scene.encoding;
        {
            DatasetWriter writer(folder_.path() / "noise");
            writer.set_encoding(scene.encoding);
            for (int i = 0; i < scene.views; ++i) {
                View view;
                view.name = "view" + std::to_string(i);
                Vec3d towards = (Vec3d::UnitZ() + 0.7 * any()).normalized();
                if (!scene.grid) {
                    view.camera = orbit_camera(i, scene.views, width + i % 3, height - i % 2);
                    towards = view.camera.center().normalized();
                } else if (scene.one_eye) {
                    view.camera = header.grid.camera_at(Vec3d(0.5, 0.2, 3), view.name);
                } else if (i % 2) {
                    view.camera = header.grid.camera_at(3 * towards, view.name);
                } else {
                    view.camera.width = columns;
                    view.camera.height = rows;
                    view.camera_direction = towards;
                }
                const Vec3d lamp = (towards + 0.5 * any()).normalized();
                const bool near = scene.light == Light::Kind::near;
                view.light = Light{scene.light, near ? Vec3d(2.5 * lamp) : lamp,
                                   (near ? 4.0 : 1.0) * (Vec3d::Ones() + 0.3 * any())};
                const size_t pixels = size_t(view.camera.width) * size_t(view.camera.height);
                std::vector<uint8_t> data(pixels * 3 * size_t(bytes_per_channel(scene.encoding))), mask(pixels);
                for (auto& byte : data) byte = uint8_t(rng());
                for (auto& byte : mask) byte = rng() % 10 != 0;
                writer.add(view, data.data(), mask);
            }
            writer.finish(header);
        }
        dataset = open_dataset(folder_.path() / "noise");
        for (uint32_t i = 0; i < uint32_t(scene.views); ++i) views.push_back(i);
        if (scene.grid)
            atlas = std::make_unique<GridAtlas>(make_atlas(dataset.grid));
        else
            atlas = std::make_unique<TriangleAtlas>(dataset.mesh, 7);
    }
    Dataset dataset;
    std::unique_ptr<Atlas> atlas;
    std::vector<uint32_t> views;

private:
    TemporaryFolder folder_;
};

/// sum t u_z / sum u_z^2
template <class Sample>
std::array<double, 3> exact_albedo(const std::vector<Sample>& samples) {
    std::array<double, 3> products{};
    double squares = 0;
    for (const Sample& s : samples) {
        for (size_t c = 0; c < 3; ++c) products[c] += s.target[c] * s.cosine;
        squares += s.cosine * s.cosine;
    }
    for (double& p : products) p = squares > 0 ? p / squares : 0;
    return products;
}

/// The samples of every texel by the rules of TexelOptions. A context must be current where the atlas is a mesh's.
template <class Text>
std::vector<std::vector<ExactSample<Text>>> exact_samples(const TexelDataset& data, const TexelOptions& options) {
    const Atlas& atlas = *data.atlas;
    std::vector<std::vector<ExactSample<Text>>> out(atlas.texel_count());
    std::optional<GlDistributor> distributor;
    if (const auto* triangles = dynamic_cast<const TriangleAtlas*>(&atlas)) distributor.emplace(*triangles);
    ImageStream stream(data.dataset, StreamSource::memory, TargetSpace::linear);
    TargetImage image;
    Distribution taken;
    for (const uint32_t v : data.views) {
        const View& view = data.dataset.views[v];
        stream.load(v, image);
        if (distributor) distributor->distribute(view.camera, image, taken);
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
            const uint32_t pixel = distributor                                             ? taken.texel_pixel[texel]
                                   : atlas.usable(texel) && image.masked_in(size_t(texel)) ? texel
                                                                                           : no_pixel;
            if (pixel == no_pixel) continue;
            std::array<double, 3> value;
            bool clipped = false;
            for (size_t c = 0; c < 3; ++c) {
                const auto channel = image.channel16(pixel)[c];
                value[c] = double(channel) * double(image.scale16());
                clipped = clipped || (options.clip_above > 0 && float(channel) * image.scale16() >= options.clip_above);
            }
            const ExactSample<Text> s(view, atlas, texel, value);
            if (s.above && !clipped) out[texel].push_back(s);
        }
    }
    if (options.shadow_below > 0)
        for (auto& samples : out) {
            const auto albedo = exact_albedo(samples);
            std::erase_if(samples, [&](const ExactSample<Text>& s) {
                return s.target[0] + s.target[1] + s.target[2] <
                       double(options.shadow_below) * (albedo[0] + albedo[1] + albedo[2]) * s.cosine;
            });
        }
    return out;
}

}  // namespace radiafit::testing
