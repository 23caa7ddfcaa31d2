#include "exchange/relight.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "eval/render.h"
#include "image/web/jpeg_image.h"

namespace radiafit::tools {
namespace {

using Json = nlohmann::ordered_json;
using Basis = Eigen::Matrix<double, relight_planes, 1>;
constexpr int channels = 3, numbers = relight_planes * channels;

constexpr int lamps_across = 17;
constexpr double farthest_out = 0.985;  // of a lamp from the middle of the disc: 10 degrees above the horizon
constexpr double least_weight = 0.01;

struct Lamp {
    View view;
    Basis basis;
    double weight;
};

std::vector<Lamp> lamps_over(const Contestant& contestant, const Grid& grid, View view) {
    const Vec3d right = grid.right.normalized(), up = -grid.down.normalized(), towards = grid.normal();
    std::vector<Lamp> lamps;
    for (int j = 0; j < lamps_across; ++j)
        for (int i = 0; i < lamps_across; ++i) {
            const double x = farthest_out * (2.0 * i / (lamps_across - 1) - 1);
            const double y = farthest_out * (2.0 * j / (lamps_across - 1) - 1);
            if (std::hypot(x, y) > farthest_out + 1e-9) continue;
            const double z = std::sqrt(1 - x * x - y * y);
            view.light = Light{Light::Kind::distant, (x * right + y * up + z * towards).normalized(), Vec3d::Ones()};
            const double share = contestant.share_of_fit ? contestant.share_of_fit(view) : 1;
            Basis basis;
            basis << 1, x, y, x * x, x * y, y * y;
            lamps.push_back({view, basis, std::max(share, least_weight)});
        }
    return lamps;
}

/// Coefficients = columns times what the lamps show: of weighted least squares.
Eigen::MatrixXd solution_of(const std::vector<Lamp>& lamps) {
    Eigen::Matrix<double, relight_planes, relight_planes> normal =
        Eigen::Matrix<double, relight_planes, relight_planes>::Zero();
    Eigen::MatrixXd weighted(relight_planes, ptrdiff_t(lamps.size()));
    for (size_t l = 0; l < lamps.size(); ++l) {
        weighted.col(ptrdiff_t(l)) = lamps[l].weight * lamps[l].basis;
        normal += weighted.col(ptrdiff_t(l)) * lamps[l].basis.transpose();
    }
    return normal.ldlt().solve(weighted);
}

struct Coefficients {
    size_t pixels = 0;
    std::vector<float> values;  ///< [pixels][coefficient][channel]
    std::vector<uint8_t> seen;  ///< [pixels]
};

Coefficients coefficients_of(const Contestant& contestant, const Dataset& dataset, const std::vector<Lamp>& lamps) {
    Coefficients out;
    out.pixels = dataset.grid.texel_count();
    out.values.assign(out.pixels * numbers, 0.0f);
    out.seen.assign(out.pixels, 0);
    const Eigen::MatrixXd solution = solution_of(lamps);
    std::vector<LightImage> shown(static_cast<size_t>(thread_count()));
    for (size_t first = 0; first < lamps.size(); first += shown.size()) {
        const size_t count = std::min(shown.size(), lamps.size() - first);
        parallel_for(count, 1, [&](size_t i, int) { shown[i] = render(contestant, dataset, lamps[first + i].view); });
        parallel_for(out.pixels, 1024, [&](size_t p, int) {
            for (size_t i = 0; i < count; ++i) {
                if (shown[i].coverage[p] > 0) out.seen[p] = 1;
                for (size_t c = 0; c < channels; ++c) {
                    const double value = std::clamp(double(shown[i].rgb[channels * p + c]), 0.0, 1.0);
                    const double srgb = srgb_encode(std::isfinite(value) ? value : 0.0);
                    for (size_t k = 0; k < relight_planes; ++k)
                        out.values[(p * relight_planes + k) * channels + c] +=
                            float(solution(ptrdiff_t(k), ptrdiff_t(first + i)) * srgb);
                }
            }
        });
    }
    for (size_t p = 0; p < out.pixels; ++p)
        if (!out.seen[p]) std::fill_n(&out.values[p * numbers], numbers, 0.0f);
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

Relight relight_of(const Contestant& contestant, const Dataset& dataset, const View& view, int quality) {
    if (!dataset.has_grid())
        throw UserError(
            fmt::format("{}: has a mesh, but such files hold a grid, a texel for each pixel; fit images that "
                        "show a surface pixel on pixel under lamps that move",
                        dataset.name));
    const std::vector<Lamp> lamps = lamps_over(contestant, dataset.grid, view);
    const Coefficients coefficients = coefficients_of(contestant, dataset, lamps);
    const size_t seen = size_t(std::ranges::count(coefficients.seen, uint8_t(1)));
    Relight out;
    std::array<Steps, numbers> steps;
    parallel_for(numbers, 1, [&](size_t i, int) {
        std::vector<float> values;
        values.reserve(seen);
        for (size_t p = 0; p < coefficients.pixels; ++p)
            if (coefficients.seen[p]) values.push_back(coefficients.values[p * numbers + i]);
        if (!values.empty()) steps[i] = steps_of(std::move(values), seen < coefficients.pixels);
    });
    parallel_for(relight_planes, 1, [&](size_t k, int) {
        std::vector<uint8_t> rgb(channels * coefficients.pixels);
        for (size_t p = 0; p < coefficients.pixels; ++p)
            for (size_t c = 0; c < channels; ++c) {
                const size_t i = k * channels + c;
                rgb[channels * p + c] = steps[i].byte_of(double(coefficients.values[p * numbers + i]));
            }
        out.planes[k] = jpeg_bytes(dataset.grid.width, dataset.grid.height, rgb, quality);
    });
    Json scale = Json::array(), bias = Json::array();
    for (const Steps& s : steps) {
        scale.push_back(s.scale());
        bias.push_back(s.bias());
    }
    const Json info = {{"width", dataset.grid.width},
                       {"height", dataset.grid.height},
                       {"format", "jpg"},
                       {"type", "ptm"},
                       {"colorspace", "rgb"},
                       {"nplanes", numbers},
                       {"quality", quality},
                       {"materials", Json::array({{{"scale", scale}, {"bias", bias}}})}};
    out.info = json_text(info, 2) + "\n";
    return out;
}

}  // namespace radiafit::tools
