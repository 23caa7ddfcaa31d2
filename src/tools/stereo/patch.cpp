#include "stereo/patch.h"

#include <cmath>

namespace radiafit::tools {
namespace {

constexpr float least_deviation = 0.004f;  // of a patch that is not flat: one step of 8 bits
constexpr float most_area = 4;

struct Offsets {
    alignas(32) float x[Patch::samples], y[Patch::samples];
};
constexpr Offsets offsets = [] {
    Offsets o{};
    int k = 0;
    for (int y = -Patch::reach; y <= Patch::reach; y += 2)
        for (int x = -Patch::reach; x <= Patch::reach; x += 2)
            if (x * x + y * y < 2 * Patch::reach * Patch::reach) {
                o.x[k] = float(x);
                o.y[k++] = float(y);
            }
    return o;
}();

constexpr int lanes = 8;

/// Their sum, in an order that does not hinder vector instructions.
float sum_of(const float (&lane)[lanes]) {
    return ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
}

}  // namespace

bool Patch::take(const GreyImage& image, int x, int y) {
    const int width = image.camera.width, height = image.camera.height;
    if (x < reach || y < reach || x >= width - reach || y >= height - reach) return false;
    const float* centre = image.values.data() + ptrdiff_t(y) * width + x;
    float mean = 0, squares = 0;
    for (int k = 0; k < samples; ++k) {
        values_[size_t(k)] = centre[ptrdiff_t(offsets.y[k]) * width + ptrdiff_t(offsets.x[k])];
        mean += values_[size_t(k)];
    }
    mean /= samples;
    for (float& value : values_) squares += (value - mean) * (value - mean);
    if (!(squares > samples * least_deviation * least_deviation)) return false;
    const float scale = 1 / std::sqrt(squares);
    for (float& value : values_) value = (value - mean) * scale;
    return true;
}

float Patch::cost(const GreyImage& source, const AffineMap& map) const {
    const float x = map.x - 0.5f, y = map.y - 0.5f;  // whole numbers at centres of pixels
    const float across = float(reach) * (std::abs(map.x_dx) + std::abs(map.x_dy));
    const float along = float(reach) * (std::abs(map.y_dx) + std::abs(map.y_dy));
    const int width = source.camera.width;
    if (map.none() || !(x - across >= 0 && y - along >= 0 && x + across < float(width - 1) &&
                        y + along < float(source.camera.height - 1)))
        return worst_cost;
    const float area = map.x_dx * map.y_dy - map.x_dy * map.y_dx;
    if (!(area > 1 / most_area && area < most_area)) return worst_cost;

    alignas(32) int place[samples];
    alignas(32) float right[samples], down[samples];
    for (int k = 0; k < samples; ++k) {
        const float px = x + map.x_dx * offsets.x[k] + map.x_dy * offsets.y[k];
        const float py = y + map.y_dx * offsets.x[k] + map.y_dy * offsets.y[k];
        const int column = int(px), row = int(py);
        right[k] = px - float(column);
        down[k] = py - float(row);
        place[k] = row * width + column;
    }
    const float* const above = source.values.data();
    const float* const below = above + width;
    float sum[lanes] = {}, squares[lanes] = {}, products[lanes] = {};
    for (int k = 0; k < samples; k += lanes)
        for (int l = 0; l < lanes; ++l) {
            const int at = place[k + l];
            const float top = above[at] + right[k + l] * (above[at + 1] - above[at]);
            const float bottom = below[at] + right[k + l] * (below[at + 1] - below[at]);
            const float value = top + down[k + l] * (bottom - top);
            sum[l] += value;
            squares[l] += value * value;
            products[l] += value * values_[size_t(k + l)];
        }
    const float total = sum_of(sum), spread = sum_of(squares) - total * total / samples;
    if (!(spread > samples * least_deviation * least_deviation)) return worst_cost;
    return 1 - sum_of(products) / std::sqrt(spread);
}

}  // namespace radiafit::tools
