#include "exchange/relight.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/range.h"
#include "eval/pixel_areas.h"
#include "eval/render.h"
#include "image/web/jpeg_image.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;
constexpr int channels = 3;
constexpr double least_weight = 0.01;
constexpr double horizon = 0.985;  // of a lamp from the middle of the disc: 10 degrees above the horizon

struct Lamp {
    View view;
    double x, y;  ///< of its direction, over the grid
    double weight;
};

class LampMaker {
public:
    LampMaker(const Contestant& contestant, const Grid& grid, const View& view)
        : contestant_(&contestant),
          right_(grid.right.normalized()),
          up_(-grid.down.normalized()),
          towards_(grid.normal()),
          view_(view) {}
    Lamp at(double x, double y) const {
        View view = view_;
        const double z = std::sqrt(std::max(0.0, 1 - x * x - y * y));
        view.light = Light{Light::Kind::distant, (x * right_ + y * up_ + z * towards_).normalized(), Vec3d::Ones()};
        const double share = contestant_->share_of_fit ? contestant_->share_of_fit(view) : 1;
        return {view, x, y, std::max(share, least_weight)};
    }

private:
    const Contestant* contestant_;
    Vec3d right_, up_, towards_;
    View view_;
};

/// Functions of the lamp: what a viewer multiplies the coefficients with and adds up.
struct ViewerFunctions {
    std::vector<Lamp> lamps;
    Eigen::MatrixXd at;    ///< [lamps x channels][coefficients]
    Eigen::VectorXd mean;  ///< [lamps x channels], beside them
    Json info;             ///< what info.json says of them

    /// Coefficients = this times what the lamps show less the mean: of weighted least squares.
    Eigen::MatrixXd solution() const {
        Eigen::VectorXd weights(at.rows());
        for (Eigen::Index i = 0; i < weights.size(); ++i) weights[i] = lamps[size_t(i / channels)].weight;
        const Eigen::MatrixXd weighted = at.transpose() * weights.asDiagonal();
        return solve_symmetric(weighted * at, weighted);
    }
};

ViewerFunctions polynomials(const LampMaker& maker) {
    constexpr int across = 17, planes = 6;
    ViewerFunctions out;
    for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i) {
            const double x = horizon * (2.0 * i / (across - 1) - 1), y = horizon * (2.0 * j / (across - 1) - 1);
            if (std::hypot(x, y) <= horizon + 1e-9) out.lamps.push_back(maker.at(x, y));
        }
    const auto rows = Eigen::Index(channels * out.lamps.size());
    out.at = Eigen::MatrixXd::Zero(rows, channels * planes);
    out.mean = Eigen::VectorXd::Zero(rows);
    for (size_t l = 0; l < out.lamps.size(); ++l) {
        const double x = out.lamps[l].x, y = out.lamps[l].y;
        const double basis[planes] = {1, x, y, x * x, x * y, y * y};
        for (int k = 0; k < planes; ++k)
            for (int c = 0; c < channels; ++c) out.at(Eigen::Index(l) * channels + c, k * channels + c) = basis[k];
    }
    out.info = {{"type", "ptm"}, {"colorspace", "rgb"}};
    return out;
}

/// sRGB of what a render shows at a pixel; 0 where that is no number.
double stored_value(float light) {
    const double value = std::clamp(double(light), 0.0, 1.0);
    return srgb_encode(std::isfinite(value) ? value : 0.0);
}

/// [lamps x channels][pixels] what lamps show at some pixels.
Eigen::MatrixXd shown_at(const Contestant& contestant, const std::vector<Lamp>& lamps,
                         const std::vector<RasterPixel>& seen, const std::vector<size_t>& some) {
    std::vector<RasterPixel> pixels(seen.size());
    for (const size_t p : some) pixels[p] = seen[p];
    Eigen::MatrixXd out(Eigen::Index(channels * lamps.size()), Eigen::Index(some.size()));
    parallel_for(lamps.size(), 1, [&](size_t l, int worker) {
        std::vector<float> rgb;
        contestant.shade(lamps[l].view, pixels, rgb, worker);
        for (size_t i = 0; i < some.size(); ++i)
            for (int c = 0; c < channels; ++c)
                out(Eigen::Index(l) * channels + c, Eigen::Index(i)) =
                    stored_value(rgb[channels * some[i] + size_t(c)]);
    });
    return out;
}

/// Bytes as the viewer takes them back: of the mean 255ths, of a function (byte - 127) / range.
void store_in_bytes(ViewerFunctions& functions) {
    const Eigen::Index rows = functions.at.rows();
    std::vector<int> bytes;
    for (Eigen::Index i = 0; i < rows; ++i) {
        bytes.push_back(int(std::lround(255 * std::clamp(functions.mean[i], 0.0, 1.0))));
        functions.mean[i] = bytes.back() / 255.0;
    }
    std::vector<double> ranges;
    for (Eigen::Index k = 0; k < functions.at.cols(); ++k) {
        const double range = 127 / std::max(1e-9, functions.at.col(k).cwiseAbs().maxCoeff());
        ranges.push_back(range);
        for (Eigen::Index i = 0; i < rows; ++i) {
            bytes.push_back(int(std::lround(127 + range * functions.at(i, k))));
            functions.at(i, k) = (bytes.back() - 127) / range;
        }
    }
    functions.info["basis"] = bytes;
    functions.info["range"] = ranges;
}

/// Of colours that the fit itself shows at some of the grid's texels.
ViewerFunctions components(const Contestant& contestant, const Dataset& dataset, const LampMaker& maker, int planes) {
    constexpr int across = 15;
    constexpr size_t most_pixels = 4000;
    ViewerFunctions out;
    for (int j = 0; j < across; ++j)
        for (int i = 0; i < across; ++i) {  // the viewer turns the octahedron's plane by 45 degrees
            const double s = 2.0 * i / (across - 1) - 1, t = 2.0 * j / (across - 1) - 1;
            Vec3d direction((s - t) / 2, (s + t) / 2, 0);
            direction.z() = std::max(0.0, 1 - std::abs(direction.x()) - std::abs(direction.y()));
            direction.normalize();
            out.lamps.push_back(maker.at(direction.x(), direction.y()));
        }
    Rasterizer rasterizer;
    const std::vector<RasterPixel> seen = seen_pixels(dataset, out.lamps.front().view, rasterizer);
    std::vector<size_t> pixels, some;
    for (size_t p = 0; p < seen.size(); ++p)
        if (seen[p].triangle != no_triangle) pixels.push_back(p);
    const size_t step = std::max<size_t>(1, pixels.size() / most_pixels);
    for (size_t i = 0; i < pixels.size(); i += step) some.push_back(pixels[i]);
    Eigen::MatrixXd values = shown_at(contestant, out.lamps, seen, some);
    out.mean = values.rows() > 0 && values.cols() > 0 ? Eigen::VectorXd(values.rowwise().mean())
                                                      : Eigen::VectorXd::Zero(values.rows());
    values.colwise() -= out.mean;
    Eigen::VectorXd roots(values.rows());
    for (Eigen::Index i = 0; i < roots.size(); ++i) roots[i] = std::sqrt(out.lamps[size_t(i / channels)].weight);
    const Eigen::MatrixXd weighted = roots.asDiagonal() * values;
    const SymmetricEigen spectrum = symmetric_eigen(weighted * weighted.transpose());
    out.at = roots.cwiseInverse().asDiagonal() * spectrum.vectors.rowwise().reverse().leftCols(planes);
    out.info = {{"type", "bilinear"}, {"colorspace", "mrgb"}, {"resolution", across}};
    store_in_bytes(out);
    return out;
}

struct Coefficients {
    size_t pixels = 0, numbers = 0;
    std::vector<float> values;  ///< [pixels][numbers]
    std::vector<uint8_t> seen;  ///< [pixels]
};

Coefficients coefficients_of(const Contestant& contestant, const Dataset& dataset, const ViewerFunctions& functions) {
    const Eigen::MatrixXd solution = functions.solution();
    const std::vector<Lamp>& lamps = functions.lamps;
    Coefficients out;
    out.pixels = dataset.grid.texel_count();
    out.numbers = size_t(solution.rows());
    out.values.assign(out.pixels * out.numbers, 0.0f);
    out.seen.assign(out.pixels, 0);
    std::vector<LightImage> shown(static_cast<size_t>(thread_count()));
    for (size_t first = 0; first < lamps.size(); first += shown.size()) {
        const size_t count = std::min(shown.size(), lamps.size() - first);
        parallel_for(count, 1, [&](size_t i, int) { shown[i] = render(contestant, dataset, lamps[first + i].view); });
        parallel_for(out.pixels, 1024, [&](size_t p, int) {
            Eigen::Map<Eigen::VectorXf> values(&out.values[p * out.numbers], Eigen::Index(out.numbers));
            for (size_t i = 0; i < count; ++i) {
                if (shown[i].coverage[p] > 0) out.seen[p] = 1;
                for (size_t c = 0; c < channels; ++c) {
                    const auto row = Eigen::Index(channels * (first + i) + c);
                    const double value = stored_value(shown[i].rgb[channels * p + c]) - functions.mean[row];
                    values += (value * solution.col(row)).cast<float>();
                }
            }
        });
    }
    for (size_t p = 0; p < out.pixels; ++p)
        if (!out.seen[p]) std::fill_n(&out.values[p * out.numbers], out.numbers, 0.0f);
    return out;
}

/// Values from `least` to `most` are bytes from 0 to 255.
struct Steps {
    double least = 0, most = 1;
    double scale() const { return std::max(most - least, 1e-6); }
    double bias() const { return -least / scale(); }
    uint8_t byte_of(double value) const {
        return uint8_t(std::lround(255 * std::clamp((value - least) / scale(), 0.0, 1.0)));
    }
};

/// The ends that lose least: of all values, or without the few that lie farthest out.
Steps steps_of(std::vector<float> values, bool with_zero) {
    std::ranges::sort(values);
    Steps best;
    double least_loss = std::numeric_limits<double>::infinity();
    for (const double left_out : {0.0, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3}) {
        const size_t skipped = size_t(left_out * double(values.size()));
        Steps steps{double(values[skipped]), double(values[values.size() - 1 - skipped])};
        if (with_zero) steps = {std::min(steps.least, 0.0), std::max(steps.most, 0.0)};
        double loss = double(values.size()) * std::pow(steps.scale() / 255, 2) / 12;
        for (const float value : values)
            loss += std::pow(double(value) - std::clamp(double(value), steps.least, steps.most), 2);
        if (loss < least_loss) least_loss = loss, best = steps;
    }
    return best;
}

}  // namespace

Relight relight_of(const Contestant& contestant, const Dataset& dataset, const View& view,
                   const RelightOptions& options) {
    require("planes", options.planes, limits::relight_planes);
    if (options.planes % 3 != 0 && options.basis == RelightOptions::Basis::bilinear)
        throw UserError(fmt::format("planes = {}: an image has three of them; choose 3, 6, ... 27", options.planes));
    if (!dataset.has_grid())
        throw UserError(
            fmt::format("{}: has a mesh, but such files hold a grid, a texel for each pixel; fit images that "
                        "show a surface pixel on pixel under lamps that move",
                        dataset.name));
    const LampMaker maker(contestant, dataset.grid, view);
    ViewerFunctions functions = options.basis == RelightOptions::Basis::ptm
                                    ? polynomials(maker)
                                    : components(contestant, dataset, maker, options.planes);
    const Coefficients coefficients = coefficients_of(contestant, dataset, functions);
    const size_t seen = size_t(std::ranges::count(coefficients.seen, uint8_t(1))), numbers = coefficients.numbers;
    std::vector<Steps> steps(numbers);
    parallel_for(numbers, 1, [&](size_t i, int) {
        std::vector<float> values;
        values.reserve(seen);
        for (size_t p = 0; p < coefficients.pixels; ++p)
            if (coefficients.seen[p]) values.push_back(coefficients.values[p * numbers + i]);
        if (!values.empty()) steps[i] = steps_of(std::move(values), seen < coefficients.pixels);
    });
    Relight out;
    out.planes.resize(numbers / channels);
    parallel_for(out.planes.size(), 1, [&](size_t k, int) {
        std::vector<uint8_t> rgb(channels * coefficients.pixels);
        for (size_t p = 0; p < coefficients.pixels; ++p)
            for (size_t c = 0; c < channels; ++c) {
                const size_t i = k * channels + c;
                rgb[channels * p + c] = steps[i].byte_of(double(coefficients.values[p * numbers + i]));
            }
        out.planes[k] = jpeg_bytes(dataset.grid.width, dataset.grid.height, rgb, options.quality);
    });
    Json material = {{"scale", Json::array()}, {"bias", Json::array()}};
    for (const Steps& s : steps) {
        material["scale"].push_back(s.scale());
        material["bias"].push_back(s.bias());
    }
    if (functions.info.contains("range")) {
        material["range"] = functions.info["range"];
        functions.info.erase("range");
    }
    Json info = {{"width", dataset.grid.width},
                 {"height", dataset.grid.height},
                 {"format", "jpg"},
                 {"nplanes", numbers},
                 {"quality", options.quality}};
    info.update(functions.info);
    info["materials"] = Json::array({material});
    out.info = json_text(info, 2) + "\n";
    return out;
}

}  // namespace radiafit::tools
