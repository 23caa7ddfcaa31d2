#include "capture/lamp_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/statistics.h"
#include "dataset/dataset.h"
#include "image/png_file.h"

namespace radiafit::tools {
namespace {

using Rgb = std::array<double, 3>;
constexpr Rgb outline_color = {60, 220, 90}, lamp_color = {255, 150, 0}, unused_color = {255, 60, 60};
constexpr int longest = 1000;      // pixels, of all that the camera sees
constexpr double around = 1.2;     // radii, of a sphere enlarged
constexpr double well_lit = 0.95;  // of the surface's pixels, darker than which white is
constexpr int gap = 6;

/// sRGB bytes that are drawn on.
struct Canvas {
    int width, height;
    std::vector<uint8_t> rgb = std::vector<uint8_t>(3 * size_t(width) * size_t(height), 24);

    /// Mixed by the share of each pixel that a line of such a width along the circle covers.
    void ring(const Vec2d& centre, double radius, double line, const Rgb& color) {
        const double reach = radius + line;
        const auto bound = [](double v, int most) { return std::clamp(int(v), 0, most); };
        for (int y = bound(centre.y() - reach, height); y < bound(centre.y() + reach + 1, height); ++y)
            for (int x = bound(centre.x() - reach, width); x < bound(centre.x() + reach + 1, width); ++x) {
                const double off = std::abs((Vec2d(x + 0.5, y + 0.5) - centre).norm() - radius);
                const double share = std::clamp(0.5 + 0.5 * line - off, 0.0, 1.0);
                uint8_t* at = &rgb[3 * (size_t(y) * size_t(width) + size_t(x))];
                for (size_t c = 0; c < 3; ++c) at[c] = uint8_t(std::lround((1 - share) * at[c] + share * color[c]));
            }
    }
    /// With a dark rim, so that it is seen on white, too.
    void mark(const Vec2d& centre, double radius, double line, const Rgb& color) {
        ring(centre, radius, line + 2, {0, 0, 0});
        ring(centre, radius, line, color);
    }
};

/// A part of the pictures as it is shown: place (x, y) there is at (place - from) / step + corner on the canvas.
struct Panel {
    Vec2d from;
    double step;  ///< pixels of the pictures for one of the canvas
    Vec2d corner;
    int width, height;

    Vec2d shown(const Vec2d& place) const { return (place - from) / step + corner; }
};

/// Means of what each pixel covers, `white` or more as white.
void show(const LuminanceImage& image, double white, const Panel& panel, Canvas& canvas) {
    const int samples = std::max(1, int(std::ceil(panel.step)));
    parallel_for(size_t(panel.height), 8, [&](size_t y, int) {
        for (int x = 0; x < panel.width; ++x) {
            double sum = 0;
            for (int j = 0; j < samples; ++j)
                for (int i = 0; i < samples; ++i)
                    sum += image.sample(panel.from +
                                        panel.step * Vec2d(x + (i + 0.5) / samples, double(y) + (j + 0.5) / samples));
            const double value = std::clamp(sum / (samples * samples) / white, 0.0, 1.0);
            const size_t at =
                (size_t(panel.corner.y()) + y) * size_t(canvas.width) + size_t(panel.corner.x()) + size_t(x);
            std::fill_n(&canvas.rgb[3 * at], 3, uint8_t(std::lround(255 * srgb_encode(value))));
        }
    });
}

/// What the surface shows where it is lit well.
double white_of(const LuminanceImage& image) {
    const size_t step = std::max<size_t>(1, image.values.size() / 100000);
    std::vector<double> values;
    for (size_t p = 0; p < image.values.size(); p += step) values.push_back(double(image.values[p]));
    return std::max(quantile(std::move(values), well_lit), 1e-9);
}

}  // namespace

std::string lamp_picture(const LampCalibration& calibration) {
    const LuminanceImage& image = calibration.brightest;
    const double step = double(std::max(image.width, image.height)) / longest;
    const Panel whole{Vec2d::Zero(), step, Vec2d::Zero(), std::max(1, int(image.width / step)),
                      std::max(1, int(image.height / step))};
    const int rows = std::max(2, int(calibration.spheres.size()));
    const int side = (std::max(whole.height, 480) - (rows - 1) * gap) / rows;
    Canvas canvas{whole.width + gap + side, std::max(whole.height, rows * side + (rows - 1) * gap)};
    const double white = white_of(image);
    show(image, white, whole, canvas);
    std::vector<bool> used(calibration.highlights.size(), false);
    for (const uint32_t i : calibration.images) used[i] = true;
    for (size_t s = 0; s < calibration.spheres.size(); ++s) {
        const Circle& sphere = calibration.spheres[s];
        const double reach = around * sphere.radius;
        const Panel panel{sphere.centre - Vec2d(reach, reach), 2 * reach / side,
                          Vec2d(whole.width + gap, int(s) * (side + gap)), side, side};
        show(image, white, panel, canvas);
        canvas.mark(whole.shown(sphere.centre), sphere.radius / whole.step, 1.5, outline_color);
        canvas.mark(panel.shown(sphere.centre), sphere.radius / panel.step, 1.5, outline_color);
        for (size_t i = 0; i < calibration.highlights.size(); ++i)
            if (const std::optional<Highlight>& h = calibration.highlights[i][s])
                canvas.mark(panel.shown(h->place), 0.02 * side, 1.2, used[i] ? lamp_color : unused_color);
    }
    return png_bytes(canvas.width, canvas.height, canvas.rgb);
}

}  // namespace radiafit::tools
