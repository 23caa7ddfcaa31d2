#include "capture/undistort.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "capture/image_scale.h"

namespace radiafit::tools {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double least_factor = 0.2, largest_factor = 2;  // of width and height, as COLMAP bounds them
constexpr double widest_gap = 1.25;                       // pixels between the look-ups of one new pixel
constexpr int most_look_ups = 64;                         // along a side of a new pixel

/// Where the centre of a pixel lies in the photograph, in pixels from the first one's centre, and the sides of the
/// parallelogram that it covers there.
struct Footprint {
    double x = 0, y = 0;
    double across_x = 0, across_y = 0, down_x = 0, down_y = 0;
    int across = 1, down = 1;  // look-ups along the sides
    bool inside = false;
};

int look_ups(double x, double y) {
    const double squared = x * x + y * y;
    if (squared <= widest_gap * widest_gap) return 1;
    return int(std::min(std::ceil(std::sqrt(squared) / widest_gap), double(most_look_ups)));
}

class Mapping {
public:
    Mapping(const Camera& taken, const Lens& lens, const Camera& pinhole) : taken_(taken), lens_(lens), to_(pinhole) {}

    Footprint at(double x, double y) const {
        const DistortedPoint d = lens_.distort((x - to_.cx) / to_.fx, (y - to_.cy) / to_.fy);
        Footprint f;
        const double px = taken_.fx * d.x + taken_.cx, py = taken_.fy * d.y + taken_.cy;
        constexpr double rounding = 1e-6;  // pixels
        f.inside = d.valid && px >= -rounding && px <= taken_.width + rounding && py >= -rounding &&
                   py <= taken_.height + rounding;
        if (!f.inside) return f;
        f.x = px - 0.5, f.y = py - 0.5;
        f.inside = std::isfinite(d.x_u + d.y_u) && std::isfinite(d.x_v + d.y_v);
        if (!f.inside) return f;
        f.across_x = taken_.fx * d.x_u / to_.fx, f.across_y = taken_.fy * d.y_u / to_.fx;
        f.down_x = taken_.fx * d.x_v / to_.fy, f.down_y = taken_.fy * d.y_v / to_.fy;
        f.across = look_ups(f.across_x, f.across_y);
        f.down = look_ups(f.down_x, f.down_y);
        return f;
    }
    int width() const { return to_.width; }
    int height() const { return to_.height; }
    int taken_width() const { return taken_.width; }
    int taken_height() const { return taken_.height; }

private:
    const Camera& taken_;
    const Lens& lens_;
    const Camera& to_;
};

/// value(i): channel i of the photograph, interleaved; store(i, mean): of the new one; skip(pixel): it shows nothing.
template <int channels, class Value, class Store, class Skip>
void resample(const Mapping& map, const Value& value, const Store& store, const Skip& skip) {
    const int last_x = map.taken_width() - 1, last_y = map.taken_height() - 1;
    const size_t stride = size_t(map.taken_width()) * channels;
    // Interpolated by differences, so that equal values give exactly that value.
    const auto look_up = [&](double x, double y, float* out) {
        const double cx = std::clamp(x, 0.0, double(last_x)), cy = std::clamp(y, 0.0, double(last_y));
        const int x0 = int(cx), y0 = int(cy);
        const auto fx = float(cx - x0), fy = float(cy - y0);
        const size_t a = size_t(y0) * stride + size_t(x0) * channels, right = x0 < last_x ? channels : 0;
        const size_t b = a + (y0 < last_y ? stride : 0);
        for (size_t c = 0; c < channels; ++c) {
            const float top0 = value(a + c), top1 = value(a + right + c);
            const float low0 = value(b + c), low1 = value(b + right + c);
            const float top = top0 + fx * (top1 - top0), low = low0 + fx * (low1 - low0);
            out[c] = top + fy * (low - top);
        }
    };
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            const Footprint f = map.at(x + 0.5, y + 0.5);
            const size_t pixel = size_t(y) * size_t(map.width()) + size_t(x);
            if (!f.inside) {
                skip(pixel);
                continue;
            }
            float mean[channels];
            if (f.across == 1 && f.down == 1) {
                look_up(f.x, f.y, mean);
            } else {
                float sample[channels];
                int count = 0;
                for (int j = 0; j < f.down; ++j)
                    for (int i = 0; i < f.across; ++i) {
                        const double u = (i + 0.5) / f.across - 0.5, v = (j + 0.5) / f.down - 0.5;
                        look_up(f.x + u * f.across_x + v * f.down_x, f.y + u * f.across_y + v * f.down_y, sample);
                        ++count;
                        for (size_t c = 0; c < channels; ++c)
                            mean[c] = count == 1 ? sample[c] : mean[c] + (sample[c] - mean[c]) / float(count);
                    }
            }
            for (size_t c = 0; c < channels; ++c) store(pixel * channels + c, mean[c]);
        }
}

/// The border of the photograph where it comes nearest to the middle of the pinhole's picture, along one axis.
struct Extent {
    double low = -infinity, high = infinity;
};

/// COLMAP's factor of a side: 1 / max(c / (c - low), (side - 0.5 - c) / (high - c)).
double side_factor(const Extent& extent, double centre, int side) {
    const double scale = std::max(centre / (centre - extent.low), (side - 0.5 - centre) / (extent.high - centre));
    return std::isnan(scale) ? 1 : std::clamp(1 / scale, least_factor, largest_factor);
}

}  // namespace

Camera resized_camera(Camera camera, int width, int height) {
    // Pixel coordinates run from 0 at the image's left or top edge, so they scale by the very ratio of the sizes.
    const double sx = double(width) / camera.width, sy = double(height) / camera.height;
    camera.fx *= sx, camera.cx *= sx, camera.width = width;
    camera.fy *= sy, camera.cy *= sy, camera.height = height;
    return camera;
}

Camera undistorted_camera(const Camera& taken, const Lens& lens) {
    Extent across, down;
    const auto seen = [&](double x, double y) -> std::optional<Vec2d> {
        const auto p = lens.undistort({(x - taken.cx) / taken.fx, (y - taken.cy) / taken.fy});
        if (!p) return {};
        return Vec2d(taken.fx * p->x() + taken.cx, taken.fy * p->y() + taken.cy);
    };
    for (int y = 0; y < taken.height; ++y) {
        if (const auto p = seen(0.5, y + 0.5)) across.low = std::max(across.low, p->x());
        if (const auto p = seen(taken.width - 0.5, y + 0.5)) across.high = std::min(across.high, p->x());
    }
    for (int x = 0; x < taken.width; ++x) {
        if (const auto p = seen(x + 0.5, 0.5)) down.low = std::max(down.low, p->y());
        if (const auto p = seen(x + 0.5, taken.height - 0.5)) down.high = std::min(down.high, p->y());
    }
    Camera pinhole = taken;
    pinhole.width = std::max(1, int(side_factor(across, taken.cx, taken.width) * taken.width));
    pinhole.height = std::max(1, int(side_factor(down, taken.cy, taken.height) * taken.height));
    pinhole.cx *= double(pinhole.width) / taken.width;
    pinhole.cy *= double(pinhole.height) / taken.height;
    return pinhole;
}

UndistortionLoss undistortion_loss(const Camera& taken, const Lens& lens, const Camera& pinhole) {
    constexpr int points = 64;
    const Mapping map(taken, lens, pinhole);
    UndistortionLoss loss;
    for (int j = 0; j < points; ++j)
        for (int i = 0; i < points; ++i) {
            const double x = (i + 0.5) / points, y = (j + 0.5) / points;
            loss.blank += !map.at(x * pinhole.width, y * pinhole.height).inside;
            loss.no_pinhole +=
                !lens.undistort({(x * taken.width - taken.cx) / taken.fx, (y * taken.height - taken.cy) / taken.fy});
        }
    loss.blank /= points * points;
    loss.no_pinhole /= points * points;
    return loss;
}

UndistortedImage undistort(const ImageFile& image, const Camera& taken, const Lens& lens, const Camera& pinhole) {
    const Mapping map(taken, lens, pinhole);
    const size_t size = size_t(pinhole.width) * size_t(pinhole.height);
    UndistortedImage result{{pinhole.width, pinhole.height, image.bits, image.linear, {}, {}, {}, {}}, {}};
    ImageFile& out = result.image;
    const auto skip = [&](size_t pixel) {
        if (result.inside.empty()) result.inside.assign(size, 255);
        result.inside[pixel] = 0;
    };
    const std::vector<float>& light = linear_table(image.bits == 8 ? 8 : 16, image.linear);
    const LightCoder& coder = LightCoder::of(image.bits == 8 ? 8 : 16, image.linear);
    if (image.bits == 8) {
        out.rgb8.resize(size * 3);
        resample<3>(
            map, [&](size_t i) { return light[image.rgb8[i]]; },
            [&](size_t i, float mean) { out.rgb8[i] = static_cast<uint8_t>(coder.stored(mean)); }, skip);
    } else if (image.bits == 32) {
        out.rgb32.resize(size * 3);
        resample<3>(
            map, [&](size_t i) { return image.rgb32[i]; }, [&](size_t i, float mean) { out.rgb32[i] = mean; }, skip);
    } else {
        out.rgb16.resize(size * 3);
        resample<3>(
            map, [&](size_t i) { return light[image.rgb16[i]]; },
            [&](size_t i, float mean) { out.rgb16[i] = coder.stored(mean); }, skip);
    }
    if (!image.alpha.empty()) {
        out.alpha.resize(size);
        resample<1>(
            map, [&](size_t i) { return float(image.alpha[i]); },
            [&](size_t i, float mean) { out.alpha[i] = static_cast<uint8_t>(std::lround(mean)); }, [](size_t) {});
    }
    return result;
}

std::vector<uint8_t> undistort_mask(const std::vector<uint8_t>& mask, int width, int height, const Camera& taken,
                                    const Lens& lens, const Camera& pinhole) {
    const Camera of_mask = resized_camera(taken, width, height);
    std::vector<uint8_t> out(size_t(pinhole.width) * size_t(pinhole.height));
    resample<1>(
        Mapping(of_mask, lens, pinhole), [&](size_t i) { return mask[i] ? 1.0f : 0.0f; },
        [&](size_t i, float mean) { out[i] = mean >= 0.5f - 1e-5f ? 255 : 0; }, [](size_t) {});
    return out;
}

}  // namespace radiafit::tools
