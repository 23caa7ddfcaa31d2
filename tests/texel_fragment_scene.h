#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "fragment/gl_distributor.h"
#include "gl_scene.h"
#include "loss_oracle.h"
#include "model/texel_local.h"
#include "model/texel_options.h"
#include "model/texel_texts.h"
#include "temporary_folder.h"

/// Images of noise under a lamp each, over a mesh or a grid, and what they say of each texel in double.
namespace radiafit::testing {

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

/// What a sample says, in double.
template <class Text>
struct ExactSample {
    typename Text::Terms terms;
    std::array<double, 3> target;
    double cosine;  ///< u_z
    double facing;  ///< v_z
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
    using real3 = typename Text::real3;
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
            const Vec3d x = atlas.position(texel).cast<double>();
            const Frame frame = make_frame(atlas.normal(texel));
            const auto local = [&](const Vec3d& d) {
                return real3{frame.tangent.cast<double>().dot(d), frame.bitangent.cast<double>().dot(d),
                             frame.normal.cast<double>().dot(d)};
            };
            const real3 u = local(view.light->direction_from(x)), to_camera = local(view.direction_to_camera(x));
            const auto channels = image.channel16(pixel);
            bool counts = u.z > 0 && to_camera.z > 0;
            ExactSample<Text> s{Text::sample_terms(u, to_camera), {}, u.z, to_camera.z};
            for (size_t c = 0; c < 3; ++c) {
                const float value = float(channels[c]) * image.scale16();
                counts = counts && !(options.clip_above > 0 && value >= options.clip_above);
                s.target[c] =
                    double(channels[c]) * double(image.scale16()) / view.light->irradiance_at(x)[Eigen::Index(c)];
            }
            if (counts) out[texel].push_back(s);
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

/// A sum, and that of its terms' magnitudes.
struct ExactSum {
    double value = 0, magnitude = 0;
    void add(double term, double size) { value += term, magnitude += size; }
    void add(double term) { add(term, std::abs(term)); }
};

/// Everything that an engine's passes say of one texel, over its samples' number, penalties included.
template <class Text>
struct ExactTexel {
    using Model = TexelLocal<Text>;
    ExactSum error, gauss_newton, curvature;
    std::array<ExactSum, size_t(Model::parameters)> gradient, diagonal;

    /// What a quantity can be taken for: its value, and what terms that are wrong by 5e-7 make of it. They are products
    /// of 32-bit unit vectors; grazing directions and steep lobes magnify that.
    template <class Of>
    static auto sizes(const typename Text::Terms& terms, const Of& of) {
        auto size = of(terms);
        for (double& x : size) x = std::abs(x);
        constexpr double step = 1e-6, share = 5e-7 / 1e-5;  // of the tolerance
        for (int j = 0; j < Text::term_count; ++j) {
            auto above = terms, below = terms;
            above.x[j] += step;
            below.x[j] -= step;
            const auto up = of(above), down = of(below);
            for (size_t i = 0; i < size.size(); ++i) size[i] += share * std::abs(up[i] - down[i]) / (2 * step);
        }
        return size;
    }

    ExactTexel(const std::vector<ExactSample<Text>>& samples, const TexelOptions& options,
               const typename Model::Parameters& p, const typename Model::Parameters& d) {
        constexpr int B = Model::basis, Q = Model::shape;
        const double per_sample = samples.empty() ? 0 : 1 / double(samples.size());
        for (const ExactSample<Text>& s : samples) {
            const auto columns_at = [&](const auto& terms) { return Model::columns(Model::shape_of(p), terms); };
            const auto bend_at = [&](const auto& terms) {
                const auto bend = Model::bend(p, d, terms);
                return std::array<double, 6>{bend.first[0],  bend.first[1],  bend.first[2],
                                             bend.second[0], bend.second[1], bend.second[2]};
            };
            const auto columns = columns_at(s.terms), column_size = sizes(s.terms, columns_at);
            const auto bend = bend_at(s.terms), bend_size = sizes(s.terms, bend_at);
            const auto value = Model::value(p, s.terms);
            std::array<double, 3> residual, residual_size;
            double squared = 0, squared_size = 0;
            for (size_t c = 0; c < 3; ++c) {
                residual[c] = value[c] - s.target[c];
                residual_size[c] = s.target[c];
                for (size_t k = 0; k < size_t(B); ++k) residual_size[c] += std::abs(p[3 * k + c]) * column_size[k];
                squared += residual[c] * residual[c], squared_size += residual_size[c] * residual_size[c];
            }
            const double weight = options.loss.weights == SampleWeights::facing ? s.facing : 1;
            // a weight that is wrong by 5e-7
            const double sure = 1 + (options.loss.weighted() ? 0.05 / weight : 0);
            const LossOracle loss(options.loss, std::sqrt(weight * squared), std::sqrt(weight * squared_size));
            const double each = per_sample * weight * loss.weight, uncertain = each * (sure + loss.sensitivity);
            error.add(per_sample * loss.value, 0.5 * squared_size * uncertain);
            for (size_t c = 0; c < 3; ++c) {
                const double r = residual[c], size = residual_size[c];
                double first_size = bend_size[c];
                for (size_t k = 0; k < size_t(B); ++k) first_size += std::abs(d[3 * k + c]) * column_size[k];
                const double first = bend[c], second = bend[3 + c], second_size = bend_size[3 + c];
                gauss_newton.add(each * first * first, uncertain * first_size * first_size);
                curvature.add(each * (first * first + r * second),
                              uncertain * (first_size * first_size + size * second_size));
                for (size_t k = 0; k < size_t(B); ++k) {
                    gradient[3 * k + c].add(each * r * columns[k], uncertain * size * column_size[k]);
                    diagonal[3 * k + c].add(each * columns[k] * columns[k],
                                            uncertain * column_size[k] * column_size[k]);
                }
                const double last = p[3 * size_t(B - 1) + c];
                for (size_t i = 0; i < size_t(Q); ++i) {
                    const double column = last * columns[size_t(B) + i],
                                 of_size = std::abs(last) * column_size[size_t(B) + i];
                    gradient[3 * size_t(B) + i].add(each * r * column, uncertain * size * of_size);
                    diagonal[3 * size_t(B) + i].add(each * column * column, uncertain * of_size * of_size);
                }
            }
        }
        for (size_t i = 0; i < p.size(); ++i) {
            const double a = Model::bounds(int(i))[0], b = Model::bounds(int(i))[1], mu = double(options.mu);
            if (p[i] >= a && p[i] <= b) continue;
            const double beyond = p[i] < a ? p[i] - a : p[i] - b;
            const bool paper = options.mode == Mode::paper;
            error.add(mu * (paper ? (p[i] - a) * (p[i] - b) : 0.5 * beyond * beyond));
            gradient[i].add(mu * (paper ? 2 * p[i] - a - b : beyond));
            const double second = mu * (paper ? 2 : 1) * d[i] * d[i];
            gauss_newton.add(second);
            curvature.add(second);
        }
        double largest = 0, largest_size = 0;
        for (const ExactSum& sum : diagonal) {
            largest = std::max(largest, sum.value);
            largest_size = std::max(largest_size, sum.magnitude);
        }
        for (ExactSum& sum : diagonal) {
            sum.value = std::max(sum.value, 1e-4 * largest + 1e-30);
            sum.magnitude = std::max({sum.magnitude, sum.value, 1e-4 * largest_size});
        }
    }
};

}  // namespace radiafit::testing
