#include "capture/gains.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/decompositions.h"
#include "base/error.h"
#include "base/statistics.h"
#include "base/text_file.h"
#include "base/wording.h"
#include "capture/image_scale.h"

namespace radiafit::tools {
namespace {

constexpr size_t wanted_points = 20000;
constexpr double depth_tolerance = 5e-3;   // relative; a 3 x 3 window at that angle stays within it
constexpr double clipped = 250.0 / 255.0;  // stored value; above, the sensor's answer is no longer linear
constexpr float dark = 0.005f;             // linear mean; below, an 8-bit step is more than 5 % of the value
constexpr size_t least_shared = 20;        // samples on points that other views see too
constexpr double least_gain = 1e-6, largest_gain = 1e6;  // of a table
constexpr int rounds = 20;                               // of reweighting; the scale converges after about ten

/// Samples of the training views that take part, grouped by point.
struct Observation {
    uint32_t view;
    double log_value;
    double weight = 1;
};

class GainSolver {
public:
    GainSolver(const std::vector<std::vector<GainSample>>& samples, const std::vector<uint8_t>& takes_part)
        : log_gains_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples.size()))) {
        size_t points = 0;
        for (const auto& view : samples)
            for (const GainSample& s : view) points = std::max(points, size_t(s.point) + 1);
        groups_.resize(points);
        brightness_.resize(points, 0);
        for (uint32_t v = 0; v < samples.size(); ++v)
            if (takes_part[v])
                for (const GainSample& s : samples[v]) groups_[s.point].push_back({v, s.log_value});
    }

    void run() {
        for (int round = 0; round < rounds; ++round) {
            solve();
            reweight();
        }
    }
    double log_gain(size_t view) const { return log_gains_[static_cast<Eigen::Index>(view)]; }
    double brightness(uint32_t point) const { return brightness_[point]; }
    /// The number of views that determine a point's brightness. One view alone says nothing about gains.
    size_t views_of(uint32_t point) const { return point < groups_.size() ? groups_[point].size() : 0; }

private:
    /// The brightness of every point eliminated, one dense system over the views remains: a weighted graph Laplacian.
    void solve() {
        const Eigen::Index n = log_gains_.size();
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
        for (const auto& group : groups_) {
            if (group.size() < 2) continue;
            double weights = 0, mean = 0;
            for (const Observation& o : group) {
                weights += o.weight;
                mean += o.weight * o.log_value;
            }
            mean /= weights;
            for (const Observation& a : group) {
                matrix(a.view, a.view) += a.weight;
                right(a.view) -= a.weight * (a.log_value - mean);
                for (const Observation& b : group) matrix(a.view, b.view) -= a.weight * b.weight / weights;
            }
        }
        // The common factor is free, in every group of views that share points: a weak pull towards log gain 0 fixes
        // it.
        matrix.diagonal().array() += 1e-6 * matrix.trace() / double(n) + 1e-12;
        log_gains_ = solve_symmetric(matrix, right);
    }

    void reweight() {
        std::vector<double> sizes;
        for (size_t p = 0; p < groups_.size(); ++p) {
            if (groups_[p].empty()) continue;
            double weights = 0, sum = 0;
            for (const Observation& o : groups_[p]) {
                weights += o.weight;
                sum += o.weight * (o.log_value + log_gains_[o.view]);
            }
            brightness_[p] = sum / weights;
            if (groups_[p].size() > 1)
                for (const Observation& o : groups_[p]) sizes.push_back(std::abs(residual(p, o)));
        }
        if (sizes.empty()) return;  // no point is seen twice
        const double scale = std::max(2 * 1.4826 * median(std::move(sizes)), 1e-3);
        for (size_t p = 0; p < groups_.size(); ++p)
            for (Observation& o : groups_[p]) {
                const double r = residual(p, o) / scale;
                o.weight = 1 / (1 + r * r);
            }
    }

    double residual(size_t point, const Observation& o) const {
        return o.log_value + log_gains_[o.view] - brightness_[point];
    }

    std::vector<std::vector<Observation>> groups_;  ///< [points]
    std::vector<double> brightness_;                ///< [points] log
    Eigen::VectorXd log_gains_;                     ///< [views]
};

}  // namespace

std::vector<double> read_gains(const std::filesystem::path& file, const std::vector<std::string>& names) {
    TextFile text(file, fmt::format("gain table ({} takes auto, none, estimate, per-channel or such a file)",
                                    option_name("gains")));
    std::unordered_map<std::string, double> table;
    for (std::string_view line; text.next_entry(line);) {
        const auto tokens = split_tokens(line);
        if (tokens.size() < 2) text.fail("expected an image name and, in the last column, its linear gain");
        const double gain = text.to_double(tokens.back(), "the gain in the last column");
        if (!(gain >= least_gain && gain <= largest_gain))
            text.fail(
                fmt::format("the gain {} is not from {:g} to {:g}: correct the line", gain, least_gain, largest_gain));
        if (!table.emplace(tokens.front(), gain).second)
            text.fail(fmt::format("image '{}' is given twice: remove one line", tokens.front()));
    }
    std::vector<double> gains;
    for (const std::string& name : names) {
        const auto at = table.find(name);
        if (at == table.end())
            throw UserError(
                fmt::format("{}: no gain for image '{}': add a line NAME GAIN for it", file.string(), name));
        gains.push_back(at->second);
    }
    return gains;
}

void normalize_gains(std::vector<double>& gains, const std::vector<uint8_t>& held_out) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < gains.size(); ++i)
        if (!held_out[i]) {
            sum += std::log(gains[i]);
            ++count;
        }
    if (count == 0) return;
    const double mean = std::exp(sum / double(count));
    for (double& gain : gains) gain /= mean;
}

GainPoints::GainPoints(const Mesh& mesh) : points_(surface_points(mesh, wanted_points)) {}

std::vector<GainSample> GainPoints::observe(const Camera& camera, const Rasterizer& raster, const ImageFile& image,
                                            const std::vector<uint8_t>& mask) const {
    const std::vector<float>& light = linear_table(image.bits, image.linear);
    const bool floats = image.bits == 32;  // which do not clip
    const auto limit = static_cast<size_t>(clipped * double(light.size() - 1));
    const Vec3d eye = camera.center();
    const auto width = size_t(camera.width);
    std::vector<GainSample> samples;
    for (uint32_t p = 0; p < points_.size(); ++p) {
        const std::optional<Vec3d> seen = project_facing(points_[p], camera, eye);
        if (!seen) continue;
        const Vec3d& at = *seen;
        const size_t x = static_cast<size_t>(at.x()), y = static_cast<size_t>(at.y());
        std::array<double, 3> sums{};
        bool good = true;
        for (size_t row = y - 1; row <= y + 1 && good; ++row)
            for (size_t pixel = row * width + x - 1; pixel <= row * width + x + 1; ++pixel) {
                good = std::abs(double(raster.inverse_depth()[pixel]) * at.z() - 1) < depth_tolerance &&
                       (mask.empty() || mask[pixel]);
                for (size_t c = 0; c < 3 && good; ++c) {
                    if (floats) {
                        sums[c] += double(image.rgb32[3 * pixel + c]);
                        continue;
                    }
                    const size_t stored = image.bits == 8 ? image.rgb8[3 * pixel + c] : image.rgb16[3 * pixel + c];
                    good = stored < limit;
                    sums[c] += light[stored];
                }
                if (!good) break;
            }
        const double mean = (sums[0] + sums[1] + sums[2]) / 27;
        if (!good || mean <= dark) continue;
        GainSample sample{p, static_cast<float>(std::log(mean))};
        for (size_t c = 0; c < 3; ++c)
            sample.log_channels[c] = sums[c] / 9 > dark ? static_cast<float>(std::log(sums[c] / 9)) : NAN;
        samples.push_back(sample);
    }
    return samples;
}

GainEstimate estimate_gains(const std::vector<std::vector<GainSample>>& samples, const std::vector<uint8_t>& held_out) {
    GainEstimate result;
    result.gains.assign(samples.size(), 1.0);
    std::unordered_map<uint32_t, uint32_t> training_views;  // of each point
    for (size_t v = 0; v < samples.size(); ++v)
        if (!held_out[v])
            for (const GainSample& s : samples[v]) ++training_views[s.point];
    std::vector<uint8_t> takes_part(samples.size(), 0);
    for (size_t v = 0; v < samples.size(); ++v) {
        const auto shared = [&](const GainSample& s) { return training_views[s.point] > 1; };
        takes_part[v] =
            !held_out[v] && size_t(std::count_if(samples[v].begin(), samples[v].end(), shared)) >= least_shared;
    }
    GainSolver solver(samples, takes_part);
    solver.run();
    for (size_t v = 0; v < samples.size(); ++v) {
        if (takes_part[v]) {
            result.gains[v] = std::exp(solver.log_gain(v));
            continue;
        }
        std::vector<double> differences;
        if (held_out[v])
            for (const GainSample& s : samples[v])
                if (solver.views_of(s.point) > 0) differences.push_back(solver.brightness(s.point) - s.log_value);
        if (differences.size() >= least_shared)
            result.gains[v] = std::exp(median(std::move(differences)));
        else
            result.guessed.push_back(v);
    }
    normalize_gains(result.gains, held_out);
    return result;
}

ChannelGainEstimate estimate_channel_gains(const std::vector<std::vector<GainSample>>& samples,
                                           const std::vector<uint8_t>& held_out) {
    const GainEstimate of_all = estimate_gains(samples, held_out);
    ChannelGainEstimate result{.gains = std::vector<std::array<double, 3>>(samples.size()), .guessed = of_all.guessed};
    for (size_t c = 0; c < 3; ++c) {
        std::vector<std::vector<GainSample>> channel(samples.size());
        for (size_t v = 0; v < samples.size(); ++v)
            for (const GainSample& s : samples[v])
                if (!std::isnan(s.log_channels[c])) channel[v].push_back({s.point, s.log_channels[c]});
        GainEstimate estimate = estimate_gains(channel, held_out);
        for (const size_t v : estimate.guessed) estimate.gains[v] = of_all.gains[v];
        normalize_gains(estimate.gains, held_out);
        for (size_t v = 0; v < samples.size(); ++v) result.gains[v][c] = estimate.gains[v];
    }
    return result;
}

}  // namespace radiafit::tools
