#include "capture/lit_images.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace radiafit::tools {
namespace {

constexpr double shadow_margin = 1.5;  // radii: a sphere's shadow, and the light that it throws beside it
constexpr double pixels_wanted = 6000, patches_across = 13;

ImageSetFormat full_size(ImageSetFormat format) {
    format.width = format.file_width;
    format.height = format.file_height;
    return format;
}

}  // namespace

LitReader::LitReader(const LitImages& images) : images_(&images), format_(full_size(images.format)), light_(format_) {}

LuminanceImage LitReader::luminance(const PackedImage& image) const {
    LuminanceImage out{format_.width, format_.height, {}};
    out.values.resize(size_t(out.width) * size_t(out.height));
    for (size_t p = 0; p < out.values.size(); ++p) {
        float sum = 0;
        for (size_t c = 0; c < 3; ++c) sum += light_.at(image.pixels, 3 * p + c);
        out.values[p] = std::max(0.0f, sum / 3);
    }
    return out;
}

std::array<float, 3> LitReader::rgb(const PackedImage& image, size_t pixel) const {
    std::array<float, 3> out{};
    for (size_t c = 0; c < 3; ++c) out[c] = light_.at(image.pixels, 3 * pixel + c);
    const bool masked = !image.mask.empty() && !image.mask[pixel];
    if (masked || *std::ranges::max_element(out) >= light_.clipped()) out.fill(std::numeric_limits<float>::quiet_NaN());
    return out;
}

SurfacePixels::SurfacePixels(const LitImages& images, const std::vector<Circle>& spheres)
    : values_(images.files.size()) {
    const int width = images.format.file_width, height = images.format.file_height;
    const auto index = [&](int x, int y) { return size_t(y) * size_t(width) + size_t(x); };
    const auto is_surface = [&](int x, int y) {
        return (images.mask.empty() || images.mask[index(x, y)]) &&
               !within(spheres, Vec2d(x + 0.5, y + 0.5), shadow_margin);
    };
    double area = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) area += is_surface(x, y);
    const int step = std::max(1, int(std::sqrt(area / pixels_wanted)));
    const int patch = std::max(1, int(std::sqrt(area) / patches_across));
    for (int y = step / 2; y < height; y += step)
        for (int x = step / 2; x < width; x += step) {
            if (!is_surface(x, y)) continue;
            pixels_.push_back(index(x, y));
            patches_.push_back(uint32_t(y / patch * (width / patch + 1) + x / patch));
        }
}

void SurfacePixels::take(size_t i, const LitReader& reader, const PackedImage& image) {
    for (const size_t pixel : pixels_)
        for (const float v : reader.rgb(image, pixel)) values_[i].push_back(v);
}

SurfaceSamples SurfacePixels::samples(const std::vector<uint32_t>& which, const PictureFrame& frame) const {
    SurfaceSamples out{which.size(), {}, patches_, {}};
    for (size_t p = 0; p < pixels_.size(); ++p) {
        const size_t x = pixels_[p] % size_t(frame.width), y = pixels_[p] / size_t(frame.width);
        out.positions.push_back(frame.plane_point(Vec2d(double(x) + 0.5, double(y) + 0.5)));
        for (const uint32_t i : which)
            for (size_t c = 0; c < 3; ++c) out.values.push_back(values_[i][3 * p + c]);
    }
    return out;
}

bool within(const std::vector<Circle>& circles, const Vec2d& place, double factor) {
    return std::ranges::any_of(circles, [&](const Circle& c) { return (place - c.centre).norm() < factor * c.radius; });
}

}  // namespace radiafit::tools
