#include "lamps/highlight.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/statistics.h"
#include "lamps/connected_pixels.h"

namespace radiafit::tools {
namespace {

constexpr double inside = 0.95;   // of the radius: beyond it the surroundings mix in
constexpr double stands_out = 3;  // times the brighter tenth
constexpr double most_of_disc = 0.2;
constexpr double nearly = 0.9;            // of the brightest value
constexpr double least_deviation = 0.02;  // pixels: what the spot's form leaves open

/// Pixels of a disc, in a window around it.
struct Disc {
    int left, top, width, height;
    std::vector<uint8_t> within;  ///< [height][width]
    size_t count = 0;
    size_t index(int x, int y) const { return size_t(y - top) * size_t(width) + size_t(x - left); }
    bool has(int x, int y) const {
        return x >= left && y >= top && x < left + width && y < top + height && within[index(x, y)];
    }
};

Disc disc_of(const LuminanceImage& image, const Circle& outline) {
    const double r = inside * outline.radius;
    Disc disc{};
    disc.left = std::clamp(int(std::floor(outline.centre.x() - r)), 0, image.width);
    disc.top = std::clamp(int(std::floor(outline.centre.y() - r)), 0, image.height);
    disc.width = std::clamp(int(std::ceil(outline.centre.x() + r)), disc.left, image.width) - disc.left;
    disc.height = std::clamp(int(std::ceil(outline.centre.y() + r)), disc.top, image.height) - disc.top;
    for (int y = disc.top; y < disc.top + disc.height; ++y)
        for (int x = disc.left; x < disc.left + disc.width; ++x) {
            const bool in = (Vec2d(x + 0.5, y + 0.5) - outline.centre).norm() < r;
            disc.within.push_back(in);
            disc.count += in;
        }
    return disc;
}

}  // namespace

std::optional<Highlight> find_highlight(const LuminanceImage& image, const Circle& outline) {
    const Disc disc = disc_of(image, outline);
    if (disc.count < 12) return {};
    std::vector<double> values;
    for (int y = disc.top; y < disc.top + disc.height; ++y)
        for (int x = disc.left; x < disc.left + disc.width; ++x)
            if (disc.has(x, y)) values.push_back(double(image.at(x, y)));
    const double peak = *std::ranges::max_element(values), bright = quantile(values, 0.9);
    if (!(peak > 0 && peak >= stands_out * bright)) return {};
    // Spots: what is connected above half of the way up. Of those nearly as bright as the brightest, which mirrored
    // surroundings may be where the image clips, the most compact; then some pixels around it, which are half covered.
    const double middle = quantile(values, 0.5), threshold = 0.5 * (peak + bright);
    const auto is_bright = [&](int x, int y) {
        return disc.has(x + disc.left, y + disc.top) && double(image.at(x + disc.left, y + disc.top)) >= threshold;
    };
    ConnectedPixels members;
    double least_spread = std::numeric_limits<double>::infinity();
    for (const ConnectedPixels& part : connected_pixels(disc.width, disc.height, is_bright)) {
        double brightest = 0, spread = 0;
        Vec2d mean = Vec2d::Zero();
        for (const auto& [x, y] : part) {
            brightest = std::max(brightest, double(image.at(x + disc.left, y + disc.top)));
            mean += Vec2d(x, y) / double(part.size());
        }
        for (const auto& [x, y] : part) spread += (Vec2d(x, y) - mean).squaredNorm() / double(part.size());
        if (brightest < nearly * peak || spread >= least_spread) continue;
        least_spread = spread;
        members = part;
    }
    for (auto& [x, y] : members) x += disc.left, y += disc.top;
    if (double(members.size()) > most_of_disc * double(disc.count)) return {};
    std::vector<uint8_t> spot(disc.within.size(), 0);
    for (const auto& [x, y] : members) spot[disc.index(x, y)] = 1;
    const size_t core = members.size();
    for (size_t i = 0; i < core; ++i)
        for (int dy = -2; dy <= 2; ++dy)
            for (int dx = -2; dx <= 2; ++dx) {
                const int x = members[i].first + dx, y = members[i].second + dy;
                if (!disc.has(x, y) || spot[disc.index(x, y)]) continue;
                spot[disc.index(x, y)] = 1;
                members.emplace_back(x, y);
            }
    std::vector<double> steps;  // between neighbours, of which most have nothing but noise between them
    for (int y = disc.top; y < disc.top + disc.height; ++y)
        for (int x = disc.left; x + 1 < disc.left + disc.width; ++x)
            if (disc.has(x, y) && disc.has(x + 1, y))
                steps.push_back(std::abs(double(image.at(x + 1, y)) - double(image.at(x, y))));
    const double noise = 1.4826 / std::sqrt(2.0) * quantile(steps, 0.5);
    double sum = 0;
    Vec2d moment = Vec2d::Zero();
    for (const auto& [x, y] : members) {
        const double weight = std::max(0.0, double(image.at(x, y)) - middle);
        sum += weight;
        moment += weight * Vec2d(x + 0.5, y + 0.5);
    }
    Highlight out;
    out.place = moment / sum;
    double squares = 0;
    for (const auto& [x, y] : members) squares += 0.5 * (Vec2d(x + 0.5, y + 0.5) - out.place).squaredNorm();
    out.deviation = std::hypot(noise * std::sqrt(squares) / sum, least_deviation);
    return out;
}

}  // namespace radiafit::tools
