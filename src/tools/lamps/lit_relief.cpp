#include "lamps/lit_relief.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/decompositions.h"
#include "base/parallel.h"
#include "base/statistics.h"

namespace radiafit::tools {
namespace {

constexpr double in_shadow = 0.1;       // of a pixel's upper decile
constexpr double hardly_lit = 0.05;     // of the median pixel's
constexpr double cauchy_scale = 2.385;  // robust deviations: 95 % as efficient as least squares under normal errors
constexpr size_t least_known = 6;
constexpr int fit_rounds = 8;

void take_pixels(const LightStack& stack, LitRelief& relief) {
    std::vector<ReliefPixel> pixels;
    std::vector<double> deciles;
    for (int y = 0; y < stack.height; ++y)
        for (int x = 0; x < stack.width; ++x) {
            const float* all = stack.at(x, y);
            std::vector<double> known;
            for (size_t i = 0; i < stack.images(); ++i)
                if (std::isfinite(all[i])) known.push_back(double(all[i]));
            const double decile = known.size() < least_known ? 0 : quantile(known, 0.9);
            if (!(decile > 0)) continue;
            ReliefPixel pixel{.x = x, .y = y, .place = stack.place(x, y)};
            for (size_t i = 0; i < stack.images(); ++i) {
                const bool has = std::isfinite(all[i]);
                pixel.value.push_back(has ? float(double(all[i]) / decile) : 0.0f);
                pixel.weight.push_back(has);
            }
            pixels.push_back(std::move(pixel));
            deciles.push_back(decile);
        }
    const double least = hardly_lit * median(deciles);
    relief.index.assign(size_t(stack.width) * size_t(stack.height), -1);
    for (size_t i = 0; i < pixels.size(); ++i) {
        if (deciles[i] < least) continue;
        relief.index[size_t(pixels[i].y) * size_t(stack.width) + size_t(pixels[i].x)] = int(relief.pixels.size());
        relief.pixels.push_back(std::move(pixels[i]));
    }
}

void face(LitRelief& relief) {
    parallel_for(relief.pixels.size(), 64, [&](size_t k, int) {
        ReliefPixel& p = relief.pixels[k];
        Mat3d matrix = 1e-6 * Mat3d::Identity();
        Vec3d right = Vec3d::Zero();
        for (size_t i = 0; i < p.value.size(); ++i) {
            if (!(p.weight[i] > 0)) continue;
            const Vec3d lit = relief.strengths[i] * relief.directions[i];
            matrix += double(p.weight[i]) * lit * lit.transpose();
            right += double(p.weight[i]) * double(p.value[i]) * lit;
        }
        p.facing = solve_symmetric(matrix, right);
    });
}

void brighten(LitRelief& relief) {
    const size_t images = relief.directions.size();
    std::vector<double> over(images, 1e-12), under(images, 1e-12);
    for (const ReliefPixel& p : relief.pixels)
        for (size_t i = 0; i < images; ++i) {
            const double shown = relief.shown(p, i);
            over[i] += double(p.weight[i]) * shown * double(p.value[i]);
            under[i] += double(p.weight[i]) * shown * shown;
        }
    double mean = 0;
    for (size_t i = 0; i < images; ++i) {
        relief.strengths[i] *= std::clamp(over[i] / under[i], 0.5, 2.0);
        mean += std::log(relief.strengths[i]) / double(images);
    }
    for (double& s : relief.strengths) s /= std::exp(mean);
}

void weigh(const LightStack& stack, LitRelief& relief, bool by_values) {
    std::vector<double> off;
    for (const ReliefPixel& p : relief.pixels)
        for (size_t i = 0; i < p.value.size(); ++i)
            if (p.weight[i] > 0) off.push_back(std::abs(double(p.value[i]) - relief.shown(p, i)));
    relief.deviation = std::max(1.4826 * median(std::move(off)), 1e-4);
    parallel_for(relief.pixels.size(), 64, [&](size_t k, int) {
        ReliefPixel& p = relief.pixels[k];
        std::vector<double> even(p.value.size());  // under lamps of one strength
        for (size_t i = 0; i < even.size(); ++i)
            even[i] = by_values ? double(p.value[i]) / relief.strengths[i] : relief.directions[i].dot(p.facing);
        const double dark = in_shadow * quantile(even, 0.9);
        const float* given = stack.at(p.x, p.y);
        for (size_t i = 0; i < even.size(); ++i) {
            const double r = (double(p.value[i]) - relief.shown(p, i)) / (cauchy_scale * relief.deviation);
            p.weight[i] = std::isfinite(given[i]) && even[i] > 0 && even[i] >= dark ? float(1 / (1 + r * r)) : 0.0f;
        }
    });
}

}  // namespace

LitRelief fit_relief(const LightStack& stack) {
    LitRelief relief{.width = stack.width, .height = stack.height};
    for (size_t i = 0; i < stack.images(); ++i) relief.directions.push_back(stack.direction(i));
    take_pixels(stack, relief);
    if (relief.pixels.empty()) return relief;
    for (size_t i = 0; i < stack.images(); ++i) {
        std::vector<double> values;
        for (const ReliefPixel& p : relief.pixels)
            if (p.weight[i] > 0) values.push_back(double(p.value[i]));
        const double middle = values.empty() ? 1 : median(std::move(values));
        relief.strengths.push_back(std::max(middle, 1e-3) / std::max(relief.directions[i].z(), 0.3));
    }
    for (int round = 0; round < fit_rounds; ++round) {
        face(relief);
        weigh(stack, relief, round == 0);
        brighten(relief);
    }
    face(relief);
    return relief;
}

}  // namespace radiafit::tools
