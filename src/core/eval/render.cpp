#include "eval/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/output_claims.h"
#include "eval/exposure.h"
#include "image/exr.h"

namespace radiafit {
namespace {

constexpr int gap = 4;  // pixels between the pictures of a sheet

using Rgb = std::array<uint8_t, 3>;

Rgb bytes_of(const std::array<float, 3>& shown) {
    Rgb bytes;
    for (size_t c = 0; c < 3; ++c) {
        if (!std::isfinite(shown[c])) return {255, 0, 255};
        bytes[c] = uint8_t(std::lround(255 * clamped(shown[c])));
    }
    return bytes;
}

// sRGB bytes for the eye, whatever the encoding of a judged picture is.
Rgb bytes_of_stored(const float* stored, Encoding encoding) {
    std::array<float, 3> shown;
    for (size_t c = 0; c < 3; ++c)
        shown[c] = encoding == Encoding::u8_srgb ? stored[c] : float(srgb_encode(double(stored[c])));
    return bytes_of(shown);
}

class Sheet {
public:
    Sheet(int pictures, int width, int height) : picture_width_(width) {
        image.width = pictures * width + (pictures - 1) * gap;
        image.height = height;
        image.rgb.assign(size_t(image.width) * size_t(height) * 3, 255);
    }

    template <class PixelBytes>
    void add(PixelBytes pixel_bytes) {
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < picture_width_; ++x) {
                const Rgb bytes = pixel_bytes(size_t(y) * size_t(picture_width_) + size_t(x));
                std::copy(bytes.begin(), bytes.end(), image.rgb.begin() + 3 * (ptrdiff_t(y) * image.width + left_ + x));
            }
        left_ += picture_width_ + gap;
    }

    ByteImage image;

private:
    int picture_width_, left_ = 0;
};

}  // namespace

LightImage render(const Contestant& contestant, const Dataset& dataset, const View& view, int pixel_points,
                  int worker) {
    PixelAreas areas(dataset, pixel_points);
    areas.shade(contestant, view, worker);
    LightImage image;
    image.width = view.camera.width;
    image.height = view.camera.height;
    image.rgb = areas.rgb();
    for (size_t i = 0; i < areas.centres().size(); ++i) {
        image.coverage.push_back(areas.coverage(i));
        for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
            float& value = image.rgb[c];
            if (contestant.space == TargetSpace::stored) value = float(decode(dataset.encoding, value));
            value *= image.coverage[i];
        }
    }
    return image;
}

std::string picture_remark() {
    const std::string made = made_by_remark();
    return made.empty() ? picture_mark : fmt::format("{}_{}", picture_mark, made);
}

void write_light_exr(const std::filesystem::path& path, const LightImage& image) {
    ExrImage exr{image.width, image.height, {"R", "G", "B", "A"}, {}, {{"software", picture_mark}}};
    exr.values.reserve(4 * image.coverage.size());
    for (size_t i = 0; i < image.coverage.size(); ++i)
        exr.values.insert(exr.values.end(),
                          {image.rgb[3 * i], image.rgb[3 * i + 1], image.rgb[3 * i + 2], image.coverage[i]});
    write_exr(path, exr);
}

LightImage in_exposure(LightImage image, const Gain& gain) {
    for (size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] /= float(gain[i % 3]);
    return image;
}

Camera photograph_camera(const View& view) {
    constexpr int largest = 8192;  // Rasterizer
    const auto [x, y] = view.crop_origin;
    const auto [width, height] = view.full_size;
    const bool inside = x >= 0 && y >= 0 && width <= largest && height <= largest && x <= width - view.camera.width &&
                        y <= height - view.camera.height;
    return inside && !view.camera_direction ? view.camera.cropped(-x, -y, width, height) : view.camera;
}

Camera fitted_into(const Camera& camera, int width, int height) {
    Camera out = camera;
    const double scale = std::min(double(width) / camera.width, double(height) / camera.height);
    out.width = width;
    out.height = height;
    out.fx *= scale;
    out.fy *= scale;
    out.cx = scale * camera.cx + 0.5 * (width - scale * camera.width);
    out.cy = scale * camera.cy + 0.5 * (height - scale * camera.height);
    return out;
}

ByteImage to_bytes(const LightImage& image, const Background& background) {
    ByteImage out{image.width, image.height, {}, background.transparent ? 4 : 3};
    std::array<double, 3> behind;
    for (size_t c = 0; c < 3; ++c) behind[c] = srgb_decode(background.srgb[c] / 255.0);
    for (size_t i = 0; i < image.coverage.size(); ++i) {
        const float coverage = image.coverage[i];
        std::array<float, 3> light;
        for (size_t c = 0; c < 3; ++c) {
            light[c] = image.rgb[3 * i + c];
            if (!background.transparent) light[c] += float((1 - double(coverage)) * behind[c]);
            if (background.transparent && coverage > 0) light[c] /= coverage;
        }
        const Rgb bytes = bytes_of_stored(light.data(), Encoding::u16_linear);
        out.rgb.insert(out.rgb.end(), bytes.begin(), bytes.end());
        if (background.transparent) out.rgb.push_back(uint8_t(std::lround(255 * coverage)));
    }
    return out;
}

ByteImage comparison_sheet(const JudgedView& fit, const JudgedView* baseline, Encoding encoding, float error_factor) {
    if (baseline && (baseline->width != fit.width || baseline->height != fit.height))
        throw std::invalid_argument("comparison_sheet: fit and baseline show different views");
    Sheet sheet(baseline ? 4 : 3, fit.width, fit.height);
    sheet.add([&](size_t i) { return bytes_of_stored(fit.photograph.data() + 3 * i, encoding); });
    if (baseline) sheet.add([&](size_t i) { return bytes_of_stored(baseline->render.data() + 3 * i, encoding); });
    sheet.add([&](size_t i) { return bytes_of_stored(fit.render.data() + 3 * i, encoding); });
    sheet.add([&](size_t i) -> Rgb {
        if (!fit.foreground[i]) return {0, 0, 0};
        std::array<float, 3> error;
        for (size_t c = 0; c < 3; ++c)
            error[c] = error_factor * std::abs(fit.render[3 * i + c] - fit.photograph[3 * i + c]);
        return bytes_of(error);
    });
    return sheet.image;
}

}  // namespace radiafit
