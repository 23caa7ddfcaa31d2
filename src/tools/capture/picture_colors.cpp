#include "capture/picture_colors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "capture/icc_profile.h"
#include "capture/image_scale.h"
#include "dataset/dataset.h"

namespace radiafit::tools {
namespace {

/// A pixel's light: curve and matrix, or the transform.
std::array<float, 3> light_of(const ColorConversion& conversion, std::array<float, 3> stored) {
    if (conversion.transform) {
        conversion.transform(stored.data(), 1);
        return stored;
    }
    for (int c = 0; c < 3; ++c) stored[size_t(c)] = conversion.curve(c, stored[size_t(c)]);
    std::array<float, 3> light = {};
    for (size_t row = 0; row < 3; ++row)
        for (size_t c = 0; c < 3; ++c) light[row] += conversion.matrix[3 * row + c] * stored[c];
    return light;
}

/// The largest difference, over greys and colours, between what a stored value is and what it would be as sRGB, or as
/// linear light: in stored sRGB, or in light.
struct Differences {
    double srgb = 0, linear = 0;
};

Differences compare_with_srgb(const ColorConversion& conversion) {
    Differences most;
    const auto compare = [&](const std::array<float, 3>& stored) {
        const std::array<float, 3> light = light_of(conversion, stored);
        for (size_t c = 0; c < 3; ++c) {
            const double value = std::isfinite(light[c]) ? std::clamp(double(light[c]), 0.0, 1.0) : 2.0;
            most.srgb = std::max(most.srgb, std::abs(srgb_encode(value) - double(stored[c])));
            most.linear = std::max(most.linear, std::abs(value - double(stored[c])));
        }
    };
    constexpr int steps = 6, greys = 64;
    for (int r = 0; r <= steps; ++r)
        for (int g = 0; g <= steps; ++g)
            for (int b = 0; b <= steps; ++b) compare({float(r) / steps, float(g) / steps, float(b) / steps});
    for (int i = 0; i <= greys; ++i) compare({float(i) / greys, float(i) / greys, float(i) / greys});
    return most;
}

/// As sRGB in 8 bits, as light in 16. Not a number is 0.
void store(float light, uint8_t& to) {
    to = light > 0 ? static_cast<uint8_t>(LightCoder::of(8, false).stored(light)) : uint8_t(0);
}
void store(float light, uint16_t& to) { to = light > 0 ? LightCoder::of(16, true).stored(light) : uint16_t(0); }

/// Pixel by pixel, curves by tables of all stored values.
template <class Channel>
void convert_values(std::vector<Channel>& rgb, const ColorConversion& conversion) {
    constexpr size_t values = size_t(1) << (8 * sizeof(Channel));
    constexpr float largest = float(values - 1);
    if (conversion.transform) {
        constexpr size_t piece = 4096;  // pixels
        std::vector<float> light;
        for (size_t at = 0; at < rgb.size(); at += 3 * piece) {
            const size_t count = std::min(3 * piece, rgb.size() - at);
            light.assign(rgb.begin() + ptrdiff_t(at), rgb.begin() + ptrdiff_t(at + count));
            for (float& v : light) v /= largest;
            conversion.transform(light.data(), count / 3);
            for (size_t i = 0; i < count; ++i) store(light[i], rgb[at + i]);
        }
        return;
    }
    std::array<std::vector<float>, 3> curves;
    for (size_t c = 0; c < 3; ++c) {
        curves[c].resize(values);
        for (size_t i = 0; i < values; ++i) curves[c][i] = conversion.curve(int(c), float(i) / largest);
    }
    const std::array<float, 9>& m = conversion.matrix;
    for (size_t i = 0; i + 2 < rgb.size(); i += 3) {
        const float r = curves[0][rgb[i]], g = curves[1][rgb[i + 1]], b = curves[2][rgb[i + 2]];
        for (size_t c = 0; c < 3; ++c) store(m[3 * c] * r + m[3 * c + 1] * g + m[3 * c + 2] * b, rgb[i + c]);
    }
}

void convert_floats(std::vector<float>& rgb, const std::array<float, 9>& m) {
    for (size_t i = 0; i + 2 < rgb.size(); i += 3) {
        const float r = rgb[i], g = rgb[i + 1], b = rgb[i + 2];
        for (size_t c = 0; c < 3; ++c) rgb[i + c] = m[3 * c] * r + m[3 * c + 1] * g + m[3 * c + 2] * b;
    }
}

bool is_identity(const std::array<float, 9>& matrix) {
    constexpr float tolerance = 0.003f;
    for (size_t i = 0; i < 9; ++i)
        if (!(std::abs(matrix[i] - (i % 4 == 0 ? 1.0f : 0.0f)) <= tolerance)) return false;
    return true;
}

std::string name_of(const ColorConversion& profile) {
    return profile.name.empty() ? "a profile without a name" : fmt::format("the profile '{}'", profile.name);
}

/// PNG's chunks and OpenEXR's chromaticities. A gamma near 1 / 2.2 is how sRGB was written before it had a chunk.
ColorConversion conversion_of_chunks(const ColorTags& tags, bool floats, std::string& by) {
    const bool usual = std::abs(tags.gamma - 1 / 2.2) < 0.05 * (1 / 2.2);
    double gamma = usual ? 0 : tags.gamma;
    if (floats || std::abs(gamma - 1) < 0.005) gamma = 1;
    if (tags.gamma > 0) by = usual ? "gAMA (1 / 2.2)" : fmt::format("gAMA ({:g})", tags.gamma);
    if (tags.has_chromaticities()) by += by.empty() ? "its chromaticities" : " and cHRM";
    if (!tags.numbers_by.empty()) by = tags.numbers_by;
    return make_conversion(tags.chromaticities, gamma);
}

}  // namespace

ColorReading convert_colors(ImageFile& image) {
    using Kind = ColorReading::Kind;
    ColorReading reading;
    const bool floats = image.bits == 32;
    const ColorTags& tags = image.colors;
    std::optional<ColorConversion> conversion;
    if (!tags.profile.empty()) {
        conversion = read_icc_profile(tags.profile);
        if (conversion->refusal.empty() && conversion->grey && !image.grey)
            conversion->refusal = "it is of grey, and the picture of colours";
        reading.by = name_of(*conversion);
    }
    if (!tags.damage.empty()) reading.ignored = fmt::format("its colour profile is not used: {}", tags.damage);
    if (conversion && !conversion->refusal.empty()) {
        reading.ignored = fmt::format("{} is not used: {}", reading.by, conversion->refusal);
        conversion.reset();
    }
    if (!conversion && !tags.srgb.empty() && !floats) {
        reading.by = tags.srgb;
        reading.kind = Kind::srgb;
        image.linear = false;
        return reading;
    }
    if (!conversion && (tags.gamma > 0 || tags.has_chromaticities())) {
        conversion = conversion_of_chunks(tags, floats, reading.by);
        if (!conversion->refusal.empty()) {
            reading.ignored = fmt::format("its chromaticities are not used: {}", conversion->refusal);
            conversion.reset();
            if (ColorTags curve = tags; tags.gamma > 0 && !floats) {
                curve.chromaticities = {};
                reading.by.clear();
                conversion = conversion_of_chunks(curve, floats, reading.by);
            }
        }
    }
    if (!conversion) {
        reading.by.clear();
        return reading;
    }
    if (floats) {
        image.linear = true;
        reading.kind = Kind::linear;
        if (conversion->transform) {
            reading.ignored = fmt::format("{} is not used: it has tables, and the picture floats", reading.by);
            reading.by.clear();
            reading.kind = Kind::unknown;
        } else if (!is_identity(conversion->matrix)) {
            convert_floats(image.rgb32, conversion->matrix);
            reading.kind = Kind::converted;
        }
        return reading;
    }
    const Differences differences = compare_with_srgb(*conversion);
    // Small profiles that call themselves sRGB have its primaries and, for its curve, the power 2.2.
    const double srgb_tolerance = conversion->name.starts_with("sRGB") ? 9.0 / 255 : 1.5 / 255;
    constexpr double linear_tolerance = 0.002;
    if (differences.srgb <= srgb_tolerance) {
        reading.kind = Kind::srgb;
        image.linear = false;
    } else if (differences.linear <= linear_tolerance) {
        reading.kind = Kind::linear;
        image.linear = true;
    } else {
        reading.kind = Kind::converted;
        if (image.bits == 8)
            convert_values(image.rgb8, *conversion);
        else
            convert_values(image.rgb16, *conversion);
        image.linear = image.bits == 16;
    }
    return reading;
}

}  // namespace radiafit::tools
