#include "rti/rti_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/error.h"
#include "base/parallel.h"
#include "base/wording.h"
#include "geometry/direction_hull.h"
#include "lightbasis/light_basis.h"
#include "rti/hemisphere.h"

namespace radiafit::tools {
namespace {

using namespace fits;

/// x right, y up, z towards the camera.
Frame frame_of(const Grid& grid) {
    return {grid.right.normalized().cast<float>(), -grid.down.normalized().cast<float>(), grid.normal().cast<float>()};
}

/// What the record of every fit says; `training`: views that it could have been made of.
void describe(FitRecord& fit, const char* model, ValueCurve curve, const Atlas& atlas, const Dataset& dataset) {
    const auto training = uint32_t(dataset.split(false).size());
    fit.space = TargetSpace::linear;
    fit.solver = "imported";
    fit.engine = "none";
    fit.options_json = nlohmann::json{{"model", model}, {"curve", name_of(curve)}}.dump();
    const size_t texels = atlas.texel_count();
    fit.iterations.assign(texels, 0);
    fit.error.assign(texels, 0);
    for (uint32_t t = 0; t < texels; ++t) {
        fit.status.push_back(atlas.usable(t) ? Status::stationary : Status::no_samples);
        fit.samples.push_back(atlas.usable(t) ? training : 0);
    }
    set_dataset(fit, dataset);
}

/// [coefficients][functions] The model's coefficients, in a texel's frame, that show each of the file's functions.
Eigen::MatrixXf coefficients_of_functions(const RtiFile& file, const Frame& texel, const Frame& grid) {
    const TexelModel& model = *file.model;
    const std::vector<Vec3d> lamps = over_hemisphere(20 * size_t(model.basis));
    const auto rows = Eigen::Index(lamps.size());
    Eigen::MatrixXd ours(rows, model.basis), theirs(rows, Eigen::Index(file.numbers / 3));
    const std::vector<float> p(size_t(model.parameters), 0.0f);
    std::vector<double> columns(size_t(model.columns()));
    for (Eigen::Index i = 0; i < rows; ++i) {
        const Vec3d& lamp = lamps[size_t(i)];
        const Vec3f in_world = (lamp.x() * grid.tangent.cast<double>() + lamp.y() * grid.bitangent.cast<double>() +
                                lamp.z() * grid.normal.cast<double>())
                                   .cast<float>();
        model.columns(p, texel.to_local(in_world), Vec3f::UnitZ(), columns);
        for (int k = 0; k < model.basis; ++k) ours(i, k) = columns[size_t(k)];
        const LampMatrix shown = file.functions(lamp);
        for (Eigen::Index k = 0; k < theirs.cols(); ++k) theirs(i, k) = shown(0, 1 + 3 * k);
    }
    Eigen::MatrixXd found = ours.colPivHouseholderQr().solve(theirs);
    for (double& value : found.reshaped())  // the same function but for its sign, mostly
        if (std::abs(value - std::round(value)) < 1e-5) value = std::round(value);
    if (!((ours * found - theirs).cwiseAbs().maxCoeff() < 1e-5))
        throw std::logic_error(fmt::format("{}: its functions are not those of model {}", file.kind, model.name));
    return found.cast<float>();
}

Fitted reflectance_of(const RtiFile& file, const Dataset& dataset) {
    FittedReflectance out;
    out.atlas = texel_atlas(dataset, 1);
    out.fit.options.model = file.model;
    out.fit.options.curve = file.curve;
    describe(out.fit, file.model->name, file.curve, *out.atlas, dataset);
    using Coefficients = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;  // [coefficient][channel]
    const Eigen::MatrixXf of_functions =
        coefficients_of_functions(file, make_frame(dataset.grid.normal().cast<float>()), frame_of(dataset.grid));
    const auto parameters = size_t(file.model->parameters);
    out.fit.parameters.resize(out.atlas->texel_count() * parameters);
    parallel_for(out.atlas->texel_count(), 4096, [&](size_t t, int) {
        const Eigen::Map<const Coefficients> theirs(&file.values[t * file.numbers], of_functions.cols(), 3);
        Eigen::Map<Coefficients>(&out.fit.parameters[t * parameters], of_functions.rows(), 3) = of_functions * theirs;
    });
    return {std::move(out), dataset};
}

/// Mean products of a pixel's numbers, and 1 before them: [1 + numbers][1 + numbers], of some of the pixels.
Eigen::MatrixXd moments_of(const RtiFile& file) {
    constexpr size_t most = 20000;
    const size_t pixels = file.values.size() / file.numbers, step = std::max<size_t>(1, pixels / most);
    const auto numbers = Eigen::Index(file.numbers);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(1 + numbers, 1 + numbers);
    size_t count = 0;
    for (size_t p = 0; p < pixels; p += step, ++count) {
        Eigen::VectorXd z(1 + numbers);
        z[0] = 1;
        z.tail(numbers) = Eigen::Map<const Eigen::VectorXf>(&file.values[p * file.numbers], numbers).cast<double>();
        sum.selfadjointView<Eigen::Lower>().rankUpdate(z);
    }
    return Eigen::MatrixXd(sum.selfadjointView<Eigen::Lower>()) / double(count);
}

/// [lamps][lamps of the basis]
Eigen::MatrixXd kernels_at(const std::vector<Vec3d>& lamps, const LightBasis& basis) {
    const LightKernel<double> kernel{double(basis.length)};
    Eigen::MatrixXd out(Eigen::Index(lamps.size()), Eigen::Index(basis.lamps.size()));
    for (Eigen::Index i = 0; i < out.rows(); ++i)
        for (Eigen::Index j = 0; j < out.cols(); ++j)
            out(i, j) = kernel({lamps[size_t(i)].cast<float>()}, basis.lamps[size_t(j)]);
    return out;
}

/// The file's functions, sampled at lamps: [lamps][1 + numbers] of each channel.
using SampledFunctions = std::array<Eigen::MatrixXd, 3>;
SampledFunctions sample(const RtiFile& file, const std::vector<Vec3d>& lamps) {
    SampledFunctions out;
    out.fill(Eigen::MatrixXd(Eigen::Index(lamps.size()), Eigen::Index(1 + file.numbers)));
    for (size_t i = 0; i < lamps.size(); ++i) {
        const LampMatrix at = file.functions(lamps[i]);
        for (int c = 0; c < 3; ++c) out[size_t(c)].row(Eigen::Index(i)) = at.row(c);
    }
    return out;
}

/// `count` directions or a few less, evenly over those that are shown: amid the training lamps' and close to them, as
/// others are turned back among these (light_basis_fit.h). Of the file: x right, y up, z towards the camera.
std::vector<Vec3d> shown_lamps(const Dataset& dataset, const Frame& frame, size_t count) {
    constexpr double close = 0.05;  // radians
    std::vector<Vec3d> training;
    for (const uint32_t v : dataset.split(false))
        training.push_back(frame.to_local(dataset.views[v].light->place.cast<float>()).cast<double>().normalized());
    const auto shown_of = [&](size_t all) {
        std::vector<Vec3d> lamps = over_hemisphere(all);
        std::erase_if(lamps, [&](const Vec3d& lamp) { return angle_outside(training, lamp) > close; });
        return lamps;
    };
    const size_t shown = std::max<size_t>(1, shown_of(count).size());
    std::vector<Vec3d> lamps = shown_of(std::max<size_t>(2, count * count / shown));
    if (lamps.empty()) lamps = over_hemisphere(count);
    lamps.resize(std::min(count, lamps.size()));
    return lamps;
}

/// The nearest basis whose kernels have this length, and how far from the file it is.
struct NearestBasis {
    LightBasis basis;
    double difference = std::numeric_limits<double>::infinity();
};
NearestBasis nearest_basis(const RtiFile& file, const std::vector<Vec3d>& references, const std::vector<Vec3d>& lamps,
                           const SampledFunctions& theirs, const Eigen::MatrixXd& moments, float length,
                           const Frame& frame) {
    constexpr double ridge = 1e-6;  // keeps the kernels' weights small enough for floats
    NearestBasis out;
    LightBasis& basis = out.basis;
    basis.cubes = {{0, 0, 0}};
    basis.rank = int(file.numbers);
    basis.noise = 1e-4f;  // of a sample, which has 8 bits and more: nothing is fitted to it
    basis.frame = frame;
    basis.length = length;
    basis.smoothing = 1e-4f;
    for (const Vec3d& lamp : references) basis.lamps.push_back({lamp.cast<float>()});
    const auto count = Eigen::Index(basis.lamps.size());
    const Eigen::MatrixXd at = kernels_at(lamps, basis);
    Eigen::MatrixXd products = at.transpose() * at;
    products.diagonal().array() += ridge * double(lamps.size());
    const Eigen::LLT<Eigen::MatrixXd> solver(products);
    // Values under the reference lamps, of which the basis makes these weights again.
    Eigen::MatrixXd values_of_weights = kernels_at(references, basis);
    values_of_weights.diagonal().array() += double(basis.smoothing);
    basis.numbers.resize(basis.block_size());
    auto block = LightBasis::Block::Map(basis.numbers.data(), 3 * count, 1 + basis.rank);
    double squares = 0;
    for (int c = 0; c < 3; ++c) {
        const Eigen::MatrixXd weights = solver.solve(at.transpose() * theirs[size_t(c)]);
        const Eigen::MatrixXd difference = at * weights - theirs[size_t(c)];
        squares += (difference * moments).cwiseProduct(difference).sum();
        block.middleRows(c * count, count) = (values_of_weights * weights).cast<float>();
    }
    out.difference = std::sqrt(std::max(0.0, squares) / (3 * double(lamps.size())));
    return out;
}

RtiFit light_basis_of(const RtiFile& file, const Dataset& dataset) {
    const Frame frame = frame_of(dataset.grid);
    const std::vector<Vec3d> references = shown_lamps(dataset, frame, most_reference_lamps);
    const std::vector<Vec3d> lamps = shown_lamps(dataset, frame, 1500);
    const SampledFunctions theirs = sample(file, lamps);
    const Eigen::MatrixXd moments = moments_of(file);
    NearestBasis best;
    for (const float length : {0.15f, 0.2f, 0.25f, 0.3f, 0.4f, 0.5f, 0.7f}) {
        NearestBasis tried = nearest_basis(file, references, lamps, theirs, moments, length, frame);
        if (tried.difference < best.difference) best = std::move(tried);
    }
    FittedLightBasis out;
    out.atlas = texel_atlas(dataset, 1);
    out.fit.basis = std::move(best.basis);
    out.fit.parameters = file.values;
    out.fit.basis.curve = file.curve;
    describe(out.fit, light_basis_name, file.curve, *out.atlas, dataset);
    return {{std::move(out), dataset}, best.difference};
}

}  // namespace

void check_rti_dataset(const RtiFile& file, const std::filesystem::path& name, const Dataset& dataset) {
    const auto refuse = [&](const std::string& why) {
        throw UserError(fmt::format("{}: {}", dataset.folder.string(), why));
    };
    require_lights(dataset);
    const Grid& grid = dataset.grid;
    if (!dataset.has_grid())
        refuse(fmt::format("has a mesh, but {} is a picture: give images packed pixel on pixel", name.string()));
    if (grid.width != file.width || grid.height != file.height)
        refuse(
            fmt::format("{} x {} texels, but {} has {} x {} pixels: give the images that it was made of, at the same "
                        "size and cut",
                        grid.width, grid.height, name.string(), file.width, file.height));
    for (const View& view : dataset.views)
        if (view.light->kind != Light::Kind::distant || view.light->intensity != Vec3d::Ones() ||
            !(view.gain == Gain(1)))
            refuse(fmt::format(
                "image '{}' has a near lamp, an intensity or a gain, of which such files know nothing: pack "
                "the images with directions to the lamps alone",
                view.name));
    const Vec3f plane = grid.normal().cast<float>();
    if (file.model && std::ranges::any_of(grid.texel_normals, [&](const Vec3f& n) {
            return n != Vec3f::Zero() && !((n - plane).norm() < 1e-3f);
        }))
        refuse(
            fmt::format("its texels have normals of their own, but {} knows none: pack the images again with {} flat",
                        name.string(), option_name("normals")));
}

RtiFit fit_of(const RtiFile& file, const Dataset& dataset) {
    if (file.model) return {reflectance_of(file, dataset), 0};
    return light_basis_of(file, dataset);
}

}  // namespace radiafit::tools
